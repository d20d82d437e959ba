//! The Hammersley set.

use super::halton::{BASES, SCRAMBLES, radical_inverses, scramble};
use super::hash::splitmix;
use super::radical::{FractionLoop, RadicalInverse, Tail, TailLoop};
use super::sobol::MOST_POINTS;
use super::target::Target;
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
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
        let mut points = HammersleyPoints {
            n: Divisor::new(set.key.n_samples),
            scramble: set.scramble,
            tail: Tail::Common(0.0),
            others: radical_inverses(set, set.dim - 1),
        };
        points.renew(&set.key.stream());
        Box::new(points)
    }
}

struct HammersleyPoints {
    n: Divisor,
    scramble: Scramble,
    tail: Tail,
    others: Vec<RadicalInverse>,
}

impl HammersleyPoints {
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        for at in (0..target.len()).step_by(BLOCK) {
            let len = BLOCK.min(target.len() - at);
            let from = first + at as u64;
            let mut sums: [f64; BLOCK] = std::array::from_fn(|i| (from + i as u64) as f64);
            let (sums, scale) = (&mut sums[..len], self.n);
            simd::run(isa, TailLoop { tail: &self.tail, first: from, sums });
            simd::run(isa, FractionLoop { sums, scale, target, axis: 0, at });
        }
        for (other, coordinates) in self.others.iter().enumerate() {
            coordinates.fill(isa, first, target, other + 1);
        }
    }
}

impl Points for HammersleyPoints {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        self.write(isa, first, &mut Target::Rows { points, dim: self.others.len() + 1 });
    }
    fn fill_centred(&self, isa: Isa, first: u64, columns: [&mut [f32]; 2]) {
        self.write(isa, first, &mut Target::Centred(columns));
    }
    fn renew(&mut self, stream: &Stream) -> bool {
        let bits = stream.scramble_bits();
        // Keys of the other axes count from 0.
        self.tail = Tail::new(self.scramble, splitmix(bits, BASES as u64));
        scramble(&mut self.others, bits);
        true
    }
}
