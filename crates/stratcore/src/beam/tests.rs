use super::PixelBeam;
use super::pixel::{depth_unit, facet_lanes};
use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{
    Halton, Jittered, LatinHypercube, PointSet, Random, Sampler, Scramble, Sobol, whole_set,
};
use crate::scene::{self, Channel, Light, Material, Mesh, Scene};
use crate::simd::{DOUBT, Isa};
use crate::study::{Control, StudyPlan, study};
use crate::trace::{TracedScene, Tracer};
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::sync::atomic::AtomicBool;

/// A scene whose radiance tells which triangle was hit: triangle i emits i + 1.
fn labelled(triangles: &[[DVec3; 3]], resolution: [u32; 2], fov_y: f64) -> TracedScene {
    let mut scene = scene::load("edges").unwrap();
    scene.camera.eye = DVec3::new(0.3, -0.2, 0.1);
    scene.camera.look_at = scene.camera.eye + DVec3::new(0.1, 0.05, 1.0);
    scene.camera.fov_y = fov_y;
    scene.camera.resolution = resolution;
    scene.light = Light::Headlight;
    scene.ambient = [0.0; 3];
    scene.background = [0.0; 3];
    relabel(scene, triangles)
}

fn relabel(mut scene: Scene, triangles: &[[DVec3; 3]]) -> TracedScene {
    let n = triangles.len() as u32;
    scene.mesh = Mesh {
        positions: triangles.iter().flatten().copied().collect(),
        triangles: (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        materials: (0..n).collect(),
        corner_normals: None,
    };
    scene.materials =
        (0..n).map(|i| Material { ke: [f64::from(i + 1); 3], ..Material::default() }).collect();
    TracedScene::new(scene)
}

/// Triangles of every kind around the view axis: large and small, needles, some through the
/// plane of the eye, some degenerate, some twice, some coplanar.
fn soup(seed: u64, n: usize) -> Vec<[DVec3; 3]> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut point = |spread: f64, depth: [f64; 2]| {
        let z: f64 = rng.random_range(depth[0]..depth[1]);
        let mut lateral = || rng.random_range(-spread..spread) * z.abs().max(0.5);
        let (x, y) = (lateral(), lateral());
        DVec3::new(x, y, z)
    };
    let mut triangles: Vec<[DVec3; 3]> = Vec::new();
    for i in 0..n {
        let centre = point(0.3, [1.0, 20.0]);
        triangles.push(match i % 8 {
            0..=2 => [centre, centre + point(0.2, [-0.3, 0.3]), centre + point(0.2, [-0.3, 0.3])],
            3 => [0; 3].map(|_| point(2.0, [-5.0, 15.0])),
            4 => {
                let along = point(1.0, [-1.0, 1.0]);
                [centre, centre + along, centre + along * 0.5 + point(1e-7, [-1e-7, 1e-7])]
            }
            5 => [centre, centre, centre + point(0.5, [-0.5, 0.5])],
            6 => *triangles.last().unwrap(),
            _ => {
                let flat = |p: DVec3| DVec3::new(p.x, p.y, 7.0);
                [0; 3].map(|_| flat(point(0.3, [7.0, 7.5])))
            }
        });
    }
    triangles
}

/// Small triangles all over the view, none of which hides many others.
fn leaves(seed: u64, n: usize) -> Vec<[DVec3; 3]> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut point = |centre: DVec3, half: f64| {
        centre + DVec3::from_array([0; 3].map(|_| rng.random_range(-half..half)))
    };
    (0..n)
        .map(|_| {
            let centre = point(DVec3::new(0.8, 0.1, 5.0), 3.0);
            [0; 3].map(|_| point(centre, 0.15))
        })
        .collect()
}

/// Random positions that f32 represents about the pixel's centre, as the kernels place them.
fn positions(seed: u64, n: usize) -> Vec<f64> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..2 * n).map(|_| f64::from(rng.random_range(-0.5f32..0.5)) + 0.5).collect()
}

/// Positions on both sides of edges, as close as f32 goes: pairs that see different triangles
/// are bisected.
fn positions_at_edges(beam: &PixelBeam, seed: u64, n: usize) -> Vec<f64> {
    let round = |x: f64| f64::from((x - 0.5) as f32) + 0.5;
    let label = |p: [f64; 2]| beam.exact_sample(p[0], p[1]).0;
    let mut found = Vec::new();
    for pair in positions(seed, n).chunks_exact(4) {
        let (mut a, mut b) = ([pair[0], pair[1]], [pair[2], pair[3]]);
        if label(a) == label(b) {
            continue;
        }
        for _ in 0..24 {
            let middle = [0, 1].map(|axis| round(0.5 * (a[axis] + b[axis])));
            if label(middle) == label(a) { a = middle } else { b = middle }
        }
        found.extend([a, b].concat());
    }
    found
}

/// Every sample against a loop over all triangles in f64. A different triangle is excused only
/// where moving the sample by 1e-9 pixel gives it to the loop as well, or where both lie at the
/// same depth to 1e-12. Returns the number of excused samples.
fn mismatches(traced: &TracedScene, pixel: [u32; 2], points: &[f64]) -> usize {
    let scene = traced.scene();
    let frame = scene.camera.pixel(pixel);
    let beam = PixelBeam::new(scene, traced.accel(), pixel, Channel::R).unwrap();
    let mut values = vec![0.0; points.len() / 2];
    beam.eval_block(points, &mut values);
    let label = |u: f64, v: f64| traced.brute_force_hit(scene.camera.eye, frame.direction(u, v));
    let mut excused = 0;
    for (point, &value) in points.chunks(2).zip(&values) {
        let (u, v) = (point[0], point[1]);
        let hit = label(u, v);
        let expected = hit.map_or(0.0, |hit| f64::from(hit.triangle + 1));
        if value == expected {
            continue;
        }
        excused += 1;
        let step = 1e-9;
        let moved = [(-step, 0.0), (step, 0.0), (0.0, -step), (0.0, step)].iter().any(|(a, b)| {
            label(u + a, v + b).map_or(0.0, |hit| f64::from(hit.triangle + 1)) == value
        });
        let level = hit.is_some_and(|hit| {
            let other = scene.mesh.corners((value - 1.0).max(0.0) as usize);
            let ray =
                crate::trace::Ray { origin: scene.camera.eye, direction: frame.direction(u, v) };
            ray.meets(other).is_some_and(|c| (c.inverse_t * hit.t - 1.0).abs() < 1e-12)
        });
        assert!(moved || level, "pixel {pixel:?} at {u}, {v}: {value}, loop says {expected}");
    }
    excused
}

#[test]
fn every_sample_sees_what_a_loop_over_all_triangles_sees() {
    let mut samples = 0;
    let mut excused = 0;
    for (seed, fov_y) in [(1, 40.0), (2, 5.0), (3, 110.0), (4, 0.01)] {
        let traced = labelled(&soup(seed, 160), [8, 6], fov_y);
        for y in 0..6 {
            for x in 0..8 {
                let (accel, seed) = (traced.accel(), seed * 1000 + u64::from(y * 8 + x));
                let beam = PixelBeam::new(traced.scene(), accel, [x, y], Channel::R).unwrap();
                let mut points = positions(seed, 300);
                points.extend(positions_at_edges(&beam, seed, 200));
                samples += points.len() / 2;
                excused += mismatches(&traced, [x, y], &points);
            }
        }
    }
    // Coincident and coplanar triangles tie; nothing else may.
    assert!(excused < samples / 100, "{excused} of {samples}");
}

#[test]
fn a_shared_edge_leaks_no_sample() {
    // A fan of thin triangles around a point inside the pixel, lit from behind by nothing: any
    // sample that falls through a crack sees the background's 0.
    let centre = DVec3::new(0.35, -0.17, 3.0);
    let corner = |i: u32| {
        let angle = f64::from(i % 97) / 97.0 * std::f64::consts::TAU;
        centre + DVec3::new(5.0 * angle.cos(), 5.0 * angle.sin(), 0.3 * (3.0 * angle).sin())
    };
    let fan: Vec<_> = (0..97).map(|i| [centre, corner(i), corner(i + 1)]).collect();
    let traced = labelled(&fan, [4, 4], 30.0);
    for pixel in 0..16 {
        let (accel, at) = (traced.accel(), [pixel % 4, pixel / 4]);
        let beam = PixelBeam::new(traced.scene(), accel, at, Channel::R).unwrap();
        let points = positions(u64::from(pixel), 20_000);
        let mut values = vec![0.0; 20_000];
        beam.eval_block(&points, &mut values);
        assert!(values.iter().all(|value| *value > 0.0), "pixel {at:?}");
        // And rays straight at the edges.
        for i in 0..97 {
            for step in 0..20 {
                let target = centre.lerp(corner(i), f64::from(step) / 20.0);
                let [forward, right, up] = traced.scene().camera.frame();
                let d = target - traced.scene().camera.eye;
                let tan = 15f64.to_radians().tan();
                let (x, y) =
                    (d.dot(right) / d.dot(forward) / tan, d.dot(up) / d.dot(forward) / tan);
                let (u, v) =
                    ((x + 1.0) * 2.0 - f64::from(at[0]), (1.0 - y) * 2.0 - f64::from(at[1]));
                if (0.0..1.0).contains(&u) && (0.0..1.0).contains(&v) {
                    assert!(beam.exact_sample(u, v).0.is_some(), "{u}, {v}");
                }
            }
        }
    }
}

/// Trial means of a few pixels by every instruction set, bit for bit, with strata and without: of
/// few triangles, and of so many that tiles are sampled as crowds.
#[test]
fn all_instruction_sets_give_the_same_bits() {
    for (name, fov_y) in [("classic", 20.0), ("classic", 170.0), ("classic-shadows", 45.0)] {
        let mut scene = scene::load(name).unwrap();
        scene.camera.fov_y = fov_y;
        let traced = TracedScene::new(scene);
        for pixel in [[128, 75], [100, 120], [10, 10], [200, 160], [60, 83]] {
            same_bits_by_every_isa(&traced, pixel);
        }
    }
    let crowd = labelled(&leaves(11, 1_000), [2, 2], 60.0);
    for pixel in [[0, 0], [1, 1]] {
        let n_facets = crowd.pixel(pixel, Channel::Luminance).n_facets();
        assert!(n_facets > Some(100), "{n_facets:?}");
        same_bits_by_every_isa(&crowd, pixel);
    }
}

/// The same where narrow triangles stand before a wall: beyond their tips the edges alone do not
/// keep them out of a stratum, and what does must not go by the vector's length.
#[test]
fn all_instruction_sets_cut_narrow_triangles_alike() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let mut triangles =
        vec![[[-90.0, -90.0], [90.0, -90.0], [0.0, 180.0]].map(|[x, y]| DVec3::new(x, y, 9.0))];
    for _ in 0..300 {
        let tip = DVec3::new(rng.random_range(-2.5..4.0), rng.random_range(-3.0..3.0), 5.0);
        let base = tip + DVec3::new(rng.random_range(-0.1..0.1), rng.random_range(-0.5..0.5), 0.1);
        triangles.push([tip, base, base + DVec3::new(0.05, 0.0, 0.0)]);
    }
    let mut scene = labelled(&triangles, [8, 8], 60.0).scene().clone();
    for material in &mut scene.materials {
        *material = Material { kd: [0.7; 3], ..Material::default() };
    }
    let traced = TracedScene::new(scene);
    for pixel in (0..64).map(|at| [at % 8, at / 8]) {
        same_bits_by_every_isa(&traced, pixel);
    }
}

/// A facet that is passed over as hidden raises no doubt: wherever none of its edges is below the
/// doubt, beyond a needle's tip too, its 1/t is within the bound. Needles in a pixel of 3e-6
/// radians are as long as they are far, and f64 has their planes to some digits alone.
#[test]
fn bounds_hold_wherever_edges_are_in_doubt() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(12);
    let axis = DVec3::new(0.1, 0.05, 1.0).normalize();
    let across = axis.cross(DVec3::Y).normalize();
    let upwards = across.cross(axis);
    let fov = 3e-6;
    let mut needles = Vec::new();
    for _ in 0..400 {
        let mut at = |depth: f64, reach: f64| {
            let [x, y] = [0; 2].map(|_| rng.random_range(-reach..reach) * fov * depth);
            DVec3::new(0.3, -0.2, 0.1) + axis * depth + across * x + upwards * y
        };
        let (tip, base) = (at(1.0, 0.5), at(2.0, 1.0));
        let width = 10f64.powf(rng.random_range(-4.0..0.0)) * 2.0 * fov;
        needles.push([tip, base, base + across * width]);
    }
    let pixels = [(needles, fov.to_degrees()), (soup(5, 400), 20.0), (soup(6, 400), 0.5)];
    let (mut n_inside, mut n_beyond) = (0, 0);
    for (triangles, fov_y) in pixels {
        let traced = labelled(&triangles, [1, 1], fov_y);
        let beam = PixelBeam::new(traced.scene(), traced.accel(), [0, 0], Channel::R).unwrap();
        let unit = depth_unit(beam.facets());
        for facet in beam.facets() {
            let bound = facet_lanes(facet, unit).w_hi;
            for (p, q) in [(0, 1), (1, 2), (2, 0)] {
                let (p, q) = (&facet.edges[p], &facet.edges[q]);
                let area = p.s * q.t - p.t * q.s;
                let corner = [(p.t * q.c - q.t * p.c) / area, (q.s * p.c - p.s * q.c) / area];
                let length = p.s.hypot(p.t);
                for step in 0..120 {
                    // Along an edge, from 1e-12 to 1 pixel before its corner and beyond.
                    let sign = if step % 2 == 0 { 1.0 } else { -1.0 };
                    let step = sign * 10f64.powf(-0.1 * f64::from(step)) / length;
                    let [s, t] = [corner[0] - p.t * step, corner[1] + p.s * step];
                    let least = facet.edges.map(|edge| edge.at(s, t));
                    let least = least.into_iter().fold(f64::INFINITY, f64::min);
                    let is_here = s.abs() <= 0.5 && t.abs() <= 0.5;
                    if is_here && least >= -1.9 * f64::from(DOUBT) {
                        let w = facet.inverse_depth.at(s, t) / unit;
                        assert!(w <= f64::from(bound), "{w} above {bound} at {s}, {t}");
                        n_inside += usize::from(least >= -1e-12);
                        n_beyond += usize::from(least < -1e-8);
                    }
                }
            }
        }
    }
    assert!(n_inside > 1000 && n_beyond > 1000, "{n_inside} {n_beyond}");
}

/// A trial's mean is its own where one facet fills rectangles wider than a run of f32 sums, which
/// the last few trials go through several strata at a time, and beside edges.
#[test]
fn the_last_trials_sum_like_the_others() {
    let wall = [[-90.0, -90.0, 9.0], [90.0, -90.0, 20.0], [0.0, 180.0, 4.0]].map(DVec3::from_array);
    last_trials_sum_like_the_others(&[wall], &[100, 4093, 4096, 512 * 512]);
    let mut with_leaves = leaves(11, 40);
    with_leaves.push(wall);
    last_trials_sum_like_the_others(&with_leaves, &[100, 257, 4093, 4096]);
}

fn last_trials_sum_like_the_others(triangles: &[[DVec3; 3]], counts: &[u64]) {
    let mut scene = labelled(triangles, [1, 1], 60.0).scene().clone();
    scene.materials.fill(Material { kd: [0.7; 3], ..Material::default() });
    let traced = TracedScene::new(scene);
    let never = AtomicBool::new(false);
    for &n in counts {
        let (seed, sampler) = (5, Jittered.stream_id());
        let key = StreamKey { seed, pixel: [0, 0], sampler, n_samples: n, trial: 0 };
        let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: true };
        for isa in Isa::all() {
            let accel = traced.accel();
            let beam = PixelBeam::new(traced.scene(), accel, [0, 0], Channel::Luminance).unwrap();
            let beam = beam.with_isa(isa);
            let means = |first, count| {
                let mut means = vec![f64::NAN; count];
                assert!(beam.trial_means(&Jittered, &set, first, &mut means, &never));
                means
            };
            let all = means(0, 9);
            for (first, count) in [(0, 1), (3, 2), (8, 1), (9, 0)] {
                assert_eq!(means(first, count), all[first as usize..][..count], "{n}: {isa:?}");
            }
        }
    }
}

fn same_bits_by_every_isa(traced: &TracedScene, pixel: [u32; 2]) {
    let means = |isa| {
        let (scene, accel) = (traced.scene(), traced.accel());
        let beam = PixelBeam::new(scene, accel, pixel, Channel::Luminance).unwrap();
        let beam = beam.with_isa(isa);
        let mut all = Vec::new();
        let never = AtomicBool::new(false);
        for (sampler, scramble, n, n_trials) in [
            (&Jittered as &dyn Sampler, Scramble::None, 16, 21),
            (&Jittered, Scramble::None, 49, 18),
            (&Jittered, Scramble::None, 30, 17),
            (&Jittered, Scramble::None, 144, 21),
            (&Jittered, Scramble::None, 900, 18),
            (&Random, Scramble::None, 50, 21),
            (&Random, Scramble::TorusShift, 50, 21),
            (&Halton, Scramble::Owen, 7, 21),
            (&Sobol, Scramble::OwenHash, 1500, 21),
        ] {
            let (sampler_id, seed) = (sampler.stream_id(), 5);
            let key = StreamKey { seed, pixel, sampler: sampler_id, n_samples: n, trial: 0 };
            let set = PointSet { key, dim: 2, scramble, rectangular: true };
            let mut means = vec![0.0; n_trials];
            assert!(beam.trial_means(sampler, &set, 3, &mut means, &never));
            all.extend(means);
        }
        all
    };
    let plain = means(Isa::BASELINE);
    for isa in Isa::all() {
        let case = format!("{}, {pixel:?}: {}", traced.scene().name, isa.name());
        assert_eq!(means(isa), plain, "{case}");
    }
}

/// Means of points without strata are those of the points one by one, in small sets and in such
/// as are evaluated part by part; and a trial's mean is its own, whichever others come with it.
#[test]
fn scattered_trials_are_their_points() {
    let traced = TracedScene::new(scene::load("classic").unwrap());
    for pixel in [[128, 75], [100, 120], [60, 83], [10, 10]] {
        let beam = PixelBeam::new(traced.scene(), traced.accel(), pixel, Channel::R).unwrap();
        for (sampler, scramble, n) in [
            (&Sobol as &dyn Sampler, Scramble::OwenHash, 1),
            (&Sobol, Scramble::OwenHash, 256),
            (&Sobol, Scramble::Owen, 4097),
            (&Halton, Scramble::Owen, 100),
            (&LatinHypercube, Scramble::None, 9001),
            (&Jittered, Scramble::TorusShift, 49),
        ] {
            let (seed, stream) = (8, sampler.stream_id());
            let key = StreamKey { seed, pixel, sampler: stream, n_samples: n, trial: 0 };
            let set = PointSet { key, dim: 2, scramble, rectangular: true };
            let never = AtomicBool::new(false);
            let means = |first, count| {
                let mut means = vec![f64::NAN; count];
                assert!(beam.trial_means(sampler, &set, first, &mut means, &never));
                means
            };
            let all = means(4, 50);
            assert_eq!(all[7..9], means(11, 2), "{pixel:?}, {n}");
            for (trial, mean) in (4..8).zip(all) {
                let key = StreamKey { trial, ..key };
                let points = whole_set(sampler, &PointSet { key, ..set }).unwrap();
                let mut sum = 0.0;
                for point in points.chunks(2) {
                    let mut value = [0.0];
                    beam.eval_block(point, &mut value);
                    sum += value[0];
                }
                let expected = sum / n as f64;
                let off = (mean - expected).abs();
                assert!(off <= 1e-12 * expected.abs(), "{pixel:?}, {n}: {mean}, {expected}");
            }
        }
    }
}

/// The beam draws the points that the samplers define, so its means are those of the rays to
/// the rounding of f32 positions and values: 1e-6, but for a sample that crosses an edge.
#[test]
fn beam_and_rays_agree_trial_by_trial() {
    let directional = Light::Directional {
        towards: DVec3::new(-0.5, 0.8, -0.3).normalize(),
        irradiance: [0.9; 3],
    };
    for (name, light) in
        [("classic", None), ("classic-shadows", None), ("classic", Some(directional))]
    {
        let load = || {
            let mut scene = scene::load(name).unwrap();
            scene.light = light.unwrap_or(scene.light);
            TracedScene::new(scene)
        };
        let (traced, rays) = (load(), load().with_tracer(Tracer::Bvh));
        let plan = StudyPlan { n_trials: 16, counts: vec![1, 16, 144], ..StudyPlan::paper() };
        let (mut rows, mut crossed) = (0, 0);
        for y in (8..256).step_by(37) {
            for x in (5..256).step_by(41) {
                let results = [&traced, &rays].map(|scene| {
                    let integrand = scene.pixel([x, y], Channel::Luminance);
                    study(&integrand, [x, y], &plan, Control::unwatched()).unwrap()
                });
                let [a, b] = results.each_ref().map(|r| r.samplers.iter().flat_map(|s| &s.rows));
                for (a, b) in a.zip(b) {
                    rows += 1;
                    crossed += usize::from((a.grand_mean - b.grand_mean).abs() > 1e-6);
                }
            }
        }
        // A row has up to 2,304 samples, each within 6e-8 of an edge once in some 10^6.
        assert!(crossed <= 1 + rows / 100, "{name}: {crossed} of {rows}");
    }
}

/// A point light over the middle of the pixel at a height of so many footprints: the beam's values
/// are those of f64 to 1e-5 of the greatest, and where it could not promise that, rays take the
/// pixel.
#[test]
fn a_light_next_to_a_surface_is_left_to_rays() {
    let mut scene = scene::load("edges").unwrap();
    scene.ambient = [0.0; 3];
    scene.camera.eye = DVec3::ZERO;
    scene.camera.look_at = DVec3::Z;
    scene.camera.up = DVec3::Y;
    scene.camera.fov_y = 20.0;
    scene.camera.resolution = [1, 1];
    let footprint = 20.0 * (10f64.to_radians()).tan();
    let wall = [[-90.0, -90.0, 10.0], [90.0, -90.0, 10.0], [0.0, 180.0, 10.0]];
    for (height, is_left) in
        [(10.0, false), (0.3, false), (0.08, false), (0.06, true), (1e-3, true), (1e-6, true)]
    {
        let mut scene = scene.clone();
        let position = DVec3::new(0.0, 0.0, 10.0 - height * footprint);
        scene.light = Light::Point { position, intensity: [1.0; 3] };
        scene.mesh = Mesh {
            positions: wall.map(DVec3::from_array).to_vec(),
            triangles: vec![[0, 1, 2]],
            materials: vec![0],
            corner_normals: None,
        };
        scene.materials = vec![Material { kd: [1.0; 3], ..Material::default() }];
        let traced = TracedScene::new(scene);
        let pixel = traced.pixel([0, 0], Channel::R);
        assert_eq!(pixel.n_facets().is_none(), is_left, "{height}");
        let axis = |i: u32| (f64::from(i) + 0.5) / 64.0;
        let points: Vec<f64> = (0..64 * 64).flat_map(|i| [axis(i % 64), axis(i / 64)]).collect();
        let mut values = vec![f64::NAN; points.len() / 2];
        pixel.eval_block(&points, &mut values);
        // h r⁻³ on the wall, with the light at h over its middle.
        let expected = points.chunks(2).map(|point| {
            let [x, y] = [point[0] - 0.5, point[1] - 0.5].map(|x| x * footprint);
            let h = height * footprint;
            h * (x * x + y * y + h * h).powf(-1.5)
        });
        let greatest = values.iter().copied().fold(0.0, f64::max);
        for (value, expected) in values.iter().zip(expected) {
            assert!((value - expected).abs() <= 1e-5 * greatest, "{height}: {value} {expected}");
        }
    }
}

/// A plane seen nearly edge-on, to its horizon, under a light that is far from it: w falls to 0
/// in the pixel and the beam keeps it.
#[test]
fn a_horizon_under_a_far_light_stays_with_the_beam() {
    let mut scene = scene::load("edges").unwrap();
    scene.camera.eye = DVec3::ZERO;
    scene.camera.look_at = DVec3::Z;
    scene.camera.up = DVec3::Y;
    scene.camera.resolution = [1, 1];
    let position = DVec3::new(-100.0, 0.0, 0.0);
    scene.light = Light::Point { position, intensity: [1.0; 3] };
    scene.mesh = Mesh {
        positions: [[0.001, -9.0, 8.0], [0.001, 9.0, 8.0], [0.001, 0.0, 9.0]]
            .map(DVec3::from_array)
            .to_vec(),
        triangles: vec![[0, 1, 2]],
        materials: vec![0],
        corner_normals: None,
    };
    scene.materials = vec![Material { kd: [1.0; 3], ..Material::default() }];
    assert_eq!(TracedScene::new(scene).pixel([0, 0], Channel::R).n_facets(), Some(1));
}

#[test]
fn an_empty_picture_is_its_background() {
    let mut scene = scene::load("edges").unwrap();
    scene.background = [0.3; 3];
    let traced = relabel(scene, &[]);
    let beam = PixelBeam::new(traced.scene(), traced.accel(), [0, 0], Channel::R).unwrap();
    assert_eq!(beam.n_facets(), 0);
    let plan = StudyPlan::paper();
    let result = study(&beam, [0, 0], &plan, Control::unwatched()).unwrap();
    assert!(result.samplers.iter().all(|sampler| sampler.exact));
    let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 8, n_samples: 9, trial: 0 };
    let set = PointSet { key, dim: 2, scramble: Scramble::Owen, rectangular: false };
    let (mut means, never) = (vec![f64::NAN; 3], AtomicBool::new(false));
    assert!(beam.trial_means(&Sobol, &set, 0, &mut means, &never));
    assert_eq!(means, [0.3; 3]);
}

/// Rows that would take minutes end at once.
#[test]
fn a_cancelled_row_ends() {
    let traced = TracedScene::new(scene::load("classic").unwrap());
    let (pixel, cancel) = ([100, 120], AtomicBool::new(true));
    let beam = PixelBeam::new(traced.scene(), traced.accel(), pixel, Channel::Luminance).unwrap();
    assert!(beam.n_facets() > 0);
    let mut means = vec![0.0; 1000];
    for (sampler, scramble, n) in [
        (&Jittered as &dyn Sampler, Scramble::None, 1 << 24),
        (&Random, Scramble::None, u32::MAX.into()),
        (&Sobol, Scramble::OwenHash, 1 << 32),
    ] {
        let (id, seed) = (sampler.stream_id(), 1);
        let key = StreamKey { seed, pixel, sampler: id, n_samples: n, trial: 0 };
        let set = PointSet { key, dim: 2, scramble, rectangular: false };
        assert!(beam.trial_means(sampler, &set, 0, &mut means, &cancel));
    }
}

/// Beyond scene and tree, which rays need as well.
#[test]
fn a_million_triangles_take_less_than_64_mib() {
    let traced = TracedScene::new(scene::load("classic").unwrap());
    let bytes = size_of_val(traced.accel().rounded_corners());
    let n_triangles = traced.scene().mesh.triangles.len();
    assert!(bytes * 1_080_548 < n_triangles * (64 << 20), "{bytes} bytes for {n_triangles}");
}
