//! One trial: N points in, the mean of f at them out.

use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Sampler};
use crate::variance::{CompensatedSum, neumaier_sum};
use std::sync::atomic::{AtomicBool, Ordering};

/// Points evaluated at a time, where the integrand does not ask for more: small enough for the first-level cache in any practical d.
const BLOCK: usize = 512;

/// Overwrites `means` with the estimates of trials `first_trial ..`: each the mean of f over
/// its own fresh point set. `set.key.trial` is ignored. Once `cancel` is set, what is
/// written means nothing.
pub fn trial_means(
    integrand: &dyn Integrand,
    sampler: &dyn Sampler,
    set: &PointSet,
    first_trial: u32,
    means: &mut [f64],
    cancel: &AtomicBool,
) {
    if integrand.trial_means(sampler, set, first_trial, means, cancel) {
        return;
    }
    let n = set.key.n_samples;
    let at_once = integrand.batch();
    let block = usize::try_from(n).unwrap_or(usize::MAX).min(BLOCK.max(at_once));
    let n_together = (at_once / block).max(1);
    let mut points = vec![0.0; n_together * block * set.dim];
    let mut values = vec![0.0; n_together * block];
    for (first, means) in (first_trial..).step_by(n_together).zip(means.chunks_mut(n_together)) {
        let source = |trial| {
            let key = StreamKey { trial, ..set.key };
            sampler.points(&PointSet { key, ..*set })
        };
        let sources: Vec<_> = (first..).take(means.len()).map(source).collect();
        let mut sums = vec![CompensatedSum::default(); means.len()];
        let mut weights = sums.clone();
        for from in (0..n).step_by(block).take_while(|_| !cancel.load(Ordering::Relaxed)) {
            let len = block.min((n - from) as usize);
            let points = &mut points[..means.len() * len * set.dim];
            let values = &mut values[..means.len() * len];
            for (source, points) in sources.iter().zip(points.chunks_exact_mut(len * set.dim)) {
                source.fill(from, points);
            }
            if integrand.is_weighted() {
                integrand.weigh_block(points, values);
                add(&mut weights, values.chunks_exact(len));
            }
            integrand.eval_block(points, values);
            add(&mut sums, values.chunks_exact(len));
        }
        for ((mean, sum), weight) in means.iter_mut().zip(sums).zip(weights) {
            let of = if integrand.is_weighted() { weight.total() } else { n as f64 };
            *mean = sum.total() / of;
        }
    }
}

/// Adds to each trial's sum those of its values, a block at a time.
fn add<'a>(sums: &mut [CompensatedSum], values: impl Iterator<Item = &'a [f64]>) {
    for (sum, values) in sums.iter_mut().zip(values) {
        for block in values.chunks(BLOCK) {
            sum.add(neumaier_sum(block.iter().copied()));
        }
    }
}
