//! The BVH against the loop over all triangles, closed meshes against leaks, light against
//! closed forms.

use super::*;
use crate::integrand::Integrand;
use crate::sampler::{Jittered, PointSet, Scramble};
use crate::scene::library::{Model, cube, icosphere, torus};
use crate::scene::{
    AreaLight, Camera, Channel, Distribution, Light, LightShape, Material, Mesh, Rgb, Scene, load,
};
use crate::study::{Control, SamplerChoice, StudyPlan, study};
use crate::theory::Class;
use glam::{DVec3, dvec3};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::sync::atomic::AtomicBool;

const WHITE: Rgb = [1.0; 3];

fn scene_of(mesh: Mesh, eye: DVec3, light: Light) -> Scene {
    Scene {
        name: "test".to_owned(),
        camera: Camera {
            eye,
            look_at: eye + dvec3(0.1, -0.2, -1.0),
            up: DVec3::Y,
            fov_y: 50.0,
            resolution: [64, 48],
        },
        mesh,
        materials: vec![Material {
            name: "m".to_owned(),
            kd: [0.5, 0.25, 0.75],
            ..Material::default()
        }],
        light,
        distribution: Distribution::default(),
        filter: None,
        ambient: [0.0; 3],
        background: [0.1, 0.2, 0.3],
        files: Vec::new(),
        notes: Vec::new(),
    }
}

fn triangles(corners: &[[DVec3; 3]]) -> Mesh {
    Mesh {
        positions: corners.concat(),
        triangles: (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        materials: vec![0; corners.len()],
        corner_normals: None,
    }
}

fn random() -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(1996)
}

fn unit(random: &mut Xoshiro256PlusPlus) -> DVec3 {
    loop {
        let v = DVec3::from_array(std::array::from_fn(|_| random.random::<f64>() * 2.0 - 1.0));
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    }
}

/// Rays through the picture, and rays from a random triangle's corner in random directions.
fn agrees_with_brute_force(scene: &TracedScene, rays: usize) {
    let mut random = random();
    let camera = scene.scene().camera;
    let mut hits = 0;
    for i in 0..rays {
        let (origin, direction) = if i % 2 == 0 {
            let [x, y] = camera.resolution.map(|side| random.random_range(0..side));
            let [u, v] = [random.random(), random.random()];
            (camera.eye, camera.pixel([x, y]).direction(u, v))
        } else {
            let corner = random.random_range(0..scene.scene().mesh.positions.len());
            let off = unit(&mut random) * random.random::<f64>();
            (scene.scene().mesh.positions[corner] + off, unit(&mut random))
        };
        let hit = scene.closest_hit(origin, direction);
        assert_eq!(hit, scene.brute_force_hit(origin, direction), "{origin} {direction}");
        hits += usize::from(hit.is_some());
        let within = hit.map_or(f64::INFINITY, |hit| hit.t);
        assert!(!scene.occluded(origin, direction, within, hit.map(|hit| hit.triangle)));
        if let Some(hit) = hit {
            assert!(scene.occluded(origin, direction, hit.t * 1.01, None));
        }
    }
    assert!(hits > rays / 3, "{hits} of {rays}");
}

#[test]
fn bvh_and_brute_force_see_the_same_triangles() {
    for (name, rays) in [("classic", 120), ("edges", 120), ("grass", 24)] {
        agrees_with_brute_force(&TracedScene::new(load(name).unwrap()), rays);
    }
    for mesh in [icosphere(3), torus(0.3, 40, 24), cube()] {
        let scene = scene_of(mesh, dvec3(0.3, 0.2, 2.5), Light::Headlight);
        agrees_with_brute_force(&TracedScene::new(scene), 3000);
    }
}

#[test]
fn axis_parallel_rays_agree_with_brute_force() {
    let mut grid = Model::default().mesh;
    for i in 0..400 {
        let (x, z) = (f64::from(i % 20), f64::from(i / 20));
        let corner = |dx, dz| dvec3(x + dx, 0.0, z + dz);
        let quad = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let base = grid.positions.len() as u32;
        grid.positions.extend(quad);
        grid.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    }
    grid.materials = vec![0; grid.triangles.len()];
    let scene = TracedScene::new(scene_of(grid, dvec3(3.0, 4.0, 5.0), Light::Headlight));
    for i in 0..=80 {
        for j in 0..=80 {
            let above = dvec3(f64::from(i) / 4.0, 3.0, f64::from(j) / 4.0);
            let hit = scene.closest_hit(above, -DVec3::Y);
            assert!(hit.is_some(), "{above}");
            assert_eq!(hit, scene.brute_force_hit(above, -DVec3::Y), "{above}");
            assert_eq!(scene.closest_hit(above, DVec3::Y), None);
        }
    }
}

/// From inside, through points on shared edges and through vertices: every ray must hit.
#[test]
fn closed_meshes_do_not_leak() {
    let mut random = random();
    let circle = |random: &mut Xoshiro256PlusPlus| {
        let (sin, cos) = (random.random::<f64>() * 6.3).sin_cos();
        dvec3(cos, 0.0, sin) + unit(random) * 0.2
    };
    let middle = |random: &mut Xoshiro256PlusPlus| unit(random) * 0.7 * random.random::<f64>();
    type Inside<'a> = &'a dyn Fn(&mut Xoshiro256PlusPlus) -> DVec3;
    let cases: [(Mesh, Inside<'_>); 3] =
        [(icosphere(3), &middle), (torus(0.3, 40, 24), &circle), (cube(), &middle)];
    for (mesh, inside) in cases {
        let moved = Mesh {
            positions: mesh.positions.iter().map(|p| *p + dvec3(7.3, -2.1, 5.7)).collect(),
            ..mesh.clone()
        };
        for (mesh, offset) in [(mesh, DVec3::ZERO), (moved, dvec3(7.3, -2.1, 5.7))] {
            let scene =
                TracedScene::new(scene_of(mesh, offset + inside(&mut random), Light::Headlight));
            let mesh = &scene.scene().mesh;
            for i in 0..20_000 {
                let triangle = random.random_range(0..mesh.triangles.len());
                let [a, b, _] = mesh.corners(triangle);
                let target = if i % 2 == 0 { a } else { a.lerp(b, random.random()) };
                let origin = offset + inside(&mut random);
                let direction = (target - origin) * random.random_range(0.1..3.0);
                assert!(scene.closest_hit(origin, direction).is_some(), "{origin} {direction}");
            }
        }
    }
}

#[test]
fn a_triangle_across_the_eye_plane_is_hit_only_in_front() {
    let floor = [dvec3(-5.0, -1.0, -5.0), dvec3(5.0, -1.0, -5.0), dvec3(0.0, -1.0, 8.0)];
    let ray = |direction| Ray { origin: DVec3::ZERO, direction }.meets(floor);
    let crossing = ray(dvec3(0.0, -1.0, -2.0)).unwrap();
    assert!((crossing.inverse_t - 1.0).abs() < 1e-15);
    assert!(ray(dvec3(0.0, 1.0, 2.0)).is_none());
    assert!(ray(dvec3(0.0, -1.0, -6.0)).is_none());
    assert!(ray(dvec3(0.0, -1.0, 7.9)).is_some());
}

#[test]
fn degenerate_and_edge_on_triangles_are_never_hit() {
    let [o, x, y] = [dvec3(-1.0, -1.0, -3.0), dvec3(1.0, -1.0, -3.0), dvec3(0.0, 1.0, -3.0)];
    let towards = dvec3(0.0, -1.0, -3.0);
    for corners in [[o, x, o], [o, o, o], [o, x, o.lerp(x, 0.25)], [o, o * 2.0, o * 3.0]] {
        assert_eq!(Ray { origin: DVec3::ZERO, direction: towards }.meets(corners), None);
    }
    assert!(Ray { origin: DVec3::ZERO, direction: towards }.meets([o, x, y]).is_some());
    // The ray's origin lies in the triangle's plane.
    let edge_on = Ray { origin: dvec3(0.0, 0.0, -3.0), direction: DVec3::Y };
    assert_eq!(edge_on.meets([o, x, y]), None);
}

#[test]
fn hostile_scenes_trace_without_a_panic() {
    let wild = dvec3(f64::NAN, 1.0, f64::INFINITY);
    let far = dvec3(1e15, -1e15, 1e15);
    let flat = [DVec3::X; 3];
    for mesh in [
        Mesh::default(),
        triangles(&[[wild, DVec3::X, DVec3::Y]]),
        triangles(&[flat]),
        triangles(&[[far, -far, DVec3::Y * 1e15], [DVec3::X, DVec3::Y, DVec3::Z]]),
        triangles(&vec![[DVec3::X, DVec3::Y, DVec3::Z]; 300]),
        triangles(&[[DVec3::X * 1e-30, DVec3::Y * 1e-30, DVec3::Z * 1e-30]]),
    ] {
        let scene = TracedScene::new(scene_of(mesh, DVec3::splat(2.0), Light::Headlight));
        for direction in [-DVec3::ONE, DVec3::X, dvec3(-1.0, -1e-300, 0.0), dvec3(0.0, -0.0, 1e9)] {
            let [r, g, b] = scene.radiance(DVec3::splat(2.0), direction);
            assert!(r.is_finite() && g.is_finite() && b.is_finite());
        }
    }
}

#[test]
fn the_lower_triangle_wins_a_tie() {
    let face = [DVec3::X, DVec3::Y, DVec3::Z];
    let scene = scene_of(triangles(&[face; 40]), DVec3::splat(2.0), Light::Headlight);
    let hit = TracedScene::new(scene).closest_hit(DVec3::splat(2.0), -DVec3::ONE).unwrap();
    assert_eq!(hit.triangle, 0);
}

fn floor() -> Mesh {
    let [a, b] = [dvec3(-50.0, 0.0, -50.0), dvec3(50.0, 0.0, -50.0)];
    let [c, d] = [dvec3(50.0, 0.0, 50.0), dvec3(-50.0, 0.0, 50.0)];
    triangles(&[[a, b, c], [a, c, d]])
}

fn close(a: Rgb, b: Rgb) -> bool {
    (0..3).all(|i| (a[i] - b[i]).abs() <= 1e-14 * b[i].abs())
}

#[test]
fn a_headlight_shades_by_the_cosine_to_the_eye() {
    let eye = dvec3(0.0, 3.0, 0.0);
    let scene = TracedScene::new(scene_of(floor(), eye, Light::Headlight));
    let seen = scene.radiance(eye, dvec3(4.0, -3.0, 0.0));
    assert!(close(seen, [0.5 * 0.6, 0.25 * 0.6, 0.75 * 0.6]), "{seen:?}");
    assert_eq!(scene.radiance(eye, DVec3::Y), [0.1, 0.2, 0.3]);
}

#[test]
fn point_and_directional_lights_follow_their_formulas_and_cast_shadows() {
    let eye = dvec3(0.0, 3.0, 0.0);
    let mut mesh = floor();
    // A roof over x > 1, between the floor and the lights.
    let roof = [dvec3(1.0, 1.0, -9.0), dvec3(9.0, 1.0, 0.0), dvec3(1.0, 1.0, 9.0)];
    mesh.positions.extend(roof);
    mesh.triangles.push([6, 7, 8]);
    mesh.materials.push(0);
    let light = Light::Point { position: dvec3(0.0, 4.0, 0.0), intensity: [32.0, 16.0, 8.0] };
    let scene = TracedScene::new(Scene { ambient: [0.5; 3], ..scene_of(mesh.clone(), eye, light) });
    // Lit at (-3, 0, 0): r = 5, cosine 4/5.
    let lit = scene.radiance(eye, dvec3(-3.0, -3.0, 0.0));
    let e = [32.0, 16.0, 8.0].map(|i| i * 0.8 / 25.0 + 0.5);
    assert!(close(lit, [0.5 * e[0], 0.25 * e[1], 0.75 * e[2]]), "{lit:?}");
    // Under the roof, seen from below it, only the ambient light arrives.
    let low_eye = dvec3(0.0, 0.5, 0.0);
    let dark = scene.radiance(low_eye, dvec3(4.0, -0.5, 0.0));
    assert!(close(dark, [0.25, 0.125, 0.375]), "{dark:?}");
    // The roof's underside: the light is on the other side.
    let under = scene.radiance(low_eye, dvec3(2.0, 0.5, 0.0));
    assert!(close(under, [0.25, 0.125, 0.375]), "{under:?}");
    // A light below the roof does not reach its upper side, but lights the floor under it.
    let light = Light::Directional { towards: dvec3(-0.6, 0.8, 0.0), irradiance: WHITE };
    let scene = TracedScene::new(scene_of(mesh, eye, light));
    let lit = scene.radiance(low_eye, dvec3(-3.0, -0.5, 0.0));
    assert!(close(lit, [0.4, 0.2, 0.6]), "{lit:?}");
    assert_eq!(scene.radiance(low_eye, dvec3(2.5, -0.5, 0.0)), [0.0; 3]);
}

/// Each triangle twice, and a third of the same plane: no sample of the beam or of rays is in
/// the shadow of the surface that it lies on.
#[test]
fn doubles_cast_no_shadow_on_their_surface() {
    let eye = dvec3(0.3, 3.1, 0.7);
    let lamp = AreaLight {
        shape: LightShape::Rectangle {
            corner: dvec3(-1.0, 5.0, -1.0),
            edges: [DVec3::X * 2.0, DVec3::Z * 2.0],
        },
        radiance: WHITE,
    };
    let slant = |p: DVec3| dvec3(p.x, p.y + 0.13 * p.x - 0.07 * p.z, p.z);
    let once = Mesh { positions: floor().positions.into_iter().map(slant).collect(), ..floor() };
    let mut twice = once.clone();
    twice.triangles.extend([[0, 1, 2], [3, 4, 5], [1, 2, 5]]);
    twice.materials.resize(5, 0);
    let point = Light::Point { position: dvec3(0.4, 4.0, 0.2), intensity: WHITE };
    for (light, lights) in [(point, vec![]), (Light::Off, vec![lamp])] {
        let distribution = Distribution { lights, ..Distribution::default() };
        let scenes = [&once, &twice].map(|mesh| Scene {
            distribution: distribution.clone(),
            ..scene_of(mesh.clone(), eye, light)
        });
        for tracer in [Tracer::Beam, Tracer::Bvh] {
            let [once, twice] =
                scenes.clone().map(|scene| TracedScene::new(scene).with_tracer(tracer));
            let mut random = random();
            for pixel in [[30, 20], [10, 40], [60, 47]] {
                let pixels = [&once, &twice].map(|scene| scene.pixel(pixel, Channel::G));
                for _ in 0..500 {
                    let at: [f64; 4] = std::array::from_fn(|_| random.random());
                    let [a, b] = pixels.each_ref().map(|p| p.eval(&at[..p.dim()]));
                    // Of coplanar triangles either may be seen; their normals round apart.
                    assert!(
                        (a - b).abs() <= 1e-12 * a && a > 0.0,
                        "{tracer:?} {pixel:?} {at:?}: {a} {b}"
                    );
                }
            }
        }
    }
}

#[test]
fn smooth_normals_shade_between_their_corners() {
    let mesh = icosphere(2);
    let eye = dvec3(0.0, 0.0, 4.0);
    let scene = TracedScene::new(scene_of(mesh, eye, Light::Headlight));
    let mut random = random();
    for _ in 0..2000 {
        let direction = unit(&mut random) * 0.7 - eye;
        let hit = scene.closest_hit(eye, direction).unwrap();
        let point = eye + direction * hit.t;
        let corners = scene.scene().mesh.corners(hit.triangle as usize);
        // Barycentric weights by areas; the corner normals are the corners.
        let [a, b, c] = corners;
        let area = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).length();
        let normal = a * area(point, b, c) + b * area(point, c, a) + c * area(point, a, b);
        let expected = 0.5 * normal.normalize().dot(-direction.normalize()).abs();
        let [red, ..] = scene.radiance(eye, direction);
        assert!((red - expected).abs() < 1e-9, "{red} {expected}");
    }
}

#[test]
fn a_pixel_is_its_rays() {
    let scene = TracedScene::new(scene_of(icosphere(3), dvec3(0.0, 0.5, 3.0), Light::Headlight));
    let pixel = scene.pixel([30, 25], Channel::Luminance);
    assert_eq!((pixel.dim(), pixel.axes()), (2, vec!["pixel_x".to_owned(), "pixel_y".to_owned()]));
    let frame = scene.scene().camera.pixel([30, 25]);
    let [r, g, b] = scene.radiance(scene.scene().camera.eye, frame.direction(0.25, 0.75));
    assert_eq!(pixel.eval(&[0.25, 0.75]), 0.2126 * r + 0.7152 * g + 0.0722 * b);
    assert_eq!(scene.pixel([30, 25], Channel::G).eval(&[0.25, 0.75]), g);
}

/// Pixel (88, 20) of `edges` is cut upright at 0.3: with q = frac(0.3 k) the k strata that are
/// cut are Bernoulli trials, and the variance of the mean is q(1-q) k / N² times the step's
/// square. (M-1) s²/σ² has a standard deviation of sqrt(2/(M-1)) for a normal mean; few cut
/// strata have less kurtosis. The bound of 6 of them is one false alarm in 10^8.
#[test]
fn an_upright_edge_of_the_target_has_its_exact_variance() {
    const TRIALS: u32 = 4000;
    let scene = TracedScene::new(load("edges").unwrap());
    let pixel = scene.pixel([88, 20], Channel::Luminance);
    for k in [3u64, 5, 8] {
        let n = k * k;
        let mut means = vec![0.0; TRIALS as usize];
        let key = crate::rng::StreamKey {
            seed: 1996,
            pixel: [88, 20],
            sampler: 1,
            n_samples: n,
            trial: 0,
        };
        let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
        crate::trial::trial_means(&pixel, &Jittered, &set, 0, &mut means, &AtomicBool::new(false));
        let variance = crate::variance::Moments::of(&means).variance;
        let q = (0.3 * k as f64).fract();
        let exact = q * (1.0 - q) * k as f64 / (n * n) as f64 * (0.8 - 0.1f64).powi(2);
        let ratio = variance / exact;
        let bound = 6.0 * (2.0 / f64::from(TRIALS - 1)).sqrt();
        assert!((ratio - 1.0).abs() < bound, "k = {k}: {ratio}");
    }
}

/// The classes that `assets/README.md` promises. With 200 trials the fitted exponent has a
/// standard error of 0.015; a bound of 0.08 is five of them, one false alarm in 10^6.
#[test]
fn pixels_of_the_target_have_the_classes_promised() {
    let scene = TracedScene::new(load("edges").unwrap());
    let plan = StudyPlan {
        n_trials: 200,
        samplers: vec![SamplerChoice::named("jittered").unwrap()],
        ..StudyPlan::paper()
    };
    let studied = |pixel| {
        let integrand = scene.pixel(pixel, Channel::Luminance);
        study(&integrand, pixel, &plan, Control::unwatched()).unwrap().samplers.remove(0)
    };
    for constant in [[10, 10], [68, 10], [10, 96], [96, 96]] {
        assert_eq!(studied(constant).class, Some(Class::Exact), "{constant:?}");
    }
    for (pixel, expected) in [([100, 150], 2.0), ([128, 220], 2.0), ([216, 24], 1.5)] {
        let fit = studied(pixel).fit.unwrap();
        assert!((fit.exponent - expected).abs() < 0.08, "{pixel:?}: {}", fit.exponent);
    }
    let fine = studied([230, 100]);
    assert_eq!((fine.class, fine.class_is_sure), (Some(Class::Complex), true));
    // The edge at one half: nothing varies at even k.
    for row in studied([72, 10]).rows {
        assert_eq!(row.variance_of_mean == 0.0, row.n_used.isqrt() % 2 == 0, "N = {}", row.n);
    }
}
