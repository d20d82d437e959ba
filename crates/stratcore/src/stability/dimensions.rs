//! Points in very many dimensions.

use super::studio::larger;
use super::{Bench, Family, Row};
use crate::double::Double;
use crate::error::StudyError;
use crate::integrand::{Integrand, by_name};
use crate::rng::StreamKey;
use crate::sampler::{CountPolicy, Jittered, PointSet, Sampler, Scramble, whole_set};
use crate::study::{Control, SamplerChoice, StudyPlan, study};
use glam::DVec2;

pub(super) const FAMILY: Family = Family {
    name: "dimensions",
    title: "Dimensions",
    advice: "Jittered sets keep one point in each stratum in any dimension that has a set: in 64 \
             dimensions N = 1, and from there on N = 2^d is beyond what can be addressed (2^44). \
             Sequences keep one point in each elementary interval of every axis up to dimension \
             1,024, scrambled or not, and their coordinates are the nearest f64 numbers to the \
             fractions that they stand for.",
    measure,
};

fn measure(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    strata(bench)?;
    variances(bench)?;
    sequences(bench)?;
    halton(bench)?;
    many_coordinates(bench)
}

/// Jittered points of every N = k^d below 2^40, and unequal strata, up to d = 64.
fn strata(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const RUN: u64 = 64;
    let (mut outside, mut total, mut sets) = (0u64, 0u64, 0u64);
    let mut single_outside = 0u64;
    for dim in 1..=64usize {
        bench.check()?;
        let cubes = (1..=5u64).filter_map(|k| k.checked_pow(dim as u32));
        let odd = [2u64, 12, 1 << 10, 3 * 5 * 7 * 11 * 13];
        for n in cubes.chain(odd).filter(|n| *n < 1 << 40) {
            let rectangular = !Jittered.admits(n, dim, false);
            let key = bench.key(Jittered.stream_id(), dim as u32, n);
            let set = PointSet { key, dim, scramble: Scramble::None, rectangular };
            let strata = Jittered.strata(n, dim).unwrap_or_default();
            let product = strata.iter().try_fold(1u64, |product, k| product.checked_mul(*k));
            outside += u64::from(product != Some(n) || strata.len() != dim);
            let points = Jittered.points(&set);
            sets += 1;
            for first in [0, n / 2, n.saturating_sub(RUN)] {
                let len = RUN.min(n - first);
                let mut run = vec![0.0; len as usize * dim];
                points.fill(first, &mut run);
                for (index, point) in (first..).zip(run.chunks(dim)) {
                    let mut rest = index;
                    for (x, k) in point.iter().zip(&strata) {
                        let cell = (rest % k) as f64;
                        rest /= k;
                        let within = |x: f64| {
                            let (at, lost) = crate::double::two_product(x, *k as f64);
                            let place = (Double::from(at) - cell + lost).value();
                            (0.0..1.0).contains(&x) && (0.0..=1.0).contains(&place)
                        };
                        outside += u64::from(!within(*x));
                        single_outside += u64::from(!within(f64::from(*x as f32)));
                        total += 1;
                    }
                }
            }
        }
    }
    let share = |count: u64| count as f64 / total as f64;
    bench.push(
        Row::new("strata up to d = 64", "share of coordinates outside their stratum", 0.0)
            .tried(format!(
                "{sets} sets of N = k^d below 2^40 and of unequal strata, {total} coordinates"
            ))
            .f32(share(single_outside))
            .error(share(outside))
            .floor(0.0)
            .note("f32: the same coordinates rounded to f32; some become 1, or cross to the next"),
    );
    Ok(())
}

/// Variance of a ramp under N = 2^d jittered points against its closed form.
fn variances(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const TRIALS: u32 = 400;
    let mut worst = 0.0f64;
    let dims: Vec<usize> = vec![1, 2, 3, 5, 8, 10, 12];
    let deepest = [(16, 1u64), (64, 1)];
    let sizes = dims.iter().map(|d| (*d, 1u64 << d)).chain(deepest);
    let plan = StudyPlan {
        samplers: vec![SamplerChoice::JITTERED],
        n_trials: TRIALS,
        seed: bench.seed,
        ..StudyPlan::paper()
    };
    let mut rows = 0;
    for (dim, n) in sizes {
        bench.check()?;
        let Ok(f) = by_name("ramp", Some(dim), &[]) else {
            worst = f64::NAN;
            continue;
        };
        let plan = StudyPlan { counts: vec![n], ..plan.clone() };
        let result = study(&*f, [0, 0], &plan, Control::unwatched())?;
        let row = &result.samplers[0].rows[0];
        let exact = row.exact_variance.unwrap_or(f64::NAN);
        let z = (row.variance_of_mean / exact - 1.0) / (2.0 / f64::from(TRIALS - 1)).sqrt();
        worst = larger(worst, z.abs());
        rows += 1;
    }
    bench.push(
        // Uniform offsets have less kurtosis than normal ones: 4 standard errors are passed by
        // chance once in 16,000 rows, or less.
        Row::new("variance in d dimensions", "standard errors from the closed form", 4.0)
            .tried(format!(
                "a ramp under jittered N = 2^d, d up to 12, N = 1 to d = 64, {rows} rows"
            ))
            .error(worst)
            .note("|a|²/(12 N k²)"),
    );
    Ok(())
}

fn set(
    bench: &Bench<'_>,
    sampler: &dyn Sampler,
    scramble: Scramble,
    n: u64,
    dim: usize,
) -> PointSet {
    let key = StreamKey { trial: 5, ..bench.key(sampler.stream_id(), dim as u32, n) };
    PointSet { key, dim, scramble, rectangular: false }
}

/// One point in each of the 2^m intervals of each axis of Sobol' points, in each of the b of
/// Halton points.
fn sequences(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let (mut wrong, mut axes) = (0u64, 0u64);
    let mut single_wrong = 0u64;
    let cases = [
        ("sobol", Scramble::None),
        ("sobol", Scramble::Owen),
        ("sobol", Scramble::OwenHash),
        ("sobol", Scramble::LmsShift),
        ("halton", Scramble::None),
        ("halton", Scramble::Owen),
        ("halton", Scramble::DigitPermutation),
    ];
    for (name, scramble) in cases {
        let sampler = crate::sampler::by_name(name)?;
        let dim = sampler.facts().max_dim;
        // All the bases of Halton's 1,024 axes are below 2^13.
        let n = if name == "sobol" { 1 << 10 } else { 8192 };
        let points = whole_set(sampler, &set(bench, sampler, scramble, n, dim))?;
        bench.check()?;
        let bases = primes(dim);
        for axis in (0..dim).step_by(bench.either(5, 1)) {
            let parts = if name == "sobol" { n } else { bases[axis] };
            let mut seen = [vec![0u32; parts as usize], vec![0u32; parts as usize]];
            let along = points.chunks_exact(dim).take(parts as usize).map(|point| point[axis]);
            let mut is_inside = true;
            for x in along {
                is_inside &= (0.0..1.0).contains(&x);
                for (seen, x) in seen.iter_mut().zip([x, f64::from(x as f32)]) {
                    // An unscrambled coordinate is the lower end of its interval, rounded.
                    let place = (x * parts as f64 + 4e-12) as usize;
                    seen[place.min(parts as usize - 1)] += 1;
                }
            }
            let is_even = |seen: &[u32]| seen.iter().all(|count| *count == 1);
            wrong += u64::from(!is_inside || !is_even(&seen[0]));
            single_wrong += u64::from(!is_even(&seen[1]));
            axes += 1;
        }
    }
    bench.push(
        Row::new("sequences to d = 1,024", "share of axes without one point per interval", 0.0)
            .tried(format!(
                "Sobol' (2^10 intervals) and Halton (as many as the axis's base), unscrambled \
                 and under five scrambles, {axes} axes"
            ))
            .f32(single_wrong as f64 / axes as f64)
            .error(wrong as f64 / axes as f64)
            .floor(0.0)
            .note("f32: the same coordinates rounded to f32"),
    );
    Ok(())
}

fn primes(count: usize) -> Vec<u64> {
    let is_prime = |n: &u64| (2..=n.isqrt()).all(|d| !n.is_multiple_of(d));
    (2u64..).filter(is_prime).take(count).collect()
}

/// Coordinates of the unscrambled Halton sequence against their fractions.
fn halton(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let sampler = crate::sampler::by_name("halton")?;
    let dim = sampler.facts().max_dim;
    let n = 1u64 << 32;
    let points = sampler.points(&set(bench, sampler, Scramble::None, n, dim));
    let bases = primes(dim);
    let (mut worst, mut single) = (0.0f64, 0.0f64);
    const RUN: usize = 32;
    for first in [0, 12_345, n / 3, n - RUN as u64] {
        let mut run = vec![0.0; RUN * dim];
        points.fill(first, &mut run);
        for (index, point) in (first..).zip(run.chunks(dim)) {
            for (x, base) in point.iter().zip(&bases) {
                let exact = mirrored(index, *base);
                worst = larger(worst, (Double::from(*x) - exact).value().abs());
                let x = f64::from(*x as f32);
                single = single.max((Double::from(x) - exact).value().abs());
            }
        }
    }
    bench.push(
        // Half the spacing of numbers below 1.
        Row::new("coordinates of Halton", "largest error of a coordinate", 2f64.powi(-53))
            .tried("1,024 axes, indices up to 2^32")
            .f32(single)
            .error(worst)
            .floor(2f64.powi(-54))
            .note("against the digits' fraction in double-double"),
    );
    Ok(())
}

/// The digits of `index` in a base, mirrored at the point.
fn mirrored(index: u64, base: u64) -> Double {
    // Below 2^46: both are exact.
    let (mut rest, mut above, mut below) = (index, 0u64, 1u64);
    while rest > 0 {
        above = above * base + rest % base;
        below *= base;
        rest /= base;
    }
    Double::from(above as f64) / below as f64
}

/// Σ (xᵢ - 1/2) √(12/d): variance 1.
struct Sum(usize);

impl Integrand for Sum {
    fn dim(&self) -> usize {
        self.0
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let sum: DVec2 = point
            .chunks(2)
            .map(|pair| DVec2::new(pair[0] - 0.5, pair.get(1).map_or(0.0, |y| y - 0.5)))
            .sum();
        (sum.x + sum.y) * (12.0 / self.0 as f64).sqrt()
    }
}

/// A study in 1,024 dimensions: random points against 1/N, and every sequence falls faster.
fn many_coordinates(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const DIM: usize = 1024;
    let plan = StudyPlan {
        samplers: ["random", "sobol", "halton", "lhs"]
            .iter()
            .map(|name| SamplerChoice::named(name))
            .collect::<Result<_, _>>()?,
        counts: vec![16, 64, 256],
        count_policy: CountPolicy::Error,
        n_trials: 100,
        seed: bench.seed,
    };
    let control = Control { cancel: bench.control.cancel, ..Control::unwatched() };
    let result = study(&Sum(DIM), [0, 0], &plan, control)?;
    let deviation = (2.0 / f64::from(plan.n_trials - 1)).sqrt();
    let mut worst = 0.0f64;
    for sampler in &result.samplers {
        for row in &sampler.rows {
            let z = (row.variance_of_mean * row.n_used as f64 - 1.0) / deviation;
            // Stratified along each axis, a sum has far less than random points give it.
            worst = larger(worst, if sampler.name == "random" { z.abs() } else { z });
        }
    }
    bench.push(
        Row::new("a study in 1,024 dimensions", "standard errors above 1/N", 4.0)
            .tried("a sum over all coordinates, random, sobol, halton and lhs, N = 16, 64, 256")
            .error(worst)
            .note("random points have 1/N, whatever d; the others no more"),
    );
    Ok(())
}
