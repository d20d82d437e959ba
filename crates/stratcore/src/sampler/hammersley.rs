//! The Hammersley set.

use super::halton::{BASES, radical_inverses};
use super::hash::splitmix;
use super::radical::{RadicalInverse, Tail};
use super::sobol::{MOST_POINTS, digital_neighbours};
use super::{BELOW_ONE, Kind, PointSet, Points, Sampler, Scramble};

/// i/N and the Halton sequence in d - 1 dimensions. Scrambles work on the digits of the latter
/// and move the former within its 1/N.
#[derive(Debug, Clone, Copy)]
pub struct Hammersley;

impl Sampler for Hammersley {
    fn name(&self) -> &'static str {
        "hammersley"
    }
    fn summary(&self) -> &'static str {
        "Hammersley set: i/N beside d - 1 radical inverses"
    }
    fn source(&self) -> &'static str {
        "Hammersley 1960; digit scrambles: Owen 1995, Matousek 1998"
    }
    fn stream_id(&self) -> u8 {
        6
    }
    fn kind(&self) -> Kind {
        Kind::Set
    }
    fn max_dim(&self) -> usize {
        BASES + 1
    }
    fn scrambles(&self) -> &'static [Scramble] {
        &[Scramble::Owen, Scramble::DigitPermutation, Scramble::TorusShift, Scramble::None]
    }
    fn is_randomised(&self, scramble: Scramble) -> bool {
        scramble != Scramble::None
    }
    fn admits(&self, n: u64, _dim: usize, _rectangular: bool) -> bool {
        (1..=MOST_POINTS).contains(&n)
    }
    fn neighbours(&self, n: u64, _dim: usize) -> (Option<u64>, Option<u64>) {
        digital_neighbours(n)
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        // Keys of the other axes count from 0.
        let key = splitmix(set.key.stream().scramble_bits(), BASES as u64);
        Box::new(HammersleyPoints {
            n: set.key.n_samples as f64,
            tail: Tail::new(set.scramble, key),
            others: radical_inverses(set, set.dim - 1),
        })
    }
}

struct HammersleyPoints {
    n: f64,
    tail: Tail,
    others: Vec<RadicalInverse>,
}

impl Points for HammersleyPoints {
    fn fill(&self, first: u64, points: &mut [f64]) {
        let dim = self.others.len() + 1;
        for (index, point) in (first..).zip(points.chunks_exact_mut(dim)) {
            point[0] = ((index as f64 + self.tail.at(index)) / self.n).min(BELOW_ONE);
        }
        for (other, coordinates) in self.others.iter().enumerate() {
            coordinates.fill(first, points, other + 1, dim);
        }
    }
}
