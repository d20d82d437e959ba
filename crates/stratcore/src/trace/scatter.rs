//! From a hit to the radiance it sends back: one type per set of features, so that what a scene
//! does not have is not in the code that traces it.

use super::moment::Moment;
use super::surface::Surface;
use super::tracer::Nearest;
use super::{Ray, TracedScene};
use crate::scene::{Distribution, LightShape, Rgb, Specular, around, disk};
use glam::DVec3;

/// How radiance comes about behind the camera's rays.
pub(super) trait Scatter: Send + Sync + Copy {
    /// For a scene with these features.
    fn of(distribution: &Distribution) -> Self;
    /// Coordinates that choose points on lights.
    fn light_axes(self) -> usize;
    /// Coordinates that choose directions of diffuse reflection.
    fn bounce_axes(self) -> usize;
    /// Radiance along a ray from the camera.
    fn radiance<M: Moment>(
        scene: &TracedScene,
        ray: &Ray,
        moment: M,
        lights: &[f64],
        bounces: &[f64],
    ) -> Rgb;
}

/// Light from a point or a direction, once reflected.
#[derive(Clone, Copy)]
pub(super) struct Direct;

/// The same with area lights.
#[derive(Clone, Copy)]
pub(super) struct WithAreaLights {
    light_axes: usize,
}

/// The same with mirrors, glass and diffuse interreflection.
#[derive(Clone, Copy)]
pub(super) struct WithPaths {
    light_axes: usize,
    bounce_axes: usize,
}

impl Scatter for Direct {
    fn of(_: &Distribution) -> Self {
        Self
    }
    #[inline(always)]
    fn light_axes(self) -> usize {
        0
    }
    #[inline(always)]
    fn bounce_axes(self) -> usize {
        0
    }
    #[inline(always)]
    fn radiance<M: Moment>(scene: &TracedScene, ray: &Ray, moment: M, _: &[f64], _: &[f64]) -> Rgb {
        let Some(nearest) = scene.nearest(ray, None, moment) else {
            return scene.scene().background;
        };
        let surface = Surface::new(scene, ray, &nearest, moment);
        let irradiance = surface.direct(scene, moment);
        lambert(scene, &surface, irradiance)
    }
}

impl Scatter for WithAreaLights {
    fn of(distribution: &Distribution) -> Self {
        Self { light_axes: 2 * distribution.lights.len() }
    }
    fn light_axes(self) -> usize {
        self.light_axes
    }
    fn bounce_axes(self) -> usize {
        0
    }
    #[inline]
    fn radiance<M: Moment>(
        scene: &TracedScene,
        ray: &Ray,
        moment: M,
        lights: &[f64],
        _: &[f64],
    ) -> Rgb {
        let Some(nearest) = scene.nearest(ray, None, moment) else {
            return scene.scene().background;
        };
        let surface = Surface::new(scene, ray, &nearest, moment);
        let [direct, area] = [surface.direct(scene, moment), surface.area(scene, moment, lights)];
        lambert(scene, &surface, plus(direct, area))
    }
}

impl Scatter for WithPaths {
    fn of(distribution: &Distribution) -> Self {
        let Distribution { lights, bounces, .. } = distribution;
        Self { light_axes: 2 * lights.len(), bounce_axes: 2 * *bounces as usize }
    }
    fn light_axes(self) -> usize {
        self.light_axes
    }
    fn bounce_axes(self) -> usize {
        self.bounce_axes
    }
    fn radiance<M: Moment>(
        scene: &TracedScene,
        ray: &Ray,
        moment: M,
        lights: &[f64],
        bounces: &[f64],
    ) -> Rgb {
        let specular_depth = scene.scene().distribution.specular_depth;
        Branch { scene, moment, lights, bounces, specular_depth, sees_lights: true }
            .follow(ray, None)
    }
}

/// Ke + Kd (ambient + irradiance).
#[inline(always)]
fn lambert(scene: &TracedScene, surface: &Surface, irradiance: Rgb) -> Rgb {
    let material = surface.material(scene);
    let ambient = scene.scene().ambient;
    std::array::from_fn(|i| material.ke[i] + material.kd[i] * (ambient[i] + irradiance[i]))
}

fn plus(a: Rgb, b: Rgb) -> Rgb {
    std::array::from_fn(|i| a[i] + b[i])
}

fn times(a: Rgb, b: Rgb) -> Rgb {
    std::array::from_fn(|i| a[i] * b[i])
}

/// One ray of a tree of rays, with what is left to follow and to choose by.
///
/// All vertices choose their points on the lights by the same coordinates, and all branches
/// their bounces: each term stays an unbiased estimate, and d grows by 2 a light and 2 a bounce.
#[derive(Clone, Copy)]
struct Branch<'a, M> {
    scene: &'a TracedScene,
    moment: M,
    lights: &'a [f64],
    /// Coordinates of the bounces that are left.
    bounces: &'a [f64],
    /// Mirrors and panes that are left.
    specular_depth: u32,
    /// Whether a mesh light's own radiance counts. After a diffuse reflection it was reckoned
    /// at the vertex before.
    sees_lights: bool,
}

impl<M: Moment> Branch<'_, M> {
    fn follow(self, ray: &Ray, from: Option<u32>) -> Rgb {
        let Some(nearest) = self.scene.nearest(ray, from, self.moment) else {
            return self.scene.scene().background;
        };
        self.outgoing(ray, &nearest)
    }

    fn outgoing(self, ray: &Ray, nearest: &Nearest) -> Rgb {
        let Self { scene, moment, .. } = self;
        let surface = Surface::new(scene, ray, nearest, moment);
        let material = surface.material(scene);
        let emitted =
            if self.sees_lights || !is_light(scene, &surface) { material.ke } else { [0.0; 3] };
        let mut irradiance = [0.0; 3];
        if material.kd != [0.0; 3] {
            irradiance = plus(scene.scene().ambient, surface.direct(scene, moment));
            irradiance = plus(irradiance, surface.area(scene, moment, self.lights));
            irradiance = plus(irradiance, self.bounced(&surface));
        }
        let diffuse = plus(emitted, times(material.kd, irradiance));
        if self.specular_depth == 0 {
            return diffuse;
        }
        let next = Self { specular_depth: self.specular_depth - 1, sees_lights: true, ..self };
        let onward = |direction| {
            let ray = Ray { origin: surface.point(), direction };
            next.follow(&ray, Some(surface.id))
        };
        let specular = match material.specular {
            Specular::None => [0.0; 3],
            Specular::Mirror { reflectance } => times(reflectance, onward(mirrored(&surface))),
            Specular::Glass { index, transmittance } => {
                let ratio = if surface.is_front { 1.0 / index } else { index };
                match refracted(&surface, ratio) {
                    None => onward(mirrored(&surface)),
                    Some((direction, reflected)) => {
                        let back = onward(mirrored(&surface)).map(|x| x * reflected);
                        let through = times(transmittance, onward(direction));
                        plus(back, through.map(|x| x * (1.0 - reflected)))
                    }
                }
            }
        };
        plus(diffuse, specular)
    }

    /// Irradiance over π that arrives from other surfaces, by one direction of density cos θ/π.
    fn bounced(self, surface: &Surface) -> Rgb {
        let Some((at, bounces)) = self.bounces.split_at_checked(2) else { return [0.0; 3] };
        let [x, y] = disk(at[0], at[1]);
        let [a, b] = around(surface.normal);
        let height = (1.0 - x * x - y * y).max(0.0).sqrt();
        let direction = a * x + b * y + surface.normal * height;
        // A shading normal may lean: what lies below the plane sends nothing.
        if surface.plane_normal.dot(direction) <= 0.0 {
            return [0.0; 3];
        }
        let ray = Ray { origin: surface.point(), direction };
        Self { bounces, sees_lights: false, ..self }.follow(&ray, Some(surface.id))
    }
}

fn is_light(scene: &TracedScene, surface: &Surface) -> bool {
    let scene = scene.scene();
    let its_material = scene.mesh.materials[surface.id as usize];
    scene.distribution.lights.iter().any(
        |light| matches!(light.shape, LightShape::Mesh { material, .. } if material == its_material),
    )
}

fn mirrored(surface: &Surface) -> DVec3 {
    2.0 * surface.normal.dot(surface.to_eye) * surface.normal - surface.to_eye
}

/// Where a ray goes on across a border with this ratio of indices (before over behind), and the
/// share that is reflected; none where all of it is.
fn refracted(surface: &Surface, ratio: f64) -> Option<(DVec3, f64)> {
    let cos_in = surface.normal.dot(surface.to_eye).clamp(0.0, 1.0);
    let squared = 1.0 - ratio * ratio * (1.0 - cos_in * cos_in);
    if squared <= 0.0 {
        return None;
    }
    let cos_out = squared.sqrt();
    let direction = surface.normal * (ratio * cos_in - cos_out) - surface.to_eye * ratio;
    let across = (ratio * cos_in - cos_out) / (ratio * cos_in + cos_out);
    let along = (cos_in - ratio * cos_out) / (cos_in + ratio * cos_out);
    Some((direction, (across * across + along * along) / 2.0))
}
