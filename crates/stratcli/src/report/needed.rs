//! The samples that pixels need, and the errors that come of them, as pictures.

use super::axis::{INK, MUTED, SMALL, plain};
use super::chart::label;
use super::picture::EXACT;
use super::raster::{Raster, viridis};
use super::svg::{Rect, Stroke, Svg};
use stratcore::trade::needed::{Need, NeedMap, Needed, PixelNeed};

/// Range of errors that is shown, in units of the target: a factor of four either way.
const WORST: f64 = 4.0;

/// What a panel shows of a pixel.
type Colour = Box<dyn Fn(&PixelNeed) -> [u8; 3]>;

/// Where N lies on the scale from 1 to the largest, in [0, 1].
fn position(n: u64, most: u64) -> f64 {
    (n as f64).ln() / (most.max(2) as f64).ln()
}

fn n_colour(pixel: &PixelNeed, most: u64) -> [u8; 3] {
    if pixel.need == Need::Exact { EXACT } else { viridis(position(pixel.n, most)) }
}

fn error_colour(pixel: &PixelNeed, rmse: f64, error: f64) -> [u8; 3] {
    match pixel.need {
        Need::Exact => EXACT,
        _ => viridis(0.5 + 0.5 * (rmse / error).ln() / WORST.ln()),
    }
}

/// N in false colour, as linear R, G and B: what a viewer of the EXR shows.
pub fn false_colour(found: &NeedMap) -> Vec<(String, Vec<f32>)> {
    let colours: Vec<_> =
        found.pixels.iter().map(|pixel| n_colour(pixel, found.uniform_spp_for_all)).collect();
    let linear = |byte: u8| {
        let x = f64::from(byte) / 255.0;
        // IEC 61966-2-1, backwards.
        (if x <= 0.040_45 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }) as f32
    };
    let channel = |i: usize| colours.iter().map(|c| linear(c[i])).collect();
    ["R", "G", "B"].iter().enumerate().map(|(i, name)| ((*name).to_owned(), channel(i))).collect()
}

/// A row of three pictures per sampler: N per pixel, the error with it, and the error of a
/// uniform picture of as many samples.
pub fn draw(title: &str, found: &Needed) -> Svg {
    const SIDE: f64 = 300.0;
    const GAP: f64 = 86.0;
    let [across, down] = found.size;
    let h = SIDE * f64::from(down) / f64::from(across);
    let row_height = h + 44.0;
    let rows = found.maps.len() as f64;
    let mut svg = Svg::new(28.0 + 3.0 * (SIDE + GAP), 40.0 + rows * row_height + 44.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    let error = found.error;
    // One scale of N for all samplers: their colours can be compared.
    let most = found.maps.iter().map(|map| map.uniform_spp_for_all).max().unwrap_or(1);
    for (row, map) in found.maps.iter().enumerate() {
        let top = 72.0 + row as f64 * row_height;
        let name = label(map.sampler, map.scramble);
        let panels: [(String, Colour); 3] = [
            (format!("samples needed, {name}"), Box::new(move |p| n_colour(p, most))),
            (
                "RMS error with these N".to_owned(),
                Box::new(move |p| error_colour(p, p.rmse, error)),
            ),
            (
                format!("RMS error, uniform {} spp", map.uniform_spp),
                Box::new(move |p| error_colour(p, p.rmse_uniform, error)),
            ),
        ];
        for (i, (name, colour)) in panels.iter().enumerate() {
            let x = 28.0 + i as f64 * (SIDE + GAP);
            let area = Rect { x, y: top, w: SIDE, h };
            svg.text([x, top - 10.0], plain(13.0, INK), name);
            svg.image(
                area,
                Raster { size: found.size, rgb: map.pixels.iter().map(colour).collect() },
            );
            svg.outline(area, Stroke::solid("#bbbbbb", 1.0));
            let bar = Rect { x: x + SIDE + 10.0, w: 14.0, ..area };
            let ticks = if i == 0 { n_ticks(most) } else { error_ticks() };
            scale(&mut svg, bar, &ticks);
        }
    }
    let key = 40.0 + rows * row_height + 14.0;
    let swatch = Rect { x: 28.0, y: key - 10.0, w: 12.0, h: 12.0 };
    svg.fill(swatch, "#d8d8d8", 1.0);
    svg.outline(swatch, Stroke::solid("#999999", 0.8));
    svg.text([47.0, key], plain(SMALL, MUTED), "exact: no trial differed");
    svg.text([28.0 + SIDE + GAP, key], plain(SMALL, MUTED), "errors in units of the target");
    svg
}

/// Powers of four up to the largest N.
fn n_ticks(most: u64) -> Vec<(f64, String)> {
    (0..32)
        .map(|k| 1u64 << (2 * k))
        .take_while(|n| *n <= most)
        .map(|n| (position(n, most), n.to_string()))
        .collect()
}

fn error_ticks() -> Vec<(f64, String)> {
    [(0.0, "1/4"), (0.25, "1/2"), (0.5, "1"), (0.75, "2"), (1.0, "4")]
        .map(|(at, label)| (at, label.to_owned()))
        .to_vec()
}

fn scale(svg: &mut Svg, bar: Rect, ticks: &[(f64, String)]) {
    let steps = 128;
    let ramp = (0..steps).rev().map(|i| viridis(f64::from(i) / f64::from(steps - 1))).collect();
    svg.image(bar, Raster { size: [1, steps], rgb: ramp });
    svg.outline(bar, Stroke::solid("#bbbbbb", 1.0));
    for (at, label) in ticks {
        let y = bar.y + bar.h * (1.0 - at);
        svg.line([bar.x + bar.w, y], [bar.x + bar.w + 4.0, y], Stroke::solid(INK, 1.0));
        svg.text([bar.x + bar.w + 7.0, y + 4.0], plain(SMALL, INK), label);
    }
}
