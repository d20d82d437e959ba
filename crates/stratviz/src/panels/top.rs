//! The menu, the pages, and what was done last.

use super::dialogs::Dialog;
use crate::command::Command;
use crate::model::Model;
use crate::state::{Page, State};
use eframe::egui::{self, Align, Layout, Ui};
use stratcore::scene::library::SCENES;

/// What the menu asks for.
pub enum Wish {
    /// To be done at once.
    Do(Command),
    /// A question first.
    Ask(Dialog),
    /// To end.
    Quit,
}

/// Draws the bar at the top.
pub fn ui(ui: &mut Ui, state: &State, model: &Model) -> Option<Wish> {
    let mut wish = None;
    egui::MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| wish = file_menu(ui, state));
        ui.menu_button("View", |ui| {
            let words = if state.dark { "Light (D)" } else { "Dark (D)" };
            if ui.button(words).clicked() {
                wish = Some(Wish::Do(Command::SetDark(!state.dark)));
            }
        });
        if ui.button("Help").on_hover_text("H").clicked() {
            wish = Some(Wish::Do(Command::ShowHelp(true)));
        }
        ui.separator();
        for (page, words) in Page::ALL {
            if ui.selectable_label(state.page == page, words).clicked() {
                wish = Some(Wish::Do(Command::ShowPage(page)));
            }
        }
        ui.separator();
        scene_line(ui, model);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(times) = model.frame_times.longest() {
                let [panels, frame] = times.map(|time| time.as_secs_f64() * 1e3);
                let words = format!("panels {panels:.1} ms, frame {frame:.1} ms");
                ui.weak(words).on_hover_text(
                    "the longest of the last 120 frames, in CPU time of the window's thread: what \
                     the panels took, and the whole with painting",
                );
            }
        });
    });
    if let Some(fault) = &model.scene_fault {
        ui.horizontal_wrapped(|ui| {
            ui.colored_label(ui.visuals().error_fg_color, format!("cannot open: {fault}"));
        });
    }
    if let Some(notice) = &model.notice {
        let colour =
            if notice.is_fault { ui.visuals().error_fg_color } else { ui.visuals().text_color() };
        ui.horizontal_wrapped(|ui| ui.colored_label(colour, &notice.text));
    }
    wish
}

/// Which scene is open, and what its loader remarked.
fn scene_line(ui: &mut Ui, model: &Model) {
    if let Some(spec) = &model.loading {
        ui.spinner();
        ui.label(format!("loading {spec}"));
    } else if let Some(loaded) = &model.loaded {
        let scene = loaded.traced.scene();
        let [width, height] = scene.camera.resolution;
        let triangles = scene.mesh.triangles.len();
        ui.label(format!("{}: {width} × {height}, {triangles} triangles", scene.name));
        if !scene.notes.is_empty() {
            ui.weak(format!("{} remarks", scene.notes.len())).on_hover_text(scene.notes.join("\n"));
        }
    }
}

fn file_menu(ui: &mut Ui, state: &State) -> Option<Wish> {
    let mut wish = None;
    if ui.button("Open… (Ctrl+O)").clicked() {
        wish = Some(Wish::Ask(Dialog::open(state)));
    }
    ui.menu_button("Built-in", |ui| {
        for scene in SCENES {
            if ui.button(scene.name).on_hover_text(scene.summary).clicked() {
                wish = Some(Wish::Do(Command::Open(scene.name.to_owned())));
            }
        }
    });
    ui.add_enabled_ui(!state.recent.is_empty(), |ui| {
        ui.menu_button("Recent", |ui| {
            for spec in &state.recent {
                if ui.button(spec).clicked() {
                    wish = Some(Wish::Do(Command::Open(spec.clone())));
                }
            }
        });
    });
    if ui.button("Reload (F5)").clicked() {
        wish = Some(Wish::Do(Command::Reload));
    }
    ui.separator();
    let mut dialogs = vec![Dialog::save_picture(state), Dialog::save_curve(state)];
    if state.page == Page::Patterns {
        dialogs.push(Dialog::save_discrepancies());
    }
    dialogs.push(Dialog::open_line());
    for dialog in dialogs {
        let key = dialog.key().map_or_else(String::new, |key| format!(" ({key})"));
        if ui.button(format!("{}…{key}", dialog.title())).clicked() {
            wish = Some(Wish::Ask(dialog));
        }
    }
    ui.separator();
    if ui.button("Quit").clicked() {
        wish = Some(Wish::Quit);
    }
    wish
}
