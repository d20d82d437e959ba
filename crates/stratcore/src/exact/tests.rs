use super::{ExactCurve, TOLERANCE, Unresolved, curve};
use crate::beam::PixelBeam;
use crate::integrand::quadrature::gauss_legendre;
use crate::scene::{self, Channel, Light, Material, Mesh, library::SCENES};
use crate::study::{Control, ExactStudy, Method, SamplerChoice, StudyPlan, study};
use crate::trace::{TracedScene, Tracer};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::PI;

/// The one pixel of a camera at the origin that looks along z: at depth 1 it spans x and y
/// from -1/2 to 1/2, u to the right and v downwards.
struct Stage {
    corners: Vec<[DVec3; 3]>,
    /// Emission of each triangle.
    values: Vec<f64>,
}

impl Stage {
    fn new() -> Self {
        Self { corners: Vec::new(), values: Vec::new() }
    }

    /// A triangle by its corners (x, y) on the picture and their depths.
    fn triangle(mut self, value: f64, corners: [[f64; 3]; 3]) -> Self {
        self.corners.push(corners.map(|[x, y, z]| DVec3::new(x, y, 1.0) * z));
        self.values.push(value);
        self
    }

    /// A polygon about its first corner.
    fn polygon(self, value: f64, depth: f64, corners: &[[f64; 2]]) -> Self {
        let at = |i: usize| [corners[i][0], corners[i][1], depth];
        (1..corners.len() - 1)
            .fold(self, |stage, i| stage.triangle(value, [at(0), at(i), at(i + 1)]))
    }

    fn wall(self, value: f64, depth: f64) -> Self {
        self.polygon(value, depth, &[[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]])
    }

    fn traced(self) -> TracedScene {
        let mut scene = scene::load("edges").unwrap();
        scene.camera.eye = DVec3::ZERO;
        scene.camera.look_at = DVec3::Z;
        scene.camera.fov_y = 2.0 * 0.5f64.atan().to_degrees();
        scene.camera.resolution = [1, 1];
        scene.light = Light::Directional { towards: DVec3::Y, irradiance: [0.0; 3] };
        scene.ambient = [0.0; 3];
        scene.background = [0.0; 3];
        let n = self.corners.len() as u32;
        scene.mesh = Mesh {
            positions: self.corners.concat(),
            triangles: (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            materials: (0..n).collect(),
            corner_normals: None,
        };
        let material = |&ke| Material { kd: [0.8; 3], ke: [ke; 3], ..Material::default() };
        scene.materials = self.values.iter().map(material).collect();
        TracedScene::new(scene)
    }

    fn curve(self, counts: &[u64]) -> Result<ExactCurve, Unresolved> {
        curve(&beam(&self.traced(), [0, 0]), counts, TOLERANCE)
    }
}

fn beam(traced: &TracedScene, pixel: [u32; 2]) -> PixelBeam {
    PixelBeam::new(traced.scene(), traced.accel(), pixel, Channel::Luminance).unwrap()
}

fn squares(k: u64) -> Vec<u64> {
    (1..=k).map(|k| k * k).collect()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found:e} is not {expected:e} ± {tolerance:e}");
}

#[test]
fn a_pixel_of_one_value_has_no_variance() {
    let covered = Stage::new().wall(0.7, 5.0).curve(&squares(16)).unwrap();
    let empty = Stage::new().curve(&squares(16)).unwrap();
    assert_near(covered.mean, 0.7, 1e-15);
    assert_eq!((empty.mean, empty.patches), (0.0, 0));
    for curve in [covered, empty] {
        assert_eq!((curve.variance, curve.error), (0.0, 0.0));
        assert!(curve.jittered.iter().all(|v| *v == 0.0));
    }
}

/// A step at c along one axis cuts a row of k strata into v and 1 - v: v(1 - v) k / N².
#[test]
fn an_axis_aligned_step_at_every_n() {
    for (c, vertical) in [(0.3, true), (0.5, true), (0.05, false), (0.707, false)] {
        let at = |a: f64, b: f64| if vertical { [a, b] } else { [b, -a] };
        let strip = [at(-2.0, -2.0), at(c - 0.5, -2.0), at(c - 0.5, 2.0), at(-2.0, 2.0)];
        let found =
            Stage::new().wall(0.2, 9.0).polygon(1.2, 4.0, &strip).curve(&squares(40)).unwrap();
        assert_near(found.mean, 0.2 + c, 1e-14);
        assert_near(found.variance, c * (1.0 - c), 1e-14);
        for (k, variance) in (1..=40u32).zip(&found.jittered) {
            let k = f64::from(k);
            let v = (k * c).fract();
            let expected = if (k * c - (k * c).round()).abs() < 1e-9 {
                0.0
            } else {
                v * (1.0 - v) * k / k.powi(4)
            };
            assert_near(*variance, expected, 1e-13);
            assert!(expected > 0.0 || *variance == 0.0, "c = {c}, k = {k}: {variance:e}");
        }
    }
}

/// Half a pixel: k strata on the diagonal, each half and half.
#[test]
fn a_diagonal_at_every_n() {
    let half = [[-2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
    let found = Stage::new().polygon(3.0, 4.0, &half).curve(&squares(40)).unwrap();
    assert_near(found.mean, 1.5, 1e-14);
    for (k, variance) in (1..=40u32).zip(&found.jittered) {
        let k = f64::from(k);
        assert_near(*variance, 9.0 * 0.25 * k / k.powi(4), 1e-13);
    }
}

/// Many triangles of one value around a point are one polygon of that value.
#[test]
fn a_fan_is_a_disk() {
    let n = 200;
    let radius = 0.37;
    let rim = |i: u32| {
        let angle = 2.0 * PI * f64::from(i) / f64::from(n);
        [0.05 + radius * angle.cos(), -0.03 + radius * angle.sin(), 3.0]
    };
    let fan = (0..n).fold(Stage::new(), |stage, i| {
        stage.triangle(1.0, [[0.05, -0.03, 3.0], rim(i), rim(i + 1)])
    });
    let found = fan.curve(&[1, 4, 9]).unwrap();
    let area = 0.5 * f64::from(n) * radius * radius * (2.0 * PI / f64::from(n)).sin();
    assert_near(found.mean, area, 1e-13);
    assert_near(found.variance, area * (1.0 - area), 1e-13);
    assert_near(found.jittered[0], area * (1.0 - area), 1e-13);
    // The polygon's four quarters, by the same formula about its own centre of mass: here by
    // cutting the fan's outline at both axes.
    let quarters = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| {
        let outline: Vec<[f64; 2]> = (0..n).map(|i| [rim(i)[0], rim(i)[1]]).collect();
        let cut = |outline: &[[f64; 2]], axis: usize, sign: f64| {
            let mut kept = Vec::new();
            for (i, a) in outline.iter().enumerate() {
                let b = outline[(i + 1) % outline.len()];
                if sign * a[axis] >= 0.0 {
                    kept.push(*a);
                }
                if a[axis] * b[axis] < 0.0 {
                    let share = a[axis] / (a[axis] - b[axis]);
                    kept.push([0, 1].map(|j| a[j] + share * (b[j] - a[j])));
                }
            }
            kept
        };
        let part = cut(&cut(&outline, 0, x), 1, y);
        let shoelace: f64 = (0..part.len())
            .map(|i| (part[i], part[(i + 1) % part.len()]))
            .map(|(a, b)| a[0] * b[1] - b[0] * a[1])
            .sum();
        2.0 * shoelace
    });
    let expected = quarters.iter().map(|v| v * (1.0 - v)).sum::<f64>() / 16.0;
    assert_near(found.jittered[1], expected, 1e-13);
}

/// A narrow pixel on a wall that is almost face-on, under a headlight: relative variance
/// 1e-14. Against quadrature of the differences from the pixel's centre.
#[test]
fn a_smooth_pixel_keeps_its_digits() {
    let tilt = 3e-3;
    let half = |from: f64, to: f64| [[from, -3.0], [to, -3.0], [to, 3.0], [from, 3.0]];
    let halves = Stage::new().polygon(0.0, 5.0, &half(-3.0, 1e-5));
    let mut scene = halves.polygon(0.0, 5.0, &half(1e-5, 3.0)).traced().scene().clone();
    for p in &mut scene.mesh.positions {
        p.z += tilt * p.x;
    }
    scene.camera.fov_y = 0.01;
    scene.light = Light::Headlight;
    let traced = TracedScene::new(scene);
    let frame = traced.scene().camera.pixel([0, 0]);
    let normal = DVec3::new(tilt, 0.0, -1.0).normalize();
    let centre = frame.direction(0.5, 0.5);
    // n·D/|D| - n·C/|C|, with |C| - |D| = (C - D)·(C + D) / (|C| + |D|).
    let f = |u: f64, v: f64| {
        let d = frame.direction(u, v);
        let (c_length, d_length) = (centre.length(), d.length());
        let shorter = (centre - d).dot(centre + d) / (c_length + d_length);
        let change = normal.dot(d - centre) * c_length + normal.dot(centre) * shorter;
        0.8 * change / (c_length * d_length)
    };
    let counts = [1, 4, 9, 256, 4096];
    let found = curve(&beam(&traced, [0, 0]), &counts, TOLERANCE).unwrap();
    assert!(found.patches > 0, "the wall's halves meet in the pixel");
    let relative = found.variance / (found.mean * found.mean);
    assert!((1e-14..1e-13).contains(&relative), "{relative:e}");
    let rule = gauss_legendre(5);
    for (n, variance) in counts.iter().zip(&found.jittered) {
        let k = n.isqrt();
        let mut sum = 0.0;
        for cell in 0..*n {
            let place = |i: u64, x: f64| (i as f64 + x) / k as f64;
            let values: Vec<_> = rule
                .iter()
                .flat_map(|a| rule.iter().map(move |b| (a, b)))
                .map(|(a, b)| (f(place(cell % k, a.0), place(cell / k, b.0)), a.1 * b.1))
                .collect();
            let mean: f64 = values.iter().map(|(f, w)| f * w).sum();
            sum += values.iter().map(|(f, w)| (f - mean).powi(2) * w).sum::<f64>();
        }
        let expected = sum / (n * n) as f64;
        assert_near(*variance, expected, 1e-6 * expected);
    }
}

/// Two walls that cross each other within the pixel, and one that lies in the plane of another.
#[test]
fn crossing_and_coplanar_walls() {
    // Depths 4 + x and 4 - x/2 as seen from the eye: equal at s = 0, wherever t.
    let leaning = |stage: Stage, value: f64, slope: f64| {
        let at = |x: f64, y: f64| [x, y, 4.0 / (1.0 + slope * x)];
        let quad = [at(-0.9, -0.9), at(0.9, -0.9), at(0.9, 0.9), at(-0.9, 0.9)];
        stage
            .triangle(value, [quad[0], quad[1], quad[2]])
            .triangle(value, [quad[0], quad[2], quad[3]])
    };
    let crossing = leaning(leaning(Stage::new(), 1.0, 0.3), 0.0, -0.2);
    let found = crossing.curve(&[1, 4, 9]).unwrap();
    assert_near(found.mean, 0.5, 1e-13);
    assert_near(found.jittered[1], 0.0, 1e-15);
    assert_near(found.jittered[2], 0.25 * 3.0 / 81.0, 1e-13);

    // The same triangles twice: the first ones are seen.
    let twice = Stage::new().wall(0.3, 5.0).wall(0.9, 5.0).curve(&[1, 4]).unwrap();
    assert_near(twice.mean, 0.3, 1e-15);
    assert_eq!(twice.variance, 0.0);

    // Apart by less than f64 tells from another plane.
    let mut almost = Stage::new().wall(0.3, 5.0).wall(0.9, 5.0);
    for corner in &mut almost.corners[2..] {
        corner[0].z *= 1.0 + 4.0 * f64::EPSILON;
    }
    assert!(matches!(almost.curve(&[1]), Err(Unresolved::EqualDepth(_))));
}

/// Against points thrown into a fine grid, each by `PixelBeam::exact_sample`.
#[test]
fn curves_agree_with_dense_sampling_in_every_scene() {
    /// Points per axis: strata of the finest grid times 32.
    const FINE: usize = 512;
    let counts = [1, 4, 16, 64, 256];
    let (mut compared, mut scenes) = (0, 0);
    for info in SCENES {
        let traced = TracedScene::new(scene::load(info.name).unwrap());
        if PixelBeam::new(traced.scene(), traced.accel(), [0, 0], Channel::R).is_none() {
            continue;
        }
        scenes += 1;
        let pixels = (0..100u32).map(|i| [(37 * i + 11) % 256, (101 * i + 60) % 256]);
        let beams = pixels.map(|pixel| (pixel, beam(&traced, pixel)));
        let some = beams.filter(|(_, beam)| (2..60).contains(&beam.n_facets())).take(4);
        for (pixel, beam) in some {
            let Ok(found) = curve(&beam, &counts, TOLERANCE) else { continue };
            let mut rng = Xoshiro256PlusPlus::seed_from_u64(u64::from(pixel[0]));
            let values: Vec<f64> = (0..FINE * FINE)
                .map(|i| {
                    let mut place =
                        |i: usize| (i as f64 + rng.random_range(0.0..1.0)) / FINE as f64;
                    let (u, v) = (place(i % FINE), place(i / FINE));
                    beam.exact_sample(u, v).1
                })
                .collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let what = format!("{} {pixel:?}, {} patches", info.name, found.patches);
            // An edge leaves (1/FINE)^1.5 of its step.
            let rounding = 1e-10 * mean.abs();
            let slack = 5.0 * (FINE as f64).powf(-1.5) * found.variance.sqrt() + rounding;
            assert!((found.mean - mean).abs() < slack, "{what}: {} {mean}", found.mean);
            for (n, variance) in counts.iter().zip(&found.jittered) {
                let k = n.isqrt() as usize;
                let mut cells = vec![[0.0; 2]; k * k];
                for (i, value) in values.iter().enumerate() {
                    let cell = (i / FINE) * k / FINE * k + (i % FINE) * k / FINE;
                    cells[cell][0] += value - mean;
                    cells[cell][1] += (value - mean).powi(2);
                }
                let points = (FINE * FINE / (k * k)) as f64;
                let within = |[sum, squares]: &[f64; 2]| squares / points - (sum / points).powi(2);
                let expected = cells.iter().map(within).sum::<f64>() / (n * n) as f64;
                let slack = 0.03 * expected + 1e-20;
                let near = (variance - expected).abs() < slack;
                assert!(near, "{what}, N = {n}: {variance:e} {expected:e}");
            }
            compared += 1;
        }
    }
    assert!(compared >= 3 * scenes && scenes >= 4, "{compared} pixels of {scenes} scenes");
}

#[test]
fn a_study_says_where_its_rows_come_from() {
    let plan = StudyPlan {
        samplers: ["random", "jittered", "jittered+torus-shift", "halton"]
            .map(|name| SamplerChoice::named(name).unwrap())
            .to_vec(),
        counts: vec![1, 4, 16],
        n_trials: 5,
        ..StudyPlan::paper()
    };
    let traced = TracedScene::new(scene::load("edges").unwrap());
    let exact = ExactStudy::new(&plan, TOLERANCE).unwrap();
    let pixel = [216, 24];
    let integrand = traced.pixel(pixel, Channel::Luminance);
    let found = exact.pixel(&integrand, pixel, Control::unwatched()).unwrap();
    let trials = study(&integrand, pixel, &plan, Control::unwatched()).unwrap();
    for (found, trials) in found.samplers[..2].iter().zip(&trials.samplers) {
        assert_eq!((found.method, &found.unresolved), (Method::Exact, &None));
        for (row, measured) in found.rows.iter().zip(&trials.rows) {
            assert_eq!(row.ci95(), [row.variance_of_mean; 2]);
            assert_eq!((row.n, row.n_used), (measured.n, measured.n_used));
        }
        assert_eq!(found.fit.unwrap().std_error, 0.0);
    }
    assert_eq!(found.reference.unwrap().mean, found.samplers[0].rows[0].grand_mean);
    for (found, trials) in found.samplers[2..].iter().zip(&trials.samplers[2..]) {
        assert_eq!((found.method, &found.unresolved), (Method::Trials, &Some(Unresolved::Sampler)));
        assert_eq!(found.rows, trials.rows);
    }

    drop(integrand);
    let rays = traced.with_tracer(Tracer::Bvh);
    let found =
        exact.pixel(&rays.pixel(pixel, Channel::Luminance), pixel, Control::unwatched()).unwrap();
    assert_eq!(found.reference, None);
    assert!(found.samplers.iter().all(|s| s.unresolved == Some(Unresolved::Rays)));
}

/// A wall under a point light, all of it in the shadow of a triangle out of sight; and the same
/// with the shadow's edge in the pixel.
#[test]
fn a_pixel_in_shadow_has_one_value() {
    let shadowed = |edge: f64| {
        // The light is at the eye's height far to the right; the blocker stands half way.
        let mut scene = Stage::new().wall(0.25, 5.0).traced().scene().clone();
        scene.light = Light::Point { position: DVec3::new(40.0, 0.0, 0.0), intensity: [1e4; 3] };
        // Lines from the light to x = 5 edge on the wall cross x = 20 at this depth.
        let deep = 5.0 * 20.0 / (40.0 - 5.0 * edge);
        let first = scene.mesh.positions.len() as u32;
        let corner = |y: f64, z: f64| DVec3::new(20.0, y, z);
        scene.mesh.positions.extend([corner(-90.0, deep), corner(90.0, deep), corner(0.0, -200.0)]);
        scene.mesh.triangles.push([first, first + 1, first + 2]);
        scene.mesh.materials.push(0);
        curve(&beam(&TracedScene::new(scene), [0, 0]), &[1, 4, 9], TOLERANCE).unwrap()
    };
    let dark = shadowed(0.9);
    assert_near(dark.mean, 0.25, 1e-15);
    assert_eq!((dark.variance, &dark.jittered[..], dark.patches), (0.0, &[0.0; 3][..], 0));
    let half = shadowed(0.0);
    assert!(half.mean > 0.3 && half.variance > 0.0 && half.patches > 0, "{half:?}");
}

#[test]
fn grids_of_too_many_strata_are_refused() {
    for counts in [&[0][..], &[1 << 26], &[16_777_213], &[1 << 24, 1]] {
        let refused = super::Grids::new(counts).err();
        assert!(matches!(refused, Some(Unresolved::TooManyStrata { .. })), "{counts:?}");
    }
    assert!(super::Grids::new(&[4095, 12, 7]).is_ok());
}
