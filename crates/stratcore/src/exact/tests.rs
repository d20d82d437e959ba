use super::polygon::Polygon;
use super::polynomial::Polynomial;
use super::strata::Axis;
use super::walk::{Side, Walker};
use super::{ExactCurve, TOLERANCE, Unresolved, curve};
use crate::beam::PixelBeam;
use crate::integrand::quadrature::gauss_legendre;
use crate::sampler::strata_per_axis;
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

/// Half a pixel: k strata on the diagonal, each half and half. At k = 300 in several bands.
#[test]
fn a_diagonal_at_every_n() {
    let counts = [squares(40), vec![300 * 300]].concat();
    for halves in
        [[[-2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]], [[-2.0, -2.0], [2.0, -2.0], [-2.0, 2.0]]]
    {
        let found = Stage::new().polygon(3.0, 4.0, &halves).curve(&counts).unwrap();
        assert_near(found.mean, 1.5, 1e-14);
        for (n, variance) in counts.iter().zip(&found.jittered) {
            let k = n.isqrt() as f64;
            let expected = 9.0 * 0.25 * k / k.powi(4);
            // What stratification removes, a factor of about k, is rounded too.
            assert_near(*variance, expected, 1e-14 * k * expected);
        }
    }
}

/// The part of a polygon where x is at least `from` along an axis, or at most for sign -1.
fn cut(outline: &[[f64; 2]], axis: usize, sign: f64, from: f64) -> Vec<[f64; 2]> {
    let mut kept = Vec::new();
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        let [to_a, to_b] = [a, &b].map(|corner| sign * (corner[axis] - from));
        if to_a >= 0.0 {
            kept.push(*a);
        }
        if to_a * to_b < 0.0 {
            let share = to_a / (to_a - to_b);
            kept.push([0, 1].map(|j| a[j] + share * (b[j] - a[j])));
        }
    }
    kept
}

fn area(outline: &[[f64; 2]]) -> f64 {
    let shoelace = |(i, a): (usize, &[f64; 2])| {
        let b = outline[(i + 1) % outline.len()];
        a[0] * b[1] - b[0] * a[1]
    };
    0.5 * outline.iter().enumerate().map(shoelace).sum::<f64>()
}

/// Triangles of all slopes over grids of all shapes, some in several bands of rows: v(1 - v) in
/// each stratum, v by cutting the triangle at its four sides.
#[test]
fn slanted_triangles_over_every_grid() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    let counts = [2, 3, 12, 15, 49, 210, 16_900, 22_500, 24_180];
    for _ in 0..12 {
        let mut outline =
            [[0.0; 2]; 3].map(|corner| corner.map(|_: f64| rng.random_range(-0.8..0.8)));
        if area(&outline) < 0.0 {
            outline.reverse();
        }
        let found = Stage::new().polygon(1.0, 4.0, &outline).curve(&counts).unwrap();
        for (n, variance) in counts.iter().zip(&found.jittered) {
            let [columns, rows] = strata_per_axis(*n, 2)[..] else { unreachable!("two axes") };
            let mut sum = 0.0;
            for row in 0..rows {
                let t = |row: u64| row as f64 / rows as f64 - 0.5;
                let in_row = cut(&cut(&outline, 1, 1.0, t(row)), 1, -1.0, t(row + 1));
                for column in 0..columns {
                    let s = |column: u64| column as f64 / columns as f64 - 0.5;
                    let part = cut(&cut(&in_row, 0, 1.0, s(column)), 0, -1.0, s(column + 1));
                    let share = *n as f64 * area(&part);
                    sum += share * (1.0 - share);
                }
            }
            let expected = sum / (n * n) as f64;
            // Corners known to 2e-16 move the share of each stratum on a side by k times that;
            // some 2k are on each unit of sides, which are 6 at most. What is removed, N times
            // the area, is rounded besides.
            let slack = 5e-15 + 1e-14 * found.mean;
            assert_near(*variance, expected, slack / *n as f64);
        }
    }
}

/// Integral of f over a polygon, exact for polynomials of degree 10: triangles about its first
/// corner, as squares that collapse to it.
fn integral(outline: &[[f64; 2]], f: impl Fn(f64, f64) -> f64) -> f64 {
    let rule = gauss_legendre(6);
    let Some(a) = outline.first() else { return 0.0 };
    let mut sum = 0.0;
    for pair in outline[1..].windows(2) {
        let [b, c] = [pair[0], pair[1]].map(|corner| [0, 1].map(|i| corner[i] - a[i]));
        let size = b[0] * c[1] - b[1] * c[0];
        for (x, weight) in &rule {
            for (y, share) in &rule {
                let at = |i: usize| a[i] + x * (b[i] + y * (c[i] - b[i]));
                sum += size * x * weight * share * f(at(0), at(1));
            }
        }
    }
    sum
}

/// Σ η (η + 2ρ) of polynomials over polygons, by walking along sides, against integrals over
/// each polygon cut by each stratum: sides of all slopes, on lines of the grid, and so short or
/// so near to a line that rounding puts their ends on either side of it.
#[test]
fn walked_sums_are_those_of_clipped_polygons() {
    fn check<const D: usize>(rng: &mut Xoshiro256PlusPlus) {
        let mut random = || {
            Polynomial::<D>(std::array::from_fn(|a| {
                let row: [f64; D] = std::array::from_fn(|_| rng.random_range(-1.0..1.0));
                std::array::from_fn(|b| if a + b < D { row[b] } else { 0.0 })
            }))
        };
        let base = random();
        let outlines: [&[[f64; 2]]; 7] = [
            &[[-0.43, -0.31], [0.37, -0.48], [0.12, 0.46]],
            &[[-0.5, -0.5], [0.1, -0.5], [-0.2, 0.5], [-0.5, 0.5]],
            &[[0.0, -0.25], [0.5, -0.25], [0.5, 0.25], [0.25, 0.5], [0.0, 0.25]],
            &[[-0.5, 0.5], [-0.5, -0.5], [0.5, 0.5]],
            &[[-1e-16, -0.5], [0.3, -0.1], [0.0, 0.3]],
            &[[-3e-17, -0.5], [0.2, -0.2], [-2e-17, 0.3]],
            &[[0.1, 0.2], [0.1 + 1e-9, 0.2], [0.1, 0.2 + 1e-9]],
        ];
        let changes = outlines.map(|_| random());
        let sides: Vec<_> = outlines
            .iter()
            .zip(&changes)
            .flat_map(|(outline, change)| {
                Side::of(&Polygon::of(outline), change).collect::<Vec<_>>()
            })
            .collect();
        for [k, l] in [[1, 1], [3, 2], [16, 16], [5, 40], [130, 129]] {
            let axes = [Axis::<D>::new(k), Axis::new(l)];
            let mut walker = Walker::new([k, l]);
            let found = walker.squared_means(&sides, &base, [&axes[0], &axes[1]]);
            let n = (k * l) as f64;
            let (mut expected, mut terms) = (0.0, 0.0);
            for row in 0..l {
                let t = |row: usize| row as f64 / l as f64 - 0.5;
                let in_row =
                    |outline: &[[f64; 2]]| cut(&cut(outline, 1, 1.0, t(row)), 1, -1.0, t(row + 1));
                let in_row = outlines.map(in_row);
                for column in 0..k {
                    let s = |column: usize| column as f64 / k as f64 - 0.5;
                    let square = [[s(column), t(row)], [s(column + 1), t(row)]];
                    let [b, a] = [[s(column + 1), t(row + 1)], [s(column), t(row + 1)]];
                    let rho = n * integral(&[square[0], square[1], b, a], |s, t| base.at(s, t));
                    let mut eta = 0.0;
                    for (outline, change) in in_row.iter().zip(&changes) {
                        let part = cut(outline, 0, 1.0, s(column));
                        let part = cut(&part, 0, -1.0, s(column + 1));
                        eta += n * integral(&part, |s, t| change.at(s, t));
                    }
                    expected += eta * (eta + 2.0 * rho);
                    terms += eta.abs() * (eta.abs() + 2.0 * rho.abs());
                }
            }
            assert_near(found, expected, 1e-13 * terms);
        }
    }
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    check::<1>(&mut rng);
    check::<3>(&mut rng);
    check::<5>(&mut rng);
    check::<9>(&mut rng);
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
        4.0 * self::area(&cut(&cut(&outline, 0, x, 0.0), 1, y, 0.0))
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
        let Some(refused @ Unresolved::TooManyStrata { .. }) = refused else {
            panic!("{counts:?}: {refused:?}")
        };
        let text = refused.to_string();
        assert!(text.contains("16777216 with all N together"), "{text}");
    }
    assert!(super::Grids::new(&[4095, 12, 7]).is_ok());
}
