//! Scene files.

use super::library::{self, BuiltIn, MODELS, Model, SCENES};
use super::{Camera, Light, Rgb, Scene, SceneError};
use glam::DVec3;
use serde::Deserialize;
use std::path::Path;

/// A scene from a `.toml` or `.obj` file, or a built-in one by name ([`SCENES`]).
///
/// # Errors
/// [`SceneError`] names the file, what is wrong with it, and the way out.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    if let Some(BuiltIn { name, toml, .. }) = SCENES.iter().find(|s| s.name == spec) {
        return from_toml(name, toml, Path::new("."), spec);
    }
    let known = SCENES.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
    Err(SceneError::UnknownScene { name: spec.to_owned(), known })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    camera: CameraTable,
    #[serde(default)]
    shading: Shading,
    mesh: Vec<MeshTable>,
    #[serde(default)]
    background: BackgroundTable,
    #[serde(default)]
    light: LightTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraTable {
    eye: [f64; 3],
    look_at: [f64; 3],
    #[serde(default = "y_up")]
    up: [f64; 3],
    fov_y: f64,
    resolution: [u32; 2],
}

fn y_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

#[derive(Deserialize, Default, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Shading {
    #[default]
    Flat,
    Smooth,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshTable {
    builtin: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct BackgroundTable {
    radiance: Rgb,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, tag = "kind", rename_all = "lowercase")]
enum LightTable {
    #[default]
    Headlight,
}

fn from_toml(name: &str, text: &str, _folder: &Path, path: &str) -> Result<Scene, SceneError> {
    let malformed = |fault: String| SceneError::Malformed { path: path.to_owned(), fault };
    let file: SceneFile = toml::from_str(text).map_err(|e| malformed(e.to_string()))?;
    let mut model = Model::default();
    for table in &file.mesh {
        let builtin = table.builtin.as_deref().unwrap_or_default();
        let part = library::model(builtin).ok_or_else(|| {
            malformed(format!("no mesh is called \"{builtin}\"; there are {}", MODELS.join(", ")))
        })?;
        model = part;
    }
    let CameraTable { eye, look_at, up, fov_y, resolution } = file.camera;
    let [eye, look_at, up] = [eye, look_at, up].map(DVec3::from_array);
    let light = match file.light {
        LightTable::Headlight => Light::Headlight,
    };
    Ok(Scene {
        name: name.to_owned(),
        camera: Camera { eye, look_at, up, fov_y, resolution },
        mesh: model.mesh,
        materials: model.materials,
        light,
        ambient: [0.0; 3],
        background: file.background.radiance,
        notes: Vec::new(),
    })
}
