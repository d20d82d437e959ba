//! Exact curves against trials, over whole pictures: one is the oracle of the other.
//!
//! For M trials at one N, with exact mean μ and variance σ² of a trial mean and its excess
//! kurtosis κ, the scores
//!
//! z = (s²/σ² - 1) / √(2/(M - 1) + κ/M)  and  z = (x̄ - μ) / √(σ²/M)
//!
//! have mean 0 and mean square 1. Each is tested at four standard errors, 1e-4 of false alarms;
//! and by Kolmogorov and Smirnov's distance from the normal distribution, at 1e-4. For that the
//! first is first made symmetric by the cube root of Wilson and Hilferty (1931), s² being close
//! to a chi-square of 2/(2/(M - 1) + κ/M) degrees of freedom.

use super::{Grids, TOLERANCE};
use crate::beam::PixelBeam;
use crate::integrand::Integrand;
use crate::scene::{self, Channel, Light, Material, Mesh, Scene};
use crate::study::{Control, StudyPlan, study};
use crate::trace::{PixelIntegrand, TracedScene};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use statrs::distribution::{ContinuousCDF, Normal};

const COUNTS: [u64; 5] = [1, 4, 16, 64, 256];

/// Excess kurtosis of a trial mean above which rare events rule and s² is far from chi-square.
const RARE: f64 = 5.0;

#[derive(Default)]
struct Scores {
    variance: Vec<f64>,
    /// The same scores, made symmetric.
    symmetric: Vec<f64>,
    mean: Vec<f64>,
    /// Rows without a score: rare events, or a measured variance that the dense grid misses by
    /// half, so that its kurtosis cannot be trusted.
    left_out: usize,
    /// Rows whose mean has no score: f32 radiance may be off by as much as it scatters.
    rounded: usize,
    /// Rows without variance, in both ways.
    constant: usize,
    unresolved: usize,
}

/// Σ of the strata's variances and fourth cumulants, from a dense grid of samples.
struct Shape {
    variance: f64,
    fourth: f64,
}

impl Shape {
    fn of(beam: &PixelBeam) -> [Self; COUNTS.len()] {
        const FINE: usize = 128;
        let place = |i: usize| (i as f64 + 0.5) / FINE as f64;
        let points: Vec<f64> =
            (0..FINE * FINE).flat_map(|i| [place(i % FINE), place(i / FINE)]).collect();
        let mut values = vec![0.0; FINE * FINE];
        beam.eval_block(&points, &mut values);
        COUNTS.map(|n| {
            let k = n.isqrt() as usize;
            let mut cells = vec![Vec::new(); k * k];
            for (i, value) in values.iter().enumerate() {
                cells[(i / FINE) * k / FINE * k + (i % FINE) * k / FINE].push(*value);
            }
            let mut shape = Self { variance: 0.0, fourth: 0.0 };
            for cell in cells {
                let size = cell.len() as f64;
                let mean = cell.iter().sum::<f64>() / size;
                let moment = |p| cell.iter().map(|v| (v - mean).powi(p)).sum::<f64>() / size;
                shape.variance += moment(2);
                shape.fourth += moment(4) - 3.0 * moment(2).powi(2);
            }
            shape
        })
    }
}

/// Scores of the lattice of `side` × `side` pixels: trials of one scene, curves of another.
fn scores(measured: &TracedScene, known: &TracedScene, side: u32, n_trials: u32) -> Scores {
    let plan = StudyPlan { counts: COUNTS.to_vec(), n_trials, ..StudyPlan::paper() };
    let grids = Grids::new(&COUNTS).unwrap();
    let mut scores = Scores::default();
    let m = f64::from(n_trials);
    let [width, height] = measured.scene().camera.resolution;
    for i in 0..side * side {
        let at = |i: u32, size: u32| (2 * i + 1) * size / (2 * side);
        let pixel = [at(i % side, width), at(i / side, height)];
        let beam = |traced: &TracedScene| {
            let (scene, accel) = (traced.scene(), traced.accel());
            PixelBeam::new(scene, accel, pixel, Channel::Luminance).unwrap()
        };
        let Ok(curve) = grids.curve(&beam(known), TOLERANCE) else {
            scores.unresolved += 1;
            continue;
        };
        let beam = beam(measured);
        let shapes = Shape::of(&beam);
        let result = study(&beam, pixel, &plan, Control::unwatched()).unwrap();
        for sampler in &result.samplers {
            for (i, row) in sampler.rows.iter().enumerate() {
                let n = row.n as f64;
                let (variance, shape, kurtosis) = match sampler.name {
                    "random" => {
                        let one = &shapes[0];
                        (
                            curve.variance / n,
                            one.variance / n,
                            one.fourth / one.variance.powi(2) / n,
                        )
                    }
                    _ => {
                        let Shape { variance, fourth } = &shapes[i];
                        (curve.jittered[i], variance / (n * n), fourth / variance.powi(2))
                    }
                };
                if variance == 0.0 && row.variance_of_mean == 0.0 {
                    scores.constant += 1;
                    continue;
                }
                // Not a number where the dense grid found no variance.
                let measured = row.variance_of_mean;
                let is_known = kurtosis <= RARE && (shape / measured - 1.0).abs() <= 0.5;
                if !is_known {
                    scores.left_out += 1;
                    continue;
                }
                let spread = 2.0 / (m - 1.0) + kurtosis / m;
                let ratio = measured / variance;
                scores.variance.push((ratio - 1.0) / spread.sqrt());
                // 2/(9ν) with ν = 2/spread.
                let ninth = spread / 9.0;
                scores.symmetric.push((ratio.cbrt() - (1.0 - ninth)) / ninth.sqrt());
                let std_error = (variance / m).sqrt();
                if curve.mean.abs() * 2f64.powi(-23) < 0.05 * std_error {
                    scores.mean.push((row.grand_mean - curve.mean) / std_error);
                } else {
                    scores.rounded += 1;
                }
            }
        }
    }
    scores
}

impl Scores {
    /// The distributions as found, and what is wrong with them.
    fn judge(&self) -> Result<String, String> {
        let mut text = format!(
            "{} rows, {} of their means too near to rounding; {} more constant, {} left out; {} \
             pixels unresolved",
            self.variance.len(),
            self.rounded,
            self.constant,
            self.left_out,
            self.unresolved
        );
        let mut fine = true;
        for (name, scores, distances) in
            [("variance", &self.variance, &self.symmetric), ("mean", &self.mean, &self.mean)]
        {
            let n = scores.len() as f64;
            let mean = scores.iter().sum::<f64>() / n;
            let square = scores.iter().map(|z| z * z).sum::<f64>() / n;
            let normal = Normal::new(0.0, 1.0).unwrap();
            let mut sorted: Vec<f64> = distances.iter().map(|z| normal.cdf(*z)).collect();
            sorted.sort_by(f64::total_cmp);
            let distance = sorted
                .iter()
                .enumerate()
                .map(|(i, p)| (p - i as f64 / n).max((i + 1) as f64 / n - p))
                .fold(0.0, f64::max);
            // 2 exp(-2 x²) = 1e-4 at x = 2.23. Scores of variances have κ = 12/ν at the most,
            // with ν = 2/(2/(M - 1) + κ/M): the variance of z² is then below 2.5 for M = 300.
            fine &= mean.abs() < 4.0 / n.sqrt()
                && (square - 1.0).abs() < 4.0 * (2.5 / n).sqrt()
                && distance < 2.23 / n.sqrt();
            text += &format!(
                "; {name}: mean {mean:.3} ± {:.3}, mean square {square:.3} ± {:.3}, distance {:.2} / √n",
                1.0 / n.sqrt(),
                (2.0 / n).sqrt(),
                distance * n.sqrt()
            );
        }
        if fine { Ok(text) } else { Err(text) }
    }
}

fn traced(name: &str) -> TracedScene {
    TracedScene::new(scene::load(name).unwrap())
}

#[test]
fn scores_of_two_pictures_are_standard_normal() {
    for name in ["classic", "classic-shadows"] {
        let scene = traced(name);
        let scores = scores(&scene, &scene, 14, 300);
        assert!(scores.unresolved < 4 && scores.mean.len() > 700);
        assert!(scores.left_out * 10 < scores.variance.len(), "{name}: {}", scores.left_out);
        scores.judge().unwrap_or_else(|text| panic!("{name}: {text}"));
    }
}

/// The same of more pixels, of every scene that the beam traces:
/// `cargo test -p stratcore --lib oracle -- --nocapture`.
/// METHOD.md has its last result.
#[test]
fn scores_of_every_scene_are_standard_normal() {
    use std::io::Write;
    for info in scene::library::SCENES {
        let scene = traced(info.name);
        if !matches!(scene.pixel([0, 0], Channel::Luminance), PixelIntegrand::Beam(_)) {
            continue;
        }
        let verdict = scores(&scene, &scene, 40, 1000).judge();
        writeln!(std::io::stderr(), "{}: {verdict:?}", info.name).unwrap();
        assert!(verdict.is_ok());
    }
}

/// Every edge a thousandth of a pixel beside where it is.
#[test]
fn a_shift_by_a_thousandth_of_a_pixel_is_found() {
    let scene = traced("classic");
    let mut shifted = scene.scene().clone();
    let camera = &mut shifted.camera;
    let pixel = 2.0 * (0.5 * camera.fov_y.to_radians()).tan() / f64::from(camera.resolution[1]);
    let away = (camera.look_at - camera.eye).length();
    camera.look_at += camera.frame()[1] * (1e-3 * pixel * away);
    let scores = scores(&scene, &TracedScene::new(shifted), 14, 300);
    assert!(scores.judge().is_err(), "{:?}", scores.judge());
}

/// A floor under the sun, seen from above, in the shadows of triangles that are out of sight.
fn shadow_play(n_blockers: usize) -> TracedScene {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(5);
    let sun = DVec3::new(0.1, 1.0, 0.1);
    let flat = |x: f64, z: f64| DVec3::new(x, 0.0, z);
    let mut triangles = vec![
        [flat(-9.0, -9.0), flat(9.0, -9.0), flat(9.0, 9.0)],
        [flat(-9.0, -9.0), flat(9.0, 9.0), flat(-9.0, 9.0)],
    ];
    let mut around = |size: f64| DVec3::from_array([0; 3].map(|_| rng.random_range(-size..size)));
    for _ in 0..n_blockers {
        let centre = flat(1.0, 0.0) * around(1.5) + DVec3::Z * around(1.5).z + sun * 9.0;
        triangles.push([0; 3].map(|_| centre + around(0.5)));
    }
    let mut scene: Scene = scene::load("edges").unwrap();
    scene.camera.eye = DVec3::new(0.0, 6.0, -4.0);
    scene.camera.look_at = DVec3::ZERO;
    scene.camera.fov_y = 25.0;
    scene.camera.resolution = [16, 16];
    scene.light = Light::Directional { towards: sun.normalize(), irradiance: [1.0; 3] };
    scene.ambient = [0.2; 3];
    let n = triangles.len() as u32;
    scene.materials = vec![Material { kd: [0.5; 3], ..Material::default() }];
    scene.mesh = Mesh {
        positions: triangles.concat(),
        triangles: (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        materials: vec![0; triangles.len()],
        corner_normals: None,
    };
    TracedScene::new(scene)
}

#[test]
fn a_missing_shadow_is_found() {
    let scene = shadow_play(12);
    let fine = scores(&scene, &scene, 16, 300);
    assert!(fine.unresolved == 0 && fine.mean.len() > 300, "{}", fine.mean.len());
    fine.judge().unwrap_or_else(|text| panic!("{text}"));
    let without_one = scores(&scene, &shadow_play(11), 16, 300);
    assert!(without_one.judge().is_err(), "{:?}, {:?}", fine.judge(), without_one.judge());
}
