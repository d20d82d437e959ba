//! One path of rays per point: a pixel's integral in all the dimensions that its scene has.

use super::moment::{At, Moment, Still};
use super::scatter::{Direct, Scatter, WithAreaLights, WithPaths};
use super::{Ray, TracedScene};
use crate::integrand::Integrand;
use crate::scene::{Channel, Lens, Motion, PixelFrame, Rgb};
use glam::DVec3;

/// An integrand that has a colour at each point.
pub trait Radiance: Integrand {
    /// Linear RGB at a point of the unit cube.
    fn radiance(&self, point: &[f64]) -> Rgb;
}

/// Where a camera's rays start.
trait Eye: Send + Sync + Copy {
    const AXES: usize;
    /// The ray through `direction`, whose length along the view is 1.
    fn ray(self, eye: DVec3, direction: DVec3, at: &[f64]) -> Ray;
}

#[derive(Clone, Copy)]
struct Pinhole;

impl Eye for Pinhole {
    const AXES: usize = 0;
    #[inline(always)]
    fn ray(self, eye: DVec3, direction: DVec3, _: &[f64]) -> Ray {
        Ray { origin: eye, direction }
    }
}

#[derive(Clone, Copy)]
struct ThinLens {
    lens: Lens,
    right: DVec3,
    up: DVec3,
}

impl Eye for ThinLens {
    const AXES: usize = 2;
    #[inline(always)]
    fn ray(self, eye: DVec3, direction: DVec3, at: &[f64]) -> Ray {
        let [x, y] = self.lens.point(at[0], at[1]);
        let offset = self.right * x + self.up * y;
        // All rays of a direction meet in the plane of focus.
        Ray { origin: eye + offset, direction: direction - offset / self.lens.focus_distance }
    }
}

/// What becomes of the time axis.
trait Shutter: Send + Sync + Copy {
    const AXES: usize;
    type Moment: Moment;
    fn at(self, time: &[f64]) -> Self::Moment;
    fn eye(self, eye: DVec3, time: &[f64]) -> DVec3;
}

#[derive(Clone, Copy)]
struct Instant;

impl Shutter for Instant {
    const AXES: usize = 0;
    type Moment = Still;
    #[inline(always)]
    fn at(self, _: &[f64]) -> Still {
        Still
    }
    #[inline(always)]
    fn eye(self, eye: DVec3, _: &[f64]) -> DVec3 {
        eye
    }
}

#[derive(Clone, Copy)]
struct Open<'a> {
    motion: &'a Motion,
}

impl<'a> Shutter for Open<'a> {
    const AXES: usize = 1;
    type Moment = At<'a>;
    #[inline(always)]
    fn at(self, time: &[f64]) -> At<'a> {
        At { vertices: &self.motion.vertices, time: time[0] }
    }
    #[inline(always)]
    fn eye(self, eye: DVec3, time: &[f64]) -> DVec3 {
        eye + self.motion.camera * time[0]
    }
}

/// The integral of one pixel, compiled for the features that the scene has. The parts of a plain
/// one have no size and constant axes: there is nothing for its inner loop to branch on.
struct PixelRays<'a, E, T, S> {
    scene: &'a TracedScene,
    frame: PixelFrame,
    channel: Channel,
    eye: E,
    shutter: T,
    scatter: S,
}

/// The integral of a pixel by rays.
pub(super) fn rays<'a>(
    scene: &'a TracedScene,
    frame: PixelFrame,
    channel: Channel,
) -> Box<dyn Radiance + 'a> {
    match scene.scene().distribution.lens {
        None => with_eye(scene, frame, channel, Pinhole),
        Some(lens) => {
            let [_, right, up] = scene.scene().camera.frame();
            with_eye(scene, frame, channel, ThinLens { lens, right, up })
        }
    }
}

fn with_eye<'a>(
    scene: &'a TracedScene,
    frame: PixelFrame,
    channel: Channel,
    eye: impl Eye + 'a,
) -> Box<dyn Radiance + 'a> {
    match &scene.scene().distribution.motion {
        None => with_shutter(scene, frame, channel, eye, Instant),
        Some(motion) => with_shutter(scene, frame, channel, eye, Open { motion }),
    }
}

fn with_shutter<'a, E: Eye + 'a, T: Shutter + 'a>(
    scene: &'a TracedScene,
    frame: PixelFrame,
    channel: Channel,
    eye: E,
    shutter: T,
) -> Box<dyn Radiance + 'a> {
    let distribution = &scene.scene().distribution;
    if distribution.specular_depth > 0 || distribution.bounces > 0 {
        Box::new(PixelRays::<E, T, WithPaths>::new(scene, frame, channel, eye, shutter))
    } else if !distribution.lights.is_empty() {
        Box::new(PixelRays::<E, T, WithAreaLights>::new(scene, frame, channel, eye, shutter))
    } else {
        Box::new(PixelRays::<E, T, Direct>::new(scene, frame, channel, eye, shutter))
    }
}

impl<'a, E: Eye, T: Shutter, S: Scatter> PixelRays<'a, E, T, S> {
    fn new(
        scene: &'a TracedScene,
        frame: PixelFrame,
        channel: Channel,
        eye: E,
        shutter: T,
    ) -> Self {
        let distribution = &scene.scene().distribution;
        Self { scene, frame, channel, eye, shutter, scatter: S::of(distribution) }
    }
}

impl<E: Eye, T: Shutter, S: Scatter> Radiance for PixelRays<'_, E, T, S> {
    #[inline]
    fn radiance(&self, point: &[f64]) -> Rgb {
        let (square, rest) = point.split_at(2);
        let (lens, rest) = rest.split_at(E::AXES);
        let (lights, rest) = rest.split_at(self.scatter.light_axes());
        let (bounces, time) = rest.split_at(self.scatter.bounce_axes());
        let moment = self.shutter.at(time);
        let eye = self.shutter.eye(self.scene.scene().camera.eye, time);
        let ray = self.eye.ray(eye, self.frame.direction(square[0], square[1]), lens);
        S::radiance(self.scene, &ray, moment, lights, bounces)
    }
}

impl<E: Eye, T: Shutter, S: Scatter> Integrand for PixelRays<'_, E, T, S> {
    fn dim(&self) -> usize {
        2 + E::AXES + self.scatter.light_axes() + self.scatter.bounce_axes() + T::AXES
    }

    fn axes(&self) -> Vec<String> {
        self.scene.scene().distribution.axes()
    }

    fn eval(&self, point: &[f64]) -> f64 {
        self.channel.of(self.radiance(point))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a plain pixel is traced by has no byte that could tell of a feature, so that its
    /// inner loop has nothing to branch on; each feature brings its own.
    #[test]
    fn what_is_absent_has_no_size() {
        const PLAIN: usize = size_of::<(&TracedScene, PixelFrame, Channel)>();
        let plain = size_of::<PixelRays<'_, Pinhole, Instant, Direct>>();
        assert_eq!(plain, PLAIN);
        assert_eq!(size_of::<Still>(), 0);
        for with in [
            size_of::<PixelRays<'_, ThinLens, Instant, Direct>>(),
            size_of::<PixelRays<'_, Pinhole, Open<'_>, Direct>>(),
            size_of::<PixelRays<'_, Pinhole, Instant, WithAreaLights>>(),
            size_of::<PixelRays<'_, Pinhole, Instant, WithPaths>>(),
        ] {
            assert!(with > plain, "{with}");
        }
    }
}
