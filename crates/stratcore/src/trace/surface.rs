//! The surface at a hit, and the light that reaches it.

use super::moment::Moment;
use super::tracer::Nearest;
use super::{Ray, TracedScene};
use crate::scene::{Light, Material, Rgb, SHORT_OF_THE_LIGHT};
use glam::DVec3;

/// A hit, with both normals on the side that the ray came from.
pub(super) struct Surface {
    /// The triangle.
    pub id: u32,
    /// Unit vector back along the ray.
    pub to_eye: DVec3,
    /// Of the triangle's plane.
    pub plane_normal: DVec3,
    /// What light is reckoned by: the shading normal, if the scene has them.
    pub normal: DVec3,
    /// Whether the ray came to the side on which the corners are counter-clockwise.
    pub is_front: bool,
    /// Cosine at [`Surface::normal`] towards the ray's origin, without its sign.
    facing: f64,
    ray: Ray,
    inverse_t: f64,
}

impl Surface {
    #[inline(always)]
    pub fn new<M: Moment>(scene: &TracedScene, ray: &Ray, nearest: &Nearest, moment: M) -> Self {
        let mesh = &scene.scene().mesh;
        let id = nearest.triangle as usize;
        let [a, b, c] = moment.corners(mesh, id);
        let to_eye = -ray.direction.normalize();
        let plane_normal = (b - a).cross(c - a).normalize();
        let across = plane_normal.dot(to_eye);
        let is_front = across >= 0.0;
        let plane_normal = if is_front { plane_normal } else { -plane_normal };
        let (normal, facing) = match &mesh.corner_normals {
            Some(normals) => {
                let [wa, wb, wc] = nearest.crossing.edges;
                let [na, nb, nc] = normals[id];
                let normal = (na * wa + nb * wb + nc * wc).normalize_or(plane_normal);
                let normal = if normal.dot(plane_normal) < 0.0 { -normal } else { normal };
                (normal, normal.dot(to_eye).abs())
            }
            // The same without asking for the side, which a headlight does not need.
            None => (plane_normal, across.abs()),
        };
        let (id, inverse_t) = (nearest.triangle, nearest.crossing.inverse_t);
        Self { id, to_eye, plane_normal, normal, is_front, facing, ray: *ray, inverse_t }
    }

    pub fn material<'a>(&self, scene: &'a TracedScene) -> &'a Material {
        let scene = scene.scene();
        &scene.materials[scene.mesh.materials[self.id as usize] as usize]
    }

    pub fn point(&self) -> DVec3 {
        self.ray.origin + self.ray.direction * (1.0 / self.inverse_t)
    }

    /// Cosine at the surface towards a light along `to_light`, which is met at `t_max` of its
    /// lengths; 0 where the light does not reach.
    #[inline(always)]
    fn lit_cosine<M: Moment>(
        &self,
        scene: &TracedScene,
        moment: M,
        point: DVec3,
        to_light: DVec3,
        t_max: f64,
    ) -> f64 {
        let cosine = self.normal.dot(to_light) / to_light.length();
        let faces = self.plane_normal.dot(to_light) > 0.0 && cosine > 0.0;
        let ray = Ray { origin: point, direction: to_light };
        if faces && !scene.blocks(&ray, t_max, Some(self.id), moment) { cosine } else { 0.0 }
    }

    /// Irradiance from the light that has no area.
    #[inline(always)]
    pub fn direct<M: Moment>(&self, scene: &TracedScene, moment: M) -> Rgb {
        match scene.scene().light {
            Light::Off => [0.0; 3],
            Light::Headlight => [self.facing; 3],
            Light::Point { position, intensity } => {
                let point = self.point();
                let to_light = position - point;
                let cosine = self.lit_cosine(scene, moment, point, to_light, 1.0);
                intensity.map(|i| i * cosine / to_light.length_squared())
            }
            Light::Directional { towards, irradiance } => {
                let cosine = self.lit_cosine(scene, moment, self.point(), towards, f64::INFINITY);
                irradiance.map(|i| i * cosine)
            }
        }
    }

    /// Irradiance over π from one point of each area light, chosen by two of the `coordinates`
    /// each.
    #[inline]
    pub fn area<M: Moment>(&self, scene: &TracedScene, moment: M, coordinates: &[f64]) -> Rgb {
        let point = self.point();
        scene.scene().distribution.irradiance(point, coordinates, |_, to_light| {
            self.lit_cosine(scene, moment, point, to_light, SHORT_OF_THE_LIGHT)
        })
    }
}
