//! Axes: where a number lies on paper, and which numbers are printed beside it.

use super::svg::{Rect, Stroke, Svg, Type};

/// Ink of text and frames.
pub const INK: &str = "#222222";
/// Ink of what is said in passing.
pub const MUTED: &str = "#666666";
/// Grid lines.
pub const GRID: &str = "#e4e4e4";
/// Size of text on axes.
pub const SMALL: f64 = 11.5;

/// Plain text of a size and colour, from its start.
pub const fn plain(size: f64, colour: &'static str) -> Type {
    Type { size, colour, anchor: "start", upwards: false }
}

/// The same, centred on its point.
pub const fn centred(size: f64, colour: &'static str) -> Type {
    Type { size, colour, anchor: "middle", upwards: false }
}

/// One axis: numbers `lo ..= hi` onto coordinates `from ..= to`.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    lo: f64,
    hi: f64,
    log: bool,
    from: f64,
    to: f64,
}

/// A place on an axis with what is printed there; minor ticks have no label.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// The number.
    pub value: f64,
    /// What is printed.
    pub label: Option<String>,
}

impl Axis {
    /// Equal steps for equal differences; `lo < hi`.
    pub fn linear([lo, hi]: [f64; 2], [from, to]: [f64; 2]) -> Self {
        Self { lo, hi, log: false, from, to }
    }

    /// Equal steps for equal ratios; `0 < lo < hi`.
    pub fn log([lo, hi]: [f64; 2], [from, to]: [f64; 2]) -> Self {
        Self { lo: lo.log10(), hi: hi.log10(), log: true, from, to }
    }

    /// Where a number lies.
    pub fn at(&self, value: f64) -> f64 {
        let value = if self.log { value.log10() } else { value };
        self.from + (value - self.lo) / (self.hi - self.lo) * (self.to - self.from)
    }

    /// Decades with 2 … 9 between them as minor ticks, or round steps of 1, 2 or 5.
    pub fn ticks(&self) -> Vec<Tick> {
        if self.log { self.decades() } else { self.steps() }
    }

    fn decades(&self) -> Vec<Tick> {
        let slack = 1e-9;
        let span = self.hi - self.lo;
        let every = (span / 7.0).ceil().max(1.0) as i32;
        let mut ticks = Vec::new();
        for decade in self.lo.floor() as i32..=self.hi.ceil() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(decade);
                if value.log10() < self.lo - slack || value.log10() > self.hi + slack {
                    continue;
                }
                if digit == 1 {
                    let label = (decade.rem_euclid(every) == 0).then(|| power_of_ten(decade));
                    ticks.push(Tick { value, label });
                } else if span <= 8.0 {
                    // Less than two decades may have one power of ten: 2 and 5 help to read it.
                    let label = (span < 2.0 && matches!(digit, 2 | 5)).then(|| number(value));
                    ticks.push(Tick { value, label });
                }
            }
        }
        ticks
    }

    fn steps(&self) -> Vec<Tick> {
        let rough = (self.hi - self.lo) / 6.0;
        let unit = 10f64.powf(rough.log10().floor());
        let step =
            unit * [1.0, 2.0, 5.0, 10.0].into_iter().find(|m| m * unit >= rough).unwrap_or(10.0);
        let first = (self.lo / step - 1e-9).ceil() as i64;
        let last = (self.hi / step + 1e-9).floor() as i64;
        let tick = |i: i64| {
            let value = i as f64 * step;
            Tick { value, label: Some(number(value)) }
        };
        (first..=last).map(tick).collect()
    }
}

/// A number with no more digits than it needs, and a true minus.
fn number(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded }).replace('-', "\u{2212}")
}

fn power_of_ten(decade: i32) -> String {
    match decade {
        0..=3 => format!("{}", 10u32.pow(decade.unsigned_abs())),
        _ => format!("10^{{{decade}}}").replace('-', "\u{2212}"),
    }
}

/// Grid, ticks, frame and names of a pair of axes around the area they span.
pub fn draw(svg: &mut Svg, area: Rect, x: &Axis, y: &Axis, [x_name, y_name]: [&str; 2]) {
    const MAJOR: f64 = 5.0;
    const MINOR: f64 = 3.0;
    let frame = Stroke::solid(INK, 1.0);
    let thin = Stroke::solid(INK, 0.7);
    let grid = Stroke::solid(GRID, 0.8);
    let Rect { x: left, y: top, w, h } = area;
    let (right, bottom) = (left + w, top + h);
    for tick in x.ticks() {
        let at = x.at(tick.value);
        if let Some(label) = &tick.label {
            svg.line([at, top], [at, bottom], grid);
            svg.text([at, bottom + 18.0], centred(SMALL, INK), label);
        }
        let length = if tick.label.is_some() { MAJOR } else { MINOR };
        svg.line([at, bottom], [at, bottom - length], thin);
    }
    for tick in y.ticks() {
        let at = y.at(tick.value);
        if let Some(label) = &tick.label {
            svg.line([left, at], [right, at], grid);
            let set = Type { anchor: "end", ..plain(SMALL, INK) };
            svg.text([left - 8.0, at + 4.0], set, label);
        }
        let length = if tick.label.is_some() { MAJOR } else { MINOR };
        svg.line([left, at], [left + length, at], thin);
    }
    svg.line([left, bottom], [right, bottom], frame);
    svg.line([left, top], [left, bottom], frame);
    svg.text([left + w / 2.0, bottom + 38.0], centred(SMALL + 0.5, INK), x_name);
    let upwards = Type { upwards: true, ..centred(SMALL + 0.5, INK) };
    svg.text([left - 44.0, top + h / 2.0], upwards, y_name);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().filter_map(|t| t.label).collect()
    }

    #[test]
    fn decades_carry_labels_and_eight_minor_ticks_each() {
        let axis = Axis::log([0.01, 100.0], [0.0, 400.0]);
        assert_eq!(labels(&axis), ["10^{\u{2212}2}", "10^{\u{2212}1}", "1", "10", "100"]);
        assert_eq!(axis.ticks().len(), 4 * 9 + 1);
        assert!((axis.at(1.0) - 200.0).abs() < 1e-9);
        assert_eq!(labels(&Axis::log([1e-12, 1e9], [0.0, 1.0])).len(), 8);
        assert_eq!(labels(&Axis::log([1.5, 6.0], [0.0, 1.0])), ["2", "5"]);
        let both_sides = ["0.02", "0.05", "10^{\u{2212}1}", "0.2", "0.5"];
        assert_eq!(labels(&Axis::log([0.015, 0.6], [0.0, 1.0])), both_sides);
    }

    #[test]
    fn linear_ticks_are_round_numbers() {
        let axis = Axis::linear([0.5, 2.5], [100.0, 0.0]);
        assert_eq!(labels(&axis), ["0.5", "1", "1.5", "2", "2.5"]);
        assert_eq!(labels(&Axis::linear([-0.1, 0.1], [0.0, 1.0]))[0], "\u{2212}0.1");
        assert_eq!(axis.at(2.5), 0.0);
    }
}
