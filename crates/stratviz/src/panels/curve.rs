//! The curves of the studied pixels, their exponents, and what they mean.

use super::{colours, plot};
use crate::actions::{FORGET_KEPT, Now};
use crate::command::Command;
use crate::model::Study;
use crate::words;
use eframe::egui::{self, Color32, Grid, RichText, Ui, vec2};
use stratcli::table::{short, with_error};
use stratcore::dimensions::Bound;
use stratcore::study::SamplerResult;

/// Draws the studies of the pixels.
pub fn ui(ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
    let Now { state, model, .. } = *now;
    let mut command = None;
    for study in &model.studies {
        let [x, y] = study.pixel;
        heading(ui, &format!("Pixel {x}, {y}"), study);
        if model.studies.len() == 1 {
            verdict(ui, study, state.study.error);
        }
    }
    if model.studies.is_empty() {
        ui.heading("Pixel");
        ui.label("Click a pixel of the picture, or move to one with the arrow keys.");
        return None;
    }
    let studies: Vec<_> = model.studies.iter().collect();
    egui::Panel::bottom("exponents").resizable(true).default_size(126.0).show(ui, |ui| {
        egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            if studies.iter().any(|study| !study.kept.is_empty()) {
                command = FORGET_KEPT.button(ui, now);
            }
            exponents(ui, &studies, state.study.error);
        });
    });
    plot::ui(ui, "curve", &studies);
    command
}

/// What is studied, and how far it is.
pub fn heading(ui: &mut Ui, title: &str, study: &Study) {
    ui.horizontal_wrapped(|ui| {
        ui.heading(title);
        if study.running {
            ui.spinner();
        }
        if let Some(result) = &study.result {
            ui.label(format!("M = {} trials", result.trials));
        }
        let state = match (study.running, study.stopped, &study.result) {
            (true, ..) => "tightening",
            (_, true, _) => "stopped",
            (_, _, Some(_)) => "done",
            _ => "",
        };
        ui.weak(state);
        if let Some(time) = study.first_curve {
            ui.weak(format!("first curve after {:.1} ms", time.as_secs_f64() * 1e3));
        }
    });
    if let Some(fault) = &study.fault {
        ui.colored_label(ui.visuals().error_fg_color, fault);
    }
}

/// The sentence about a study.
pub fn verdict(ui: &mut Ui, study: &Study, error: f64) {
    if let Some(result) = &study.result {
        ui.label(RichText::new(words::verdict(result, error)).strong());
    }
}

/// A row per curve: its key, exponent, prediction and cost.
pub fn exponents(ui: &mut Ui, studies: &[&Study], error: f64) {
    Grid::new("exponents").num_columns(6).spacing([14.0, 4.0]).striped(true).show(ui, |ui| {
        let needed = format!("N for error {error}");
        for title in ["sampler", "measured", "predicted", "class", &needed, "points"] {
            ui.weak(title);
        }
        ui.end_row();
        for (i, study) in studies.iter().enumerate() {
            let key = (studies.len() > 1).then_some(i);
            let current = study.result.iter().flat_map(|result| &result.samplers);
            for sampler in current {
                row(ui, sampler, key, None, error);
            }
            for (sampler, trials) in &study.kept {
                row(ui, sampler, key, Some(*trials), error);
            }
        }
    });
}

fn row(ui: &mut Ui, sampler: &SamplerResult, study: Option<usize>, kept: Option<u32>, error: f64) {
    let dash = || "-".to_owned();
    let colour = colours::sampler(sampler.name, ui.visuals().dark_mode);
    ui.horizontal(|ui| {
        swatch(ui, colour);
        let mut name = match study {
            Some(i) => format!("{}: {}", i + 1, sampler.name),
            None => sampler.name.to_owned(),
        };
        if sampler.scramble != stratcore::sampler::Scramble::None {
            name += &format!(" ({})", sampler.scramble);
        }
        if let Some(trials) = kept {
            name += &format!(", kept at M = {trials}");
        }
        ui.label(name);
    });
    ui.strong(match (&sampler.fit, sampler.exact) {
        (Some(fit), _) => format!("p = {}", with_error(fit.exponent, fit.std_error)),
        (None, true) => "exact".to_owned(),
        (None, false) => "no fit".to_owned(),
    });
    let sign = if sampler.predicted_bound == Some(Bound::AtLeast) { ">=" } else { "=" };
    ui.label(sampler.predicted.map_or_else(dash, |p| format!("p {sign} {}", short(p, 4))));
    ui.label(match (sampler.class, sampler.class_is_sure) {
        (Some(class), true) => class.to_string(),
        (Some(class), false) => format!("{class}?"),
        (None, _) => dash(),
    });
    let needed = words::needed(sampler, error);
    ui.label(needed.map_or_else(dash, words::count));
    let zero = sampler.rows.iter().filter(|row| row.variance_of_mean == 0.0).count();
    let points = sampler.rows.len() - zero;
    ui.label(match zero {
        0 => format!("{points}"),
        zero => format!("{points}, and {zero} with variance 0 left out"),
    });
    ui.end_row();
}

/// A square of a sampler's colour.
pub fn swatch(ui: &mut Ui, colour: Color32) {
    let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 2.0, colour);
}
