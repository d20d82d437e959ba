//! Which triangles can a pixel see? One walk of the BVH with the pixel's four planes.

use crate::beam::affine::CentredFrame;
use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;

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
        let normals = std::array::from_fn(|axis| sides.map(|n| n[axis] as f32));
        let scale = columns.abs().max(rows.abs()).max(forward.abs()).max_element();
        Self { columns, rows, forward, scale, normals }
    }

    /// The rows of the pixel that a triangle reaches, from t to t, no fewer than there are;
    /// none if it is certainly outside one of the pixel's sides, or the pixel outside one of
    /// its own.
    #[inline(always)]
    pub fn rows_of(&self, corners: &[DVec3; 3]) -> Option<[f64; 2]> {
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
        if a.z.min(b.z).min(c.z) <= 1e-9 * size {
            return Some([-0.5, 0.5]);
        }
        let [a, b, c] = [a.y / a.z, b.y / b.z, c.y / c.z];
        Some([a.min(b).min(c).max(-0.5), a.max(b).max(c).min(0.5)])
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

/// Calls `visit` with the primitives of each leaf that the pyramid may touch, nearer ones
/// first as far as the tree knows. `visit` returns the view depth beyond which nothing can be
/// seen any more.
pub(crate) fn gather(bvh: &Bvh2, frustum: &Frustum, mut visit: impl FnMut(&[u32]) -> f32) {
    let Some(root) = bvh.nodes.first() else { return };
    if !frustum.touches(&root.aabb) {
        return;
    }
    let mut horizon = f32::INFINITY;
    let mut stack = Vec::with_capacity(64);
    stack.push((0u32, frustum.nearest(&root.aabb)));
    while let Some((index, nearest)) = stack.pop() {
        if nearest > horizon {
            continue;
        }
        let node = &bvh.nodes[index as usize];
        if node.prim_count > 0 {
            let first = node.first_index as usize;
            horizon = visit(&bvh.primitive_indices[first..first + node.prim_count as usize]);
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
}
