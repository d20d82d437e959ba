//! Power over both frequencies, and its radial means.

use super::{caption, square};
use crate::model::{Piece, Progress};
use crate::panels::colours;
use eframe::egui::{
    self, Color32, ColorImage, Rangef, Rect, TextureHandle, TextureOptions, Ui, pos2, vec2,
};
use egui_plot::{AxisHints, HLine, Line, LineStyle, Plot};
use stratcli::report::chart::label;
use stratcli::report::spectrum::{SamplerSpectrum, power_map};

/// Holds the power of one sampler on the GPU.
#[derive(Default)]
pub struct PowerPicture {
    texture: Option<(Key, TextureHandle)>,
}

/// What the power on the GPU is of: the words, the sampler, the trials.
type Key = (Vec<String>, usize, u32);

impl PowerPicture {
    /// Power over both frequencies.
    pub fn ui(&mut self, ui: &mut Ui, place: usize, spectra: &Piece<Vec<SamplerSpectrum>>) {
        let found = spectra.result.iter().flatten().nth(place);
        let (title, about) = match found {
            Some(spectrum) => (
                format!("Power of {}", label(spectrum.name, spectrum.scramble)),
                format!("mean of {}", spectrum.trials),
            ),
            None => ("Power".to_owned(), String::new()),
        };
        caption(ui, &title, &about, &spectra.progress);
        let Some(spectrum) = found else { return };
        let key = (spectra.planned.clone(), place, spectrum.trials);
        if self.texture.as_ref().is_none_or(|(known, _)| *known != key) {
            let map = power_map(&spectrum.spectrum);
            let pixels = map.rgb.iter().map(|[r, g, b]| Color32::from_rgb(*r, *g, *b)).collect();
            let image = ColorImage::new(map.size.map(|side| side as usize), pixels);
            let texture = ui.ctx().load_texture("power", image, TextureOptions::NEAREST);
            self.texture = Some((key, texture));
        }
        let Some((_, texture)) = &self.texture else { return };
        let area = square(ui, "Power spectrum");
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture.id(), area, uv, Color32::WHITE);
        scale(ui, area, spectrum);
    }
}

/// The colours of power, and how far frequencies reach.
fn scale(ui: &Ui, area: Rect, spectrum: &SamplerSpectrum) {
    const STEPS: u8 = 40;
    let painter = ui.painter();
    let bar = Rect::from_min_size(pos2(area.right() + 6.0, area.top()), vec2(8.0, area.height()));
    if bar.right() + 20.0 > ui.clip_rect().right() {
        return;
    }
    let ink = ui.visuals().weak_text_color();
    let step = bar.height() / f32::from(STEPS);
    for i in 0..STEPS {
        let share = f64::from(i) / f64::from(STEPS - 1);
        let [r, g, b] = stratcli::report::raster::viridis(share);
        let at = pos2(bar.left(), bar.bottom() - step * (f32::from(i) + 1.0));
        let cell = Rect::from_min_size(at, vec2(bar.width(), step + 0.5));
        painter.rect_filled(cell, 0.0, Color32::from_rgb(r, g, b));
    }
    for (share, words) in [(0.0, "0"), (0.5, "1"), (1.0, "2+")] {
        let y = bar.bottom() - share * bar.height() + 6.0 * (share - 0.5);
        let font = egui::FontId::proportional(11.0);
        painter.text(pos2(bar.right() + 4.0, y), egui::Align2::LEFT_CENTER, words, font, ink);
    }
    let reach = (spectrum.spectrum.size()[0] / 2).to_string();
    let font = egui::FontId::proportional(11.0);
    let corner = area.left_bottom() + vec2(-4.0, 0.0);
    let words = format!("\u{b1}{reach}");
    painter.text(corner, egui::Align2::RIGHT_BOTTOM, words, font, ink);
}

/// Radial means of the power of all samplers.
pub fn radial(ui: &mut Ui, spectra: &Piece<Vec<SamplerSpectrum>>) {
    /// Peaks beyond this would flatten everything else.
    const MOST: f64 = 4.0;
    let dark = ui.visuals().dark_mode;
    let muted = ui.visuals().weak_text_color();
    let found = spectra.result.as_deref().unwrap_or_default();
    let is_cut = found.iter().flat_map(|s| &s.rings).any(|ring| ring.power > MOST);
    let about = if is_cut { "1 is white noise; cut at 4" } else { "1 is white noise" };
    caption(ui, "Radial mean of power", about, &Progress::Done);
    Plot::new("radial")
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .custom_x_axes(vec![axis(AxisHints::new_x().label("frequency, cycles per side"))])
        .custom_y_axes(vec![axis(AxisHints::new_y().label("mean power"))])
        .include_y(0.0)
        .include_x(0.0)
        .show(ui, |plot| {
            let white = HLine::new("white noise", 1.0).color(muted);
            plot.hline(white.style(LineStyle::dashed_dense()).allow_hover(false));
            for spectrum in found {
                let place =
                    |ring: &stratcore::spectrum::Ring| [ring.frequency, ring.power.min(MOST)];
                let points: Vec<_> = spectrum.rings.iter().map(place).collect();
                let colour = colours::sampler(spectrum.name, dark);
                plot.line(Line::new(spectrum.name, points).color(colour).width(1.5));
            }
        });
}

/// Names its marks where there is little room, too.
fn axis(hints: AxisHints<'_>) -> AxisHints<'_> {
    hints.label_spacing(Rangef::new(16.0, 30.0))
}
