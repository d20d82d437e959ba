//! The integral of one pixel.

use super::TracedScene;
use crate::beam::PixelBeam;
use crate::integrand::Integrand;
use crate::sampler::{PointSet, Sampler};
use crate::scene::{Channel, PixelFrame};
use serde::{Deserialize, Serialize};
use std::sync::atomic::AtomicBool;

/// How the samples of a pixel are traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Tracer {
    /// The pixel's own list of triangles, gathered once ([`crate::beam`]). Scenes that it does
    /// not serve are traced by rays.
    #[default]
    Beam,
    /// One ray through the BVH per sample, in f64.
    Bvh,
}

/// A channel of the radiance over one pixel's square.
pub enum PixelIntegrand<'a> {
    /// By one ray per point.
    Rays(PixelRays<'a>),
    /// By the pixel's beam.
    Beam(Box<PixelBeam>),
}

/// One ray through the BVH per point.
#[derive(Clone, Copy)]
pub struct PixelRays<'a> {
    scene: &'a TracedScene,
    frame: PixelFrame,
    channel: Channel,
}

impl<'a> PixelIntegrand<'a> {
    pub(super) fn new(
        scene: &'a TracedScene,
        pixel: [u32; 2],
        channel: Channel,
        tracer: Tracer,
    ) -> Self {
        if tracer == Tracer::Beam
            && let Some(beam) = PixelBeam::new(scene.scene(), scene.accel().bvh(), pixel, channel)
        {
            return Self::Beam(Box::new(beam));
        }
        Self::Rays(PixelRays { scene, frame: scene.scene().camera.pixel(pixel), channel })
    }

    fn inner(&self) -> &dyn Integrand {
        match self {
            Self::Rays(rays) => rays,
            Self::Beam(beam) => &**beam,
        }
    }
}

impl Integrand for PixelIntegrand<'_> {
    fn dim(&self) -> usize {
        self.inner().dim()
    }

    fn axes(&self) -> Vec<String> {
        self.inner().axes()
    }

    fn eval(&self, point: &[f64]) -> f64 {
        self.inner().eval(point)
    }

    fn eval_block(&self, points: &[f64], values: &mut [f64]) {
        self.inner().eval_block(points, values);
    }

    fn trial_means(
        &self,
        sampler: &dyn Sampler,
        set: &PointSet,
        first_trial: u32,
        means: &mut [f64],
        cancel: &AtomicBool,
    ) -> bool {
        self.inner().trial_means(sampler, set, first_trial, means, cancel)
    }
}

impl Integrand for PixelRays<'_> {
    fn dim(&self) -> usize {
        2
    }

    fn axes(&self) -> Vec<String> {
        vec!["pixel_x".to_owned(), "pixel_y".to_owned()]
    }

    fn eval(&self, point: &[f64]) -> f64 {
        let eye = self.scene.scene().camera.eye;
        let direction = self.frame.direction(point[0], point[1]);
        self.channel.of(self.scene.radiance(eye, direction))
    }
}
