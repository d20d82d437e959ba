//! What is looked at: triangles, Lambertian materials, one light, a camera.

mod camera;
mod distribution;
mod error;
mod file;
mod filter;
pub mod library;
mod light_table;
mod obj;
mod tables;
#[cfg(test)]
mod tests;
mod text;

pub use camera::{Camera, CameraFault, PixelFrame};
pub use distribution::{Aperture, AreaLight, Distribution, Lens, LightShape, Motion};
pub(crate) use distribution::{SHORT_OF_THE_LIGHT, around, disk};
pub use error::SceneError;
pub use file::{load, load_from};
pub use filter::{Filter, FilterMethod, FilterShape};

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Linear RGB.
pub type Rgb = [f64; 3];

/// The largest coordinate a scene may have: the areas of the BVH's boxes still fit in f32.
pub const MAX_COORDINATE: f64 = 1e15;

/// A scene, ready to be traced. Coordinates are f64 and those of the files.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Name for reports: the file's stem, or the built-in's name.
    pub name: String,
    /// The camera.
    pub camera: Camera,
    /// All triangles.
    pub mesh: Mesh,
    /// Materials, indexed by [`Mesh::materials`].
    pub materials: Vec<Material>,
    /// What lights the surfaces from a point or a direction.
    pub light: Light,
    /// What a pixel integrates over besides its square.
    pub distribution: Distribution,
    /// How a pixel weighs the picture about its centre; its own square, evenly, if none.
    pub filter: Option<Filter>,
    /// Radiance of light that comes from everywhere and casts no shadow, times Kd.
    pub ambient: Rgb,
    /// Radiance where nothing is hit.
    pub background: Rgb,
    /// The files that it was read from, in the order in which they were opened; none for a
    /// built-in scene.
    pub files: Vec<String>,
    /// What the loader had to assume, in words; empty as a rule.
    pub notes: Vec<String>,
}

impl Scene {
    /// A scene without a name, a feature or ambient light, before nothing.
    pub fn plain(mesh: Mesh, materials: Vec<Material>, camera: Camera, light: Light) -> Self {
        Self {
            name: String::new(),
            camera,
            mesh,
            materials,
            light,
            distribution: Distribution::default(),
            filter: None,
            ambient: [0.0; 3],
            background: [0.0; 3],
            files: Vec::new(),
            notes: Vec::new(),
        }
    }
}

/// Indexed triangles, each with a material.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` per triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`] per triangle.
    pub materials: Vec<u32>,
    /// Shading normals at the corners of each triangle, unit length; present only when the scene
    /// asks for smooth shading and the files have normals. Otherwise the geometric normal counts.
    pub corner_normals: Option<Vec<[DVec3; 3]>>,
}

impl Mesh {
    /// Triangles that share no vertices, all of material 0.
    pub fn loose(triangles: impl IntoIterator<Item = [DVec3; 3]>) -> Self {
        let positions: Vec<DVec3> = triangles.into_iter().flatten().collect();
        let count = positions.len() as u32 / 3;
        Self {
            positions,
            triangles: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            materials: vec![0; count as usize],
            corner_normals: None,
        }
    }

    /// Length twice the area, along the normal of the counter-clockwise side.
    pub fn area_normal(&self, id: usize) -> DVec3 {
        let [a, b, c] = self.corners(id);
        (b - a).cross(c - a)
    }

    /// The corners of triangle `id`.
    pub fn corners(&self, id: usize) -> [DVec3; 3] {
        self.triangles[id].map(|i| self.positions[i as usize])
    }
}

/// A Lambertian surface, and what it is besides where the scene follows mirrors and glass.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Material {
    /// Name in the MTL file.
    pub name: String,
    /// Diffuse reflectance.
    pub kd: Rgb,
    /// Emitted radiance.
    pub ke: Rgb,
    /// What it does to rays where [`Distribution::specular_depth`] is above 0.
    pub specular: Specular,
}

/// How a surface sends rays on in one direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Specular {
    /// Not at all.
    #[default]
    None,
    /// As a mirror.
    Mirror {
        /// Share that is reflected.
        reflectance: Rgb,
    },
    /// As the border between air, on the side that the normal points to, and glass: both rays
    /// are followed, weighted by Fresnel's equations for unpolarised light.
    Glass {
        /// Refractive index inside.
        index: f64,
        /// Share of the refracted light that passes the surface.
        transmittance: Rgb,
    },
}

/// What lights the surfaces. Both sides of a triangle reflect; the side that the eye sees is
/// lit only from its own half-space. A surface's radiance is Ke + Kd·(ambient + E), with E:
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// None: ambient light, emission and area lights alone.
    Off,
    /// A light at the eye that neither falls off nor casts shadows: E = |n·v|, v from the hit
    /// to the eye.
    Headlight,
    /// E = intensity · cos θ / r², with a shadow ray.
    Point {
        /// Where it is.
        position: DVec3,
        /// E on a surface that faces it at distance 1.
        intensity: Rgb,
    },
    /// E = irradiance · cos θ, with a shadow ray.
    Directional {
        /// Unit vector from the surface towards the light.
        towards: DVec3,
        /// E on a surface that faces it.
        irradiance: Rgb,
    },
}

/// What number a study is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Channel {
    /// Rec. 709 luminance of linear RGB.
    #[default]
    Luminance,
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
}

impl Channel {
    /// Weights of R, G and B.
    pub fn weights(self) -> Rgb {
        match self {
            Self::Luminance => [0.2126, 0.7152, 0.0722],
            Self::R => [1.0, 0.0, 0.0],
            Self::G => [0.0, 1.0, 0.0],
            Self::B => [0.0, 0.0, 1.0],
        }
    }

    /// The channel's value of a colour.
    pub fn of(self, rgb: Rgb) -> f64 {
        let w = self.weights();
        w[0] * rgb[0] + w[1] * rgb[1] + w[2] * rgb[2]
    }
}
