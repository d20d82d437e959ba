//! `classic`: the kind of picture that ray tracers made in 1996.

use super::{Model, cube, icosphere, torus};
use glam::{DAffine3, DQuat, DVec3, dvec3};

/// A checkerboard of unit squares in the plane y = 0, each of two triangles of its own, from
/// behind the eye to 420 units away and as wide as the view; spheres, boxes and a ring on it.
pub(super) fn model() -> Model {
    let mut model = Model::default();
    ground(&mut model);
    let ball = icosphere(5);
    let mut sphere = |radius: f64, x: f64, z: f64, kd| {
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::splat(radius),
            DQuat::IDENTITY,
            dvec3(x, radius, z),
        );
        let material = model.material("sphere", kd);
        model.add(&ball, place, material);
    };
    sphere(1.0, 0.3, 8.0, [0.85, 0.25, 0.15]);
    sphere(0.5, -1.3, 6.0, [0.9, 0.7, 0.2]);
    let stone = model.material("stone", [0.5, 0.6, 0.7]);
    let place = DAffine3::from_scale_rotation_translation(
        dvec3(0.5, 1.0, 0.5),
        DQuat::from_rotation_y(0.5),
        dvec3(2.4, 1.0, 10.0),
    );
    model.add(&cube(), place, stone);
    let place = DAffine3::from_translation(dvec3(-2.5, 0.3, 9.0));
    model.add(&torus(0.3, 48, 24), place, stone);
    model
}

fn ground(model: &mut Model) {
    let light = model.material("light square", [0.85, 0.83, 0.78]);
    let dark = model.material("dark square", [0.12, 0.14, 0.2]);
    for z in -4..420 {
        let half_width = 8 + (f64::from(z.max(0)) * 0.45) as i32;
        for x in -half_width..half_width {
            let corner = |dx: i32, dz: i32| dvec3(f64::from(x + dx), 0.0, f64::from(z + dz));
            let square = [corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)];
            model.polygon(&square, if (x + z) % 2 == 0 { light } else { dark });
        }
    }
}
