//! Puts meshes together.

use super::Model;
use crate::scene::{Material, Mesh, Rgb};
use glam::{DAffine3, DVec3};

impl Model {
    /// Adds a material and returns its index.
    pub(super) fn material(&mut self, name: &str, kd: Rgb) -> u32 {
        self.materials.push(Material { name: name.to_owned(), kd, ke: [0.0; 3] });
        self.materials.len() as u32 - 1
    }

    /// Adds a material that only emits, the same in all directions.
    pub(super) fn emitter(&mut self, name: &str, ke: Rgb) -> u32 {
        self.materials.push(Material { name: name.to_owned(), kd: [0.0; 3], ke });
        self.materials.len() as u32 - 1
    }

    /// Adds all of another model. Where only one of the two has shading normals, the other's
    /// are geometric.
    pub(in crate::scene) fn append(&mut self, other: Self) {
        let merges_normals =
            self.mesh.corner_normals.is_some() || other.mesh.corner_normals.is_some();
        let mut normals = Vec::new();
        if merges_normals {
            normals.append(&mut corner_normals(&mut self.mesh));
        }
        let mut mesh = other.mesh;
        if merges_normals {
            normals.append(&mut corner_normals(&mut mesh));
        }
        let first_material = self.materials.len() as u32;
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.append(&mut mesh.positions);
        self.mesh.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| base + i)));
        self.mesh.materials.extend(mesh.materials.iter().map(|m| first_material + m));
        self.mesh.corner_normals = merges_normals.then_some(normals);
        self.materials.extend(other.materials);
    }

    /// Adds a moved copy of `mesh`, all of one material.
    pub(super) fn add(&mut self, mesh: &Mesh, place: DAffine3, material: u32) {
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.extend(mesh.positions.iter().map(|p| place.transform_point3(*p)));
        self.mesh.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| base + i)));
        self.mesh.materials.resize(self.mesh.triangles.len(), material);
    }

    /// Adds a convex polygon with vertices of its own, as a fan of triangles.
    pub(super) fn polygon(&mut self, corners: &[DVec3], material: u32) {
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.extend_from_slice(corners);
        for i in 2..corners.len() as u32 {
            self.mesh.triangles.push([base, base + i - 1, base + i]);
        }
        self.mesh.materials.resize(self.mesh.triangles.len(), material);
    }
}

fn corner_normals(mesh: &mut Mesh) -> Vec<[DVec3; 3]> {
    let given = mesh.corner_normals.take();
    given.unwrap_or_else(|| {
        let plane = |id| [mesh.area_normal(id).normalize_or(DVec3::Y); 3];
        (0..mesh.triangles.len()).map(plane).collect()
    })
}
