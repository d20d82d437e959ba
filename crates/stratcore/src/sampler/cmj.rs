//! Correlated multi-jittered sampling.

use super::hash::{splitmix, whole};
use super::permutation::Permutation;
use super::random::{Slabs, UniformPoints, count_up};
use super::target::{ByAxis, Target};
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble, strata_per_axis};
use crate::rng::Stream;
use crate::simd::{Divisor, Isa};

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
            n: Divisor::new(set.key.n_samples),
            columns,
            rows,
            offset_of_row: Permutation::new(rows, key(0)),
            offset_of_column: Permutation::new(columns, key(1)),
            offsets: UniformPoints { stream, dim: set.dim },
        })
    }
}

struct MultiJitteredPoints {
    n: Divisor,
    columns: u64,
    rows: u64,
    offset_of_row: Permutation,
    offset_of_column: Permutation,
    offsets: UniformPoints,
}

impl Slabs for MultiJitteredPoints {
    #[inline(always)]
    fn count(&self, _axis: usize) -> Divisor {
        self.n
    }
    /// Kensler 2013, section 2: the cell, then the slab within it.
    #[inline(always)]
    fn list<const FMA: bool>(&self, axis: usize, first: u64, slabs: &mut [f64]) {
        let Self { columns, rows, .. } = *self;
        let (mut column, mut row) = (first % columns, first / columns);
        let mut rest = slabs;
        while !rest.is_empty() {
            let run = rest.len().min((columns - column) as usize);
            let (slabs, others) = rest.split_at_mut(run);
            if axis == 0 {
                let offset = whole(self.offset_of_row.get(row));
                count_up(column, slabs);
                for slab in slabs {
                    *slab = *slab * whole(rows) + offset;
                }
            } else {
                let start = whole(row * columns);
                self.offset_of_column.list(column, slabs);
                for slab in slabs {
                    *slab += start;
                }
            }
            rest = others;
            (column, row) = (0, row + 1);
        }
    }
}

impl ByAxis for MultiJitteredPoints {
    fn dim(&self) -> usize {
        self.offsets.dim
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        self.offsets.write_in_slabs(isa, first, target, self);
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        self.offsets.stream = *stream;
        let bits = stream.scramble_bits();
        self.offset_of_row.renew(splitmix(bits, 0));
        self.offset_of_column.renew(splitmix(bits, 1));
        true
    }
}
