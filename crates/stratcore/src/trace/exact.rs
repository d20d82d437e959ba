//! The determinant of three f64 vectors without rounding, for the few cases in which rounding
//! could change its sign.
//!
//! Expansions and their sums: J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic and
//! Fast Robust Geometric Predicates*, Discrete & Computational Geometry 18, 1997.

use glam::DVec3;

/// a·(b×c): its sign is exact and its value is within a few ulps, as long as no product of
/// three coordinates leaves the range of normal numbers.
#[cold]
pub(super) fn determinant(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let mut sum = Expansion::default();
    for (x, y, z) in [(a.x, b.y, c.z), (a.y, b.z, c.x), (a.z, b.x, c.y)] {
        sum.add_product(x, y, z);
    }
    for (x, y, z) in [(-a.x, b.z, c.y), (-a.y, b.x, c.z), (-a.z, b.y, c.x)] {
        sum.add_product(x, y, z);
    }
    sum.parts[..sum.len].iter().sum()
}

/// An exact sum of non-overlapping parts, smallest first. Six products of four parts each fit.
#[derive(Default)]
struct Expansion {
    parts: [f64; 24],
    len: usize,
}

impl Expansion {
    fn add_product(&mut self, x: f64, y: f64, z: f64) {
        let (high, low) = two_product(y, z);
        for factor in [low, high] {
            let (high, low) = two_product(x, factor);
            self.add(low);
            self.add(high);
        }
    }

    /// Shewchuk's GROW-EXPANSION.
    fn add(&mut self, term: f64) {
        let mut carry = term;
        let mut len = 0;
        for i in 0..self.len {
            let (sum, error) = two_sum(carry, self.parts[i]);
            if error != 0.0 {
                self.parts[len] = error;
                len += 1;
            }
            carry = sum;
        }
        if carry != 0.0 {
            self.parts[len] = carry;
            len += 1;
        }
        self.len = len;
    }
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}
