//! Points of many trials at once: a lane is a trial.

use super::vector::{MAX_LANES, Vector};
use crate::rng::StreamKey;
use std::sync::atomic::AtomicBool;

/// Trials from `first` on.
pub(crate) struct Trials<'a> {
    /// Of the first trial of all; its `trial` is ignored.
    pub key: &'a StreamKey,
    pub first: u32,
    /// Seen within some milliseconds.
    pub cancel: &'a AtomicBool,
}

/// LANES trials: what each draws from, and the sum of its values.
#[derive(Clone, Copy)]
pub(super) struct Group<V: Vector> {
    y: V::Int,
    z: V::Int,
    yz: V::Int,
    pub(super) sum: V::Sum,
    /// Lanes that have a trial.
    pub(super) n_trials: usize,
}

impl<V: Vector> Group<V> {
    /// Of so many trials from `first` on. Lanes beyond the last draw like the others; nobody
    /// reads their sums.
    #[inline(always)]
    fn new(key: &StreamKey, first: u32, n_trials: usize) -> Self {
        let mut words = key.words_of_trials::<MAX_LANES>(first);
        for word in words.iter_mut().flatten() {
            *word = first_step(*word);
        }
        let (y, z) = (V::int_load(&words[0]), V::int_load(&words[1]));
        Self { y, z, yz: V::int_mul(y, z), sum: V::sum_zero(), n_trials }
    }

    /// As many as it takes for `n_trials`.
    #[inline(always)]
    pub(super) fn all(trials: &Trials<'_>, n_trials: usize) -> Vec<Self> {
        let mut groups = Vec::with_capacity(n_trials.div_ceil(V::LANES));
        for at in (0..n_trials).step_by(V::LANES) {
            let n = V::LANES.min(n_trials - at);
            groups.push(Self::new(trials.key, trials.first.wrapping_add(at as u32), n));
        }
        groups
    }

    /// Writes each trial's sum.
    #[inline(always)]
    pub(super) fn store(groups: &[Self], sums: &mut [f64]) {
        for (sums, group) in sums.chunks_mut(V::LANES).zip(groups) {
            sums.copy_from_slice(&V::sum_store(group.sum)[..sums.len()]);
        }
    }

    /// Sample `index` of each trial, anywhere in the pixel.
    #[inline(always)]
    pub(super) fn anywhere(&self, index: u32) -> [V; 2] {
        self.sample(index, [1.0 / (1 << 24) as f32; 2], [-0.5; 2])
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
