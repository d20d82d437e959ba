//! The menu, the pages, and what was done last.

use crate::actions::{Entry, HELP, Menu, Now, OPEN, built_in, overlays, recent};
use crate::command::Command;
use crate::model::Model;
use crate::state::Page;
use eframe::egui::{self, Align, Layout, Ui};

/// Draws the bar at the top.
pub fn ui(ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
    let Now { state, model, .. } = *now;
    let mut command = None;
    egui::MenuBar::new().ui(ui, |ui| {
        for (menu, title) in Menu::ALL {
            ui.menu_button(title, |ui| command = command.take().or(entries(ui, menu, now)));
        }
        command = command.take().or(HELP.button(ui, now));
        ui.separator();
        for (page, words) in Page::ALL {
            if ui.selectable_label(state.page == page, words).clicked() {
                command = Some(Command::ShowPage(page));
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
    command
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

/// What a menu holds, with the choices that depend on the session.
fn entries(ui: &mut Ui, menu: Menu, now: &Now<'_>) -> Option<Command> {
    let mut command = None;
    for action in menu.actions() {
        command = command.or(action.menu_entry(ui, now));
        if action.name == OPEN.name {
            let scenes =
                [("Built-in", built_in().collect()), ("Recent", recent(now.state).collect())];
            for (title, scenes) in scenes {
                command = command.or(submenu(ui, title, scenes));
            }
        }
    }
    if menu == Menu::Picture {
        command = command.or(submenu(ui, "Overlay", overlays(now.state).collect()));
    }
    command
}

fn submenu(ui: &mut Ui, title: &str, entries: Vec<Entry>) -> Option<Command> {
    let mut command = None;
    ui.add_enabled_ui(!entries.is_empty(), |ui| {
        ui.menu_button(title, |ui| {
            for entry in entries {
                if ui.button(&entry.name).on_hover_text(&entry.about).clicked() {
                    command = Some(entry.command);
                }
            }
        });
    });
    command
}
