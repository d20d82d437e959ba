//! The integral of one pixel.

use super::TracedScene;
use crate::integrand::Integrand;
use crate::scene::{Channel, PixelFrame};

/// A channel of the radiance over one pixel's square, by one ray through the BVH per point.
#[derive(Clone, Copy)]
pub struct PixelIntegrand<'a> {
    scene: &'a TracedScene,
    frame: PixelFrame,
    channel: Channel,
}

impl<'a> PixelIntegrand<'a> {
    pub(super) fn new(scene: &'a TracedScene, pixel: [u32; 2], channel: Channel) -> Self {
        Self { scene, frame: scene.scene().camera.pixel(pixel), channel }
    }
}

impl Integrand for PixelIntegrand<'_> {
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
