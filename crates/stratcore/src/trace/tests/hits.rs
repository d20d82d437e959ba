//! The BVH against the loop over all triangles, closed meshes against leaks.

use super::*;
use crate::scene::library::{Model, cube, icosphere, torus};
use crate::scene::load;

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
        Mesh::loose([[wild, DVec3::X, DVec3::Y]]),
        Mesh::loose([flat]),
        Mesh::loose([[far, -far, DVec3::Y * 1e15], [DVec3::X, DVec3::Y, DVec3::Z]]),
        Mesh::loose([[DVec3::X, DVec3::Y, DVec3::Z]; 300]),
        Mesh::loose([[DVec3::X * 1e-30, DVec3::Y * 1e-30, DVec3::Z * 1e-30]]),
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
    let scene = scene_of(Mesh::loose([face; 40]), DVec3::splat(2.0), Light::Headlight);
    let hit = TracedScene::new(scene).closest_hit(DVec3::splat(2.0), -DVec3::ONE).unwrap();
    assert_eq!(hit.triangle, 0);
}
