//! Measuring: studies of a size that the effort allows, each with points of its own.

use super::LiteratureError;
use super::finding::{Check, Figure, Finding, Relation};
use crate::discrepancy::Measure;
use crate::fit::{Fit, power_law};
use crate::integrand::{Integrand, by_name};
use crate::rng::{Stream, StreamKey};
use crate::study::{
    Control, DiscrepancyRow, Row, SamplerChoice, SamplerResult, StudyPlan, discrepancies, study,
    study_pixels,
};

/// How much is spent on a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// Seconds.
    Quick,
    /// Minutes.
    Full,
}

/// What one claim measures with.
pub(super) struct Lab<'a> {
    seed: u64,
    effort: Effort,
    control: Control<'a>,
    /// Pixel row of the next measurement: no two share points.
    next: u32,
    findings: Vec<Finding>,
    figures: Vec<Figure>,
}

/// Measurements that one claim may make.
const MOST_MEASUREMENTS: u32 = 1 << 10;

/// Number of the streams that place random features. No sampler has it.
const PLACEMENT: u8 = 255;

/// An average over random placements of a feature.
#[derive(Debug, Clone, Copy)]
pub(super) struct Average {
    pub(super) n: u64,
    pub(super) mean: f64,
    pub(super) std_error: f64,
}

impl<'a> Lab<'a> {
    pub(super) fn new(claim: usize, seed: u64, effort: Effort, control: Control<'a>) -> Self {
        // Progress is counted in claims, by the caller.
        let control = Control { progress: &|_| {}, clock: None, ..control };
        let next = claim as u32 * MOST_MEASUREMENTS;
        Self { seed, effort, control, next, findings: Vec::new(), figures: Vec::new() }
    }

    pub(super) fn into_parts(self) -> (Vec<Finding>, Vec<Figure>) {
        (self.findings, self.figures)
    }

    pub(super) fn push(&mut self, finding: Finding) {
        self.findings.push(finding);
    }

    pub(super) fn draw(&mut self, figure: Figure) {
        self.figures.push(figure);
    }

    pub(super) fn control(&self) -> Control<'a> {
        self.control
    }

    pub(super) fn is_quick(&self) -> bool {
        self.effort == Effort::Quick
    }

    /// One of two sizes.
    pub(super) fn either<T>(&self, quick: T, full: T) -> T {
        if self.is_quick() { quick } else { full }
    }

    /// Samples to spend on one measurement.
    fn samples(&self) -> u64 {
        self.either(2_500_000, 50_000_000)
    }

    /// Trials of a study at these N.
    pub(super) fn trials(&self, counts: &[u64]) -> u32 {
        (self.samples() / counts.iter().sum::<u64>()).clamp(50, 100_000) as u32
    }

    /// A seed of the measurement's own, for claims that draw for themselves.
    pub(super) fn key(&mut self) -> StreamKey {
        let pixel = [0, self.next_row()];
        StreamKey { seed: self.seed, pixel, sampler: PLACEMENT, n_samples: 1, trial: 0 }
    }

    fn next_row(&mut self) -> u32 {
        self.next += 1;
        self.next
    }

    pub(super) fn plan(&self, choice: SamplerChoice, counts: &[u64], n_trials: u32) -> StudyPlan {
        StudyPlan {
            samplers: vec![choice],
            counts: counts.to_vec(),
            n_trials,
            seed: self.seed,
            ..StudyPlan::paper()
        }
    }

    /// One integrand under one sampler, as many trials as the effort pays for.
    pub(super) fn study(
        &mut self,
        f: &dyn Integrand,
        choice: SamplerChoice,
        counts: &[u64],
    ) -> Result<SamplerResult, LiteratureError> {
        let row = self.next_row();
        self.study_at(f, choice, counts, row)
    }

    /// The same under a sampler by name, and of several integrands at the same points.
    pub(super) fn studies<const K: usize>(
        &mut self,
        fs: [&dyn Integrand; K],
        sampler: &str,
        counts: &[u64],
    ) -> Result<[Vec<Row>; K], LiteratureError> {
        let choice = SamplerChoice::named(sampler)?;
        let row = self.next_row();
        let mut results = [const { Vec::new() }; K];
        for (f, result) in fs.into_iter().zip(&mut results) {
            *result = self.study_at(f, choice, counts, row)?.rows;
        }
        Ok(results)
    }

    fn study_at(
        &self,
        f: &dyn Integrand,
        choice: SamplerChoice,
        counts: &[u64],
        row: u32,
    ) -> Result<SamplerResult, LiteratureError> {
        let plan = self.plan(choice, counts, self.trials(counts));
        let mut result = study(f, [0, row], &plan, self.control)?;
        // One sampler was asked for, so one is there.
        Ok(result.samplers.remove(0))
    }

    /// Variance of the mean averaged over random placements of an integrand. `make` builds it
    /// from a stream of its own.
    pub(super) fn placed<I: Integrand>(
        &mut self,
        make: &(dyn Fn(Stream) -> I + Sync),
        sampler: &str,
        counts: &[u64],
    ) -> Result<Vec<Average>, LiteratureError> {
        // Few trials at many placements: the placements' own spread weighs more.
        const TRIALS: u32 = 4;
        let per_placement = u64::from(TRIALS) * counts.iter().sum::<u64>();
        let placements = (self.samples() / per_placement).clamp(50, 1 << 17) as u32;
        let samples = self.replicates(make, sampler, counts, TRIALS, placements)?;
        let p = f64::from(placements);
        let average = |(n, values): (&u64, Vec<f64>)| {
            let mean = values.iter().sum::<f64>() / p;
            let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
            Average { n: *n, mean, std_error: (squares / (p - 1.0) / p).sqrt() }
        };
        Ok(counts.iter().zip(samples).map(average).collect())
    }

    /// The variance of `trials` trial means, measured `repeats` times: for each N the list.
    pub(super) fn replicates<I: Integrand>(
        &mut self,
        make: &(dyn Fn(Stream) -> I + Sync),
        sampler: &str,
        counts: &[u64],
        trials: u32,
        repeats: u32,
    ) -> Result<Vec<Vec<f64>>, LiteratureError> {
        let mut variances = vec![Vec::with_capacity(repeats as usize); counts.len()];
        self.each_replicate(make, sampler, counts, trials, repeats, &mut |result| {
            for (list, row) in variances.iter_mut().zip(&result.rows) {
                list.push(row.variance_of_mean);
            }
        })?;
        Ok(variances)
    }

    /// Mean arbitrary-edge discrepancy of `sets` point sets, or of as many as there are.
    pub(super) fn edge_discrepancies(
        &self,
        sampler: &str,
        counts: &[u64],
        sets: u32,
    ) -> Result<Vec<Average>, LiteratureError> {
        let plan = self.plan(SamplerChoice::named(sampler)?, counts, sets);
        let found = discrepancies(&plan, 2, &[Measure::Edge], self.control)?;
        let average = |row: &DiscrepancyRow| Average {
            n: row.n_used,
            mean: row.mean,
            std_error: row.std_error.unwrap_or(f64::NAN),
        };
        Ok(found.curves.iter().flat_map(|curve| &curve.rows).map(average).collect())
    }

    /// Whole studies, `repeats` of them, handed to `each` in order.
    pub(super) fn each_replicate<I: Integrand>(
        &mut self,
        make: &(dyn Fn(Stream) -> I + Sync),
        sampler: &str,
        counts: &[u64],
        trials: u32,
        repeats: u32,
        each: &mut dyn FnMut(&SamplerResult),
    ) -> Result<(), LiteratureError> {
        let plan = self.plan(SamplerChoice::named(sampler)?, counts, trials);
        let row = self.next_row();
        let seed = self.seed;
        let build = |pixel| {
            let key = StreamKey { seed, pixel, sampler: PLACEMENT, n_samples: 1, trial: 0 };
            make(key.stream())
        };
        let pixels = (0..repeats).map(|x| [x, row]);
        study_pixels(&build, pixels, &plan, self.control, &mut |result| {
            result.samplers.iter().for_each(&mut *each);
        })?;
        Ok(())
    }

    /// A row on the exponent of a study.
    pub(super) fn exponent(
        &mut self,
        case: &str,
        f: &dyn Integrand,
        sampler: &str,
        counts: &[u64],
        expected: f64,
    ) -> Result<Finding, LiteratureError> {
        let result = self.study(f, SamplerChoice::named(sampler)?, counts)?;
        Ok(exponent_of(case, &result, expected))
    }

    /// A row that holds each measured variance against an exact one.
    pub(super) fn exact(
        &mut self,
        case: &str,
        f: &dyn Integrand,
        sampler: &str,
        counts: &[u64],
        exact: impl Fn(u64) -> f64,
    ) -> Result<Finding, LiteratureError> {
        let result = self.study(f, SamplerChoice::named(sampler)?, counts)?;
        let finding = Finding::new(case, "variance / exact, mean over N", 1.0);
        Ok(with_checks(finding, ratios(&result.rows, exact)))
    }
}

/// An integrand of the catalogue.
pub(super) fn integrand(
    name: &str,
    dim: usize,
    params: &[(&str, f64)],
) -> Result<Box<dyn Integrand>, LiteratureError> {
    let params: Vec<_> = params.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    Ok(by_name(name, Some(dim), &params)?)
}

/// base^from ..= base^to
pub(super) fn powers(base: u64, exponents: std::ops::RangeInclusive<u32>) -> Vec<u64> {
    exponents.map(|e| base.pow(e)).collect()
}

/// k^dim for the k's.
pub(super) fn cells(ks: &[u64], dim: usize) -> Vec<u64> {
    ks.iter().map(|k| k.pow(dim as u32)).collect()
}

/// Measured variances over expected ones. An expected zero has no ratio: it is 1 where zero
/// was measured, and infinite elsewhere.
pub(super) fn ratios(rows: &[Row], expected: impl Fn(u64) -> f64) -> Vec<Check> {
    rows.iter()
        .map(|row| {
            let (s2, exact) = (row.variance_of_mean, expected(row.n_used));
            let at = format!("N = {}", row.n_used);
            match exact {
                0.0 => {
                    let ratio = if s2 == 0.0 { 1.0 } else { f64::INFINITY };
                    Check { at, ratio, std_error: 0.0 }
                }
                _ => Check { at, ratio: s2 / exact, std_error: row.var_ln().sqrt() },
            }
        })
        .collect()
}

/// Averages over expected ones.
pub(super) fn average_ratios(averages: &[Average], expected: impl Fn(u64) -> f64) -> Vec<Check> {
    let check = |a: &Average| {
        let exact = expected(a.n);
        Check { at: format!("N = {}", a.n), ratio: a.mean / exact, std_error: a.std_error / exact }
    };
    averages.iter().map(check).collect()
}

/// A row of several ratios: their mean where they should all be 1, otherwise the one nearest
/// to breaking the bound.
pub(super) fn with_checks(finding: Finding, checks: Vec<Check>) -> Finding {
    let (value, std_error) = match finding.relation {
        Relation::Equals => {
            let noisy = || checks.iter().filter(|c| c.std_error > 0.0 || c.ratio != 1.0);
            match noisy().count() as f64 {
                // Zeros where zeros are due leave no noise to average.
                0.0 => (1.0, 0.0),
                count => {
                    let mean = noisy().map(|c| c.ratio).sum::<f64>() / count;
                    (mean, noisy().map(|c| c.std_error.powi(2)).sum::<f64>().sqrt() / count)
                }
            }
        }
        relation => {
            let sign = if relation == Relation::AtMost { 1.0 } else { -1.0 };
            let worst = checks.iter().max_by(|a, b| (sign * a.ratio).total_cmp(&(sign * b.ratio)));
            worst.map_or((f64::NAN, f64::NAN), |c| (c.ratio, c.std_error))
        }
    };
    let bound = finding.expected.unwrap_or(1.0);
    Finding { checks, ..finding.measured(value * bound, std_error * bound) }
}

/// A row on a fitted exponent.
pub(super) fn exponent_of(case: &str, result: &SamplerResult, expected: f64) -> Finding {
    exponent_row(case, result.fit.as_ref(), expected)
}

pub(super) fn exponent_row(case: &str, fit: Option<&Fit>, expected: f64) -> Finding {
    let range = fit.map_or(String::new(), |f| format!(", N = {} to {}", f.n_min, f.n_max));
    let finding = Finding::new(format!("{case}{range}"), "p", expected);
    match fit {
        Some(fit) => finding.measured(fit.exponent, fit.std_error),
        None => finding.measured(f64::NAN, f64::NAN),
    }
}

/// A row on the exponent of averages over placements.
pub(super) fn exponent_of_averages(case: &str, averages: &[Average], expected: f64) -> Finding {
    let rows = averages.iter().map(|a| (a.n, a.mean, (a.std_error / a.mean).powi(2)));
    exponent_row(case, power_law(rows).as_ref(), expected)
}

/// A row on an exponent with the distance that exact variances keep from it at these N.
pub(super) fn allowing_exact(finding: Finding, exact: f64) -> Finding {
    let distance = (exact - finding.expected.unwrap_or(exact)).abs();
    // Rounding is no distance.
    let distance = if distance > 1e-6 { distance } else { 0.0 };
    finding.allowing(distance, format!("the exact variances at these N fit to p = {exact:.4}"))
}

/// The exponent that an exact law fits to at these N, without noise.
pub(super) fn exact_exponent(counts: &[u64], law: impl Fn(u64) -> f64) -> Option<f64> {
    power_law(counts.iter().map(|n| (*n, law(*n), 1.0))).map(|fit| fit.exponent)
}
