//! Uniform independent points: the paper's `O(1/N)` baseline.

use super::{Facts, Kind, Placement, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
use crate::simd::{self, BLOCK, Isa, Loop};

/// Uniform independent points in any dimension, any N.
#[derive(Debug, Clone, Copy)]
pub struct Random;

impl Sampler for Random {
    fn facts(&self) -> Facts {
        Facts {
            name: "random",
            summary: "uniform independent points",
            source: "Mitchell 1996; any text on Monte Carlo",
            stream_id: 0,
            kind: Kind::Sequence,
            max_dim: usize::MAX,
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
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
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        let pairs = self.dim.div_ceil(2) as u64;
        if self.dim.is_multiple_of(2) {
            // The points are the pairs in their order.
            simd::run(isa, PairLoop { stream: self.stream, first: first * pairs, pairs: points });
            return;
        }
        // The last pair of each point gives one coordinate.
        let mut drawn = [0.0; 2 * BLOCK];
        let mut slots = points.chunks_exact_mut(self.dim).flat_map(|p| p.chunks_mut(2)).peekable();
        for first in (first * pairs..).step_by(BLOCK) {
            if slots.peek().is_none() {
                break;
            }
            simd::run(isa, PairLoop { stream: self.stream, first, pairs: &mut drawn });
            for (pair, slot) in drawn.chunks_exact(2).zip(slots.by_ref()) {
                slot.copy_from_slice(&pair[..slot.len()]);
            }
        }
    }
}

/// Pairs `first ..` of a stream.
struct PairLoop<'a> {
    stream: Stream,
    first: u64,
    pairs: &'a mut [f64],
}

impl Loop for PairLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (_, draws, run) in self.stream.runs(self.first, self.pairs) {
            for (lane, run) in (0..u32::MAX).step_by(BLOCK).zip(run.chunks_mut(2 * BLOCK)) {
                let block = draws.block(lane, run.len() / 2);
                for (pair, drawn) in run.chunks_exact_mut(2).zip(block.pairs()) {
                    pair.copy_from_slice(&drawn);
                }
            }
        }
    }
}
