//! The integral of one pixel.

use super::rays::{Radiance, rays};
use super::{Filtered, TracedScene};
use crate::beam::{AreaBeam, PixelBeam};
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
    /// Rays through the BVH for each sample, in f64.
    Bvh,
}

/// The way that samples of a pixel take.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Route {
    /// The pixel's beam in f32; samples that rounding could misplace are settled in f64.
    Beam,
    /// The pixel's beam, and for each facet the triangles in the shaft to each area light; f64.
    BeamAndShafts,
    /// Rays through the BVH; f64.
    Rays,
}

impl std::fmt::Display for Route {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Beam => "beam in f32",
            Self::BeamAndShafts => "beam and shafts in f64",
            Self::Rays => "rays in f64",
        })
    }
}

/// A channel of the radiance over one pixel's square.
pub enum PixelIntegrand<'a> {
    /// By rays.
    Rays(Box<dyn Radiance + 'a>),
    /// By the pixel's beam.
    Beam(Box<PixelBeam>),
    /// By the pixel's beam, and by what stands before area lights.
    AreaBeam(Box<AreaBeam<'a>>),
    /// Any of these, under a reconstruction filter.
    Filtered(Filtered<'a, PixelIntegrand<'a>>),
}

impl<'a> PixelIntegrand<'a> {
    pub(super) fn new(
        scene: &'a TracedScene,
        pixel: [u32; 2],
        channel: Channel,
        tracer: Tracer,
    ) -> Self {
        let frame = scene.scene().camera.pixel(pixel);
        match &scene.scene().filter {
            None => Self::unfiltered(scene, frame, channel, tracer),
            Some(filter) => {
                let support = frame.widened(filter.radius);
                let inner = Self::unfiltered(scene, support, channel, tracer);
                Self::Filtered(Filtered::new(Box::new(inner), filter))
            }
        }
    }

    fn unfiltered(
        scene: &'a TracedScene,
        frame: PixelFrame,
        channel: Channel,
        tracer: Tracer,
    ) -> Self {
        let beam = || PixelBeam::of_frame(scene.scene(), scene.accel(), &frame, channel);
        match (tracer == Tracer::Beam).then(beam).flatten() {
            Some(beam) if scene.scene().distribution.lights.is_empty() => {
                Self::Beam(Box::new(beam))
            }
            Some(beam) => Self::AreaBeam(Box::new(AreaBeam::new(scene, beam, channel))),
            None => Self::Rays(rays(scene, frame, channel)),
        }
    }

    /// Triangles that may be seen in the pixel; none where rays find them.
    pub fn n_facets(&self) -> Option<usize> {
        match self {
            Self::Rays(_) => None,
            Self::Beam(beam) => Some(beam.n_facets()),
            Self::AreaBeam(beam) => Some(beam.n_facets()),
            Self::Filtered(filtered) => filtered.inner().n_facets(),
        }
    }

    /// The way that its samples take.
    pub fn route(&self) -> Route {
        match self {
            Self::Rays(_) => Route::Rays,
            Self::Beam(_) => Route::Beam,
            Self::AreaBeam(_) => Route::BeamAndShafts,
            Self::Filtered(filtered) => filtered.inner().route(),
        }
    }

    fn inner(&self) -> &dyn Integrand {
        match self {
            Self::Rays(rays) => &**rays,
            Self::Beam(beam) => &**beam,
            Self::AreaBeam(beam) => &**beam,
            Self::Filtered(filtered) => filtered,
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

    fn is_weighted(&self) -> bool {
        self.inner().is_weighted()
    }

    fn weigh_block(&self, points: &[f64], weights: &mut [f64]) {
        self.inner().weigh_block(points, weights);
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
