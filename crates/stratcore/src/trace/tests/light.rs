//! Light on surfaces against closed forms.

use super::*;
use crate::integrand::Integrand;
use crate::scene::library::icosphere;
use crate::scene::{AreaLight, Channel, Distribution, LightShape, Rgb};

const WHITE: Rgb = [1.0; 3];

fn floor() -> Mesh {
    let [a, b] = [dvec3(-50.0, 0.0, -50.0), dvec3(50.0, 0.0, -50.0)];
    let [c, d] = [dvec3(50.0, 0.0, 50.0), dvec3(-50.0, 0.0, 50.0)];
    Mesh::loose([[a, b, c], [a, c, d]])
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
