//! Figures made of pictures: the scene, the map of p, and close-ups of pixels.

use super::axis::{INK, MUTED, SMALL, centred, plain};
use super::chart::convergence_into;
use super::gain::class_style;
use super::raster::{Raster, viridis};
use super::summary::CloseUp;
use super::svg::{Rect, Stroke, Svg, Type};
use stratcore::StudyResult;

/// Grey of a pixel without an exponent because every estimate is exact.
pub const EXACT: [u8; 3] = [0xd8; 3];
/// Grey of a pixel that was not fitted, or not yet studied.
const MISSING: [u8; 3] = [0xff; 3];

/// A rectangle of this width with the picture's shape.
fn shaped(x: f64, y: f64, w: f64, [across, down]: [u32; 2]) -> Rect {
    Rect { x, y, w, h: w * f64::from(down) / f64::from(across) }
}

/// The picture itself.
pub fn picture(title: &str, raster: Raster) -> Svg {
    let frame = shaped(28.0, 48.0, 512.0, raster.size);
    let mut svg = Svg::new(568.0, frame.y + frame.h + 24.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    svg.outline(frame, Stroke::solid("#bbbbbb", 1.0));
    svg.image(frame, raster);
    svg
}

/// What the map shows of one pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Cell {
    /// A fitted exponent.
    Exponent(f64),
    /// Every estimate is exact.
    Exact,
    /// No fit through every row, or not studied.
    Missing,
}

/// The picture beside p over it, in false colour on the fixed scale 1 to 2. `cells` are `size`
/// pixels, row by row.
pub fn map(title: &str, photo: Raster, size: [u32; 2], cells: &[Cell]) -> Svg {
    const SIDE: f64 = 400.0;
    let left = shaped(28.0, 48.0, SIDE, photo.size);
    let right = Rect { x: left.x + SIDE + 20.0, ..left };
    let bar = Rect { x: right.x + SIDE + 22.0, y: right.y, w: 16.0, h: right.h };
    let mut svg = Svg::new(bar.x + bar.w + 60.0, left.y + left.h + 46.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    let colour = |cell: &Cell| match cell {
        Cell::Exponent(p) => viridis(p - 1.0),
        Cell::Exact => EXACT,
        Cell::Missing => MISSING,
    };
    svg.image(left, photo);
    svg.image(right, Raster { size, rgb: cells.iter().map(colour).collect() });
    let steps = 128;
    let ramp = (0..steps).rev().map(|i| viridis(f64::from(i) / f64::from(steps - 1))).collect();
    svg.image(bar, Raster { size: [1, steps], rgb: ramp });
    for frame in [left, right, bar] {
        svg.outline(frame, Stroke::solid("#bbbbbb", 1.0));
    }
    for (p, label) in [(1.0, "1"), (1.5, "1.5"), (2.0, "2")] {
        let y = bar.y + bar.h * (2.0 - p);
        svg.line([bar.x + bar.w, y], [bar.x + bar.w + 5.0, y], Stroke::solid(INK, 1.0));
        svg.text([bar.x + bar.w + 9.0, y + 4.0], plain(SMALL, INK), label);
    }
    svg.text([bar.x + bar.w + 9.0, bar.y + bar.h * 0.25 + 4.0], plain(SMALL + 1.0, INK), "p");
    let key = right.y + right.h + 24.0;
    for (i, (grey, words)) in
        [("#d8d8d8", "exact: one colour"), ("#ffffff", "zero variance at some N, or unfinished")]
            .iter()
            .enumerate()
    {
        let swatch = Rect { x: right.x + 150.0 * i as f64, y: key - 10.0, w: 12.0, h: 12.0 };
        svg.fill(swatch, grey, 1.0);
        svg.outline(swatch, Stroke::solid("#999999", 0.8));
        svg.text([swatch.x + 19.0, key], plain(SMALL, MUTED), words);
    }
    svg
}

/// A close-up with all that is drawn of it.
pub struct CloseUpDrawing<'a> {
    /// The numbers.
    pub close_up: &'a CloseUp,
    /// The inside of the pixel.
    pub inside: Raster,
    /// Its study.
    pub study: &'a StudyResult,
}

/// One column per close-up: the inside of the pixel, its place in the picture, its curve.
pub fn close_ups(title: &str, photo: &Raster, drawings: Vec<CloseUpDrawing<'_>>) -> Svg {
    const COLUMN: f64 = 330.0;
    const SIDE: f64 = 250.0;
    let place = shaped(0.0, 0.0, 150.0, photo.size);
    let inside_top = 92.0;
    let place_top = inside_top + SIDE + 16.0;
    let chart_top = place_top + place.h + 32.0;
    let width = 20.0 + COLUMN * drawings.len() as f64;
    let mut svg = Svg::new(width, chart_top + 210.0 + 56.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    for (i, CloseUpDrawing { close_up, inside, study }) in drawings.into_iter().enumerate() {
        let left = 70.0 + COLUMN * i as f64;
        let middle = left + SIDE / 2.0;
        let (colour, _) = class_style(close_up.class);
        let heading = format!("p = {:.2} ± {:.2}", close_up.exponent, close_up.std_error);
        svg.text([middle, 66.0], centred(17.0, INK), &heading);
        let [x, y] = close_up.pixel;
        let words = format!("{}; the paper's example has {:.2}", close_up.class, close_up.paper);
        svg.text([middle, 84.0], centred(12.5, MUTED), &words);
        let frame = Rect { x: left, y: inside_top, w: SIDE, h: SIDE };
        svg.image(frame, inside);
        svg.outline(frame, Stroke::solid(colour, 2.0));

        let here = Rect { x: left + SIDE - place.w, y: place_top, ..place };
        svg.image(here, photo.clone());
        svg.outline(here, Stroke::solid("#bbbbbb", 1.0));
        let step = place.w / f64::from(photo.size[0]);
        let at = [here.x + (f64::from(x) + 0.5) * step, here.y + (f64::from(y) + 0.5) * step];
        // White under the class's colour, so that the mark is seen on any ground.
        for (ink, thick) in [("#ffffff", 4.5), (colour, 2.0)] {
            let around = Rect { x: at[0] - 6.0, y: at[1] - 6.0, w: 12.0, h: 12.0 };
            svg.outline(around, Stroke::solid(ink, thick));
        }
        let set = Type { anchor: "end", ..plain(12.5, INK) };
        let caption = here.x - 12.0;
        svg.text([caption, here.y + 14.0], set, "pixel");
        svg.text([caption, here.y + 31.0], set, &format!("{x}, {y}"));
        let faint = Type { colour: MUTED, size: SMALL, ..set };
        svg.text([caption, here.y + 56.0], faint, "sd of one");
        svg.text([caption, here.y + 71.0], faint, "sample");
        svg.text([caption, here.y + 86.0], faint, &format!("{:.3}", close_up.contrast));
        convergence_into(&mut svg, Rect { x: left, y: chart_top, w: SIDE, h: 210.0 }, study);
    }
    svg
}
