//! Scene files.

use super::library::{self, Model, SCENES};
use super::light_table::{LightTables, Lights};
use super::obj;
use super::text::{document, shown};
use super::{
    Aperture, AreaLight, Camera, Distribution, Filter, FilterMethod, FilterShape, Lens, Light,
    LightShape, MAX_COORDINATE, Motion, Rgb, Scene, SceneError,
};
use crate::input::{self, Open};
use glam::DVec3;
use serde::Deserialize;
use std::cell::RefCell;
use std::collections::HashSet;
use std::path::Path;

/// A scene from a `.toml` or `.obj` file, or a built-in one by name ([`SCENES`]).
///
/// A bare OBJ gets a camera that frames its bounds at 256 × 256 pixels, and a headlight.
///
/// # Errors
/// [`SceneError`] names the file, what is wrong with it, and the way out.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    load_from(spec, &input::from_disk)
}

/// The same with files that `open` gives.
///
/// # Errors
/// As [`load`].
pub fn load_from(spec: &str, open: Open<'_>) -> Result<Scene, SceneError> {
    let files = RefCell::new(Vec::<String>::new());
    let open: Open<'_> = &|path: &Path| {
        let opened = open(path)?;
        let (mut files, name) = (files.borrow_mut(), shown(path));
        if !files.contains(&name) {
            files.push(name);
        }
        Ok(opened)
    };
    let scene = read(spec, open)?;
    Ok(Scene { files: files.take(), ..scene })
}

fn read(spec: &str, open: Open<'_>) -> Result<Scene, SceneError> {
    let path = Path::new(spec);
    if let Some(scene) = SCENES.iter().find(|scene| scene.name == spec) {
        return from_toml(scene.name, scene.toml, path, open);
    }
    let name = path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    match path.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
        Some("toml") => from_toml(&name, &document(open, path)?, path, open),
        Some("obj") => from_obj(&name, path, open),
        _ => {
            let known = SCENES.iter().map(|s| s.name).collect::<Vec<_>>().join(", ");
            Err(SceneError::UnknownScene { name: spec.to_owned(), known })
        }
    }
}

/// Most meshes of a scene.
const MAX_MESHES: usize = 1000;

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
    light: LightTables,
    lens: Option<LensTable>,
    shutter: Option<ShutterTable>,
    filter: Option<FilterTable>,
    #[serde(default)]
    paths: PathsTable,
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
    /// How far the mesh moves while the shutter is open.
    motion: Option<[f64; 3]>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct BackgroundTable {
    radiance: Rgb,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LensTable {
    radius: f64,
    focus_distance: f64,
    /// Corners of the aperture; a disk without it.
    blades: Option<u32>,
    #[serde(default)]
    rotation: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ShutterTable {
    #[serde(default)]
    camera_motion: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FilterTable {
    kind: FilterShape,
    radius: Option<f64>,
    #[serde(default)]
    method: FilterMethod,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct PathsTable {
    specular_depth: u32,
    bounces: u32,
}

fn from_toml(name: &str, text: &str, path: &Path, open: Open<'_>) -> Result<Scene, SceneError> {
    let file: SceneFile = toml::from_str(text).map_err(|e| {
        let start = e.span().map_or(0, |span| span.start);
        let line = 1 + text.bytes().take(start).filter(|b| *b == b'\n').count();
        let fault = e.message().replace('\n', ", ").replace("u32", "a whole number of at least 0");
        let fault = format!("{fault}{}", way_out(&fault));
        SceneError::SceneFile { path: shown(path), line, fault }
    })?;
    let CameraTable { eye, look_at, up, fov_y, resolution } = file.camera;
    let [eye, look_at, up] = [eye, look_at, up].map(DVec3::from_array);
    let camera = Camera { eye, look_at, up, fov_y, resolution };
    camera.check().map_err(|fault| SceneError::Camera { path: shown(path), fault })?;
    let background = colour(path, "background radiance", file.background.radiance)?;
    let mut notes = Vec::new();
    let mut model = Model::default();
    let mut moved = Vec::new();
    check_meshes(path, &file.mesh)?;
    for table in &file.mesh {
        let part = table.read(path, open, file.shading == Shading::Smooth, &mut notes)?;
        let fits = |a: usize, b: usize| u32::try_from(a + b).is_ok();
        if !fits(model.mesh.positions.len(), part.mesh.positions.len())
            || !fits(model.mesh.triangles.len(), part.mesh.triangles.len())
        {
            return Err(SceneError::TooLarge { path: shown(path) });
        }
        let motion = vector(path, "mesh motion", table.motion.unwrap_or_default())?;
        moved.resize(moved.len() + part.mesh.positions.len(), motion);
        model.append(part);
    }
    if model.mesh.triangles.is_empty() {
        let fault = "there is no [[mesh]]; name at least one".to_owned();
        return Err(SceneError::Feature { path: shown(path), fault });
    }
    note_degenerate(&model, &mut notes);
    let Lights { light, area, ambient } = file.light.read(path, &model)?;
    refuse_moving_lights(path, &area, &model, &moved)?;
    let distribution = Distribution {
        lens: file.lens.map(|table| table.read(path)).transpose()?,
        lights: area,
        motion: motion(path, file.shutter, moved, &mut notes)?,
        specular_depth: file.paths.specular_depth,
        bounces: file.paths.bounces,
    };
    file.paths.check(path)?;
    let filter = file.filter.map(|table| table.read(path)).transpose()?;
    let Model { mesh, materials } = model;
    let name = name.to_owned();
    Ok(Scene {
        name,
        camera,
        mesh,
        materials,
        light,
        distribution,
        filter,
        ambient,
        background,
        files: Vec::new(),
        notes,
    })
}

/// What a key that is missing should say; empty for other faults.
fn way_out(fault: &str) -> &'static str {
    match fault.strip_prefix("missing field ") {
        Some("`kind`") => {
            "; a light is a headlight, point, directional or area, a filter a box, tent, \
             gaussian, mitchell or lanczos"
        }
        Some("`shape`") => "; an area light is a rectangle, disk, sphere or mesh",
        Some("`radius`") => "; half the width of the lens's opening",
        Some("`focus_distance`") => "; how far from the eye, along the view, all is sharp",
        Some("`camera`") => "; a [camera] has eye, look_at, fov_y and resolution",
        Some("`mesh`") => "; name at least one [[mesh]] by its path or as a builtin",
        Some("`position`" | "`intensity`") => "; a point light has position and intensity",
        Some("`towards`" | "`irradiance`") => "; a directional light has towards and irradiance",
        _ => "",
    }
}

/// A few lines must not ask for triangles without end.
fn check_meshes(file: &Path, tables: &[MeshTable]) -> Result<(), SceneError> {
    let fault = |fault: String| Err(SceneError::Feature { path: shown(file), fault });
    if tables.len() > MAX_MESHES {
        return fault(format!(
            "there are {} meshes; a scene has at most {MAX_MESHES}: join some in one OBJ",
            tables.len()
        ));
    }
    let mut seen = HashSet::new();
    let place = |table: &MeshTable| table.motion.map(|motion| motion.map(f64::to_bits));
    match tables.iter().find(|&table| !seen.insert((&table.path, &table.builtin, place(table)))) {
        Some(MeshTable { path, builtin, .. }) if path.is_some() != builtin.is_some() => {
            let name = path.as_ref().or(builtin.as_ref()).map_or("", String::as_str);
            fault(format!(
                "the mesh \"{name}\" stands there twice, in the same place; name it once"
            ))
        }
        _ => Ok(()),
    }
}

/// A mesh light is sampled where it was loaded.
fn refuse_moving_lights(
    file: &Path,
    lights: &[AreaLight],
    model: &Model,
    moved: &[DVec3],
) -> Result<(), SceneError> {
    let moves =
        |id: usize| model.mesh.triangles[id].iter().any(|i| moved[*i as usize] != DVec3::ZERO);
    for light in lights {
        let LightShape::Mesh { material, .. } = &light.shape else { continue };
        let is_lit = |id: usize| model.mesh.materials[id] == *material;
        if (0..model.mesh.triangles.len()).any(|id| is_lit(id) && moves(id)) {
            let name = &model.materials[*material as usize].name;
            let fault = format!(
                "the mesh light \"{name}\" is part of a mesh that moves; lights stand still: give \
                 them a [[mesh]] without motion"
            );
            return Err(SceneError::Feature { path: shown(file), fault });
        }
    }
    Ok(())
}

/// What moves; nothing, and a note, for a shutter before which all stands still.
fn motion(
    file: &Path,
    shutter: Option<ShutterTable>,
    vertices: Vec<DVec3>,
    notes: &mut Vec<String>,
) -> Result<Option<Motion>, SceneError> {
    let meshes_move = vertices.iter().any(|v| *v != DVec3::ZERO);
    let Some(ShutterTable { camera_motion }) = shutter else {
        if meshes_move {
            let fault = "a [[mesh]] has motion but the scene no [shutter]; add one".to_owned();
            return Err(SceneError::Feature { path: shown(file), fault });
        }
        return Ok(None);
    };
    let camera = vector(file, "shutter camera_motion", camera_motion)?;
    if camera == DVec3::ZERO && !meshes_move {
        notes.push("nothing moves while the [shutter] is open: it adds no dimension".to_owned());
        return Ok(None);
    }
    Ok(Some(Motion { camera, vertices }))
}

impl LensTable {
    fn read(self, file: &Path) -> Result<Lens, SceneError> {
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
    fn read(self, file: &Path) -> Result<Filter, SceneError> {
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
    fn check(&self, file: &Path) -> Result<(), SceneError> {
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
    fn read(
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

fn from_obj(name: &str, path: &Path, open: Open<'_>) -> Result<Scene, SceneError> {
    let mut notes = Vec::new();
    let model = obj::read(open, path, false, &mut notes)?;
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
        distribution: Distribution::default(),
        filter: None,
        ambient: [0.0; 3],
        background: [0.0; 3],
        files: Vec::new(),
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
