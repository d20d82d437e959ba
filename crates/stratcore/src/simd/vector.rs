//! What the kernels ask of a vector, and the plain twin that asks no CPU for anything.

use super::Lanes4;

/// A vector of f32 lanes. Every operation is one IEEE operation per lane, or a fused
/// multiply-add: all implementations give the same bits.
pub(super) trait Vector: Copy {
    /// Lanes, at most [`MAX_LANES`].
    const LANES: usize;
    /// As many u32 lanes.
    type Int: Copy;
    /// As many truth values.
    type Mask: Copy;
    /// As many f64 lanes.
    type Sum: Copy;

    /// The four functions' values on a rectangle, middle ± radius.
    fn range(functions: &Lanes4, rect: &Extent) -> Range4;
    /// The four functions' greatest values on rectangles of half such a size, by their middles.
    fn ends(functions: &Lanes4, half: [f32; 2], slack: [f32; 4]) -> Ends4;

    fn splat(x: f32) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    fn min(self, other: Self) -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    /// self · factor + addend, rounded once.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    fn ge(self, other: Self) -> Self::Mask;
    fn gt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    /// The least lane.
    fn least(self) -> f32;
    /// `yes` where the mask is set.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// `yes` where the sign bit of `x` is set.
    fn select_negative(x: Self, yes: Self, no: Self) -> Self;
    /// Reads LANES values.
    fn load(values: &[f32]) -> Self;
    /// The first LANES values are the vector's.
    fn store(self) -> [f32; MAX_LANES];
    /// Writes LANES values.
    fn write(self, values: &mut [f32]);

    fn mask_none() -> Self::Mask;
    fn mask_all() -> Self::Mask;
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// a and not b.
    fn mask_without(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Bit l is lane l's.
    fn mask_bits(mask: Self::Mask) -> u32;

    fn int_splat(x: u32) -> Self::Int;
    /// Reads LANES values.
    fn int_load(values: &[u32]) -> Self::Int;
    fn int_add(a: Self::Int, b: Self::Int) -> Self::Int;
    fn int_mul(a: Self::Int, b: Self::Int) -> Self::Int;
    /// x ^ (x >> 16)
    fn int_xorshift16(x: Self::Int) -> Self::Int;
    /// The upper 24 bits as a number in 0 ..= 2^24 - 1.
    fn upper24(x: Self::Int) -> Self;

    fn sum_zero() -> Self::Sum;
    fn sum_add(sum: Self::Sum, x: Self) -> Self::Sum;
    fn sum_add_all(sum: Self::Sum, x: f64) -> Self::Sum;
    /// The first LANES values are the sum's.
    fn sum_store(sum: Self::Sum) -> [f64; MAX_LANES];
}

/// A rectangle of the pixel: its middle, and half its width and height.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub middle: [f32; 2],
    pub half: [f32; 2],
}

/// What four functions do on a rectangle.
#[derive(Clone, Copy)]
pub(super) struct Range4 {
    /// Bit l: function l is below -[`CULL_SLACK`] everywhere.
    pub below: u32,
    /// Bit l: function l is above [`CULL_SLACK`] everywhere.
    pub above: u32,
    /// Least and greatest value of the last function.
    pub last: [f32; 2],
}

/// What four functions do on any rectangle of one size.
#[derive(Clone, Copy)]
pub(super) struct Ends4 {
    /// Greatest value where the rectangle's middle is at (0, 0).
    pub high: [f32; 4],
    /// Greatest minus least.
    pub width: [f32; 4],
}

/// Slack of every decision about a whole rectangle: four times the rounding of a function
/// whose largest coefficient is 1.
pub(super) const CULL_SLACK: f32 = 1e-6;

/// The widest vector there is.
pub(super) const MAX_LANES: usize = 16;

/// The places of the bits that are set.
pub(super) struct Bits(pub u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let at = self.0.trailing_zeros() as usize;
        let is_one = self.0 != 0;
        self.0 &= self.0.wrapping_sub(1);
        is_one.then_some(at)
    }
}

/// L lanes as a plain array: eight, and in tests also as many as the widest vector has.
#[derive(Clone, Copy)]
pub(super) struct Plain<const L: usize>([f32; L]);

#[inline(always)]
fn each<const L: usize, A: Copy, B: Copy, C>(
    a: [A; L],
    b: [B; L],
    f: impl Fn(A, B) -> C,
) -> [C; L] {
    std::array::from_fn(|l| f(a[l], b[l]))
}

impl<const L: usize> Vector for Plain<L> {
    const LANES: usize = L;
    type Int = [u32; L];
    type Mask = [bool; L];
    type Sum = [f64; L];

    #[inline(always)]
    fn range(functions: &Lanes4, rect: &Extent) -> Range4 {
        let Lanes4 { c, s, t } = functions;
        let ([x, y], [rx, ry]) = (rect.middle, rect.half);
        let mut out = Range4 { below: 0, above: 0, last: [0.0; 2] };
        for l in 0..4 {
            let middle = s[l].mul_add(x, t[l].mul_add(y, c[l]));
            let radius = s[l].abs().mul_add(rx, t[l].abs() * ry);
            out.last = [middle - radius, middle + radius];
            out.above |= u32::from(out.last[0] > CULL_SLACK) << l;
            out.below |= u32::from(out.last[1] < -CULL_SLACK) << l;
        }
        out
    }
    #[inline(always)]
    fn ends(functions: &Lanes4, [half_s, half_t]: [f32; 2], slack: [f32; 4]) -> Ends4 {
        let Lanes4 { c, s, t } = functions;
        let mut ends = Ends4 { high: [0.0; 4], width: [0.0; 4] };
        for l in 0..4 {
            let radius = s[l].abs().mul_add(half_s, t[l].abs().mul_add(half_t, slack[l]));
            ends.high[l] = c[l] + radius;
            ends.width[l] = radius + radius;
        }
        ends
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; L])
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(each(self.0, other.0, |a, b| a + b))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(each(self.0, other.0, |a, b| a - b))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(each(self.0, other.0, |a, b| a * b))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(each(self.0, other.0, |a, b| a / b))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // As x86 does it: the second where they compare equal or are unordered.
        Self(each(self.0, other.0, |a, b| if a < b { a } else { b }))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f32::abs))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f32::sqrt))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        Self(std::array::from_fn(|l| self.0[l].mul_add(factor.0[l], addend.0[l])))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        each(self.0, other.0, |a, b| a >= b)
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        each(self.0, other.0, |a, b| a > b)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        each(self.0, other.0, |a, b| a <= b)
    }
    #[inline(always)]
    fn least(self) -> f32 {
        self.0.into_iter().fold(f32::INFINITY, |least, x| if x < least { x } else { least })
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|l| if mask[l] { yes.0[l] } else { no.0[l] }))
    }
    #[inline(always)]
    fn select_negative(x: Self, yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|l| if x.0[l].is_sign_negative() { yes.0[l] } else { no.0[l] }))
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        Self(std::array::from_fn(|l| values[l]))
    }
    #[inline(always)]
    fn store(self) -> [f32; MAX_LANES] {
        std::array::from_fn(|l| if l < L { self.0[l] } else { 0.0 })
    }
    #[inline(always)]
    fn write(self, values: &mut [f32]) {
        values[..L].copy_from_slice(&self.0);
    }
    #[inline(always)]
    fn mask_none() -> Self::Mask {
        [false; L]
    }
    #[inline(always)]
    fn mask_all() -> Self::Mask {
        [true; L]
    }
    #[inline(always)]
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each(a, b, |a, b| a & b)
    }
    #[inline(always)]
    fn mask_without(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each(a, b, |a, b| a & !b)
    }
    #[inline(always)]
    fn mask_bits(mask: Self::Mask) -> u32 {
        (0..L).map(|l| u32::from(mask[l]) << l).sum()
    }
    #[inline(always)]
    fn int_splat(x: u32) -> Self::Int {
        [x; L]
    }
    #[inline(always)]
    fn int_load(values: &[u32]) -> Self::Int {
        std::array::from_fn(|l| values[l])
    }
    #[inline(always)]
    fn int_add(a: Self::Int, b: Self::Int) -> Self::Int {
        each(a, b, u32::wrapping_add)
    }
    #[inline(always)]
    fn int_mul(a: Self::Int, b: Self::Int) -> Self::Int {
        each(a, b, u32::wrapping_mul)
    }
    #[inline(always)]
    fn int_xorshift16(x: Self::Int) -> Self::Int {
        x.map(|x| x ^ (x >> 16))
    }
    #[inline(always)]
    fn upper24(x: Self::Int) -> Self {
        Self(x.map(|x| (x >> 8) as f32))
    }
    #[inline(always)]
    fn sum_zero() -> Self::Sum {
        [0.0; L]
    }
    #[inline(always)]
    fn sum_add(sum: Self::Sum, x: Self) -> Self::Sum {
        each(sum, x.0, |sum, x| sum + f64::from(x))
    }
    #[inline(always)]
    fn sum_add_all(sum: Self::Sum, x: f64) -> Self::Sum {
        sum.map(|sum| sum + x)
    }
    #[inline(always)]
    fn sum_store(sum: Self::Sum) -> [f64; MAX_LANES] {
        std::array::from_fn(|l| if l < L { sum[l] } else { 0.0 })
    }
}
