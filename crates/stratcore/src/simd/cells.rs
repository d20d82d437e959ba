//! A pixel cut into a fixed grid, with what fills each cell.

use super::dissect::{self, Fill};
use super::vector::MAX_LANES;
use super::{Entry, Pixel32, Strata, Work};
use std::ops::Range;

/// What fills each cell of a grid over the pixel. Cells of one fill are neighbours in the order
/// in which samples are sorted.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cells {
    per_axis: u32,
    /// Each cell's place in that order.
    ranks: Vec<u32>,
    /// What fills the cells, in that order, and the rank behind each fill's last cell; a mixed one
    /// has a run of `entries`.
    pub(super) fills: Vec<(Fill, u32)>,
    pub(super) entries: Vec<Entry>,
    pub(super) occluders: Vec<u32>,
}

impl Cells {
    /// `next_pieces` is [`dissect::next_pieces`], compiled for some instruction set.
    pub(super) fn new(
        pixel: &Pixel32,
        per_axis: u32,
        next_pieces: impl Fn(&Strata, &mut Work) -> bool,
    ) -> Self {
        let strata = Strata::new([per_axis; 2]);
        let mut cells = Self { per_axis, ..Self::default() };
        let mut fills = vec![Fill::NOTHING; (per_axis * per_axis) as usize];
        let mut work = Work::default();
        dissect::start(pixel, &strata, usize::MAX, &mut work);
        while next_pieces(&strata, &mut work) {
            for piece in &work.pieces {
                let fill = match piece.fill {
                    Fill::Mixed { first, end } => cells.keep(&work, first..end),
                    uniform => uniform,
                };
                for j in piece.j[0]..piece.j[1] {
                    for i in piece.i[0]..piece.i[1] {
                        fills[strata.index(i, j) as usize] = fill;
                    }
                }
            }
        }
        cells.rank(&fills);
        cells
    }

    /// Takes what fills each cell.
    fn rank(&mut self, fills: &[Fill]) {
        let is_uniform = |fill: &&Fill| matches!(fill, Fill::Uniform { .. });
        let mut distinct: Vec<Fill> = Vec::new();
        for fill in fills.iter().filter(is_uniform) {
            if !distinct.contains(fill) {
                distinct.push(*fill);
            }
        }
        let of_fill = |fill: &Fill| distinct.iter().position(|known| known == fill);
        // Mixed ones last, each by itself.
        let place = |fill: &Fill| of_fill(fill).unwrap_or(distinct.len());
        let mut order: Vec<_> = fills.iter().map(place).zip(0..).collect();
        order.sort_unstable();
        self.ranks = vec![0; fills.len()];
        for (rank, (_, cell)) in (0..).zip(order) {
            let cell: usize = cell;
            self.ranks[cell] = rank;
            match self.fills.last_mut() {
                Some((fill, end)) if *fill == fills[cell] => *end = rank + 1,
                _ => self.fills.push((fills[cell], rank + 1)),
            }
        }
    }

    /// Copies a stratum's list with its occluders.
    fn keep(&mut self, work: &Work, run: Range<u32>) -> Fill {
        let first = self.entries.len() as u32;
        for entry in &work.list[run.start as usize..run.end as usize] {
            let [start, end] = entry.occluders.map(|at| at as usize);
            let kept = self.occluders.len() as u32;
            self.occluders.extend(&work.list_occluders[start..end]);
            let occluders = [kept, self.occluders.len() as u32];
            self.entries.push(Entry { occluders, ..*entry });
        }
        Fill::Mixed { first, end: self.entries.len() as u32 }
    }

    /// One cell: samples need no sorting.
    pub(super) fn is_single(&self) -> bool {
        self.per_axis == 1
    }

    /// The column of cells, or the row, that a position lies in.
    #[inline(always)]
    fn along_axis(&self, x: f32) -> u32 {
        /// Added to a number, it leaves the nearest whole one in the lowest bits.
        const ROUND: f32 = (1u32 << 23) as f32;
        let (k, last) = (self.per_axis as f32, self.per_axis.wrapping_sub(1) as f32);
        // In f32 a position can round up to the far edge; the last cell reaches there. One next to
        // a border may be on either side of it: lists have that much to spare.
        let at = x * k + 0.5 * last;
        let at = if at > 0.0 { at } else { 0.0 };
        let at = if at < last { at } else { last };
        (at + ROUND).to_bits().wrapping_sub(ROUND.to_bits())
    }

    /// Puts the samples at positions (s, t) about the pixel's centre into the order of the cells.
    #[inline(always)]
    pub(super) fn sort(&self, [s, t]: [&[f32]; 2], sorted: &mut Sorted) {
        let Sorted { ends, places, s: sorted_s, t: sorted_t, .. } = sorted;
        let (s, t) = (&s[..places.len()], &t[..places.len()]);
        for (place, (s, t)) in places.iter_mut().zip(s.iter().zip(t)) {
            let [i, j] = [*s, *t].map(|x| self.along_axis(x));
            *place = j.wrapping_mul(self.per_axis).wrapping_add(i);
        }
        ends.fill(0);
        for place in places.iter_mut() {
            let rank = self.ranks[*place as usize];
            *place = rank;
            let end = &mut ends[rank as usize];
            *end = end.wrapping_add(1);
        }
        let mut total = 0;
        for end in ends.iter_mut() {
            total += std::mem::replace(end, total);
        }
        // Each start moves to its cell's end as the cell fills.
        for (place, (s, t)) in places.iter_mut().zip(s.iter().zip(t)) {
            let end = &mut ends[*place as usize];
            let at = *end;
            *end = at.wrapping_add(1);
            *place = at;
            sorted_s[at as usize] = *s;
            sorted_t[at as usize] = *t;
        }
    }
}

/// Samples in the order of their cells.
#[derive(Default)]
pub(crate) struct Sorted {
    /// By rank.
    pub(super) ends: Vec<u32>,
    /// Of each sample as it was given.
    pub(super) places: Vec<u32>,
    pub(super) s: Vec<f32>,
    pub(super) t: Vec<f32>,
    pub(super) values: Vec<f32>,
}

impl Sorted {
    /// Room for as many samples, and a vector's length behind them.
    #[inline(always)]
    pub(super) fn resize(&mut self, cells: &Cells, n: usize) {
        self.ends.resize(cells.ranks.len(), 0);
        self.places.resize(n, 0);
        for room in [&mut self.s, &mut self.t, &mut self.values] {
            room.resize(n + MAX_LANES, 0.0);
        }
    }
}
