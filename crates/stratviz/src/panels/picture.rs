//! The picture: zoom, pan, hover, click.

use super::colours;
use super::legend;
use super::texture::TiledTexture;
use crate::command::Command;
use crate::jobs::Studied;
use crate::model::{Model, Progress};
use crate::state::{Overlay, PictureWords, State};
use eframe::egui::{
    self, Align2, Color32, FontId, Key, Painter, Pos2, Rect, Response, Sense, Stroke, StrokeKind,
    Ui, Vec2, WidgetInfo, pos2, vec2,
};

/// From this many points per pixel on, the pixels are told apart by a grid.
const GRID_FROM: f32 = 12.0;
/// Points per pixel at the most.
const CLOSEST: f32 = 256.0;

/// What is looked at, and the textures.
pub struct PicturePanel {
    /// Points per pixel; none to fit the panel.
    scale: Option<f32>,
    /// The pixel coordinates in the middle of the panel.
    middle: Vec2,
    /// The panel's size in points when it was last drawn.
    size: Vec2,
    hovered: Option<[u32; 2]>,
    picture: TiledTexture<u64>,
    overlay: TiledTexture<(Overlay, u64)>,
}

impl Default for PicturePanel {
    fn default() -> Self {
        let (picture, overlay) = (TiledTexture::default(), TiledTexture::default());
        let (middle, size) = (Vec2::ZERO, Vec2::ZERO);
        Self { scale: None, middle, size, hovered: None, picture, overlay }
    }
}

impl PicturePanel {
    /// Draws the picture with its tools above and what is under the pointer below.
    pub fn ui(&mut self, ui: &mut Ui, state: &State, model: &Model) -> Option<Command> {
        let mut command = None;
        egui::Panel::top("picture tools").show(ui, |ui| {
            command = self.tools(ui, state, model);
        });
        egui::Panel::bottom("readout").exact_size(24.0).show(ui, |ui| {
            ui.horizontal_centered(|ui| self.readout(ui, model));
        });
        let frame = egui::Frame::new().fill(ui.visuals().extreme_bg_color);
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            if let Some(clicked) = self.canvas(ui, state, model) {
                command = Some(clicked);
            }
        });
        command
    }

    fn tools(&mut self, ui: &mut Ui, state: &State, model: &Model) -> Option<Command> {
        let mut words = state.picture.clone();
        let mut command = None;
        ui.horizontal_wrapped(|ui| {
            if ui.button("Fit").on_hover_text("the whole picture (F)").clicked() {
                self.scale = None;
            }
            if ui.button("1:1").on_hover_text("one point per pixel (Ctrl+0)").clicked() {
                self.scale = Some(1.0);
            }
            ui.separator();
            let stops = egui::DragValue::new(&mut words.exposure)
                .range(-20.0..=20.0)
                .speed(0.05)
                .fixed_decimals(1)
                .prefix("exposure ");
            ui.add(stops).on_hover_text("stops; E and Shift+E");
            let spp = egui::DragValue::new(&mut words.spp).range(1..=4096).suffix(" spp");
            ui.add(spp).on_hover_text("samples per pixel of the finished picture");
            ui.separator();
            egui::ComboBox::from_id_salt("overlay").selected_text(words.overlay.label()).show_ui(
                ui,
                |ui| {
                    for overlay in Overlay::ALL {
                        ui.selectable_value(&mut words.overlay, overlay, overlay.label());
                    }
                },
            );
            if words.overlay != Overlay::Off {
                let slider = egui::Slider::new(&mut words.opacity, 0.0..=1.0).show_value(false);
                ui.add(slider).on_hover_text("how much the overlay covers");
            }
            command = map_button(ui, state, model);
        });
        if words != state.picture {
            command = Some(Command::SetPicture(words));
        }
        command
    }

    /// What is under the pointer.
    fn readout(&self, ui: &mut Ui, model: &Model) {
        let Some(pixel) = self.hovered else {
            let words = match &model.picture_progress {
                Progress::Failed(fault) => fault.clone(),
                Progress::Running(share) => format!("rendering, {:.0} %", share * 100.0),
                _ => "click a pixel to study it, Shift-click to compare".to_owned(),
            };
            ui.weak(words);
            return;
        };
        let [x, y] = pixel;
        ui.monospace(format!("x {x}  y {y}"));
        if let Some(rgb) = model.picture.at(pixel) {
            ui.monospace(format!("RGB {:.4} {:.4} {:.4}", rgb[0], rgb[1], rgb[2]));
        }
        match model.map.at(pixel).copied().flatten() {
            Some(Studied::Fitted { exponent, std_error, class, .. }) => {
                ui.monospace(format!("p {exponent:.2} ± {std_error:.2}  {class}"));
            }
            Some(Studied::Exact) => drop(ui.monospace("exact")),
            Some(Studied::Unfitted) => drop(ui.monospace("no fit")),
            None => {}
        }
    }

    fn canvas(&mut self, ui: &mut Ui, state: &State, model: &Model) -> Option<Command> {
        let (response, painter) = ui.allocate_painter(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Picture"));
        self.size = response.rect.size();
        let [width, height] = model.picture.size;
        if width == 0 || height == 0 {
            self.hovered = None;
            return None;
        }
        let size = vec2(width as f32, height as f32);
        let fit = (response.rect.size() / size).min_elem();
        self.navigate(ui, &response, size, fit);
        let scale = self.scale.unwrap_or(fit);
        if self.scale.is_none() {
            self.middle = size / 2.0;
        }
        let origin = response.rect.center() - self.middle * scale;
        self.paint_layers(ui, &painter, (origin, scale), state, model);
        if scale >= GRID_FROM {
            grid(&painter, origin, scale, [width, height]);
        }
        mark_studied(&painter, origin, scale, &state.pixels);
        if state.picture.overlay != Overlay::Off {
            legend::paint(&painter, response.rect, state);
        }
        let pixel_at = |at: Pos2| {
            let p = (at - origin) / scale;
            let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < size.x && p.y < size.y;
            inside.then_some([p.x as u32, p.y as u32])
        };
        self.hovered = response.hover_pos().and_then(pixel_at);
        let clicked = response.interact_pointer_pos().and_then(pixel_at)?;
        if response.secondary_clicked() {
            return Some(Command::Remove(clicked));
        }
        response.clicked().then(|| {
            let compare = ui.input(|input| input.modifiers.shift);
            if compare { Command::Compare(clicked) } else { Command::Study(clicked) }
        })
    }

    /// Wheel and pinch zoom to the pointer, dragging pans, keys do both.
    fn navigate(&mut self, ui: &Ui, response: &Response, size: Vec2, fit: f32) {
        let scale = self.scale.unwrap_or(fit);
        if response.dragged() && response.drag_delta() != Vec2::ZERO {
            self.scale = Some(scale);
            self.middle -= response.drag_delta() / scale;
        }
        let mut zoom = 1.0;
        let mut about = response.rect.center();
        if let Some(pointer) = response.hover_pos() {
            let [wheel, pinch] = ui.input(|i| [i.smooth_scroll_delta.y, i.zoom_delta()]);
            zoom = pinch * (wheel * 0.005).exp();
            about = pointer;
        }
        if !ui.ctx().text_edit_focused() {
            ui.input(|input| {
                let pressed = |key| input.key_pressed(key) && !input.modifiers.command;
                if pressed(Key::Plus) || pressed(Key::Equals) {
                    (zoom, about) = (1.5, response.rect.center());
                }
                if pressed(Key::Minus) {
                    (zoom, about) = (1.0 / 1.5, response.rect.center());
                }
                if pressed(Key::F) {
                    self.scale = None;
                }
                if input.modifiers.command && input.key_pressed(Key::Num0) {
                    self.scale = Some(1.0);
                }
            });
        }
        if zoom != 1.0 {
            let new = (scale * zoom).clamp(fit.min(1.0) / 4.0, CLOSEST);
            let off = about - response.rect.center();
            self.middle += off / scale - off / new;
            self.scale = Some(new);
        }
        self.middle = self.middle.clamp(Vec2::ZERO, size);
    }

    /// Moves the view so that a pixel can be seen.
    pub fn reveal(&mut self, [x, y]: [u32; 2]) {
        let Some(scale) = self.scale else { return };
        let half = self.size / (2.0 * scale) - Vec2::splat(1.0);
        let at = vec2(x as f32 + 0.5, y as f32 + 0.5);
        let off = at - self.middle;
        self.middle += off - off.clamp(-half.max(Vec2::ZERO), half.max(Vec2::ZERO));
    }

    fn paint_layers(
        &mut self,
        ui: &Ui,
        painter: &Painter,
        (origin, scale): (Pos2, f32),
        state: &State,
        model: &Model,
    ) {
        let PictureWords { exposure, overlay, opacity, .. } = state.picture;
        let gain = exposure.exp2();
        self.picture
            .update(ui.ctx(), &model.picture, exposure.to_bits(), |rgb| colours::screen(rgb, gain));
        self.picture.paint(painter, origin, scale, Color32::WHITE);
        if overlay != Overlay::Off {
            let error = state.study.error;
            let key = (overlay, error.to_bits());
            self.overlay
                .update(ui.ctx(), &model.map, key, |cell| colours::overlay(cell, overlay, error));
            self.overlay.paint(painter, origin, scale, Color32::WHITE.gamma_multiply(opacity));
        }
    }
}

/// Starts and stops the map, and tells how far it is.
fn map_button(ui: &mut Ui, state: &State, model: &Model) -> Option<Command> {
    let clicked = |ui: &mut Ui, words: &str, hint: &str, command| {
        ui.button(words).on_hover_text(hint).clicked().then_some(command)
    };
    model.loaded.as_ref()?;
    match &model.map_progress {
        Progress::Running(share) => {
            let command =
                clicked(ui, "Cancel map", "keep what is finished (M)", Command::CancelMap);
            ui.add(egui::ProgressBar::new(*share).desired_width(90.0).show_percentage());
            command
        }
        Progress::Failed(fault) => {
            let command = clicked(ui, "Map", "try again (M)", Command::StartMap);
            ui.colored_label(ui.visuals().error_fg_color, fault);
            command
        }
        progress => {
            let hint = "study every pixel under jittered, coarse to fine (M)";
            let command = clicked(ui, "Map", hint, Command::StartMap);
            if let Progress::Stopped(share) = progress
                && state.picture.overlay != Overlay::Off
            {
                ui.weak(format!("stopped at {:.0} %", share * 100.0));
            }
            command
        }
    }
}

fn grid(painter: &Painter, origin: Pos2, scale: f32, [width, height]: [u32; 2]) {
    let area = painter.clip_rect();
    let whole = Rect::from_min_size(origin, vec2(width as f32, height as f32) * scale);
    let area = area.intersect(whole);
    let stroke = Stroke::new(0.5, Color32::from_white_alpha(40));
    let lines = |lo: f32, hi: f32, from: f32| {
        let first = ((lo - from) / scale).ceil() as i64;
        let last = ((hi - from) / scale).floor() as i64;
        (first..=last).map(move |i| from + i as f32 * scale)
    };
    for x in lines(area.left(), area.right(), origin.x) {
        painter.vline(x, area.y_range(), stroke);
    }
    for y in lines(area.top(), area.bottom(), origin.y) {
        painter.hline(area.x_range(), y, stroke);
    }
}

/// A frame round each studied pixel, large enough to be seen, and its number among several.
fn mark_studied(painter: &Painter, origin: Pos2, scale: f32, pixels: &[[u32; 2]]) {
    const SMALLEST: f32 = 9.0;
    for (i, [x, y]) in pixels.iter().enumerate() {
        let centre = origin + vec2(*x as f32 + 0.5, *y as f32 + 0.5) * scale;
        let rect = Rect::from_center_size(centre, Vec2::splat(scale.max(SMALLEST)));
        painter.rect_stroke(rect, 0.0, Stroke::new(3.0, Color32::BLACK), StrokeKind::Outside);
        painter.rect_stroke(rect, 0.0, Stroke::new(1.5, Color32::WHITE), StrokeKind::Outside);
        if pixels.len() > 1 {
            let at = pos2(rect.right() + 5.0, rect.center().y);
            let font = FontId::proportional(14.0);
            for (offset, colour) in [(1.0, Color32::BLACK), (0.0, Color32::WHITE)] {
                let at = at + Vec2::splat(offset);
                painter.text(at, Align2::LEFT_CENTER, i + 1, font.clone(), colour);
            }
        }
    }
}
