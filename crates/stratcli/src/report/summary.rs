//! What a reproduction found: every number of the report, and of `summary.json`.
//!
//! A part that is not finished is null. Intervals are ± one standard error unless they say
//! otherwise; "scatter" is the standard deviation of one run.

use super::histogram::Histogram;
use serde::Serialize;
use stratcore::theory::Class;

/// The paper's numbers.
pub mod paper {
    use stratcore::theory::Class;

    /// Figure 5: an example of each class.
    pub const CLOSE_UPS: [(Class, f64); 3] =
        [(Class::Smooth, 1.89), (Class::Edge, 1.45), (Class::Complex, 1.12)];
    /// Form factor: all N, and without N = 1.
    pub const FORM_FACTOR: [f64; 2] = [1.430, 1.501];
    /// The same with an occluder.
    pub const OCCLUDED: [f64; 2] = [1.233, 1.245];
}

/// Everything.
#[derive(Debug, Clone, Serialize)]
pub struct Summary {
    /// The command that makes this again.
    pub command: String,
    /// Whether every part is there.
    pub complete: bool,
    /// What was done.
    pub protocol: Protocol,
    /// The pixels of the picture.
    pub pixels: Option<Pixels>,
    /// The paper's closing claims.
    pub claims: Option<Claims>,
    /// One pixel of each class.
    pub close_ups: Vec<CloseUp>,
    /// The experiment in four dimensions.
    pub form_factor: Option<FormFactor>,
    /// Paper beside ours.
    pub verdicts: Vec<Verdict>,
    /// Names of the figures, without `.svg` and `.png`.
    pub figures: Vec<String>,
}

/// What was done.
#[derive(Debug, Clone, Serialize)]
pub struct Protocol {
    /// Scene's name.
    pub scene: String,
    /// Its triangles.
    pub triangles: usize,
    /// Its picture: width, height.
    pub resolution: [u32; 2],
    /// Samples per pixel of the picture in Figure 1.
    pub picture_spp: u64,
    /// Side of the lattice of studied pixels; null for every pixel.
    pub lattice: Option<u32>,
    /// Pixels to be studied.
    pub pixels: usize,
    /// Samplers compared.
    pub samplers: Vec<String>,
    /// Sample counts N.
    pub counts: Vec<u64>,
    /// Independent repeats M.
    pub trials: u32,
    /// Seed of all randomness.
    pub seed: u64,
    /// Repeats of the form factor's study.
    pub repeats: u32,
    /// Standard deviation of a fitted p from M normal trials at each N and nothing else:
    /// sqrt(2/(M-1)) / sqrt(Σ (ln N - mean ln N)²).
    pub noise_of_p: f64,
}

/// Fitted exponents over the picture.
#[derive(Debug, Clone, Serialize)]
pub struct Pixels {
    /// Pixels studied.
    pub studied: usize,
    /// Pixels whose every estimate was the same number: no exponent exists.
    pub exact: usize,
    /// Pixels with zero variance at some N under some sampler: a feature so small that all
    /// trials missed it. Not in the exponents below.
    pub partly_exact: usize,
    /// Exponents under `random`.
    pub random: Exponents,
    /// Exponents under `jittered`.
    pub jittered: Exponents,
    /// Shares of the classes, exact included.
    pub classes: Vec<ClassShare>,
}

/// The distribution of p over pixels.
#[derive(Debug, Clone, Serialize)]
pub struct Exponents {
    /// Pixels.
    pub pixels: usize,
    /// Mean p; null without pixels, as all that follow.
    pub mean: f64,
    /// Standard error of the mean.
    pub std_error: f64,
    /// Standard deviation of p over pixels.
    pub std_deviation: f64,
    /// Interquartile range over 1.349: the standard deviation if the distribution is normal,
    /// whatever its tails.
    pub robust_deviation: f64,
    /// Root mean square of the fits' own standard errors.
    pub typical_std_error: f64,
    /// 1st, 50th and 99th percentile.
    pub percentiles: [f64; 3],
    /// Counts in bins.
    pub histogram: Histogram,
}

/// One class's share of the picture.
#[derive(Debug, Clone, Serialize)]
pub struct ClassShare {
    /// The class.
    pub class: Class,
    /// Pixels in it.
    pub pixels: usize,
    /// Of them, those whose 95 % interval of p lies within the class and whose rows one line
    /// describes: χ² below its 99th percentile.
    pub clear: usize,
    /// Share of the studied pixels.
    pub share: f64,
}

/// The paper's conclusions, measured at every pixel and N.
#[derive(Debug, Clone, Serialize)]
pub struct Claims {
    /// One-sided level of the test on each ratio.
    pub level: f64,
    /// One row per N.
    pub rows: Vec<ClaimRow>,
    /// Sum over N > 1.
    pub beyond_one: ClaimRow,
    /// The pixels and N where `jittered` looked worst, measured again.
    pub suspects: Vec<Suspect>,
    /// Gains by class.
    pub gains: Vec<Gain>,
}

/// `jittered` against `random` at one N: ratio of their variances over all pixels where both
/// are above zero.
#[derive(Debug, Clone, Default, Serialize)]
pub struct ClaimRow {
    /// N; 0 in a sum over N.
    pub n: u64,
    /// Pixels compared.
    pub compared: u64,
    /// Mean of ln(variance jittered / variance random).
    pub mean_ln_ratio: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Pixels where `jittered` looks worse at the level.
    pub looks_worse: u64,
    /// Pixels where it looks better at the same level.
    pub looks_better: u64,
    /// `compared` × level: looks_worse if both were equal everywhere and trial means normal.
    pub expected_false_alarms: f64,
    /// `compared` × the rate seen at N = 1, where both are the same method: looks_worse if both
    /// were equal everywhere. Holds whatever the trial means' distribution.
    pub expected_from_n1: f64,
}

/// A pixel and N where `jittered` looked worst, with new seed and more trials.
#[derive(Debug, Clone, Serialize)]
pub struct Suspect {
    /// The pixel.
    pub pixel: [u32; 2],
    /// N.
    pub n: u64,
    /// Variance jittered / variance random, as first seen.
    pub ratio: f64,
    /// ln(ratio) over its standard error, as first seen.
    pub z: f64,
    /// Trials in the new measurement.
    pub again_trials: u32,
    /// The ratio as measured again.
    pub again_ratio: f64,
    /// Ends of its interval, three standard errors either side in the logarithm.
    pub again_interval: [f64; 2],
}

/// Variance random / variance jittered over the pixels of a class.
#[derive(Debug, Clone, Serialize)]
pub struct Gain {
    /// The class.
    pub class: Class,
    /// Pixels that are clearly in it.
    pub pixels: usize,
    /// N.
    pub n: Vec<u64>,
    /// Lower quartile, median and upper quartile per N.
    pub quartiles: Vec<[f64; 3]>,
    /// The paper's: N for smooth, sqrt(N) for edge, 1 for complex.
    pub paper: Vec<f64>,
}

/// One pixel chosen for its class.
#[derive(Debug, Clone, Serialize)]
pub struct CloseUp {
    /// Its class.
    pub class: Class,
    /// The pixel.
    pub pixel: [u32; 2],
    /// The paper's exponent for its example of the class.
    pub paper: f64,
    /// Ours under `jittered`.
    pub exponent: f64,
    /// Its standard error.
    pub std_error: f64,
    /// Ours under `random`.
    pub random: f64,
    /// Its standard error.
    pub random_std_error: f64,
    /// Standard deviation of one sample in the pixel.
    pub contrast: f64,
    /// Pixels the rule chose among.
    pub candidates: usize,
}

/// The experiment in four dimensions.
#[derive(Debug, Clone, Serialize)]
pub struct FormFactor {
    /// Sample counts N.
    pub counts: Vec<u64>,
    /// Independent repeats of the whole experiment, each with a seed of its own.
    pub repeats: u32,
    /// Mean of all estimates at the largest N, over all repeats.
    pub estimate: f64,
    /// Its standard error.
    pub std_error: f64,
    /// The closed form.
    pub analytic: f64,
    /// (estimate - analytic) / standard error.
    pub z: f64,
    /// Without occluder, then with occluders of growing side.
    pub cases: Vec<FormFactorCase>,
}

/// One geometry, repeated. Pairs are: all N; without N = 1.
#[derive(Debug, Clone, Serialize)]
pub struct FormFactorCase {
    /// Side of the half-way occluder; null for none.
    pub occluder: Option<f64>,
    /// Theory's exponent; null where every estimate is the same number.
    pub predicted: Option<f64>,
    /// The exponent that the exact variances fit to; null where they have no closed form.
    pub exact: [Option<f64>; 2],
    /// Mean exponent over the repeats; null where every estimate is the same number.
    pub mean: [Option<f64>; 2],
    /// Its standard error.
    pub std_error: [Option<f64>; 2],
    /// Standard deviation of one repeat.
    pub scatter: [Option<f64>; 2],
    /// The first repeat: `stratcli integrand form-factor` with this report's seed.
    pub one_run: [Option<f64>; 2],
}

/// One line of the table that ends the report.
#[derive(Debug, Clone, Serialize)]
pub struct Verdict {
    /// What is compared.
    pub what: String,
    /// The paper's value, as written there.
    pub paper: String,
    /// Ours.
    pub ours: String,
    /// What follows.
    pub verdict: String,
    /// Whether the paper's statement holds here; null where it is no test.
    pub holds: Option<bool>,
}
