//! Vectors of three numbers, f32 or f64, in steps that the compiler makes vector instructions of.

use std::ops::{Add, Mul, Sub};

/// A floating-point number.
pub(super) trait Number:
    Copy + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    fn abs(self) -> Self;
}

impl Number for f32 {
    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }
}

impl Number for f64 {
    #[inline(always)]
    fn abs(self) -> Self {
        Self::abs(self)
    }
}

/// One instruction of a vector, which [`f64::max`] is not.
#[inline(always)]
pub(super) fn max<T: Number>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

#[inline(always)]
pub(super) fn min<T: Number>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn max3<T: Number>(a: T, b: T, c: T) -> T {
    max(max(a, b), c)
}

#[inline(always)]
pub(super) fn largest<T: Number>(p: [T; 3]) -> T {
    max3(p[0].abs(), p[1].abs(), p[2].abs())
}

#[inline(always)]
pub(super) fn sub<T: Number>(p: [T; 3], q: [T; 3]) -> [T; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

#[inline(always)]
pub(super) fn scaled<T: Number>(p: [T; 3], factor: T) -> [T; 3] {
    [p[0] * factor, p[1] * factor, p[2] * factor]
}

#[inline(always)]
pub(super) fn dot<T: Number>(p: [T; 3], q: [T; 3]) -> T {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2]
}

#[inline(always)]
pub(super) fn cross<T: Number>(p: [T; 3], q: [T; 3]) -> [T; 3] {
    [p[1] * q[2] - q[1] * p[2], p[2] * q[0] - q[2] * p[0], p[0] * q[1] - q[0] * p[1]]
}
