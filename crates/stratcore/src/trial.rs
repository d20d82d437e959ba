//! One trial: N points in, the mean of f at them out.

use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Sampler};
use crate::variance::neumaier_sum;
use std::sync::atomic::{AtomicBool, Ordering};

/// Points evaluated at a time: small enough for the first-level cache in any practical d.
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
    let block = BLOCK.min(usize::try_from(n).unwrap_or(BLOCK));
    let mut points = vec![0.0; block * set.dim];
    let mut values = vec![0.0; block];
    for (at, mean) in (0..).zip(means) {
        let trial = first_trial.wrapping_add(at);
        let key = StreamKey { trial, ..set.key };
        let source = sampler.points(&PointSet { key, ..*set });
        let mut weight_sums = Vec::new();
        let sum = neumaier_sum(
            (0..n).step_by(block).take_while(|_| !cancel.load(Ordering::Relaxed)).map(|first| {
                let len = block.min((n - first) as usize);
                source.fill(first, &mut points[..len * set.dim]);
                if integrand.is_weighted() {
                    integrand.weigh_block(&points[..len * set.dim], &mut values[..len]);
                    weight_sums.push(neumaier_sum(values[..len].iter().copied()));
                }
                integrand.eval_block(&points[..len * set.dim], &mut values[..len]);
                neumaier_sum(values[..len].iter().copied())
            }),
        );
        let of = if integrand.is_weighted() { neumaier_sum(weight_sums) } else { n as f64 };
        *mean = sum / of;
    }
}
