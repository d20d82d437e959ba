//! `inspect`: what a scene holds, and what that means for its pixels.

mod features;
mod pixel;

use super::Outcome;
use super::pixel::pixel_of;
use crate::cli::{Common, InspectArgs};
use crate::output;
use crate::table::{Align, columns, number, short};
use anyhow::Result;
use features::FeatureFacts;
use pixel::PixelFacts;
use serde::Serialize;
use stratcore::dimensions::{SURVEYED, survey};
use stratcore::integrand::Integrand;
use stratcore::scene::{self, Channel, Light, Rgb, Scene};
use stratcore::study::Control;
use stratcore::theory::Class;
use stratcore::trace::{Route, TracedScene};

#[derive(Serialize)]
struct Inspection {
    scene: String,
    /// What was read; none for a built-in scene.
    files: Vec<String>,
    camera: CameraFacts,
    triangles: usize,
    vertices: usize,
    smooth_shading: bool,
    materials: Vec<MaterialFacts>,
    bounds: Option<[[f64; 3]; 2]>,
    light: LightFacts,
    features: FeatureFacts,
    ambient: Rgb,
    background: Rgb,
    memory_bytes: MemoryFacts,
    notes: Vec<String>,
    dim: usize,
    axes: Vec<String>,
    /// Jittered sampling's exponent for each class of pixel.
    predicted: Vec<Prediction>,
    /// Of a lattice of pixels, how many of each class take which path.
    paths: Vec<PathFacts>,
    /// The pixel that was asked for.
    pixel: Option<PixelFacts>,
}

#[derive(Serialize)]
struct CameraFacts {
    eye: [f64; 3],
    look_at: [f64; 3],
    up: [f64; 3],
    fov_y: f64,
    resolution: [u32; 2],
}

#[derive(Serialize)]
struct MaterialFacts {
    name: String,
    kd: Rgb,
    ke: Rgb,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum LightFacts {
    Off,
    Headlight,
    Point { position: [f64; 3], intensity: Rgb },
    Directional { towards: [f64; 3], irradiance: Rgb },
}

/// Bytes in memory.
#[derive(Serialize)]
pub struct MemoryFacts {
    pub scene: usize,
    pub bvh: usize,
}

impl MemoryFacts {
    pub fn of(traced: &TracedScene) -> Self {
        let Scene { mesh, materials, .. } = traced.scene();
        let accel = traced.accel();
        let bvh = accel.bvh();
        Self {
            scene: size_of_val(&*mesh.positions)
                + size_of_val(&*mesh.triangles)
                + size_of_val(&*mesh.materials)
                + mesh.corner_normals.as_deref().map_or(0, size_of_val)
                + size_of_val(&**materials),
            bvh: size_of_val(&*bvh.nodes)
                + size_of_val(&*bvh.primitive_indices)
                + size_of_val(accel.rounded_corners()),
        }
    }
}

#[derive(Serialize)]
struct PathFacts {
    class: Class,
    path: Route,
    pixels: u32,
}

#[derive(Serialize)]
struct Prediction {
    class: Class,
    /// Dimension of what is jumped across; null without jumps, d for detail everywhere.
    discontinuity_dim: Option<usize>,
    exponent: Option<f64>,
    meaning: &'static str,
}

pub fn run(args: &InspectArgs, common: &Common) -> Result<Outcome> {
    let scene = scene::load(&args.scene)?;
    let at = args.at.as_deref().map(|at| pixel_of(&scene, at)).transpose()?;
    let traced = TracedScene::new(scene);
    let control = Control::unwatched();
    let paths = survey(&traced, common.seed, control)?;
    let paths = paths.into_iter().map(|(class, path, pixels)| PathFacts { class, path, pixels });
    let inspection = Inspection {
        paths: paths.collect(),
        pixel: at.map(|at| PixelFacts::of(&traced, at, common.seed, control)).transpose()?,
        ..inspect(&traced)
    };
    if common.json {
        output::print_json(inspection)?;
    } else {
        output::print(&text(&inspection))?;
    }
    Ok(Outcome::Done)
}

fn inspect(traced: &TracedScene) -> Inspection {
    let Scene { name, camera, mesh, materials, light, ambient, background, files, notes, .. } =
        traced.scene();
    let pixel = traced.pixel([0, 0], Channel::Luminance);
    let dim = pixel.dim();
    let corners = || mesh.triangles.iter().flatten().map(|i| mesh.positions[*i as usize]);
    let lowest = corners().reduce(|a, b| a.min(b));
    let highest = corners().reduce(|a, b| a.max(b));
    let prediction = |class: Class, meaning| Prediction {
        class,
        discontinuity_dim: match class {
            Class::Edge => Some(dim - 1),
            Class::Complex => Some(dim),
            Class::Exact | Class::Smooth => None,
        },
        exponent: class.predicted_exponent(dim),
        meaning,
    };
    Inspection {
        scene: name.clone(),
        files: files.clone(),
        camera: CameraFacts {
            eye: camera.eye.to_array(),
            look_at: camera.look_at.to_array(),
            up: camera.up.to_array(),
            fov_y: camera.fov_y,
            resolution: camera.resolution,
        },
        triangles: mesh.triangles.len(),
        vertices: mesh.positions.len(),
        smooth_shading: mesh.corner_normals.is_some(),
        materials: materials
            .iter()
            .map(|m| MaterialFacts { name: m.name.clone(), kd: m.kd, ke: m.ke })
            .collect(),
        bounds: lowest.zip(highest).map(|(a, b)| [a.to_array(), b.to_array()]),
        light: match *light {
            Light::Off => LightFacts::Off,
            Light::Headlight => LightFacts::Headlight,
            Light::Point { position, intensity } => {
                LightFacts::Point { position: position.to_array(), intensity }
            }
            Light::Directional { towards, irradiance } => {
                LightFacts::Directional { towards: towards.to_array(), irradiance }
            }
        },
        features: FeatureFacts::of(traced.scene()),
        ambient: *ambient,
        background: *background,
        memory_bytes: MemoryFacts::of(traced),
        notes: notes.clone(),
        dim,
        axes: pixel.axes(),
        predicted: vec![
            prediction(Class::Smooth, "radiance varies smoothly across the pixel"),
            prediction(Class::Edge, "edges cross the pixel, smooth between them"),
            prediction(Class::Complex, "detail finer than the strata"),
        ],
        paths: Vec::new(),
        pixel: None,
    }
}

fn text(facts: &Inspection) -> String {
    let triple = |v: &[f64; 3]| v.map(|x| short(x, 4)).join(" ");
    let megabytes = |bytes: usize| format!("{} MB", number(bytes as f64 * 1e-6, 3));
    let camera = &facts.camera;
    let [width, height] = camera.resolution;
    let light = match &facts.light {
        LightFacts::Off => "none but area lights".to_owned(),
        LightFacts::Headlight => "headlight".to_owned(),
        LightFacts::Point { position, intensity } => {
            format!("point at {}, intensity {}", triple(position), triple(intensity))
        }
        LightFacts::Directional { towards, irradiance } => {
            format!("directional from {}, irradiance {}", triple(towards), triple(irradiance))
        }
    };
    let bounds = match &facts.bounds {
        Some([lo, hi]) => format!("{} to {}", triple(lo), triple(hi)),
        None => "none".to_owned(),
    };
    let shading = if facts.smooth_shading { "smooth" } else { "flat" };
    let mut rows = vec![
        ("triangles", format!("{}, {shading} shading", facts.triangles)),
        ("vertices", facts.vertices.to_string()),
        ("materials", facts.materials.len().to_string()),
        ("bounds", bounds),
        ("light", light),
    ];
    rows.extend(facts.features.rows());
    rows.extend([
        ("ambient", triple(&facts.ambient)),
        ("background", triple(&facts.background)),
        (
            "camera",
            format!(
                "eye {}, looks at {}, fov_y {}°",
                triple(&camera.eye),
                triple(&camera.look_at),
                camera.fov_y
            ),
        ),
        ("picture", format!("{width} × {height} pixels")),
        (
            "memory",
            format!(
                "scene {}, BVH {}",
                megabytes(facts.memory_bytes.scene),
                megabytes(facts.memory_bytes.bvh)
            ),
        ),
        ("a pixel is", format!("d = {}: {}", facts.dim, facts.axes.join(", "))),
    ]);
    rows.extend(facts.files.iter().map(|file| ("reads", file.clone())));
    rows.extend(facts.notes.iter().map(|note| ("note", note.clone())));
    let rows: Vec<_> = rows.into_iter().map(|(name, fact)| vec![name.to_owned(), fact]).collect();
    let predicted: Vec<_> = facts
        .predicted
        .iter()
        .map(|p| {
            let k = p.discontinuity_dim.map_or("no k".to_owned(), |k| format!("k = {k}"));
            let exponent = p.exponent.map(|e| format!("p = {}", short(e, 5))).unwrap_or_default();
            vec![p.class.to_string(), k, exponent, p.meaning.to_owned()]
        })
        .collect();
    let paths: Vec<_> = facts
        .paths
        .iter()
        .map(|p| vec![p.class.to_string(), p.path.to_string(), format!("{} pixels", p.pixels)])
        .collect();
    let mut text = format!(
        "{}\n{}\nvariance of the mean ~ C N^-p: random sampling has p = 1; jittered, by theory, \
         min(1 + 2/d, 2 - k/d)\n{}\nhow {SURVEYED} × {SURVEYED} pixels are sampled, by class as \
         a quick look finds it\n{}",
        facts.scene,
        columns(Align::Left, &rows),
        columns(Align::Left, &predicted),
        columns(Align::Left, &paths),
    );
    if let Some(reasons) = facts.features.why_rays(facts.smooth_shading) {
        text += &format!("  rays because of {reasons}\n");
    }
    if let Some(pixel) = &facts.pixel {
        text += &pixel.text();
    }
    text
}
