//! Latin hypercube sampling: one point in each of N slabs along every axis.

use super::hash::splitmix;
use super::permutation::Permutation;
use super::random::UniformPoints;
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::{Stream, StreamKey};
use crate::simd::Isa;

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
        Box::new(RooksPoints { n, others, offsets: UniformPoints { stream, dim: set.dim } })
    }
}

struct RooksPoints {
    n: u64,
    others: Vec<Permutation>,
    offsets: UniformPoints,
}

impl Points for RooksPoints {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        self.offsets.fill_in_slabs(isa, self.n, first, points, |index, slabs| {
            slabs[0] = index;
            for (slab, permutation) in slabs[1..].iter_mut().zip(&self.others) {
                *slab = permutation.get(index);
            }
        });
    }
    fn renew(&mut self, stream: &Stream) -> bool {
        self.offsets.stream = *stream;
        let bits = stream.scramble_bits();
        for (axis, permutation) in (1..).zip(&mut self.others) {
            permutation.renew(splitmix(bits, axis));
        }
        true
    }
}
