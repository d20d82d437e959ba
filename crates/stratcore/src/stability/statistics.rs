//! Studies with hardly anything to go by, and radiance that is hardly a number.

use super::studio::{
    all_pixels, ball_and_floor, both, differing_bits, larger, means, scene, triangles,
};
use super::{Bench, Family, Row};
use crate::double::Double;
use crate::error::StudyError;
use crate::fit::{WeightedRow, power_law, weighted_fit};
use crate::integrand::{Integrand, by_name};
use crate::noise::Noise;
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Random, Sampler, Scramble};
use crate::scene::{Channel, Light, Mesh};
use crate::study::{Control, ExactStudy, SamplerChoice, StudyPlan, StudyResult, study};
use crate::trial::trial_means;
use crate::variance::Moments;
use glam::dvec3;

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

fn plan(sampler: &str, counts: &[u64], n_trials: u32) -> Result<StudyPlan, StudyError> {
    let samplers = vec![SamplerChoice::named(sampler)?];
    Ok(StudyPlan { samplers, counts: counts.to_vec(), n_trials, ..StudyPlan::paper() })
}

fn studied(
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

/// A step of something that is no number, on a share of the cube.
struct Spoilt {
    share: f64,
    value: f64,
}

impl Integrand for Spoilt {
    fn dim(&self) -> usize {
        1
    }
    fn eval(&self, point: &[f64]) -> f64 {
        if point[0] < self.share { self.value } else { point[0] }
    }
}

/// Which trial first has a sample below `share`.
fn first_spoilt(key: StreamKey, share: f64, trials: u32) -> Option<u32> {
    let mut points = vec![0.0; key.n_samples as usize];
    (0..trials).find(|&trial| {
        let key = StreamKey { trial, ..key };
        let set = PointSet { key, dim: 1, scramble: Scramble::None, rectangular: false };
        Random.points(&set).fill(0, &mut points);
        points.iter().any(|x| *x < share)
    })
}

fn not_a_number(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const N: u64 = 10_000;
    const SHARE: f64 = 1e-5;
    const PIXEL: [u32; 2] = [11, 7];
    let (mut unnoticed, mut cases) = (0u32, 0u32);
    let plan = StudyPlan { seed: bench.seed, ..plan("random", &[N], 100)? };
    let key = StreamKey { pixel: PIXEL, ..bench.key(Random.stream_id(), 0, N) };
    let expected = first_spoilt(key, SHARE, plan.n_trials);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let found = study(&Spoilt { share: SHARE, value }, PIXEL, &plan, Control::unwatched());
        let is_told = matches!(found, Err(StudyError::NonFinite { pixel: PIXEL, trial, .. })
            if Some(trial) == expected);
        unnoticed += u32::from(!is_told);
        cases += 1;
    }
    // A scene whose ball glows so: every pixel that sees it says so, the others do not.
    for value in [f64::NAN, f64::INFINITY] {
        let (mesh, camera) = ball_and_floor();
        let mut scene = scene(mesh, camera, Light::Headlight);
        scene.materials.push(scene.materials[0].clone());
        scene.materials[1].ke = [0.0, value, 0.0];
        let floor = scene.mesh.triangles.len() - 4;
        scene.mesh.materials[..floor].fill(1);
        let plan = StudyPlan { counts: vec![16], ..plan.clone() };
        for traced in both(&scene) {
            for pixel in all_pixels(&camera) {
                let frame = camera.pixel(pixel);
                let sees = |u: i32, v: i32| {
                    let [u, v] = [u, v].map(|i| f64::from(i) / 8.0);
                    let hit = traced.closest_hit(camera.eye, frame.direction(u, v));
                    hit.is_some_and(|hit| (hit.triangle as usize) < floor)
                };
                let all = (0..=8).all(|u| (0..=8).all(|v| sees(u, v)));
                // Half a pixel around it, so that no sliver of the ball is overlooked.
                let some = (-4..=12).any(|u| (-4..=12).any(|v| sees(u, v)));
                let integrand = traced.pixel(pixel, Channel::Luminance);
                let found = study(&integrand, pixel, &plan, Control::unwatched());
                let told =
                    matches!(found, Err(StudyError::NonFinite { pixel: p, .. }) if p == pixel);
                // Where the ball fills a small part of the pixel, either may be.
                unnoticed += u32::from(all && !told || !some && told);
                cases += 1;
            }
        }
        bench.check()?;
    }
    bench.push(
        Row::new("NaN and infinite radiance", "cases not reported, or elsewhere", 0.0)
            .tried(format!(
                "one sample in 10^5 of NaN or ±infinity among 100 trials of {N}; a ball that \
                 emits NaN or infinity, 256 pixels by beam and rays; {cases} cases"
            ))
            .error(unnoticed.into())
            .note(format!(
                "the study ends with the pixel and the first trial that met it (here {}); a map \
                 leaves that pixel missing and counts it",
                expected.map_or("none".to_owned(), |trial| format!("trial {trial}"))
            )),
    );
    Ok(())
}

/// -0 for 0 in coordinates and in trial means.
fn signed_zero(bench: &mut Bench<'_>) {
    let quad = |zero: f64| {
        let corner = |x: f64, y: f64| dvec3(x, y, zero);
        let [a, b] = [corner(-1.0, zero), corner(1.0, -1.0)];
        let [c, d] = [corner(zero, 1.0), corner(-1.0, 1.0)];
        triangles([[a, b, c], [a, c, d]])
    };
    let (_, camera) = ball_and_floor();
    let picture = |mesh: Mesh| {
        both(&scene(mesh, camera, Light::Headlight)).map(|traced| {
            means(bench, &traced, SamplerChoice::JITTERED, 16, 1, all_pixels(&camera))
        })
    };
    let (plus, minus) = (picture(quad(0.0)), picture(quad(-0.0)));
    let changed = [0, 1].map(|t| differing_bits(&plus[t], &minus[t]) as f64);
    let moments = Moments::of(&[0.0, -0.0, 0.0, -0.0]);
    let zeros = f64::from(u8::from(moments.variance != 0.0 || moments.is_out_of_range()));
    bench.push(
        Row::new("signed zero", "pixels that change a bit", 0.0)
            .tried("corners at -0 instead of 0, 256 pixels; trial means of 0 and -0")
            .f32(changed[0])
            .f64(changed[1])
            .error(changed[0].max(changed[1]) + zeros)
            .note("0 and -0 are one number: such trials are exact"),
    );
}

/// scale · x, so small that it is subnormal.
struct Tiny;

/// 2^-1060 is 2^14 of the smallest number.
const TINY: f64 = f64::from_bits(1 << 14);

impl Integrand for Tiny {
    fn dim(&self) -> usize {
        1
    }
    fn eval(&self, point: &[f64]) -> f64 {
        TINY * point[0]
    }
}

fn subnormal(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    const N: u64 = 10_000;
    let key = bench.key(Random.stream_id(), 0, N);
    let set = PointSet { key, dim: 1, scramble: Scramble::None, rectangular: false };
    let mut mean = [0.0];
    trial_means(&Tiny, &Random, &set, 0, &mut mean, bench.control.cancel);
    let mut points = vec![0.0; N as usize];
    Random.points(&set).fill(0, &mut points);
    // In units of the smallest number, as whole numbers.
    let sum: u64 = points.iter().map(|x| (TINY * x).to_bits()).sum();
    let exact = sum as f64 / N as f64;
    let off = (mean[0].to_bits() as f64 - exact).abs();
    let refused = studied(bench, &Tiny, plan("random", &[1, 4, 16], 50)?);
    let is_told = matches!(refused, Err(StudyError::VarianceOutOfRange { .. }));
    bench.push(
        Row::new("subnormal radiance", "error of the mean, in units of 2^-1074", 0.5)
            .tried(format!("{N} values below 2^-1060"))
            .f32(exact)
            .error(if is_told { off } else { f64::NAN })
            .floor(0.5)
            .note(
                "f32 has no such numbers; the mean is the nearest there is; its variance, \
                 2^-2120, is no f64, and a study says so",
            ),
    );
    Ok(())
}
