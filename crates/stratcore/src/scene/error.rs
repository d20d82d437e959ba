//! What can be wrong with a scene, each with its way out.

/// A scene that could not be loaded.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// Neither a scene file's name nor a built-in's.
    #[error(
        "no built-in scene is called \"{name}\"; there are {known}; files end in .toml or .obj"
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
    /// A file whose text is not what its name promises.
    #[error("{path}: {fault}")]
    Malformed {
        /// The file.
        path: String,
        /// What is wrong, where, and what to do.
        fault: String,
    },
}
