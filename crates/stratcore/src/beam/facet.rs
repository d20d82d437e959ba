//! A triangle in the coordinates of one pixel.
//!
//! For a fixed eye the edge functions of a triangle and the inverse of its ray parameter are
//! affine in the position within the pixel (Olano & Greer, *Triangle Scan Conversion using 2D
//! Homogeneous Coordinates*, 1997), also when the triangle crosses the plane of the eye. They
//! are set up in f64 relative to eye and pixel, so a sample is exact to the pixel and not to
//! the world.

use crate::beam::affine::{Affine, CentredFrame};
use crate::beam::gather::Frustum;
use crate::beam::numbers::{cross, dot, largest, max, max3, min, scaled, sub};
use crate::scene::Mesh;
use crate::simd;
use glam::DVec3;

/// Triangles that are set up together: a multiple of every vector's length.
const LANES: usize = 32;

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
    /// 1/t at a position in the pixel where the triangle is hit.
    pub fn hit(&self, s: f64, t: f64) -> Option<f64> {
        let inside = self.edges.iter().all(|edge| edge.at(s, t) >= 0.0);
        let inverse_depth = self.inverse_depth.at(s, t);
        (inside && inverse_depth > 0.0).then_some(inverse_depth)
    }
}

/// Sets up triangles of the mesh: those that have an area, are not seen edge-on, and do not lie
/// outside the pixel or behind the horizon for certain.
pub(super) struct SetUp<'a> {
    pub mesh: &'a Mesh,
    pub ids: &'a [u32],
    pub eye: DVec3,
    pub centred: &'a CentredFrame,
    pub frustum: &'a Frustum,
    /// 1/t that some covering facet reaches everywhere in the pixel; rises with those set up.
    pub horizon: &'a mut f64,
    /// Facets are appended.
    pub facets: &'a mut Vec<Facet>,
}

impl simd::Loop for SetUp<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { mesh, ids, eye, centred, frustum, horizon, facets } = self;
        // Here and not behind references, which might be the same: the loop becomes vectors.
        let mut corners = [[[0.0; LANES]; 3]; 3];
        let mut lanes = Lanes::default();
        // Far apart in memory: asked for side by side, they arrive together.
        for id in ids {
            simd::prefetch(&mesh.triangles, *id as usize);
            simd::prefetch(&mesh.materials, *id as usize);
        }
        for id in ids {
            for corner in mesh.triangles[*id as usize] {
                simd::prefetch(&mesh.positions, corner as usize);
            }
        }
        for ids in ids.chunks(LANES) {
            for (l, id) in ids.iter().enumerate() {
                for (to, corner) in corners.iter_mut().zip(mesh.corners(*id as usize)) {
                    [to[0][l], to[1][l], to[2][l]] = corner.to_array();
                }
            }
            // Whole vectors, for what is left of one is done number by number.
            let n = ids.len().next_multiple_of(8).min(LANES);
            lanes.set_up(&corners, n, eye.to_array(), centred, frustum);
            for (l, id) in ids.iter().enumerate() {
                let is_hidden = lanes.nearest[l] < *horizon * (1.0 - 1e-9);
                if lanes.may_be_seen[l] == 0 || is_hidden {
                    continue;
                }
                if lanes.farthest[l] > *horizon {
                    *horizon = lanes.farthest[l];
                }
                facets.push(lanes.facet(l, *id));
            }
        }
    }
}

/// Facets side by side, number by number.
struct Lanes {
    may_be_seen: [u64; LANES],
    edges: [[[f64; LANES]; 3]; 3],
    inverse_depth: [[f64; LANES]; 3],
    nearest: [f64; LANES],
    /// Of those that cover the pixel by more than rounding the least 1/t in it; else 0.
    farthest: [f64; LANES],
    normal: [[f64; LANES]; 3],
    plane_distance: [f64; LANES],
    rows: [[f64; LANES]; 2],
}

impl Default for Lanes {
    fn default() -> Self {
        const NONE: [f64; LANES] = [0.0; LANES];
        Self {
            may_be_seen: [0; LANES],
            edges: [[NONE; 3]; 3],
            inverse_depth: [NONE; 3],
            nearest: NONE,
            farthest: NONE,
            normal: [NONE; 3],
            plane_distance: NONE,
            rows: [NONE; 2],
        }
    }
}

impl Lanes {
    /// Without a branch and one triangle like the other, so that the compiler makes vectors of
    /// it. What is not a number is not seen.
    #[inline(always)]
    fn set_up(
        &mut self,
        corners: &[[[f64; LANES]; 3]; 3],
        n: usize,
        eye: [f64; 3],
        centred: &CentredFrame,
        frustum: &Frustum,
    ) {
        let [columns, rows, forward] =
            [frustum.columns, frustum.rows, frustum.forward].map(|n| n.to_array());
        let [dc, du, dv] = [centred.dc, centred.du, centred.dv].map(|d| d.to_array());
        let scale = frustum.scale;
        for l in 0..n.min(LANES) {
            let corner = |i: usize| [corners[i][0][l], corners[i][1][l], corners[i][2][l]];
            let corner = [corner(0), corner(1), corner(2)];
            let relative = [sub(corner[0], eye), sub(corner[1], eye), sub(corner[2], eye)];

            // Seen at (x, y) / z.
            let see = |p: [f64; 3]| [dot(p, columns), dot(p, rows), dot(p, forward)];
            let (a, b, c) = (see(relative[0]), see(relative[1]), see(relative[2]));
            // That of the terms that the dot products add up.
            let terms = max3(largest(relative[0]), largest(relative[1]), largest(relative[2]));
            let size = max3(largest(a), largest(b), largest(c)) + terms * scale;
            let slack = -1e-12 * size;
            let outside = |a: f64, b: f64, c: f64| max3(a, b, c) < slack;
            let beside = outside(0.5 * a[2] + a[0], 0.5 * b[2] + b[0], 0.5 * c[2] + c[0])
                | outside(0.5 * a[2] - a[0], 0.5 * b[2] - b[0], 0.5 * c[2] - c[0])
                | outside(0.5 * a[2] + a[1], 0.5 * b[2] + b[1], 0.5 * c[2] + c[1])
                | outside(0.5 * a[2] - a[1], 0.5 * b[2] - b[1], 0.5 * c[2] - c[1]);
            let volume = dot(a, cross(b, c));
            let turn = 1f64.copysign(volume);
            let before = |p: [f64; 3], q: [f64; 3]| {
                let edge = cross(p, q);
                edge[2] * turn + 0.5 * (edge[0].abs() + edge[1].abs()) < slack * size
            };
            // Seen edge-on, it has no sides to speak of.
            let has_sides = volume.abs() > -slack * size * size;
            let within = has_sides & (before(a, b) | before(b, c) | before(c, a));

            let least = min(min(a[2], b[2]), c[2]);
            let is_near = least <= 1e-6 * size;
            let (y0, y1, y2) = (a[1] / a[2], b[1] / b[2], c[1] / c[2]);
            self.rows[0][l] = if is_near { -0.5 } else { max(min(min(y0, y1), y2), -0.5) };
            self.rows[1][l] = if is_near { 0.5 } else { min(max3(y0, y1, y2), 0.5) };
            // Greatest 1/t of its corners. Depths round by far less than 1e-12 of `size`.
            let corners_nearest =
                if is_near { f64::INFINITY } else { 1.0 / (least - 1e-12 * size) };

            let normal = cross(sub(corner[1], corner[0]), sub(corner[2], corner[0]));
            let length = dot(normal, normal).sqrt();
            let distance = dot(relative[0], normal) / length;
            let orientation = 1f64.copysign(distance);
            let mut may_be_seen = !(beside | within) & (distance.abs() > 0.0) & (length > 0.0);
            let mut covers = true;
            for i in 0..3 {
                let j = (i + 1) % 3;
                let forward = in_order(corner[i], corner[j]);
                let from = select(forward, corner[i], corner[j]);
                let to = select(forward, corner[j], corner[i]);
                // The difference of ends that lie close together is free of rounding, which
                // p × q itself is not.
                let plane = cross(select(forward, relative[i], relative[j]), sub(to, from));
                let function = [dot(plane, dc), dot(plane, du), dot(plane, dv)];
                let magnitude = largest(function);
                let factor = (if forward { orientation } else { -orientation }) / magnitude;
                let function = scaled(function, factor);
                let radius = 0.5 * (function[1].abs() + function[2].abs());
                may_be_seen &= (magnitude > 0.0) & (function[0] + radius >= -1e-9);
                covers &= function[0] - radius > 1e-9;
                let [c, s, t] = &mut self.edges[i];
                [c[l], s[l], t[l]] = function;
            }
            let normal = scaled(normal, orientation / length);
            let inverse_depth = [dot(normal, dc), dot(normal, du), dot(normal, dv)];
            let inverse_depth = scaled(inverse_depth, 1.0 / distance.abs());
            let radius = 0.5 * (inverse_depth[1].abs() + inverse_depth[2].abs());
            let nearest = min(inverse_depth[0] + radius, corners_nearest);
            may_be_seen &= (nearest > 0.0) & (largest(inverse_depth) < f64::INFINITY);

            for axis in 0..3 {
                self.inverse_depth[axis][l] = inverse_depth[axis];
                self.normal[axis][l] = -normal[axis];
            }
            self.nearest[l] = nearest;
            self.farthest[l] = if covers { inverse_depth[0] - radius } else { 0.0 };
            self.plane_distance[l] = distance.abs();
            self.may_be_seen[l] = u64::from(may_be_seen);
        }
    }

    #[inline(always)]
    fn facet(&self, l: usize, triangle: u32) -> Facet {
        let affine = |f: &[[f64; LANES]; 3]| Affine { c: f[0][l], s: f[1][l], t: f[2][l] };
        let [x, y, z] = &self.normal;
        Facet {
            triangle,
            edges: [affine(&self.edges[0]), affine(&self.edges[1]), affine(&self.edges[2])],
            inverse_depth: affine(&self.inverse_depth),
            nearest: self.nearest[l],
            normal: DVec3::new(x[l], y[l], z[l]),
            plane_distance: self.plane_distance[l],
            rows: [self.rows[0][l], self.rows[1][l]],
        }
    }
}

/// A triangle's edges as (from, to, sign): from and to in one order for both triangles that
/// share the edge, so that their functions cancel exactly, and -1 where that turns it round.
pub(super) fn ordered_edges(corner: &[DVec3; 3]) -> [(usize, usize, f64); 3] {
    [(0, 1), (1, 2), (2, 0)].map(|(from, to)| {
        if in_order(corner[from].to_array(), corner[to].to_array()) {
            (from, to, 1.0)
        } else {
            (to, from, -1.0)
        }
    })
}

/// Whether an edge runs from p to q, as x, y and z decide in turn.
#[inline(always)]
fn in_order(p: [f64; 3], q: [f64; 3]) -> bool {
    let below = (p[1] < q[1]) | ((p[1] == q[1]) & (p[2] < q[2]));
    (p[0] < q[0]) | ((p[0] == q[0]) & below)
}

#[inline(always)]
fn select(first: bool, p: [f64; 3], q: [f64; 3]) -> [f64; 3] {
    let one = |p: f64, q: f64| if first { p } else { q };
    [one(p[0], q[0]), one(p[1], q[1]), one(p[2], q[2])]
}
