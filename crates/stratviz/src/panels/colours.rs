//! Colours of samplers, of the picture, and of what lies over it.

use crate::jobs::Studied;
use crate::state::Overlay;
use eframe::egui::Color32;
use std::sync::LazyLock;
use stratcli::picture::srgb_byte;
use stratcli::report::chart::Style;
use stratcli::report::raster::viridis;
use stratcore::sampler::{SHELF, Sampler};
use stratcore::scene::Rgb;
use stratcore::theory::Class;

/// The colour that stands for a sampler in every figure, black turned to white on dark ground.
/// Samplers whose colour is another's too are told from it by a paler or darker shade.
pub fn sampler(name: &str, dark: bool) -> Color32 {
    let ground = if dark { Color32::WHITE } else { Color32::BLACK };
    let colour = match Color32::from_hex(Style::of_sampler(name).colour) {
        Ok(Color32::BLACK) | Err(_) if dark => Color32::from_gray(235),
        Ok(colour) => colour,
        Err(_) => Color32::BLACK,
    };
    let of_this_colour = |other: &&&dyn Sampler| {
        Style::of_sampler(other.name()).colour == Style::of_sampler(name).colour
    };
    let before = SHELF.iter().take_while(|other| other.name() != name);
    let shade = before.filter(of_this_colour).count();
    colour.lerp_to_gamma(ground, (0.45 * shade as f32).min(0.8))
}

/// sRGB of linear radiance, by a table: a picture has millions of values.
pub fn screen(rgb: &Rgb, gain: f64) -> Color32 {
    const STEPS: usize = 1 << 14;
    static TABLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
        // Steps are even in the square root, which is nearly even to the eye.
        (0..=STEPS).map(|i| srgb_byte((i as f64 / STEPS as f64).powi(2))).collect()
    });
    let byte = |v: f64| TABLE[((v * gain).clamp(0.0, 1.0).sqrt() * STEPS as f64) as usize];
    Color32::from_rgb(byte(rgb[0]), byte(rgb[1]), byte(rgb[2]))
}

/// Sample counts at the ends of the scale of samples needed.
pub const SAMPLES_SCALE: [f64; 2] = [1.0, 1e4];

/// A pixel's colour in an overlay; transparent where nothing is known.
pub fn overlay(cell: &Option<Studied>, overlay: Overlay, error: f64) -> Color32 {
    let Some(studied) = cell else { return Color32::TRANSPARENT };
    match (overlay, studied) {
        (Overlay::Off, _) => Color32::TRANSPARENT,
        (Overlay::Exponent, Studied::Fitted { exponent, .. }) => exponent_colour(*exponent),
        (Overlay::Class, Studied::Fitted { class, .. }) => class_colour(*class),
        (Overlay::Exponent | Overlay::Class, Studied::Exact) => class_colour(Class::Exact),
        (Overlay::Samples, studied) => {
            studied.samples_needed(error).map_or(MISSING, samples_colour)
        }
        (_, Studied::Unfitted) => MISSING,
    }
}

/// Where a study found no line.
pub const MISSING: Color32 = Color32::from_rgb(0x70, 0x70, 0x70);

/// p on the fixed scale 1 to 2.
pub fn exponent_colour(p: f64) -> Color32 {
    rgb(viridis(p - 1.0))
}

/// Samples needed, on a logarithmic scale: many are bright.
pub fn samples_colour(n: f64) -> Color32 {
    let [lo, hi] = SAMPLES_SCALE.map(f64::log10);
    rgb(viridis((n.log10() - lo) / (hi - lo)))
}

/// Each kind of pixel: the map's colour at its exponent, and light grey for exact ones.
pub fn class_colour(class: Class) -> Color32 {
    match class.predicted_exponent(2) {
        Some(p) => exponent_colour(p),
        None => Color32::from_gray(0xd8),
    }
}

fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_within_one_step_of_srgb() {
        for i in 0..=1000 {
            let v = f64::from(i) / 1000.0;
            let [r, ..] = screen(&[v; 3], 1.0).to_array();
            assert!(r.abs_diff(srgb_byte(v)) <= 1, "{v}");
        }
        assert_eq!(screen(&[f64::NAN, -1.0, 9.0], 1.0).to_array()[1..3], [0, 255]);
    }
}
