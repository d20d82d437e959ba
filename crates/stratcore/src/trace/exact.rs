//! The determinant of three f64 vectors without rounding, for the few cases in which rounding
//! could change its sign.
//!
//! Expansions and their sums: J. R. Shewchuk, *Adaptive Precision Floating-Point Arithmetic and
//! Fast Robust Geometric Predicates*, Discrete & Computational Geometry 18, 1997.

use crate::double::{two_product, two_sum};
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    fn integer(v: [i64; 9]) -> i128 {
        let [a, b, c, d, e, f, g, h, i] = v.map(i128::from);
        a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)
    }

    fn vectors(v: [i64; 9]) -> [DVec3; 3] {
        let v = v.map(|x| x as f64);
        [DVec3::from_slice(&v), DVec3::from_slice(&v[3..]), DVec3::from_slice(&v[6..])]
    }

    /// Against 128-bit integers, for vectors that almost or exactly lie in one plane: the third
    /// is the sum of the others but for at most one unit.
    #[test]
    fn signs_are_those_of_integer_arithmetic() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(7);
        let mut zeros = 0;
        for _ in 0..20_000 {
            let mut v = [0; 9];
            for x in &mut v[..6] {
                *x = random.random_range(-(1i64 << 39)..1 << 39);
            }
            for i in 0..3 {
                v[6 + i] = v[i] + v[3 + i];
            }
            v[random.random_range(6..9)] += random.random_range(-1..2);
            let [a, b, c] = vectors(v);
            let (exact, ours) = (integer(v), determinant(a, b, c));
            assert_eq!(exact.signum() as f64, if ours == 0.0 { 0.0 } else { ours.signum() });
            assert!((ours - exact as f64).abs() <= 4.0 * f64::EPSILON * ours.abs());
            zeros += i32::from(exact == 0);
        }
        assert!(zeros > 1000, "{zeros}");
    }
}
