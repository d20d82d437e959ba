//! Scenes and shapes that are made by code: the same triangles on every machine and every run.

mod build;
mod classic;
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
pub const SCENES: &[BuiltIn] = &[BuiltIn {
    name: "classic",
    summary: "spheres and boxes on a checkerboard that runs to the horizon",
    toml: include_str!("../../../../../assets/classic.toml"),
}];

/// A procedural mesh by the name it has in a scene file (`builtin = "classic"`).
pub fn model(name: &str) -> Option<Model> {
    match name {
        "classic" => Some(classic::model()),
        _ => None,
    }
}

/// Names that [`model`] knows.
pub const MODELS: &[&str] = &["classic"];
