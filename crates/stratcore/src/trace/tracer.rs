//! What a ray sees.

use super::moment::{Moment, Still};
use super::rays::{Radiance, rays};
use super::scatter::{Direct, Scatter};
use super::{Accel, Crossing, Filtered, PixelIntegrand, Ray, Tracer};
use crate::scene::{Channel, Filter, Rgb, Scene};
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
pub(super) struct Nearest {
    pub triangle: u32,
    pub crossing: Crossing,
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
        let motion = scene.distribution.motion.as_ref().map(|motion| &motion.vertices[..]);
        let accel = Accel::build(&scene.mesh, scene.camera.eye, motion);
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

    /// The same scene, its pixels weighed by this filter.
    #[must_use]
    pub fn with_filter(mut self, filter: Option<Filter>) -> Self {
        self.scene.filter = filter;
        self
    }

    /// How its pixels are sampled.
    pub fn tracer(&self) -> Tracer {
        self.tracer
    }

    /// The integral of pixel (x, y): a channel of the radiance over the pixel's square.
    pub fn pixel(&self, pixel: [u32; 2], channel: Channel) -> PixelIntegrand<'_> {
        PixelIntegrand::new(self, pixel, channel, self.tracer)
    }

    /// Pixel (x, y) in colour, by rays.
    pub fn colour(&self, pixel: [u32; 2]) -> Box<dyn Radiance + '_> {
        let frame = self.scene.camera.pixel(pixel);
        let channel = Channel::default();
        match &self.scene.filter {
            None => rays(self, frame, channel),
            Some(filter) => {
                let inner = rays(self, frame.widened(filter.radius), channel);
                Box::new(Filtered::new(inner, filter))
            }
        }
    }

    /// The nearest triangle; the lowest index where two are exactly as near.
    pub fn closest_hit(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        self.nearest(&Ray { origin, direction }, Still).map(|nearest| nearest.hit())
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
        self.blocks(&Ray { origin, direction }, t_max, skip, Still)
    }

    /// [`TracedScene::occluded`] at a moment. Never a part of its caller, for what a headlight
    /// does not need would take room there.
    #[inline(never)]
    pub(super) fn blocks<M: Moment>(
        &self,
        ray: &Ray,
        t_max: f64,
        skip: Option<u32>,
        moment: M,
    ) -> bool {
        const STOP: f64 = -1.0;
        let mut blocked = false;
        self.accel.walk(ray.origin, ray.direction, t_max, |id, limit| {
            let corners = moment.corners(&self.scene.mesh, id as usize);
            let is_between = !blocked
                && Some(id) != skip
                && ray.meets(corners).is_some_and(|crossing| crossing.inverse_t * t_max > 1.0)
                && !(skip.is_some() && self.starts_on(ray, corners));
            blocked |= is_between;
            if blocked { STOP } else { limit }
        });
        blocked
    }

    /// Whether the ray starts in the triangle's plane, to rounding: on a double of the triangle
    /// that it leaves, or on another of that plane. Such a one neither shadows nor reflects.
    fn starts_on(&self, ray: &Ray, [a, b, c]: [DVec3; 3]) -> bool {
        /// The beam's bound for coplanar neighbours.
        const ROUNDING: f64 = 1e-10;
        let normal = (b - a).cross(c - a);
        let from_eye = normal.dot(a - self.scene.camera.eye).abs();
        normal.dot(ray.origin - a).abs() <= ROUNDING * from_eye
    }

    /// Linear radiance along a ray, by the lights that have no area.
    pub fn radiance(&self, origin: DVec3, direction: DVec3) -> Rgb {
        Direct::radiance(self, &Ray { origin, direction }, Still, &[], &[])
    }

    /// The nearest triangle at a moment. Never a part of its caller: beside what shades a hit
    /// the walk would have fewer registers.
    #[inline(never)]
    pub(super) fn nearest<M: Moment>(&self, ray: &Ray, moment: M) -> Option<Nearest> {
        self.nearest_besides(ray, None, moment)
    }

    /// The same, other than the triangle that the ray starts on.
    #[inline(never)]
    pub(super) fn nearest_from<M: Moment>(
        &self,
        ray: &Ray,
        start: u32,
        moment: M,
    ) -> Option<Nearest> {
        self.nearest_besides(ray, Some(start), moment)
    }

    #[inline(always)]
    fn nearest_besides<M: Moment>(
        &self,
        ray: &Ray,
        skip: Option<u32>,
        moment: M,
    ) -> Option<Nearest> {
        let mut best = None;
        self.accel.walk(ray.origin, ray.direction, f64::INFINITY, |id, limit| {
            if Some(id) == skip {
                return limit;
            }
            let corners = moment.corners(&self.scene.mesh, id as usize);
            match ray.meets(corners) {
                Some(_) if skip.is_some() && self.starts_on(ray, corners) => limit,
                Some(crossing) => {
                    Nearest::consider(&mut best, id, crossing);
                    limit.min(1.0 / crossing.inverse_t)
                }
                None => limit,
            }
        });
        best
    }
}
