//! The key to the overlay, in the picture's corner.

use super::colours::{MISSING, SAMPLES_SCALE, class_colour, exponent_colour, samples_colour};
use crate::state::{Overlay, State};
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};
use stratcore::theory::Class;

const ROW: f32 = 18.0;
const BAR: f32 = 14.0;
const TALL: f32 = 120.0;

/// Draws the key to what lies over the picture.
pub fn paint(painter: &Painter, area: Rect, state: &State) {
    let error = state.study.error;
    let (title, height) = match state.picture.overlay {
        Overlay::Off => return,
        Overlay::Exponent => ("p under jittered".to_owned(), TALL + ROW),
        Overlay::Class => ("under jittered".to_owned(), 5.0 * ROW),
        Overlay::Samples => (format!("samples for error {error}"), TALL + ROW),
    };
    let size = vec2(148.0, height + 44.0);
    let frame = Rect::from_min_size(area.left_bottom() + vec2(10.0, -size.y - 10.0), size);
    painter.rect_filled(frame, 4.0, Color32::from_black_alpha(190));
    let at = frame.min + vec2(10.0, 10.0);
    text(painter, at + vec2(0.0, 7.0), &title);
    let top = at + vec2(0.0, 24.0);
    match state.picture.overlay {
        Overlay::Off => {}
        Overlay::Exponent => {
            bar(painter, top, |share| exponent_colour(1.0 + share));
            for (p, words) in [(1.0, "1"), (1.5, "1.5"), (2.0, "2")] {
                tick(painter, top, p - 1.0, words);
            }
            swatch(painter, top + vec2(0.0, TALL + 8.0), class_colour(Class::Exact), "exact");
        }
        Overlay::Samples => {
            let [lo, hi] = SAMPLES_SCALE.map(f64::log10);
            bar(painter, top, |share| samples_colour(10f64.powf(lo + share * (hi - lo))));
            for (i, words) in ["1", "10", "100", "1000", "10,000"].iter().enumerate() {
                tick(painter, top, i as f64 / 4.0, words);
            }
            swatch(painter, top + vec2(0.0, TALL + 8.0), MISSING, "no fit");
        }
        Overlay::Class => {
            let classes = [Class::Smooth, Class::Edge, Class::Complex, Class::Exact];
            for (i, class) in classes.into_iter().enumerate() {
                let at = top + vec2(0.0, ROW * i as f32);
                swatch(painter, at, class_colour(class), &class.to_string());
            }
            swatch(painter, top + vec2(0.0, 4.0 * ROW), MISSING, "no fit");
        }
    }
}

fn text(painter: &Painter, at: Pos2, words: &str) {
    painter.text(at, Align2::LEFT_CENTER, words, FontId::proportional(13.0), Color32::WHITE);
}

/// A colour bar; the share is 0 at its foot and 1 at its top.
fn bar(painter: &Painter, top: Pos2, colour: impl Fn(f64) -> Color32) {
    const STEPS: u8 = 60;
    let height = TALL / f32::from(STEPS);
    for i in 0..STEPS {
        let at = top + vec2(0.0, TALL - height * (f32::from(i) + 1.0));
        let cell = Rect::from_min_size(at, vec2(BAR, height + 0.5));
        painter.rect_filled(cell, 0.0, colour(f64::from(i) / f64::from(STEPS - 1)));
    }
}

fn tick(painter: &Painter, top: Pos2, share: f64, words: &str) {
    let y = top.y + TALL * (1.0 - share as f32);
    let ends = [pos2(top.x + BAR, y), pos2(top.x + BAR + 4.0, y)];
    painter.line_segment(ends, Stroke::new(1.0, Color32::WHITE));
    text(painter, pos2(top.x + BAR + 8.0, y), words);
}

fn swatch(painter: &Painter, at: Pos2, colour: Color32, words: &str) {
    let cell = Rect::from_min_size(at, vec2(12.0, 12.0));
    painter.rect_filled(cell, 0.0, colour);
    painter.rect_stroke(cell, 0.0, Stroke::new(0.5, Color32::WHITE), StrokeKind::Outside);
    text(painter, at + vec2(20.0, 6.0), words);
}
