//! What can be wrong with a scene, each with its way out.

use super::camera::CameraFault;
use crate::input::MAX_LINE;

/// A scene that could not be loaded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Neither a scene file's name nor a built-in's.
    #[error(
        "no built-in scene is called \"{name}\"; there are {known}, and the names of files end \
         in .toml or .obj"
    )]
    UnknownScene {
        /// As typed.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A file that is not there or cannot be read.
    #[error("cannot read {path}: {fault}; check the path and its permissions")]
    Unreadable {
        /// The file.
        path: String,
        /// What the system said.
        fault: String,
    },
    /// A scene file that does not say what a scene file says.
    #[error("{path}, line {line}: {fault}")]
    SceneFile {
        /// The file.
        path: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong, and what is possible instead.
        fault: String,
    },
    /// A camera that shows nothing.
    #[error("{path}: {fault}")]
    Camera {
        /// The file.
        path: String,
        /// What is wrong, and how to mend it.
        fault: CameraFault,
    },
    /// A mesh, light, lens or other feature that is not described as it should be.
    #[error("{path}: {fault}")]
    Feature {
        /// The file.
        path: String,
        /// What is wrong, and what is possible instead.
        fault: String,
    },
    /// A number that cannot be meant.
    #[error("{path}: {name} is {value:?}; {wanted}")]
    Value {
        /// The file.
        path: String,
        /// Table and key.
        name: &'static str,
        /// Its value.
        value: [f64; 3],
        /// What it may be.
        wanted: &'static str,
    },
    /// A line of an OBJ or MTL file that cannot be understood.
    #[error("{path}, line {line}: {fault}")]
    Line {
        /// The file.
        path: String,
        /// Line, from 1.
        line: usize,
        /// What is wrong, and what it should be.
        fault: String,
    },
    /// An OBJ or MTL file that its reader refuses as a whole.
    #[error("{path}: {fault}; export it again as a plain polygon OBJ")]
    Refused {
        /// The file.
        path: String,
        /// What the reader said.
        fault: String,
    },
    /// A file without a single triangle.
    #[error("{path} has no faces; a scene needs at least one triangle (lines starting with f)")]
    Empty {
        /// The file.
        path: String,
    },
    /// A line of an OBJ or MTL file that goes on and on.
    #[error(
        "{path}, line {line} is longer than {MAX_LINE} bytes; export it again as a plain polygon OBJ"
    )]
    LongLine {
        /// The file.
        path: String,
        /// Line, from 1.
        line: usize,
    },
    /// More vertices or triangles than 32 bits can count.
    #[error("{path} has more than 2^32 - 1 vertices or triangles; split the scene")]
    TooLarge {
        /// The file.
        path: String,
    },
}
