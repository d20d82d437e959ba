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
    /// Corners of the triangle in each slot, relative to the eye, rounded. Those of neighbours
    /// lie side by side, where the mesh may have spread them over all memory.
    rounded_corners: Vec<[[f32; 3]; 3]>,
    eye: DVec3,
}

/// Triangles of a leaf, at most.
pub(crate) const LEAF: usize = 8;

impl Accel {
    /// Builds the tree. Triangles that no ray can meet (zero area, or a coordinate that is not
    /// finite) are left out.
    ///
    /// With the vertices' displacements while the shutter is open, boxes contain all that the
    /// triangles sweep.
    pub fn build(mesh: &Mesh, eye: DVec3, motion: Option<&[DVec3]>) -> Self {
        let corners = |id: u32| mesh.corners(id as usize).map(|p| p - eye);
        let moved = |id: u32| {
            let indices = mesh.triangles[id as usize].map(|i| i as usize);
            let shift = |i: usize| motion.map_or(DVec3::ZERO, |motion| motion[i]);
            indices.map(|i| mesh.positions[i] + shift(i) - eye)
        };
        let can_be_met = |id: &u32| {
            let [a, b, c] = corners(*id);
            let normal = (b - a).cross(c - a);
            normal.is_finite() && normal != DVec3::ZERO
        };
        let ids: Vec<u32> = (0..mesh.triangles.len() as u32).filter(can_be_met).collect();
        let extent = |id: &u32| {
            corners(*id)
                .iter()
                .chain(&moved(*id))
                .fold(0.0, |m: f64, p| m.max(p.abs().max_element()))
        };
        // Far above the rounding of f64 coordinates at this distance, far below f32's.
        let pad = ids.iter().map(extent).fold(0.0, f64::max) * 2f64.powi(-40);
        let swept = |id: &u32| [corners(*id), moved(*id)];
        let boxes: Vec<Aabb> =
            ids.iter().map(|id| padded_box(swept(id).as_flattened(), pad)).collect();
        let bvh = build_tree(&boxes, &ids);
        let rounded = |id: &u32| corners(*id).map(|p| p.as_vec3().to_array());
        let rounded_corners = bvh.primitive_indices.iter().map(rounded).collect();
        Self { bvh, rounded_corners, eye }
    }

    /// The tree. A leaf's primitives are slots; [`Accel::triangle`] gives their triangles.
    pub fn bvh(&self) -> &Bvh2 {
        &self.bvh
    }

    /// The corners of the triangle in each slot, relative to the eye and rounded to f32.
    pub fn rounded_corners(&self) -> &[[[f32; 3]; 3]] {
        &self.rounded_corners
    }

    /// What the boxes are relative to.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The triangle in each slot of the tree.
    pub(crate) fn triangles(&self) -> &[u32] {
        &self.bvh.primitive_indices
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
        mut limit: f64,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) {
        let slabs = Slabs::new(origin - self.eye, direction);
        let mut reach = slabs.reach(limit);
        let mut stack = Stack::new();
        let mut node = match self.bvh.nodes.first() {
            Some(root) if slabs.entry(root) <= reach => root,
            _ => return,
        };
        loop {
            if node.is_leaf() {
                for slot in node.first_index..node.first_index + node.prim_count {
                    limit = visit(self.triangle(slot), limit);
                }
                reach = slabs.reach(limit);
            } else {
                let first = node.first_index;
                let children = &self.bvh.nodes[first as usize..first as usize + 2];
                let entries = [slabs.entry(&children[0]), slabs.entry(&children[1])];
                let near = usize::from(entries[1] < entries[0]);
                let far = 1 - near;
                if entries[near] <= reach {
                    if entries[far] <= reach {
                        stack.push((first + far as u32, entries[far]));
                    }
                    node = &children[near];
                    continue;
                }
            }
            node = loop {
                match stack.pop() {
                    Some((index, entry)) if entry <= reach => {
                        break &self.bvh.nodes[index as usize];
                    }
                    Some(_) => {}
                    None => return,
                }
            };
        }
    }
}

/// obvhs's medium build without its clock and debug checks. A triangle test costs more than
/// the medium build assumes, so leaves are smaller.
fn build_tree(boxes: &[Aabb], triangles: &[u32]) -> Bvh2 {
    let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        3,
    );
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut bvh, 0.05, None);
    collapse(&mut bvh, LEAF as u32, 2.0);
    optimizer.run(&mut bvh, 0.1, None);
    // Neighbours in the tree become neighbours in memory.
    bvh.reorder_in_stack_traversal_order();
    let mut ordered = Vec::with_capacity(triangles.len());
    for node in bvh.nodes.iter_mut().filter(|node| node.is_leaf()) {
        let (first, count) = (node.first_index as usize, node.prim_count as usize);
        assert!(count <= LEAF, "a leaf of {count} triangles");
        let leaf = &bvh.primitive_indices[first..first + count];
        node.first_index = ordered.len() as u32;
        ordered.extend(leaf.iter().map(|primitive| triangles[*primitive as usize]));
    }
    bvh.primitive_indices = ordered;
    bvh
}

fn padded_box(points: &[DVec3], pad: f64) -> Aabb {
    let low = points.iter().fold(DVec3::INFINITY, |low, p| low.min(*p)) - pad;
    let high = points.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p)) + pad;
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
    /// Length of one unit of the caller's parameter in this ray's.
    longest: f64,
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
        Self { low_origin: rounded + slack, high_origin: rounded - slack, inverse, longest }
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

    /// The largest entry, always finite, of a box that may hold something before `limit`.
    #[inline(always)]
    fn reach(&self, limit: f64) -> f32 {
        ((limit * self.longest * (1.0 + 1e-6)) as f32).min(f32::MAX)
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
