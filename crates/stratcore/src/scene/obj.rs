//! OBJ meshes and their MTL materials.
//!
//! tobj groups and triangulates. The text is checked line by line before tobj sees it, because
//! tobj names no lines and panics on some of what people's files contain; what we do not use
//! (texture coordinates, names, lines, curves) never reaches it.

use super::library::Model;
use super::text::{Lines, shown};
use super::{MAX_COORDINATE, Material, Rgb, SceneError, Specular};
use crate::input::Open;
use glam::DVec3;
use std::collections::HashMap;
use std::fmt::Write;
use std::io;
use std::path::{Path, PathBuf};

/// Kd where no material says otherwise.
const DEFAULT_KD: f64 = 0.8;

/// Most MTL files that an OBJ file may name: each is read.
const MAX_LIBRARIES: usize = 1000;

/// Reads an OBJ file and the MTL files it names. Polygons become fans of triangles in the
/// file's order. `smooth` asks for the file's normals. What had to be assumed goes to `notes`.
pub(super) fn read(
    open: Open<'_>,
    path: &Path,
    smooth: bool,
    notes: &mut Vec<String>,
) -> Result<Model, SceneError> {
    let checked = Checked::obj(open, path, notes)?;
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let library = |name: &Path| {
        let text = checked.libraries.get(name).map_or("", String::as_str);
        tobj::load_mtl_buf(&mut text.as_bytes())
    };
    let refused =
        |e: tobj::LoadError| SceneError::Refused { path: shown(path), fault: e.to_string() };
    let (parts, materials) =
        tobj::load_obj_buf(&mut checked.text.as_bytes(), &options, library).map_err(refused)?;
    let mut model = Model {
        materials: materials.map_err(refused)?.iter().map(material).collect(),
        ..Default::default()
    };
    let unnamed = model.materials.len() as u32;
    let mut normals = Vec::new();
    for part in &parts {
        add_part(&mut model, &part.mesh, unnamed, &mut normals);
    }
    if model.mesh.triangles.is_empty() {
        return Err(SceneError::Empty { path: shown(path) });
    }
    let fits = |len: usize| u32::try_from(len).is_ok();
    if !fits(model.mesh.positions.len()) || !fits(model.mesh.triangles.len()) {
        return Err(SceneError::TooLarge { path: shown(path) });
    }
    let grey = model.mesh.materials.iter().filter(|m| **m == unnamed).count();
    if grey > 0 {
        let [name, kd] = ["default".to_owned(), DEFAULT_KD.to_string()];
        if checked.names_materials {
            let path = path.display();
            notes.push(format!("{path}: {grey} triangles without a material get Kd {kd}"));
        }
        model.materials.push(Material { name, kd: [DEFAULT_KD; 3], ..Material::default() });
    }
    if smooth && checked.faces_with_normals > 0 {
        if let Some(line) = checked.face_without_normals {
            let fault = "this face has no normals but others have; give all of them normals, or \
                         use shading = \"flat\"";
            return Err(SceneError::Line { path: shown(path), line, fault: fault.to_owned() });
        }
        for (id, corners) in normals.iter_mut().enumerate() {
            let plane = model.mesh.area_normal(id).normalize_or(DVec3::Y);
            *corners = corners.map(|n| n.normalize_or(plane));
        }
        model.mesh.corner_normals = Some(normals);
    }
    Ok(model)
}

fn add_part(model: &mut Model, part: &tobj::Mesh, unnamed: u32, normals: &mut Vec<[DVec3; 3]>) {
    let base = model.mesh.positions.len() as u32;
    let points =
        |flat: &[f64]| -> Vec<DVec3> { flat.chunks_exact(3).map(DVec3::from_slice).collect() };
    let mut positions = points(&part.positions);
    let part_normals = points(&part.normals);
    let corners = |list: &[u32], at: usize| [list[at], list[at + 1], list[at + 2]];
    for at in (0..part.indices.len() / 3).map(|triangle| 3 * triangle) {
        model.mesh.triangles.push(corners(&part.indices, at).map(|i| base + i));
        if !part_normals.is_empty() {
            normals.push(corners(&part.normal_indices, at).map(|i| part_normals[i as usize]));
        }
    }
    model.mesh.positions.append(&mut positions);
    let material = part.material_id.map_or(unnamed, |id| id as u32);
    model.mesh.materials.resize(model.mesh.triangles.len(), material);
}

fn material(m: &tobj::Material) -> Material {
    Material {
        name: m.name.clone(),
        kd: m.diffuse.unwrap_or([DEFAULT_KD; 3]),
        ke: m.emissive.unwrap_or([0.0; 3]),
        specular: specular(m),
    }
}

/// By the material's `illum`: 3 and 5 are mirrors of reflectance Ks; 4, 6 and 7 are glass of
/// index Ni and filter Tf.
fn specular(m: &tobj::Material) -> Specular {
    const GLASS_INDEX: f64 = 1.5;
    match m.illumination_model {
        Some(3 | 5) => Specular::Mirror { reflectance: m.specular.unwrap_or([1.0; 3]) },
        Some(4 | 6 | 7) => {
            let filter = m.unknown_param.get("Tf").and_then(|tf| colour("Tf", tf).ok());
            Specular::Glass {
                index: m.optical_density.unwrap_or(GLASS_INDEX),
                transmittance: filter.unwrap_or([1.0; 3]),
            }
        }
        _ => Specular::None,
    }
}

/// An OBJ file's text, reduced to what we use and known to be sound.
#[derive(Default)]
struct Checked {
    text: String,
    /// Reduced text of each MTL file, by the name that the OBJ file calls it.
    libraries: HashMap<PathBuf, String>,
    names_materials: bool,
    faces_with_normals: usize,
    face_without_normals: Option<usize>,
}

impl Checked {
    /// In two passes, since a face may name vertices that come later: the file, however large,
    /// is never held whole.
    fn obj(open: Open<'_>, path: &Path, notes: &mut Vec<String>) -> Result<Self, SceneError> {
        let mut totals = [0, 0];
        let mut lines = Lines::open(open, path)?;
        while let Some((_, line)) = lines.next_line()? {
            match keyword(&line).0 {
                "v" => totals[0] += 1,
                "vn" => totals[1] += 1,
                _ => {}
            }
        }
        let mut seen = [0, 0];
        let mut checked = Self::default();
        let mut lines = Lines::open(open, path)?;
        while let Some((number, line)) = lines.next_line()? {
            let (key, rest) = keyword(&line);
            let at_line = |fault| SceneError::Line { path: shown(path), line: number, fault };
            match key {
                "v" => {
                    seen[0] += 1;
                    let position = position(rest).map_err(at_line)?;
                    checked.numbers("v", position);
                }
                "vn" => {
                    seen[1] += 1;
                    let normal = three_numbers(rest, MAX_COORDINATE).map_err(at_line)?;
                    checked.numbers("vn", normal);
                }
                "f" => checked.face(rest, number, seen, totals).map_err(at_line)?,
                "usemtl" if !rest.is_empty() => {
                    checked.names_materials = true;
                    checked.text += &format!("usemtl {rest}\n");
                }
                // Named again, it says nothing new.
                "mtllib" if !checked.libraries.contains_key(Path::new(rest)) => {
                    if checked.libraries.len() == MAX_LIBRARIES {
                        let fault = format!(
                            "more than {MAX_LIBRARIES} material libraries; join them in one MTL file"
                        );
                        return Err(at_line(fault));
                    }
                    checked.text += &format!("mtllib {rest}\n");
                    let text = checked_mtl(open, &path.with_file_name(rest), notes)?;
                    checked.libraries.insert(PathBuf::from(rest), text);
                }
                _ => {}
            }
        }
        Ok(checked)
    }

    fn numbers(&mut self, key: &str, [x, y, z]: [f64; 3]) {
        // Writing to a String cannot fail. `{:e}` is the shortest text that reads back exactly.
        let _ = writeln!(self.text, "{key} {x:e} {y:e} {z:e}");
    }

    /// Copies a face without its texture coordinates, all indices counted from the start.
    fn face(
        &mut self,
        words: &str,
        line: usize,
        seen: [usize; 2],
        totals: [usize; 2],
    ) -> Result<(), String> {
        let corners = words.split_whitespace().count();
        if corners < 3 {
            return Err(format!("a face has {corners} vertices; it needs at least 3"));
        }
        self.text.push('f');
        let mut has_normals = true;
        for word in words.split_whitespace() {
            let mut parts = word.split('/');
            let vertex = parts.next().unwrap_or_default();
            let vertex = index(vertex, "vertex", seen[0], totals[0])?;
            match parts.nth(1).filter(|normal| !normal.is_empty()) {
                Some(normal) => {
                    let normal = index(normal, "normal", seen[1], totals[1])?;
                    let _ = write!(self.text, " {vertex}//{normal}");
                }
                None => {
                    has_normals = false;
                    let _ = write!(self.text, " {vertex}");
                }
            }
        }
        self.text.push('\n');
        if has_normals {
            self.faces_with_normals += 1;
        } else {
            self.face_without_normals.get_or_insert(line);
        }
        Ok(())
    }
}

/// The lines of an MTL file that we use. A file that is not there leaves a note and no lines.
fn checked_mtl(open: Open<'_>, path: &Path, notes: &mut Vec<String>) -> Result<String, SceneError> {
    let is_missing = |found: &io::Result<_>| {
        found.as_ref().is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
    };
    let found = open(path);
    if is_missing(&found) {
        notes.push(format!("{} is missing: its materials get Kd {DEFAULT_KD}", path.display()));
        return Ok(String::new());
    }
    let mut lines = Lines::new(found, path)?;
    let (mut checked, mut textures) = (String::new(), 0);
    while let Some((number, line)) = lines.next_line()? {
        let at_line = |fault| SceneError::Line { path: shown(path), line: number, fault };
        match keyword(&line) {
            ("newmtl", "") => return Err(at_line("a material needs a name".to_owned())),
            ("newmtl", name) => checked += &format!("newmtl {name}\n"),
            (key @ ("Kd" | "Ke" | "Ks" | "Tf"), rest) => {
                let [r, g, b] = colour(key, rest).map_err(at_line)?;
                checked += &format!("{key} {r:e} {g:e} {b:e}\n");
            }
            ("Ni", rest) => {
                let index = self::number(rest, 1e3).map_err(at_line)?;
                if index <= 0.0 {
                    return Err(at_line(format!("refractive index {index} is not above 0")));
                }
                checked += &format!("Ni {index:e}\n");
            }
            ("illum", rest) => {
                let model = rest.parse::<u8>().map_err(|_| {
                    at_line(format!("illum \"{rest}\" is not a whole number from 0 to 10"))
                })?;
                checked += &format!("illum {model}\n");
            }
            (key, _) => textures += usize::from(key.starts_with("map_")),
        }
    }
    if textures > 0 {
        let path = path.display();
        notes.push(format!("{path}: {textures} textures are not read; colours are those of Kd"));
    }
    Ok(checked)
}

fn keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (key, rest.trim())
}

fn number(word: &str, largest: f64) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(x) if x.abs() <= largest => Ok(x),
        Ok(x) => Err(format!("{x} is not a number within ±{largest:e}")),
        Err(_) => Err(format!("\"{word}\" is not a number")),
    }
}

fn three_numbers(words: &str, largest: f64) -> Result<[f64; 3], String> {
    let found: Vec<f64> =
        words.split_whitespace().map(|w| number(w, largest)).collect::<Result<_, _>>()?;
    found.try_into().map_err(|_| format!("\"{words}\" should be three numbers"))
}

fn colour(key: &str, words: &str) -> Result<Rgb, String> {
    let rgb = three_numbers(words, f64::MAX)?;
    let is_negative = rgb.iter().any(|x| *x < 0.0);
    if is_negative { Err(format!("{key} is negative; colours are 0 or more")) } else { Ok(rgb) }
}

/// x y z, then nothing, a weight w that divides them, or a colour, which we do not use.
fn position(words: &str) -> Result<[f64; 3], String> {
    let found: Vec<f64> =
        words.split_whitespace().map(|w| number(w, MAX_COORDINATE)).collect::<Result<_, _>>()?;
    match found[..] {
        [x, y, z] | [x, y, z, _, _, _] | [x, y, z, _, _, _, _] => Ok([x, y, z]),
        [x, y, z, w] => {
            let p = [x / w, y / w, z / w];
            let fits = p.iter().all(|x| x.abs() <= MAX_COORDINATE);
            fits.then_some(p).ok_or_else(|| format!("weight {w} sends the vertex to infinity"))
        }
        _ => Err(format!("\"{words}\" should be three numbers")),
    }
}

/// An index counted from the start (1 is the first) or, if negative, back from the last seen.
fn index(word: &str, what: &str, seen: usize, total: usize) -> Result<i64, String> {
    let given: i64 = word.parse().map_err(|_| format!("\"{word}\" is not a {what} index"))?;
    let absolute = if given < 0 { given.saturating_add(seen as i64 + 1) } else { given };
    if (1..=total as i64).contains(&absolute) {
        return Ok(absolute);
    }
    let kind = if what == "normal" { "normals" } else { "vertices" };
    Err(format!("{what} index {given} is out of range: there are {total} {kind}, the first is 1"))
}
