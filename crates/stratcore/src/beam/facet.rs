//! A triangle in the coordinates of one pixel.
//!
//! For a fixed eye the edge functions of a triangle and the inverse of its ray parameter are
//! affine in the position within the pixel (Olano & Greer, *Triangle Scan Conversion using 2D
//! Homogeneous Coordinates*, 1997), also when the triangle crosses the plane of the eye. They
//! are set up in f64 relative to eye and pixel, so a sample is exact to the pixel and not to
//! the world.

use crate::beam::affine::{Affine, CentredFrame};
use crate::beam::gather::{Frustum, Seen};
use glam::DVec3;

/// What a pixel needs of a triangle that may be seen in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    /// The triangle's index in the mesh; the lower one wins a tie.
    pub triangle: u32,
    /// Inside where none is negative. Each scaled to a largest coefficient of 1. The edge that
    /// two triangles share has opposite functions, bit for bit.
    pub edges: [Affine; 3],
    /// 1/t, t the ray parameter of the hit; positive before the eye.
    pub inverse_depth: Affine,
    /// Greatest 1/t of its part of the pixel, at the least.
    pub nearest: f64,
    /// Unit normal, towards the eye.
    pub normal: DVec3,
    /// Distance of the triangle's plane from the eye, not negative.
    pub plane_distance: f64,
    /// Lies between these rows, t of the pixel, to a rounding of 1e-9.
    pub rows: [f64; 2],
}

impl Facet {
    /// None for a triangle that has no area, is seen edge-on, or lies outside the pixel for
    /// certain.
    pub fn new(
        corner: &[DVec3; 3],
        id: u32,
        eye: DVec3,
        centred: &CentredFrame,
        frustum: &Frustum,
    ) -> Option<Self> {
        let relative = corner.map(|p| p - eye);
        let Seen { rows, inverse_depth: corner_inverse_depth } = frustum.seen(&relative)?;
        let normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        let length = normal.length();
        let distance = relative[0].dot(normal) / length;
        // Also leaves out what is not a number.
        if !(distance.abs() > 0.0 && length > 0.0) {
            return None;
        }
        let orientation = distance.signum();
        let mut edges = [Affine::default(); 3];
        for (edge, (p, q, sign)) in edges.iter_mut().zip(ordered_edges(corner)) {
            // The difference of ends that lie close together is free of rounding, which p × q
            // itself is not.
            let plane = relative[p].cross(corner[q] - corner[p]);
            let function = Affine::dot(plane, centred);
            let magnitude = function.magnitude();
            if magnitude <= 0.0 || magnitude.is_nan() {
                return None;
            }
            *edge = function.scaled(sign * orientation / magnitude);
            if edge.c + edge.radius() < -1e-9 {
                return None;
            }
        }
        let normal = normal * (orientation / length);
        let inverse_depth = Affine::dot(normal, centred).scaled(distance.abs().recip());
        let nearest = (inverse_depth.c + inverse_depth.radius()).min(corner_inverse_depth);
        (nearest > 0.0 && inverse_depth.magnitude().is_finite()).then_some(Self {
            triangle: id,
            edges,
            inverse_depth,
            nearest,
            normal: -normal,
            plane_distance: distance.abs(),
            rows,
        })
    }

    /// 1/t at a position in the pixel where the triangle is hit.
    pub fn hit(&self, s: f64, t: f64) -> Option<f64> {
        let inside = self.edges.iter().all(|edge| edge.at(s, t) >= 0.0);
        let inverse_depth = self.inverse_depth.at(s, t);
        (inside && inverse_depth > 0.0).then_some(inverse_depth)
    }

    /// Whether every position in the pixel is inside by more than rounding.
    pub fn covers(&self) -> bool {
        self.edges.iter().all(|edge| edge.c - edge.radius() > 1e-9)
    }

    /// Least 1/t of its plane over the pixel.
    pub fn farthest_in_pixel(&self) -> f64 {
        self.inverse_depth.c - self.inverse_depth.radius()
    }
}

/// A triangle's edges as (from, to, sign): from and to in one order for both triangles that
/// share the edge, so that their functions cancel exactly, and -1 where that turns it round.
pub(super) fn ordered_edges(corner: &[DVec3; 3]) -> [(usize, usize, f64); 3] {
    let key = |i: usize| (corner[i].x, corner[i].y, corner[i].z);
    [(0, 1), (1, 2), (2, 0)]
        .map(|(from, to)| if key(from) < key(to) { (from, to, 1.0) } else { (to, from, -1.0) })
}
