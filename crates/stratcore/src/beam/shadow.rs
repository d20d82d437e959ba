//! Shadows in the coordinates of one pixel.
//!
//! On a flat receiver the hit is P = D/w with w affine, so that (P - l) w = D - l w is affine for
//! a light at l, and (P - o) w for any point o. Whether the line from the light to P passes
//! inside a triangle's three edges, and whether P lies beyond the triangle's plane, are
//! therefore four affine conditions on the position in the pixel, as for a facet itself. A
//! directional light is the same with the edges' planes along its direction.

use crate::beam::affine::{Affine, CentredFrame};
use crate::beam::facet::{Facet, ordered_edges};
use crate::beam::pixel::lanes;
use crate::scene::{Light, Scene};
use crate::simd::Lanes4;
use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;

/// A triangle that may stand between a receiver and the light: it does where no condition is
/// negative.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Occluder {
    conditions: [Affine; 4],
}

impl Occluder {
    pub fn blocks(&self, s: f64, t: f64) -> bool {
        self.conditions.iter().all(|condition| condition.at(s, t) >= 0.0)
    }

    pub fn conditions(&self) -> &[Affine; 4] {
        &self.conditions
    }

    pub fn lanes(&self) -> Lanes4 {
        lanes(self.conditions)
    }

    /// None for a triangle that shadows nothing of the receiver in the pixel.
    fn new(
        scene: &Scene,
        id: u32,
        light: &Light,
        receiver: &Facet,
        centred: &CentredFrame,
    ) -> Option<Self> {
        let eye = scene.camera.eye;
        let corner = scene.mesh.corners(id as usize);
        let normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        // Lines run from the light: from `corner - source`, or all along one direction.
        let (side, along) = match light {
            Light::Point { position, .. } => {
                (normal.dot(corner[0] - *position), Line::From(*position))
            }
            Light::Directional { towards, .. } => (-normal.dot(*towards), Line::Along(-*towards)),
            Light::Off | Light::Headlight => return None,
        };
        if side == 0.0 || !side.is_finite() {
            return None;
        }
        let w = &receiver.inverse_depth;
        // n · (P - o) w, for a point o of the scene.
        let beyond = |n: DVec3, o: DVec3| {
            let (direct, shift) = (Affine::dot(n, centred), w.scaled(-n.dot(o - eye)));
            let sum = direct.plus(shift);
            (sum, direct.magnitude().max(shift.magnitude()))
        };
        let mut conditions = [Affine::default(); 4];
        for (condition, (from, to, sign)) in conditions.iter_mut().zip(ordered_edges(&corner)) {
            let (p, q) = (corner[from], corner[to]);
            let plane = match along {
                Line::From(source) => (p - source).cross(q - p),
                Line::Along(direction) => direction.cross(q - p),
            };
            let (function, _) = beyond(plane, p);
            *condition = scaled(function, function.magnitude(), sign * side.signum())?;
        }
        let (function, magnitude) = beyond(normal, corner[0]);
        let function = scaled(function, magnitude, side.signum())?;
        // Rounding is all that a coplanar neighbour is beyond.
        if function.c + function.radius() < 1e-10 {
            return None;
        }
        conditions[3] = scaled(function, function.magnitude(), 1.0)?;
        let possible = conditions.iter().all(|f| f.c + f.radius() >= -1e-9);
        possible.then_some(Self { conditions })
    }
}

/// How light travels.
enum Line {
    From(DVec3),
    Along(DVec3),
}

fn scaled(function: Affine, magnitude: f64, sign: f64) -> Option<Affine> {
    (magnitude > 0.0).then(|| function.scaled(sign / magnitude))
}

/// Appends the triangles that may shadow `receiver` in the pixel.
pub(crate) fn occluders(
    scene: &Scene,
    bvh: &Bvh2,
    receiver: &Facet,
    centred: &CentredFrame,
    out: &mut Vec<Occluder>,
) {
    let eye = scene.camera.eye;
    let patch = || patch(scene, receiver, centred);
    let shaft = match scene.light {
        Light::Off | Light::Headlight => return,
        Light::Point { position, .. } => Shaft::between([position - eye; 2], patch()),
        Light::Directional { towards, .. } => {
            Shaft { start: patch(), run: [towards; 2], end: f64::INFINITY }
        }
    };
    shaft.visit(bvh, |id| {
        // By its own box, not its leaf's: what is found does not depend on the tree.
        let corners = scene.mesh.corners(id as usize).map(|p| p - eye);
        if id != receiver.triangle && shaft.touches_triangle(&corners) {
            out.extend(Occluder::new(scene, id, &scene.light, receiver, centred));
        }
    });
}

/// Triangles that may stand between `receiver`'s part of the pixel and a light within a box,
/// relative to the eye.
pub(super) fn between(
    scene: &Scene,
    bvh: &Bvh2,
    receiver: &Facet,
    centred: &CentredFrame,
    light: [DVec3; 2],
) -> Vec<u32> {
    let eye = scene.camera.eye;
    let shaft = Shaft::between(light, patch(scene, receiver, centred));
    let mut found = Vec::new();
    shaft.visit(bvh, |id| {
        let corners = scene.mesh.corners(id as usize).map(|p| p - eye);
        // What lies behind the receiver's plane, or in it to rounding, shadows nothing on it.
        let faces = corners.iter().any(|p| {
            receiver.normal.dot(*p) + receiver.plane_distance > 1e-10 * receiver.plane_distance
        });
        if id != receiver.triangle && faces && shaft.touches_triangle(&corners) {
            found.push(id);
        }
    });
    found
}

fn bounds(points: &[DVec3]) -> [DVec3; 2] {
    points
        .iter()
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| [lo.min(*p), hi.max(*p)])
}

/// A box around what the pixel sees of the receiver, relative to the eye.
fn patch(scene: &Scene, receiver: &Facet, centred: &CentredFrame) -> [DVec3; 2] {
    let corners = scene.mesh.corners(receiver.triangle as usize).map(|p| p - scene.camera.eye);
    let [mut lo, mut hi] = bounds(&corners);
    let pixel = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
        .map(|(s, t)| (receiver.inverse_depth.at(s, t), centred.direction(s, t)));
    if pixel.iter().all(|(w, _)| *w > 0.0) {
        let [from, to] = bounds(&pixel.map(|(w, direction)| direction / w));
        [lo, hi] = [lo.max(from), hi.min(to)];
    }
    // Wider than the rounding of either box, which may leave lo above hi.
    let slack = DVec3::splat(1e-9 * lo.abs().max(hi.abs()).max_element());
    [lo.min(hi) - slack, hi.max(lo) + slack]
}

/// All points start + τ run, 0 ≤ τ ≤ end, start and run each within a box.
struct Shaft {
    start: [DVec3; 2],
    run: [DVec3; 2],
    end: f64,
}

impl Shaft {
    /// Everything between a light within one box and a receiver within another.
    fn between(light: [DVec3; 2], receiver: [DVec3; 2]) -> Self {
        Self { start: light, run: [receiver[0] - light[0], receiver[1] - light[1]], end: 1.0 }
    }

    /// Shows `visit` the triangles of the tree's leaves that the shaft touches.
    fn visit(&self, bvh: &Bvh2, mut visit: impl FnMut(u32)) {
        let mut stack = vec![0u32];
        while let Some(node) = stack.pop().and_then(|index| bvh.nodes.get(index as usize)) {
            if !self.touches(&node.aabb) {
                continue;
            }
            if node.prim_count == 0 {
                stack.extend([node.first_index + 1, node.first_index]);
                continue;
            }
            let first = node.first_index as usize;
            let leaf = &bvh.primitive_indices[first..first + node.prim_count as usize];
            leaf.iter().for_each(|id| visit(*id));
        }
    }

    /// Whether the shaft may touch a triangle, by its box.
    fn touches_triangle(&self, corners: &[DVec3; 3]) -> bool {
        let [lo, hi] = bounds(corners).map(|p| p.as_vec3a());
        let slack = lo.abs().max(hi.abs()) * f32::EPSILON;
        self.touches(&Aabb::new(lo - slack, hi + slack))
    }

    /// False only when no τ brings the shaft into the box: each side of the box bounds τ from
    /// one end.
    fn touches(&self, aabb: &Aabb) -> bool {
        let (mut first, mut last) = (0.0f64, self.end);
        // Keeps the τ with offset + τ slope ≥ 0, a little more for rounding.
        let mut keep = |offset: f64, slope: f64, size: f64| {
            let offset = offset + 1e-9 * size;
            if slope > 0.0 {
                first = first.max(-offset / slope);
            } else if slope < 0.0 {
                last = last.min(offset / -slope);
            } else if offset < 0.0 {
                last = f64::NEG_INFINITY;
            }
        };
        for axis in 0..3 {
            let (lo, hi) = (f64::from(aabb.min[axis]), f64::from(aabb.max[axis]));
            let size = lo.abs().max(hi.abs());
            let start = self.start.map(|p| p[axis]);
            let size = size.max(start[0].abs()).max(start[1].abs());
            keep(start[1] - lo, self.run[1][axis], size);
            keep(hi - start[0], -self.run[0][axis], size);
        }
        // τ of a light that is infinitely far is a length of the scene.
        let size = if last.is_finite() { first.max(last.abs()) } else { 0.0 };
        first <= last + 2e-9 * size
    }
}
