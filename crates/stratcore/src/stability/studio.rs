//! The scenes that extremes are tried on.

use super::Bench;
use crate::integrand::Integrand;
use crate::sampler::PointSet;
use crate::scene::library::icosphere;
use crate::scene::{Camera, Channel, Light, Material, Mesh, Scene};
use crate::study::SamplerChoice;
use crate::trace::{TracedScene, Tracer};
use crate::trial::trial_means;
use glam::{DVec3, dvec3};

/// A scene of one grey material and no distribution.
pub(super) fn scene(mesh: Mesh, camera: Camera, light: Light) -> Scene {
    let grey = Material { name: "grey".to_owned(), kd: [0.5, 0.4, 0.6], ..Material::default() };
    let plain = Scene::plain(mesh, vec![grey], camera, light);
    Scene { name: "stability".to_owned(), background: [0.1, 0.2, 0.3], ..plain }
}

/// The same triangles, shaded flat.
pub(super) fn flat(mesh: Mesh) -> Mesh {
    Mesh { corner_normals: None, ..mesh }
}

/// A ball on a floor with a slanted wall, some 6 across, seen in 16 × 16 pixels from nearby.
pub(super) fn ball_and_floor() -> (Mesh, Camera) {
    let mut mesh = flat(icosphere(3));
    let base = mesh.positions.len() as u32;
    mesh.positions.extend([
        dvec3(-3.0, -1.0, -3.0),
        dvec3(-3.0, -1.0, 3.0),
        dvec3(3.0, -1.0, 3.0),
        dvec3(3.0, -1.0, -3.0),
        dvec3(-3.0, 2.0, -3.3),
        dvec3(3.0, 2.1, -3.7),
    ]);
    for corners in [[0, 1, 2], [0, 2, 3], [0, 3, 5], [0, 5, 4]] {
        mesh.triangles.push(corners.map(|i: u32| base + i));
        mesh.materials.push(0);
    }
    let camera = Camera {
        eye: dvec3(1.3, 0.9, 4.1),
        look_at: dvec3(0.1, -0.2, 0.0),
        up: DVec3::Y,
        fov_y: 50.0,
        resolution: [16, 16],
    };
    (mesh, camera)
}

/// Every place of a scene multiplied by a factor and moved.
pub(super) fn placed(mesh: &Mesh, camera: &Camera, scale: f64, by: DVec3) -> (Mesh, Camera) {
    let place = |p: DVec3| p * scale + by;
    let mesh =
        Mesh { positions: mesh.positions.iter().map(|p| place(*p)).collect(), ..mesh.clone() };
    (mesh, Camera { eye: place(camera.eye), look_at: place(camera.look_at), ..*camera })
}

/// Every pixel of a picture.
pub(super) fn all_pixels(camera: &Camera) -> impl Iterator<Item = [u32; 2]> + use<> {
    let [width, height] = camera.resolution;
    (0..height).flat_map(move |y| (0..width).map(move |x| [x, y]))
}

/// Means of `trials` sets of `n` points in each pixel, by a tracer, one after the other.
pub(super) fn means(
    bench: &Bench<'_>,
    scene: &TracedScene,
    choice: SamplerChoice,
    n: u64,
    trials: u32,
    pixels: impl IntoIterator<Item = [u32; 2]>,
) -> Vec<f64> {
    let mut all = Vec::new();
    for pixel in pixels {
        let integrand = scene.pixel(pixel, Channel::Luminance);
        let key = bench.key(choice.sampler.stream_id(), 0, n);
        let set = PointSet {
            key: crate::rng::StreamKey { pixel, ..key },
            dim: integrand.dim(),
            scramble: choice.scramble,
            rectangular: false,
        };
        let mut means = vec![0.0; trials as usize];
        trial_means(&integrand, choice.sampler, &set, 0, &mut means, bench.control.cancel);
        all.extend(means);
    }
    all
}

/// The scene under both tracers: the beam, in f32, and rays, in f64.
pub(super) fn both(scene: &Scene) -> [TracedScene; 2] {
    [Tracer::Beam, Tracer::Bvh].map(|tracer| TracedScene::new(scene.clone()).with_tracer(tracer))
}

/// How many numbers differ in a bit.
pub(super) fn differing_bits(a: &[f64], b: &[f64]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits()).count() + a.len().abs_diff(b.len())
}

/// Largest absolute difference; NaN where one of them is no number.
pub(super) fn farthest(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, larger)
}

/// The larger of two errors; NaN if one of them is.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}
