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
        Self { columns, rows, forward, normals }
    }

    /// The rows of the pixel that a triangle reaches, from t to t, no fewer than there are;
    /// none if it is certainly outside one of the four sides.
    #[inline(always)]
    pub fn rows_of(&self, corners: &[DVec3; 3]) -> Option<[f64; 2]> {
        let size = corners.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
        let scale = self.columns.abs().max(self.rows.abs()).max_element() + 1.0;
        let slack = -1e-12 * size * scale;
        let [mut left, mut right, mut above, mut below] = [f64::NEG_INFINITY; 4];
        let mut nearest = f64::INFINITY;
        for p in corners {
            let half = 0.5 * p.dot(self.forward);
            let (s, t) = (p.dot(self.columns), p.dot(self.rows));
            left = left.max(half + s);
            right = right.max(half - s);
            above = above.max(half + t);
            below = below.max(half - t);
            nearest = nearest.min(half);
        }
        if left.min(right).min(above.min(below)) < slack {
            return None;
        }
        if nearest <= 1e-9 * size {
            return Some([-0.5, 0.5]);
        }
        let mut reach = [f64::INFINITY, f64::NEG_INFINITY];
        for p in corners {
            let t = p.dot(self.rows) / p.dot(self.forward);
            reach = [reach[0].min(t), reach[1].max(t)];
        }
        Some([reach[0].max(-0.5), reach[1].min(0.5)])
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
