//! How pixels and integrands are studied: samplers, counts, trials, seed.

use crate::actions::{COPY_LINE, Now, RESTART, STOP};
use crate::command::Command;
use crate::state::StudyWords;
use eframe::egui::{self, DragValue, TextEdit, Ui};
use stratcli::cli::StudiedChannel;
use stratcore::sampler::{CountPolicy, SHELF, Sampler};

/// The controls of a study. What is typed counts when the field is left.
#[derive(Default)]
pub struct StudyPanel {
    counts: CountsField,
}

/// A field of sample counts; what is typed counts when it is left.
#[derive(Default)]
pub struct CountsField {
    typed: String,
    /// The state's counts when `typed` was last taken from it.
    known: Option<String>,
}

impl CountsField {
    /// Draws the field. `default` is what empty stands for.
    pub fn ui(&mut self, ui: &mut Ui, name: &str, default: &str, counts: &mut String) {
        if self.known.as_ref() != Some(counts) {
            self.typed.clone_from(counts);
            self.known = Some(counts.clone());
        }
        let label = ui.label(name);
        let field = TextEdit::singleline(&mut self.typed).desired_width(76.0).hint_text(default);
        let response = ui.add(field).labelled_by(label.id);
        let response = response.on_hover_text(
            "sample counts N: 1..16^2, 2^0..2^12 or a list such as 1,4,16; empty for the default",
        );
        if response.lost_focus() {
            counts.clone_from(&self.typed);
        }
    }
}

impl StudyPanel {
    /// Draws the controls.
    pub fn ui(&mut self, ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
        let before = &now.state.study;
        let mut words = before.clone();
        let mut command = None;
        ui.horizontal_wrapped(|ui| {
            samplers_menu(ui, &mut words);
            self.counts.ui(ui, "counts", "1..16^2", &mut words.counts);
            number(ui, "M up to", DragValue::new(&mut words.trials).range(2..=1_000_000), |ui| {
                ui.label("the most trials of each estimate");
            });
            let until = DragValue::new(&mut words.until).range(0.0..=1.0).speed(0.001);
            number(ui, "until p ±", until.max_decimals(3), |ui| {
                ui.label("stop when the 95 % interval of every p is this tight; 0 uses all trials");
            });
            number(ui, "seed", DragValue::new(&mut words.seed), |ui| {
                ui.label("the same seed gives the same numbers");
            });
            let error = DragValue::new(&mut words.error).range(1e-6..=1.0).speed(0.0005);
            number(ui, "error", error.max_decimals(6), |ui| {
                ui.label("the standard error that \"samples needed\" is about, in radiance");
            });
            channel_box(ui, &mut words);
            policy_box(ui, &mut words);
            ui.separator();
            let is_busy = now.model.is_busy_on(now.state.page);
            let buttons = [if is_busy { STOP } else { RESTART }, COPY_LINE];
            for action in buttons {
                command = command.take().or(action.button(ui, now));
            }
        });
        if words != *before {
            command = Some(Command::SetStudy(words));
        }
        command
    }
}

fn number(ui: &mut Ui, words: &str, value: DragValue<'_>, hint: impl FnOnce(&mut Ui)) {
    let label = ui.label(words);
    ui.add(value).labelled_by(label.id).on_hover_ui(hint);
}

/// Samplers to compare, with the scramble of those that have a choice.
fn samplers_menu(ui: &mut Ui, words: &mut StudyWords) {
    let title = format!("Samplers ({})", words.samplers.len());
    let menu = egui::containers::menu::MenuConfig::new()
        .close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
    egui::containers::menu::MenuButton::new(title).config(menu).ui(ui, |ui| {
        egui::ScrollArea::vertical().max_height(460.0).show(ui, |ui| {
            for sampler in SHELF {
                ui.horizontal(|ui| sampler_line(ui, *sampler, words));
            }
            // A file of points has no place on the shelf, but can be pasted.
            let is_more = words.samplers.len() > 1;
            for other in words.samplers.clone() {
                if is_more
                    && other.starts_with("file:")
                    && ui.button(format!("Remove {other}")).clicked()
                {
                    words.samplers.retain(|name| *name != other);
                }
            }
        });
    });
}

fn sampler_line(ui: &mut Ui, sampler: &dyn Sampler, words: &mut StudyWords) {
    let place = words.place_of(sampler.name());
    let mut chosen = place.is_some();
    let facts = sampler.facts();
    let hint = format!("{}\nN = {}\n{}", facts.summary, facts.counts, facts.source);
    if ui.checkbox(&mut chosen, sampler.name()).on_hover_text(hint).changed()
        && let Some(switched) = words.with_sampler_switched(sampler.name())
    {
        *words = switched;
    }
    let usable = sampler.scrambles().iter().filter(|scramble| sampler.is_randomised(**scramble));
    let scrambles: Vec<_> = usable.map(ToString::to_string).collect();
    let place = words.place_of(sampler.name());
    let Some(word) = place.and_then(|at| words.samplers.get_mut(at)) else { return };
    if scrambles.len() > 1 {
        let default = sampler.scrambles()[0].to_string();
        let mut scramble =
            word.split_once('+').map_or_else(|| default.clone(), |(_, s)| s.to_owned());
        egui::ComboBox::from_id_salt(sampler.name()).selected_text(&scramble).show_ui(ui, |ui| {
            for option in &scrambles {
                ui.selectable_value(&mut scramble, option.clone(), option);
            }
        });
        *word = if scramble == default {
            sampler.name().to_owned()
        } else {
            format!("{}+{scramble}", sampler.name())
        };
    }
}

fn channel_box(ui: &mut Ui, words: &mut StudyWords) {
    use clap::ValueEnum as _;
    egui::ComboBox::from_id_salt("channel").selected_text(&words.channel).show_ui(ui, |ui| {
        for channel in StudiedChannel::value_variants() {
            if let Some(value) = channel.to_possible_value() {
                let name = value.get_name().to_owned();
                ui.selectable_value(&mut words.channel, name.clone(), name);
            }
        }
    });
}

fn policy_box(ui: &mut Ui, words: &mut StudyWords) {
    let label = |policy| match policy {
        CountPolicy::Error => "exact N only",
        CountPolicy::Snap => "nearest N",
        CountPolicy::Rect => "unequal strata",
    };
    let shown = egui::ComboBox::from_id_salt("policy").selected_text(label(words.n_policy));
    let response = shown.show_ui(ui, |ui| {
        for policy in [CountPolicy::Snap, CountPolicy::Error, CountPolicy::Rect] {
            ui.selectable_value(&mut words.n_policy, policy, label(policy));
        }
    });
    response.response.on_hover_text("what to do with an N that a sampler cannot make");
}
