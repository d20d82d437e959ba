//! `classic`: the kind of picture that ray tracers made in 1996.

use super::{Model, cube, icosphere, torus};
use crate::scene::{Mesh, Rgb, Specular};
use glam::{DAffine3, DQuat, DVec3, dvec3};

const IVORY: Rgb = [0.86, 0.84, 0.78];
const INK: Rgb = [0.10, 0.14, 0.22];
const CORAL: Rgb = [0.88, 0.22, 0.13];
const AMBER: Rgb = [0.95, 0.68, 0.16];
const TEAL: Rgb = [0.08, 0.50, 0.53];
const PLUM: Rgb = [0.42, 0.20, 0.50];
const ROSE: Rgb = [0.86, 0.48, 0.52];
const STONE: Rgb = [0.62, 0.66, 0.72];

/// Spheres, boxes and a ring on a checkerboard. Seen from (0, 1.6, 0) towards +z; +x is to the
/// left in the picture.
pub(super) fn model() -> Model {
    let mut model = Model::default();
    checkerboard(&mut model);
    still_life(&mut model);
    avenue(&mut model);
    model
}

/// The same with mirrors: the balls and the ring reflect most of what they see.
pub(super) fn with_mirrors() -> Model {
    const MIRRORS: [&str; 4] = ["coral", "amber", "teal", "rose"];
    let mut model = model();
    for material in &mut model.materials {
        if MIRRORS.contains(&&*material.name) {
            material.specular =
                Specular::Mirror { reflectance: material.kd.map(|kd| 0.3 + 0.6 * kd) };
            material.kd = material.kd.map(|kd| 0.25 * kd);
        }
    }
    model
}

/// Unit squares in the plane y = 0, each of two triangles of its own, from behind the eye to
/// 400 units away and as wide as the view.
fn checkerboard(model: &mut Model) {
    let [ivory, ink] = [model.material("ivory", IVORY), model.material("ink", INK)];
    for z in -4..400 {
        let half_width = 8 + (f64::from(z.max(0)) * 0.45) as i32;
        for x in -half_width..half_width {
            let corner = |dx: i32, dz: i32| dvec3(f64::from(x + dx), 0.0, f64::from(z + dz));
            let square = [corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0)];
            model.polygon(&square, if (x + z) % 2 == 0 { ivory } else { ink });
        }
    }
}

/// The objects in front.
fn still_life(model: &mut Model) {
    let [fine, medium] = [icosphere(5), icosphere(4)];
    let [coral, amber] = [model.material("coral", CORAL), model.material("amber", AMBER)];
    let [teal, plum] = [model.material("teal", TEAL), model.material("plum", PLUM)];
    let [rose, stone] = [model.material("rose", ROSE), model.material("stone", STONE)];
    let ball = |radius: f64| DVec3::splat(radius);
    place(model, &fine, ball(1.3), 0.0, dvec3(0.9, 1.3, 9.4), coral);
    place(model, &fine, ball(0.6), 0.0, dvec3(-1.35, 0.6, 6.6), amber);
    place(model, &medium, ball(0.42), 0.0, dvec3(1.25, 0.42, 5.4), teal);
    place(model, &cube(), dvec3(0.62, 1.1, 0.62), 0.5, dvec3(-3.0, 1.1, 10.8), stone);
    place(model, &medium, ball(0.5), 0.0, dvec3(-3.0, 2.7, 10.8), teal);
    place(model, &cube(), ball(0.55), 0.62, dvec3(2.9, 0.55, 9.4), plum);
    place(model, &cube(), dvec3(0.3, 0.3, 0.3), 0.2, dvec3(2.85, 1.4, 9.45), amber);
    place(model, &torus(0.32, 128, 52), ball(0.42), 0.0, dvec3(-0.25, 0.1344, 4.5), rose);
}

/// A row of balls and a row of pillars that run to the vanishing point.
fn avenue(model: &mut Model) {
    let ball = icosphere(3);
    let [ivory, stone] = [model.material("far ball", IVORY), model.material("pillar", STONE)];
    for step in 0..10 {
        let z = 15.0 + 6.0 * f64::from(step);
        place(model, &ball, DVec3::splat(0.7), 0.0, dvec3(-2.1, 0.7, z), ivory);
        place(model, &cube(), dvec3(0.45, 1.7, 0.45), 0.0, dvec3(7.0, 1.7, z + 6.0), stone);
    }
}

/// Adds a scaled copy, turned about the vertical by `turn` radians.
fn place(model: &mut Model, mesh: &Mesh, scale: DVec3, turn: f64, at: DVec3, material: u32) {
    let turn = DQuat::from_rotation_y(turn);
    model.add(mesh, DAffine3::from_scale_rotation_translation(scale, turn, at), material);
}
