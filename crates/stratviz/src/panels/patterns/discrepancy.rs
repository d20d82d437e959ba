//! Discrepancy against N.

use super::caption;
use crate::model::Piece;
use crate::panels::bars::Bars;
use crate::panels::colours;
use crate::panels::plot::{log_log, marker_of, slope};
use crate::state::PatternWords;
use eframe::egui::{Ui, vec2};
use egui_plot::{Line, MarkerShape, Points};
use stratcli::report::discrepancy::{interval, rates};
use stratcore::discrepancy::Measure;
use stratcore::study::DiscrepancyCurve;

/// Draws the curves of all samplers, with the rates that theory knows.
pub fn ui(ui: &mut Ui, words: &PatternWords, found: &Piece<Vec<DiscrepancyCurve>>) {
    let dark = ui.visuals().dark_mode;
    let muted = ui.visuals().weak_text_color();
    let measure = words.measure.parse::<Measure>().ok();
    let title = format!("Discrepancy: {}", words.measure);
    caption(ui, &title, &format!("mean of {}", words.sets), &found.progress);
    let curves = found.result.as_deref().unwrap_or_default();
    // A narrow plot: the names of slopes need a larger share of it.
    let plot = log_log("discrepancy", "points, N", "mean discrepancy");
    plot.set_margin_fraction(vec2(0.17, 0.06)).show(ui, |plot| {
        let rows = || curves.iter().flat_map(|curve| &curve.rows).filter(|row| row.mean > 0.0);
        let lowest = rows().map(|row| row.mean.log10()).fold(f64::INFINITY, f64::min);
        let last = rows().map(|row| row.n_used).max().unwrap_or(1) as f64;
        let start = curves
            .iter()
            .rev()
            .find_map(|curve| curve.rows.iter().find(|row| row.n_used > 1 && row.mean > 0.0));
        if let (Some(row), Some(measure)) = (start, measure) {
            let from = [(row.n_used as f64).log10(), row.mean.log10()];
            for (name, p) in rates(measure) {
                slope(plot, from, [last.log10(), lowest], (p, name), muted);
            }
        }
        for curve in curves {
            let colour = colours::sampler(curve.sampler, dark);
            let rows = || curve.rows.iter().filter(|row| row.mean > 0.0);
            let place = |n: u64, value: f64| [(n as f64).log10(), value.log10()];
            if let Some(fit) = &curve.fit {
                let ends = [fit.n_min, fit.n_max].map(|n| place(n, fit.variance_at(n as f64)));
                let line = Line::new(curve.sampler, ends.to_vec()).color(colour).width(1.5);
                plot.line(line.allow_hover(false));
            }
            let bars = rows().filter(|row| row.std_error.is_some()).map(|row| {
                let [low, high] = interval(row.mean, row.std_error).map(f64::log10);
                [(row.n_used as f64).log10(), low, high]
            });
            plot.add(Bars::upright(curve.sampler, colour, bars));
            let points: Vec<_> = rows().map(|row| place(row.n_used, row.mean)).collect();
            let shape = marker_of(curve.sampler);
            let dots = Points::new(curve.sampler, points).shape(shape).radius(3.0);
            plot.points(dots.color(colour).filled(shape != MarkerShape::Circle));
        }
    });
}
