//! Points of many trials at once: a lane is a trial.

use super::Strata;
use super::vector::{MAX_LANES, Vector};
use crate::rng::Stream;

/// LANES trials: what each draws from, and the sum of its values.
#[derive(Clone, Copy)]
pub(super) struct Group<V: Vector> {
    y: V::Int,
    z: V::Int,
    yz: V::Int,
    pub(super) sum: V::Sum,
}

impl<V: Vector> Group<V> {
    /// Of up to LANES streams; further lanes draw from a stream that nobody reads.
    #[inline(always)]
    pub(super) fn new(streams: &[Stream]) -> Self {
        let (mut y, mut z) = ([1; MAX_LANES], [1; MAX_LANES]);
        for (l, stream) in streams.iter().enumerate() {
            y[l] = first_step(stream.words[0]);
            z[l] = first_step(stream.words[1]);
        }
        let (y, z) = (V::int_load(&y), V::int_load(&z));
        Self { y, z, yz: V::int_mul(y, z), sum: V::sum_zero() }
    }

    /// One sample per trial in the stratum `index`: its position about the pixel's centre, from
    /// the upper 24 bits of the first two words of [`pcg3d`](crate::rng::pcg3d).
    #[inline(always)]
    pub(super) fn sample(&self, index: u32, step: [f32; 2], origin: [f32; 2]) -> [V; 2] {
        let x = V::int_add(V::int_splat(first_step(index)), self.yz);
        let y = V::int_add(self.y, V::int_mul(self.z, x));
        let z = V::int_add(self.z, V::int_mul(x, y));
        let [x, y, z] = [x, y, z].map(V::int_xorshift16);
        let x = V::int_add(x, V::int_mul(y, z));
        let y = V::int_add(y, V::int_mul(z, x));
        let place = |word, axis: usize| {
            V::upper24(word).mul_add(V::splat(step[axis]), V::splat(origin[axis]))
        };
        [place(x, 0), place(y, 1)]
    }
}

/// pcg3d's first step, an LCG, on one word.
#[inline(always)]
fn first_step(word: u32) -> u32 {
    word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)
}

/// Where the samples of a trial lie.
pub(crate) enum Placement<'a> {
    /// This many, anywhere in the pixel.
    Anywhere(u32),
    /// One in each stratum.
    Strata(&'a Strata),
}

impl Placement<'_> {
    #[inline(always)]
    pub(super) fn len(&self) -> u32 {
        match self {
            Self::Anywhere(n) => *n,
            Self::Strata(strata) => strata.per_axis[0] * strata.per_axis[1],
        }
    }

    #[inline(always)]
    pub(super) fn sample<V: Vector>(&self, group: &Group<V>, index: u32) -> [V; 2] {
        match self {
            Self::Anywhere(_) => group.sample(index, [1.0 / (1 << 24) as f32; 2], [-0.5; 2]),
            Self::Strata(strata) => {
                let [i, j] = [index % strata.per_axis[0], index / strata.per_axis[0]];
                group.sample(index, strata.step, strata.origin(i, j))
            }
        }
    }
}
