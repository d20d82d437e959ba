//! `[light]`, or several as `[[light]]`.

use super::library::Model;
use super::tables::{colour, vector};
use super::text::shown;
use super::{AreaLight, Distribution, Light, LightShape, Rgb, SceneError};
use glam::DVec3;
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};
use std::path::Path;

/// What a scene file says of lights.
#[derive(Default)]
pub(super) struct LightTables(Vec<LightTable>);

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
    Area(AreaTable),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AreaTable {
    shape: Shape,
    radiance: Option<Rgb>,
    corner: Option<[f64; 3]>,
    edges: Option<[[f64; 3]; 2]>,
    centre: Option<[f64; 3]>,
    normal: Option<[f64; 3]>,
    radius: Option<f64>,
    material: Option<String>,
    #[serde(default)]
    ambient: Rgb,
}

#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "lowercase")]
enum Shape {
    Rectangle,
    Disk,
    Sphere,
    Mesh,
}

/// All lights of a scene.
pub(super) struct Lights {
    /// The one without an area; a headlight where nothing is said.
    pub light: Light,
    /// Those with one.
    pub area: Vec<AreaLight>,
    /// Sum over all.
    pub ambient: Rgb,
}

impl<'de> Deserialize<'de> for LightTables {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMore;
        impl<'de> Visitor<'de> for OneOrMore {
            type Value = LightTables;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("one [light] table or several [[light]] tables")
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<LightTables, A::Error> {
                let one = LightTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(LightTables(vec![one]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<LightTables, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(seq)).map(LightTables)
            }
        }
        deserializer.deserialize_any(OneOrMore)
    }
}

impl LightTables {
    /// The lights, with those that are meshes taken from `model`.
    pub fn read(self, file: &Path, model: &Model) -> Result<Lights, SceneError> {
        let mut lights = Lights { light: Light::Off, area: Vec::new(), ambient: [0.0; 3] };
        if self.0.is_empty() {
            lights.light = Light::Headlight;
        }
        for table in self.0 {
            let (light, ambient) = match table {
                LightTable::Headlight { ambient } => (Light::Headlight, ambient),
                LightTable::Point { position, intensity, ambient } => {
                    let intensity = colour(file, "light intensity", intensity)?;
                    let position = vector(file, "light position", position)?;
                    (Light::Point { position, intensity }, ambient)
                }
                LightTable::Directional { towards, irradiance, ambient } => {
                    let irradiance = colour(file, "light irradiance", irradiance)?;
                    let towards = direction(
                        file,
                        "light towards",
                        towards,
                        "it points from the scene to the light and is not zero",
                    )?;
                    (Light::Directional { towards, irradiance }, ambient)
                }
                LightTable::Area(table) => {
                    let ambient = table.ambient;
                    let light = table.read(file, model)?;
                    refuse_again(file, &light, &lights.area, model)?;
                    lights.area.push(light);
                    (Light::Off, ambient)
                }
            };
            if lights.area.len() > Distribution::MAX_LIGHTS {
                let most = Distribution::MAX_LIGHTS;
                let fault = format!("there are more than {most} area lights; a scene has no more");
                return Err(fault_of(file, &fault));
            }
            if light != Light::Off {
                if lights.light != Light::Off {
                    let fault = "there are two lights of kind headlight, point or directional; \
                                 keep one, and make others of kind area";
                    return Err(fault_of(file, fault));
                }
                lights.light = light;
            }
            let ambient = colour(file, "light ambient", ambient)?;
            lights.ambient = std::array::from_fn(|i| lights.ambient[i] + ambient[i]);
        }
        Ok(lights)
    }
}

/// The triangles of a material would be kept twice, and their light counted twice.
fn refuse_again(
    file: &Path,
    light: &AreaLight,
    before: &[AreaLight],
    model: &Model,
) -> Result<(), SceneError> {
    let LightShape::Mesh { material, .. } = light.shape else { return Ok(()) };
    let same = |other: &AreaLight| matches!(other.shape, LightShape::Mesh { material: named, .. } if named == material);
    if !before.iter().any(same) {
        return Ok(());
    }
    let name = &model.materials[material as usize].name;
    Err(fault_of(file, &format!("the mesh light \"{name}\" stands there twice; name it once")))
}

impl AreaTable {
    fn read(self, file: &Path, model: &Model) -> Result<AreaLight, SceneError> {
        let Self { shape, radiance, corner, edges, centre, normal, radius, material, ambient: _ } =
            self;
        let missing = |keys| fault_of(file, &format!("a light of this shape needs {keys}"));
        let foreign = match shape {
            Shape::Rectangle => [centre.is_some(), normal.is_some(), radius.is_some()],
            Shape::Disk => [corner.is_some(), edges.is_some(), false],
            Shape::Sphere => [corner.is_some(), edges.is_some(), normal.is_some()],
            Shape::Mesh => [
                corner.is_some() || edges.is_some(),
                centre.is_some() || normal.is_some() || radius.is_some(),
                radiance.is_some(),
            ],
        };
        if foreign.contains(&true) || material.is_some() != matches!(shape, Shape::Mesh) {
            return Err(fault_of(
                file,
                "an area light has a key that is not its shape's: a rectangle has corner, edges, \
                 radiance; a disk centre, normal, radius, radiance; a sphere centre, radius, \
                 radiance; a mesh has material alone, whose Ke it sends",
            ));
        }
        let shape = match shape {
            Shape::Rectangle => {
                let (Some(corner), Some([a, b])) = (corner, edges) else {
                    return Err(missing("corner and edges"));
                };
                let edges = [vector(file, "light edges", a)?, vector(file, "light edges", b)?];
                if edges[0].cross(edges[1]) == DVec3::ZERO {
                    return Err(fault_of(
                        file,
                        "the edges of a light span no area; give two that are not parallel",
                    ));
                }
                LightShape::Rectangle { corner: vector(file, "light corner", corner)?, edges }
            }
            Shape::Disk => {
                let (Some(centre), Some(normal), Some(radius)) = (centre, normal, radius) else {
                    return Err(missing("centre, normal and radius"));
                };
                let wanted = "it is perpendicular to the disk and not zero";
                let normal = direction(file, "light normal", normal, wanted)?;
                let radius = self::radius(file, radius)?;
                let radii = super::around(normal).map(|v| v * radius);
                LightShape::Disk { centre: vector(file, "light centre", centre)?, radii }
            }
            Shape::Sphere => {
                let (Some(centre), Some(radius)) = (centre, radius) else {
                    return Err(missing("centre and radius"));
                };
                let centre = vector(file, "light centre", centre)?;
                LightShape::Sphere { centre, radius: self::radius(file, radius)? }
            }
            Shape::Mesh => return emissive_mesh(file, model, &material.unwrap_or_default()),
        };
        let Some(radiance) = radiance else { return Err(missing("radiance")) };
        Ok(AreaLight { shape, radiance: colour(file, "light radiance", radiance)? })
    }
}

fn emissive_mesh(file: &Path, model: &Model, name: &str) -> Result<AreaLight, SceneError> {
    let lit = |m: &&super::Material| m.ke.iter().any(|ke| *ke > 0.0);
    let Some(material) = model.materials.iter().position(|m| m.name == name && lit(&m)) else {
        let known: Vec<_> =
            model.materials.iter().filter(lit).map(|m| format!("\"{}\"", m.name)).collect();
        let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        let fault = format!(
            "a mesh light names the material \"{name}\", which is not among the materials with a \
             Ke above 0: {known}"
        );
        return Err(fault_of(file, &fault));
    };
    let mesh = &model.mesh;
    let ids = (0..mesh.triangles.len()).filter(|id| mesh.materials[*id] as usize == material);
    let mut area = 0.0;
    let mut triangles: Vec<_> = ids
        .filter_map(|id| {
            let its_area = mesh.area_normal(id).length() / 2.0;
            area += its_area;
            (its_area > 0.0).then(|| (area, mesh.corners(id)))
        })
        .collect();
    for (up_to, _) in &mut triangles {
        *up_to /= area;
    }
    if triangles.is_empty() {
        let fault = format!("no triangle with an area has the light's material \"{name}\"");
        return Err(fault_of(file, &fault));
    }
    let radiance = model.materials[material].ke;
    let material = material as u32;
    Ok(AreaLight { shape: LightShape::Mesh { material, triangles, area }, radiance })
}

fn direction(
    file: &Path,
    name: &'static str,
    value: [f64; 3],
    wanted: &'static str,
) -> Result<DVec3, SceneError> {
    vector(file, name, value)?.try_normalize().ok_or_else(|| SceneError::Value {
        path: shown(file),
        name,
        value,
        wanted,
    })
}

fn radius(file: &Path, radius: f64) -> Result<f64, SceneError> {
    let fault = || fault_of(file, &format!("light radius is {radius}; it lies above 0"));
    (radius > 0.0 && radius <= super::MAX_COORDINATE).then_some(radius).ok_or_else(fault)
}

fn fault_of(file: &Path, fault: &str) -> SceneError {
    SceneError::Feature { path: shown(file), fault: fault.to_owned() }
}
