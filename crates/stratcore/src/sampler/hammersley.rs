//! The Hammersley set.

use super::halton::{BASES, SCRAMBLES, radical_inverses, scramble};
use super::hash::splitmix;
use super::radical::{RadicalInverse, Tail};
use super::random::count_up;
use super::sobol::MOST_POINTS;
use super::target::{ByAxis, Target};
use super::{Admissible, BELOW_ONE, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
use crate::simd::{self, BLOCK, Divisor, Isa, Loop};

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

/// The first coordinate of points `first ..`: their number, with a tail, over n.
struct CountLoop<'a, 'b> {
    n: Divisor,
    tail: &'a Tail,
    first: u64,
    target: &'a mut Target<'b>,
}

impl Loop for CountLoop<'_, '_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { n, tail, first, target } = self;
        let mut sums = [0.0; BLOCK];
        for at in (0..target.len()).step_by(BLOCK) {
            let sums = &mut sums[..BLOCK.min(target.len() - at)];
            let first = first + at as u64;
            count_up(first, sums);
            tail.add(first, sums);
            target.put(0, at, sums.iter().map(|sum| n.divide::<FMA>(*sum).min(BELOW_ONE)));
        }
    }
}

impl ByAxis for HammersleyPoints {
    fn dim(&self) -> usize {
        self.others.len() + 1
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        simd::run(isa, CountLoop { n: self.n, tail: &self.tail, first, target });
        for (other, coordinates) in self.others.iter().enumerate() {
            coordinates.fill(isa, first, target, other + 1);
        }
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        let bits = stream.scramble_bits();
        // Keys of the other axes count from 0.
        self.tail = Tail::new(self.scramble, splitmix(bits, BASES as u64));
        scramble(&mut self.others, bits);
        true
    }
}
