//! Correlated multi-jittered sampling.

use super::hash::splitmix;
use super::permutation::Permutation;
use super::random::UniformPoints;
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble, strata_per_axis};
use crate::rng::Stream;
use crate::simd::Isa;

/// One point in each of the m × n cells of a grid and, at the same time, in each of the mn
/// columns and mn rows. All columns of cells share one order of their rows' offsets, and all
/// rows one order of their columns', which keeps neighbours apart.
///
/// m and n are the strata of `jittered`: equal, or as equal as the count allows where
/// rectangles are allowed.
#[derive(Debug, Clone, Copy)]
pub struct CorrelatedMultiJittered;

impl Sampler for CorrelatedMultiJittered {
    fn facts(&self) -> Facts {
        Facts {
            name: "cmj",
            summary: "correlated multi-jittered: stratified in 2-D cells and along both axes",
            source: "Chiu, Shirley & Wang 1994; Kensler 2013",
            stream_id: 4,
            kind: Kind::Set,
            max_dim: 2,
            counts: Admissible::Cells,
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let stream = set.key.stream();
        let strata = strata_per_axis(set.key.n_samples, set.dim);
        let (columns, rows) = (strata[0], strata.get(1).copied().unwrap_or(1));
        let key = |axis| splitmix(stream.scramble_bits(), axis);
        Box::new(MultiJitteredPoints {
            columns,
            rows,
            offset_of_row: Permutation::new(rows, key(0)),
            offset_of_column: Permutation::new(columns, key(1)),
            offsets: UniformPoints { stream, dim: set.dim },
        })
    }
}

struct MultiJitteredPoints {
    columns: u64,
    rows: u64,
    offset_of_row: Permutation,
    offset_of_column: Permutation,
    offsets: UniformPoints,
}

impl Points for MultiJitteredPoints {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        let n = self.columns * self.rows;
        let (mut column, mut row) = (first % self.columns, first / self.columns);
        self.offsets.fill_in_slabs(isa, n, first, points, |_, slabs| {
            // Kensler 2013, section 2: the cell, then the slab within it.
            let both = [
                column * self.rows + self.offset_of_row.get(row),
                row * self.columns + self.offset_of_column.get(column),
            ];
            for (slab, one) in slabs.iter_mut().zip(both) {
                *slab = one;
            }
            column += 1;
            if column == self.columns {
                (column, row) = (0, row + 1);
            }
        });
    }
    fn renew(&mut self, stream: &Stream) -> bool {
        self.offsets.stream = *stream;
        let bits = stream.scramble_bits();
        self.offset_of_row.renew(splitmix(bits, 0));
        self.offset_of_column.renew(splitmix(bits, 1));
        true
    }
}
