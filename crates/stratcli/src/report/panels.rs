//! A map as panels side by side: the mean, p under each sampler, the class, the best sampler.

use super::axis::{INK, MUTED, SMALL, plain};
use super::gain::class_style;
use super::picture::EXACT;
use super::raster::{Raster, viridis};
use super::svg::{Rect, Stroke, Svg};
use stratcore::theory::Class;

/// One picture with its key.
pub struct Panel {
    /// What stands above it.
    pub caption: String,
    /// Its pixels.
    pub raster: Raster,
    /// What its colours mean.
    pub key: Key,
}

/// What colours mean.
pub enum Key {
    /// Nothing more than a picture.
    None,
    /// p on the fixed scale 1 to 2.
    Exponent,
    /// Classes.
    Classes,
    /// Samplers by name.
    Samplers(Vec<String>),
}

/// The colour of p; grey where every estimate is exact, a chequered mark where there is none.
pub fn exponent_colour(pixel: [u32; 2], p: Option<f64>, exact: bool) -> [u8; 3] {
    match p {
        Some(p) => viridis(p - 1.0),
        None if exact => EXACT,
        None => missing_colour(pixel),
    }
}

/// The colour of a class; a chequered mark where it is not known.
pub fn class_colour(pixel: [u32; 2], class: Option<Class>) -> [u8; 3] {
    match class {
        Some(Class::Exact) => EXACT,
        Some(class) => rgb(class_style(class).0),
        None => missing_colour(pixel),
    }
}

/// Colours of areas, which have no marker and no dash to be told apart by: in grey the lightness
/// of neighbours in this list is 10 of 100 apart or more.
const AREAS: [&str; 6] = ["#e69f00", "#0072b2", "#f7f0b6", "#4a1a4a", "#cc79a7", "#000000"];

/// The colour of a sampler by its place among those compared.
pub fn sampler_colour(place: usize) -> [u8; 3] {
    rgb(AREAS[place % AREAS.len()])
}

fn missing_colour([x, y]: [u32; 2]) -> [u8; 3] {
    if (x + y).is_multiple_of(2) { [0x50; 3] } else { [0xb0; 3] }
}

/// `#rrggbb` as bytes.
fn rgb(colour: &str) -> [u8; 3] {
    let word = u32::from_str_radix(colour.trim_start_matches('#'), 16).unwrap_or(0);
    [16, 8, 0].map(|shift| (word >> shift & 0xff) as u8)
}

/// The panels in rows of three, each with its key below.
pub fn draw(title: &str, subtitle: &str, panels: Vec<Panel>) -> Svg {
    const SIDE: f64 = 360.0;
    const GAP: f64 = 24.0;
    const MARGIN: f64 = 28.0;
    const TOP: f64 = 66.0;
    const KEY: f64 = 52.0;
    let columns = panels.len().clamp(1, 3);
    let aspect = panels
        .first()
        .map_or(1.0, |panel| f64::from(panel.raster.size[1]) / f64::from(panel.raster.size[0]));
    // Tall regions are as high as wide ones are wide.
    let (w, h) = if aspect > 1.0 { (SIDE / aspect, SIDE) } else { (SIDE, SIDE * aspect) };
    let step = [SIDE + GAP, h + 24.0 + KEY];
    let rows = panels.len().div_ceil(columns);
    let width = 2.0 * MARGIN + step[0] * columns as f64 - GAP;
    let mut svg = Svg::new(width, TOP + step[1] * rows as f64, title);
    svg.text([MARGIN, 30.0], plain(16.0, INK), title);
    svg.text([MARGIN, 49.0], plain(SMALL, MUTED), subtitle);
    for (i, panel) in panels.into_iter().enumerate() {
        let left = MARGIN + step[0] * (i % columns) as f64;
        let top = TOP + step[1] * (i / columns) as f64;
        svg.text([left, top + 13.0], plain(13.0, INK), &panel.caption);
        let frame = Rect { x: left, y: top + 22.0, w, h };
        svg.image(frame, panel.raster);
        svg.outline(frame, Stroke::solid("#bbbbbb", 1.0));
        key(&mut svg, [left, frame.y + h + 10.0], &panel.key);
    }
    svg
}

fn key(svg: &mut Svg, at: [f64; 2], key: &Key) {
    const EXACT_INK: &str = "#d8d8d8";
    match key {
        Key::None => {}
        Key::Exponent => {
            let bar = Rect { x: at[0], y: at[1], w: 150.0, h: 10.0 };
            let steps = 128;
            let ramp = (0..steps).map(|i| viridis(f64::from(i) / f64::from(steps - 1))).collect();
            svg.image(bar, Raster { size: [steps, 1], rgb: ramp });
            svg.outline(bar, Stroke::solid("#bbbbbb", 1.0));
            for (p, label) in [(1.0, "1"), (1.5, "1.5"), (2.0, "2")] {
                let x = bar.x + bar.w * (p - 1.0);
                svg.line([x, bar.y + bar.h], [x, bar.y + bar.h + 4.0], Stroke::solid(INK, 1.0));
                svg.text([x - 3.0, bar.y + bar.h + 16.0], plain(SMALL, INK), label);
            }
            swatch(svg, [at[0] + 176.0, at[1]], &Ink::Plain(EXACT_INK), "exact");
            swatch(svg, [at[0] + 240.0, at[1]], &Ink::Chequered, "no exponent");
        }
        Key::Classes => {
            for (i, class) in [Class::Smooth, Class::Edge, Class::Complex].into_iter().enumerate() {
                let place = [at[0] + 76.0 * i as f64, at[1]];
                swatch(svg, place, &Ink::Plain(class_style(class).0), &class.to_string());
            }
            swatch(svg, [at[0] + 228.0, at[1]], &Ink::Plain(EXACT_INK), "exact");
            swatch(svg, [at[0], at[1] + 18.0], &Ink::Chequered, "not known");
        }
        Key::Samplers(names) => {
            for (i, name) in names.iter().enumerate() {
                let place = [at[0] + 120.0 * (i % 3) as f64, at[1] + 16.0 * (i / 3) as f64];
                swatch(svg, place, &Ink::Plain(AREAS[i % AREAS.len()]), name);
            }
        }
    }
}

enum Ink {
    Plain(&'static str),
    Chequered,
}

fn swatch(svg: &mut Svg, [x, y]: [f64; 2], ink: &Ink, words: &str) {
    let square = Rect { x, y, w: 12.0, h: 12.0 };
    match ink {
        Ink::Plain(colour) => svg.fill(square, colour, 1.0),
        Ink::Chequered => {
            let cells = (0..9).map(|i| missing_colour([i % 3, i / 3])).collect();
            svg.image(square, Raster { size: [3, 3], rgb: cells });
        }
    }
    svg.outline(square, Stroke::solid("#999999", 0.8));
    svg.text([x + 18.0, y + 10.0], plain(SMALL, MUTED), words);
}
