//! What adds dimensions or branches to a scene's pixels.

use crate::table::short;
use serde::Serialize;
use stratcore::scene::{Aperture, Distribution, FilterMethod, FilterShape, LightShape, Scene};

/// Absent features are null, empty or 0.
#[derive(Serialize)]
pub struct FeatureFacts {
    lens: Option<LensFacts>,
    area_lights: Vec<AreaLightFacts>,
    shutter: Option<ShutterFacts>,
    specular_depth: u32,
    bounces: u32,
    filter: Option<FilterFacts>,
}

#[derive(Serialize)]
struct LensFacts {
    radius: f64,
    focus_distance: f64,
    /// Null for a disk.
    blades: Option<u32>,
}

#[derive(Serialize)]
struct AreaLightFacts {
    shape: &'static str,
    radiance: [f64; 3],
}

#[derive(Serialize)]
struct ShutterFacts {
    camera_motion: [f64; 3],
    moving_vertices: usize,
}

#[derive(Serialize)]
struct FilterFacts {
    kind: FilterShape,
    radius: f64,
    method: FilterMethod,
}

impl FeatureFacts {
    pub fn of(scene: &Scene) -> Self {
        let Distribution { lens, lights, motion, specular_depth, bounces } = &scene.distribution;
        Self {
            lens: lens.map(|lens| LensFacts {
                radius: lens.radius,
                focus_distance: lens.focus_distance,
                blades: match lens.aperture {
                    Aperture::Disk => None,
                    Aperture::Blades { blades, .. } => Some(blades),
                },
            }),
            area_lights: lights
                .iter()
                .map(|light| AreaLightFacts {
                    shape: match light.shape {
                        LightShape::Rectangle { .. } => "rectangle",
                        LightShape::Disk { .. } => "disk",
                        LightShape::Sphere { .. } => "sphere",
                        LightShape::Mesh { .. } => "mesh",
                    },
                    radiance: light.radiance,
                })
                .collect(),
            shutter: motion.as_ref().map(|motion| ShutterFacts {
                camera_motion: motion.camera.to_array(),
                moving_vertices: motion
                    .vertices
                    .iter()
                    .filter(|v| v.to_array() != [0.0; 3])
                    .count(),
            }),
            specular_depth: *specular_depth,
            bounces: *bounces,
            filter: scene.filter.as_ref().map(|filter| FilterFacts {
                kind: filter.shape,
                radius: filter.radius,
                method: filter.method,
            }),
        }
    }

    /// Lines of the table: only what is there.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let mut rows = Vec::new();
        let triple = |v: [f64; 3]| v.map(|x| short(x, 4)).join(" ");
        for light in &self.area_lights {
            rows.push((
                "area light",
                format!("{}, radiance {}", light.shape, triple(light.radiance)),
            ));
        }
        if let Some(lens) = &self.lens {
            let shape = lens.blades.map_or("disk".to_owned(), |blades| format!("{blades} blades"));
            let focus = short(lens.focus_distance, 5);
            rows.push((
                "lens",
                format!("{shape} of radius {}, focus at {focus}", short(lens.radius, 4)),
            ));
        }
        if let Some(shutter) = &self.shutter {
            let camera = match shutter.camera_motion {
                [0.0, 0.0, 0.0] => String::new(),
                motion => format!(", and the camera by {}", triple(motion)),
            };
            rows.push(("shutter", format!("{} vertices move{camera}", shutter.moving_vertices)));
        }
        if self.specular_depth > 0 {
            let depth = self.specular_depth;
            rows.push(("mirrors, glass", format!("followed {depth} deep, no dimension")));
        }
        if self.bounces > 0 {
            rows.push(("reflections", format!("{} diffuse", self.bounces)));
        }
        if let Some(filter) = &self.filter {
            let radius = short(filter.radius, 3);
            rows.push(("filter", format!("{}, radius {radius}, {}", filter.kind, filter.method)));
        }
        rows
    }

    /// What keeps pixels off the beam, in words; none where nothing does.
    pub fn why_rays(&self, smooth_shading: bool) -> Option<String> {
        let reasons = [
            (self.lens.is_some(), "the lens"),
            (self.shutter.is_some(), "the shutter"),
            (self.specular_depth > 0, "mirrors and glass"),
            (self.bounces > 0, "diffuse reflections"),
            (smooth_shading, "smooth shading"),
        ];
        let reasons: Vec<_> =
            reasons.into_iter().filter(|(is, _)| *is).map(|(_, name)| name).collect();
        (!reasons.is_empty()).then(|| reasons.join(", "))
    }
}
