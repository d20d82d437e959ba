//! Which triangles can a pixel see? One walk of the BVH with the pixel's four planes.

use crate::beam::affine::CentredFrame;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;

/// The pixel's pyramid from the eye.
pub(crate) struct Frustum {
    /// Inward unit normals of the four sides.
    sides: [DVec3; 4],
    /// The same by component, for conservative tests in f32.
    normals: [[f32; 4]; 3],
    /// View direction: depth along it is the ray parameter of the pixel's directions.
    forward: Vec3A,
}

impl Frustum {
    /// `forward` is the camera's, along which every direction of the pixel has length 1.
    pub fn new(centred: &CentredFrame, forward: DVec3) -> Self {
        let corner = |s, t| centred.direction(s, t);
        let corners = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
        let sides = std::array::from_fn(|side| {
            let n = corners[side].cross(corners[(side + 1) % 4]).normalize();
            if n.dot(centred.dc) < 0.0 { -n } else { n }
        });
        let normals = std::array::from_fn(|axis| sides.map(|n: DVec3| n[axis] as f32));
        Self { sides, normals, forward: forward.as_vec3a() }
    }

    /// Whether one side has all three points outside it, by more than rounding.
    #[inline(always)]
    pub fn misses(&self, points: &[DVec3; 3]) -> bool {
        let slack = -1e-12 * points.iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
        self.sides.iter().any(|n| points.iter().all(|p| n.dot(*p) < slack))
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
        let (a, b) = (self.forward * aabb.min, self.forward * aabb.max);
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
