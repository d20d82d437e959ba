//! Points of many trials at once: a lane is a trial.

use super::vector::{MAX_LANES, Vector};
use crate::rng::{Stream, StreamKey, TOGETHER};
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
    words: Words<V>,
    pub(super) sum: V::Sum,
    /// Lanes that have a trial.
    pub(super) n_trials: usize,
}

/// What LANES samples are drawn from, each by its trial.
#[derive(Clone, Copy)]
struct Words<V: Vector> {
    y: V::Int,
    z: V::Int,
    yz: V::Int,
}

/// Few trials in several strata at once, stratum after stratum.
#[derive(Clone, Copy)]
pub(super) struct Spread<V: Vector>(Words<V>);

/// Trials that are spread out, at most.
pub(super) const MAX_SPREAD: usize = 2;

impl<V: Vector> Group<V> {
    /// Overwrites `groups` with as many as it takes for `n_trials`, and gives the last of them
    /// spread out if its trials are few. Lanes beyond the last trial draw like the others; nobody
    /// reads their sums.
    #[inline(always)]
    pub(super) fn all(
        trials: &Trials<'_>,
        n_trials: usize,
        groups: &mut Vec<Self>,
    ) -> Option<Spread<V>> {
        groups.clear();
        let mut spread = None;
        for at in (0..n_trials).step_by(MAX_LANES) {
            let mut words = [[0; MAX_LANES]; 2];
            for from in (0..MAX_LANES.min(n_trials - at)).step_by(TOGETHER) {
                let first = trials.first.wrapping_add((at + from) as u32);
                let made = trials.key.words_of_trials::<TOGETHER>(first);
                for (words, made) in words.iter_mut().zip(made) {
                    words[from..from + TOGETHER].copy_from_slice(&made);
                }
            }
            for word in words.as_flattened_mut() {
                *word = first_step(Stream::even(*word));
            }
            for from in (0..MAX_LANES.min(n_trials - at)).step_by(V::LANES) {
                let n_trials = V::LANES.min(n_trials - at - from);
                let words = [&words[0][from..], &words[1][from..]];
                groups.push(Self { words: Words::new(words), sum: V::sum_zero(), n_trials });
                spread = Spread::new(words, n_trials);
            }
        }
        spread
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

    /// One sample per trial in the stratum `index`: its position about the pixel's centre.
    #[inline(always)]
    pub(super) fn sample(&self, index: u32, step: [f32; 2], origin: [f32; 2]) -> [V; 2] {
        self.words.sample(index, step, [V::splat(origin[0]), V::splat(origin[1])])
    }
}

impl<V: Vector> Words<V> {
    /// Of the first LANES trials; pcg3d's first step is done.
    #[inline(always)]
    fn new([ys, zs]: [&[u32]; 2]) -> Self {
        let (y, z) = (V::int_load(ys), V::int_load(zs));
        Self { y, z, yz: V::int_mul(y, z) }
    }

    /// A position from the upper 24 bits of the first two words of
    /// [`pcg3d`](crate::rng::pcg3d).
    #[inline(always)]
    fn sample(&self, index: u32, step: [f32; 2], origin: [V; 2]) -> [V; 2] {
        let x = V::int_add(V::int_splat(first_step(index)), self.yz);
        let y = V::int_add(self.y, V::int_mul(self.z, x));
        let z = V::int_add(self.z, V::int_mul(x, y));
        let (x, y, z) = (V::int_xorshift16(x), V::int_xorshift16(y), V::int_xorshift16(z));
        let x = V::int_add(x, V::int_mul(y, z));
        let y = V::int_add(y, V::int_mul(z, x));
        let place =
            |word, axis: usize| V::upper24(word).mul_add(V::splat(step[axis]), origin[axis]);
        [place(x, 0), place(y, 1)]
    }
}

impl<V: Vector> Spread<V> {
    /// None where they are more than [`MAX_SPREAD`], or leave room for less than eight strata,
    /// which would gain nothing.
    #[inline(always)]
    fn new(words: [&[u32]; 2], n_trials: usize) -> Option<Self> {
        let n_strata = V::LANES / n_trials;
        if n_trials > MAX_SPREAD || n_strata < 8 {
            return None;
        }
        let mut strata = [0; MAX_LANES];
        let mut repeated = [[0; MAX_LANES]; 2];
        for stratum in 0..n_strata {
            let lanes = stratum * n_trials..(stratum + 1) * n_trials;
            strata[lanes.clone()].fill(stratum as u32);
            for (to, words) in repeated.iter_mut().zip(words) {
                to[lanes.clone()].copy_from_slice(&words[..n_trials]);
            }
        }
        let mut words = Words::new([&repeated[0], &repeated[1]]);
        // The first step is linear: a later stratum's index adds to its result.
        let later = V::int_mul(V::int_load(&strata), V::int_splat(MULTIPLIER));
        words.yz = V::int_add(words.yz, later);
        Some(Self(words))
    }

    /// One sample per lane, from the stratum `index` on: origins lane by lane.
    #[inline(always)]
    pub(super) fn sample(&self, index: u32, step: [f32; 2], origin: [V; 2]) -> [V; 2] {
        self.0.sample(index, step, origin)
    }
}

const MULTIPLIER: u32 = 1_664_525;

/// pcg3d's first step, an LCG, on one word.
#[inline(always)]
fn first_step(word: u32) -> u32 {
    word.wrapping_mul(MULTIPLIER).wrapping_add(1_013_904_223)
}
