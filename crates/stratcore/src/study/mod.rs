//! The experiment: pixels × samplers × N × M. The only module that owns threads.

mod discrepancy;
mod exact;
mod inside;
mod live;
mod parallel;
mod picture;
mod plan;
mod result;
mod spectrum;
mod until;

pub use discrepancy::{Discrepancies, DiscrepancyCurve, DiscrepancyRow, discrepancies};
pub use exact::ExactStudy;
pub use inside::{Inside, inside};
pub use live::study_live;
pub use parallel::{both, collect, for_each, in_order, thread_count, with_threads};
pub use picture::{Image, render, render_pixels};
pub use plan::{SamplerChoice, StudyPlan};
pub use result::{Method, Reading, Row, SamplerResult, StudyResult};
pub use spectrum::{ErrorPlan, ErrorSpectrum, error_spectra, point_spectrum};
pub use until::{EarlyFit, Stop, StopReason, Tightness, study_until};

use result::Curves;

use crate::dimensions::Bound;
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::noise::Noise;
use crate::rng::StreamKey;
use crate::sampler::{CountPolicy, PointSet, Scramble};
use crate::theory::{Basis, Subject, predict};
use crate::trial::trial_means;
use crate::variance::Moments;
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

/// The rows of one pixel, each sampler's moments after those of the one before: what
/// [`study`] measures, without what it reads from them. `counts_used` are those of the plan for
/// the integrand's dimensions.
///
/// # Errors
/// As [`study`]; `Cancelled` where any sampler was not finished.
pub(crate) fn measure(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    counts_used: &[Vec<u64>],
    control: Control<'_>,
) -> Result<Vec<Moments>, StudyError> {
    let mut moments = Vec::with_capacity(plan.samplers.len() * plan.counts.len());
    for (choice, used) in plan.samplers.iter().zip(counts_used) {
        let rows = sampler_rows(integrand, pixel, plan, *choice, used, control)?;
        moments.extend(rows.iter().map(|row| row.moments(plan.n_trials)));
    }
    Ok(moments)
}

fn study_sampler(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    choice: SamplerChoice,
    counts_used: &[u64],
    control: Control<'_>,
) -> Result<SamplerResult, StudyError> {
    let rows = sampler_rows(integrand, pixel, plan, choice, counts_used, control)?;
    Ok(summarise(integrand, choice, rows, plan.n_trials))
}

fn sampler_rows(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    choice: SamplerChoice,
    counts_used: &[u64],
    control: Control<'_>,
) -> Result<Vec<Row>, StudyError> {
    let mut rows = Vec::with_capacity(counts_used.len());
    let mut means = vec![0.0; plan.n_trials as usize];
    for (&n, &n_used) in plan.counts.iter().zip(counts_used) {
        let set = point_set(integrand, pixel, plan, choice, n_used)?;
        let ns_per_sample = row_means(integrand, choice, &set, 0, &mut means, control)?;
        rows.push(Row { ns_per_sample, ..row(integrand, choice, &set, n, &means)? });
    }
    Ok(rows)
}

/// Names the sets of N points of a study; the trial is left open.
pub(crate) fn point_set(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    choice: SamplerChoice,
    n_samples: u64,
) -> Result<PointSet, StudyError> {
    let sampler = choice.sampler.stream_id();
    let key = StreamKey { seed: plan.seed, pixel, sampler, n_samples, trial: 0 };
    key.check()?;
    Ok(PointSet {
        key,
        dim: integrand.dim(),
        scramble: choice.scramble,
        rectangular: plan.count_policy == CountPolicy::Rect,
    })
}

/// The row that these trial means make, without its time.
fn row(
    integrand: &dyn Integrand,
    choice: SamplerChoice,
    set: &PointSet,
    n: u64,
    means: &[f64],
) -> Result<Row, StudyError> {
    let n_used = set.key.n_samples;
    if let Some((trial, &mean)) = (0..).zip(means).find(|(_, mean)| !mean.is_finite()) {
        let (pixel, sampler) = (set.key.pixel, choice.sampler.name());
        return Err(StudyError::NonFinite { pixel, sampler, n: n_used, trial, mean });
    }
    let moments = Moments::of(means);
    if moments.is_out_of_range() {
        let (pixel, sampler) = (set.key.pixel, choice.sampler.name());
        let variance = moments.variance;
        return Err(StudyError::VarianceOutOfRange { pixel, sampler, n: n_used, variance });
    }
    Ok(Row {
        n,
        n_used,
        grand_mean: moments.mean,
        variance_of_mean: moments.variance,
        skewness: moments.skewness,
        kurtosis: moments.kurtosis,
        noise: Noise::None,
        exact_variance: exact_variance(integrand, choice, n_used),
        strata: set.rectangular.then(|| choice.sampler.strata(n_used, set.dim)).flatten(),
        ns_per_sample: None,
    })
}

/// Overwrites `means` with those of trials `first_trial ..`, in order; gives the time per
/// sample where there is a clock.
fn row_means(
    integrand: &dyn Integrand,
    choice: SamplerChoice,
    set: &PointSet,
    first_trial: u32,
    means: &mut [f64],
    control: Control<'_>,
) -> Result<Option<f64>, StudyError> {
    /// Samples per task: some tens of microseconds of work at the least.
    const TASK: u64 = 1 << 14;
    let n = set.key.n_samples;
    let n_trials = means.len();
    let trials_per_task =
        if control.clock.is_some() { n_trials } else { (TASK / n).max(1) as usize };
    let start = control.clock.map(|clock| clock());
    let run = |(task, chunk): (usize, &mut [f64])| {
        if !control.cancel.load(Ordering::Relaxed) {
            let first_trial = first_trial + (task * trials_per_task) as u32;
            trial_means(integrand, choice.sampler, set, first_trial, chunk, control.cancel);
            (control.progress)(chunk.len() as u64 * n);
        }
    };
    // A single task is not worth asking the other threads for.
    if n_trials <= trials_per_task {
        run((0, means));
    } else {
        means.par_chunks_mut(trials_per_task).enumerate().for_each(run);
    }
    if control.cancel.load(Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    Ok(control
        .clock
        .zip(start)
        .map(|(clock, start)| (clock() - start).as_nanos() as f64 / (n_trials as f64 * n as f64)))
}

/// The closed form's variance, for the point sets that [`Integrand::exact_variance`] speaks of.
fn exact_variance(integrand: &dyn Integrand, choice: SamplerChoice, n: u64) -> Option<f64> {
    let plain =
        choice.scramble == Scramble::None && choice.sampler.admits(n, integrand.dim(), false);
    plain.then(|| integrand.exact_variance(choice.sampler.name(), n)).flatten()
}

/// What the rows of one sampler, each of `trials` trials, say together.
fn summarise(
    integrand: &dyn Integrand,
    choice: SamplerChoice,
    mut rows: Vec<Row>,
    trials: u32,
) -> SamplerResult {
    let name = choice.sampler.name();
    let dim = integrand.dim();
    let moments: Vec<_> = rows.iter().map(|row| (row.n_used, row.moments(trials))).collect();
    let reading = Reading::of(name, choice.scramble, dim, &moments);
    let curves = Curves::of(&moments, &reading);
    let Reading { noise, fit, paper_fit, exact, class, class_is_sure } = reading;
    for (row, noise) in rows.iter_mut().zip(noise) {
        row.noise = noise;
    }
    let known = predict(name, choice.scramble, &Subject::of(integrand)).filter(|_| !exact);
    SamplerResult {
        name,
        scramble: choice.scramble,
        fit,
        misfit_p_value: fit.and_then(|fit| fit.p_value()),
        local_slopes: curves.local_slopes,
        two_terms: curves.two_terms,
        paper_fit,
        paper_fit_without_first: curves.paper_without_first,
        exact,
        class,
        class_is_sure,
        predicted: known.map(|law| law.exponent),
        predicted_bound: known.map(|_| Bound::Equals),
        predicted_from: known.map(|_| Basis::Integrand),
        predicted_source: known.map(|law| law.source),
        rows,
        method: Method::Trials,
        unresolved: None,
    }
}
