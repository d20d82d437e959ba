//! Point sets by themselves: one of them, its power spectrum, radial means, discrepancies.

mod discrepancy;
mod points;
mod power;

use super::colours;
use super::study::CountsField;
use crate::actions::{
    ALL_PAIRS, FEWER, FEWER_DIMENSIONS, MORE, MORE_DIMENSIONS, NEXT_AXES, NEXT_SAMPLER, NEXT_TRIAL,
    Now, STRATA,
};
use crate::command::Command;
use crate::model::{Model, Progress};
use crate::state::PatternWords;
use eframe::egui::{
    self, Align, ComboBox, DragValue, Label, Layout, Rect, RichText, Sense, Ui, UiBuilder,
    WidgetInfo, vec2,
};
use power::PowerPicture;
use stratcli::report::chart::label;
use stratcli::table::with_error;
use stratcore::discrepancy::Measure;

/// Between the four fields, in points.
const GAP: f32 = 10.0;

/// Dots in one picture, at the most.
pub const MOST_POINTS: u64 = 1 << 14;

/// Holds the power of one sampler on the GPU, and the counts while they are typed.
#[derive(Default)]
pub struct PatternsPanel {
    counts: CountsField,
    power: PowerPicture,
}

impl PatternsPanel {
    /// Draws the patterns page.
    pub fn ui(&mut self, ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
        let Now { state, model, .. } = *now;
        let mut words = state.patterns.clone();
        let mut command = None;
        ui.horizontal_wrapped(|ui| command = self.controls(ui, now, &mut words));
        legend(ui, model);
        let area = ui.available_rect_before_wrap();
        let size = (area.size() - vec2(GAP, GAP)) / 2.0;
        let cell = |column: f32, row: f32| {
            Rect::from_min_size(area.min + (size + vec2(GAP, GAP)) * vec2(column, row), size)
        };
        let place = state.pattern_place();
        field(ui, cell(0.0, 0.0), |ui| points::ui(ui, state, &model.drawn));
        field(ui, cell(1.0, 0.0), |ui| self.power.ui(ui, place, &model.spectra));
        field(ui, cell(0.0, 1.0), |ui| power::radial(ui, &model.spectra));
        field(ui, cell(1.0, 1.0), |ui| discrepancy::ui(ui, &state.patterns, &model.discrepancy));
        ui.allocate_rect(area, Sense::hover());
        if words != state.patterns { Some(Command::SetPatterns(words)) } else { command }
    }

    fn controls(
        &mut self,
        ui: &mut Ui,
        now: &Now<'_>,
        words: &mut PatternWords,
    ) -> Option<Command> {
        let state = now.state;
        let hint = |actions: &[crate::actions::Action]| {
            actions.iter().map(|action| action.hint(state.page)).collect::<Vec<_>>().join("\n")
        };
        let mut command = None;
        let sampler = state.pattern_sampler().to_owned();
        let shown = ComboBox::from_id_salt("pattern sampler").selected_text(&sampler);
        let shown = shown.show_ui(ui, |ui| {
            for name in &state.study.samplers {
                ui.selectable_value(&mut words.sampler, name.clone(), name);
            }
        });
        shown.response.on_hover_text(hint(&[NEXT_SAMPLER]));
        let label = ui.label("N");
        let n = DragValue::new(&mut words.n).range(1..=MOST_POINTS).speed(1.0);
        ui.add(n).labelled_by(label.id).on_hover_text(hint(&[MORE, FEWER]));
        let label = ui.label("d");
        let mut dim = words.dim;
        let [least, most] = PatternWords::DIMENSIONS;
        let slider = DragValue::new(&mut dim).range(least..=most).speed(0.05);
        let dims = ui.add(slider).labelled_by(label.id);
        dims.on_hover_text(hint(&[MORE_DIMENSIONS, FEWER_DIMENSIONS]));
        if dim != words.dim {
            *words = words.clone().in_dim(dim);
        }
        if words.dim > 2 {
            command = axes(ui, now, words);
        }
        let label = ui.label("trial");
        let trial = ui.add(DragValue::new(&mut words.trial)).labelled_by(label.id);
        trial.on_hover_text(hint(&[NEXT_TRIAL]));
        let label = ui.label("sets");
        let sets = DragValue::new(&mut words.sets).range(1..=10_000);
        let about = "how many sets spectra and discrepancies are the means of";
        ui.add(sets).labelled_by(label.id).on_hover_text(about);
        let shown = ComboBox::from_id_salt("measure").selected_text(&words.measure);
        let shown = shown.show_ui(ui, |ui| {
            for measure in Measure::ALL.iter().filter(|m| m.check(words.dim).is_ok()) {
                let name = measure.name().to_owned();
                let value = ui.selectable_value(&mut words.measure, name, measure.name());
                value.on_hover_text(measure.summary());
            }
        });
        shown.response.on_hover_text("the discrepancy that is measured");
        self.counts.ui(ui, "at N", "2..16^2", &mut words.counts);
        command.or(STRATA.button(ui, now))
    }
}

/// Which two dimensions are seen, or all pairs.
fn axes(ui: &mut Ui, now: &Now<'_>, words: &mut PatternWords) -> Option<Command> {
    let label = ui.label("axes");
    let before = words.axes;
    let hint = format!("the two dimensions seen, from 0\n{}", NEXT_AXES.hint(now.state.page));
    for axis in &mut words.axes {
        let axis = DragValue::new(axis).range(0..=words.dim - 1).speed(0.05);
        ui.add(axis).labelled_by(label.id).on_hover_text(&hint);
    }
    if words.axes[0] == words.axes[1] {
        words.axes = before;
    }
    ALL_PAIRS.button(ui, now)
}

/// A part of the page, clipped to its place.
fn field(ui: &mut Ui, place: Rect, draw: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        ui.set_clip_rect(place.expand(2.0).intersect(ui.clip_rect()));
        draw(ui);
    });
}

/// What a field shows, and how far it is.
fn caption(ui: &mut Ui, title: &str, about: &str, progress: &Progress) {
    ui.horizontal(|ui| {
        ui.strong(title);
        ui.weak(about);
        match progress {
            Progress::Running(share) => {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    ui.spinner();
                    ui.weak(format!("{:.0} %", 100.0 * share));
                });
            }
            Progress::Stopped(share) => drop(ui.weak(format!("stopped at {:.0} %", 100.0 * share))),
            Progress::Idle | Progress::Done | Progress::Failed(_) => {}
        }
    });
    if let Progress::Failed(fault) = progress {
        ui.colored_label(ui.visuals().error_fg_color, fault);
    }
}

/// The largest square that there is room for, in the middle.
fn square(ui: &mut Ui, name: &str) -> Rect {
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, name));
    let side = area.size().min_elem() - 2.0;
    Rect::from_center_size(area.center(), vec2(side, side))
}

/// Key to the samplers: their colours, and the exponents of their discrepancies.
fn legend(ui: &mut Ui, model: &Model) {
    let dark = ui.visuals().dark_mode;
    let curves = model.discrepancy.result.iter().flatten();
    let spectra = model.spectra.result.iter().flatten();
    let known: Vec<_> = curves.map(|c| (c.sampler, c.scramble, c.fit)).collect();
    let others = spectra.map(|s| (s.name, s.scramble, None)).skip(known.len());
    ui.horizontal_wrapped(|ui| {
        for (name, scramble, fit) in known.iter().copied().chain(others) {
            let colour = colours::sampler(name, dark);
            // One label each: what does not fit goes to the next row as a whole.
            let mut text = label(name, scramble);
            if let Some(fit) = fit {
                text += &format!("  p = {}", with_error(fit.exponent, fit.std_error));
            }
            let text = Label::new(RichText::new(text).color(colour)).extend();
            ui.add(text).on_hover_text("discrepancy falls as N^-p");
            ui.add_space(6.0);
        }
    });
}
