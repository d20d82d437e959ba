//! The Hammersley set.

use super::halton::{BASES, SCRAMBLES, radical_inverses};
use super::hash::splitmix;
use super::radical::{FractionLoop, RadicalInverse, Tail};
use super::sobol::MOST_POINTS;
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler};
use crate::simd::{self, BLOCK, Divisor, Isa};

/// i/N and the Halton sequence in d - 1 dimensions. Scrambles work on the digits of the latter
/// and move the former within its 1/N.
#[derive(Debug, Clone, Copy)]
pub struct Hammersley;

impl Sampler for Hammersley {
    fn facts(&self) -> Facts {
        Facts {
            name: "hammersley",
            summary: "Hammersley set: i/N beside d - 1 radical inverses",
            source: "Hammersley 1960; digit scrambles: Owen 1995, Matousek 1998",
            stream_id: 6,
            kind: Kind::Set,
            max_dim: BASES + 1,
            counts: Admissible::UpTo(MOST_POINTS),
            scrambles: SCRAMBLES,
            is_random: false,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        // Keys of the other axes count from 0.
        let key = splitmix(set.key.stream().scramble_bits(), BASES as u64);
        Box::new(HammersleyPoints {
            n: Divisor::new(set.key.n_samples),
            tail: Tail::new(set.scramble, key),
            others: radical_inverses(set, set.dim - 1),
        })
    }
}

struct HammersleyPoints {
    n: Divisor,
    tail: Tail,
    others: Vec<RadicalInverse>,
}

impl Points for HammersleyPoints {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        let dim = self.others.len() + 1;
        for (first, run) in (first..).step_by(BLOCK).zip(points.chunks_mut(BLOCK * dim)) {
            let cells: [u64; BLOCK] = std::array::from_fn(|i| first + i as u64);
            let (tail, scale) = (&self.tail, self.n);
            simd::run(isa, FractionLoop { cells: &cells, tail, scale, run, axis: 0, dim });
        }
        for (other, coordinates) in self.others.iter().enumerate() {
            coordinates.fill(isa, first, points, other + 1, dim);
        }
    }
}
