//! A pixel cut into a fixed grid, with what fills each cell.

use super::dissect::{self, Fill};
use super::{Entry, Pixel32, Strata, Work};
use std::ops::Range;

/// What fills each cell of a grid over the pixel.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    per_axis: u32,
    /// By cell; a mixed cell has a run of `entries`.
    pub(super) fills: Vec<Fill>,
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
        let fills = vec![Fill::NOTHING; (per_axis * per_axis) as usize];
        let mut cells = Self { per_axis, fills, entries: Vec::new(), occluders: Vec::new() };
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
                        cells.fills[strata.index(i, j) as usize] = fill;
                    }
                }
            }
        }
        cells
    }

    /// Copies a list with its occluders.
    fn keep(&mut self, work: &Work, run: Range<u32>) -> Fill {
        let first = self.entries.len() as u32;
        for entry in &work.list[run.start as usize..run.end as usize] {
            let start = self.occluders.len() as u32;
            let [from, to] = entry.occluders.map(|at| at as usize);
            self.occluders.extend_from_slice(&work.occluders[from..to]);
            let occluders = [start, self.occluders.len() as u32];
            self.entries.push(Entry { occluders, ..*entry });
        }
        Fill::Mixed { first, end: self.entries.len() as u32 }
    }

    /// One cell: samples need no sorting.
    pub(super) fn is_single(&self) -> bool {
        self.per_axis == 1
    }

    /// Overwrites `order` with the samples' indices by cell, and gives each cell's end in it.
    pub(super) fn sort(&self, s: &[f32], t: &[f32], order: &mut [u32]) -> Vec<u32> {
        if self.is_single() {
            for (at, slot) in (0..).zip(order.iter_mut()) {
                *slot = at;
            }
            return vec![order.len() as u32];
        }
        let k = self.per_axis as f32;
        // In f32 a position can round up to the far edge; the last cell reaches there.
        let axis = |x: f32| (((x + 0.5) * k) as u32).min(self.per_axis - 1);
        let cell = |at: usize| (axis(t[at]) * self.per_axis + axis(s[at])) as usize;
        let mut ends = vec![0u32; self.fills.len()];
        for at in 0..order.len() {
            ends[cell(at)] += 1;
        }
        let mut total = 0;
        for end in &mut ends {
            total += std::mem::replace(end, total);
        }
        // Each start moves to its cell's end as the cell fills.
        for at in 0..order.len() {
            let end = &mut ends[cell(at)];
            order[*end as usize] = at as u32;
            *end += 1;
        }
        ends
    }
}
