//! `grass`: more thin blades than pixels.

use super::{Model, icosphere};
use crate::scene::Mesh;
use glam::{DAffine3, DQuat, DVec3, dvec3};
use rand::RngExt;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::TAU;

const BLADES: usize = 375_000;
/// The meadow ends here.
const DEPTH: f64 = 34.0;

/// A meadow of bent blades, three triangles each, with two balls and three stones in it. Seen
/// from (0, 1.1, 0) towards +z.
pub(super) fn model() -> Model {
    let mut model = Model::default();
    let mut random = Xoshiro256PlusPlus::seed_from_u64(1996);
    let soil = model.material("soil", [0.16, 0.12, 0.07]);
    let [far, wide] = [DEPTH, 0.5 * DEPTH + 2.0];
    let ground = [(-wide, -2.0), (-wide, far), (wide, far), (wide, -2.0)];
    model.polygon(&ground.map(|(x, z)| dvec3(x, 0.0, z)), soil);
    things(&mut model);
    let greens: Vec<u32> = (0..8)
        .map(|i| {
            let dry = f64::from(i) / 7.0;
            let kd = [0.16 + 0.55 * dry, 0.42 + 0.22 * dry, 0.08 + 0.12 * dry];
            model.material("blade", kd)
        })
        .collect();
    for _ in 0..BLADES {
        // A square root would be even over the wedge that is seen; this is denser in front.
        let z = 0.6 + (DEPTH - 0.6) * random.random::<f64>().powf(0.65);
        let x = (random.random::<f64>() * 2.0 - 1.0) * (0.46 * z + 0.4);
        let dry = random.random::<f64>() * random.random::<f64>();
        blade(&mut model, &mut random, dvec3(x, 0.0, z), greens[(dry * 8.0) as usize]);
    }
    model
}

/// Half a blade is a quadrilateral, the other half a triangle that leans further over.
fn blade(model: &mut Model, random: &mut Xoshiro256PlusPlus, root: DVec3, material: u32) {
    let mut uniform = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let height = uniform(0.12, 0.42);
    let half_width = uniform(0.004, 0.009);
    let (sin, cos) = uniform(0.0, TAU).sin_cos();
    let side = dvec3(cos, 0.0, sin) * half_width;
    let lean = dvec3(-sin, 0.0, cos) * (height * uniform(0.1, 0.7));
    let middle = root + dvec3(0.0, 0.6 * height, 0.0) + lean * 0.3;
    let tip = root + dvec3(0.0, height, 0.0) + lean;
    let outline = [root - side, root + side, middle + side * 0.8, middle - side * 0.8];
    let base = model.mesh.positions.len() as u32;
    model.mesh.positions.extend_from_slice(&outline);
    model.mesh.positions.push(tip);
    let triangles = [[0, 1, 2], [0, 2, 3], [3, 2, 4]];
    model.mesh.triangles.extend(triangles.map(|t| t.map(|i| base + i)));
    model.mesh.materials.resize(model.mesh.triangles.len(), material);
}

fn things(model: &mut Model) {
    // Without normals: they would make a meadow of a million flat triangles carry its own.
    let flat = |levels| Mesh { corner_normals: None, ..icosphere(levels) };
    let [ball, stone] = [flat(4), flat(2)];
    let red = model.material("red ball", [0.85, 0.12, 0.10]);
    let white = model.material("white ball", [0.90, 0.88, 0.84]);
    let grey = model.material("stone", [0.45, 0.44, 0.42]);
    let mut place = |mesh: &Mesh, scale: DVec3, at: DVec3, material| {
        let turn = DQuat::from_rotation_y(at.x);
        model.add(mesh, DAffine3::from_scale_rotation_translation(scale, turn, at), material);
    };
    place(&ball, DVec3::splat(0.3), dvec3(-0.45, 0.3, 3.2), red);
    place(&ball, DVec3::splat(0.3), dvec3(1.9, 0.3, 7.0), white);
    place(&stone, dvec3(1.1, 0.7, 0.8), dvec3(1.6, 0.3, 10.0), grey);
    place(&stone, dvec3(0.7, 0.5, 0.6), dvec3(-4.2, 0.2, 13.0), grey);
    place(&stone, dvec3(1.6, 1.3, 1.4), dvec3(-5.0, 0.5, 21.0), grey);
}
