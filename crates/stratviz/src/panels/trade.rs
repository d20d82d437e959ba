//! Error against time in the first pixel: the cheapest way to an error.

use super::colours;
use super::plot::{decades, marker_of, power};
use crate::command::Command;
use crate::model::Model;
use crate::state::State;
use eframe::egui::{self, Grid, RichText, Ui};
use egui_plot::{HLine, Line, LineStyle, MarkerShape, Plot, Points};
use stratcli::table::number;
use stratcore::trade::{Choice, Reach, SamplerTrade, TradeResult, TradeRow};

/// Draws the trade page.
pub fn ui(ui: &mut Ui, state: &State, model: &Model) -> Option<Command> {
    let mut command = None;
    ui.horizontal_wrapped(|ui| {
        ui.heading(match state.pixels.first() {
            Some([x, y]) => format!("Error against time, pixel {x}, {y}"),
            None => "Error against time".to_owned(),
        });
        if model.trade.running {
            ui.spinner();
        }
        let can = !state.pixels.is_empty() && !model.trade.running;
        let button = ui.add_enabled(can, egui::Button::new("Measure"));
        let hint = "errors on all cores, then times on one: nothing else should run meanwhile";
        if button.on_hover_text(hint).clicked() {
            command = Some(Command::Trade);
        }
    });
    if state.pixels.is_empty() {
        ui.label("Click a pixel of the picture first.");
    }
    if let Some(fault) = &model.trade.fault {
        ui.colored_label(ui.visuals().error_fg_color, fault);
    }
    let Some((pixel, trade)) = &model.trade.result else { return command };
    if Some(pixel) != state.pixels.first() {
        ui.weak(format!("measured in pixel {}, {}", pixel[0], pixel[1]));
    }
    for choice in &trade.choices {
        ui.label(RichText::new(sentence(choice)).strong());
    }
    egui::Panel::bottom("ways").resizable(true).default_size(150.0).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for choice in &trade.choices {
                ways(ui, choice);
            }
        });
    });
    plot(ui, trade);
    command
}

fn sentence(choice: &Choice) -> String {
    let error = number(choice.error, 3);
    let Some(best) = choice.best.and_then(|at| choice.reach.get(at)) else {
        return format!("No sampler is sure to reach error {error}.");
    };
    let mut text = format!("The cheapest way to error {error}: {}", way(best));
    if let Some(tried) = &choice.confirmation {
        let share = 100.0 * tried.reached;
        text += &format!("; {share:.0} % of {} fresh runs reached it", tried.runs);
    }
    text + "."
}

fn way(reach: &Reach) -> String {
    let count = reach.n_safe.map_or_else(|| "no".to_owned(), |n| n.to_string());
    let time = reach.ns.map_or_else(String::new, |ns| format!(", {}", time(ns.median)));
    let beyond = if reach.extrapolated { " (beyond what was measured)" } else { "" };
    format!("{count} samples of {}{time}{beyond}", reach.name)
}

/// Nanoseconds in the unit that suits them.
fn time(ns: f64) -> String {
    match ns {
        ns if ns < 1e3 => format!("{} ns", number(ns, 3)),
        ns if ns < 1e6 => format!("{} µs", number(ns / 1e3, 3)),
        ns => format!("{} ms", number(ns / 1e6, 3)),
    }
}

fn ways(ui: &mut Ui, choice: &Choice) {
    let dash = || "-".to_owned();
    Grid::new("ways").num_columns(4).spacing([14.0, 4.0]).striped(true).show(ui, |ui| {
        for title in ["sampler", "samples", "time of one estimate", ""] {
            ui.weak(title);
        }
        ui.end_row();
        for reach in &choice.reach {
            ui.colored_label(colours::sampler(reach.name, ui.visuals().dark_mode), reach.name);
            ui.label(reach.n_safe.map_or_else(dash, |n| n.to_string()));
            ui.label(reach.ns.map_or_else(dash, |ns| time(ns.median)));
            ui.label(if reach.extrapolated { "beyond what was measured" } else { "" });
            ui.end_row();
        }
    });
}

fn plot(ui: &mut Ui, trade: &TradeResult) {
    let dark = ui.visuals().dark_mode;
    let muted = ui.visuals().weak_text_color();
    Plot::new("trade")
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .x_axis_label("time of one estimate, ns")
        .y_axis_label("RMS error")
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .x_axis_formatter(|mark, range| power(mark, range.end() - range.start()))
        .y_axis_formatter(|mark, range| power(mark, range.end() - range.start()))
        .show(ui, |plot| {
            for choice in &trade.choices {
                let line = HLine::new("target", choice.error.log10()).color(muted);
                plot.hline(line.style(LineStyle::dashed_dense()).allow_hover(false));
            }
            plot.line(Line::new("Pareto front", front(trade)).color(muted).width(3.0));
            for sampler in &trade.samplers {
                let colour = colours::sampler(sampler.name, dark);
                let points: Vec<_> = measured(sampler).map(place).collect();
                plot.line(Line::new(sampler.name, points.clone()).color(colour).width(1.0));
                let shape = marker_of(sampler.name);
                let dots = Points::new(sampler.name, points).shape(shape).radius(3.5);
                plot.points(dots.color(colour).filled(shape != MarkerShape::Circle));
            }
        });
}

/// The rows that can be drawn: an error of zero has no logarithm.
fn measured(sampler: &SamplerTrade) -> impl Iterator<Item = &TradeRow> {
    sampler.rows.iter().filter(|row| row.error.rmse > 0.0)
}

fn place(row: &TradeRow) -> [f64; 2] {
    [row.ns_per_estimate.median.log10(), row.error.rmse.log10()]
}

/// The points that no other point beats in both time and error, from fast to exact.
fn front(trade: &TradeResult) -> Vec<[f64; 2]> {
    let rows = trade.samplers.iter().flat_map(measured).filter(|row| row.pareto);
    let mut points: Vec<_> = rows.map(place).collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        assert_eq!(time(12.34), "12.3 ns");
        assert_eq!(time(12_340.0), "12.3 µs");
        assert_eq!(time(1.234e7), "12.3 ms");
    }
}
