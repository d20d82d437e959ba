//! Sums and products without rounding, and numbers of twice f64's precision: what plain
//! arithmetic is held against.
//!
//! T. J. Dekker, *A Floating-Point Technique for Extending the Available Precision*, Numerische
//! Mathematik 18, 1971; D. E. Knuth, *The Art of Computer Programming* 2, 4.2.2.

use std::ops::{Add, Div, Mul, Sub};

/// a + b as its rounded value and what the rounding lost, exactly.
#[inline(always)]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// a · b as its rounded value and what the rounding lost, exactly where neither leaves the
/// range of normal numbers.
#[inline(always)]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    (product, a.mul_add(b, -product))
}

/// An unevaluated sum of two numbers, the second below the rounding of the first: 106 bits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// Rounded to f64.
    pub(crate) fn value(self) -> f64 {
        self.high + self.low
    }

    /// For |a| ≥ |b|.
    #[inline(always)]
    fn normal(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add<f64> for Double {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        let (sum, lost) = two_sum(self.high, other);
        Self::normal(sum, lost + self.low)
    }
}

impl Add for Double {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (sum, lost) = two_sum(self.high, other.high);
        let (low, lower) = two_sum(self.low, other.low);
        let Self { high, low } = Self::normal(sum, lost + low);
        Self::normal(high, low + lower)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + Self { high: -other.high, low: -other.low }
    }
}

impl Sub<f64> for Double {
    type Output = Self;
    fn sub(self, other: f64) -> Self {
        self + -other
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (product, lost) = two_product(self.high, other.high);
        Self::normal(product, lost + (self.high * other.low + self.low * other.high))
    }
}

impl Div<f64> for Double {
    type Output = Self;
    fn div(self, other: f64) -> Self {
        let first = self.high / other;
        let rest = self - Self::from(first) * Self::from(other);
        let second = rest.high / other;
        let rest = rest - Self::from(second) * Self::from(other);
        Self::normal(first, second) + rest.high / other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whole numbers of up to 100 bits, against 128-bit integers.
    #[test]
    fn sums_and_products_are_those_of_integers() {
        let double = |x: i128| {
            let high = x as f64;
            Double::from(high) + (x - high as i128) as f64
        };
        let whole = |x: Double| x.high as i128 + x.low as i128;
        for i in 0..1000i128 {
            let a = (i * 0x9e37_79b9_7f4a_7c15) & ((1 << 50) - 1);
            let b = ((i + 7) * 0xbf58_476d_1ce4_e5b9) & ((1 << 49) - 1);
            assert_eq!(whole(double(a) * double(b)), a * b);
            let (large, other) = (a * b, b * (i + 3) - a);
            assert_eq!(whole(double(large) - double(other)), large - other);
            assert_eq!(whole(double(large) + other as f64), large + (other as f64) as i128);
        }
    }

    #[test]
    fn a_third_has_a_hundred_bits() {
        let third = Double::from(1.0) / 3.0;
        let rest = third + third + third - 1.0;
        assert!(rest.value().abs() < 2f64.powi(-103) && third.low != 0.0, "{rest:?}");
    }
}
