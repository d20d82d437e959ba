//! A map in numbers: shares of classes, the spread of p, and samplers against one another.

use super::histogram::Histogram;
use super::plan::Identity;
use super::{PixelReading, SamplerIdentity};
use crate::theory::Class;
use serde::{Deserialize, Serialize};

/// What is said of a whole map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Pixels in the map.
    pub pixels: u64,
    /// Pixels of which nothing is known: a trial's mean was not finite.
    pub missing: u64,
    /// Shares of the classes, read under unscrambled `jittered`; empty without it.
    pub classes: Vec<ClassShare>,
    /// One entry per sampler.
    pub samplers: Vec<SamplerSummary>,
    /// Each sampler but the first of them against `random`, or against the first.
    pub comparisons: Vec<Comparison>,
}

/// How much of a map is of one class.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClassShare {
    /// The class.
    pub class: Class,
    /// Its pixels.
    pub pixels: u64,
    /// As a share of all pixels.
    pub share: f64,
    /// Of them those whose whole 95 % interval of p is of the class.
    pub sure: u64,
}

/// The exponents of a map under one sampler.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SamplerSummary {
    /// Name and scramble.
    pub sampler: String,
    /// Pixels with a fit.
    pub fitted: u64,
    /// Pixels where every variance is zero.
    pub exact: u64,
    /// Pixels with a fit and zero variance at some N.
    pub partly_exact: u64,
    /// Pixels whose variances were computed without trials.
    pub computed: u64,
    /// The first pixel, tile by tile, that was measured by trials; missing ones apart.
    #[serde(default)]
    pub first_measured: Option<[u32; 2]>,
    /// Pixels with too few variances above zero for a fit, though not all are zero.
    pub unfitted: u64,
    /// Mean of p over the fits; none without fits.
    pub mean: Option<f64>,
    /// Standard deviation of p over the fits; none below two.
    pub std_deviation: Option<f64>,
    /// Quartiles of p over the fits, to a bin of the histogram.
    pub quartiles: Option<[f64; 3]>,
    /// p in bins.
    pub histogram: Histogram,
}

/// Variance of the mean under one sampler over that of another, at the same N.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name and scramble of the sampler.
    pub sampler: String,
    /// And of the one that it is held against.
    pub baseline: String,
    /// Pixels of this class, read under unscrambled `jittered`; all pixels where none is given.
    pub class: Option<Class>,
    /// At each N that both use, in ascending order.
    pub gains: Vec<Gain>,
}

/// A comparison at one N.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// N
    pub n: u64,
    /// Pixels where both variances are above zero.
    pub pixels: u64,
    /// Quartiles of the ratio of variances over those pixels; the middle one is the median.
    /// Below 1 the sampler is better.
    pub quartiles: Option<[f64; 3]>,
}

const CLASSES: [Class; 4] = [Class::Exact, Class::Smooth, Class::Edge, Class::Complex];

/// A [`Summary`] under construction, one pixel at a time. Its memory does not depend on the
/// number of pixels.
#[derive(Debug, Clone)]
pub struct Tally {
    pixels: u64,
    missing: u64,
    /// The unscrambled `jittered`.
    judge: Option<usize>,
    /// Pixels, and sure ones, of each of [`CLASSES`].
    classes: [[u64; 2]; 4],
    samplers: Vec<Exponents>,
    pairs: Vec<Pair>,
}

#[derive(Debug, Clone)]
struct Exponents {
    label: String,
    fitted: u64,
    exact: u64,
    partly_exact: u64,
    unfitted: u64,
    computed: u64,
    first_measured: Option<[u32; 2]>,
    /// Sums of p - 1 and of its square.
    sums: [f64; 2],
    histogram: Histogram,
}

#[derive(Debug, Clone)]
struct Pair {
    sampler: usize,
    baseline: usize,
    /// N, and its place in the counts of both.
    rows: Vec<(u64, [usize; 2])>,
    /// Histograms of log₂ of the ratio: per class and then for all, one per row.
    ratios: [Vec<Histogram>; 5],
}

impl Tally {
    /// An empty one for maps of this plan.
    pub fn new(plan: &Identity) -> Self {
        let find = |name| plan.samplers.iter().position(|s| s.is_plain(name));
        let baseline = find("random").unwrap_or(0);
        let pair = |sampler: usize| {
            let used = |i: usize| &plan.samplers[i].counts_used;
            let mut rows: Vec<(u64, [usize; 2])> = used(sampler)
                .iter()
                .enumerate()
                .filter_map(|(at, n)| {
                    let there = used(baseline).iter().position(|other| other == n)?;
                    Some((*n, [at, there]))
                })
                .collect();
            rows.sort_unstable();
            rows.dedup_by_key(|(n, _)| *n);
            // Ratios from 2^-32 to 2^32, to 2 %.
            let empty = vec![Histogram::new(-32.0, 1.0 / 32.0, 2048); rows.len()];
            Pair { sampler, baseline, rows, ratios: std::array::from_fn(|_| empty.clone()) }
        };
        let exponents = |sampler: &SamplerIdentity| Exponents {
            label: sampler.label(),
            fitted: 0,
            exact: 0,
            partly_exact: 0,
            unfitted: 0,
            computed: 0,
            first_measured: None,
            sums: [0.0; 2],
            histogram: Histogram::new(0.0, 0.02, 200),
        };
        Self {
            pixels: 0,
            missing: 0,
            judge: find("jittered"),
            classes: [[0; 2]; 4],
            samplers: plan.samplers.iter().map(exponents).collect(),
            pairs: (0..plan.samplers.len()).filter(|i| *i != baseline).map(pair).collect(),
        }
    }

    /// Counts the pixel at (x, y): one reading per sampler.
    pub fn add(&mut self, at: [u32; 2], pixel: &[PixelReading]) {
        self.pixels += 1;
        if pixel.iter().any(PixelReading::is_missing) {
            self.missing += 1;
            return;
        }
        let judged = self.judge.map(|i| &pixel[i].reading);
        let class = judged.and_then(|reading| reading.class);
        let class = class.and_then(|class| CLASSES.iter().position(|c| *c == class));
        if let Some(class) = class {
            self.classes[class][0] += 1;
            self.classes[class][1] += u64::from(judged.is_some_and(|r| r.class_is_sure));
        }
        for (tally, pixel) in self.samplers.iter_mut().zip(pixel) {
            tally.add(at, pixel);
        }
        for pair in &mut self.pairs {
            for (row, (_, at)) in pair.rows.iter().enumerate() {
                let a = pixel[pair.sampler].moments[at[0]].variance;
                let b = pixel[pair.baseline].moments[at[1]].variance;
                if a > 0.0 && b > 0.0 {
                    let ratio = (a / b).log2();
                    class.iter().for_each(|class| pair.ratios[*class][row].add(ratio));
                    pair.ratios[4][row].add(ratio);
                }
            }
        }
    }

    /// What was counted.
    pub fn summary(&self) -> Summary {
        let share = |(class, [pixels, sure]): (&Class, &[u64; 2])| ClassShare {
            class: *class,
            pixels: *pixels,
            share: *pixels as f64 / self.pixels as f64,
            sure: *sure,
        };
        let shares = CLASSES.iter().zip(&self.classes).map(share);
        Summary {
            pixels: self.pixels,
            missing: self.missing,
            classes: if self.judge.is_some() { shares.collect() } else { Vec::new() },
            samplers: self.samplers.iter().map(Exponents::summary).collect(),
            comparisons: self.pairs.iter().flat_map(|pair| self.compare(pair)).collect(),
        }
    }

    fn compare(&self, pair: &Pair) -> Vec<Comparison> {
        let label = |i: usize| self.samplers[i].label.clone();
        let classes = CLASSES.iter().map(|class| Some(*class)).chain([None]);
        let gain = |((n, _), histogram): (&(u64, [usize; 2]), &Histogram)| Gain {
            n: *n,
            pixels: histogram.n(),
            quartiles: quartiles(histogram).map(|q| q.map(f64::exp2)),
        };
        let comparison = |(class, histograms): (Option<Class>, &Vec<Histogram>)| Comparison {
            sampler: label(pair.sampler),
            baseline: label(pair.baseline),
            class,
            gains: pair.rows.iter().zip(histograms).map(gain).collect(),
        };
        let has_pixels = |c: &Comparison| c.gains.iter().any(|gain| gain.pixels > 0);
        classes.zip(&pair.ratios).map(comparison).filter(has_pixels).collect()
    }
}

impl Exponents {
    fn add(&mut self, at: [u32; 2], pixel: &PixelReading) {
        if pixel.is_computed() {
            self.computed += 1;
        } else {
            self.first_measured.get_or_insert(at);
        }
        let Some(fit) = &pixel.reading.fit else {
            *(if pixel.reading.exact { &mut self.exact } else { &mut self.unfitted }) += 1;
            return;
        };
        self.fitted += 1;
        let has_zero = pixel.moments.iter().any(|moments| moments.variance == 0.0);
        self.partly_exact += u64::from(has_zero);
        let p = fit.exponent - 1.0;
        self.sums = [self.sums[0] + p, self.sums[1] + p * p];
        self.histogram.add(fit.exponent);
    }

    fn summary(&self) -> SamplerSummary {
        let n = self.fitted as f64;
        let [sum, squares] = self.sums;
        let variance = (squares - sum * sum / n) / (n - 1.0);
        SamplerSummary {
            sampler: self.label.clone(),
            fitted: self.fitted,
            exact: self.exact,
            partly_exact: self.partly_exact,
            unfitted: self.unfitted,
            computed: self.computed,
            first_measured: self.first_measured,
            mean: (self.fitted > 0).then(|| 1.0 + sum / n),
            std_deviation: (self.fitted > 1).then(|| variance.max(0.0).sqrt()),
            quartiles: quartiles(&self.histogram),
            histogram: self.histogram.clone(),
        }
    }
}

fn quartiles(histogram: &Histogram) -> Option<[f64; 3]> {
    let [low, middle, high] = [0.25, 0.5, 0.75].map(|q| histogram.quantile(q));
    Some([low?, middle?, high?])
}
