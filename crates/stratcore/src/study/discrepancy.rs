//! Discrepancy against N.

use super::{Control, SamplerChoice, StudyPlan};
use crate::discrepancy::Measure;
use crate::error::StudyError;
use crate::fit::{Fit, power_law};
use crate::rng::StreamKey;
use crate::sampler::{
    self, CountPolicy, PointSet, Scramble, most_trials_but_for_shifts, whole_set,
};
use crate::variance::Moments;
use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::Ordering;

/// Discrepancies of point sets of growing N, for each sampler of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Discrepancies {
    /// Dimensions of the points.
    pub dim: usize,
    /// Seed of all randomness.
    pub seed: u64,
    /// Trials asked for.
    pub trials: u32,
    /// One for each sampler and measure, sampler by sampler; those that were finished when
    /// cancelled.
    pub curves: Vec<DiscrepancyCurve>,
    /// Whether every sampler of the plan is there.
    pub complete: bool,
}

/// One discrepancy of one sampler's sets.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DiscrepancyCurve {
    /// Sampler's name.
    pub sampler: &'static str,
    /// How its sets were scrambled.
    pub scramble: Scramble,
    /// Which discrepancy.
    pub measure: Measure,
    /// One row per count of the plan.
    pub rows: Vec<DiscrepancyRow>,
    /// The line mean ~ C N^-p through the rows that have a standard error, unweighted.
    pub fit: Option<Fit>,
}

/// The discrepancy of several sets of N points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct DiscrepancyRow {
    /// N as asked for.
    pub n: u64,
    /// N as used.
    pub n_used: u64,
    /// Different sets that were measured: fewer than asked for where there are no more.
    pub trials: u32,
    /// Mean of their discrepancies: of maxima for `edge` and `star`, of roots for the others.
    pub mean: f64,
    /// Standard error of that mean; none for a single set.
    pub std_error: Option<f64>,
    /// Mean of the squared discrepancies, for those that are roots of mean squares.
    pub mean_sq: Option<f64>,
    /// Standard error of that.
    pub std_error_sq: Option<f64>,
}

/// Measures the discrepancies of M sets of each sampler at each N.
///
/// Unlike a variance, a discrepancy is that of one set: a deterministic sampler has one too,
/// without an error, and so has a plan of one trial. Progress is counted in pairs of points.
///
/// # Errors
/// What the plan's samplers refuse; [`StudyError::MeasureNeedsDim`]; `Cancelled` before the
/// first sampler is finished.
pub fn discrepancies(
    plan: &StudyPlan,
    dim: usize,
    measures: &[Measure],
    control: Control<'_>,
) -> Result<Discrepancies, StudyError> {
    let used = checked(plan, dim, measures)?;
    let mut curves = Vec::new();
    let mut complete = true;
    for (choice, used) in plan.samplers.iter().zip(used) {
        match of_sampler(plan, *choice, &used, dim, measures, control) {
            Ok(found) => curves.extend(found),
            Err(StudyError::Cancelled) if !curves.is_empty() => {
                complete = false;
                break;
            }
            Err(error) => return Err(error),
        }
    }
    Ok(Discrepancies { dim, seed: plan.seed, trials: plan.n_trials, curves, complete })
}

/// The counts that each sampler uses, after every check that can be made before the first set.
fn checked(
    plan: &StudyPlan,
    dim: usize,
    measures: &[Measure],
) -> Result<Vec<Vec<u64>>, StudyError> {
    for (what, is_empty) in [
        ("samplers", plan.samplers.is_empty()),
        ("sample counts", plan.counts.is_empty()),
        ("trials", plan.n_trials == 0),
        ("discrepancies", measures.is_empty()),
    ] {
        if is_empty {
            return Err(StudyError::EmptyPlan(what));
        }
    }
    if plan.n_trials > StudyPlan::MAX_TRIALS {
        return Err(StudyError::TooManyTrials(plan.n_trials, StudyPlan::MAX_TRIALS));
    }
    measures.iter().try_for_each(|measure| measure.check(dim))?;
    let of_choice = |choice: &SamplerChoice| {
        sampler::check_scramble(choice.sampler, choice.scramble)?;
        let used = |&n| sampler::count_used(choice.sampler, n, dim, plan.count_policy);
        plan.counts.iter().map(used).collect()
    };
    plan.samplers.iter().map(of_choice).collect()
}

fn of_sampler(
    plan: &StudyPlan,
    choice: SamplerChoice,
    counts_used: &[u64],
    dim: usize,
    measures: &[Measure],
    control: Control<'_>,
) -> Result<Vec<DiscrepancyCurve>, StudyError> {
    let SamplerChoice { sampler, scramble } = choice;
    let mut curves: Vec<_> = measures
        .iter()
        .map(|&measure| {
            let (sampler, rows) = (sampler.name(), Vec::new());
            DiscrepancyCurve { sampler, scramble, measure, rows, fit: None }
        })
        .collect();
    for (&n, &n_used) in plan.counts.iter().zip(counts_used) {
        let trials = plan.n_trials.min(sampler.most_trials(n_used, scramble));
        // [trial][measure]
        let values: Vec<Vec<f64>> = (0..trials)
            .into_par_iter()
            .map(|trial| {
                if control.cancel.load(Ordering::Relaxed) {
                    return Err(StudyError::Cancelled);
                }
                let stream = sampler.stream_id();
                let (seed, pixel) = (plan.seed, [0, 0]);
                let key = StreamKey { seed, pixel, sampler: stream, n_samples: n_used, trial };
                let rectangular = plan.count_policy == CountPolicy::Rect;
                let points = whole_set(sampler, &PointSet { key, dim, scramble, rectangular })?;
                let values = measures.iter().map(|measure| measure.of(&points, dim)).collect();
                (control.progress)(n_used * n_used);
                Ok(values)
            })
            .collect::<Result<_, _>>()?;
        let but_for_shifts = most_trials_but_for_shifts(sampler, n_used, scramble);
        for (i, curve) in curves.iter_mut().enumerate() {
            let measure = curve.measure;
            let trials = if measure.ignores_shifts() { trials.min(but_for_shifts) } else { trials };
            let of_measure: Vec<_> =
                values[..trials as usize].iter().map(|trial| trial[i]).collect();
            let is_l2 = measure.is_l2();
            curve.rows.push(DiscrepancyRow::new(n, n_used, trials, &of_measure, is_l2));
        }
    }
    for curve in &mut curves {
        curve.fit = fit_rows(&curve.rows);
    }
    Ok(curves)
}

impl DiscrepancyRow {
    fn new(n: u64, n_used: u64, trials: u32, values: &[f64], is_l2: bool) -> Self {
        let squares: Vec<_> = values.iter().map(|value| value * value).collect();
        let (mean, std_error) = mean_and_error(values);
        let (mean_sq, std_error_sq) = mean_and_error(&squares);
        let mean_sq = is_l2.then_some(mean_sq);
        let std_error_sq = std_error_sq.filter(|_| is_l2);
        Self { n, n_used, trials, mean, std_error, mean_sq, std_error_sq }
    }
}

/// The mean of at least one value; its standard error, if there are two.
fn mean_and_error(values: &[f64]) -> (f64, Option<f64>) {
    if values.len() < 2 {
        return (values.first().copied().unwrap_or(f64::NAN), None);
    }
    let spread = Moments::of(values);
    let std_error = (spread.variance / values.len() as f64).sqrt();
    (spread.mean, Some(std_error))
}

/// A line through the means. A count that was snapped to the same N twice is one row.
fn fit_rows(rows: &[DiscrepancyRow]) -> Option<Fit> {
    let mut known: Vec<_> = rows
        .iter()
        .filter_map(|row| Some((row.n_used, row.mean, (row.std_error? / row.mean).powi(2))))
        .collect();
    known.sort_by_key(|(n, ..)| *n);
    known.dedup_by_key(|(n, ..)| *n);
    power_law(known)
}
