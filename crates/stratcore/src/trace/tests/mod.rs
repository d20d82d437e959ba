//! Rays against loops and closed forms.

mod hits;
mod light;
mod pixels;

use super::*;
use crate::scene::{Camera, Light, Material, Mesh, Scene};
use glam::{DVec3, dvec3};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

fn scene_of(mesh: Mesh, eye: DVec3, light: Light) -> Scene {
    let look_at = eye + dvec3(0.1, -0.2, -1.0);
    let camera = Camera { eye, look_at, up: DVec3::Y, fov_y: 50.0, resolution: [64, 48] };
    let surface = Material { kd: [0.5, 0.25, 0.75], ..Material::default() };
    Scene { background: [0.1, 0.2, 0.3], ..Scene::plain(mesh, vec![surface], camera, light) }
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
