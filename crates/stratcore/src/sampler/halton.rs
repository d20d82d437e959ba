//! The Halton sequence.

use super::hash::splitmix;
use super::radical::{RadicalInverse, primes};
use super::sobol::MOST_POINTS;
use super::target::{ByAxis, Target};
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
use crate::simd::Isa;
use std::sync::OnceLock;

/// Radical inverses of the index in the first d primes.
///
/// Its scrambles draw each digit's permutation from the affine ones, x to ax + c modulo the
/// base: in bases 2 and 3 all there are; above, a part of them that gives every estimate the
/// mean and the variance that uniform permutations would.
#[derive(Debug, Clone, Copy)]
pub struct Halton;

impl Sampler for Halton {
    fn facts(&self) -> Facts {
        Facts {
            name: "halton",
            summary: "Halton sequence: radical inverses in the first d primes, any N",
            source: "Halton 1960; digit scrambles: Owen 1995, Matousek 1998",
            stream_id: 7,
            kind: Kind::Sequence,
            max_dim: BASES,
            counts: Admissible::UpTo(MOST_POINTS),
            scrambles: SCRAMBLES,
            is_random: false,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let mut points = HaltonPoints { axes: radical_inverses(set, set.dim) };
        points.renew(&set.key.stream());
        Box::new(points)
    }
}

/// Scrambles of radical inverses.
pub(super) const SCRAMBLES: &[Scramble] =
    &[Scramble::Owen, Scramble::DigitPermutation, Scramble::TorusShift, Scramble::None];

/// Dimensions: the number of prime bases kept.
pub(super) const BASES: usize = 1024;

/// The first `count` coordinates of the Halton sequence, to be scrambled as the set says.
pub(super) fn radical_inverses(set: &PointSet, count: usize) -> Vec<RadicalInverse> {
    static PRIMES: OnceLock<Vec<u64>> = OnceLock::new();
    let bases = PRIMES.get_or_init(|| primes(BASES));
    let axis = |base: &u64| RadicalInverse::new(*base, set.key.n_samples, set.scramble, set.dim);
    bases[..count].iter().map(axis).collect()
}

/// Scrambles them as those of a stream.
pub(super) fn scramble(axes: &mut [RadicalInverse], bits: u64) {
    for (axis, coordinates) in (0..).zip(axes) {
        coordinates.scramble(splitmix(bits, axis));
    }
}

struct HaltonPoints {
    axes: Vec<RadicalInverse>,
}

impl ByAxis for HaltonPoints {
    fn dim(&self) -> usize {
        self.axes.len()
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        for (axis, coordinates) in self.axes.iter().enumerate() {
            coordinates.fill(isa, first, target, axis);
        }
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        scramble(&mut self.axes, stream.scramble_bits());
        true
    }
}
