//! A scene at the limit.

use stratcore::scene::{Mesh, Scene};

/// The same camera and light before one triangle that fills the picture: generate, shade,
/// accumulate.
pub fn covered_by_one_triangle(mut scene: Scene) -> Scene {
    let [w, h] = scene.camera.resolution.map(f64::from);
    let frame = scene.camera.pixel([0, 0]);
    let corners = [[-w, -h], [4.0 * w, -h], [-w, 4.0 * h]];
    let positions = corners.map(|[u, v]| scene.camera.eye + frame.direction(u, v)).to_vec();
    scene.mesh =
        Mesh { positions, triangles: vec![[0, 1, 2]], materials: vec![0], corner_normals: None };
    scene
}
