//! What error costs how much time: samplers and sample counts against one another.
//!
//! The error of an estimate is its root mean square deviation from the reference, over trials
//! and, for a picture, over pixels. Time is that of one thread, per sample, measured by the
//! caller's clock. From both follow the Pareto front, the N and the time that reach a target
//! error, and which sampler is the fastest way there.

mod beyond;
mod choice;
mod error_curve;
pub mod needed;
mod timing;

pub use choice::{Choice, Confirmation, Fastest, Reach};
pub use error_curve::ErrorRow;
pub use timing::{Quartiles, RowTime, Timing};

use crate::error::StudyError;
use crate::integrand::{Integrand, Reference};
use crate::sampler::{CountPolicy, PointSet, Scramble};
use crate::study::{Control, SamplerChoice, StudyPlan, StudyResult, study};
use crate::variance::Moments;
use rayon::prelude::*;
use serde::Serialize;
use std::time::Duration;

/// One integral of a trade: a pixel of a picture, or the whole of it.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// Addresses its randomness.
    pub pixel: [u32; 2],
    /// The integrand. All subjects of a trade have the same dimensions.
    pub integrand: &'a dyn Integrand,
}

/// An error to be reached.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Target {
    /// In the unit of the integrand: radiance, for a pixel.
    Absolute(f64),
    /// As a share of the mean over all subjects' references. (Of a picture's mean: a share of
    /// each pixel's own value asks for the impossible where the pixel is black.)
    Relative(f64),
}

impl Target {
    /// The error in the unit of the integrand.
    pub fn absolute(self, mean: f64) -> f64 {
        match self {
            Self::Absolute(error) => error,
            Self::Relative(share) => share * mean.abs(),
        }
    }
}

/// What is to be compared, and how.
#[derive(Clone)]
pub struct TradePlan {
    /// Samplers, counts, trials and seed of the measurement of errors.
    pub study: StudyPlan,
    /// Errors to be reached, each above 0.
    pub targets: Vec<Target>,
    /// Nanoseconds of one evaluation, in place of the measured ones: what the choice would be
    /// where shading is as dear as that.
    pub eval_cost: Option<f64>,
}

/// The trade.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TradeResult {
    /// Dimensions d.
    pub dim: usize,
    /// Integrals measured.
    pub subjects: usize,
    /// Seed of all randomness.
    pub seed: u64,
    /// Independent repeats M of each estimate.
    pub trials: u32,
    /// Mean of the subjects' references, and its standard error.
    pub reference: Reference,
    /// Nanoseconds of one evaluation where they were given, not measured.
    pub eval_cost: Option<f64>,
    /// How times were measured.
    pub timing: Timing,
    /// One per sampler of the plan.
    pub samplers: Vec<SamplerTrade>,
    /// One per target of the plan.
    pub choices: Vec<Choice>,
}

impl TradeResult {
    /// The ways to another error, by what was measured under `study`; not tried with fresh
    /// randomness.
    pub fn ways_to(&self, target: Target, study: &StudyPlan) -> Choice {
        let error = target.absolute(self.reference.mean);
        choice::choose(target, error, &self.samplers, study, self.dim)
    }
}

/// One sampler's curve of error against time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SamplerTrade {
    /// Sampler's name.
    pub name: &'static str,
    /// Its scramble.
    pub scramble: Scramble,
    /// In the order of N.
    pub rows: Vec<TradeRow>,
}

/// Error and time of one sampler at one N.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TradeRow {
    /// The error.
    #[serde(flatten)]
    pub error: ErrorRow,
    /// Time per sample.
    #[serde(flatten)]
    pub time: RowTime,
    /// Nanoseconds of one estimate of N samples: by the cost of evaluation that was given, or
    /// as measured.
    pub ns_per_estimate: Quartiles,
    /// 1/(MSE · time of one estimate), in 1/(unit² s); none for an error of zero.
    pub efficiency: Option<f64>,
    /// No other point of any sampler is both faster and more exact.
    pub pareto: bool,
}

/// Measures errors, then times, then chooses, measures an N beyond the plan's before it is
/// chosen, and confirms each choice with fresh randomness.
///
/// Errors are measured on all threads of the pool, times on the calling thread alone.
///
/// # Errors
/// As [`study`]; [`StudyError::EmptyPlan`] without subjects or targets.
pub fn trade(
    subjects: &[Subject<'_>],
    plan: &TradePlan,
    clock: &(dyn Fn() -> Duration + Sync),
    control: Control<'_>,
) -> Result<TradeResult, StudyError> {
    let first = subjects.first().ok_or(StudyError::EmptyPlan("pixels"))?;
    if plan.targets.is_empty() {
        return Err(StudyError::EmptyPlan("targets"));
    }
    let dim = first.integrand.dim();
    let counts = plan.study.counts_used(dim)?;
    let mut references = references(subjects, &plan.study, control)?;
    let studies: Vec<StudyResult> = subjects
        .par_iter()
        .map(|subject| study(subject.integrand, subject.pixel, &plan.study, control))
        .collect::<Result<_, _>>()?;
    let errors = error_curve::error_curves(&studies, &references);
    let (times, timing) = timing::measure(subjects, &plan.study, &counts, clock, control)?;
    let mut samplers: Vec<SamplerTrade> = Vec::new();
    for ((choice, errors), times) in plan.study.samplers.iter().zip(errors).zip(times) {
        let rows = errors.into_iter().zip(times).map(|(error, time)| row(error, time, plan));
        let mut rows: Vec<_> = rows.collect();
        rows.sort_by_key(|row| row.error.n);
        rows.dedup_by_key(|row| row.error.n);
        let name = choice.sampler.name();
        samplers.push(SamplerTrade { name, scramble: choice.scramble, rows });
    }
    choice::mark_pareto(&mut samplers);
    let mean = mean_reference(&references);
    let choices = plan
        .targets
        .iter()
        .map(|&target| {
            let absolute = target.absolute(mean.mean);
            let mut choice = choice::choose(target, absolute, &samplers, &plan.study, dim);
            beyond::secure(
                &mut choice,
                &samplers,
                subjects,
                &mut references,
                &plan.study,
                control,
            )?;
            choice::confirm(&mut choice, subjects, &references, &plan.study, control)?;
            Ok(choice)
        })
        .collect::<Result<_, StudyError>>()?;
    Ok(TradeResult {
        dim,
        subjects: subjects.len(),
        seed: plan.study.seed,
        trials: plan.study.n_trials,
        reference: mean_reference(&references),
        eval_cost: plan.eval_cost,
        timing,
        samplers,
        choices,
    })
}

fn row(error: ErrorRow, time: RowTime, plan: &TradePlan) -> TradeRow {
    let n = error.n as f64;
    let per_sample = match plan.eval_cost {
        Some(cost) => time.generation_ns.map(|generation| generation + cost),
        None => time.ns_per_sample,
    };
    let ns_per_estimate = per_sample.map(|ns| ns * n);
    let cost = error.mse * ns_per_estimate.median * 1e-9;
    let efficiency = (cost > 0.0).then(|| cost.recip());
    TradeRow { error, time, ns_per_estimate, efficiency, pareto: false }
}

fn mean_reference(references: &[Reference]) -> Reference {
    let n = references.len() as f64;
    Reference {
        mean: references.iter().map(|r| r.mean).sum::<f64>() / n,
        std_error: references.iter().map(|r| r.std_error.powi(2)).sum::<f64>().sqrt() / n,
    }
}

/// The means of the subjects: the closed form's, or that of 64 jittered estimates of 16 times
/// the largest N that is to be judged.
fn references(
    subjects: &[Subject<'_>],
    plan: &StudyPlan,
    control: Control<'_>,
) -> Result<Vec<Reference>, StudyError> {
    let largest = plan.counts.iter().copied().max().unwrap_or(1);
    subjects
        .par_iter()
        .map(|subject| match subject.integrand.reference() {
            Some(reference) => Ok(reference),
            None => measured_reference(subject, largest.saturating_mul(16), plan.seed, control),
        })
        .collect()
}

/// The mean of 64 jittered estimates of at least `wanted` samples: its variance is 1/64 of
/// theirs.
fn measured_reference(
    subject: &Subject<'_>,
    wanted: u64,
    seed: u64,
    control: Control<'_>,
) -> Result<Reference, StudyError> {
    const TRIALS: u32 = 64;
    let dim = subject.integrand.dim() as u32;
    let per_axis = (2u64..)
        .find(|k| k.checked_pow(dim).is_none_or(|n| n >= wanted))
        .and_then(|k| k.checked_pow(dim))
        .unwrap_or(wanted);
    let plan = StudyPlan {
        samplers: vec![SamplerChoice::named("jittered")?],
        counts: vec![per_axis],
        count_policy: CountPolicy::Error,
        n_trials: TRIALS,
        seed,
    };
    let result = study(subject.integrand, subject.pixel, &plan, control)?;
    let row = &result.samplers[0].rows[0];
    let std_error = (row.variance_of_mean / f64::from(TRIALS)).sqrt();
    Ok(Reference { mean: row.grand_mean, std_error })
}

/// The trial means of one sampler and N, `trials` of them, in order.
fn means_of(
    subject: &Subject<'_>,
    choice: SamplerChoice,
    plan: &StudyPlan,
    n: u64,
    control: Control<'_>,
) -> Result<Vec<f64>, StudyError> {
    let set = point_set(subject, choice, plan, n)?;
    let mut means = vec![0.0; plan.n_trials as usize];
    let sampler = choice.sampler;
    crate::trial::trial_means(subject.integrand, sampler, &set, 0, &mut means, control.cancel);
    if control.cancel.load(std::sync::atomic::Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    Ok(means)
}

fn point_set(
    subject: &Subject<'_>,
    choice: SamplerChoice,
    plan: &StudyPlan,
    n_samples: u64,
) -> Result<PointSet, StudyError> {
    crate::study::point_set(subject.integrand, subject.pixel, plan, choice, n_samples)
}

/// Mean square deviation from a reference, without the share that the reference's own error
/// adds.
fn mean_square_error(moments: &Moments, reference: &Reference) -> f64 {
    let m = moments.count as f64;
    let bias = moments.mean - reference.mean;
    let off = bias * bias - reference.std_error.powi(2);
    // Rounding of equal trials is no error.
    let rounding = 1e-14 * reference.mean.abs();
    if moments.variance == 0.0 && bias.abs() <= rounding.max(4.0 * reference.std_error) {
        return 0.0;
    }
    (moments.variance * (m - 1.0) / m + off).max(0.0)
}
