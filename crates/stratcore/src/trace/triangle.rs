//! A watertight ray-triangle test.
//!
//! With the corners a, b, c relative to the ray's origin, the direction D is a combination
//! αa + βb + γc whose coefficients are ratios of determinants: α = D·(b×c) / a·(b×c). The ray
//! meets the triangle where all three are at least 0. Only signs decide, so triangles that
//! cross the eye's plane need no clipping (Olano & Greer, *Triangle Scan Conversion using 2D
//! Homogeneous Coordinates*, 1997). Each sign is exact for the rounded corners, and neighbours
//! see the same corners: no ray slips through a shared edge or vertex.

use super::exact::determinant;
use glam::DVec3;

/// A half-line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: DVec3,
    /// Where it goes; any length, and lengths along the ray are counted in it.
    pub direction: DVec3,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// 1/t, finite and above 0: the ray meets the triangle at `origin + direction * t`.
    pub inverse_t: f64,
    /// Edge functions D·(b×c), D·(c×a), D·(a×b), all of one sign: the weights of the three
    /// corners up to a common factor.
    pub edges: [f64; 3],
}

impl Ray {
    /// Where the ray meets the triangle; none for a degenerate one.
    #[inline]
    pub fn meets(&self, corners: [DVec3; 3]) -> Option<Crossing> {
        let [a, b, c] = corners;
        let (a, b, c) = (a - self.origin, b - self.origin, c - self.origin);
        let d = self.direction;
        let bc = edge(d, b, c);
        let ca = edge(d, c, a);
        if bc * ca < 0.0 {
            return None;
        }
        let ab = edge(d, a, b);
        let (low, high) = (bc.min(ca).min(ab), bc.max(ca).max(ab));
        if low < 0.0 && high > 0.0 || low == high && low == 0.0 {
            return None;
        }
        let normal = (b - a).cross(c - a);
        let size = one_norm(b - a) * one_norm(c - a);
        let volume = or_exact(a.dot(normal), one_norm(a) * size, || determinant(a, b, c));
        // Grazing rays: the sum is as precise as its parts, and cannot be 0.
        let slope = or_exact(d.dot(normal), one_norm(d) * size, || bc + ca + ab);
        let inverse_t = slope / volume;
        (inverse_t > 0.0 && inverse_t < f64::INFINITY)
            .then_some(Crossing { inverse_t, edges: [bc, ca, ab] })
    }
}

/// D·(p×q), of exact sign.
#[inline]
fn edge(d: DVec3, p: DVec3, q: DVec3) -> f64 {
    // p×q = p×(q-p), which cancels less.
    let along = q - p;
    let scale = one_norm(d) * one_norm(p) * one_norm(along);
    or_exact(d.dot(p.cross(along)), scale, || determinant(d, p, q))
}

/// `value`, a determinant whose six products sum to at most `scale` in magnitude, unless its
/// rounding error could reach its sign. Its error is below 7 · 2^-53 `scale` to first
/// order: two roundings in the differences of corners, five in the products and sums.
#[inline]
fn or_exact(value: f64, scale: f64, exact: impl FnOnce() -> f64) -> f64 {
    const BOUND: f64 = 16.0 * f64::EPSILON / 2.0;
    if value.abs() > BOUND * scale { value } else { exact() }
}

fn one_norm(v: DVec3) -> f64 {
    v.x.abs() + v.y.abs() + v.z.abs()
}
