use super::{ExactCurve, TOLERANCE, Unresolved, curve};
use crate::beam::PixelBeam;
use crate::scene::{self, Channel, Light, Material, Mesh};
use crate::trace::TracedScene;
use glam::DVec3;
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
        let material = |&ke| Material { name: String::new(), kd: [0.8; 3], ke: [ke; 3] };
        scene.materials = self.values.iter().map(material).collect();
        TracedScene::new(scene)
    }

    fn curve(self, counts: &[u64]) -> Result<ExactCurve, Unresolved> {
        curve(&beam(&self.traced(), [0, 0]), counts, TOLERANCE)
    }
}

fn beam(traced: &TracedScene, pixel: [u32; 2]) -> PixelBeam {
    PixelBeam::new(traced.scene(), traced.accel().bvh(), pixel, Channel::Luminance).unwrap()
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
