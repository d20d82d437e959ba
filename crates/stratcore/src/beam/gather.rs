//! Which triangles can a pixel see? One walk of the BVH with the pixel's four planes.

use crate::beam::affine::CentredFrame;
use crate::simd::{self, Isa};
use crate::trace::Accel;
use glam::DVec3;
use obvhs::aabb::Aabb;
use std::array::from_fn;

/// Triangles that are sieved together.
const BATCH: usize = 16;
/// Triangles that pass and are shown together, at first and at most: more and more of them, for
/// where the first few hide nothing, the next will not either.
const PATIENCE: [usize; 2] = [2, 64];

/// The pixel's pyramid from the eye.
pub(crate) struct Frustum {
    /// A point P relative to the eye is seen at (s, t) = (P·columns, P·rows) / P·forward.
    columns: DVec3,
    rows: DVec3,
    /// View direction: P·forward is the ray parameter of the pixel's directions.
    forward: DVec3,
    /// Largest component of the three.
    scale: f64,
    /// Inward unit normals of the four sides by component, for conservative tests in f32.
    normals: [[f32; 4]; 3],
    /// Columns, rows and forward, for the same, and the largest sum of components of one.
    axes: [[f32; 3]; 3],
    reach: f32,
}

/// What a pixel sees of a triangle, at the most.
pub(crate) struct Seen {
    /// From row to row, t of the pixel.
    pub rows: [f64; 2],
    /// Greatest 1/t of its corners; infinite if one is behind the eye, or nearly.
    pub inverse_depth: f64,
}

impl Frustum {
    pub fn new(centred: &CentredFrame) -> Self {
        let CentredFrame { dc, du, dv } = *centred;
        let volume = du.cross(dv).dot(dc);
        let [columns, rows, forward] =
            [dv.cross(dc), dc.cross(du), du.cross(dv)].map(|n| n / volume);
        let sides = [forward * 0.5 + columns, forward * 0.5 - columns, forward * 0.5 + rows]
            .map(DVec3::normalize);
        let sides = [sides[0], sides[1], sides[2], (forward * 0.5 - rows).normalize()];
        let normals = from_fn(|axis| sides.map(|n| n[axis] as f32));
        let scale = columns.abs().max(rows.abs()).max(forward.abs()).max_element();
        let axes = [columns, rows, forward];
        let reach = axes.map(|n| n.abs().element_sum()).into_iter().fold(0.0, f64::max) as f32;
        let axes = axes.map(|n| n.as_vec3().to_array());
        Self { columns, rows, forward, scale, normals, axes, reach }
    }

    /// None if the triangle is certainly outside one of the pixel's sides, or the pixel outside
    /// one of its own.
    #[inline(always)]
    pub fn seen(&self, corners: &[DVec3; 3]) -> Option<Seen> {
        // Seen at (x, y) / z.
        let [a, b, c] =
            corners.map(|p| DVec3::new(p.dot(self.columns), p.dot(self.rows), p.dot(self.forward)));
        let size = a.abs().max(b.abs()).max(c.abs()).max_element() + self.terms(corners);
        let slack = -1e-12 * size;
        let outside = |side: fn(DVec3) -> f64| side(a).max(side(b)).max(side(c)) < slack;
        if outside(|p| 0.5 * p.z + p.x)
            || outside(|p| 0.5 * p.z - p.x)
            || outside(|p| 0.5 * p.z + p.y)
            || outside(|p| 0.5 * p.z - p.y)
        {
            return None;
        }
        let volume = a.dot(b.cross(c));
        let before = |p: DVec3, q: DVec3| {
            let edge = p.cross(q);
            edge.z * volume.signum() + 0.5 * (edge.x.abs() + edge.y.abs()) < slack * size
        };
        // Seen edge-on, it has no sides to speak of.
        let has_sides = volume.abs() > -slack * size * size;
        if has_sides && (before(a, b) || before(b, c) || before(c, a)) {
            return None;
        }
        let least = a.z.min(b.z).min(c.z);
        if least <= 1e-9 * size {
            return Some(Seen { rows: [-0.5, 0.5], inverse_depth: f64::INFINITY });
        }
        let [a, b, c] = [a.y / a.z, b.y / b.z, c.y / c.z];
        let rows = [a.min(b).min(c).max(-0.5), a.max(b).max(c).min(0.5)];
        // Depths round by far less than 1e-12 of `size`.
        Some(Seen { rows, inverse_depth: (least - 1e-12 * size).recip() })
    }

    /// The size of the terms that the sides' dot products add up.
    #[inline(always)]
    fn terms(&self, corners: &[DVec3; 3]) -> f64 {
        let [a, b, c] = corners.map(DVec3::abs);
        a.max(b).max(c).max_element() * self.scale
    }

    /// Whether some point of the box may lie in the pyramid: false only when one plane has all
    /// of the box outside by more than rounding.
    #[inline(always)]
    fn touches(&self, aabb: &Aabb) -> bool {
        // 2^-20 of the terms' magnitude: eight times the rounding of normals, products and sums.
        const SLACK: f32 = 1.0 / (1 << 20) as f32;
        let mut reach = [0.0f32; 4];
        let mut size = [0.0f32; 4];
        for axis in 0..3 {
            let (lo, hi) = (aabb.min[axis], aabb.max[axis]);
            for side in 0..4 {
                let n = self.normals[axis][side];
                let (a, b) = (n * lo, n * hi);
                reach[side] += a.max(b);
                size[side] += a.abs().max(b.abs());
            }
        }
        (0..4).all(|side| reach[side] >= -SLACK * size[side])
    }

    /// A lower bound of the view depth of the box's points.
    #[inline(always)]
    fn nearest(&self, aabb: &Aabb) -> f32 {
        let forward = self.forward.as_vec3a();
        let (a, b) = (forward * aabb.min, forward * aabb.max);
        let size = a.abs().max(b.abs()).element_sum();
        a.min(b).element_sum() - size / (1 << 20) as f32
    }
}

/// Calls `visit` with the slots of the triangles of the leaves that the pyramid may touch, but for those
/// that are certainly not seen in it; some at a time, nearer leaves first as far as the tree
/// knows. `visit` returns the view depth beyond which nothing can be seen any more.
pub(crate) fn gather(accel: &Accel, frustum: &Frustum, mut visit: impl FnMut(&[u32]) -> f32) {
    let bvh = accel.bvh();
    let Some(root) = bvh.nodes.first() else { return };
    if !frustum.touches(&root.aabb) {
        return;
    }
    let mut batch = Batch::default();
    let mut found = Vec::with_capacity(PATIENCE[1] + BATCH);
    let [mut patience, _] = PATIENCE;
    let mut horizon = f32::INFINITY;
    let mut stack = Vec::with_capacity(64);
    stack.push((0u32, frustum.nearest(&root.aabb)));
    while let Some((index, nearest)) = stack.pop() {
        if nearest > horizon {
            continue;
        }
        let node = &bvh.nodes[index as usize];
        if node.prim_count > 0 {
            for slot in node.first_index..node.first_index + node.prim_count {
                batch.add(slot, &accel.corners()[slot as usize], accel.eye());
                if batch.len == BATCH {
                    batch.sieve(frustum, &mut found);
                    if found.len() >= patience {
                        horizon = visit(&found);
                        found.clear();
                        patience = PATIENCE[1].min(2 * patience);
                    }
                }
            }
            continue;
        }
        let child = |index: u32| {
            let aabb = &bvh.nodes[index as usize].aabb;
            frustum.touches(aabb).then(|| (index, frustum.nearest(aabb)))
        };
        match (child(node.first_index), child(node.first_index + 1)) {
            (Some(a), Some(b)) => {
                let (near, far) = if a.1 <= b.1 { (a, b) } else { (b, a) };
                stack.extend([far, near]);
            }
            (one, other) => stack.extend(one.or(other)),
        }
    }
    batch.sieve(frustum, &mut found);
    visit(&found);
}

/// Triangles that wait to be sieved, corner by corner and component by component.
#[derive(Default)]
struct Batch {
    len: usize,
    slots: [u32; BATCH],
    corners: [[[f32; BATCH]; 3]; 3],
}

impl Batch {
    #[inline(always)]
    fn add(&mut self, slot: u32, corners: &[DVec3; 3], eye: DVec3) {
        for (to, corner) in self.corners.iter_mut().zip(corners) {
            let relative = (*corner - eye).as_vec3().to_array();
            for (to, x) in to.iter_mut().zip(relative) {
                to[self.len] = x;
            }
        }
        self.slots[self.len] = slot;
        self.len += 1;
    }

    /// Empties the batch; what passes is appended to `found`.
    fn sieve(&mut self, frustum: &Frustum, found: &mut Vec<u32>) {
        let mut outside = [false; BATCH];
        let Frustum { axes, reach, .. } = frustum;
        let (corners, outside_of) = (&self.corners, &mut outside);
        simd::run(Isa::detect(), Sieve { axes, reach: *reach, corners, outside: outside_of });
        for (slot, outside) in self.slots[..self.len].iter().zip(outside) {
            if !outside {
                found.push(*slot);
            }
        }
        self.len = 0;
    }
}

/// Finds the triangles that are certainly outside one of the pixel's sides, or have the pixel
/// outside one of their own.
struct Sieve<'a> {
    axes: &'a [[f32; 3]; 3],
    reach: f32,
    corners: &'a [[[f32; BATCH]; 3]; 3],
    outside: &'a mut [bool; BATCH],
}

impl simd::Loop for Sieve<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        // Coordinates, axes, products and sums round by five times 2^-24 of their terms at most.
        let slack = self.reach / (1 << 20) as f32;
        let max = |a: f32, b: f32| if a > b { a } else { b };
        let max3 = |[a, b, c]: [f32; 3]| max(max(a, b), c);
        let largest = |p: [f32; 3]| max3(p.map(f32::abs));
        for l in 0..BATCH {
            let corners: [[f32; 3]; 3] =
                from_fn(|corner| from_fn(|axis| self.corners[corner][axis][l]));
            let dot = |n: [f32; 3], p: [f32; 3]| n[0] * p[0] + n[1] * p[1] + n[2] * p[2];
            // Seen at (x, y) / z, as in `Frustum::seen`, each component wrong by `error` at most.
            let seen = corners.map(|p| self.axes.map(|n| dot(n, p)));
            let error = max3(corners.map(largest)) * slack + f32::MIN_POSITIVE;
            let side = |f: fn([f32; 3]) -> f32| max3(seen.map(f)) < -2.0 * error;
            let beside = side(|[x, _, z]| 0.5 * z + x)
                | side(|[x, _, z]| 0.5 * z - x)
                | side(|[_, y, z]| 0.5 * z + y)
                | side(|[_, y, z]| 0.5 * z - y);
            // An edge's function has products of two components, wrong by 2 · size · error.
            let size = max3(seen.map(largest)) + error;
            let cross = |p: [f32; 3], q: [f32; 3]| {
                [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
            };
            let [a, b, c] = seen;
            let edges = [cross(a, b), cross(b, c), cross(c, a)];
            let volume = dot(a, edges[1]);
            let turn = if volume < 0.0 { -1.0 } else { 1.0 };
            let before =
                |e: [f32; 3]| e[2] * turn + 0.5 * (e[0].abs() + e[1].abs()) < -16.0 * size * error;
            let has_sides = volume.abs() > 64.0 * size * size * error;
            let within = has_sides & (before(edges[0]) | before(edges[1]) | before(edges[2]));
            self.outside[l] = beside | within;
        }
    }
}
