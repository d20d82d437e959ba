//! Scene files.

use super::library::{self, Model, SCENES};
use super::obj::{self, read_text, shown};
use super::{Camera, Light, MAX_COORDINATE, Rgb, Scene, SceneError};
use glam::DVec3;
use serde::Deserialize;
use std::path::Path;

/// A scene from a `.toml` or `.obj` file, or a built-in one by name ([`SCENES`]).
///
/// A bare OBJ gets a camera that frames its bounds at 256 × 256 pixels, and a headlight.
///
/// # Errors
/// [`SceneError`] names the file, what is wrong with it, and the way out.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    if let Some(scene) = SCENES.iter().find(|scene| scene.name == spec) {
        return from_toml(scene.name, scene.toml, Path::new(spec));
    }
    let path = Path::new(spec);
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
        Some("toml") => from_toml(&name, &read_text(path)?, path),
        Some("obj") => from_obj(&name, path),
        _ => {
            let known = SCENES.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
            Err(SceneError::UnknownScene { name: spec.to_owned(), known })
        }
    }
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

#[derive(Deserialize, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Shading {
    #[default]
    Flat,
    Smooth,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MeshTable {
    path: Option<String>,
    builtin: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct BackgroundTable {
    radiance: Rgb,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, tag = "kind", rename_all = "lowercase")]
enum LightTable {
    Headlight {
        #[serde(default)]
        ambient: Rgb,
    },
    Point {
        position: [f64; 3],
        intensity: Rgb,
        #[serde(default)]
        ambient: Rgb,
    },
    Directional {
        towards: [f64; 3],
        irradiance: Rgb,
        #[serde(default)]
        ambient: Rgb,
    },
}

impl Default for LightTable {
    fn default() -> Self {
        Self::Headlight { ambient: [0.0; 3] }
    }
}

fn from_toml(name: &str, text: &str, path: &Path) -> Result<Scene, SceneError> {
    let file: SceneFile = toml::from_str(text).map_err(|e| {
        let start = e.span().map_or(0, |span| span.start);
        let line = 1 + text.bytes().take(start).filter(|b| *b == b'\n').count();
        SceneError::SceneFile { path: shown(path), line, fault: e.message().replace('\n', ", ") }
    })?;
    let CameraTable { eye, look_at, up, fov_y, resolution } = file.camera;
    let [eye, look_at, up] = [eye, look_at, up].map(DVec3::from_array);
    let camera = Camera { eye, look_at, up, fov_y, resolution };
    camera.check().map_err(|fault| SceneError::Camera { path: shown(path), fault })?;
    let (light, ambient) = file.light.read(path)?;
    let background = colour(path, "background radiance", file.background.radiance)?;
    let mut notes = Vec::new();
    let mut model = Model::default();
    for table in &file.mesh {
        let part = table.read(path, file.shading == Shading::Smooth, &mut notes)?;
        let fits = |a: usize, b: usize| u32::try_from(a + b).is_ok();
        if !fits(model.mesh.positions.len(), part.mesh.positions.len())
            || !fits(model.mesh.triangles.len(), part.mesh.triangles.len())
        {
            return Err(SceneError::TooLarge { path: shown(path) });
        }
        model.append(part);
    }
    if model.mesh.triangles.is_empty() {
        let fault = "there is no [[mesh]]; name at least one".to_owned();
        return Err(SceneError::MeshTable { path: shown(path), fault });
    }
    note_degenerate(&model, &mut notes);
    let Model { mesh, materials } = model;
    let name = name.to_owned();
    Ok(Scene { name, camera, mesh, materials, light, ambient, background, notes })
}

impl MeshTable {
    fn read(
        &self,
        file: &Path,
        smooth: bool,
        notes: &mut Vec<String>,
    ) -> Result<Model, SceneError> {
        let fault = match (&self.path, &self.builtin) {
            (Some(path), None) => return obj::read(&file.with_file_name(path), smooth, notes),
            (None, Some(name)) => match library::model(name) {
                Some(mut model) => {
                    if !smooth {
                        model.mesh.corner_normals = None;
                    }
                    return Ok(model);
                }
                None => {
                    let known = library::MODELS.join(", ");
                    format!("no built-in mesh is called \"{name}\"; there are {known}")
                }
            },
            _ => "each [[mesh]] has either a path or a builtin".to_owned(),
        };
        Err(SceneError::MeshTable { path: shown(file), fault })
    }
}

impl LightTable {
    fn read(self, file: &Path) -> Result<(Light, Rgb), SceneError> {
        let (light, ambient) = match self {
            Self::Headlight { ambient } => (Light::Headlight, ambient),
            Self::Point { position, intensity, ambient } => {
                let intensity = colour(file, "light intensity", intensity)?;
                let position = vector(file, "light position", position)?;
                (Light::Point { position, intensity }, ambient)
            }
            Self::Directional { towards, irradiance, ambient } => {
                let irradiance = colour(file, "light irradiance", irradiance)?;
                let direction = vector(file, "light towards", towards)?.try_normalize();
                let towards = direction.ok_or_else(|| SceneError::Value {
                    path: shown(file),
                    name: "light towards",
                    value: towards,
                    wanted: "it points from the scene to the light and is not zero",
                })?;
                (Light::Directional { towards, irradiance }, ambient)
            }
        };
        Ok((light, colour(file, "light ambient", ambient)?))
    }
}

fn colour(file: &Path, name: &'static str, value: Rgb) -> Result<Rgb, SceneError> {
    let is_colour = value.iter().all(|x| (0.0..f64::INFINITY).contains(x));
    let wanted = "colours are three finite numbers of at least 0";
    let path = shown(file);
    is_colour.then_some(value).ok_or(SceneError::Value { path, name, value, wanted })
}

fn vector(file: &Path, name: &'static str, value: [f64; 3]) -> Result<DVec3, SceneError> {
    let is_vector = value.iter().all(|x| x.abs() <= MAX_COORDINATE);
    let wanted = "coordinates are numbers within ±1e15";
    let path = shown(file);
    let value_if_sound = is_vector.then(|| DVec3::from_array(value));
    value_if_sound.ok_or(SceneError::Value { path, name, value, wanted })
}

fn from_obj(name: &str, path: &Path) -> Result<Scene, SceneError> {
    let mut notes = Vec::new();
    let model = obj::read(path, false, &mut notes)?;
    note_degenerate(&model, &mut notes);
    let Model { mesh, materials } = model;
    let camera = framing(&mesh.positions);
    camera.check().map_err(|fault| SceneError::Camera { path: shown(path), fault })?;
    Ok(Scene {
        name: name.to_owned(),
        camera,
        mesh,
        materials,
        light: Light::Headlight,
        ambient: [0.0; 3],
        background: [0.0; 3],
        notes,
    })
}

/// A camera that sees the whole bounding sphere of the points' box, from the front, a little to
/// the right and above.
fn framing(points: &[DVec3]) -> Camera {
    const FOV_Y: f64 = 45.0;
    const MARGIN: f64 = 1.05;
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let look_at = low.midpoint(high);
    let distance = MARGIN * low.distance(look_at) / (FOV_Y.to_radians() / 2.0).sin();
    let eye = look_at + DVec3::new(0.4, 0.35, 1.0).normalize() * distance;
    Camera { eye, look_at, up: DVec3::Y, fov_y: FOV_Y, resolution: [256, 256] }
}

fn note_degenerate(model: &Model, notes: &mut Vec<String>) {
    let flat = (0..model.mesh.triangles.len())
        .filter(|id| model.mesh.area_normal(*id) == DVec3::ZERO)
        .count();
    if flat > 0 {
        notes.push(format!("{flat} triangles have no area and are never seen"));
    }
}
