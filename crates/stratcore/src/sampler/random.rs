//! Uniform independent points: the paper's `O(1/N)` baseline.

use super::hash::whole;
use super::{Admissible, BELOW_ONE, Facts, Kind, Placement, PointSet, Points, Sampler, Scramble};
use crate::rng::{PairMap, Stream, StreamKey};
use crate::simd::{self, BLOCK, Divisor, Isa, Loop};

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
            counts: Admissible::UpTo(StreamKey::MAX_SAMPLES - 1),
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
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
        let Self { stream, dim } = *self;
        let pairs = dim.div_ceil(2) as u64;
        if dim.is_multiple_of(2) {
            // The points are the pairs in their order.
            let (first, map) = (first * pairs, AsDrawn);
            simd::run(isa, PairLoop { stream, first, pairs: points, map });
            return;
        }
        // The last pair of each point gives one coordinate.
        let mut drawn = [0.0; 2 * BLOCK];
        let mut slots = points.chunks_exact_mut(dim).flat_map(|p| p.chunks_mut(2)).peekable();
        for first in (first * pairs..).step_by(BLOCK) {
            if slots.peek().is_none() {
                break;
            }
            simd::run(isa, PairLoop { stream, first, pairs: &mut drawn, map: AsDrawn });
            for (pair, slot) in drawn.chunks_exact(2).zip(slots.by_ref()) {
                slot.copy_from_slice(&pair[..slot.len()]);
            }
        }
    }
}

impl UniformPoints {
    /// The same points, each coordinate moved into one of `n` slabs along its axis; `list` tells
    /// for a point's index, coordinate by coordinate, which.
    #[inline]
    pub(super) fn fill_in_slabs(
        &self,
        isa: Isa,
        n: u64,
        first: u64,
        points: &mut [f64],
        mut list: impl FnMut(u64, &mut [u64]),
    ) {
        self.fill_with(isa, first, points);
        let (dim, n) = (self.dim, Divisor::new(n));
        let mut slabs = vec![0; points.len().min(dim * BLOCK)];
        let runs = points.chunks_mut(dim * BLOCK);
        for (first, points) in (first..).step_by(BLOCK).zip(runs) {
            let slabs = &mut slabs[..points.len()];
            for (index, slabs) in (first..).zip(slabs.chunks_exact_mut(dim)) {
                list(index, slabs);
            }
            simd::run(isa, SlabLoop { slabs, n, points });
        }
    }
}

struct SlabLoop<'a> {
    slabs: &'a [u64],
    n: Divisor,
    points: &'a mut [f64],
}

impl Loop for SlabLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (x, slab) in self.points.iter_mut().zip(self.slabs) {
            *x = self.n.divide::<FMA>(whole(*slab) + *x).min(BELOW_ONE);
        }
    }
}

/// Pairs `first ..` of a stream, mapped.
pub(super) struct PairLoop<'a, M> {
    pub(super) stream: Stream,
    pub(super) first: u64,
    pub(super) pairs: &'a mut [f64],
    pub(super) map: M,
}

impl<M: PairMap> Loop for PairLoop<'_, M> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        self.stream.fill::<FMA>(self.first, self.pairs, self.map);
    }
}

#[derive(Clone, Copy)]
struct AsDrawn;

impl PairMap for AsDrawn {
    #[inline(always)]
    fn map<const FMA: bool>(self, _index: f64, pair: [f64; 2]) -> [f64; 2] {
        pair
    }
}
