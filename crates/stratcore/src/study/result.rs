//! What was measured.

use crate::dimensions::Bound;
use crate::exact::Unresolved;
use crate::fit::{
    Fit, LocalSlope, TwoTerms, WeightedRow, both_fits, local_slopes, paper_fit, two_terms,
};
use crate::integrand::Reference;
use crate::noise::{Noise, pooled_noise};
use crate::sampler::Scramble;
use crate::theory::{Basis, Class};
use crate::variance::Moments;
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

impl StudyResult {
    /// The same in the paper's terms: each sampler's [`fit`](SamplerResult::fit) is its
    /// [`paper_fit`](SamplerResult::paper_fit).
    #[must_use]
    pub fn with_paper_fits(mut self) -> Self {
        for sampler in &mut self.samplers {
            sampler.fit = sampler.paper_fit;
            sampler.two_terms = None;
        }
        self
    }
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
    /// Generalised least squares through the rows that have a variance, each with the weight
    /// that its noise gives it; none when fewer than two have.
    pub fit: Option<Fit>,
    /// How often one slope would leave residuals as large as the fit's by chance: below some
    /// 0.01 no single slope describes the rows.
    pub misfit_p_value: Option<f64>,
    /// Exponents between neighbouring N.
    pub local_slopes: Vec<LocalSlope>,
    /// Two power laws, where one does not describe the rows and two do better.
    pub two_terms: Option<TwoTerms>,
    /// The paper's unweighted fit through the same rows. Classes are read from it.
    pub paper_fit: Option<Fit>,
    /// The paper's fit without the row of smallest N.
    pub paper_fit_without_first: Option<Fit>,
    /// Every variance is zero: each estimate was the same number.
    pub exact: bool,
    /// Kind of pixel, read from the exponent under `jittered`; none for other samplers.
    pub class: Option<Class>,
    /// Whether the exponent's 95 % interval lies within its class.
    pub class_is_sure: bool,
    /// The exponent that theory predicts for large N, never from what was measured: from what is
    /// known of the integrand; for a pixel, once [`predict_pixel`] was asked, from what it needs.
    ///
    /// [`predict_pixel`]: crate::dimensions::predict_pixel
    pub predicted: Option<f64>,
    /// How it binds; none without a prediction.
    pub predicted_bound: Option<Bound>,
    /// Which of the two it is from.
    pub predicted_from: Option<Basis>,
    /// Where the law was published.
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

impl SamplerResult {
    /// What the weighted fit is made of: the rows with a variance, in the order of N.
    pub fn weighted_rows(&self) -> Vec<WeightedRow> {
        weighted_rows(self.rows.iter().map(|row| (row.n_used, row.variance_of_mean, row.noise)))
    }
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
    /// g₁ of the trial means; 0 without a variance.
    pub skewness: f64,
    /// g₂ of the trial means (0 for normal ones); 0 without a variance.
    pub kurtosis: f64,
    /// How s² scatters about the true variance, from the shape of this row's trial means and
    /// those of the sampler's other rows.
    pub noise: Noise,
    /// The variance that a closed form gives at this N, where the integrand has one.
    pub exact_variance: Option<f64>,
    /// Strata along each axis, where rectangular ones were allowed and the sampler has strata.
    pub strata: Option<Vec<u64>>,
    /// Machine time per sample, generation and evaluation, where the caller lent a clock.
    pub ns_per_sample: Option<f64>,
}

impl Row {
    /// Variance of ln s²; 0 where s² is.
    pub fn var_ln(&self) -> f64 {
        self.noise.var_ln()
    }

    /// The moments of its trial means, which were so many.
    pub fn moments(&self, trials: u32) -> Moments {
        let Self { grand_mean: mean, variance_of_mean: variance, skewness, kurtosis, .. } = *self;
        Moments { count: trials.into(), mean, variance, skewness, kurtosis }
    }

    /// Ends of the variance's 95 % interval.
    pub fn ci95(&self) -> [f64; 2] {
        self.noise.ci95(self.variance_of_mean)
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
            var_ln: Option<f64>,
            skewness: Option<f64>,
            kurtosis: Option<f64>,
            exact_variance: Option<f64>,
            strata: Option<&'a [u64]>,
            ns_per_sample: Option<f64>,
        }
        let [lo, hi] = self.ci95();
        let varies = self.variance_of_mean > 0.0;
        Document {
            n: self.n,
            n_used: self.n_used,
            grand_mean: self.grand_mean,
            variance_of_mean: self.variance_of_mean,
            lo,
            hi,
            var_ln: varies.then(|| self.var_ln()),
            skewness: varies.then_some(self.skewness),
            kurtosis: varies.then_some(self.kurtosis),
            exact_variance: self.exact_variance,
            strata: self.strata.as_deref(),
            ns_per_sample: self.ns_per_sample,
        }
        .serialize(serializer)
    }
}

/// What one sampler's rows say: the noise of each, the fits, and the class.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// How each row's s² scatters.
    pub noise: Vec<Noise>,
    /// See [`SamplerResult::fit`].
    pub fit: Option<Fit>,
    /// See [`SamplerResult::paper_fit`].
    pub paper_fit: Option<Fit>,
    /// See [`SamplerResult::exact`].
    pub exact: bool,
    /// See [`SamplerResult::class`].
    pub class: Option<Class>,
    /// See [`SamplerResult::class_is_sure`].
    pub class_is_sure: bool,
}

impl Reading {
    /// Reads the moments of the trial means at each N used, for a sampler by name in `dim`
    /// dimensions. A variance that is not a number is missing: it is neither fitted nor exact.
    pub fn of(sampler: &str, scramble: Scramble, dim: usize, rows: &[(u64, Moments)]) -> Self {
        let noise = pooled_noise(rows);
        let varying = noisy_rows(rows, &noise);
        let [fit, paper_fit] = both_fits(&varying);
        let exact = rows.iter().all(|(_, moments)| moments.variance == 0.0);
        // A torus shift tears the strata apart: what is known of a sampler holds for it
        // unscrambled.
        let reads_class = sampler == "jittered" && scramble == Scramble::None;
        let class = match (&paper_fit, exact) {
            (_, true) => Some(Class::Exact),
            (Some(fit), _) if reads_class => Some(Class::of_exponent(fit.exponent, dim)),
            _ => None,
        };
        let class_is_sure = exact
            || reads_class
                && paper_fit.is_some_and(|fit| {
                    Class::of_exponent(fit.ci95[0], dim) == Class::of_exponent(fit.ci95[1], dim)
                });
        Self { noise, fit, paper_fit, exact, class, class_is_sure }
    }
}

/// Curves beyond the two lines of a [`Reading`].
pub(super) struct Curves {
    pub local_slopes: Vec<LocalSlope>,
    pub two_terms: Option<TwoTerms>,
    pub paper_without_first: Option<Fit>,
}

impl Curves {
    pub fn of(rows: &[(u64, Moments)], reading: &Reading) -> Self {
        let varying = noisy_rows(rows, &reading.noise);
        Self {
            local_slopes: local_slopes(&varying),
            two_terms: reading.fit.and_then(|single| two_terms(&varying, &single)),
            paper_without_first: paper_fit(varying.get(1..).unwrap_or_default()),
        }
    }
}

fn noisy_rows(rows: &[(u64, Moments)], noise: &[Noise]) -> Vec<WeightedRow> {
    weighted_rows(
        rows.iter().zip(noise).map(|((n, moments), noise)| (*n, moments.variance, *noise)),
    )
}

/// The rows (N, variance, noise) with a variance, in the order of N. Counts that were snapped to
/// the same N drew the same points: they are one row.
fn weighted_rows(rows: impl Iterator<Item = (u64, f64, Noise)>) -> Vec<WeightedRow> {
    let mut rows: Vec<_> = rows.collect();
    rows.sort_by_key(|(n, ..)| *n);
    rows.dedup_by_key(|(n, ..)| *n);
    let varying = rows.into_iter().filter(|(_, variance, _)| *variance > 0.0);
    varying.map(|(n, variance, noise)| WeightedRow::new(n, variance, noise)).collect()
}
