//! The help overlay: every key.

use eframe::egui::{self, Context, Grid, Key};

/// Keys and what they do.
const KEYS: &[(&str, &str)] = &[
    ("click, Shift+click", "study a pixel, compare it with others"),
    ("right click", "no longer study a pixel"),
    ("arrows, Shift+arrows", "move the studied pixel by 1, by 10"),
    ("wheel, drag, + and -", "zoom to the pointer, pan, zoom"),
    ("Ctrl+drag", "zoom to a rectangle"),
    ("F, Ctrl+0", "fit the picture, one point per pixel"),
    ("E, Shift+E, A", "exposure up, down, for the brightest"),
    ("O, M", "next overlay, start or cancel the map"),
    ("Space", "stop what is under way, run it again"),
    ("N, Shift+N", "inside and patterns: more samples, fewer"),
    ("S, T, Shift+T", "inside and patterns: next sampler, next trial, trial before"),
    ("arrows on the patterns page", "N and sampler, in place of the pixel"),
    ("C, Ctrl+V", "copy as command, open copied commands"),
    ("Ctrl+C", "copy x,y of the pixel"),
    ("Ctrl+O, F5", "open a scene, load it again"),
    ("Ctrl+S, Ctrl+E", "save the picture, the curve"),
    ("1, 2, 3, 4", "pixel, theory, trade, patterns page"),
    ("D, H, Esc", "dark or light, this help, close"),
];

/// Draws the overlay; false when it is to go.
pub fn ui(ctx: &Context) -> bool {
    let mut open = true;
    let window = egui::Window::new("Keys").collapsible(false).resizable(false);
    window.open(&mut open).anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
        Grid::new("keys").num_columns(2).spacing([24.0, 6.0]).striped(true).show(ui, |ui| {
            for (keys, meaning) in KEYS {
                ui.monospace(*keys);
                ui.label(*meaning);
                ui.end_row();
            }
        });
        ui.separator();
        ui.label(
            "The curve of a pixel is the variance of the mean over M trials against N samples. \
             Bars are 95 % intervals; p is the exponent of variance ~ C / N^p.",
        );
    });
    open && !ctx.input(|input| input.key_pressed(Key::Escape))
}
