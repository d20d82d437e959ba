//! Trials of points that the kernels do not draw themselves.

use crate::rng::{Stream, StreamKey, TOGETHER};
use crate::sampler::{PointSet, Points, Sampler};
use crate::simd::{self, Isa, Loop, Scattered, Sorted, Trials};
use std::sync::atomic::Ordering;

/// Points that are evaluated together, of several trials where one has fewer: enough for a vector
/// of samples in most cells of a pixel, few enough for a near cache.
const BATCH: usize = 1 << 12;

/// Overwrites `sums` with those of `trials`, each over the points of its own set of what
/// `evaluate` puts down for them, given their positions about the pixel's centre. Once they are
/// cancelled, what is written means nothing.
pub(super) fn sums(
    isa: Isa,
    sampler: &dyn Sampler,
    set: &PointSet,
    trials: &Trials<'_>,
    sums: &mut [f64],
    room: &mut Scattered,
    mut evaluate: impl FnMut([&[f32]; 2], &mut [f32], &mut Sorted),
) {
    let n = set.key.n_samples;
    let block = usize::try_from(n).unwrap_or(usize::MAX).min(BATCH);
    let n_together = (BATCH / block).min(sums.len()).max(1);
    let ([s, t, values], sorted) = room.columns(n_together * block);
    let (mut points, mut made): (Option<Box<dyn Points>>, _) = (None, None);
    let mut streams = Streams::new(isa, &set.key, trials.first);
    for (at, sums) in (0..).step_by(n_together).zip(sums.chunks_mut(n_together)) {
        let first = trials.first.wrapping_add(at);
        sums.fill(0.0);
        for from in (0..n).step_by(block).take_while(|_| !trials.cancel.load(Ordering::Relaxed)) {
            let len = block.min((n - from) as usize);
            let all = sums.len() * len;
            let (s, t, values) = (&mut s[..all], &mut t[..all], &mut values[..all]);
            let columns = s.chunks_exact_mut(len).zip(t.chunks_exact_mut(len));
            for (at, (s, t)) in (0..).zip(columns) {
                let trial = first.wrapping_add(at);
                // A set that is evaluated part by part is made once.
                if made != Some(trial) {
                    let stream = streams.get(trial);
                    let renewed = points.as_mut().is_some_and(|points| points.renew(stream));
                    if !renewed {
                        let key = StreamKey { trial, ..set.key };
                        points = Some(sampler.points(&PointSet { key, ..*set }));
                    }
                    made = Some(trial);
                }
                if let Some(points) = &points {
                    points.fill_centred(isa, from, [s, t]);
                }
            }
            evaluate([s, t], values, sorted);
            simd::run(isa, SumLoop { values, len, sums });
        }
    }
}

/// Streams of trials one after the other, made so many at a time.
struct Streams<'a> {
    isa: Isa,
    key: &'a StreamKey,
    first: u32,
    made: [Stream; TOGETHER],
}

impl<'a> Streams<'a> {
    fn new(isa: Isa, key: &'a StreamKey, first: u32) -> Self {
        let mut streams = Self { isa, key, first, made: [Stream::of_bits(0); TOGETHER] };
        simd::run(isa, &mut streams);
        streams
    }

    fn get(&mut self, trial: u32) -> &Stream {
        if trial.wrapping_sub(self.first) as usize >= TOGETHER {
            self.first = trial;
            simd::run(self.isa, &mut *self);
        }
        &self.made[trial.wrapping_sub(self.first) as usize]
    }
}

impl Loop for &mut Streams<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        self.made = self.key.streams_of_trials(self.first);
    }
}

/// Adds to each trial's sum those of its `len` values.
struct SumLoop<'a> {
    values: &'a [f32],
    len: usize,
    sums: &'a mut [f64],
}

impl Loop for SumLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (sum, values) in self.sums.iter_mut().zip(self.values.chunks_exact(self.len)) {
            // So many sums side by side, whatever the vectors.
            let mut lanes = [0.0; 8];
            let (blocks, rest) = values.as_chunks::<8>();
            for block in blocks {
                for (lane, value) in lanes.iter_mut().zip(block) {
                    *lane += f64::from(*value);
                }
            }
            for (lane, value) in lanes.iter_mut().zip(rest) {
                *lane += f64::from(*value);
            }
            *sum += lanes.iter().sum::<f64>();
        }
    }
}
