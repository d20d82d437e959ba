//! The help overlay: every key, as the table of actions has them.

use crate::actions::Menu;
use eframe::egui::{self, Context, Grid, Key, RichText, ScrollArea, Ui};

/// What the pointer does, which no key does.
const POINTER: &[(&str, &str)] = &[
    ("click, Shift+click", "study a pixel, compare it"),
    ("right click", "no longer study a pixel"),
    ("wheel, drag", "zoom to the pointer, pan"),
    ("Ctrl+drag", "zoom to a rectangle"),
    ("drop a file", "open a scene"),
];

/// Menus in the columns of the overlay.
const COLUMNS: [&[Menu]; 3] =
    [&[Menu::File, Menu::View], &[Menu::Study], &[Menu::Picture, Menu::Points]];

/// Draws the overlay; false when it is to go.
pub fn ui(ctx: &Context) -> bool {
    let mut open = true;
    let window = egui::Window::new("Keys").collapsible(false).resizable(false);
    window.open(&mut open).anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        ScrollArea::both().max_height(ctx.content_rect().height() - 150.0).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                for menus in COLUMNS {
                    ui.vertical(|ui| column(ui, menus));
                    ui.add_space(16.0);
                }
            });
        });
        ui.separator();
        ui.label(
            "The curve of a pixel is the variance of the mean over M trials against N samples. \
             Bars are 95 % intervals; p is the exponent of variance ~ C / N^p.",
        );
    });
    open && !ctx.input(|input| input.key_pressed(Key::Escape))
}

fn column(ui: &mut Ui, menus: &[Menu]) {
    ui.spacing_mut().item_spacing.y = 2.0;
    for (menu, title) in Menu::ALL.iter().filter(|(menu, _)| menus.contains(menu)) {
        let with_keys = menu.actions().filter(|action| !action.triggers.is_empty());
        let rows = with_keys.map(|action| (action.keys(None), action.name, action.about));
        table(ui, title, rows);
    }
    if menus.contains(&Menu::Study) {
        let rows = POINTER.iter().map(|(keys, meaning)| ((*keys).to_owned(), *meaning, ""));
        table(ui, "Pointer", rows);
    }
}

fn table<'a>(ui: &mut Ui, title: &str, rows: impl Iterator<Item = (String, &'a str, &'a str)>) {
    ui.add_space(6.0);
    ui.strong(title);
    Grid::new(title).num_columns(2).spacing([12.0, 2.0]).striped(true).show(ui, |ui| {
        for (keys, meaning, about) in rows {
            ui.label(RichText::new(keys).monospace().size(11.5));
            let meaning = ui.label(RichText::new(meaning).size(12.5));
            if !about.is_empty() {
                meaning.on_hover_text(about);
            }
            ui.end_row();
        }
    });
}
