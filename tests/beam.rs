//! The beam against an f64 test of its own making, triangle by triangle.
//!
//! The reference shares nothing with the beam or the BVH: candidates are all triangles whose
//! projected bounding box touches the pixel, and those whose box holds the sample are met by
//! Möller and Trumbore's test (*Fast, Minimum Storage Ray-Triangle Intersection*, 1997) in f64.

use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;
use stratcore::beam::PixelBeam;
use stratcore::integrand::Integrand;
use stratcore::scene::library::icosphere;
use stratcore::scene::{Camera, Channel, Light, Material, Mesh, Scene, load};
use stratcore::trace::{TracedScene, Tracer};

/// A pinhole's view of the mesh.
struct View {
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
}

impl View {
    fn new(origin: DVec3, towards: DVec3) -> Self {
        let forward = towards.normalize();
        let (right, up) = forward.any_orthonormal_pair();
        Self { origin, right, up, forward }
    }

    /// Where a direction crosses the plane at distance 1, and its depth.
    fn project(&self, direction: DVec3) -> ([f64; 2], f64) {
        let depth = direction.dot(self.forward);
        ([direction.dot(self.right) / depth, direction.dot(self.up) / depth], depth)
    }

    /// A box on that plane around what is seen of a triangle: all of the plane if it reaches
    /// behind the pinhole, nothing if it lies there.
    fn outline(&self, corners: [DVec3; 3]) -> Box2 {
        let corners = corners.map(|p| p - self.origin);
        let depths = corners.map(|p| p.dot(self.forward));
        if depths.iter().all(|depth| *depth < 0.0) {
            return [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        }
        if depths.iter().zip(&corners).any(|(depth, p)| *depth <= 1e-9 * p.length()) {
            return [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];
        }
        bounds(corners.iter().map(|p| self.project(*p).0))
    }

    /// All triangles that may be seen within a box on that plane.
    fn touching(&self, mesh: &Mesh, window: Box2) -> Vec<Candidate> {
        let ids = 0..mesh.triangles.len() as u32;
        ids.map(|id| Candidate::new(self, mesh, id)).filter(|c| touch(c.outline, window)).collect()
    }
}

/// From least to greatest along both axes.
type Box2 = [[f64; 2]; 2];

fn touch([lo, hi]: Box2, [from, to]: Box2) -> bool {
    (0..2).all(|axis| lo[axis] <= to[axis] && hi[axis] >= from[axis])
}

/// A triangle, and the box around what a view sees of it.
struct Candidate {
    id: u32,
    corners: [DVec3; 3],
    outline: Box2,
}

impl Candidate {
    fn new(view: &View, mesh: &Mesh, id: u32) -> Self {
        let corners = mesh.corners(id as usize);
        Self { id, corners, outline: view.outline(corners) }
    }

    /// The distance at which a ray from the view's pinhole, through a place of its plane, meets
    /// it.
    fn meets(&self, view: &View, place: [f64; 2], direction: DVec3) -> Option<f64> {
        touch(self.outline, [place; 2]).then(|| meets(self.corners, view.origin, direction))?
    }
}

/// The smallest box around points, a little wider.
fn bounds(points: impl Iterator<Item = [f64; 2]>) -> Box2 {
    let start = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    let [lo, hi] = points.fold(start, |[lo, hi], p| {
        [[lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])]]
    });
    [lo.map(|x| x - 1e-9), hi.map(|x| x + 1e-9)]
}

/// Distance along the direction, by Möller and Trumbore.
fn meets([a, b, c]: [DVec3; 3], origin: DVec3, direction: DVec3) -> Option<f64> {
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(p) / determinant;
    let q = from_a.cross(e1);
    let v = direction.dot(q) / determinant;
    let t = e2.dot(q) / determinant;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// What the reference needs of a picture.
struct Picture<'a> {
    scene: &'a Scene,
    view: View,
    /// What is seen of each triangle.
    outlines: Vec<Box2>,
}

impl<'a> Picture<'a> {
    fn new(scene: &'a Scene) -> Self {
        let [forward, right, up] = scene.camera.frame();
        let view = View { origin: scene.camera.eye, right, up, forward };
        let ids = 0..scene.mesh.triangles.len();
        let outlines = ids.map(|id| view.outline(scene.mesh.corners(id))).collect();
        Self { scene, view, outlines }
    }
}

/// What it needs of one pixel.
struct Reference<'a> {
    scene: &'a Scene,
    view: &'a View,
    pixel: [u32; 2],
    candidates: Vec<Candidate>,
}

impl<'a> Reference<'a> {
    fn new(picture: &'a Picture<'_>, pixel: [u32; 2]) -> Self {
        let Picture { scene, view, outlines } = picture;
        let frame = scene.camera.pixel(pixel);
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let window =
            bounds(corners.map(|[u, v]| view.project(frame.direction(u, v)).0).into_iter());
        let candidates = (0..)
            .zip(outlines)
            .filter(|(_, outline)| touch(**outline, window))
            .map(|(id, _)| Candidate::new(view, &scene.mesh, id))
            .collect();
        Self { scene, view, pixel, candidates }
    }

    fn direction(&self, [u, v]: [f64; 2]) -> DVec3 {
        self.scene.camera.pixel(self.pixel).direction(u, v)
    }

    /// The nearest triangle and its distance; of equals the first.
    fn hit(&self, place: [f64; 2]) -> Option<(u32, f64)> {
        let direction = self.direction(place);
        let (on_plane, _) = self.view.project(direction);
        let mut best = None;
        for candidate in &self.candidates {
            if let Some(t) = candidate.meets(self.view, on_plane, direction)
                && best.is_none_or(|(_, nearest)| t < nearest)
            {
                best = Some((candidate.id, t));
            }
        }
        best
    }

    /// The places around one, 1e-9 pixel away: a sample on an edge may see what they see.
    fn around([u, v]: [f64; 2]) -> [[f64; 2]; 8] {
        let e = 1e-9;
        [[-e, 0.0], [e, 0.0], [0.0, -e], [0.0, e], [-e, -e], [e, -e], [-e, e], [e, e]]
            .map(|[a, b]| [u + a, v + b])
    }

    /// Whether a triangle, or none, is as good an answer as the reference's own: on an edge, or
    /// at equal depth to 1e-12.
    fn admits(&self, place: [f64; 2], seen: Option<u32>) -> bool {
        let hit = self.hit(place);
        let level = || {
            let (Some(seen), Some((_, t))) = (seen, hit) else { return false };
            let corners = self.scene.mesh.corners(seen as usize);
            meets(corners, self.scene.camera.eye, self.direction(place))
                .is_some_and(|other| (other / t - 1.0).abs() < 1e-12)
        };
        hit.map(|(id, _)| id) == seen
            || level()
            || Self::around(place).iter().any(|p| self.hit(*p).map(|(id, _)| id) == seen)
    }
}

/// What happened to many samples.
#[derive(Debug, Default, Clone, Copy)]
struct Tally {
    samples: u64,
    /// Answers other than the reference's, on an edge or at equal depth.
    ties: u64,
    /// Any others.
    mismatches: u64,
}

impl Tally {
    fn plus(self, other: Self) -> Self {
        Self {
            samples: self.samples + other.samples,
            ties: self.ties + other.ties,
            mismatches: self.mismatches + other.mismatches,
        }
    }
}

/// The scene with a radiance that tells which triangle was hit: i + 1 from triangle i, 0 from
/// the background.
fn labelled(mut scene: Scene) -> Scene {
    let n = scene.mesh.triangles.len() as u32;
    scene.light = Light::Headlight;
    scene.ambient = [0.0; 3];
    scene.background = [0.0; 3];
    scene.mesh.materials = (0..n).collect();
    let label = |i| Material { ke: [f64::from(i + 1); 3], ..Material::default() };
    scene.materials = (0..n).map(label).collect();
    scene
}

/// Places in the pixel that the beam represents exactly: offsets from its middle in f32.
fn places(seed: u64, n: usize) -> Vec<f64> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..2 * n).map(|_| f64::from(random.random_range(-0.5f32..0.5)) + 0.5).collect()
}

fn beam_of(traced: &TracedScene, pixel: [u32; 2], channel: Channel) -> PixelBeam {
    PixelBeam::new(traced.scene(), traced.accel(), pixel, channel).unwrap()
}

fn values_of(integrand: &dyn Integrand, points: &[f64]) -> Vec<f64> {
    let mut values = vec![0.0; points.len() / 2];
    integrand.eval_block(points, &mut values);
    values
}

fn seen(value: f64) -> Option<u32> {
    (value > 0.0).then(|| value as u32 - 1)
}

/// `side` x `side` pixels spread over the picture.
fn spread(camera: &Camera, side: u32) -> Vec<[u32; 2]> {
    let at = |i: u32, axis: usize| (2 * i + 1) * camera.resolution[axis] / (2 * side);
    (0..side * side).map(|i| [at(i % side, 0), at(i / side, 1)]).collect()
}

/// Which triangle every sample of the beam sees, in so many pixels.
fn visibility(traced: &TracedScene, side: u32, n: usize) -> Tally {
    let pixels = spread(&traced.scene().camera, side);
    let picture = Picture::new(traced.scene());
    let one = |pixel: &[u32; 2]| {
        let reference = Reference::new(&picture, *pixel);
        let points = places(u64::from(pixel[0]) << 32 | u64::from(pixel[1]), n);
        let values = values_of(&beam_of(traced, *pixel, Channel::R), &points);
        let mut tally = Tally { samples: n as u64, ..Tally::default() };
        for (point, value) in points.chunks_exact(2).zip(values) {
            let place = [point[0], point[1]];
            if reference.hit(place).map(|(id, _)| id) != seen(value) {
                let tie = reference.admits(place, seen(value));
                tally.ties += u64::from(tie);
                tally.mismatches += u64::from(!tie);
            }
        }
        tally
    };
    pixels.par_iter().map(one).reduce(Tally::default, Tally::plus)
}

/// Luminance of every sample of the beam under a point light, shadows included.
fn lighting(traced: &TracedScene, side: u32, n: usize) -> Tally {
    let scene = traced.scene();
    let Light::Point { position, intensity } = scene.light else { panic!("not a point light") };
    let mesh = &scene.mesh;
    let picture = Picture::new(scene);
    let one = |pixel: &[u32; 2]| {
        let reference = Reference::new(&picture, *pixel);
        let points = places(u64::from(pixel[0]) << 32 | u64::from(pixel[1]), n);
        let values = values_of(&beam_of(traced, *pixel, Channel::Luminance), &points);
        let hits: Vec<_> = points.chunks_exact(2).map(|p| reference.hit([p[0], p[1]])).collect();
        // What may stand between the light and any point that is seen.
        let eye = scene.camera.eye;
        let point_of = |place: [f64; 2], t: f64| eye + reference.direction(place) * t;
        let lit_points: Vec<_> = points
            .chunks_exact(2)
            .zip(&hits)
            .filter_map(|(p, hit)| hit.map(|(id, t)| (id, point_of([p[0], p[1]], t))))
            .collect();
        let mut receivers: Vec<u32> = lit_points.iter().map(|(id, _)| *id).collect();
        receivers.sort_unstable();
        receivers.dedup();
        let occluders: Vec<(View, Vec<Candidate>)> = receivers
            .iter()
            .filter_map(|receiver| {
                let mine = || lit_points.iter().filter(|(id, _)| id == receiver).map(|(_, p)| *p);
                let view = View::new(position, mine().next()? - position);
                let window = bounds(mine().map(|p| view.project(p - position).0));
                let occluders = view.touching(mesh, window);
                Some((view, occluders))
            })
            .collect();
        let radiance = |place: [f64; 2]| {
            let Some((id, t)) = reference.hit(place) else {
                return Channel::Luminance.of(scene.background);
            };
            let point = point_of(place, t);
            let normal = mesh.area_normal(id as usize).normalize();
            let to_eye = eye - point;
            let normal = if normal.dot(to_eye) < 0.0 { -normal } else { normal };
            let to_light = position - point;
            let cosine = normal.dot(to_light) / to_light.length();
            let blocked = cosine <= 0.0
                || receivers.binary_search(&id).is_ok_and(|at| {
                    let (view, occluders) = &occluders[at];
                    let (on_plane, _) = view.project(-to_light);
                    occluders.iter().any(|other| {
                        other.id != id
                            && other
                                .meets(view, on_plane, -to_light)
                                .is_some_and(|t| t < 1.0 - 1e-12)
                    })
                });
            let material = &scene.materials[mesh.materials[id as usize] as usize];
            Channel::Luminance.of(std::array::from_fn(|i| {
                let direct =
                    if blocked { 0.0 } else { intensity[i] * cosine / to_light.length_squared() };
                material.ke[i] + material.kd[i] * (scene.ambient[i] + direct)
            }))
        };
        let mut tally = Tally { samples: n as u64, ..Tally::default() };
        for (point, value) in points.chunks_exact(2).zip(values) {
            let place = [point[0], point[1]];
            // f32 radiance of a few units in the last place; a shadow or another surface
            // changes far more.
            let agrees = |expected: f64| (value - expected).abs() < 2e-5 * expected.abs().max(0.1);
            if !agrees(radiance(place)) {
                let tie = Reference::around(place).iter().any(|p| agrees(radiance(*p)));
                tally.ties += u64::from(tie);
                tally.mismatches += u64::from(!tie);
            }
        }
        tally
    };
    spread(&scene.camera, side).par_iter().map(one).reduce(Tally::default, Tally::plus)
}

fn traced(name: &str) -> TracedScene {
    TracedScene::new(labelled(load(name).unwrap()))
}

/// Ties have probability 0 on edges, but f32 places are a lattice: one sample in a million may
/// come within 1e-9 of an edge.
fn check(name: &str, tally: Tally) {
    assert_eq!(tally.mismatches, 0, "{name}: {tally:?}");
    assert!(tally.ties <= 2 + tally.samples / 1_000_000, "{name}: {tally:?}");
}

#[test]
fn every_sample_sees_the_triangle_that_brute_force_sees() {
    check("classic", visibility(&traced("classic"), 10, 2000));
}

#[test]
fn every_sample_is_lit_as_brute_force_says() {
    check(
        "classic-shadows",
        lighting(&TracedScene::new(load("classic-shadows").unwrap()), 8, 1000),
    );
}

/// Triangles of every awkward kind around an eye at the origin: needles, some that share an edge
/// or a vertex, some without area, pairs that overlap in one plane, planes through the eye, and
/// corners behind it.
fn awkward(seed: u64) -> Scene {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut scene = load("classic").unwrap();
    scene.camera = Camera {
        eye: DVec3::ZERO,
        look_at: DVec3::NEG_Z,
        up: DVec3::Y,
        fov_y: 70.0,
        resolution: [32, 32],
    };
    let mut corners: Vec<[DVec3; 3]> = Vec::new();
    for i in 0..600 {
        let mut anywhere = |size: f64| {
            DVec3::from_array(std::array::from_fn(|_| random.random_range(-size..size)))
        };
        let middle = anywhere(3.0) - DVec3::Z * 4.0;
        let [a, b, c] = [anywhere(1.0), anywhere(1.0), anywhere(1.0)].map(|p| middle + p);
        let last = corners.last().copied().unwrap_or([a, b, c]);
        corners.push(match i % 8 {
            0 => [a, b, a + (b - a) * 0.4 + anywhere(1e-4)],
            1 => [a, b, a.lerp(b, 0.25)],
            // Overlaps the next one in a plane of its own.
            2 => [a.with_z(-5.0), b.with_z(-5.0), c.with_z(-5.0)],
            3 => [a.with_z(-5.0), b.with_z(-5.0), c.with_z(-5.0)],
            4 => [last[0], last[1], c],
            5 => [last[2], a, b],
            6 => [a, a * 1.5 + b * 0.1, b],
            _ => [a, b, c + DVec3::Z * 9.0],
        });
    }
    scene.mesh = Mesh {
        triangles: (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        materials: vec![0; corners.len()],
        positions: corners.into_iter().flatten().collect(),
        corner_normals: None,
    };
    scene
}

/// Overlapping triangles of one plane are level, and either answer is right.
#[test]
fn awkward_triangles_are_seen_as_brute_force_sees_them() {
    let mut all = Tally::default();
    for seed in 0..4 {
        all = all.plus(visibility(&TracedScene::new(labelled(awkward(seed))), 16, 200));
    }
    assert_eq!(all.mismatches, 0, "{all:?}");
}

/// Over 10^8 samples on three scenes, and on those named in STRAT_TEST_SCENES, colon-separated:
/// `cargo test --workspace --test beam -- --ignored --nocapture`
#[test]
#[ignore = "minutes"]
fn a_hundred_million_samples_see_what_brute_force_sees() {
    let others = std::env::var("STRAT_TEST_SCENES").unwrap_or_default();
    let names = ["classic", "grass"].into_iter().chain(others.split(':').filter(|s| !s.is_empty()));
    let mut all = Tally::default();
    let mut report = |name: &str, tally: Tally| {
        eprintln!("{name}: {tally:?}");
        all = all.plus(tally);
        check(name, tally);
    };
    report(
        "classic-shadows",
        lighting(&TracedScene::new(load("classic-shadows").unwrap()), 32, 32_000),
    );
    for name in names {
        report(name, visibility(&traced(name), 32, 34_000));
    }
    let mut tally = Tally::default();
    for seed in 0..20 {
        tally = tally.plus(visibility(&TracedScene::new(labelled(awkward(100 + seed))), 32, 1_000));
    }
    eprintln!("awkward: {tally:?}");
    assert_eq!(tally.mismatches, 0, "{tally:?}");
    assert!(all.samples >= 100_000_000, "{all:?}");
}

/// What the two tracers answer on the same samples, where they part, and with whom the reference
/// sides there.
#[derive(Debug, Default)]
struct Agreement {
    samples: u64,
    agree: u64,
    beam_right: u64,
    rays_right: u64,
    /// Either answer is right, on an edge or at equal depth.
    ties: u64,
    both_wrong: u64,
}

/// Both tracers are exact, so they may part only at ties. The counts are printed
/// (`--nocapture`) and stand in METHOD.md.
#[test]
fn where_beam_and_bvh_disagree_the_reference_sides_with_the_beam() {
    let beam = traced("classic");
    let rays = traced("classic").with_tracer(Tracer::Bvh);
    let mut counts = Agreement::default();
    let picture = Picture::new(beam.scene());
    for pixel in spread(&beam.scene().camera, 12) {
        let reference = Reference::new(&picture, pixel);
        let points = places(u64::from(pixel[0] * 1000 + pixel[1]), 1000);
        let ours = values_of(&beam_of(&beam, pixel, Channel::R), &points);
        let theirs = values_of(&rays.pixel(pixel, Channel::R), &points);
        for (point, (a, b)) in points.chunks_exact(2).zip(ours.iter().zip(&theirs)) {
            counts.samples += 1;
            if (a - b).abs() <= 0.5 {
                counts.agree += 1;
                continue;
            }
            let is_right = |value| reference.admits([point[0], point[1]], seen(value));
            *match (is_right(*a), is_right(*b)) {
                (true, true) => &mut counts.ties,
                (true, false) => &mut counts.beam_right,
                (false, true) => &mut counts.rays_right,
                (false, false) => &mut counts.both_wrong,
            } += 1;
        }
    }
    eprintln!("classic: {counts:?}");
    assert_eq!(counts.rays_right + counts.both_wrong, 0, "{counts:?}");
    assert!(counts.samples - counts.agree <= 1, "{counts:?}");
}

/// From inside a closed sphere no sample may see the background: not at random, not aimed at
/// shared edges, not at vertices, in f32 or in f64.
#[test]
fn a_closed_sphere_leaks_nowhere() {
    let mut scene = load("classic").unwrap();
    scene.mesh = Mesh { corner_normals: None, ..icosphere(4) };
    scene.camera = Camera {
        eye: DVec3::new(0.15, -0.09, 0.12),
        look_at: DVec3::new(1.0, 0.4, -0.3),
        up: DVec3::Y,
        fov_y: 100.0,
        resolution: [24, 24],
    };
    let traced = TracedScene::new(labelled(scene));
    let (scene, camera) = (traced.scene(), traced.scene().camera);
    let [forward, right, up] = camera.frame();
    let tan = (camera.fov_y.to_radians() / 2.0).tan();
    // Edge points and vertices, by the pixel that shows them.
    let mut aimed: Vec<Vec<f64>> = vec![Vec::new(); 24 * 24];
    for triangle in &scene.mesh.triangles {
        let corner = |i: usize| scene.mesh.positions[triangle[i % 3] as usize] - camera.eye;
        for (i, step) in (0..3).flat_map(|i| (0..16).map(move |step| (i, step))) {
            let d = corner(i).lerp(corner(i + 1), f64::from(step) / 16.0);
            let depth = d.dot(forward);
            if depth <= 0.0 {
                continue;
            }
            let x = (d.dot(right) / depth / tan + 1.0) * 12.0;
            let y = (1.0 - d.dot(up) / depth / tan) * 12.0;
            if (0.0..24.0).contains(&x) && (0.0..24.0).contains(&y) {
                let pixel = y.floor() as usize * 24 + x.floor() as usize;
                aimed[pixel].extend([x.fract(), y.fract()]);
            }
        }
    }
    let n_aimed: usize = aimed.iter().map(|points| points.len() / 2).sum();
    assert!(n_aimed > 10_000, "{n_aimed}");
    let mut leaks = 0;
    for (at, points) in (0..).zip(&aimed) {
        let beam = beam_of(&traced, [at % 24, at / 24], Channel::R);
        leaks += values_of(&beam, points).iter().filter(|value| **value == 0.0).count();
        let dark = |p: &[f64]| beam.exact_sample(p[0], p[1]).0.is_none();
        leaks += points.chunks_exact(2).filter(|p| dark(p)).count();
        let values = values_of(&beam, &places(at.into(), 500));
        leaks += values.iter().filter(|value| **value == 0.0).count();
    }
    assert_eq!(leaks, 0);
}
