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
