//! Uniform independent points: the paper's `O(1/N)` baseline.

use super::{Kind, Placement, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;

/// Uniform independent points in any dimension, any N.
#[derive(Debug, Clone, Copy)]
pub struct Random;

impl Sampler for Random {
    fn name(&self) -> &'static str {
        "random"
    }
    fn summary(&self) -> &'static str {
        "uniform independent points"
    }
    fn source(&self) -> &'static str {
        "Mitchell 1996; any text on Monte Carlo"
    }
    fn stream_id(&self) -> u8 {
        0
    }
    fn kind(&self) -> Kind {
        Kind::Sequence
    }
    fn max_dim(&self) -> usize {
        usize::MAX
    }
    fn scrambles(&self) -> &'static [Scramble] {
        &[Scramble::None, Scramble::TorusShift]
    }
    fn is_randomised(&self, _scramble: Scramble) -> bool {
        true
    }
    fn admits(&self, n: u64, _dim: usize, _rectangular: bool) -> bool {
        n >= 1
    }
    fn neighbours(&self, _n: u64, _dim: usize) -> (Option<u64>, Option<u64>) {
        (None, Some(1))
    }
    fn placement(&self) -> Placement {
        Placement::Independent
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        Box::new(UniformPoints { stream: set.key.stream(), dim: set.dim })
    }
}

/// Coordinates 2j and 2j + 1 of point i are pair `i * ceil(d/2) + j` of the stream.
pub(super) struct UniformPoints {
    pub(super) stream: Stream,
    pub(super) dim: usize,
}

impl Points for UniformPoints {
    fn fill(&self, first: u64, points: &mut [f64]) {
        let pairs = self.dim.div_ceil(2) as u64;
        for (index, point) in (first..).zip(points.chunks_exact_mut(self.dim)) {
            for (j, coordinates) in (0..).zip(point.chunks_mut(2)) {
                let pair = self.stream.pair(index * pairs + j);
                coordinates.copy_from_slice(&pair[..coordinates.len()]);
            }
        }
    }
}
