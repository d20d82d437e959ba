//! Measured curves beside power laws, on log axes.

use super::axis::{self, Axis, INK, MUTED, SMALL, plain};
use super::chart::Style;
use super::svg::{Rect, Stroke, Svg};
use stratcore::literature::Figure;

/// Draws points with their intervals, joined by thin lines, and the laws dashed.
pub fn draw(figure: &Figure) -> Svg {
    const LEGEND_ROW: f64 = 19.0;
    let top = 52.0 + LEGEND_ROW * figure.curves.len() as f64;
    let area = Rect { x: 78.0, y: top, w: 400.0, h: 300.0 };
    let mut svg = Svg::new(540.0, area.y + area.h + 56.0, figure.title);
    svg.text([28.0, 30.0], plain(16.0, INK), figure.title);
    let points = || figure.curves.iter().flat_map(|curve| &curve.points);
    let x_range = bounds(points().map(|p| p[0]));
    let y_range = bounds(points().flat_map(|p| [p[1], p[2], p[3]]).filter(|y| *y > 0.0));
    let across = [area.x, area.x + area.w];
    let x = if figure.log_x {
        Axis::log(widen(x_range, 0.06), across)
    } else {
        Axis::linear([0.0, 1.0], across)
    };
    let y_range = widen(y_range, 0.04);
    let y = Axis::log(y_range, [area.y + area.h, area.y]);
    axis::draw(&mut svg, area, &x, &y, figure.axes);
    let dashed = Stroke { colour: "#8a8a8a", width: 0.9, dash: "4 4" };
    for slope in &figure.slopes {
        let law = |x: f64| slope.factor * x.powf(slope.power);
        // Where the law leaves the frame.
        let meets = |y: f64| (y / slope.factor).powf(1.0 / slope.power);
        let (low, high) = (meets(y_range[0]), meets(y_range[1]));
        let from = x_range[0].max(low.min(high));
        let to = x_range[1].min(low.max(high));
        if from < to {
            svg.line([x.at(from), y.at(law(from))], [x.at(to), y.at(law(to))], dashed);
            let cut = to < x_range[1];
            let beside = if cut { [7.0, -6.0] } else { [7.0, 4.0] };
            let at = [x.at(to) + beside[0], y.at(law(to)) + beside[1]];
            svg.text(at, plain(SMALL, MUTED), slope.name);
        }
    }
    for (i, curve) in figure.curves.iter().enumerate() {
        let style = Style::nth(i);
        let row = 54.0 + LEGEND_ROW * i as f64;
        svg.marker([36.0, row], style.marker, style.colour);
        svg.text([50.0, row + 4.5], plain(13.0, INK), &curve.name);
        let at: Vec<_> = curve.points.iter().map(|p| [x.at(p[0]), y.at(p[1])]).collect();
        svg.path(&at, Stroke::solid(style.colour, 0.8));
        for (p, at) in curve.points.iter().zip(&at) {
            if p[2] > 0.0 && p[2] < p[3] {
                let ends = [p[2], p[3]].map(|end| [at[0], y.at(end)]);
                svg.line(ends[0], ends[1], Stroke::solid(style.colour, 1.2));
            }
            svg.marker(*at, style.marker, style.colour);
        }
    }
    svg
}

fn bounds(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, 0.0], |[lo, hi], v| [lo.min(v), hi.max(v)])
}

/// A range with a margin: a share of its length in powers of ten, or of half a decade.
fn widen(range: [f64; 2], share: f64) -> [f64; 2] {
    let [lo, hi] = range.map(f64::log10);
    let margin = share * (hi - lo).max(0.5);
    [lo - margin, hi + margin].map(|v| 10f64.powf(v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::literature::{Curve, Slope};

    #[test]
    fn points_bars_and_laws_are_drawn() {
        let points = (0..5).map(|i| 4f64.powi(i)).map(|n| [n, 1.0 / n, 0.9 / n, 1.1 / n]);
        let figure = Figure {
            name: "test",
            title: "test",
            caption: String::new(),
            axes: ["N", "error"],
            log_x: true,
            curves: vec![Curve { name: "measured".to_owned(), points: points.collect() }],
            slopes: vec![Slope { name: "N^{-1}", factor: 1.0, power: -1.0 }],
        };
        let svg = draw(&figure).to_svg();
        assert_eq!(svg.matches("<circle").count(), 6);
        assert!(svg.contains("stroke-dasharray") && svg.contains(">measured<"), "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
