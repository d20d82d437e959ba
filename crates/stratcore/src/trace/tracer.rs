//! What a ray sees.

use super::{Accel, Crossing, PixelIntegrand, Ray, Tracer};
use crate::scene::{Channel, Light, Rgb, Scene};
use glam::DVec3;

/// A scene with its BVH.
pub struct TracedScene {
    scene: Scene,
    accel: Accel,
    tracer: Tracer,
}

/// The nearest triangle along a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Its index in [`Mesh::triangles`](crate::scene::Mesh::triangles).
    pub triangle: u32,
    /// Distance in lengths of the ray's direction.
    pub t: f64,
}

/// The nearest crossing so far; the lower triangle wins a tie.
struct Nearest {
    triangle: u32,
    crossing: Crossing,
}

impl Nearest {
    fn consider(best: &mut Option<Self>, triangle: u32, crossing: Crossing) {
        let is_nearer = best.as_ref().is_none_or(|best| {
            crossing.inverse_t > best.crossing.inverse_t
                || crossing.inverse_t == best.crossing.inverse_t && triangle < best.triangle
        });
        if is_nearer {
            *best = Some(Self { triangle, crossing });
        }
    }

    fn hit(&self) -> Hit {
        Hit { triangle: self.triangle, t: 1.0 / self.crossing.inverse_t }
    }
}

impl TracedScene {
    /// Builds the BVH. Every index in the mesh must be in range, as [`load`](crate::scene::load)
    /// makes sure.
    pub fn new(scene: Scene) -> Self {
        let accel = Accel::build(&scene.mesh, scene.camera.eye);
        Self { scene, accel, tracer: Tracer::default() }
    }

    /// The scene as given.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Its BVH.
    pub fn accel(&self) -> &Accel {
        &self.accel
    }

    /// The same scene, its pixels sampled by this tracer.
    #[must_use]
    pub fn with_tracer(self, tracer: Tracer) -> Self {
        Self { tracer, ..self }
    }

    /// How its pixels are sampled.
    pub fn tracer(&self) -> Tracer {
        self.tracer
    }

    /// The integral of pixel (x, y): a channel of the radiance over the pixel's square.
    pub fn pixel(&self, pixel: [u32; 2], channel: Channel) -> PixelIntegrand<'_> {
        PixelIntegrand::new(self, pixel, channel, self.tracer)
    }

    /// The nearest triangle; the lowest index where two are exactly as near.
    pub fn closest_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        self.nearest(&Ray { origin, direction }).map(|nearest| nearest.hit())
    }

    /// The same answer from a loop over all triangles: what the BVH is tested against.
    pub fn brute_force_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let ray = Ray { origin, direction };
        let mut best = None;
        for id in 0..self.scene.mesh.triangles.len() {
            if let Some(crossing) = ray.meets(self.scene.mesh.corners(id)) {
                Nearest::consider(&mut best, id as u32, crossing);
            }
        }
        best.map(|nearest| nearest.hit())
    }

    /// Whether anything lies between `origin` and `origin + direction * t_max` (infinity for a
    /// light infinitely far away), other than the triangle `skip` that the ray starts on.
    pub fn occluded(&self, origin: DVec3, direction: DVec3, t_max: f64, skip: Option<u32>) -> bool {
        const STOP: f64 = -1.0;
        let ray = Ray { origin, direction };
        let mut blocked = false;
        self.accel.walk(origin, direction, t_max, |id, limit| {
            let is_between = !blocked
                && Some(id) != skip
                && ray
                    .meets(self.scene.mesh.corners(id as usize))
                    .is_some_and(|crossing| crossing.inverse_t * t_max > 1.0);
            blocked |= is_between;
            if blocked { STOP } else { limit }
        });
        blocked
    }

    /// Linear radiance along a ray.
    pub fn radiance(&self, origin: DVec3, direction: DVec3) -> Rgb {
        let ray = Ray { origin, direction };
        match self.nearest(&ray) {
            Some(nearest) => self.reflected(&ray, &nearest),
            None => self.scene.background,
        }
    }

    fn nearest(&self, ray: &Ray) -> Option<Nearest> {
        let mut best = None;
        self.accel.walk(ray.origin, ray.direction, f64::INFINITY, |id, limit| {
            match ray.meets(self.scene.mesh.corners(id as usize)) {
                Some(crossing) => {
                    Nearest::consider(&mut best, id, crossing);
                    limit.min(1.0 / crossing.inverse_t)
                }
                None => limit,
            }
        });
        best
    }

    fn reflected(&self, ray: &Ray, nearest: &Nearest) -> Rgb {
        let mesh = &self.scene.mesh;
        let id = nearest.triangle as usize;
        let [a, b, c] = mesh.corners(id);
        let to_eye = -ray.direction.normalize();
        // Both normals on the eye's side of the surface.
        let plane_normal = (b - a).cross(c - a).normalize();
        let plane_normal =
            if plane_normal.dot(to_eye) < 0.0 { -plane_normal } else { plane_normal };
        let normal = match &mesh.corner_normals {
            Some(normals) => {
                let [wa, wb, wc] = nearest.crossing.edges;
                let [na, nb, nc] = normals[id];
                let normal = (na * wa + nb * wb + nc * wc).normalize_or(plane_normal);
                if normal.dot(plane_normal) < 0.0 { -normal } else { normal }
            }
            None => plane_normal,
        };
        let point = || ray.origin + ray.direction / nearest.crossing.inverse_t;
        // Cosine and whether the light reaches the point, for a light along `to_light`.
        let lit_cosine = |point: DVec3, to_light: DVec3, t_max: f64| {
            let cosine = normal.dot(to_light) / to_light.length();
            let faces = plane_normal.dot(to_light) > 0.0 && cosine > 0.0;
            let id = Some(nearest.triangle);
            if faces && !self.occluded(point, to_light, t_max, id) { cosine } else { 0.0 }
        };
        let irradiance = match self.scene.light {
            Light::Headlight => [normal.dot(to_eye).abs(); 3],
            Light::Point { position, intensity } => {
                let point = point();
                let to_light = position - point;
                let cosine = lit_cosine(point, to_light, 1.0);
                intensity.map(|i| i * cosine / to_light.length_squared())
            }
            Light::Directional { towards, irradiance } => {
                let cosine = lit_cosine(point(), towards, f64::INFINITY);
                irradiance.map(|i| i * cosine)
            }
        };
        let material = &self.scene.materials[mesh.materials[id] as usize];
        std::array::from_fn(|i| {
            material.ke[i] + material.kd[i] * (self.scene.ambient[i] + irradiance[i])
        })
    }
}
