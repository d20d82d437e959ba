//! Scenes and shapes that are made by code: the same triangles on every run, and on every
//! machine but for the last bit of its sines and powers.

mod build;
mod classic;
mod edges;
mod grass;
mod room;
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
    BuiltIn {
        name: "edges-mitchell",
        summary: "the target under the filter of Mitchell and Netravali, four pixels wide",
        toml: include_str!("../../../../../assets/edges-mitchell.toml"),
    },
    BuiltIn {
        name: "classic-mirrors",
        summary: "classic's balls and ring as mirrors, under a point light with shadows",
        toml: include_str!("../../../../../assets/classic-mirrors.toml"),
    },
    BuiltIn {
        name: "room",
        summary: "a block and a ball in a box under a square lamp: soft shadows, d = 4",
        toml: include_str!("../../../../../assets/room.toml"),
    },
    BuiltIn {
        name: "room-lens",
        summary: "the room through a lens: d = 6",
        toml: include_str!("../../../../../assets/room-lens.toml"),
    },
    BuiltIn {
        name: "room-motion",
        summary: "the room with its ball rolling: d = 5",
        toml: include_str!("../../../../../assets/room-motion.toml"),
    },
    BuiltIn {
        name: "room-all",
        summary: "the room through a lens, its ball rolling: d = 7",
        toml: include_str!("../../../../../assets/room-all.toml"),
    },
    BuiltIn {
        name: "room-bounce",
        summary: "the room with two diffuse reflections and a ball of glass: d = 8",
        toml: include_str!("../../../../../assets/room-bounce.toml"),
    },
    BuiltIn {
        name: "room-shapes",
        summary: "the room under a disk and a ball of light, six blades, the eye moving: d = 9",
        toml: include_str!("../../../../../assets/room-shapes.toml"),
    },
    BuiltIn {
        name: "room-point",
        summary: "the room under a point of light: hard shadows, d = 2",
        toml: include_str!("../../../../../assets/room-point.toml"),
    },
    BuiltIn {
        name: "room-point-motion",
        summary: "the same with its ball rolling: d = 3",
        toml: include_str!("../../../../../assets/room-point-motion.toml"),
    },
    BuiltIn {
        name: "room-point-lens",
        summary: "the same through a lens, nothing moving: d = 4",
        toml: include_str!("../../../../../assets/room-point-lens.toml"),
    },
    BuiltIn {
        name: "room-point-lens-motion",
        summary: "the same through a lens, its ball rolling: d = 5",
        toml: include_str!("../../../../../assets/room-point-lens-motion.toml"),
    },
];

/// Names of the meshes made by code (`builtin = "classic"` in a scene file).
pub const MODELS: &[&str] =
    &["classic", "classic-mirrors", "grass", "edges", "room", "room-ball", "room-glass-ball"];

/// The mesh of this name; none if it is not in [`MODELS`].
pub fn model(name: &str) -> Option<Model> {
    match name {
        "classic" => Some(classic::model()),
        "grass" => Some(grass::model()),
        "edges" => Some(edges::model()),
        "classic-mirrors" => Some(classic::with_mirrors()),
        "room" => Some(room::room()),
        "room-ball" => Some(room::ball()),
        "room-glass-ball" => Some(room::glass_ball()),
        _ => None,
    }
}
