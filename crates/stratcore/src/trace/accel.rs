//! Which triangles a ray may meet.

use crate::scene::Mesh;
use glam::{DVec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::bvh2::{Bvh2, node::Bvh2Node};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// A binary BVH whose f32 boxes, relative to the eye, certainly contain the f64 triangles.
pub struct Accel {
    bvh: Bvh2,
    eye: DVec3,
}

impl Accel {
    /// Builds the tree. Triangles that no ray can meet (zero area, or a coordinate that is not
    /// finite) are left out.
    pub fn build(mesh: &Mesh, eye: DVec3) -> Self {
        let corners = |id: u32| mesh.corners(id as usize).map(|p| p - eye);
        let can_be_met = |id: &u32| {
            let [a, b, c] = corners(*id);
            let normal = (b - a).cross(c - a);
            normal.is_finite() && normal != DVec3::ZERO
        };
        let ids: Vec<u32> = (0..mesh.triangles.len() as u32).filter(can_be_met).collect();
        let extent =
            |id: &u32| corners(*id).iter().fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
        // Far above the rounding of f64 coordinates at this distance, far below f32's.
        let pad = ids.iter().map(extent).fold(0.0, f64::max) * 2f64.powi(-40);
        let boxes: Vec<Aabb> = ids.iter().map(|id| padded_box(corners(*id), pad)).collect();
        Self { bvh: build_tree(&boxes, ids), eye }
    }

    /// The tree. A leaf's primitives are slots; [`Accel::triangle`] gives their triangles.
    pub fn bvh(&self) -> &Bvh2 {
        &self.bvh
    }

    /// What the boxes are relative to.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The triangle in a slot of the tree.
    pub fn triangle(&self, slot: u32) -> u32 {
        self.bvh.primitive_indices[slot as usize]
    }

    /// Shows `visit` every triangle that the ray may meet before `limit` (in lengths of
    /// `direction`), roughly from near to far. `visit` returns the new limit; below 0 ends the
    /// walk.
    #[inline]
    pub fn walk(
        &self,
        origin: DVec3,
        direction: DVec3,
        limit: f64,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) {
        let Some(root) = self.bvh.nodes.first() else { return };
        let slabs = Slabs::new(origin - self.eye, direction);
        let mut limit = limit;
        let mut stack = Stack::new();
        let mut leaf = |node: &Bvh2Node, limit: &mut f64| {
            for slot in node.first_index..node.first_index + node.prim_count {
                *limit = visit(self.triangle(slot), *limit);
            }
        };
        if slabs.entry(root) == f32::INFINITY {
            return;
        }
        if root.is_leaf() {
            leaf(root, &mut limit);
            return;
        }
        let mut children = root.first_index as usize;
        loop {
            let [mut near, mut far] = [&self.bvh.nodes[children], &self.bvh.nodes[children + 1]];
            let [mut near_t, mut far_t] = [slabs.entry(near), slabs.entry(far)];
            if far_t < near_t {
                (near, far, near_t, far_t) = (far, near, far_t, near_t);
            }
            let mut next = None;
            for (node, t) in [(far, far_t), (near, near_t)] {
                if !node.is_leaf() && slabs.reaches(t, limit) {
                    if let Some(postponed) = next.replace((node.first_index, t)) {
                        stack.push(postponed);
                    }
                }
            }
            for (node, t) in [(near, near_t), (far, far_t)] {
                if node.is_leaf() && slabs.reaches(t, limit) {
                    leaf(node, &mut limit);
                }
            }
            let next = next.into_iter().chain(std::iter::from_fn(|| stack.pop()));
            let Some((index, _)) = { next }.find(|(_, t)| slabs.reaches(*t, limit)) else { return };
            children = index as usize;
        }
    }
}

/// obvhs's medium build without its clock and its debug checks.
fn build_tree(boxes: &[Aabb], triangles: Vec<u32>) -> Bvh2 {
    let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        triangles,
        SortPrecision::U64,
        3,
    );
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut bvh, 0.05, None);
    collapse(&mut bvh, 8, 3.0);
    optimizer.run(&mut bvh, 0.1, None);
    bvh
}

fn padded_box(corners: [DVec3; 3], pad: f64) -> Aabb {
    let [a, b, c] = corners;
    let (low, high) = (a.min(b).min(c) - pad, a.max(b).max(c) + pad);
    let down = |x: f64| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 };
    let up = |x: f64| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 };
    Aabb::new(
        Vec3A::new(down(low.x), down(low.y), down(low.z)),
        Vec3A::new(up(high.x), up(high.y), up(high.z)),
    )
}

/// A ray against boxes, in f32, wrong only on the side of yes.
struct Slabs {
    low_origin: Vec3A,
    high_origin: Vec3A,
    inverse: Vec3A,
    /// Length of one unit of this ray's parameter in the caller's.
    unit: f64,
}

impl Slabs {
    fn new(origin: DVec3, direction: DVec3) -> Self {
        // The longest component becomes 1, so that the parameter has the size of coordinates.
        let longest = direction.abs().max_element();
        // A component below this moves the ray by less than a box's padding.
        const LEAST: f32 = 1e-30;
        let component = |d: f64| {
            let d = (d / longest) as f32;
            1.0 / if d.abs() < LEAST { LEAST.copysign(d) } else { d }
        };
        let inverse =
            Vec3A::new(component(direction.x), component(direction.y), component(direction.z));
        let rounded = origin.as_vec3a();
        let slack = rounded.abs() * f32::EPSILON;
        Self {
            low_origin: rounded + slack,
            high_origin: rounded - slack,
            inverse,
            unit: 1.0 / longest,
        }
    }

    /// Parameter at which the ray enters the node's box; infinity for a miss.
    #[inline(always)]
    fn entry(&self, node: &Bvh2Node) -> f32 {
        let low = (node.aabb().min - self.low_origin) * self.inverse;
        let high = (node.aabb().max - self.high_origin) * self.inverse;
        let enter = low.min(high).max_element().max(0.0);
        let leave = low.max(high).min_element();
        // Each of the two has a relative error below 4 · 2^-24.
        if enter <= leave * (1.0 + 8.0 * f32::EPSILON) { enter } else { f32::INFINITY }
    }

    /// Whether a box entered at `t` may hold something before `limit`.
    #[inline(always)]
    fn reaches(&self, t: f32, limit: f64) -> bool {
        t < f32::INFINITY && f64::from(t) * self.unit * (1.0 - 1e-6) <= limit
    }
}

/// Nodes to visit later: no allocation until the tree is uncommonly deep.
struct Stack {
    first: [(u32, f32); 64],
    len: usize,
    rest: Vec<(u32, f32)>,
}

impl Stack {
    fn new() -> Self {
        Self { first: [(0, 0.0); 64], len: 0, rest: Vec::new() }
    }

    #[inline(always)]
    fn push(&mut self, node: (u32, f32)) {
        match self.first.get_mut(self.len) {
            Some(place) => {
                *place = node;
                self.len += 1;
            }
            None => self.rest.push(node),
        }
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<(u32, f32)> {
        self.rest.pop().or_else(|| {
            self.len = self.len.checked_sub(1)?;
            Some(self.first[self.len])
        })
    }
}
