//! Padded jittered sets: how distribution ray tracing fills its dimensions.

use super::hash::splitmix;
use super::jittered::planar_strata;
use super::permutation::Permutation;
use super::random::{Slabs, UniformPoints, count_up};
use super::target::{ByAxis, Target};
use super::{Admissible, Facts, Kind, Placement, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
use crate::simd::{Divisor, Isa};

/// A jittered set of N = k² points for each two axes and, where d is odd, one of N strata for
/// the last; the sets are put together in random orders. Every pair of axes is stratified as
/// `jittered` is in the plane; nothing is across pairs.
#[derive(Debug, Clone, Copy)]
pub struct JitteredPadded;

impl Sampler for JitteredPadded {
    fn facts(&self) -> Facts {
        Facts {
            name: "jittered-padded",
            summary: "jittered sets padded: k^2 cells for each two axes, each in a random order",
            source: "Cook, Porter & Carpenter 1984; Cook 1986",
            stream_id: 18,
            kind: Kind::Set,
            max_dim: usize::MAX,
            counts: Admissible::Rule("k^2; any with --n-policy rect"),
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn admits(&self, n: u64, dim: usize, rectangular: bool) -> bool {
        Admissible::Cells.admits(n, dim.min(2), rectangular)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        Admissible::Cells.neighbours(n, dim.min(2))
    }
    fn strata(&self, n: u64, dim: usize) -> Option<Vec<u64>> {
        // A grid of the whole only where there is one set.
        match dim {
            1 => Some(vec![n]),
            2 => Some(planar_strata(n).to_vec()),
            _ => None,
        }
    }
    fn placement(&self, dim: usize) -> Placement {
        // A single set has nothing to be put in another order with.
        if dim <= 2 { Placement::Strata } else { Placement::Other }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let (n, stream) = (set.key.n_samples, set.key.stream());
        // The first set keeps its order: the whole is the same.
        let others = (1..set.dim.div_ceil(2) as u64)
            .map(|pair| Permutation::new(n, splitmix(stream.scramble_bits(), pair)))
            .collect();
        Box::new(PaddedCells {
            n: Divisor::new(n),
            strata: planar_strata(n).map(Divisor::new),
            others,
            offsets: UniformPoints { stream, dim: set.dim },
        })
    }
}

struct PaddedCells {
    n: Divisor,
    /// Columns and rows of each pair's grid.
    strata: [Divisor; 2],
    /// In which order each set but the first takes its cells.
    others: Vec<Permutation>,
    offsets: UniformPoints,
}

impl Slabs for PaddedCells {
    #[inline(always)]
    fn count(&self, axis: usize) -> Divisor {
        if self.is_alone(axis) { self.n } else { self.strata[axis % 2] }
    }
    #[inline(always)]
    fn list<const FMA: bool>(&self, axis: usize, first: u64, slabs: &mut [f64]) {
        match (axis / 2).checked_sub(1) {
            None => count_up(first, slabs),
            Some(other) => self.others[other].list(first, slabs),
        }
        if !self.is_alone(axis) {
            for slab in slabs {
                let [row, column] = self.strata[0].div_rem::<FMA>(*slab);
                *slab = if axis.is_multiple_of(2) { column } else { row };
            }
        }
    }
}

impl PaddedCells {
    /// A last axis by itself.
    fn is_alone(&self, axis: usize) -> bool {
        axis.is_multiple_of(2) && axis + 1 == self.offsets.dim
    }
}

impl ByAxis for PaddedCells {
    fn dim(&self) -> usize {
        self.offsets.dim
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        self.offsets.write_in_slabs(isa, first, target, self);
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        self.offsets.stream = *stream;
        let bits = stream.scramble_bits();
        for (pair, order) in (1..).zip(&mut self.others) {
            order.renew(splitmix(bits, pair));
        }
        true
    }
}
