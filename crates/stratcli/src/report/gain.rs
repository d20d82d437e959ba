//! What stratification buys: variance random / variance jittered against N, by class.

use super::axis::{self, Axis, INK, MUTED, SMALL, plain};
use super::summary::Gain;
use super::svg::{Marker, Rect, Stroke, Svg};
use stratcore::theory::Class;

/// Colour and marker that stand for a class; apart from the samplers' as far as may be.
pub fn class_style(class: Class) -> (&'static str, Marker) {
    match class {
        Class::Smooth => ("#009e73", Marker::Triangle),
        Class::Edge => ("#cc79a7", Marker::Diamond),
        Class::Complex => ("#000000", Marker::Circle),
        Class::Exact => ("#8a8a8a", Marker::Cross),
    }
}

/// Medians with their quartiles, beside the factors the paper states.
pub fn draw(gains: &[Gain]) -> Svg {
    let title = "Gain: variance of random / variance of jittered";
    let area = Rect { x: 78.0, y: 72.0 + 19.0 * gains.len() as f64, w: 412.0, h: 290.0 };
    let mut svg = Svg::new(540.0, area.y + area.h + 56.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    let n_max = gains.iter().flat_map(|g| &g.n).copied().max().unwrap_or(1) as f64;
    let shown = || gains.iter().flat_map(|g| &g.quartiles).flatten().filter(|v| **v > 0.0);
    let low = shown().copied().fold(0.6, f64::min);
    let high = shown().copied().fold(n_max, f64::max);
    let x = Axis::log([0.8, 1.25 * n_max], [area.x, area.x + area.w]);
    let y = Axis::log([0.9 * low, 1.4 * high], [area.y + area.h, area.y]);
    axis::draw(&mut svg, area, &x, &y, ["samples in one estimate, N", "gain in variance"]);
    let dashed = Stroke { colour: "#8a8a8a", width: 0.9, dash: "4 4" };
    for (power, name) in [(1.0, "N"), (0.5, "N^{1/2}"), (0.0, "1")] {
        let end = [x.at(n_max), y.at(n_max.powf(power))];
        svg.line([x.at(1.0), y.at(1.0)], end, dashed);
        svg.text([end[0] + 8.0, end[1] + 4.0], plain(SMALL, MUTED), name);
    }
    for (i, gain) in gains.iter().enumerate() {
        let (colour, marker) = class_style(gain.class);
        let row = 54.0 + 19.0 * i as f64;
        svg.marker([36.0, row], marker, colour);
        let words = format!("{}, median and quartiles of {} pixels", gain.class, gain.pixels);
        svg.text([50.0, row + 4.5], plain(13.0, INK), &words);
        let thin = Stroke::solid(colour, 1.0);
        for (&n, &[low, median, high]) in gain.n.iter().zip(&gain.quartiles) {
            if low > 0.0 {
                let at = x.at(n as f64);
                svg.line([at, y.at(low)], [at, y.at(high)], thin);
                svg.marker([at, y.at(median)], marker, colour);
            }
        }
    }
    svg
}
