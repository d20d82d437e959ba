//! Which triangles can a pixel see? One walk of the BVH with the pixel's four planes.

use crate::beam::affine::CentredFrame;
use crate::beam::numbers::{cross, dot, largest, max3};
use crate::simd::{self, Isa};
use crate::trace::{Accel, LEAF};
use glam::{DVec3, Vec3A, Vec4};
use obvhs::aabb::Aabb;
use std::array::from_fn;

/// From so many triangles on those found are sieved.
const BATCH: usize = 16;
/// Triangles that pass and are shown together, at first and at most: more and more of them, for
/// where the first few hide nothing, the next will not either.
const PATIENCE: [usize; 2] = [2, 64];
/// Nodes that are opened together, at most: their memory and their arithmetic then overlap.
const WIDTH: usize = 4;
/// Lanes of the sieve: a multiple of every vector's length.
const LANES: usize = 32;

/// The pixel's pyramid from the eye.
pub(super) struct Frustum {
    /// A point P relative to the eye is seen at (s, t) = (P·columns, P·rows) / P·forward.
    pub columns: DVec3,
    pub rows: DVec3,
    /// View direction: P·forward is the ray parameter of the pixel's directions.
    pub forward: DVec3,
    /// Largest component of the three.
    pub scale: f64,
    /// Inward unit normals of the four sides by component, for conservative tests of boxes in
    /// f32: what is positive of them, which a box's upper end reaches farthest along, and what
    /// is negative.
    positive: [Vec4; 3],
    negative: [Vec4; 3],
    /// Forward likewise, and its largest component.
    forward_positive: Vec3A,
    forward_negative: Vec3A,
    forward_scale: f32,
    /// Columns, rows and forward, for the same of triangles, and the largest sum of components
    /// of one.
    axes: [[f32; 3]; 3],
    reach: f32,
}

impl Frustum {
    pub fn new(centred: &CentredFrame) -> Self {
        let CentredFrame { dc, du, dv } = *centred;
        let volume = du.cross(dv).dot(dc);
        let [columns, rows, forward] =
            [dv.cross(dc), dc.cross(du), du.cross(dv)].map(|n| n / volume);
        let sides = [columns, -columns, rows, -rows].map(|n| (forward * 0.5 + n).normalize());
        let normals: [Vec4; 3] = from_fn(|axis| Vec4::from_array(sides.map(|n| n[axis] as f32)));
        let scale = columns.abs().max(rows.abs()).max(forward.abs()).max_element();
        let axes = [columns, rows, forward];
        let reach = axes.map(|n| n.abs().element_sum()).into_iter().fold(0.0, f64::max) as f32;
        let axes = axes.map(|n| n.as_vec3().to_array());
        let ahead = forward.as_vec3a();
        Self {
            columns,
            rows,
            forward,
            scale,
            positive: normals.map(|n| n.max(Vec4::ZERO)),
            negative: normals.map(|n| n.min(Vec4::ZERO)),
            forward_positive: ahead.max(Vec3A::ZERO),
            forward_negative: ahead.min(Vec3A::ZERO),
            forward_scale: ahead.abs().max_element(),
            axes,
            reach,
        }
    }

    /// Whether some point of the box may lie in the pyramid, false only when one plane has all
    /// of the box outside by more than rounding; and a lower bound of the view depth of its
    /// points.
    #[inline(always)]
    fn meets(&self, aabb: &Aabb) -> (bool, f32) {
        let Aabb { min, max } = *aabb;
        // 2^-20 of the terms' magnitude: three times the rounding of normals, products and sums.
        let slack = min.abs().max(max.abs()).element_sum() / (1 << 20) as f32;
        let mut reach = Vec4::splat(slack);
        for axis in 0..3 {
            reach += self.positive[axis] * max[axis] + self.negative[axis] * min[axis];
        }
        let nearest = (self.forward_positive * min + self.forward_negative * max).element_sum();
        (!reach.cmplt(Vec4::ZERO).any(), nearest - slack * self.forward_scale)
    }
}

/// Calls `visit` with the triangles of the leaves that the pyramid may touch, but for those that
/// are certainly not seen in it; some at a time, nearer leaves first as far as the tree knows.
/// `visit` returns the view depth beyond which nothing can be seen any more.
pub(super) fn gather(
    isa: Isa,
    accel: &Accel,
    frustum: &Frustum,
    mut visit: impl FnMut(&[u32]) -> f32,
) {
    let (nodes, corners, ids) =
        (&accel.bvh().nodes[..], accel.rounded_corners(), accel.triangles());
    let Some(root) = nodes.first() else { return };
    let mut found = Vec::with_capacity(PATIENCE[1] + 2 * LANES);
    let [mut patience, _] = PATIENCE;
    let mut horizon = f32::INFINITY;
    // Of triangles in leaves, not yet sieved.
    let mut slots = [0u32; BATCH + (2 * WIDTH + 1) * LEAF];
    let mut n_slots = 0;
    // Of pairs of nodes to be opened, the first, with the depth of what holds both.
    let mut stack = vec![(0u32, 0f32); 64];
    let mut top = 0;
    if root.is_leaf() {
        n_slots = root.prim_count as usize;
        slots[..n_slots].copy_from_slice(&from_fn::<u32, LEAF, _>(|k| k as u32)[..n_slots]);
    } else {
        stack[0] = (root.first_index, f32::NEG_INFINITY);
        top = 1;
    }
    loop {
        let n_taken = top.min((patience / 2).min(WIDTH));
        top -= n_taken;
        if stack.len() < top + 2 * WIDTH {
            stack.resize(2 * stack.len(), (0, 0.0));
        }
        let mut taken = [(0, 0.0); WIDTH];
        taken.copy_from_slice(&stack[top..top + WIDTH]);
        for (first, nearest) in &taken[..n_taken] {
            if *nearest > horizon {
                continue;
            }
            let children = &nodes[*first as usize..*first as usize + 2];
            let met = [frustum.meets(&children[0].aabb), frustum.meets(&children[1].aabb)];
            let near = usize::from(met[1].1 < met[0].1);
            // What a child is, and whether it is met, no processor guesses: both lists are
            // written, and one grows.
            for at in [1 - near, near] {
                let (child, (touched, nearest)) = (&children[at], met[at]);
                let is_hidden = nearest > horizon;
                let (is_open, is_leaf) = (touched & !is_hidden, child.is_leaf());
                // Read later, and in no cache if the tree is large. Each child is the one or the
                // other, and the first items are there anyway.
                let first = child.first_index as usize;
                let [leaf, inner] = if is_leaf { [first, 0] } else { [0, first] };
                simd::prefetch(nodes, inner);
                simd::prefetch(nodes, inner + 1);
                simd::prefetch(corners, leaf);
                simd::prefetch(ids, leaf);
                stack[top] = (child.first_index, nearest);
                top += usize::from(is_open & !is_leaf);
                for (k, slot) in slots[n_slots..n_slots + LEAF].iter_mut().enumerate() {
                    *slot = child.first_index.wrapping_add(k as u32);
                }
                n_slots += usize::from(is_open) * child.prim_count as usize;
            }
        }
        if n_slots >= BATCH || top == 0 {
            sieve(isa, accel, frustum, &slots[..n_slots], &mut found);
            n_slots = 0;
        }
        if found.len() >= patience || top == 0 {
            horizon = visit(&found);
            found.clear();
            patience = PATIENCE[1].min(2 * patience);
        }
        if top == 0 {
            return;
        }
    }
}

/// Appends to `found` the triangles in `slots`, but for those that are certainly outside one of
/// the pixel's sides or have the pixel outside one of their own.
fn sieve(isa: Isa, accel: &Accel, frustum: &Frustum, slots: &[u32], found: &mut Vec<u32>) {
    let Frustum { axes, reach, .. } = *frustum;
    let (corners, ids) = (accel.rounded_corners(), accel.triangles());
    for slots in slots.chunks(LANES) {
        simd::run(isa, Sieve { axes, reach, corners, ids, slots, found });
    }
}

struct Sieve<'a> {
    axes: [[f32; 3]; 3],
    reach: f32,
    corners: &'a [[[f32; 3]; 3]],
    ids: &'a [u32],
    /// At most [`LANES`].
    slots: &'a [u32],
    found: &'a mut Vec<u32>,
}

impl simd::Loop for Sieve<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { axes, reach, ids, slots, found, .. } = self;
        // Here and not behind references, which might be the same: the loop becomes vectors.
        let mut corners = [[[0.0; LANES]; 3]; 3];
        let mut passes = [0u32; LANES];
        for (l, slot) in slots.iter().enumerate().take(LANES) {
            let triangle = &self.corners[*slot as usize];
            for corner in 0..3 {
                for axis in 0..3 {
                    corners[corner][axis][l] = triangle[corner][axis];
                }
            }
        }
        // Coordinates, axes, products and sums round by five times 2^-24 of their terms at most.
        let slack = reach / (1 << 20) as f32;
        // Whole vectors, for what is left of one is done number by number.
        for l in 0..slots.len().next_multiple_of(16).min(LANES) {
            let corner = |i: usize| [corners[i][0][l], corners[i][1][l], corners[i][2][l]];
            let (p, q, r) = (corner(0), corner(1), corner(2));
            // Seen at (x, y) / z, as in `facet::SetUp`, each component wrong by `error` at most.
            let see = |p: [f32; 3]| [dot(axes[0], p), dot(axes[1], p), dot(axes[2], p)];
            let (a, b, c) = (see(p), see(q), see(r));
            let error = max3(largest(p), largest(q), largest(r)) * slack + f32::MIN_POSITIVE;
            let outside = |a: f32, b: f32, c: f32| max3(a, b, c) < -2.0 * error;
            let beside = outside(0.5 * a[2] + a[0], 0.5 * b[2] + b[0], 0.5 * c[2] + c[0])
                | outside(0.5 * a[2] - a[0], 0.5 * b[2] - b[0], 0.5 * c[2] - c[0])
                | outside(0.5 * a[2] + a[1], 0.5 * b[2] + b[1], 0.5 * c[2] + c[1])
                | outside(0.5 * a[2] - a[1], 0.5 * b[2] - b[1], 0.5 * c[2] - c[1]);
            // An edge's function has products of two components, wrong by 2 · size · error.
            let size = max3(largest(a), largest(b), largest(c)) + error;
            let (ab, bc, ca) = (cross(a, b), cross(b, c), cross(c, a));
            let volume = dot(a, bc);
            let turn = 1f32.copysign(volume);
            let before =
                |e: [f32; 3]| e[2] * turn + 0.5 * (e[0].abs() + e[1].abs()) < -16.0 * size * error;
            let has_sides = volume.abs() > 64.0 * size * size * error;
            let within = has_sides & (before(ab) | before(bc) | before(ca));
            passes[l] = u32::from(!(beside | within));
        }
        let mut n = found.len();
        found.resize(n + LANES, 0);
        for (slot, passes) in slots.iter().zip(&passes) {
            found[n] = ids[*slot as usize];
            n += *passes as usize;
        }
        found.truncate(n);
    }
}
