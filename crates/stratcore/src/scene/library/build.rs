//! Puts meshes together.

use super::Model;
use crate::scene::{Material, Mesh, Rgb};
use glam::{DAffine3, DVec3};

impl Model {
    /// Adds a material and returns its index.
    pub(super) fn material(&mut self, name: &str, kd: Rgb) -> u32 {
        self.materials.push(Material { name: name.to_owned(), kd, ..Material::default() });
        self.materials.len() as u32 - 1
    }

    /// Adds a material that only emits, the same in all directions.
    pub(super) fn emitter(&mut self, name: &str, ke: Rgb) -> u32 {
        self.materials.push(Material { name: name.to_owned(), ke, ..Material::default() });
        self.materials.len() as u32 - 1
    }

    /// Adds all of another model.
    pub(in crate::scene) fn append(&mut self, other: Self) {
        let first_material = self.materials.len() as u32;
        let mut mesh = other.mesh;
        for material in &mut mesh.materials {
            *material += first_material;
        }
        self.materials.extend(other.materials);
        self.join(mesh);
    }

    /// Adds a moved copy of `mesh`, all of one material.
    pub(super) fn add(&mut self, mesh: &Mesh, place: DAffine3, material: u32) {
        let turn = place.matrix3.inverse().transpose();
        let moved_normals = |corners: &[DVec3; 3]| corners.map(|n| (turn * n).normalize_or(n));
        self.join(Mesh {
            positions: mesh.positions.iter().map(|p| place.transform_point3(*p)).collect(),
            triangles: mesh.triangles.clone(),
            materials: vec![material; mesh.triangles.len()],
            corner_normals: mesh
                .corner_normals
                .as_ref()
                .map(|normals| normals.iter().map(moved_normals).collect()),
        });
    }

    /// Adds a mesh whose materials are ours. Where only one of the two has shading normals, the
    /// other's are geometric.
    fn join(&mut self, mut mesh: Mesh) {
        if self.mesh.corner_normals.is_some() || mesh.corner_normals.is_some() {
            let mut normals = corner_normals(&mut self.mesh);
            normals.append(&mut corner_normals(&mut mesh));
            self.mesh.corner_normals = Some(normals);
        }
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.append(&mut mesh.positions);
        self.mesh.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| base + i)));
        self.mesh.materials.append(&mut mesh.materials);
    }

    /// Adds a convex polygon with vertices of its own, as a fan of triangles.
    pub(super) fn polygon(&mut self, corners: &[DVec3], material: u32) {
        let base = self.mesh.positions.len() as u32;
        self.mesh.positions.extend_from_slice(corners);
        for i in 2..corners.len() as u32 {
            self.mesh.triangles.push([base, base + i - 1, base + i]);
            self.mesh.materials.push(material);
            let normal = self.mesh.area_normal(self.mesh.triangles.len() - 1);
            if let Some(normals) = &mut self.mesh.corner_normals {
                normals.push([normal.normalize_or(DVec3::Y); 3]);
            }
        }
    }
}

fn corner_normals(mesh: &mut Mesh) -> Vec<[DVec3; 3]> {
    let given = mesh.corner_normals.take();
    given.unwrap_or_else(|| {
        let plane = |id| [mesh.area_normal(id).normalize_or(DVec3::Y); 3];
        (0..mesh.triangles.len()).map(plane).collect()
    })
}
