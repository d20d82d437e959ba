//! The experiment: pixels × samplers × N × M. The only module that owns threads.

mod discrepancy;
mod exact;
mod parallel;
mod picture;
mod plan;
mod result;
mod spectrum;

pub use discrepancy::{Discrepancies, DiscrepancyCurve, DiscrepancyRow, discrepancies};
pub use exact::ExactStudy;
pub use parallel::{collect, for_each, in_order, thread_count, with_threads};
pub use picture::{Image, render};
pub use plan::{SamplerChoice, StudyPlan};
pub use result::{Method, Reading, Row, SamplerResult, StudyResult};
pub use spectrum::{ErrorPlan, ErrorSpectrum, error_spectra, point_spectrum};

use crate::error::StudyError;
use crate::integrand::{Integrand, Regularity};
use crate::rng::StreamKey;
use crate::sampler::{CountPolicy, PointSet, Scramble};
use crate::theory::{Basis, Subject, predict};
use crate::trial::trial_means;
use crate::variance::{Spread, spread};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How a caller watches and stops a study.
#[derive(Clone, Copy)]
pub struct Control<'a> {
    /// Set to stop at the next trial.
    pub cancel: &'a AtomicBool,
    /// Told how many more samples were evaluated; called from any thread.
    pub progress: &'a (dyn Fn(u64) + Sync),
    /// Machine time, to fill `ns_per_sample`. Rows are then measured one at a time, on one
    /// thread.
    pub clock: Option<&'a (dyn Fn() -> Duration + Sync)>,
}

impl Control<'static> {
    /// Never cancels, reports to nobody, has no clock.
    pub fn unwatched() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self { cancel: &NEVER, progress: &|_| {}, clock: None }
    }
}

/// Studies one integrand. `pixel` addresses its randomness.
///
/// When cancelled it returns the samplers that were finished, or [`StudyError::Cancelled`] if
/// there is none.
///
/// # Errors
/// What [`StudyPlan::counts_used`] refuses; [`StudyError::NonFinite`]; `Cancelled`.
pub fn study(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    control: Control<'_>,
) -> Result<StudyResult, StudyError> {
    let counts_used = plan.counts_used(integrand.dim())?;
    let mut samplers = Vec::with_capacity(plan.samplers.len());
    for (choice, used) in plan.samplers.iter().zip(&counts_used) {
        match study_sampler(integrand, pixel, plan, *choice, used, control) {
            Ok(result) => samplers.push(result),
            Err(StudyError::Cancelled) if !samplers.is_empty() => break,
            Err(error) => return Err(error),
        }
    }
    Ok(StudyResult {
        pixel,
        dim: integrand.dim(),
        axes: integrand.axes(),
        seed: plan.seed,
        trials: plan.n_trials,
        reference: integrand.reference(),
        complete: samplers.len() == plan.samplers.len(),
        samplers,
    })
}

/// Studies many pixels, handing each result to `each` in the order of `pixels`. When cancelled
/// it returns `Cancelled` after the results that were finished, whichever those are.
///
/// # Errors
/// As [`study`]; what `integrand_of` refuses.
pub fn study_pixels<I: Integrand>(
    integrand_of: &(dyn Fn([u32; 2]) -> I + Sync),
    pixels: impl IntoIterator<Item = [u32; 2]>,
    plan: &StudyPlan,
    control: Control<'_>,
    each: &mut dyn FnMut(StudyResult),
) -> Result<(), StudyError> {
    /// Pixels in flight: enough to keep every core busy, few enough to hold in memory.
    const BATCH: usize = 1024;
    let mut pixels = pixels.into_iter();
    loop {
        let batch: Vec<_> = pixels.by_ref().take(BATCH).collect();
        if batch.is_empty() {
            return Ok(());
        }
        let results: Vec<_> = batch
            .par_iter()
            .map(|&pixel| study(&integrand_of(pixel), pixel, plan, control))
            .collect();
        let mut cancelled = false;
        for result in results {
            match result {
                Ok(result) if result.complete => each(result),
                Ok(_) | Err(StudyError::Cancelled) => cancelled = true,
                Err(error) => return Err(error),
            }
        }
        if cancelled {
            return Err(StudyError::Cancelled);
        }
    }
}

fn study_sampler(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    choice: SamplerChoice,
    counts_used: &[u64],
    control: Control<'_>,
) -> Result<SamplerResult, StudyError> {
    let set = |n_samples| {
        let sampler = choice.sampler.stream_id();
        PointSet {
            key: StreamKey { seed: plan.seed, pixel, sampler, n_samples, trial: 0 },
            dim: integrand.dim(),
            scramble: choice.scramble,
            rectangular: plan.count_policy == CountPolicy::Rect,
        }
    };
    let mut rows = Vec::with_capacity(counts_used.len());
    for (&n, &n_used) in plan.counts.iter().zip(counts_used) {
        let set = set(n_used);
        set.key.check()?;
        let (means, ns_per_sample) = row_means(integrand, choice, &set, plan.n_trials, control)?;
        if let Some((trial, &mean)) = (0..).zip(&means).find(|(_, mean)| !mean.is_finite()) {
            let sampler = choice.sampler.name();
            return Err(StudyError::NonFinite { pixel, sampler, n: n_used, trial, mean });
        }
        let Spread { grand_mean, variance_of_mean, var_ln } = spread(&means);
        rows.push(Row {
            n,
            n_used,
            grand_mean,
            variance_of_mean,
            var_ln,
            exact_variance: exact_variance(integrand, choice, n_used),
            strata: set.rectangular.then(|| choice.sampler.strata(n_used, set.dim)).flatten(),
            ns_per_sample,
        });
    }
    Ok(summarise(integrand, choice, rows))
}

/// The M trial means of one row, in trial order.
fn row_means(
    integrand: &dyn Integrand,
    choice: SamplerChoice,
    set: &PointSet,
    n_trials: u32,
    control: Control<'_>,
) -> Result<(Vec<f64>, Option<f64>), StudyError> {
    /// Samples per task: some tens of microseconds of work at the least.
    const TASK: u64 = 1 << 14;
    let n = set.key.n_samples;
    let mut means = vec![0.0; n_trials as usize];
    let trials_per_task =
        if control.clock.is_some() { means.len() } else { (TASK / n).max(1) as usize };
    let start = control.clock.map(|clock| clock());
    means.par_chunks_mut(trials_per_task).enumerate().for_each(|(task, chunk)| {
        if !control.cancel.load(Ordering::Relaxed) {
            let first_trial = (task * trials_per_task) as u32;
            trial_means(integrand, choice.sampler, set, first_trial, chunk, control.cancel);
            (control.progress)(chunk.len() as u64 * n);
        }
    });
    if control.cancel.load(Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    let ns_per_sample = control.clock.zip(start).map(|(clock, start)| {
        (clock() - start).as_nanos() as f64 / (f64::from(n_trials) * n as f64)
    });
    Ok((means, ns_per_sample))
}

/// The closed form's variance, for the point sets that [`Integrand::exact_variance`] speaks of.
fn exact_variance(integrand: &dyn Integrand, choice: SamplerChoice, n: u64) -> Option<f64> {
    let plain =
        choice.scramble == Scramble::None && choice.sampler.admits(n, integrand.dim(), false);
    plain.then(|| integrand.exact_variance(choice.sampler.name(), n)).flatten()
}

fn summarise(integrand: &dyn Integrand, choice: SamplerChoice, rows: Vec<Row>) -> SamplerResult {
    let name = choice.sampler.name();
    let dim = integrand.dim();
    let spreads: Vec<_> = rows.iter().map(|row| (row.n_used, row.spread())).collect();
    let Reading { fit, exact, class, class_is_sure } =
        Reading::of(name, choice.scramble, dim, &spreads);
    let known = predict(name, choice.scramble, &Subject::of(integrand)).filter(|_| !exact);
    let of_class = || class.filter(|_| class_is_sure)?.predicted_exponent(dim);
    let (predicted, predicted_from) = match known {
        Some(law) => (Some(law.exponent), Some(Basis::Integrand)),
        None if integrand.regularity() == Regularity::Unknown => {
            let predicted = of_class();
            (predicted, predicted.map(|_| Basis::Class))
        }
        None => (None, None),
    };
    SamplerResult {
        name,
        scramble: choice.scramble,
        fit,
        fit_without_first: result::fit_spreads(&spreads, 1),
        exact,
        class,
        class_is_sure,
        predicted,
        predicted_from,
        predicted_source: known.map(|law| law.source),
        rows,
        method: Method::Trials,
        unresolved: None,
    }
}
