//! The picture: zoom, pan, hover, click.

use super::colours;
use super::legend;
use super::numbers;
use super::texture::TiledTexture;
use super::view::View;
use crate::actions::{
    BRIGHTER, CANCEL_MAP, DARKER, FIT, MAP, NEXT_OVERLAY, NORMALISE, Now, ONE_TO_ONE,
};
use crate::command::{Command, Look};
use crate::jobs::Studied;
use crate::model::{Model, Progress};
use crate::state::{Overlay, PictureWords, State};
use eframe::egui::{
    self, Align2, Color32, FontId, Painter, PointerButton, Pos2, Rect, Response, Sense, Stroke,
    StrokeKind, Ui, Vec2, WidgetInfo, pos2,
};

/// From this many points per pixel on, the pixels are told apart by a grid.
const GRID_FROM: f32 = 12.0;
/// The smallest mark of a studied pixel, in points.
const MARK: Vec2 = Vec2::splat(9.0);

/// What is looked at, and the textures.
#[derive(Default)]
pub struct PicturePanel {
    view: View,
    hovered: Option<[u32; 2]>,
    /// Where a rectangle that is to be zoomed to was begun.
    corner: Option<Pos2>,
    picture: TiledTexture<u64>,
    overlay: TiledTexture<(Overlay, u64)>,
}

impl PicturePanel {
    /// Draws the picture with its tools above and what is under the pointer below.
    pub fn ui(&mut self, ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
        let Now { state, model, .. } = *now;
        let mut command = None;
        egui::Panel::top("picture tools").show(ui, |ui| command = tools(ui, now));
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

    /// The pixel under the pointer.
    pub fn hovered(&self) -> Option<[u32; 2]> {
        self.hovered
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
        let [width, height] = model.picture.size;
        if width == 0 || height == 0 {
            self.hovered = None;
            return None;
        }
        self.view.place(response.rect, [width, height]);
        let rectangle = self.rectangle(ui, &response);
        self.navigate(ui, &response, rectangle.is_some());
        self.paint_layers(ui, &painter, state, model);
        let view = &self.view;
        let scale = view.scale();
        if scale >= GRID_FROM {
            grid(&painter, view);
        }
        if scale >= numbers::FROM {
            numbers::paint(&painter, view, state, model);
        }
        mark_studied(&painter, view, &state.pixels);
        if state.picture.overlay != Overlay::Off {
            legend::paint(&painter, response.rect, state);
        }
        if let Some(rectangle) = rectangle {
            for (width, colour) in [(3.0, Color32::BLACK), (1.0, Color32::WHITE)] {
                let stroke = Stroke::new(width, colour);
                painter.rect_stroke(rectangle, 0.0, stroke, StrokeKind::Middle);
            }
        }
        self.hovered = response.hover_pos().and_then(|at| self.view.pixel_at(at));
        let clicked = response.interact_pointer_pos().and_then(|at| self.view.pixel_at(at))?;
        if response.secondary_clicked() {
            let at = response.interact_pointer_pos()?;
            let mark = |pixel: &[u32; 2]| {
                let pixel = self.view.rect_of(*pixel);
                Rect::from_center_size(pixel.center(), pixel.size().max(MARK))
            };
            let hit = state.pixels.iter().find(|pixel| mark(pixel).contains(at));
            return hit.copied().map(Command::Remove);
        }
        response.clicked().then(|| {
            let compare = ui.input(|input| input.modifiers.shift);
            if compare { Command::Compare(clicked) } else { Command::Study(clicked) }
        })
    }

    /// The rectangle that is dragged with Ctrl; zooms to it when it is let go.
    fn rectangle(&mut self, ui: &Ui, response: &Response) -> Option<Rect> {
        /// Points that are no rectangle yet.
        const LEAST: f32 = 4.0;
        if response.drag_started_by(PointerButton::Primary) && ui.input(|i| i.modifiers.command) {
            self.corner = ui.input(|input| input.pointer.press_origin());
        }
        let corner = self.corner?;
        let end = response.interact_pointer_pos().or(ui.ctx().pointer_latest_pos())?;
        let rectangle = Rect::from_two_pos(corner, end).intersect(response.rect);
        if ui.input(|input| input.pointer.any_down()) {
            return Some(rectangle);
        }
        self.corner = None;
        if rectangle.size().min_elem() >= LEAST {
            self.view.zoom_to(rectangle);
        }
        None
    }

    /// Wheel and pinch zoom to the pointer, dragging pans.
    fn navigate(&mut self, ui: &Ui, response: &Response, is_rectangle: bool) {
        if response.dragged() && !is_rectangle {
            self.view.pan(response.drag_delta());
        }
        if let Some(pointer) = response.hover_pos() {
            let [wheel, pinch] = ui.input(|i| [i.smooth_scroll_delta.y, i.zoom_delta()]);
            self.view.zoom(pinch * (wheel * 0.005).exp(), pointer);
        }
    }

    /// Looks at the picture in another way.
    pub fn look(&mut self, look: Look) {
        match look {
            Look::Fit => self.view.fit(),
            Look::OneToOne => self.view.set_scale(1.0),
            Look::Closer => self.view.zoom_about_middle(1.5),
            Look::Farther => self.view.zoom_about_middle(1.0 / 1.5),
        }
    }

    /// Moves the view so that a pixel can be seen.
    pub fn reveal(&mut self, pixel: [u32; 2]) {
        self.view.reveal(pixel);
    }

    fn paint_layers(&mut self, ui: &Ui, painter: &Painter, state: &State, model: &Model) {
        let (origin, scale) = (self.view.origin(), self.view.scale());
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

/// The view, the exposure, what lies over the picture.
fn tools(ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
    let before = &now.state.picture;
    let mut words = before.clone();
    let mut command = None;
    ui.horizontal_wrapped(|ui| {
        for action in [FIT, ONE_TO_ONE] {
            command = command.take().or(action.button(ui, now));
        }
        ui.separator();
        let stops = egui::DragValue::new(&mut words.exposure)
            .range(-20.0..=20.0)
            .speed(0.05)
            .fixed_decimals(1)
            .prefix("exposure ");
        ui.add(stops).on_hover_text(format!(
            "stops ({}, {})",
            BRIGHTER.keys(None),
            DARKER.keys(None)
        ));
        command = command.take().or(NORMALISE.button(ui, now));
        let spp = egui::DragValue::new(&mut words.spp).range(1..=4096).suffix(" spp");
        ui.add(spp).on_hover_text("samples per pixel of the finished picture");
        ui.separator();
        let shown = egui::ComboBox::from_id_salt("overlay").selected_text(words.overlay.label());
        let shown = shown.show_ui(ui, |ui| {
            for overlay in Overlay::ALL {
                ui.selectable_value(&mut words.overlay, overlay, overlay.label());
            }
        });
        shown.response.on_hover_text(NEXT_OVERLAY.hint(now.state.page));
        if words.overlay != Overlay::Off {
            let mut percent = 100.0 * words.opacity;
            let covers = egui::DragValue::new(&mut percent).range(0.0..=100.0).suffix(" %");
            let covers = covers.fixed_decimals(0);
            if ui.add(covers).on_hover_text("how much the overlay covers").changed() {
                words.opacity = percent / 100.0;
            }
        }
        command = command.take().or(map_button(ui, now));
    });
    if words != *before { Some(Command::SetPicture(words)) } else { command }
}

/// Starts and stops the map, and tells how far it is.
fn map_button(ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
    match &now.model.map_progress {
        Progress::Running(share) => {
            let command = CANCEL_MAP.button(ui, now);
            ui.add(egui::ProgressBar::new(*share).desired_width(90.0).show_percentage());
            command
        }
        progress => {
            let command = MAP.button(ui, now);
            match progress {
                Progress::Failed(fault) => {
                    ui.colored_label(ui.visuals().error_fg_color, fault);
                }
                Progress::Stopped(share) if now.state.picture.overlay != Overlay::Off => {
                    ui.weak(format!("stopped at {:.0} %", share * 100.0));
                }
                _ => {}
            }
            command
        }
    }
}

fn grid(painter: &Painter, view: &View) {
    let whole = view.whole();
    let area = painter.clip_rect().intersect(whole);
    let (origin, scale) = (view.origin(), view.scale());
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
fn mark_studied(painter: &Painter, view: &View, pixels: &[[u32; 2]]) {
    for (i, pixel) in pixels.iter().enumerate() {
        let pixel = view.rect_of(*pixel);
        let rect = Rect::from_center_size(pixel.center(), pixel.size().max(MARK));
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
