//! Studies with hardly anything to go by.

use super::numbers::{not_a_number, signed_zero, subnormal};
use super::studio::{ball_and_floor, both, larger, scene};
use super::{Bench, Family, Row};
use crate::double::Double;
use crate::error::StudyError;
use crate::fit::{WeightedRow, power_law, weighted_fit};
use crate::integrand::{Integrand, by_name};
use crate::noise::Noise;
use crate::sampler::{PointSet, Scramble};
use crate::scene::{Channel, Light};
use crate::study::{Control, ExactStudy, SamplerChoice, StudyPlan, StudyResult, study};
use crate::trial::trial_means;
use crate::variance::Moments;

pub(super) const FAMILY: Family = Family {
    name: "statistics",
    title: "Statistics",
    advice: "Two trials have a variance, one N has no exponent, equal trials are exact, and a \
             single variance above zero is shown without a line. Exponents from 0 to 5 are \
             found to twelve digits over N from 1 to 2^40. One sample that is not a number \
             makes its study end with the pixel and the trial; it is never averaged away. \
             Radiance may be subnormal, but a variance that no f64 holds (below 1e-308 or above \
             1e308) is an error and not a zero.",
    measure,
};

fn measure(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    two_trials(bench)?;
    little_to_go_by(bench)?;
    equal_trials(bench);
    planted(bench);
    exact_to_2_40(bench)?;
    bench.check()?;
    not_a_number(bench)?;
    signed_zero(bench);
    subnormal(bench)
}

pub(super) fn plan(sampler: &str, counts: &[u64], n_trials: u32) -> Result<StudyPlan, StudyError> {
    let samplers = vec![SamplerChoice::named(sampler)?];
    Ok(StudyPlan { samplers, counts: counts.to_vec(), n_trials, ..StudyPlan::paper() })
}

pub(super) fn studied(
    bench: &Bench<'_>,
    f: &dyn Integrand,
    plan: StudyPlan,
) -> Result<StudyResult, StudyError> {
    let control = Control { cancel: bench.control.cancel, ..Control::unwatched() };
    study(f, [0, 0], &StudyPlan { seed: bench.seed, ..plan }, control)
}

/// M = 2: s² is half the squared difference.
fn two_trials(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let counts: Vec<u64> = (1..=16).map(|k| k * k).collect();
    let f = by_name("gaussian", None, &[]).map_err(|_| StudyError::EmptyPlan("integrands"))?;
    let result = studied(bench, &*f, plan("jittered", &counts, 2)?)?;
    let sampler = &result.samplers[0];
    let (mut off, mut single, mut loose) = (0.0f64, 0.0f64, 0);
    for row in &sampler.rows {
        let key = bench.key(1, 0, row.n_used);
        let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
        let mut means = [0.0; 2];
        let jittered = SamplerChoice::JITTERED.sampler;
        trial_means(&*f, jittered, &set, 0, &mut means, bench.control.cancel);
        let difference = Double::from(means[0]) - means[1];
        let exact = (difference * difference / 2.0).value();
        off = off.max((row.variance_of_mean / exact - 1.0).abs());
        let in_f32 = f64::from(means[0] as f32 - means[1] as f32).powi(2) / 2.0;
        single = single.max((in_f32 / exact - 1.0).abs());
        let [lo, hi] = row.noise.ci95(row.variance_of_mean);
        loose += u32::from(!(lo > 0.0 && lo < row.variance_of_mean && hi > row.variance_of_mean));
    }
    let is_sound = loose == 0 && sampler.fit.is_some_and(|fit| fit.std_error.is_finite());
    bench.push(
        Row::new("two trials", "relative error of s²", 1e-12)
            .tried("M = 2, N = 1 to 256, a gaussian; every row with its interval, and a fit")
            .f32(single)
            .error(if is_sound { off } else { f64::NAN })
            .note(
                "the difference of two means is rounded about one of them, in units of the mean; \
                 f32: the same from means rounded to f32",
            ),
    );
    Ok(())
}

/// One N, and one variance that is not zero: no exponent, and no NaN.
fn little_to_go_by(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let unknown = |_| StudyError::EmptyPlan("integrands");
    let gaussian = by_name("gaussian", None, &[]).map_err(unknown)?;
    let one = studied(bench, &*gaussian, plan("jittered", &[64], 50)?)?;
    // A step at one half: even numbers of strata resolve it, one stratum does not.
    let step = by_name("step", Some(1), &[("edge".to_owned(), 0.5)]).map_err(unknown)?;
    let single = studied(bench, &*step, plan("jittered", &[1, 2, 4, 8, 16], 50)?)?;
    let wrong = |result: &StudyResult, with_variance: usize| {
        let sampler = &result.samplers[0];
        let variances = sampler.rows.iter().filter(|row| row.variance_of_mean > 0.0).count();
        let claims = [
            sampler.fit.is_some(),
            sampler.paper_fit.is_some(),
            sampler.two_terms.is_some(),
            sampler.exact,
            sampler.class.is_some(),
            variances != with_variance,
        ];
        claims.iter().filter(|claim| **claim).count() as f64
    };
    bench.push(
        Row::new("one N only", "claims without ground", 0.0)
            .tried("a gaussian at N = 64 alone")
            .error(wrong(&one, 1))
            .note("a variance with its interval; no exponent, no class, not \"exact\""),
    );
    bench.push(
        Row::new("a single variance", "claims without ground", 0.0)
            .tried("a step at 1/2 in one dimension, N = 1, 2, 4, 8, 16: zero but at N = 1")
            .error(wrong(&single, 1))
            .note("zeros stay out of the fit, and one row is no line"),
    );
    Ok(())
}

/// Equal numbers have no variance, whatever they are.
fn equal_trials(bench: &mut Bench<'_>) {
    let (mut off, mut plain, mut single) = (0.0f64, 0.0f64, 0.0f64);
    for x in [0.1, 1.0 / 3.0, 1e30, 1e-30, 1e-310, 16_777_217.0] {
        let values = [x; 50];
        off = off.max(Moments::of(&values).variance / (x * x));
        let (sum, squares) = values.iter().fold((0.0, 0.0), |(s, q), x| (s + x, q + x * x));
        plain = plain.max(((squares - sum * sum / 50.0) / 49.0 / (x * x)).abs());
        let x = x as f32;
        let (sum, squares) = values.iter().fold((0f32, 0f32), |(s, q), _| (s + x, q + x * x));
        let variance = f64::from(((squares - sum * sum / 50.0) / 49.0 / (x * x)).abs());
        single = larger(single, variance);
    }
    bench.push(
        Row::new("all trials equal", "variance / mean²", 0.0)
            .tried("50 times 0.1, 1/3, 1e30, 1e-30, 1e-310, 2^24 + 1")
            .f32(single)
            .f64(plain)
            .error(off)
            .floor(0.0)
            .note("f32 and f64: Σx² - (Σx)²/M, which makes a variance of rounding"),
    );
}

/// Planted rows C N^-p over N = 1 to 2^40.
fn planted(bench: &mut Bench<'_>) {
    let names = ["p near 0", "p near 5"];
    for (name, exponents) in names.into_iter().zip([[0.0, 1e-9, 1e-3], [4.9, 5.0, 5.1]]) {
        let (mut off, mut single) = (0.0f64, 0.0f64);
        for p in exponents {
            let noise = Noise::ChiSquare { dof: 49.0 };
            let bias = noise.ln_variance(1.0);
            let rows: Vec<WeightedRow> = (0..=40)
                .map(|power| {
                    let n = 1u64 << power;
                    let variance = (-p * (n as f64).ln() - bias).exp();
                    WeightedRow::new(n, variance, noise)
                })
                .collect();
            let plain = rows.iter().map(|row| (row.n, row.variance, noise.var_ln()));
            for fit in [weighted_fit(&rows), power_law(plain)] {
                off = off.max(fit.map_or(f64::INFINITY, |fit| (fit.exponent - p).abs()));
            }
            single = larger(single, (slope_in_f32(&rows) + p).abs());
        }
        bench.push(
            Row::new(name, "error of p", 1e-12)
                .tried(format!("rows on N^-p, p = {exponents:?}, N = 1 to 2^40"))
                .f32(single)
                .error(off)
                .note("variances down to 2^-204; f32 has nothing below 2^-149 and gives no line"),
        );
    }
}

/// The least-squares slope of ln s² in ln N, f32 throughout.
fn slope_in_f32(rows: &[WeightedRow]) -> f64 {
    let points: Vec<_> =
        rows.iter().map(|row| ((row.n as f32).ln(), (row.variance as f32).ln())).collect();
    let m = points.len() as f32;
    let (x, y) = points.iter().fold((0f32, 0f32), |(x, y), p| (x + p.0, y + p.1));
    let (x, y) = (x / m, y / m);
    let (sxy, sxx) = points.iter().fold((0f32, 0f32), |(sxy, sxx), p| {
        (sxy + (p.0 - x) * (p.1 - y), sxx + (p.0 - x) * (p.0 - x))
    });
    f64::from(sxy / sxx)
}

/// A pixel's exact curve under random points: p = 1 from N = 1 to 2^40.
fn exact_to_2_40(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    let (mesh, camera) = ball_and_floor();
    let [traced, _] = both(&scene(mesh, camera, Light::Headlight));
    let counts: Vec<u64> = (0..=40).map(|power| 1 << power).collect();
    let plan = plan("random", &counts, 50)?;
    let exact = ExactStudy::new(&plan, crate::exact::TOLERANCE)?;
    let pixel = [7, 9];
    let integrand = traced.pixel(pixel, Channel::Luminance);
    let result = exact.pixel(&integrand, pixel, Control::unwatched())?;
    let sampler = &result.samplers[0];
    let is_exact = sampler.unresolved.is_none();
    let p = sampler.fit.filter(|_| is_exact).map_or(f64::NAN, |fit| fit.exponent);
    bench.push(
        Row::new("N from 1 to 2^40", "error of p", 1e-12)
            .tried("41 rows of a pixel's exact curve under random points")
            .error((p - 1.0).abs())
            .note("the variance over N, to the last bit"),
    );
    Ok(())
}
