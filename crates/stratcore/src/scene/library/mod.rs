//! Scenes and shapes that are made by code: the same triangles on every run, and on every
//! machine but for the last bit of its sines and powers.

mod build;
mod classic;
mod edges;
mod grass;
mod shapes;

pub use shapes::{cube, icosphere, torus};

use super::{Material, Mesh};

/// A mesh with the materials its triangles name.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// The triangles.
    pub mesh: Mesh,
    /// What [`Mesh::materials`] indexes.
    pub materials: Vec<Material>,
}

/// A scene that comes with the library.
#[derive(Debug, Clone, Copy)]
pub struct BuiltIn {
    /// As typed instead of a path.
    pub name: &'static str,
    /// One line of help.
    pub summary: &'static str,
    /// Its scene file.
    pub(super) toml: &'static str,
}

/// Every built-in scene, in the order in which they are listed.
pub const SCENES: &[BuiltIn] = &[
    BuiltIn {
        name: "classic",
        summary: "spheres, boxes and a ring on a checkerboard that runs to the horizon",
        toml: include_str!("../../../../../assets/classic.toml"),
    },
    BuiltIn {
        name: "classic-shadows",
        summary: "the same under a point light with shadows",
        toml: include_str!("../../../../../assets/classic-shadows.toml"),
    },
    BuiltIn {
        name: "grass",
        summary: "a meadow of 375,000 thin blades",
        toml: include_str!("../../../../../assets/grass.toml"),
    },
    BuiltIn {
        name: "edges",
        summary: "a target whose pixels have known convergence",
        toml: include_str!("../../../../../assets/edges.toml"),
    },
];

/// Names of the meshes made by code (`builtin = "classic"` in a scene file).
pub const MODELS: &[&str] = &["classic", "grass", "edges"];

/// The mesh of this name; none if it is not in [`MODELS`].
pub fn model(name: &str) -> Option<Model> {
    match name {
        "classic" => Some(classic::model()),
        "grass" => Some(grass::model()),
        "edges" => Some(edges::model()),
        _ => None,
    }
}
