//! Small accumulators over many pixels: what is kept of each study once its rows are gone.

mod spread;

pub use spread::mean_and_deviation;

use crate::report::summary::{ClaimRow, ClassShare, Gain, Pixels};
use spread::{QUANTILE, exponents, is_straight, quantile};
use stratcore::StudyResult;
use stratcore::fit::Fit;
use stratcore::study::SamplerResult;
use stratcore::theory::Class;

/// One-sided level at which one ratio of variances is called conspicuous; its normal quantile is
/// [`QUANTILE`].
pub const LEVEL: f64 = 0.01;

/// What is kept of one pixel.
#[derive(Debug, Clone, Copy)]
pub struct Record {
    /// The pixel.
    pub pixel: [u32; 2],
    /// Its class under `jittered`.
    pub class: Class,
    /// Whether the interval of p lies within the class and one line describes the rows: a
    /// horizontal edge, whose variance jumps from N to N, has an exponent in name only.
    pub clear: bool,
    /// Fits under `random` and `jittered` through every row; none where some row is exact.
    pub fits: Option<Fits>,
}

/// Exponents of one pixel, each with its standard error.
#[derive(Debug, Clone, Copy)]
pub struct Fits {
    /// Under `random`.
    pub random: [f64; 2],
    /// Under `jittered`.
    pub jittered: [f64; 2],
    /// Standard deviation of one sample: the root of the variance at the first N, over N.
    pub contrast: f64,
}

/// A pixel and N where `jittered` looked conspicuously worse.
#[derive(Debug, Clone, Copy)]
pub struct Conspicuous {
    /// The pixel.
    pub pixel: [u32; 2],
    /// N.
    pub n: u64,
    /// Variance jittered / variance random.
    pub ratio: f64,
    /// ln(ratio) over its standard error.
    pub z: f64,
}

#[derive(Debug, Clone, Copy, Default)]
struct PerN {
    compared: u64,
    sum: f64,
    sum_sq: f64,
    worse: u64,
    better: u64,
}

/// Everything that the report says of the picture's pixels, gathered one pixel at a time.
#[derive(Debug, Clone)]
pub struct Tally {
    counts: Vec<u64>,
    records: Vec<Record>,
    per_n: Vec<PerN>,
    /// ln(variance random / variance jittered), `[record, N]`; NaN where one is zero.
    ln_gains: Vec<f32>,
    /// The worst seen at N > 1, worst first.
    suspects: Vec<Conspicuous>,
}

impl Tally {
    /// Suspects that are kept.
    const SUSPECTS: usize = 8;

    /// An empty tally of studies with these counts.
    pub fn new(counts: &[u64]) -> Self {
        let per_n = vec![PerN::default(); counts.len()];
        let (records, ln_gains, suspects) = Default::default();
        Self { counts: counts.to_owned(), records, per_n, ln_gains, suspects }
    }

    /// Adds one pixel's study, which has both of the paper's samplers.
    pub fn add(&mut self, study: &StudyResult) {
        let (Some(random), Some(jittered)) = (named(study, "random"), named(study, "jittered"))
        else {
            return;
        };
        let rows = self.counts.len();
        let full = |s: &SamplerResult| s.paper_fit.filter(|fit| fit.points == rows);
        let pair = |fit: Fit| [fit.exponent, fit.std_error];
        let contrast = jittered.rows[0].variance_of_mean * jittered.rows[0].n_used as f64;
        let fits = full(random).zip(full(jittered)).map(|(r, j)| Fits {
            random: pair(r),
            jittered: pair(j),
            contrast: contrast.sqrt(),
        });
        let exact = random.exact && jittered.exact;
        self.records.push(Record {
            pixel: study.pixel,
            class: if exact { Class::Exact } else { jittered.class.unwrap_or(Class::Complex) },
            clear: jittered.class_is_sure && jittered.paper_fit.is_none_or(|fit| is_straight(&fit)),
            fits,
        });
        for (i, (r, j)) in random.rows.iter().zip(&jittered.rows).enumerate() {
            let ln_ratio = (j.variance_of_mean / r.variance_of_mean).ln();
            self.ln_gains.push(if ln_ratio.is_finite() { -ln_ratio as f32 } else { f32::NAN });
            if ln_ratio.is_finite() {
                let z = ln_ratio / (r.var_ln() + j.var_ln()).sqrt();
                self.compare(i, study.pixel, ln_ratio, z);
            }
        }
    }

    fn compare(&mut self, i: usize, pixel: [u32; 2], ln_ratio: f64, z: f64) {
        let row = &mut self.per_n[i];
        row.compared += 1;
        row.sum += ln_ratio;
        row.sum_sq += ln_ratio * ln_ratio;
        row.worse += u64::from(z > QUANTILE);
        row.better += u64::from(z < -QUANTILE);
        if self.counts[i] > 1 && z > QUANTILE {
            let at = self.suspects.partition_point(|s| s.z >= z);
            let suspect = Conspicuous { pixel, n: self.counts[i], ratio: ln_ratio.exp(), z };
            self.suspects.insert(at, suspect);
            self.suspects.truncate(Self::SUSPECTS);
        }
    }

    /// What is kept of every pixel, in the order of study.
    pub fn records(&self) -> &[Record] {
        &self.records
    }

    /// The worst seen at N > 1, worst first.
    pub fn suspects(&self) -> &[Conspicuous] {
        &self.suspects
    }

    /// Exponents and classes.
    pub fn pixels(&self) -> Pixels {
        let studied = self.records.len();
        let exact = self.records.iter().filter(|r| r.class == Class::Exact).count();
        let fits = || self.records.iter().filter_map(|r| r.fits);
        let classes = [Class::Exact, Class::Smooth, Class::Edge, Class::Complex].map(|class| {
            let of_class = || self.records.iter().filter(|r| r.class == class);
            let pixels = of_class().count();
            let clear = of_class().filter(|r| r.clear).count();
            ClassShare { class, pixels, clear, share: pixels as f64 / studied as f64 }
        });
        Pixels {
            studied,
            exact,
            partly_exact: studied - exact - fits().count(),
            random: exponents(fits().map(|f| f.random).collect()),
            jittered: exponents(fits().map(|f| f.jittered).collect()),
            classes: classes.to_vec(),
        }
    }

    /// `jittered` against `random` per N, and summed over N > 1.
    pub fn comparisons(&self) -> (Vec<ClaimRow>, ClaimRow) {
        let at_one = self.counts.iter().position(|n| *n == 1).map(|i| self.per_n[i]);
        let rate = at_one.map_or(f64::NAN, |one| one.worse as f64 / one.compared as f64);
        let row = |n: u64, t: PerN| {
            let compared = t.compared as f64;
            let mean = t.sum / compared;
            let variance = (t.sum_sq - compared * mean * mean).max(0.0) / (compared - 1.0);
            ClaimRow {
                n,
                compared: t.compared,
                mean_ln_ratio: mean,
                std_error: (variance / compared).sqrt(),
                looks_worse: t.worse,
                looks_better: t.better,
                expected_false_alarms: LEVEL * compared,
                expected_from_n1: rate * compared,
            }
        };
        let mut beyond = PerN::default();
        for (_, t) in self.counts.iter().zip(&self.per_n).filter(|(n, _)| **n > 1) {
            beyond.compared += t.compared;
            beyond.sum += t.sum;
            beyond.sum_sq += t.sum_sq;
            beyond.worse += t.worse;
            beyond.better += t.better;
        }
        (self.counts.iter().zip(&self.per_n).map(|(&n, &t)| row(n, t)).collect(), row(0, beyond))
    }

    /// Gains of the pixels that are clearly of a class.
    pub fn gains(&self) -> Vec<Gain> {
        let rows = self.counts.len();
        [(Class::Smooth, 1.0), (Class::Edge, 0.5), (Class::Complex, 0.0)]
            .map(|(class, power)| {
                let of_class = || {
                    let gains = self.records.iter().zip(self.ln_gains.chunks_exact(rows));
                    gains.filter(move |(r, _)| r.class == class && r.clear && r.fits.is_some())
                };
                let quartiles = (0..rows).map(|i| {
                    let mut column: Vec<_> = of_class().map(|(_, g)| f64::from(g[i])).collect();
                    column.sort_by(f64::total_cmp);
                    [0.25, 0.5, 0.75].map(|q| quantile(&column, q).exp())
                });
                Gain {
                    class,
                    pixels: of_class().count(),
                    n: self.counts.clone(),
                    quartiles: quartiles.collect(),
                    paper: self.counts.iter().map(|n| (*n as f64).powf(power)).collect(),
                }
            })
            .into_iter()
            .filter(|gain| gain.pixels > 0)
            .collect()
    }

    /// The rule that picks a close-up: among the pixels that are clearly of the class, the
    /// tenth with most contrast; of those, the one whose p is nearest to `paper`. With it, how
    /// many it was chosen among.
    pub fn close_up(&self, class: Class, paper: f64) -> Option<(Record, Fits, usize)> {
        let mut candidates: Vec<_> = self
            .records
            .iter()
            .filter(|r| r.class == class && r.clear)
            .filter_map(|r| Some((*r, r.fits?)))
            .collect();
        candidates.sort_by(|a, b| b.1.contrast.total_cmp(&a.1.contrast));
        candidates.truncate(candidates.len().div_ceil(10));
        let off = |fits: &Fits| (fits.jittered[0] - paper).abs();
        let nearest = candidates.iter().min_by(|a, b| off(&a.1).total_cmp(&off(&b.1)))?;
        Some((nearest.0, nearest.1, candidates.len()))
    }
}

/// One sampler's part of a study.
pub fn named<'a>(study: &'a StudyResult, name: &str) -> Option<&'a SamplerResult> {
    study.samplers.iter().find(|s| s.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stratcore::integrand::Integrand;
    use stratcore::study::{Control, StudyPlan, study};

    /// A ramp, an edge, a constant, or a hash of the point: one of each class.
    struct Kind(u32);
    impl Integrand for Kind {
        fn dim(&self) -> usize {
            2
        }
        fn eval(&self, x: &[f64]) -> f64 {
            match self.0 % 4 {
                0 => x[0] + 0.5 * x[1],
                1 => f64::from(x[0] + 0.3 * x[1] < 0.5),
                2 => 0.25,
                _ => (x[0] * 1e9).rem_euclid(1.0),
            }
        }
    }

    fn tally(pixels: u32) -> Tally {
        let plan = StudyPlan::paper();
        let mut tally = Tally::new(&plan.counts);
        for x in 0..pixels {
            tally.add(&study(&Kind(x), [x, 0], &plan, Control::unwatched()).unwrap());
        }
        tally
    }

    #[test]
    fn classes_exponents_and_gains_of_known_pixels() {
        let tally = tally(40);
        let pixels = tally.pixels();
        assert_eq!((pixels.studied, pixels.exact, pixels.partly_exact), (40, 10, 0));
        for share in &pixels.classes {
            assert_eq!(share.pixels, 10, "{:?}", share.class);
        }
        // 30 fits of sd 0.033: the mean is within 5 x 0.033/sqrt(30) but for one time in a
        // million.
        assert!((pixels.random.mean - 1.0).abs() < 0.03, "{}", pixels.random.mean);
        let gains = tally.gains();
        // At N = 256 a ramp gains 256, and what is finer than any stratum gains nothing. The
        // median of 10 ratios of M = 50 has a standard error of about 0.29 x 1.25 / sqrt(10)
        // in the logarithm; five of them is a factor of 1.8.
        for (gain, exact) in [(&gains[0], 256.0), (&gains[2], 1.0)] {
            let factor = gain.quartiles[15][1] / exact;
            assert!((0.55..1.8).contains(&factor), "{:?}: {factor}", gain.class);
            assert_eq!(gain.paper[15], exact);
        }
    }

    #[test]
    fn at_one_sample_the_samplers_agree_and_beyond_it_jittered_is_not_worse() {
        let tally = tally(200);
        let (rows, beyond) = tally.comparisons();
        assert_eq!(rows[0].compared, 150);
        // Five standard errors, and five of the Poisson count: one false alarm in a million.
        assert!(rows[0].mean_ln_ratio.abs() < 5.0 * rows[0].std_error);
        assert_eq!(beyond.compared, 150 * 15);
        let expected = beyond.expected_false_alarms;
        assert!((beyond.looks_worse as f64) < expected + 5.0 * expected.sqrt());
        assert!(beyond.looks_better > 1000);
        assert!(tally.suspects().windows(2).all(|w| w[0].z >= w[1].z));
    }

    #[test]
    fn the_close_up_is_of_its_class_and_nearest_to_the_paper() {
        let tally = tally(120);
        let (record, fits, among) = tally.close_up(Class::Edge, 1.45).unwrap();
        assert_eq!(record.pixel[0] % 4, 1);
        assert!((1..=3).contains(&among));
        assert!((fits.contrast - 0.5).abs() < 0.05);
        assert!(Tally::new(&[1, 4]).close_up(Class::Smooth, 2.0).is_none());
    }
}
