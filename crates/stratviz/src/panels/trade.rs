//! Error against time, in the first pixel or over the picture: the cheapest way to an error.

use super::bars::Bars;
use super::colours;
use super::plot::{log_log, marker_of};
use crate::actions::{MEASURE, Now};
use crate::command::Command;
use crate::jobs::Traded;
use crate::line;
use crate::model::{Model, Progress};
use crate::state::State;
use eframe::egui::{self, DragValue, Grid, RichText, Ui};
use egui_plot::{HLine, Line, LineStyle, MarkerShape, Points};
use stratcli::report::chart::label;
use stratcli::report::trade::words;
use stratcore::trade::{Choice, SamplerTrade, TradeResult, TradeRow};

/// Draws the trade page.
pub fn ui(ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
    let Now { state, model, .. } = *now;
    let command = controls(ui, now);
    let progress = &model.trade.progress;
    if let Progress::Failed(fault) = progress {
        ui.colored_label(ui.visuals().error_fg_color, fault);
    }
    if let Some(traded) = &model.trade.result {
        results(ui, state, model, traded);
    } else if !progress.is_running() {
        if matches!(progress, Progress::Stopped(_)) {
            ui.label("Stopped, for times are taken while nothing else runs.");
        }
        ui.label(match (state.trade.whole, state.pixels.first()) {
            (false, None) => "Click a pixel of the picture, or measure the whole of it.",
            _ => {
                "Measure takes errors on all cores, then times on one, and names the cheapest \
                 way to the error that is set above."
            }
        });
    }
    command
}

fn controls(ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
    let Now { state, model, .. } = *now;
    let mut command = None;
    let mut words = state.trade.clone();
    ui.horizontal_wrapped(|ui| {
        ui.heading("Error against time");
        let pixel = match state.pixels.first() {
            Some([x, y]) => format!("pixel {x}, {y}"),
            None => "a pixel".to_owned(),
        };
        ui.selectable_value(&mut words.whole, false, pixel);
        ui.selectable_value(&mut words.whole, true, "whole picture");
        if words.whole {
            let label = ui.label("lattice");
            let hint = "pixels along each side of the lattice that stands for the picture";
            let lattice = DragValue::new(&mut words.lattice).range(1..=64).speed(0.1);
            ui.add(lattice).labelled_by(label.id).on_hover_text(hint);
        }
        if let Progress::Running(share) = model.trade.progress {
            ui.add(egui::ProgressBar::new(share).desired_width(90.0).show_percentage())
                .on_hover_text("samples of the errors; times and fresh runs come after them");
            ui.spinner();
        } else {
            command = MEASURE.button(ui, now);
        }
    });
    if words != state.trade { Some(Command::SetTrade(words)) } else { command }
}

fn results(ui: &mut Ui, state: &State, model: &Model, traded: &Traded) {
    let result = &traded.result;
    if let Some(choice) = &model.ways {
        ui.label(RichText::new(words::recommendation(choice, result)).strong());
    }
    let subject = match &traded.pixels[..] {
        [[x, y]] => format!("luminance of pixel {x}, {y}"),
        pixels => format!("luminance of {} pixels", pixels.len()),
    };
    let words_now = line::trade(state);
    let is_of_now = words_now.is_some_and(|words| line::same_trade(&words, &model.trade.planned));
    let stale = if is_of_now { "" } else { "; what is set now was not measured" };
    ui.weak(format!(
        "{subject}, mean {:.6}, M = {} trials, seed {}{stale}",
        result.reference.mean, result.trials, result.seed
    ));
    egui::Panel::bottom("ways").resizable(true).default_size(150.0).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if let Some(choice) = &model.ways {
                ways(ui, choice);
            }
        });
    });
    plot(ui, result, model.ways.as_ref());
}

/// A row per sampler: what it needs for the error.
fn ways(ui: &mut Ui, choice: &Choice) {
    let dash = || "-".to_owned();
    let dark = ui.visuals().dark_mode;
    Grid::new("ways").num_columns(5).spacing([14.0, 4.0]).striped(true).show(ui, |ui| {
        for title in ["sampler", "N to take", "time of one estimate", "quartiles", ""] {
            ui.weak(title);
        }
        ui.end_row();
        for (i, reach) in choice.reach.iter().enumerate() {
            let name = label(reach.name, reach.scramble);
            let name = RichText::new(name).color(colours::sampler(reach.name, dark));
            ui.label(if choice.best == Some(i) { name.strong() } else { name });
            ui.label(reach.n_safe.map_or_else(dash, |n| n.to_string()));
            ui.label(reach.ns.map_or_else(dash, |ns| words::time(ns.median)));
            ui.label(reach.ns.map_or_else(dash, |ns| {
                format!("{} to {}", words::time(ns.lower), words::time(ns.upper))
            }));
            ui.label(match (choice.best == Some(i), reach.extrapolated) {
                (true, false) => "cheapest",
                (true, true) => "cheapest, beyond the measured N",
                (false, true) => "beyond the measured N",
                (false, false) => "",
            });
            ui.end_row();
        }
    });
}

fn plot(ui: &mut Ui, trade: &TradeResult, choice: Option<&Choice>) {
    let dark = ui.visuals().dark_mode;
    let muted = ui.visuals().weak_text_color();
    log_log("trade", "time of one estimate, ns", "RMS error").show(ui, |plot| {
        if let Some(choice) = choice {
            let line = HLine::new("wanted error", choice.error.log10()).color(muted);
            plot.hline(line.style(LineStyle::dashed_dense()).allow_hover(false));
        }
        // Step by step, as all lines here: one line through sharp turns has false joints.
        for step in front(trade).windows(2) {
            let line = Line::new("Pareto front", step.to_vec()).color(muted).width(3.0);
            plot.line(line.allow_hover(false));
        }
        for sampler in &trade.samplers {
            let colour = colours::sampler(sampler.name, dark);
            let points: Vec<_> = measured(sampler).map(place).collect();
            for step in points.windows(2) {
                let line = Line::new(sampler.name, step.to_vec()).color(colour).width(1.0);
                plot.line(line.allow_hover(false));
            }
            let bars = measured(sampler).map(|row| {
                let [low, high] = row.error.mse_ci95.map(|mse| 0.5 * mse.log10());
                [place(row)[0], low, high]
            });
            plot.add(Bars::upright(sampler.name, colour, bars));
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

/// Steps through the points that no other point beats in both time and error.
fn front(trade: &TradeResult) -> Vec<[f64; 2]> {
    let rows = trade.samplers.iter().flat_map(measured).filter(|row| row.pareto);
    let mut best: Vec<_> = rows.map(place).collect();
    best.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for at in best {
        if let Some([_, error]) = steps.last().copied() {
            steps.push([at[0], error]);
        }
        steps.push(at);
    }
    steps
}
