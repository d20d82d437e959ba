//! What was measured.

use crate::fit::{
    Fit, LocalSlope, TwoTerms, WeightedRow, local_slopes, paper_fit, two_terms, weighted_fit,
};
use crate::integrand::Reference;
use crate::noise::Noise;
use crate::sampler::Scramble;
use crate::theory::Class;
use crate::variance::{Moments, Spread};
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
    /// The exponent that theory predicts: from the integrand's known regularity, otherwise
    /// from the class.
    pub predicted: Option<f64>,
}

impl SamplerResult {
    /// What the weighted fit is made of: the rows with a variance, in the order of N.
    pub fn weighted_rows(&self) -> Vec<WeightedRow> {
        weighted_rows(&distinct(&self.rows))
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

    /// The row's spread, as the paper's fit wants it.
    pub fn spread(&self) -> Spread {
        let Self { grand_mean, variance_of_mean, .. } = *self;
        Spread { grand_mean, variance_of_mean, var_ln: self.var_ln() }
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

/// Every curve through one sampler's rows.
pub(super) struct Fits {
    pub weighted: Option<Fit>,
    pub local_slopes: Vec<LocalSlope>,
    pub two_terms: Option<TwoTerms>,
    pub paper: Option<Fit>,
    pub paper_without_first: Option<Fit>,
}

impl Fits {
    /// Of the rows of one sampler.
    pub fn of(rows: &[Row]) -> Self {
        let rows = distinct(rows);
        let spreads: Vec<_> = rows.iter().map(|row| (row.n_used, row.spread())).collect();
        let paper = |skip| paper_fit(spreads.iter().skip(skip).map(|(n, spread)| (*n, spread)));
        let weighted_rows = weighted_rows(&rows);
        let weighted = weighted_fit(&weighted_rows);
        Self {
            weighted,
            local_slopes: local_slopes(&weighted_rows),
            two_terms: weighted.and_then(|single| two_terms(&weighted_rows, &single)),
            paper: paper(0),
            paper_without_first: paper(1),
        }
    }
}

/// In the order of N. Counts that were snapped to the same N drew the same points: they are
/// one row.
fn distinct(rows: &[Row]) -> Vec<&Row> {
    let mut rows: Vec<&Row> = rows.iter().collect();
    rows.sort_by_key(|row| row.n_used);
    rows.dedup_by_key(|row| row.n_used);
    rows
}

fn weighted_rows(rows: &[&Row]) -> Vec<WeightedRow> {
    let varying = rows.iter().filter(|row| row.variance_of_mean > 0.0);
    let row = |row: &&Row| WeightedRow {
        n: row.n_used,
        variance: row.variance_of_mean,
        noise: row.noise,
    };
    varying.map(row).collect()
}
