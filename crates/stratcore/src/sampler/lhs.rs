//! Latin hypercube sampling: one point in each of N slabs along every axis.

use super::hash::splitmix;
use super::permutation::Permutation;
use super::random::{Slabs, UniformPoints, count_up};
use super::target::{ByAxis, Target};
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::{Stream, StreamKey};
use crate::simd::{Divisor, Isa};

/// N-rooks: along each axis the N points lie in N different slabs, paired at random between
/// axes, each point uniform in its cell.
#[derive(Debug, Clone, Copy)]
pub struct LatinHypercube;

impl Sampler for LatinHypercube {
    fn facts(&self) -> Facts {
        Facts {
            name: "lhs",
            summary: "Latin hypercube (N-rooks): stratified along every single axis",
            source: "McKay, Beckman & Conover 1979; Shirley 1991",
            stream_id: 3,
            kind: Kind::Set,
            max_dim: usize::MAX,
            counts: Admissible::UpTo(StreamKey::MAX_SAMPLES - 1),
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let stream = set.key.stream();
        let n = set.key.n_samples;
        let key = |axis| splitmix(stream.scramble_bits(), axis);
        // The first axis keeps its order: the set is the same.
        let others = (1..set.dim as u64).map(|axis| Permutation::new(n, key(axis))).collect();
        let offsets = UniformPoints { stream, dim: set.dim };
        Box::new(RooksPoints { n: Divisor::new(n), others, offsets })
    }
}

struct RooksPoints {
    n: Divisor,
    others: Vec<Permutation>,
    offsets: UniformPoints,
}

impl Slabs for RooksPoints {
    #[inline(always)]
    fn count(&self, _axis: usize) -> Divisor {
        self.n
    }
    #[inline(always)]
    fn list<const FMA: bool>(&self, axis: usize, first: u64, slabs: &mut [f64]) {
        match axis.checked_sub(1) {
            None => count_up(first, slabs),
            Some(other) => self.others[other].list(first, slabs),
        }
    }
}

impl ByAxis for RooksPoints {
    fn dim(&self) -> usize {
        self.offsets.dim
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        self.offsets.write_in_slabs(isa, first, target, self);
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        self.offsets.stream = *stream;
        let bits = stream.scramble_bits();
        for (axis, permutation) in (1..).zip(&mut self.others) {
            permutation.renew(splitmix(bits, axis));
        }
        true
    }
}
