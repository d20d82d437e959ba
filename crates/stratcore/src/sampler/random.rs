//! Uniform independent points: the paper's `O(1/N)` baseline.

use super::hash::whole;
use super::target::Target;
use super::{Admissible, BELOW_ONE, Facts, Kind, Placement, PointSet, Points, Sampler, Scramble};
use crate::rng::{PairMap, Stream, StreamKey, unit_pair};
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
    fn placement(&self, _dim: usize) -> Placement {
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

/// Along each axis, slabs of equal width and which of them each point lies in.
pub(super) trait Slabs {
    /// How many there are along an axis.
    fn count(&self, axis: usize) -> Divisor;
    /// Overwrites `slabs` with those of points `first ..` along an axis.
    fn list<const FMA: bool>(&self, axis: usize, first: u64, slabs: &mut [f64]);
}

/// Overwrites `numbers` with `first`, below 2^52, and the numbers after it.
#[inline(always)]
pub(super) fn count_up(first: u64, numbers: &mut [f64]) {
    for (at, number) in (first..).zip(numbers) {
        *number = whole(at);
    }
}

impl UniformPoints {
    /// Writes the same points `first ..`, each coordinate moved into its slab.
    pub(super) fn write_in_slabs(
        &self,
        isa: Isa,
        first: u64,
        target: &mut Target<'_>,
        slabs: &impl Slabs,
    ) {
        simd::run(isa, SlabLoop { points: self, first, target, slabs });
    }
}

struct SlabLoop<'a, 'b, S> {
    points: &'a UniformPoints,
    first: u64,
    target: &'a mut Target<'b>,
    slabs: &'a S,
}

impl<S: Slabs> Loop for SlabLoop<'_, '_, S> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { points: UniformPoints { stream, dim }, first, target, slabs: list } = self;
        let pairs = dim.div_ceil(2);
        let mut words = [[0; BLOCK]; 3];
        let mut slabs = [0.0; BLOCK];
        let mut offsets = [[0.0; BLOCK]; 2];
        for at in (0..target.len()).step_by(BLOCK) {
            let (first, len) = (first + at as u64, BLOCK.min(target.len() - at));
            let slabs = &mut slabs[..len];
            for pair in 0..pairs {
                let draw = first * pairs as u64 + pair as u64;
                stream.draws(draw, pairs as u32, len, &mut words);
                let [xs, ys] = &mut offsets;
                for (l, (x, y)) in xs.iter_mut().zip(ys).enumerate().take(len) {
                    [*x, *y] = unit_pair([words[0][l], words[1][l], words[2][l]]);
                }
                for (axis, offsets) in (2 * pair..*dim).zip(&offsets) {
                    list.list::<FMA>(axis, first, slabs);
                    let n = list.count(axis);
                    // With many slabs a point can round up to 1.
                    let place = |(slab, x): (&f64, &f64)| n.divide::<FMA>(slab + x).min(BELOW_ONE);
                    target.put(axis, at, slabs.iter().zip(offsets).map(place));
                }
            }
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
