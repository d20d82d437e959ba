//! Variance of the mean against N, both logarithmic: the plot that pixels and integrands share.

use super::bars::Bars;
use super::colours;
use crate::model::Study;
use eframe::egui::{Align2, Color32, RichText, Ui, Vec2, Vec2b};
use egui_plot::{
    GridInput, GridMark, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotUi, Points, Text,
};
use stratcli::report::chart::{Style, fraction};
use stratcli::report::svg::Marker;
use stratcore::study::{Row, SamplerResult};
use stratcore::theory::Class;

/// One curve with what tells it from others.
struct Curve<'a> {
    sampler: &'a SamplerResult,
    /// 95 % intervals of its variances, by row.
    intervals: &'a [[f64; 2]],
    colour: Color32,
    marker: MarkerShape,
    /// Kept from before: drawn pale.
    is_kept: bool,
}

impl Curve<'_> {
    /// The rows that have a variance, with its interval.
    fn bars(&self) -> impl Iterator<Item = (&Row, [f64; 2])> {
        let rows = self.sampler.rows.iter().zip(self.intervals.iter().copied());
        rows.filter(|(row, _)| row.variance_of_mean > 0.0)
    }
}

/// Draws the curves of these studies. With several, colour tells the sampler and marker the
/// study.
pub fn ui(ui: &mut Ui, id: &str, studies: &[&Study]) {
    let dark = ui.visuals().dark_mode;
    let mut curves = Vec::new();
    for (i, study) in studies.iter().enumerate() {
        let kept = study.kept.iter().map(|kept| (&kept.sampler, &kept.intervals[..], true));
        let current = study.curves().map(|(sampler, intervals)| (sampler, intervals, false));
        for (sampler, intervals, is_kept) in kept.chain(current) {
            let colour = colours::sampler(sampler.name, dark);
            let colour = if is_kept { colour.gamma_multiply(0.45) } else { colour };
            let several = studies.len() > 1;
            let marker = if several { nth_marker(i) } else { marker_of(sampler.name) };
            curves.push(Curve { sampler, intervals, colour, marker, is_kept });
        }
    }
    let dim = studies.iter().find_map(|study| study.result.as_ref()).map_or(2, |r| r.dim);
    let muted = ui.visuals().weak_text_color();
    let lowest = lowest(&curves);
    let y_name = if lowest.is_some() { "variance of the mean" } else { "every variance is 0" };
    let mut plot = log_log(id, "samples in one estimate, N", y_name);
    if lowest.is_none() {
        plot = plot.y_axis_formatter(|_, _| String::new());
    }
    // Where variances of zero are marked: below everything else.
    let floor = lowest.map_or(0.0, |lowest| lowest - 0.25);
    plot.label_formatter(|position| match position {
        egui_plot::HoverPosition::NearDataPoint { plot_name, position, .. } => Some(format!(
            "{plot_name}\nN {:.0}\nvariance {:.3e}",
            10f64.powf(position.x),
            10f64.powf(position.y)
        )),
        egui_plot::HoverPosition::Elsewhere { .. } => None,
    })
    .show(ui, |plot| {
        reference_slopes(plot, &curves, dim, floor, muted);
        for curve in &curves {
            draw(plot, curve, floor);
        }
    });
}

/// A plot of logarithms.
pub fn log_log<'a>(id: &str, x_name: &'static str, y_name: &'static str) -> Plot<'a> {
    Plot::new(id)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_axes(Vec2b::TRUE)
        .set_margin_fraction(Vec2::new(0.1, 0.06))
        .x_axis_label(x_name)
        .y_axis_label(y_name)
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(|mark, range| power(mark, range.end() - range.start()))
        .y_axis_formatter(|mark, range| power(mark, range.end() - range.start()))
}

/// A dashed line of slope -p from (x0, y0) to x1, or down to `floor`, with its name at the end.
pub fn slope(
    plot: &mut PlotUi<'_>,
    [x0, y0]: [f64; 2],
    [x1, floor]: [f64; 2],
    (p, name): (f64, &str),
    colour: Color32,
) {
    let x1 = x1.min(x0 + (y0 - floor) / p);
    let end = [x1, y0 - p * (x1 - x0)];
    let line = Line::new("slope", vec![[x0, y0], end]).color(colour).width(1.0);
    plot.line(line.style(LineStyle::dashed_dense()).allow_hover(false));
    let at = PlotPoint::new(end[0], end[1]);
    // Clear of the last point's marker.
    let text = Text::new("slope", at, RichText::new(format!("  {name}")).size(12.0));
    plot.text(text.color(colour).anchor(Align2::LEFT_CENTER).allow_hover(false));
}

/// A point for every sampler where there is a variance.
fn draw(plot: &mut PlotUi<'_>, curve: &Curve<'_>, floor: f64) {
    let Curve { sampler, colour, .. } = *curve;
    let name = sampler.name;
    if let Some(fit) = &sampler.fit {
        let end = |n: u64| [(n as f64).log10(), fit.variance_at(n as f64).log10()];
        let line = Line::new(name, vec![end(fit.n_min), end(fit.n_max)]);
        plot.line(line.color(colour).width(1.5).allow_hover(false));
    }
    let exact = |row: &Row| {
        let variance = row.exact_variance.filter(|v| *v > 0.0)?;
        Some([(row.n_used as f64).log10(), variance.log10()])
    };
    let closed_form: Vec<_> = sampler.rows.iter().filter_map(exact).collect();
    if !curve.is_kept && closed_form.len() > 1 {
        let style = LineStyle::Dotted { spacing: 4.0 };
        let line = Line::new("closed form", closed_form).color(colour).width(1.0);
        plot.line(line.style(style).allow_hover(false));
    }
    let bars = curve.bars().map(|(row, interval)| {
        let [low, high] = interval.map(f64::log10);
        [(row.n_used as f64).log10(), low, high]
    });
    plot.add(Bars::upright(name, colour, bars));
    let at = |row: &Row| [(row.n_used as f64).log10(), row.variance_of_mean.log10()];
    let points: Vec<_> = measured(sampler).map(at).collect();
    let dots = Points::new(name, points).shape(curve.marker).radius(3.5).color(colour);
    plot.points(dots.filled(curve.marker != MarkerShape::Circle));
    let zero = sampler.rows.iter().filter(|row| row.variance_of_mean == 0.0);
    let zero: Vec<_> = zero.map(|row| [(row.n_used as f64).log10(), floor]).collect();
    if !zero.is_empty() {
        let marks = Points::new(format!("{name}: variance 0, left out of the fit"), zero);
        plot.points(marks.shape(MarkerShape::Down).radius(5.0).filled(false).color(colour));
    }
}

fn measured(sampler: &SamplerResult) -> impl Iterator<Item = &Row> {
    sampler.rows.iter().filter(|row| row.variance_of_mean > 0.0)
}

/// log₁₀ of the lowest end of an interval, where there is one.
fn lowest(curves: &[Curve<'_>]) -> Option<f64> {
    let lows = curves.iter().flat_map(Curve::bars).map(|(_, interval)| interval[0]);
    let lowest = lows.fold(f64::INFINITY, f64::min);
    lowest.is_finite().then(|| lowest.log10())
}

/// The slopes of complex, edge and smooth integrands, dashed, through the first fitted point of
/// the last curve that has a fit.
fn reference_slopes(
    plot: &mut PlotUi<'_>,
    curves: &[Curve<'_>],
    dim: usize,
    floor: f64,
    colour: Color32,
) {
    let fitted = curves.iter().rev().find_map(|c| Some((c.sampler.fit.as_ref()?, c.sampler)));
    let Some((fit, sampler)) = fitted else { return };
    let Some(first) = measured(sampler).find(|row| row.n_used == fit.n_min) else { return };
    let (x0, y0) = ((first.n_used as f64).log10(), first.variance_of_mean.log10());
    for class in [Class::Complex, Class::Edge, Class::Smooth] {
        let Some(p) = class.predicted_exponent(dim) else { continue };
        let reach = [(fit.n_max as f64).log10(), floor];
        let name = format!("-{}", fraction(class, dim));
        slope(plot, [x0, y0], reach, (p, &name), colour);
    }
}

/// Decades, and 2 … 9 times them where there is room.
pub fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let mut marks = Vec::new();
    if !(high - low).is_finite() || high - low > 400.0 {
        return marks;
    }
    for decade in low.floor() as i64..=high.ceil() as i64 {
        marks.push(GridMark { value: decade as f64, step_size: 1.0 });
        if high - low <= 8.0 {
            let minor = |digit: i32| decade as f64 + f64::from(digit).log10();
            marks.extend((2..10).map(|d| GridMark { value: minor(d), step_size: 0.2 }));
        }
    }
    marks.retain(|mark| (low..=high).contains(&mark.value));
    marks
}

/// A power of ten as people write it; 2 and 5 times it where only one or two of them are seen.
pub fn power(mark: GridMark, span: f64) -> String {
    let decade = mark.value.round();
    let value = 10f64.powf(mark.value);
    let is_decade = (mark.value - decade).abs() < 1e-6;
    let digit = (value / 10f64.powf(mark.value.floor())).round();
    if !is_decade && !(span < 1.7 && (digit == 2.0 || digit == 5.0)) {
        return String::new();
    }
    if (-3.0..6.0).contains(&decade) {
        stratcli::table::short(value, 3)
    } else {
        format!("1e{decade}")
    }
}

/// The marker of a sampler in every figure.
pub fn marker_of(name: &str) -> MarkerShape {
    match Style::of_sampler(name).marker {
        Marker::Circle => MarkerShape::Circle,
        Marker::Square => MarkerShape::Square,
        Marker::Triangle => MarkerShape::Up,
        Marker::Diamond => MarkerShape::Diamond,
        Marker::Cross => MarkerShape::Cross,
    }
}

/// The marker of the n-th of several studies.
pub fn nth_marker(n: usize) -> MarkerShape {
    use MarkerShape::{Circle, Cross, Diamond, Down, Plus, Square, Up};
    [Circle, Square, Up, Diamond, Down, Cross, Plus][n % 7]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_of_decades_are_written_as_people_do() {
        let label = |value: f64, span| power(GridMark { value, step_size: 1.0 }, span);
        assert_eq!(label(0.0, 3.0), "1");
        assert_eq!(label(2.0, 3.0), "100");
        assert_eq!(label(-3.0, 3.0), "0.001");
        assert_eq!(label(-7.0, 9.0), "1e-7");
        assert_eq!(label(2f64.log10(), 3.0), "");
        assert_eq!(label(2f64.log10(), 0.8), "2");
    }

    #[test]
    fn the_grid_is_finite_whatever_the_bounds() {
        let marks = |bounds| decades(GridInput { bounds, base_step_size: 0.1 }).len();
        assert_eq!(marks((0.0, 2.0)), 19);
        assert_eq!(marks((-1e300, 1e300)), 0);
        assert_eq!(marks((f64::NAN, 1.0)), 0);
    }
}
