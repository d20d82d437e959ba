//! Scene files.

use super::library::{Model, SCENES};
use super::light_table::Lights;
use super::obj;
use super::tables::{MeshTable, SceneFile, Shading, ShutterTable, colour, vector};
use super::text::{document, shown};
use super::{AreaLight, Camera, Distribution, Light, LightShape, Motion, Scene, SceneError};
use crate::input::{self, Open};
use glam::DVec3;
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

fn from_toml(name: &str, text: &str, path: &Path, open: Open<'_>) -> Result<Scene, SceneError> {
    let file: SceneFile = toml::from_str(text).map_err(|e| {
        let start = e.span().map_or(0, |span| span.start);
        let line = 1 + text.bytes().take(start).filter(|b| *b == b'\n').count();
        let fault = e.message().replace('\n', ", ").replace("u32", "a whole number of at least 0");
        let fault = format!("{fault}{}", way_out(&fault));
        SceneError::SceneFile { path: shown(path), line, fault }
    })?;
    let camera = file.camera.read(path)?;
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

fn from_obj(name: &str, path: &Path, open: Open<'_>) -> Result<Scene, SceneError> {
    let mut notes = Vec::new();
    let model = obj::read(open, path, false, &mut notes)?;
    note_degenerate(&model, &mut notes);
    let Model { mesh, materials } = model;
    let camera = framing(&mesh.positions);
    camera.check().map_err(|fault| SceneError::Camera { path: shown(path), fault })?;
    let name = name.to_owned();
    Ok(Scene { name, notes, ..Scene::plain(mesh, materials, camera, Light::Headlight) })
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
