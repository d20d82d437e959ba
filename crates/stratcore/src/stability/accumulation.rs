//! Sums of very many, very large, very small and very unequal values.

use super::studio::larger;
use super::{Bench, Family, Row};
use crate::double::Double;
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::literature::{Curve, Figure, Slope};
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Random, Sampler, Scramble};
use crate::study::collect;
use crate::trial::trial_means;
use crate::variance::Moments;
use std::sync::atomic::Ordering;

pub(super) const FAMILY: Family = Family {
    name: "accumulation",
    title: "Accumulation",
    advice: "The mean of one estimate is right to its last bit or two, whatever N: values are \
             summed in f64 with Neumaier's compensation, whose error does not grow with their \
             number. f32 sums stand still once a value is less than 2^-25 of the sum, for values \
             of one size at some 10^7 of them. Variances are taken about the mean, never as a \
             difference of squares, and parts that are merged agree with the whole. A mean of \
             1e6 is an f64 number, though, and those lie 1e-10 apart: no arithmetic can tell \
             trials apart that differ by less.",
    measure,
};

fn measure(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    means(bench)?;
    variances(bench);
    bench.check()?;
    merged(bench);
    Ok(())
}

/// offset + scale · x, and a rare bright value.
#[derive(Clone, Copy)]
struct Values {
    name: &'static str,
    offset: f64,
    scale: f64,
    /// (share, value)
    firefly: Option<(f64, f64)>,
}

impl Integrand for Values {
    fn dim(&self) -> usize {
        1
    }
    fn eval(&self, point: &[f64]) -> f64 {
        match self.firefly {
            Some((share, value)) if point[0] < share => value,
            _ => self.offset + self.scale * point[0],
        }
    }
}

/// Means of one trial: as an estimate is made, and three other ways.
struct Means {
    ours: f64,
    single: f64,
    plain: f64,
    exact: f64,
    /// (values, relative error of the sum so far) in f32, f64, and ours where it can be told.
    steps: Vec<[f64; 3]>,
}

fn sums(bench: &Bench<'_>, values: Values, column: u32, n: u64) -> Result<Means, StudyError> {
    const BLOCK: usize = 512;
    let key = bench.key(Random.stream_id(), column, n);
    let set = PointSet { key, dim: 1, scramble: Scramble::None, rectangular: false };
    let cancel = bench.control.cancel;
    let mut ours = [0.0];
    trial_means(&values, &Random, &set, 0, &mut ours, cancel);
    let source = Random.points(&set);
    let mut block = [0.0; BLOCK];
    let mut found = [0.0; BLOCK];
    let (mut single, mut plain, mut exact) = (0f32, 0f64, Double::default());
    let mut steps = Vec::new();
    let mut next_step = 1024;
    for first in (0..n).step_by(BLOCK) {
        if cancel.load(Ordering::Relaxed) {
            return Err(StudyError::Cancelled);
        }
        let len = BLOCK.min((n - first) as usize);
        source.fill(first, &mut block[..len]);
        values.eval_block(&block[..len], &mut found[..len]);
        for &value in &found[..len] {
            single += value as f32;
            plain += value;
            exact = exact + value;
        }
        let so_far = first + len as u64;
        if so_far >= next_step || so_far == n {
            let sum = exact.value();
            let off = |x: f64| (x / sum - 1.0).abs();
            steps.push([so_far as f64, off(single.into()), off(plain)]);
            next_step = so_far * 4;
        }
    }
    let n = n as f64;
    let exact = (exact / n).value();
    Ok(Means { ours: ours[0], single: f64::from(single) / n, plain: plain / n, exact, steps })
}

fn means(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let n: u64 = bench.either(10_000_000, 1_000_000_000);
    let even = Values { name: "mean of 1/2", offset: 0.0, scale: 1.0, firefly: None };
    let cases = [
        (even, n),
        (Values { name: "mean of 1e30", scale: 2e30, ..even }, n),
        (Values { name: "mean of 1e-30", scale: 2e-30, ..even }, n),
        (Values { name: "mean 1e6, spread 1e-6", offset: 1e6, scale: 3.5e-6, ..even }, n),
        (Values { name: "one firefly of 1e20", firefly: Some((1e-6, 1e20)), ..even }, 1_000_000),
    ];
    let work = |(column, (values, n)): (u32, (Values, u64))| sums(bench, values, column, n);
    let found = collect((0..).zip(cases).collect(), work)?;
    for ((values, n), means) in cases.into_iter().zip(&found) {
        let off = |mean: f64| (mean / means.exact - 1.0).abs();
        let note = match values.name {
            "mean of 1/2" => "a sum of f32 stands still at 2^24, as in the full run of 10^9 values",
            "mean of 1e30" => {
                "a sum of f32 stands still at 2^24 values, before it would leave its range"
            }
            "mean of 1e-30" => "f32 holds such numbers; what is off is the plain sum",
            "mean 1e6, spread 1e-6" => "f32 numbers near 1e6 lie 0.06 apart",
            _ => "f32 and f64 sums drop every value of 1/2 that comes after the firefly",
        };
        bench.push(
            // The compensated sum is rounded once, the quotient once.
            Row::new(values.name, "relative error of the mean", f64::EPSILON)
                .tried(format!("{n} values in one estimate"))
                .f32(off(means.single))
                .f64(off(means.plain))
                .error(off(means.ours))
                .floor(f64::EPSILON / 2.0)
                .note(note),
        );
    }
    let curve = |which: usize, name: &str| Curve {
        name: name.to_owned(),
        points: found[0]
            .steps
            .iter()
            .filter(|step| step[which] > 0.0)
            .map(|step| [step[0], step[which], 0.0, 0.0])
            .collect(),
    };
    bench.draw(Figure {
        name: "stability-sums",
        title: "Relative error of a running sum",
        caption: "Values uniform in 0 to 1, summed one after the other. The compensated sum, as \
                  used, stays on the floor of f64 (dashed)."
            .to_owned(),
        axes: ["values", "relative error of the sum"],
        log_x: true,
        curves: vec![curve(1, "f32"), curve(2, "f64, not compensated")],
        slopes: vec![
            Slope { name: "f64", factor: f64::EPSILON / 2.0, power: 0.0 },
            Slope { name: "f32", factor: f64::from(f32::EPSILON) / 2.0, power: 0.0 },
        ],
    });
    Ok(())
}

/// Trial means of 1e6 with a spread of 1e-6.
fn close_means(bench: &Bench<'_>, n: u64) -> Vec<f64> {
    let key = StreamKey { pixel: [64, 0], ..bench.key(Random.stream_id(), 0, n) };
    let set = PointSet { key, dim: 1, scramble: Scramble::None, rectangular: false };
    let mut values = vec![0.0; n as usize];
    Random.points(&set).fill(0, &mut values);
    for value in &mut values {
        *value = 1e6 + 3.5e-6 * *value;
    }
    values
}

/// Mean and unbiased variance in double-double.
fn exact_moments(values: &[f64]) -> [f64; 2] {
    let m = values.len() as f64;
    let mean = values.iter().fold(Double::default(), |sum, x| sum + *x) / m;
    let squares = values.iter().fold(Double::default(), |sum, x| {
        let off = Double::from(*x) - mean;
        sum + off * off
    });
    [mean.value(), (squares / (m - 1.0)).value()]
}

/// Σx² - (Σx)²/m.
fn textbook(values: &[f64]) -> f64 {
    let m = values.len() as f64;
    let (sum, squares) = values.iter().fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
    (squares - sum * sum / m) / (m - 1.0)
}

/// Welford 1962, in f64 and f32.
fn welford(values: &[f64]) -> [f64; 2] {
    let (mut mean, mut squares, mut count) = (0.0, 0.0, 0.0);
    let (mut mean32, mut squares32, mut count32) = (0f32, 0f32, 0f32);
    for &x in values {
        count += 1.0;
        let off = x - mean;
        mean += off / count;
        squares += off * (x - mean);
        let x = x as f32;
        count32 += 1.0;
        let off = x - mean32;
        mean32 += off / count32;
        squares32 += off * (x - mean32);
    }
    [squares / (count - 1.0), (squares32 / (count32 - 1.0)).into()]
}

/// Halves, merged by Chan, Golub & LeVeque's formula, down to single numbers.
fn pairwise(values: &[f64]) -> [f64; 3] {
    if let [x] = values {
        return [1.0, *x, 0.0];
    }
    let (a, b) = values.split_at(values.len() / 2);
    let ([na, ma, sa], [nb, mb, sb]) = (pairwise(a), pairwise(b));
    let (n, delta) = (na + nb, mb - ma);
    [n, ma + delta * nb / n, sa + sb + delta * delta * na * nb / n]
}

fn variances(bench: &mut Bench<'_>) {
    let n = bench.either(100_000, 1_000_000);
    let values = close_means(bench, n);
    let [_, truth] = exact_moments(&values);
    let off = |variance: f64| (variance / truth - 1.0).abs();
    let [welford64, welford32] = welford(&values);
    let [_, _, squares] = pairwise(&values);
    bench.push(
        Row::new("variance of 1e6 ± 1e-6", "relative error of s²", 1e-12)
            .tried(format!("{n} trial means"))
            .f32(off(welford32))
            .f64(off(textbook(&values)))
            .error(off(Moments::of(&values).variance))
            .floor(f64::EPSILON / 2.0)
            .note(format!(
                "f32: Welford; f64: Σx² - (Σx)²/M. In f64 Welford is off by {:.1e}, pairwise \
                 merging by {:.1e}; ours takes two passes about the first value, in a unit near \
                 the spread",
                off(welford64),
                off(squares / (n as f64 - 1.0)),
            )),
    );
}

fn merged(bench: &mut Bench<'_>) {
    let n = bench.either(100_000, 1_000_000);
    let close = close_means(bench, n);
    let even: Vec<f64> = close.iter().map(|x| (x - 1e6) / 3.5e-6).collect();
    let spread = |values: &[f64]| {
        let [mean, variance] = exact_moments(values);
        let mut worst = 0.0f64;
        for parts in [2usize, 10, 1000] {
            // Uneven parts: each the longer by its number.
            let step = values.len() / (parts * (parts + 1) / 2).max(1);
            let mut cuts = vec![0];
            for part in 1..parts {
                cuts.push((cuts[part - 1] + (part * step).max(2)).min(values.len() - 2));
            }
            cuts.dedup();
            cuts.push(values.len());
            let whole = cuts
                .windows(2)
                .filter(|cut| cut[1] - cut[0] >= 2)
                .map(|cut| Moments::of(&values[cut[0]..cut[1]]))
                .reduce(|a, b| a.merge(&b))
                .unwrap_or_default();
            if whole.count != values.len() as u64 {
                return f64::INFINITY;
            }
            worst = larger(worst, (whole.variance / variance - 1.0).abs());
            worst = larger(worst, (whole.mean / mean - 1.0).abs());
        }
        worst
    };
    let (of_even, of_close) = (spread(&even), spread(&close));
    bench.push(
        Row::new("parts merged are the whole", "relative error of mean and s²", 1e-11)
            .tried(format!("{n} values in 0 to 1, in 2, 10 and 1,000 uneven parts"))
            .error(of_even)
            .note("against double-double over all values"),
    );
    bench.push(
        Row::new("parts of 1e6 ± 1e-6", "relative error of mean and s²", 1e-4)
            .tried(format!("{n} values, in 2, 10 and 1,000 uneven parts"))
            .error(of_close)
            .note(
                "the mean of a part is an f64 number near 1e6, rounded by 1e-4 of the spread; \
                 the whole keeps its digits, parts keep half of them",
            ),
    );
}
