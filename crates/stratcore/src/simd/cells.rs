//! A pixel cut into a fixed grid, with what fills each cell.

use super::dissect::Fill;
use super::types::Entry;

/// What fills each cell of a grid over the pixel.
#[derive(Debug, Clone)]
pub(crate) struct Cells {
    per_axis: u32,
    cells: Vec<Cell>,
    entries: Vec<Entry>,
    occluders: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
enum Cell {
    Uniform {
        facet: Option<u32>,
        lit: bool,
    },
    /// A run of `entries`.
    Mixed {
        first: u32,
        end: u32,
    },
}

impl Cells {
    pub(super) fn new(per_axis: u32) -> Self {
        let nothing = Cell::Uniform { facet: None, lit: true };
        let cells = vec![nothing; (per_axis * per_axis) as usize];
        Self { per_axis, cells, entries: Vec::new(), occluders: Vec::new() }
    }

    pub(super) fn set(&mut self, cell: u32, fill: &Fill<'_>) {
        self.cells[cell as usize] = match *fill {
            Fill::Uniform { facet, lit } => Cell::Uniform { facet, lit },
            Fill::Mixed { list, occluders } => {
                let first = self.entries.len() as u32;
                for entry in list {
                    let start = self.occluders.len() as u32;
                    let [from, to] = entry.occluders.map(|at| at as usize);
                    self.occluders.extend_from_slice(&occluders[from..to]);
                    let occluders = [start, self.occluders.len() as u32];
                    self.entries.push(Entry { occluders, ..*entry });
                }
                Cell::Mixed { first, end: self.entries.len() as u32 }
            }
        };
    }

    /// One cell: samples need no sorting.
    pub(super) fn is_single(&self) -> bool {
        self.per_axis == 1
    }

    #[inline(always)]
    pub(super) fn fill(&self, cell: u32) -> Fill<'_> {
        match self.cells[cell as usize] {
            Cell::Uniform { facet, lit } => Fill::Uniform { facet, lit },
            Cell::Mixed { first, end } => {
                let list = &self.entries[first as usize..end as usize];
                Fill::Mixed { list, occluders: &self.occluders }
            }
        }
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
        let mut ends = vec![0u32; self.cells.len()];
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
