//! Which part of the picture is seen, and how large.

use eframe::egui::{Pos2, Rect, Vec2, vec2};

/// Points per pixel at the most.
const CLOSEST: f32 = 256.0;

/// Maps pixels to points of the window.
pub struct View {
    /// Points per pixel; none to fit the panel.
    scale: Option<f32>,
    /// The pixel coordinates in the middle of the panel.
    middle: Vec2,
    /// The panel.
    area: Rect,
    /// Width and height of the picture.
    size: Vec2,
}

impl Default for View {
    fn default() -> Self {
        Self { scale: None, middle: Vec2::ZERO, area: Rect::ZERO, size: Vec2::splat(1.0) }
    }
}

impl View {
    /// Notes where the panel is, and the size of the picture.
    pub fn place(&mut self, area: Rect, size: [u32; 2]) {
        (self.area, self.size) = (area, vec2(size[0] as f32, size[1] as f32));
        if self.scale.is_none() {
            self.middle = self.size / 2.0;
        }
        self.middle = self.middle.clamp(Vec2::ZERO, self.size);
    }

    fn fitting(&self) -> f32 {
        (self.area.size() / self.size).min_elem()
    }

    /// Points per pixel.
    pub fn scale(&self) -> f32 {
        self.scale.unwrap_or_else(|| self.fitting())
    }

    /// The point of the picture's top left corner.
    pub fn origin(&self) -> Pos2 {
        self.area.center() - self.middle * self.scale()
    }

    /// The points of the whole picture.
    pub fn whole(&self) -> Rect {
        Rect::from_min_size(self.origin(), self.size * self.scale())
    }

    /// The points of a pixel.
    pub fn rect_of(&self, [x, y]: [u32; 2]) -> Rect {
        let min = self.origin() + vec2(x as f32, y as f32) * self.scale();
        Rect::from_min_size(min, Vec2::splat(self.scale()))
    }

    /// The pixel at a point.
    pub fn pixel_at(&self, at: Pos2) -> Option<[u32; 2]> {
        let p = (at - self.origin()) / self.scale();
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < self.size.x && p.y < self.size.y;
        inside.then_some([p.x as u32, p.y as u32])
    }

    /// Shows the whole picture.
    pub fn fit(&mut self) {
        self.scale = None;
        self.middle = self.size / 2.0;
    }

    /// Shows so many points per pixel.
    pub fn set_scale(&mut self, scale: f32) {
        self.scale = Some(scale);
    }

    /// Moves the picture by so many points.
    pub fn pan(&mut self, by: Vec2) {
        if by != Vec2::ZERO {
            self.scale = Some(self.scale());
            self.middle = (self.middle - by / self.scale()).clamp(Vec2::ZERO, self.size);
        }
    }

    /// Enlarges by a factor, while what is at `about` stays there.
    pub fn zoom(&mut self, factor: f32, about: Pos2) {
        if factor == 1.0 {
            return;
        }
        let scale = self.scale();
        let new = (scale * factor).clamp(self.fitting().min(1.0) / 4.0, CLOSEST);
        let off = about - self.area.center();
        self.middle = (self.middle + off / scale - off / new).clamp(Vec2::ZERO, self.size);
        self.scale = Some(new);
    }

    /// Enlarges by a factor, while the middle of the panel stays there.
    pub fn zoom_about_middle(&mut self, factor: f32) {
        self.zoom(factor, self.area.center());
    }

    /// Fills the panel with what is in a rectangle.
    pub fn zoom_to(&mut self, rectangle: Rect) {
        let scale = self.scale();
        self.middle += (rectangle.center() - self.area.center()) / scale;
        self.middle = self.middle.clamp(Vec2::ZERO, self.size);
        let factor = (self.area.size() / rectangle.size()).min_elem();
        self.scale = Some((scale * factor).min(CLOSEST));
    }

    /// Moves so that a pixel can be seen.
    pub fn reveal(&mut self, [x, y]: [u32; 2]) {
        let Some(scale) = self.scale else { return };
        let half = (self.area.size() / (2.0 * scale) - Vec2::splat(1.0)).max(Vec2::ZERO);
        let off = vec2(x as f32 + 0.5, y as f32 + 0.5) - self.middle;
        self.middle += off - off.clamp(-half, half);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    fn view() -> View {
        let mut view = View::default();
        view.place(Rect::from_min_size(pos2(100.0, 50.0), vec2(400.0, 200.0)), [100, 100]);
        view
    }

    #[test]
    fn the_whole_picture_fits_and_lies_in_the_middle() {
        let view = view();
        assert_eq!(view.scale(), 2.0);
        assert_eq!(view.whole().center(), pos2(300.0, 150.0));
        assert_eq!(view.pixel_at(pos2(200.5, 50.5)), Some([0, 0]));
        assert_eq!(view.pixel_at(pos2(199.0, 60.0)), None);
    }

    #[test]
    fn what_is_under_the_pointer_stays_there() {
        let mut view = view();
        let at = pos2(231.0, 77.0);
        let before = (at - view.origin()) / view.scale();
        view.zoom(8.0, at);
        let after = (at - view.origin()) / view.scale();
        assert!((before - after).length() < 1e-3, "{before} {after}");
    }

    #[test]
    fn a_rectangle_fills_the_panel() {
        let mut view = view();
        let pixels = view.rect_of([20, 30]).union(view.rect_of([29, 34]));
        view.zoom_to(pixels);
        assert_eq!(view.scale(), 40.0);
        let shown = view.rect_of([20, 30]).union(view.rect_of([29, 34]));
        assert!((shown.center() - view.area.center()).length() < 1e-3);
        view.reveal([90, 90]);
        assert!(view.area.contains_rect(view.rect_of([90, 90])));
    }
}
