//! `room`: a box that is open to the eye, with a lamp in its ceiling, a block, and a ball that
//! is a mesh of its own so that it can move.

use super::{Model, cube, icosphere};
use crate::scene::Specular;
use glam::{DAffine3, DQuat, DVec3, dvec3};

/// The room, two units a side, its floor at y = 0 and its open side towards +z.
pub(super) fn room() -> Model {
    let mut model = Model::default();
    let white = model.material("wall", [0.74, 0.73, 0.70]);
    let [left, right] = [
        model.material("left wall", [0.63, 0.16, 0.10]),
        model.material("right wall", [0.12, 0.34, 0.55]),
    ];
    let corner = |x: i32, y: i32, z: i32| dvec3(f64::from(x), f64::from(y), f64::from(z));
    let [a, b, c, d] = [corner(-1, 0, 1), corner(1, 0, 1), corner(1, 0, -1), corner(-1, 0, -1)];
    let [e, f, g, h] = [a, b, c, d].map(|p| p + DVec3::Y * 2.0);
    model.polygon(&[a, b, c, d], white);
    model.polygon(&[h, g, f, e], white);
    model.polygon(&[d, c, g, h], white);
    model.polygon(&[a, d, h, e], left);
    model.polygon(&[b, f, g, c], right);
    let block = model.material("block", [0.72, 0.68, 0.60]);
    let place = DAffine3::from_scale_rotation_translation(
        dvec3(0.3, 0.55, 0.3),
        DQuat::from_rotation_y(0.35),
        dvec3(-0.38, 0.55, -0.38),
    );
    model.add(&cube(), place, block);
    let lamp = model.emitter("lamp", [9.0, 8.4, 7.2]);
    let under = |x: f64, z: f64| dvec3(x, 1.999, z);
    let outline = [under(-0.3, -0.3), under(0.3, -0.3), under(0.3, 0.3), under(-0.3, 0.3)];
    model.polygon(&outline, lamp);
    model
}

/// The ball, Lambertian.
pub(super) fn ball() -> Model {
    let mut model = Model::default();
    let ball = model.material("ball", [0.70, 0.52, 0.14]);
    let place = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.36),
        DQuat::IDENTITY,
        dvec3(0.42, 0.36, 0.3),
    );
    model.add(&icosphere(4), place, ball);
    model
}

/// The ball of clear glass.
pub(super) fn glass_ball() -> Model {
    let mut model = ball();
    for material in &mut model.materials {
        material.kd = [0.0; 3];
        material.specular = Specular::Glass { index: 1.5, transmittance: [0.95; 3] };
    }
    model
}
