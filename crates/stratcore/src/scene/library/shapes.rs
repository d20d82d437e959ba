//! Small closed meshes, counter-clockwise seen from outside; round ones with the normals of the
//! shape they stand for.

use crate::scene::Mesh;
use glam::{DVec3, dvec3};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// A unit sphere about the origin: an icosahedron whose triangles are split in four `levels`
/// times (20 · 4^levels triangles), every vertex on the sphere.
pub fn icosphere(levels: u32) -> Mesh {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut positions: Vec<DVec3> = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        positions.extend([dvec3(a, b, 0.0), dvec3(0.0, a, b), dvec3(b, 0.0, a)]);
    }
    for p in &mut positions {
        *p = p.normalize();
    }
    let mut triangles = hull_of_icosahedron(&positions);
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    let mesh =
        Mesh { materials: vec![0; triangles.len()], positions, triangles, corner_normals: None };
    with_normals(mesh, |p| p)
}

/// The 20 triples of vertices at mutual edge distance, turned outward.
fn hull_of_icosahedron(positions: &[DVec3]) -> Vec<[u32; 3]> {
    // Neighbours are 1.05 apart on the unit sphere, the next nearest vertices 1.70.
    let near = |a: usize, b: usize| positions[a].distance(positions[b]) < 1.2;
    let mut triangles = Vec::with_capacity(20);
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outward = positions[a].dot(positions[b].cross(positions[c])) > 0.0;
                    let [b, c] = if outward { [b, c] } else { [c, b] };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    triangles
}

/// A torus about the y axis: a tube of radius `tube` around the unit circle, with `around` ×
/// `across` quadrilaterals of two triangles each (both at least 3).
pub fn torus(tube: f64, around: u32, across: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let angle = |i: u32, n: u32| TAU * f64::from(i) / f64::from(n);
    for i in 0..around {
        let (sin, cos) = angle(i, around).sin_cos();
        for j in 0..across {
            let (up, out) = angle(j, across).sin_cos();
            let radius = 1.0 + tube * out;
            mesh.positions.push(dvec3(radius * cos, tube * up, radius * sin));
        }
    }
    let vertex = |i: u32, j: u32| (i % around) * across + j % across;
    for i in 0..around {
        for j in 0..across {
            let [a, b] = [vertex(i, j), vertex(i, j + 1)];
            let [c, d] = [vertex(i + 1, j + 1), vertex(i + 1, j)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.materials = vec![0; mesh.triangles.len()];
    // Straight away from the nearest point of the unit circle.
    with_normals(mesh, |p| p - dvec3(p.x, 0.0, p.z).normalize())
}

/// Gives every corner the direction that a smooth shape has there.
fn with_normals(mut mesh: Mesh, outward: impl Fn(DVec3) -> DVec3) -> Mesh {
    let normals = (0..mesh.triangles.len())
        .map(|id| mesh.corners(id).map(|p| outward(p).normalize_or(DVec3::Y)))
        .collect();
    mesh.corner_normals = Some(normals);
    mesh
}

/// The cube from (-1, -1, -1) to (1, 1, 1): 8 vertices, 12 triangles.
pub fn cube() -> Mesh {
    let side = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let positions = (0..8u32).map(|i| dvec3(side(i & 1), side(i >> 1 & 1), side(i >> 2))).collect();
    let quads =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { positions, triangles, materials: vec![0; 12], corner_normals: None }
}
