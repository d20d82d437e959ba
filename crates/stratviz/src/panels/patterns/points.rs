//! One set: two of its dimensions, or every pair of them.

use super::{caption, square};
use crate::jobs::Drawn;
use crate::model::Piece;
use crate::panels::colours;
use crate::state::State;
use eframe::egui::{Align2, FontId, Rect, Stroke, StrokeKind, Ui, pos2, vec2};
use stratcli::report::chart::label;

/// Dots of all pairs together, at the most: more would cost milliseconds on every frame.
const MOST_DOTS: usize = 1 << 14;

/// Draws the set that is known.
pub fn ui(ui: &mut Ui, state: &State, drawn: &Piece<Drawn>) {
    let progress = &drawn.progress;
    let Some(drawn) = &drawn.result else {
        caption(ui, "Points", "", progress);
        return;
    };
    let dims = if state.patterns.all_pairs { dimensions_shown(drawn) } else { drawn.dim };
    let mut about = match drawn.n_used {
        n if n == drawn.n => format!("N = {n}"),
        n => format!("has no set of {}; these are {n}", drawn.n),
    };
    if dims < drawn.dim {
        about += &format!("; pairs of the first {dims} dimensions");
    }
    caption(ui, &label(drawn.name, drawn.scramble), &about, progress);
    let area = square(ui, "Points");
    if state.patterns.all_pairs {
        pairs(ui, area, drawn, dims, state.strata);
    } else {
        paint(ui, area, drawn, drawn.axes, state.strata);
    }
}

/// As many dimensions as their pairs have room for.
fn dimensions_shown(drawn: &Drawn) -> usize {
    let dots = |dims: &usize| dims * (dims - 1) / 2 * drawn.n_used as usize;
    (2..=drawn.dim).take_while(|dims| dots(dims) <= MOST_DOTS).last().unwrap_or(2)
}

/// Each of the first `dims` dimensions against each before it: a column for the smaller, a row
/// for the larger.
fn pairs(ui: &Ui, area: Rect, drawn: &Drawn, dims: usize, strata: bool) {
    const GAP: f32 = 4.0;
    /// Points of a cell that leave room for its name.
    const NAMED: f32 = 48.0;
    let cell = area.width() / (dims - 1) as f32;
    for (i, j) in (1..dims).flat_map(|j| (0..j).map(move |i| (i, j))) {
        let corner = area.min + vec2(i as f32, (j - 1) as f32) * cell;
        let place = Rect::from_min_size(corner, vec2(cell - GAP, cell - GAP));
        paint(ui, place, drawn, [i, j], strata);
        if cell >= NAMED {
            let (at, font) = (place.min + vec2(3.0, 1.0), FontId::proportional(11.0));
            let ink = ui.visuals().strong_text_color();
            ui.painter().text(at, Align2::LEFT_TOP, format!("{i},{j}"), font, ink);
        }
    }
}

/// The set as `points --plot` draws it: the first axis to the right, the second upwards.
fn paint(ui: &Ui, area: Rect, drawn: &Drawn, axes: [usize; 2], strata: bool) {
    /// More lines than this are a grey area.
    const MOST_LINES: u64 = 64;
    let painter = ui.painter();
    painter.rect_filled(area, 0.0, ui.visuals().extreme_bg_color);
    let faint = Stroke::new(1.0, ui.visuals().weak_text_color().gamma_multiply(0.35));
    let strata = drawn.strata.as_ref().filter(|_| strata);
    let along = |axis: usize| {
        let along = strata.and_then(|strata| strata.get(axes[axis])).copied();
        along.filter(|k| *k <= MOST_LINES).unwrap_or(1)
    };
    let share = |i: u64, k: u64| i as f32 / k as f32;
    for i in 1..along(0) {
        painter.vline(area.left() + share(i, along(0)) * area.width(), area.y_range(), faint);
    }
    for i in 1..along(1) {
        painter.hline(area.x_range(), area.bottom() - share(i, along(1)) * area.height(), faint);
    }
    painter.rect_stroke(area, 0.0, faint, StrokeKind::Outside);
    let radius = (0.16 * area.width() / (drawn.n_used as f32).sqrt()).clamp(0.8, 3.5);
    let colour = colours::sampler(drawn.name, ui.visuals().dark_mode);
    for point in drawn.points.chunks_exact(drawn.dim) {
        let [u, v] = axes.map(|axis| point[axis] as f32);
        let at = pos2(area.left() + u * area.width(), area.bottom() - v * area.height());
        painter.circle_filled(at, radius, colour);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::sampler::Scramble;

    #[test]
    fn pairs_are_as_many_as_there_is_room_for() {
        let shown = |dim, n_used| {
            dimensions_shown(&Drawn {
                name: "random",
                scramble: Scramble::None,
                n: n_used,
                n_used,
                points: Vec::new(),
                dim,
                axes: [0, 1],
                strata: None,
            })
        };
        assert_eq!((shown(16, 64), shown(16, 256), shown(6, 256)), (16, 11, 6));
        assert_eq!((shown(3, 1 << 14), shown(2, 1 << 20)), (2, 2));
    }
}
