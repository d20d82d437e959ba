//! Histograms of the exponent p.

use super::axis::{self, Axis, INK, MUTED, SMALL, centred, plain};
use super::svg::{Rect, Stroke, Svg, Type};
use serde::Serialize;

/// Counts of numbers in equal bins.
#[derive(Debug, Clone, Serialize)]
pub struct Histogram {
    /// Lower end of the first bin.
    pub lo: f64,
    /// Width of a bin.
    pub width: f64,
    /// Numbers in each bin; a bin holds its lower end.
    pub bins: Vec<u64>,
    /// Numbers beyond either end.
    pub outside: u64,
}

impl Histogram {
    /// Bins for exponents: 0.5 to 2.5 in steps of 0.025, so that the borders between classes in
    /// two dimensions are borders of bins.
    pub fn of_exponents(values: impl Iterator<Item = f64>) -> Self {
        let mut histogram = Self { lo: 0.5, width: 0.025, bins: vec![0; 80], outside: 0 };
        for value in values {
            let at = ((value - histogram.lo) / histogram.width).floor();
            match histogram.bins.get_mut(at as usize) {
                Some(bin) if at >= 0.0 => *bin += 1,
                _ => histogram.outside += 1,
            }
        }
        histogram
    }

    fn total(&self) -> u64 {
        self.bins.iter().sum::<u64>() + self.outside
    }
}

/// A value that theory predicts, and its name.
pub type Mark = (f64, &'static str);

/// What is drawn with a histogram.
pub struct Look<'a> {
    /// Heading.
    pub title: &'a str,
    /// Colour of the bars.
    pub colour: &'static str,
    /// Predicted exponents.
    pub marks: &'a [Mark],
    /// Standard deviation of one fitted p from noise alone, drawn about each mark.
    pub noise: f64,
    /// Whether to draw the normal distribution that noise alone would give about the first mark.
    pub expected_curve: bool,
}

/// Draws a histogram; the vertical axis is the share of its pixels in a bin.
pub fn draw(histogram: &Histogram, look: &Look<'_>) -> Svg {
    let area = Rect { x: 72.0, y: 86.0, w: 420.0, h: 250.0 };
    let mut svg = Svg::new(520.0, area.y + area.h + 56.0, look.title);
    svg.text([28.0, 30.0], plain(16.0, INK), look.title);
    let total = histogram.total().max(1) as f64;
    let share = |count: u64| 100.0 * count as f64 / total;
    let normal = |p: f64, mean: f64| {
        let z = (p - mean) / look.noise;
        100.0 * histogram.width * (-0.5 * z * z).exp() / (look.noise * std::f64::consts::TAU.sqrt())
    };
    let mut highest = share(histogram.bins.iter().copied().max().unwrap_or(0));
    if look.expected_curve {
        highest = highest.max(normal(0.0, 0.0));
    }
    let end = histogram.lo + histogram.width * histogram.bins.len() as f64;
    let x = Axis::linear([histogram.lo, end], [area.x, area.x + area.w]);
    let y = Axis::linear([0.0, 1.08 * highest.max(1.0)], [area.y + area.h, area.y]);
    axis::draw(&mut svg, area, &x, &y, ["exponent p", "share of pixels, %"]);

    for (p, _) in look.marks {
        let [left, right] = [p - look.noise, p + look.noise].map(|p| x.at(p));
        svg.fill(Rect { x: left, y: area.y, w: right - left, h: area.h }, "#000000", 0.09);
    }
    for (i, &count) in histogram.bins.iter().enumerate().filter(|(_, count)| **count > 0) {
        let left = histogram.lo + histogram.width * i as f64;
        let [left, right] = [left, left + histogram.width].map(|p| x.at(p));
        let top = y.at(share(count));
        let bar = Rect { x: left + 0.4, y: top, w: right - left - 0.8, h: area.y + area.h - top };
        svg.fill(bar, look.colour, 0.85);
    }
    for (i, (p, name)) in look.marks.iter().enumerate() {
        let at = x.at(*p);
        let dashed = Stroke { colour: INK, width: 1.0, dash: "4 4" };
        svg.line([at, area.y], [at, area.y + area.h], dashed);
        svg.text([at, area.y - 22.0], centred(SMALL + 0.5, INK), name);
        if i == 0 {
            let half = x.at(p + look.noise) - at;
            let bracket = Stroke::solid(MUTED, 1.0);
            let y = area.y - 8.0;
            svg.line([at - half, y], [at + half, y], bracket);
            for end in [at - half, at + half] {
                svg.line([end, y - 3.0], [end, y + 3.0], bracket);
            }
            let set = Type { anchor: "end", ..plain(SMALL, MUTED) };
            let words = format!("noise of one fit ± {:.3}", look.noise);
            svg.text([at - half - 8.0, y + 4.0], set, &words);
        }
    }
    if let (true, Some((mean, _))) = (look.expected_curve, look.marks.first()) {
        let points: Vec<_> = (-40..=40)
            .map(|i| mean + f64::from(i) * 0.1 * look.noise)
            .map(|p| [x.at(p), y.at(normal(p, *mean))])
            .collect();
        svg.path(&points, Stroke { colour: INK, width: 1.4, dash: "5 3" });
        let beside =
            [x.at(mean + 1.6 * look.noise) + 6.0, y.at(normal(mean + 1.3 * look.noise, *mean))];
        svg.text(beside, plain(SMALL, INK), "expected from noise alone");
    }
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_falls_into_one_bin_or_is_outside() {
        let values = [0.5, 0.49, 1.0, 1.024, 1.25, 2.499, 2.5, f64::NAN, -3.0];
        let h = Histogram::of_exponents(values.into_iter());
        assert_eq!(h.total(), values.len() as u64);
        assert_eq!(h.outside, 4);
        assert_eq!([h.bins[0], h.bins[20], h.bins[30], h.bins[79]], [1, 2, 1, 1]);
    }
}
