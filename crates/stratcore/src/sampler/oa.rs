//! Orthogonal array sampling, strength 2.

use super::hash::{splitmix, whole};
use super::jittered::root_floor;
use super::permutation::Permutation;
use super::random::{Slabs, UniformPoints};
use super::target::{ByAxis, Target};
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
use crate::simd::{Divisor, Isa};

/// N = p² points, p prime, in up to p + 1 dimensions: every pair of dimensions sees one point
/// in each of its p × p cells, as correlated multi-jitter would, and every single dimension one
/// in each of p² slabs.
#[derive(Debug, Clone, Copy)]
pub struct OrthogonalArray;

/// The largest prime whose square is at most 2^32.
const LARGEST_PRIME: u64 = 65_521;

impl Sampler for OrthogonalArray {
    fn facts(&self) -> Facts {
        Facts {
            name: "oa",
            summary: "orthogonal array of strength 2: all 2-D projections multi-jittered, N = p^2",
            source: "Bose 1938; Owen 1992; Tang 1993; Jarosz, Enayet, Kensler, Kilpatrick & Christensen 2019",
            stream_id: 5,
            kind: Kind::Set,
            max_dim: LARGEST_PRIME as usize + 1,
            counts: Admissible::Rule("p^2 with p prime, d - 1 <= p <= 65,521"),
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn admits(&self, n: u64, dim: usize, _rectangular: bool) -> bool {
        let p = root_floor(n, 2);
        p * p == n && p <= LARGEST_PRIME && p + 1 >= dim as u64 && is_prime(p)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        let smallest = (dim as u64).max(3) - 1;
        let root = root_floor(n, 2).min(LARGEST_PRIME);
        let below = (smallest..=root).rev().find(|p| is_prime(*p));
        let above = (smallest.max(root + 1)..=LARGEST_PRIME).find(|p| is_prime(*p));
        (below.map(|p| p * p), above.map(|p| p * p))
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let stream = set.key.stream();
        let p = root_floor(set.key.n_samples, 2);
        let permutations = |axis: usize| {
            let key = splitmix(stream.scramble_bits(), axis as u64);
            [0, 1].map(|which| Permutation::new(p, splitmix(key, which)))
        };
        Box::new(ArrayPoints {
            p,
            permutations: (0..set.dim).map(permutations).collect(),
            offsets: UniformPoints { stream, dim: set.dim },
        })
    }
}

fn is_prime(n: u64) -> bool {
    n >= 2 && (2..).take_while(|k| k * k <= n).all(|k| !n.is_multiple_of(k))
}

struct ArrayPoints {
    p: u64,
    /// For each axis: of its strata, and of the slabs within a stratum.
    permutations: Vec<[Permutation; 2]>,
    offsets: UniformPoints,
}

impl Slabs for ArrayPoints {
    #[inline(always)]
    fn count(&self, _axis: usize) -> Divisor {
        Divisor::new(self.p * self.p)
    }
    #[inline(always)]
    fn list<const FMA: bool>(&self, axis: usize, first: u64, slabs: &mut [f64]) {
        let p = self.p;
        // Bose's array over the integers modulo p: any two of its columns take every pair of
        // values once. The symbol of point (row, column) is a row plus so many columns.
        let times = |axis: u64| axis.saturating_sub(1);
        let symbol = |axis: u64, row: u64, column: u64| match axis {
            1 => column,
            _ => (row + times(axis) % p * column) % p,
        };
        let axis = axis as u64;
        // Another column numbers the p points of a stratum (Jarosz et al. 2019, section 4).
        let other = match axis {
            _ if axis % 2 == 1 => axis - 1,
            _ if axis < p => axis + 1,
            _ => 0,
        };
        let [strata, within] = &self.permutations[axis as usize];
        for (index, slab) in (first..).zip(slabs) {
            let (row, column) = (index / p, index % p);
            let stratum = strata.get(symbol(axis, row, column));
            *slab = whole(stratum * p + within.get(symbol(other, row, column)));
        }
    }
}

impl ByAxis for ArrayPoints {
    fn dim(&self) -> usize {
        self.offsets.dim
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        self.offsets.write_in_slabs(isa, first, target, self);
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        self.offsets.stream = *stream;
        for (axis, both) in (0..).zip(&mut self.permutations) {
            let key = splitmix(stream.scramble_bits(), axis);
            for (which, permutation) in (0..).zip(both) {
                permutation.renew(splitmix(key, which));
            }
        }
        true
    }
}
