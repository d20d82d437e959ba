//! What each pixel holds, written into it when it is large enough.

use super::view::View;
use crate::jobs::Studied;
use crate::model::Model;
use crate::state::{Overlay, State};
use eframe::egui::{Align2, Color32, FontId, Painter, vec2};

/// Points per pixel from which on there is room for three numbers.
pub const FROM: f32 = 56.0;

/// Writes linear R, G and B into the pixels that are seen, and p below where the map shows it.
pub fn paint(painter: &Painter, view: &View, state: &State, model: &Model) {
    const LINE: f32 = 12.0;
    let seen = painter.clip_rect().intersect(view.whole());
    let (Some(first), Some(last)) =
        (view.pixel_at(seen.min + vec2(0.5, 0.5)), view.pixel_at(seen.max - vec2(0.5, 0.5)))
    else {
        return;
    };
    let gain = state.picture.exposure.exp2();
    for [x, y] in (first[1]..=last[1]).flat_map(|y| (first[0]..=last[0]).map(move |x| [x, y])) {
        let Some(rgb) = model.picture.at([x, y]) else { continue };
        let mut lines: Vec<_> = rgb.iter().map(|value| format!("{value:.3}")).collect();
        let studied = model.map.at([x, y]).copied().flatten();
        if state.picture.overlay != Overlay::Off {
            lines.extend(studied.map(|studied| match studied {
                Studied::Fitted { exponent, .. } => format!("p {exponent:.2}"),
                Studied::Exact => "exact".to_owned(),
                Studied::Unfitted => "no fit".to_owned(),
            }));
        }
        let brightness = gain * rgb.iter().sum::<f64>() / 3.0;
        // Half-way in the eye's scale is about a fifth of white.
        let is_bright = brightness > 0.2 && state.picture.overlay == Overlay::Off;
        let (ink, halo) = if is_bright {
            (Color32::BLACK, None)
        } else {
            (Color32::WHITE, Some(Color32::from_black_alpha(200)))
        };
        let centre = view.rect_of([x, y]).center();
        let top = centre.y - LINE * (lines.len() - 1) as f32 / 2.0;
        for (i, text) in lines.iter().enumerate() {
            let at = eframe::egui::pos2(centre.x, top + LINE * i as f32);
            let font = FontId::monospace(11.0);
            if let Some(halo) = halo {
                let at = at + vec2(1.0, 1.0);
                painter.text(at, Align2::CENTER_CENTER, text, font.clone(), halo);
            }
            painter.text(at, Align2::CENTER_CENTER, text, font, ink);
        }
    }
}
