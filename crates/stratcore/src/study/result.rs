//! What was measured.

use crate::exact::Unresolved;
use crate::fit::{Fit, fit};
use crate::integrand::Reference;
use crate::sampler::Scramble;
use crate::theory::{Basis, Class};
use crate::variance::Spread;
use serde::{Serialize, Serializer};

/// The convergence of one pixel, or of one integrand, under each sampler of a plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StudyResult {
    /// Pixel (x, y); (0, 0) is the top-left. `[0, 0]` for an integrand without pixels.
    pub pixel: [u32; 2],
    /// Dimensions d.
    pub dim: usize,
    /// Names of the d axes.
    pub axes: Vec<String>,
    /// Seed of all randomness.
    pub seed: u64,
    /// Independent repeats M.
    pub trials: u32,
    /// The integral, where it is known.
    pub reference: Option<Reference>,
    /// In the plan's order; those that were finished when the study was cancelled.
    pub samplers: Vec<SamplerResult>,
    /// Whether every sampler of the plan is there.
    pub complete: bool,
}

/// The convergence under one sampler.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SamplerResult {
    /// Sampler's name.
    pub name: &'static str,
    /// How its sets were scrambled.
    pub scramble: Scramble,
    /// One row per sample count of the plan.
    pub rows: Vec<Row>,
    /// The paper's fit through the rows that have a variance; none when fewer than two have.
    pub fit: Option<Fit>,
    /// The same without the row of smallest N.
    pub fit_without_first: Option<Fit>,
    /// Every variance is zero: each estimate was the same number.
    pub exact: bool,
    /// Kind of pixel, read from the exponent under `jittered`; none for other samplers.
    pub class: Option<Class>,
    /// Whether the exponent's 95 % interval lies within its class.
    pub class_is_sure: bool,
    /// The exponent that theory predicts: from what is known of the integrand, otherwise for
    /// the class that was measured, if it is sure.
    pub predicted: Option<f64>,
    /// Which of the two; none without a prediction.
    pub predicted_from: Option<Basis>,
    /// Where the law for the integrand was published.
    pub predicted_source: Option<&'static str>,
    /// Where the rows come from.
    pub method: Method,
    /// Why they come from trials although exact values were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unresolved: Option<Unresolved>,
}

/// Where a sampler's rows come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Measured: M repeats of each estimate.
    Trials,
    /// Computed from the pixel's visible polygons, without a random number: each row's variance
    /// is known, its interval has no width and `var_ln` is 0.
    Exact,
}

/// The spread of M trial means at one N.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// N as asked for.
    pub n: u64,
    /// N as used.
    pub n_used: u64,
    /// Mean of the trial means.
    pub grand_mean: f64,
    /// Mitchell's σ², divisor M - 1.
    pub variance_of_mean: f64,
    /// Variance of ln s².
    pub var_ln: f64,
    /// The variance that a closed form gives at this N, where the integrand has one.
    pub exact_variance: Option<f64>,
    /// Strata along each axis, where rectangular ones were allowed and the sampler has strata.
    pub strata: Option<Vec<u64>>,
    /// Machine time per sample, generation and evaluation, where the caller lent a clock.
    pub ns_per_sample: Option<f64>,
}

impl Row {
    /// The row's spread, as a fit wants it.
    pub fn spread(&self) -> Spread {
        let Self { grand_mean, variance_of_mean, var_ln, .. } = *self;
        Spread { grand_mean, variance_of_mean, var_ln }
    }

    /// Ends of the variance's 95 % interval.
    pub fn ci95(&self) -> [f64; 2] {
        self.spread().ci95()
    }
}

/// Flat, and with the interval worked out: a picture's worth of rows never needs it.
impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Document<'a> {
            n: u64,
            n_used: u64,
            grand_mean: f64,
            variance_of_mean: f64,
            lo: f64,
            hi: f64,
            var_ln: f64,
            exact_variance: Option<f64>,
            strata: Option<&'a [u64]>,
            ns_per_sample: Option<f64>,
        }
        let [lo, hi] = self.ci95();
        Document {
            n: self.n,
            n_used: self.n_used,
            grand_mean: self.grand_mean,
            variance_of_mean: self.variance_of_mean,
            lo,
            hi,
            var_ln: self.var_ln,
            exact_variance: self.exact_variance,
            strata: self.strata.as_deref(),
            ns_per_sample: self.ns_per_sample,
        }
        .serialize(serializer)
    }
}

/// What one sampler's spreads say: their fit, and the class read from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// See [`SamplerResult::fit`].
    pub fit: Option<Fit>,
    /// See [`SamplerResult::exact`].
    pub exact: bool,
    /// See [`SamplerResult::class`].
    pub class: Option<Class>,
    /// See [`SamplerResult::class_is_sure`].
    pub class_is_sure: bool,
}

impl Reading {
    /// Reads the spread at each N used, for a sampler by name in `dim` dimensions. A spread that
    /// is not a number is missing: it is neither fitted nor exact.
    pub fn of(sampler: &str, scramble: Scramble, dim: usize, spreads: &[(u64, Spread)]) -> Self {
        let fit = fit_spreads(spreads, 0);
        let exact = spreads.iter().all(|(_, spread)| spread.variance_of_mean == 0.0);
        // A torus shift tears the strata apart: what is known of a sampler holds for it
        // unscrambled.
        let reads_class = sampler == "jittered" && scramble == Scramble::None;
        let class = match (&fit, exact) {
            (_, true) => Some(Class::Exact),
            (Some(fit), _) if reads_class => Some(Class::of_exponent(fit.exponent, dim)),
            _ => None,
        };
        let class_is_sure = exact
            || reads_class
                && fit.is_some_and(|fit| {
                    Class::of_exponent(fit.ci95[0], dim) == Class::of_exponent(fit.ci95[1], dim)
                });
        Self { fit, exact, class, class_is_sure }
    }
}

/// The paper's fit through spreads with a variance, leaving out the `skip` smallest N. Counts
/// that were snapped to the same N drew the same points: they are one row.
pub(super) fn fit_spreads(spreads: &[(u64, Spread)], skip: usize) -> Option<Fit> {
    let mut spreads = spreads.to_vec();
    spreads.sort_by_key(|(n, _)| *n);
    spreads.dedup_by_key(|(n, _)| *n);
    fit(spreads.iter().skip(skip).map(|(n, spread)| (*n, spread)))
}
