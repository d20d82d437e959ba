//! Closed meshes from within: every sample has to hit.

use super::studio::{flat, scene};
use super::{Bench, PLACEMENT, Row};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::rng::Stream;
use crate::sampler::{PointSet, Random, Sampler, Scramble};
use crate::scene::library::{icosphere, torus};
use crate::scene::{Camera, Channel, Light, Mesh, Scene};
use crate::study::collect;
use crate::trace::{PixelIntegrand, TracedScene};
use crate::trial::trial_means;
use glam::{DMat3, DVec3, Vec3, dvec3};

/// What a surface shows, and what is outside.
const INSIDE: f64 = 1.0;
const OUTSIDE: f64 = 1000.0;

struct Closed {
    name: &'static str,
    mesh: Mesh,
    /// Places inside.
    eyes: Vec<DVec3>,
}

fn shapes() -> [Closed; 2] {
    let ball = Closed {
        name: "watertight sphere",
        mesh: flat(icosphere(5)),
        eyes: vec![DVec3::ZERO, dvec3(0.31, -0.62, 0.17), dvec3(-0.9, 0.1, 0.2)],
    };
    let ring = Closed {
        name: "watertight torus",
        mesh: flat(torus(0.3, 192, 96)),
        eyes: vec![dvec3(1.0, 0.0, 0.0), dvec3(-0.71, 0.1, 0.72), dvec3(0.05, -0.2, 1.1)],
    };
    [ball, ring]
}

/// The inside of a mesh in all directions but the least useful: 90° of view, 24 × 24 pixels.
fn seen_from(mesh: &Mesh, eye: DVec3, towards: DVec3) -> Scene {
    let camera = Camera {
        eye,
        look_at: eye + towards,
        up: if towards.y.abs() > 0.9 { DVec3::X } else { DVec3::Y },
        fov_y: 90.0,
        resolution: [24, 24],
    };
    let mut scene = scene(mesh.clone(), camera, Light::Off);
    scene.materials[0].ke = [INSIDE; 3];
    scene.background = [OUTSIDE; 3];
    scene
}

/// Samples tried, and those that saw outside.
#[derive(Default, Clone, Copy)]
struct Count {
    tried: u64,
    missed: u64,
}

impl Count {
    fn plus(self, other: Self) -> Self {
        Self { tried: self.tried + other.tried, missed: self.missed + other.missed }
    }
    fn share(self) -> f64 {
        if self.tried == 0 { f64::NAN } else { self.missed as f64 / self.tried as f64 }
    }
}

pub(super) fn rows(bench: &mut Bench<'_>) -> Result<(), StudyError> {
    // Of 16 trials in 576 pixels from each of 3 eyes in 6 directions.
    let per_pixel: u64 = bench.either(1 << 6, 6400);
    let rays_per_eye: u64 = bench.either(20_000, 4_000_000);
    for shape in shapes() {
        let mut views = Vec::new();
        for eye in &shape.eyes {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                views.extend([(*eye, axis), (*eye, -axis)]);
            }
        }
        let watched: &Bench<'_> = bench;
        let beams = collect(views, |(eye, towards)| {
            let traced = TracedScene::new(seen_from(&shape.mesh, eye, towards));
            let mut count = Count::default();
            for x in 0..24 {
                watched.check()?;
                for y in 0..24 {
                    count = count.plus(beam_samples(watched, &traced, [x, y], per_pixel));
                    count = count.plus(beam_aimed(&traced, [x, y]));
                }
            }
            Ok::<_, StudyError>(count)
        })?;
        let eyes: Vec<_> = (0..).zip(shape.eyes.iter().copied()).collect();
        let aimed = collect(eyes, |(column, eye)| {
            let traced = TracedScene::new(seen_from(&shape.mesh, eye, DVec3::Z));
            aimed_rays(watched, &traced, column, rays_per_eye)
        })?;
        let beam = beams.into_iter().fold(Count::default(), Count::plus);
        let [rays, single, double] =
            [0, 1, 2].map(|i| aimed.iter().fold(Count::default(), |sum, c| sum.plus(c[i])));
        bench.push(
            Row::new(shape.name, "share of samples that see through", 0.0)
                .tried(format!(
                    "{} triangles from within: {:.3e} samples by the beam, at random and at \
                     every edge and corner, and {:.1e} rays aimed at edges and corners",
                    shape.mesh.triangles.len(),
                    beam.tried as f64,
                    rays.tried as f64
                ))
                .f32(single.share())
                .f64(double.share())
                .error((beam.missed + rays.missed) as f64 / (beam.tried + rays.tried) as f64)
                .floor(0.0)
                .note(
                    "f32 and f64: the test of Möller and Trumbore, which rounds each triangle's \
                     edges on their own, on the aimed rays",
                ),
        );
    }
    Ok(())
}

/// `n` random samples of a pixel: the mean is that of the inside, or else some missed.
fn beam_samples(bench: &Bench<'_>, scene: &TracedScene, pixel: [u32; 2], n: u64) -> Count {
    let integrand = scene.pixel(pixel, Channel::R);
    let key = crate::rng::StreamKey { pixel, ..bench.key(Random.stream_id(), 0, n) };
    let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
    // Sixteen trials, since the beam takes them side by side.
    let mut means = [0.0; 16];
    trial_means(&integrand, &Random, &set, 0, &mut means, bench.control.cancel);
    let missed = means.iter().map(|mean| ((mean - INSIDE) / (OUTSIDE - INSIDE) * n as f64).round());
    Count { tried: 16 * n, missed: missed.map(|m| m as u64).sum() }
}

/// Where the mesh's corners and points of its edges fall in a pixel, as the beam rounds them,
/// and next to it.
fn beam_aimed(scene: &TracedScene, pixel: [u32; 2]) -> Count {
    let PixelIntegrand::Beam(beam) = scene.pixel(pixel, Channel::R) else {
        return Count { tried: 1, missed: 1 };
    };
    let camera = &scene.scene().camera;
    let frame = camera.pixel(pixel);
    // P = t (d0 + u du + v dv)
    let inverse = DMat3::from_cols(frame.d0, frame.du, frame.dv).inverse();
    let ends = beam.facets().iter().flat_map(|facet| {
        let corners = scene.scene().mesh.corners(facet.triangle as usize);
        let [a, b, c] = corners.map(|p| inverse * (p - camera.eye));
        [[a, b], [b, c], [c, a]]
    });
    let mut points = Vec::new();
    for [a, b] in ends.filter(|ends| ends.iter().all(|p| p.x > 0.0)) {
        let [a, b] = [a, b].map(|p| [p.y / p.x - 0.5, p.z / p.x - 0.5]);
        for share in [0.0, 0.25, 0.5, 1.0 / 3.0, 0.9] {
            let at = [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];
            let near = |x: f64| {
                let x = x as f32;
                [x.next_down(), x, x.next_up()].map(|x| f64::from(x) + 0.5)
            };
            for u in near(at[0]) {
                for v in near(at[1]) {
                    if (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v) {
                        points.extend([u, v]);
                    }
                }
            }
        }
    }
    let mut values = vec![0.0; points.len() / 2];
    beam.eval_block(&points, &mut values);
    let missed = values.iter().filter(|value| **value != INSIDE).count();
    Count { tried: values.len() as u64, missed: missed as u64 }
}

/// Rays at corners and at points of edges: [ours, the common test in f32, in f64].
fn aimed_rays(
    bench: &Bench<'_>,
    scene: &TracedScene,
    column: u32,
    n: u64,
) -> Result<[Count; 3], StudyError> {
    let stream: Stream = bench.key(PLACEMENT, 100 + column, 1).stream();
    let mesh = &scene.scene().mesh;
    let eye = scene.scene().camera.eye;
    let ring = fans(mesh);
    let mut counts = [Count::default(); 3];
    for i in 0..n {
        if i % 4096 == 0 {
            bench.check()?;
        }
        let [pick, along] = stream.pair(2 * i);
        let id = (pick * mesh.triangles.len() as f64) as usize;
        let [a, b, _] = mesh.corners(id);
        let target = if i % 2 == 0 { a } else { a.lerp(b, along) };
        let [stretch, _] = stream.pair(2 * i + 1);
        let direction = (target - eye) * (0.1 + 3.0 * stretch);
        let [ours, single, double] = &mut counts;
        ours.tried += 1;
        ours.missed += u64::from(scene.closest_hit(eye, direction).is_none());
        // All triangles about the corner contain all that the ray can meet near it.
        let about = &ring[mesh.triangles[id][0] as usize];
        let corners = || about.iter().map(|&id| mesh.corners(id as usize).map(|p| p - eye));
        double.tried += 1;
        double.missed += u64::from(!corners().any(|c| common_test(c, direction)));
        single.tried += 1;
        let in_f32 = |c: [DVec3; 3]| common_test_f32(c.map(|p| p.as_vec3()), direction.as_vec3());
        single.missed += u64::from(!corners().any(in_f32));
    }
    Ok(counts)
}

/// The triangles about each vertex.
fn fans(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut fans = vec![Vec::new(); mesh.positions.len()];
    for (id, triangle) in (0..).zip(&mesh.triangles) {
        for corner in triangle {
            fans[*corner as usize].push(id);
        }
    }
    fans
}

/// T. Möller, B. Trumbore, *Fast, Minimum Storage Ray-Triangle Intersection*, Journal of
/// Graphics Tools 2(1), 1997, for a ray from the origin.
macro_rules! common_test {
    ($name:ident, $vector:ty) => {
        fn $name([a, b, c]: [$vector; 3], d: $vector) -> bool {
            let (ab, ac) = (b - a, c - a);
            let p = d.cross(ac);
            let inverse = 1.0 / ab.dot(p);
            let u = -a.dot(p) * inverse;
            let q = (-a).cross(ab);
            let v = d.dot(q) * inverse;
            u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) * inverse > 0.0
        }
    };
}

common_test!(common_test, DVec3);
common_test!(common_test_f32, Vec3);
