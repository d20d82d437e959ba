//! The tables of a scene file, but for its lights, and what each says when it is read.

use super::library::{self, Model};
use super::light_table::LightTables;
use super::text::shown;
use super::{
    Aperture, Camera, CameraFault, Distribution, Filter, FilterMethod, FilterShape, Lens,
    MAX_COORDINATE, Rgb, SceneError, obj,
};
use crate::input::Open;
use glam::DVec3;
use serde::Deserialize;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub camera: CameraTable,
    #[serde(default)]
    pub shading: Shading,
    pub mesh: Vec<MeshTable>,
    #[serde(default)]
    pub background: BackgroundTable,
    #[serde(default)]
    pub light: LightTables,
    pub lens: Option<LensTable>,
    pub shutter: Option<ShutterTable>,
    pub filter: Option<FilterTable>,
    #[serde(default)]
    pub paths: PathsTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    pub eye: [f64; 3],
    pub look_at: [f64; 3],
    #[serde(default = "y_up")]
    pub up: [f64; 3],
    pub fov_y: f64,
    pub resolution: [u32; 2],
}

impl CameraTable {
    pub fn read(self, file: &Path) -> Result<Camera, SceneError> {
        let Self { eye, look_at, up, fov_y, resolution } = self;
        let [eye, look_at, up] = [eye, look_at, up].map(DVec3::from_array);
        let camera = Camera { eye, look_at, up, fov_y, resolution };
        let fault = |fault: CameraFault| SceneError::Camera { path: shown(file), fault };
        camera.check().map_err(fault)?;
        Ok(camera)
    }
}

fn y_up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

#[derive(Deserialize, Default, Clone, Copy, PartialEq)]
#[serde(rename_all = "lowercase")]
pub(super) enum Shading {
    #[default]
    Flat,
    Smooth,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshTable {
    pub path: Option<String>,
    pub builtin: Option<String>,
    /// How far the mesh moves while the shutter is open.
    pub motion: Option<[f64; 3]>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct BackgroundTable {
    pub radiance: Rgb,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LensTable {
    pub radius: f64,
    pub focus_distance: f64,
    /// Corners of the aperture; a disk without it.
    pub blades: Option<u32>,
    #[serde(default)]
    pub rotation: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShutterTable {
    #[serde(default)]
    pub camera_motion: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilterTable {
    pub kind: FilterShape,
    pub radius: Option<f64>,
    #[serde(default)]
    pub method: FilterMethod,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct PathsTable {
    pub specular_depth: u32,
    pub bounces: u32,
}

impl LensTable {
    pub fn read(self, file: &Path) -> Result<Lens, SceneError> {
        let Self { radius, focus_distance, blades, rotation } = self;
        let fault = |fault: String| Err(SceneError::Feature { path: shown(file), fault });
        for (name, value) in [("radius", radius), ("focus_distance", focus_distance)] {
            if !(value > 0.0 && value <= MAX_COORDINATE) {
                return fault(format!("lens {name} is {value}; it lies above 0 and up to 1e15"));
            }
        }
        if rotation.is_nan() || rotation.abs() > 360.0 {
            return fault(format!("lens rotation is {rotation} degrees; it lies within ±360"));
        }
        let aperture = match blades {
            None => Aperture::Disk,
            Some(blades @ 3..=64) => Aperture::Blades { blades, rotation },
            Some(blades) => return fault(format!("lens has {blades} blades; it may have 3 to 64")),
        };
        Ok(Lens { radius, focus_distance, aperture })
    }
}

impl FilterTable {
    pub fn read(self, file: &Path) -> Result<Filter, SceneError> {
        const WIDEST: f64 = 64.0;
        let radius = self.radius.unwrap_or_else(|| self.kind.usual_radius());
        if !(radius > 0.0 && radius <= WIDEST) {
            let fault = format!("filter radius is {radius} pixels; it lies above 0 and up to 64");
            return Err(SceneError::Feature { path: shown(file), fault });
        }
        Ok(Filter::new(self.kind, radius, self.method))
    }
}

impl PathsTable {
    pub fn check(&self, file: &Path) -> Result<(), SceneError> {
        let limits = [
            ("specular_depth", self.specular_depth, Distribution::MAX_SPECULAR_DEPTH),
            ("bounces", self.bounces, Distribution::MAX_BOUNCES),
        ];
        match limits.into_iter().find(|(_, value, most)| value > most) {
            None => Ok(()),
            Some((name, value, most)) => {
                let fault = format!("paths {name} is {value}; it is at most {most}");
                Err(SceneError::Feature { path: shown(file), fault })
            }
        }
    }
}

impl MeshTable {
    pub fn read(
        &self,
        file: &Path,
        open: Open<'_>,
        smooth: bool,
        notes: &mut Vec<String>,
    ) -> Result<Model, SceneError> {
        let fault = match (&self.path, &self.builtin) {
            (Some(path), None) => {
                return obj::read(open, &file.with_file_name(path), smooth, notes);
            }
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
        Err(SceneError::Feature { path: shown(file), fault })
    }
}

pub(super) fn colour(file: &Path, name: &'static str, value: Rgb) -> Result<Rgb, SceneError> {
    let is_colour = value.iter().all(|x| (0.0..f64::INFINITY).contains(x));
    let wanted = "colours are three finite numbers of at least 0";
    let path = shown(file);
    is_colour.then_some(value).ok_or(SceneError::Value { path, name, value, wanted })
}

pub(super) fn vector(
    file: &Path,
    name: &'static str,
    value: [f64; 3],
) -> Result<DVec3, SceneError> {
    let is_vector = value.iter().all(|x| x.abs() <= MAX_COORDINATE);
    let wanted = "coordinates are numbers within ±1e15";
    let path = shown(file);
    let value_if_sound = is_vector.then(|| DVec3::from_array(value));
    value_if_sound.ok_or(SceneError::Value { path, name, value, wanted })
}
