//! What features cost a scene that does not have them, and one that does.
//!
//! A pinhole pixel is traced by the code that knows lenses, shutters, area lights, mirrors, glass
//! and reflections, beside a loop written here that knows of none of these. What scenes had before
//! any of them the loop has too: it asks for the kind of light and for shading normals at each
//! hit. It finds hits by the same BVH and test, and does without the integrand's trait, the split
//! of a point into axes, and the surface's sides and place, which a headlight does not need. Both
//! are measured in turn, by the thread's processor time where the system tells it; the median of
//! the ratios within a round is what counts. Then one row for each feature.

mod common;

use anyhow::Result;
use common::clock::Clock;
use common::lattice;
use std::hint::black_box;
use std::io::{Write, stdout};
use std::time::Duration;
use stratcore::integrand::Integrand;
use stratcore::rng::StreamKey;
use stratcore::sampler::{PointSet, Sampler, Scramble};
use stratcore::scene::{Channel, Light, Scene, load};
use stratcore::trace::{TracedScene, Tracer};

/// Odd, so that the median is one of them.
const ROUNDS: usize = 101;
/// Passes over all pixels in a round: some tens of milliseconds, for processor time comes in
/// steps of four.
const PASSES: usize = 8;
const PIXELS: u32 = 8;
const POINTS: usize = 512;

fn main() -> Result<()> {
    let classic = TracedScene::new(load("classic")?).with_tracer(Tracer::Bvh);
    let pixels = lattice(&classic.scene().camera, PIXELS);
    let mut ratios = Vec::with_capacity(ROUNDS);
    let mut ns = Vec::with_capacity(ROUNDS);
    for round in 0..ROUNDS {
        let points = points(2, round as u32);
        let by_hand = || pixels.iter().map(|pixel| pinhole(&classic, *pixel, &points)).sum();
        let general = || pixels.iter().map(|pixel| whole(&classic, *pixel, &points)).sum();
        // Which goes first alternates.
        let [hand, all] = if round % 2 == 0 {
            let hand = time(by_hand);
            [hand, time(general)]
        } else {
            let all = time(general);
            [time(by_hand), all]
        };
        ratios.push(all.as_secs_f64() / hand.as_secs_f64());
        ns.push(per_sample(all));
    }
    let [low, ratio, high] = quartiles(&mut ratios);
    let [_, ns, _] = quartiles(&mut ns);
    writeln!(stdout(), "pinhole, no feature used: {ns:.0} ns a sample")?;
    writeln!(
        stdout(),
        "ratio to a loop that knows of no features: {ratio:.4} (quartiles {low:.4}, {high:.4})"
    )?;
    for name in ["room", "room-lens", "room-motion", "room-all", "room-bounce"] {
        for (tracer, path) in [(Tracer::Beam, "beam"), (Tracer::Bvh, "BVH")] {
            let scene = TracedScene::new(load(name)?).with_tracer(tracer);
            let dim = scene.pixel([0, 0], Channel::Luminance).dim();
            let pixels = lattice(&scene.scene().camera, PIXELS);
            let points = points(dim, 0);
            let mut ns: Vec<_> = (0..5)
                .map(|_| {
                    let all = || pixels.iter().map(|pixel| whole(&scene, *pixel, &points)).sum();
                    per_sample(time(all))
                })
                .collect();
            let [_, ns, _] = quartiles(&mut ns);
            writeln!(stdout(), "{name}, d = {dim}, tracer {path}: {ns:.0} ns a sample")?;
        }
    }
    Ok(())
}

/// A pixel under a pinhole and a headlight.
fn pinhole(traced: &TracedScene, pixel: [u32; 2], points: &[f64]) -> f64 {
    let Scene { camera, mesh, materials, background, ambient, light, .. } = traced.scene();
    let frame = camera.pixel(pixel);
    let channel = Channel::Luminance;
    points
        .chunks_exact(2)
        .map(|point| {
            let direction = frame.direction(point[0], point[1]);
            let Some(hit) = traced.closest_hit(camera.eye, direction) else {
                return channel.of(*background);
            };
            if mesh.corner_normals.is_some() || *light != Light::Headlight {
                return channel.of(traced.radiance(camera.eye, direction));
            }
            let id = hit.triangle as usize;
            let cosine = mesh.area_normal(id).normalize().dot(direction.normalize()).abs();
            let material = &materials[mesh.materials[id] as usize];
            let rgb =
                std::array::from_fn(|i| material.ke[i] + material.kd[i] * (ambient[i] + cosine));
            channel.of(rgb)
        })
        .sum()
}

fn whole(scene: &TracedScene, pixel: [u32; 2], points: &[f64]) -> f64 {
    let integrand = scene.pixel(pixel, Channel::Luminance);
    let mut values = [0.0; POINTS];
    integrand.eval_block(points, &mut values);
    values.iter().sum()
}

fn points(dim: usize, trial: u32) -> Vec<f64> {
    let sampler = &stratcore::sampler::Random;
    let key = StreamKey {
        seed: 1996,
        pixel: [0, 0],
        sampler: sampler.stream_id(),
        n_samples: POINTS as u64,
        trial,
    };
    let set = PointSet { key, dim, scramble: Scramble::None, rectangular: false };
    let mut points = vec![0.0; POINTS * dim];
    sampler.points(&set).fill(0, &mut points);
    points
}

/// Time of all passes.
fn time(work: impl Fn() -> f64) -> Duration {
    let start = Clock::start(true);
    for _ in 0..PASSES {
        black_box(work());
    }
    start.elapsed()
}

fn per_sample(time: Duration) -> f64 {
    time.as_nanos() as f64 / (f64::from(PIXELS * PIXELS) * (PASSES * POINTS) as f64)
}

/// First quartile, median, third.
fn quartiles(values: &mut [f64]) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| values[values.len() * quarter / 4])
}
