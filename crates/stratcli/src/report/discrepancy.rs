//! Discrepancy against N, both on log axes: a panel for each discrepancy.

use super::axis::{self, Axis, INK, MUTED, SMALL, plain};
use super::chart::{Style, bounds, label, styles, widen};
use super::svg::{Rect, Stroke, Svg};
use crate::output::csv_line;
use stratcore::discrepancy::Measure;
use stratcore::study::{Discrepancies, DiscrepancyCurve};

const LEGEND_ROW: f64 = 19.0;
const PLOT: Rect = Rect { x: 78.0, y: 0.0, w: 412.0, h: 300.0 };

/// The chart of every discrepancy that was measured.
pub fn chart(result: &Discrepancies) -> Svg {
    const PANEL_WIDTH: f64 = 540.0;
    let mut measures: Vec<Measure> = Vec::new();
    for curve in &result.curves {
        if !measures.contains(&curve.measure) {
            measures.push(curve.measure);
        }
    }
    let curves_of = |measure| result.curves.iter().filter(move |c| c.measure == measure);
    let per_panel = measures.first().map_or(0, |measure| curves_of(*measure).count());
    let legend = LEGEND_ROW * per_panel as f64;
    let panel_height = 58.0 + legend + PLOT.h + 60.0;
    let across = if measures.len() > 1 { 2 } else { 1 };
    let down = measures.len().div_ceil(across);
    let title = format!("Discrepancy in {} dimensions", result.dim);
    let size = [PANEL_WIDTH * across as f64, 40.0 + panel_height * down as f64];
    let mut svg = Svg::new(size[0], size[1], &title);
    svg.text([28.0, 30.0], plain(16.0, INK), &title);
    for (i, measure) in measures.into_iter().enumerate() {
        let left = PANEL_WIDTH * (i % across) as f64;
        let top = 40.0 + panel_height * (i / across) as f64;
        let curves: Vec<_> = curves_of(measure).collect();
        panel(&mut svg, [left, top], measure, &curves);
    }
    svg
}

fn panel(svg: &mut Svg, [left, top]: [f64; 2], measure: Measure, curves: &[&DiscrepancyCurve]) {
    let names: Vec<_> = curves.iter().map(|curve| curve.sampler).collect();
    let styles = styles(&names);
    let heading = format!("{}: {}", measure.name(), measure.summary());
    svg.text([left + 28.0, top + 20.0], plain(13.0, INK), &heading);
    for (i, (curve, style)) in curves.iter().zip(&styles).enumerate() {
        let y = top + 40.0 + LEGEND_ROW * i as f64;
        svg.line([left + 28.0, y], [left + 62.0, y], style.stroke(1.6));
        svg.marker([left + 45.0, y], style.marker, style.colour);
        svg.text([left + 72.0, y + 4.5], plain(13.0, INK), &legend(curve));
    }
    let rate = Rate::of(measure);
    let words_at = top + 44.0 + LEGEND_ROW * curves.len() as f64;
    svg.text([left + 28.0, words_at], plain(SMALL, MUTED), rate.words);
    let area_top = words_at + 14.0;
    let area = Rect { x: left + PLOT.x, y: area_top, ..PLOT };
    let rows = || curves.iter().flat_map(|curve| &curve.rows).filter(|row| row.mean > 0.0);
    if rows().next().is_none() {
        return;
    }
    let n_range = widen(bounds(rows().map(|row| row.n_used as f64)).map(f64::log10), 0.08);
    let ends = rows().flat_map(|row| interval(row.mean, row.std_error));
    let means = rows().map(|row| row.mean);
    let shown = means.chain(ends).filter(|value| *value > 0.0);
    let value_range = widen(bounds(shown).map(f64::log10), 0.08);
    let x = Axis::log(n_range, [area.x, area.x + area.w]);
    let y = Axis::log(value_range, [area.y + area.h, area.y]);
    axis::draw(svg, area, &x, &y, ["points, N", "mean discrepancy"]);
    reference_slopes(svg, measure, curves, &x, &y, value_range[0]);
    for (curve, style) in curves.iter().zip(&styles) {
        draw_curve(svg, curve, style, &x, &y);
    }
}

fn legend(curve: &DiscrepancyCurve) -> String {
    let name = label(curve.sampler, curve.scramble);
    match &curve.fit {
        Some(fit) => format!("{name} p = {:.3} ± {:.3}", fit.exponent, fit.std_error),
        None => name,
    }
}

/// The 95 % interval of a mean; the mean itself where there is no error.
pub fn interval(mean: f64, std_error: Option<f64>) -> [f64; 2] {
    let half = 1.959_963_985 * std_error.unwrap_or(0.0);
    [mean - half, mean + half]
}

/// Rates that theory knows, each as it is written and as the p of N^-p: that of random points,
/// and the steepest.
pub fn rates(measure: Measure) -> [(&'static str, f64); 2] {
    let rate = Rate::of(measure);
    [("\u{2212}1/2", 0.5), (rate.steepest_label, rate.steepest)]
}

/// What theory knows of rates.
struct Rate {
    words: &'static str,
    /// Largest exponent that is shown.
    steepest: f64,
    steepest_label: &'static str,
    /// Whether Beck and Chen's upper bound is shown too.
    upper_bound: bool,
}

impl Rate {
    fn of(measure: Measure) -> Self {
        let edges = ("\u{2212}3/4", 0.75);
        let (words, (steepest_label, steepest), upper_bound) = match measure {
            Measure::Edge => (
                "rates alone: random \u{2212}1/2; Beck & Chen's bounds \u{2212}3/4 and (dots) that times \u{221a}log N",
                edges,
                true,
            ),
            Measure::EdgeL2 => {
                ("rates alone: random \u{2212}1/2; jittered \u{2212}3/4", edges, false)
            }
            _ => (
                "rates alone: random \u{2212}1/2; nets \u{2212}1 but for logarithms",
                ("\u{2212}1", 1.0),
                false,
            ),
        };
        Self { words, steepest, steepest_label, upper_bound }
    }
}

/// Dashed lines of known rates through the first row of the last curve with more than one
/// point: their constants are unknown or those of no sampler here.
fn reference_slopes(
    svg: &mut Svg,
    measure: Measure,
    curves: &[&DiscrepancyCurve],
    x: &Axis,
    y: &Axis,
    floor: f64,
) {
    let start = |curve: &&DiscrepancyCurve| {
        curve.rows.iter().find(|row| row.n_used > 1 && row.mean > 0.0).copied()
    };
    let Some(first) = curves.iter().rev().find_map(start) else { return };
    let rows = curves.iter().flat_map(|curve| &curve.rows);
    let last = rows.map(|row| row.n_used).max().unwrap_or(first.n_used) as f64;
    let dashed = Stroke { colour: "#8a8a8a", width: 0.9, dash: "4 4" };
    let (n0, v0) = (first.n_used as f64, first.mean);
    for (label, p) in rates(measure) {
        let end = last.min(n0 * (v0 / floor).powf(1.0 / p));
        let to = [x.at(end), y.at(v0 * (end / n0).powf(-p))];
        svg.line([x.at(n0), y.at(v0)], to, dashed);
        // A line that ends at the floor is named above it.
        let above = if end < last { -6.0 } else { 4.0 };
        svg.text([to[0] + 5.0, to[1] + above], plain(SMALL, MUTED), label);
    }
    if Rate::of(measure).upper_bound {
        let bound = |n: f64| v0 * (n / n0).powf(-0.75) * (n.ln() / n0.ln()).sqrt();
        let steps = 48;
        let n = |i: i32| n0 * (last / n0).powf(f64::from(i) / f64::from(steps));
        let curve: Vec<_> = (0..=steps).map(|i| [x.at(n(i)), y.at(bound(n(i)))]).collect();
        svg.path(&curve, Stroke { colour: "#555555", width: 1.2, dash: "1 3" });
    }
}

fn draw_curve(svg: &mut Svg, curve: &DiscrepancyCurve, style: &Style, x: &Axis, y: &Axis) {
    let thin = Stroke::solid(style.colour, 0.9);
    if let Some(fit) = &curve.fit {
        let end = |n: u64| [x.at(n as f64), y.at(fit.variance_at(n as f64))];
        svg.line(end(fit.n_min), end(fit.n_max), style.stroke(1.5));
    }
    for row in curve.rows.iter().filter(|row| row.mean > 0.0) {
        let at = x.at(row.n_used as f64);
        let [low, high] = interval(row.mean, row.std_error);
        if low > 0.0 && high > low {
            svg.line([at, y.at(low)], [at, y.at(high)], thin);
        }
        svg.marker([at, y.at(row.mean)], style.marker, style.colour);
    }
}

/// A line per sampler, discrepancy and N. What is missing is empty.
pub fn csv(result: &Discrepancies) -> String {
    let mut text = "sampler,scramble,dim,n_requested,n_used,trials,seed,measure,mean,std_error,\
                    mean_sq,std_error_sq\n"
        .to_owned();
    let optional = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for curve in &result.curves {
        for row in &curve.rows {
            text += &csv_line(&[
                curve.sampler.to_owned(),
                curve.scramble.to_string(),
                result.dim.to_string(),
                row.n.to_string(),
                row.n_used.to_string(),
                row.trials.to_string(),
                result.seed.to_string(),
                curve.measure.name().to_owned(),
                row.mean.to_string(),
                optional(row.std_error),
                optional(row.mean_sq),
                optional(row.std_error_sq),
            ]);
        }
    }
    text
}
