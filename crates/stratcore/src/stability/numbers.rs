//! Radiance that is hardly a number.

use super::statistics::{plan, studied};
use super::studio::{all_pixels, ball_and_floor, both, differing_bits, means, scene};
use super::{Bench, Row};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Random, Sampler, Scramble};
use crate::scene::{Channel, Light, Mesh};
use crate::study::{Control, SamplerChoice, StudyPlan, study};
use crate::trial::trial_means;
use crate::variance::Moments;
use glam::dvec3;

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

pub(super) fn not_a_number(bench: &mut Bench<'_>) -> Result<(), StudyError> {
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
pub(super) fn signed_zero(bench: &mut Bench<'_>) {
    let quad = |zero: f64| {
        let corner = |x: f64, y: f64| dvec3(x, y, zero);
        let [a, b] = [corner(-1.0, zero), corner(1.0, -1.0)];
        let [c, d] = [corner(zero, 1.0), corner(-1.0, 1.0)];
        Mesh::loose([[a, b, c], [a, c, d]])
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

pub(super) fn subnormal(bench: &mut Bench<'_>) -> Result<(), StudyError> {
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
