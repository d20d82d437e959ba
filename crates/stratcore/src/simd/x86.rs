//! Vectors of x86-64.
//!
//! The methods are `inline(always)`: inside a function that has the target feature they become
//! the instruction itself. They must not be called anywhere else, which is why the types do not
//! leave [`super`].

use super::Lanes4;
use super::vector::{CULL_SLACK, Ends4, Extent, MAX_LANES, Range4, Vector};
use std::arch::x86_64::*;

/// Runs an intrinsic on values.
macro_rules! intrinsic {
    ($body:expr) => {
        // SAFETY: these methods are called only under the target features that `super` has
        // checked, and every pointer comes from an array or a slice of at least LANES values.
        unsafe { $body }
    };
}

/// 8 lanes, under AVX2, FMA, BMI, LZCNT and POPCNT.
#[derive(Clone, Copy)]
pub(super) struct Avx2(__m256);

/// 16 lanes, under AVX-512 F and DQ.
#[derive(Clone, Copy)]
pub(super) struct Avx512(__m512);

impl Vector for Avx2 {
    const LANES: usize = 8;
    type Int = __m256i;
    type Mask = __m256;
    type Sum = [__m256d; 2];

    #[inline(always)]
    fn range(functions: &Lanes4, rect: &Extent) -> Range4 {
        range(functions, rect)
    }
    #[inline(always)]
    fn ends(functions: &Lanes4, half: [f32; 2], slack: [f32; 4]) -> Ends4 {
        ends(functions, half, slack)
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        intrinsic!(Self(_mm256_set1_ps(x)))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        intrinsic!(Self(_mm256_add_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        intrinsic!(Self(_mm256_sub_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        intrinsic!(Self(_mm256_mul_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        intrinsic!(Self(_mm256_div_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        intrinsic!(Self(_mm256_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        intrinsic!(Self(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        intrinsic!(Self(_mm256_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        intrinsic!(Self(_mm256_fmadd_ps(self.0, factor.0, addend.0)))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        intrinsic!(_mm256_cmp_ps::<_CMP_GE_OQ>(self.0, other.0))
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        intrinsic!(_mm256_cmp_ps::<_CMP_GT_OQ>(self.0, other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        intrinsic!(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0))
    }
    #[inline(always)]
    fn least(self) -> f32 {
        intrinsic!({
            let x = _mm_min_ps(_mm256_castps256_ps128(self.0), _mm256_extractf128_ps::<1>(self.0));
            let x = _mm_min_ps(x, _mm_movehl_ps(x, x));
            _mm_cvtss_f32(_mm_min_ss(x, _mm_shuffle_ps::<1>(x, x)))
        })
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        // By bytes: where `no` is read from the place that the result goes to, a selection of
        // floats would become a masked store, which some CPUs take tens of cycles for.
        intrinsic!({
            let (yes, no) = (_mm256_castps_si256(yes.0), _mm256_castps_si256(no.0));
            Self(_mm256_castsi256_ps(_mm256_blendv_epi8(no, yes, _mm256_castps_si256(mask))))
        })
    }
    #[inline(always)]
    fn select_negative(x: Self, yes: Self, no: Self) -> Self {
        // By bytes, as `select`.
        intrinsic!({
            let mask = _mm256_srai_epi32::<31>(_mm256_castps_si256(x.0));
            let (yes, no) = (_mm256_castps_si256(yes.0), _mm256_castps_si256(no.0));
            Self(_mm256_castsi256_ps(_mm256_blendv_epi8(no, yes, mask)))
        })
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        let values = &values[..Self::LANES];
        intrinsic!(Self(_mm256_loadu_ps(values.as_ptr())))
    }
    #[inline(always)]
    fn store(self) -> [f32; MAX_LANES] {
        let mut out = [0.0; MAX_LANES];
        intrinsic!(_mm256_storeu_ps(out.as_mut_ptr(), self.0));
        out
    }
    #[inline(always)]
    fn write(self, values: &mut [f32]) {
        let values = &mut values[..Self::LANES];
        intrinsic!(_mm256_storeu_ps(values.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn mask_none() -> Self::Mask {
        intrinsic!(_mm256_setzero_ps())
    }
    #[inline(always)]
    fn mask_all() -> Self::Mask {
        intrinsic!(_mm256_castsi256_ps(_mm256_set1_epi32(-1)))
    }
    #[inline(always)]
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        intrinsic!(_mm256_and_ps(a, b))
    }
    #[inline(always)]
    fn mask_without(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        intrinsic!(_mm256_andnot_ps(b, a))
    }
    #[inline(always)]
    fn mask_bits(mask: Self::Mask) -> u32 {
        intrinsic!(_mm256_movemask_ps(mask) as u32)
    }
    #[inline(always)]
    fn int_splat(x: u32) -> Self::Int {
        intrinsic!(_mm256_set1_epi32(x as i32))
    }
    #[inline(always)]
    fn int_load(values: &[u32]) -> Self::Int {
        let values = &values[..Self::LANES];
        intrinsic!(_mm256_loadu_si256(values.as_ptr().cast()))
    }
    #[inline(always)]
    fn int_add(a: Self::Int, b: Self::Int) -> Self::Int {
        intrinsic!(_mm256_add_epi32(a, b))
    }
    #[inline(always)]
    fn int_mul(a: Self::Int, b: Self::Int) -> Self::Int {
        intrinsic!(_mm256_mullo_epi32(a, b))
    }
    #[inline(always)]
    fn int_xorshift16(x: Self::Int) -> Self::Int {
        intrinsic!(_mm256_xor_si256(x, _mm256_srli_epi32::<16>(x)))
    }
    #[inline(always)]
    fn upper24(x: Self::Int) -> Self {
        intrinsic!(Self(_mm256_cvtepi32_ps(_mm256_srli_epi32::<8>(x))))
    }
    #[inline(always)]
    fn sum_zero() -> Self::Sum {
        intrinsic!([_mm256_setzero_pd(); 2])
    }
    #[inline(always)]
    fn sum_add(sum: Self::Sum, x: Self) -> Self::Sum {
        intrinsic!({
            let low = _mm256_cvtps_pd(_mm256_castps256_ps128(x.0));
            let high = _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(x.0));
            [_mm256_add_pd(sum[0], low), _mm256_add_pd(sum[1], high)]
        })
    }
    #[inline(always)]
    fn sum_add_all(sum: Self::Sum, x: f64) -> Self::Sum {
        intrinsic!(sum.map(|sum| _mm256_add_pd(sum, _mm256_set1_pd(x))))
    }
    #[inline(always)]
    fn sum_store(sum: Self::Sum) -> [f64; MAX_LANES] {
        let mut out = [0.0; MAX_LANES];
        intrinsic!({
            _mm256_storeu_pd(out.as_mut_ptr(), sum[0]);
            _mm256_storeu_pd(out[4..].as_mut_ptr(), sum[1]);
        });
        out
    }
}

impl Vector for Avx512 {
    const LANES: usize = 16;
    type Int = __m512i;
    type Mask = __mmask16;
    type Sum = [__m512d; 2];

    #[inline(always)]
    fn range(functions: &Lanes4, rect: &Extent) -> Range4 {
        range(functions, rect)
    }
    #[inline(always)]
    fn ends(functions: &Lanes4, half: [f32; 2], slack: [f32; 4]) -> Ends4 {
        ends(functions, half, slack)
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        intrinsic!(Self(_mm512_set1_ps(x)))
    }
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        intrinsic!(Self(_mm512_add_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        intrinsic!(Self(_mm512_sub_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        intrinsic!(Self(_mm512_mul_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        intrinsic!(Self(_mm512_div_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        intrinsic!(Self(_mm512_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        intrinsic!(Self(_mm512_abs_ps(self.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        intrinsic!(Self(_mm512_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        intrinsic!(Self(_mm512_fmadd_ps(self.0, factor.0, addend.0)))
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        intrinsic!(_mm512_cmp_ps_mask::<_CMP_GE_OQ>(self.0, other.0))
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        intrinsic!(_mm512_cmp_ps_mask::<_CMP_GT_OQ>(self.0, other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        intrinsic!(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0))
    }
    #[inline(always)]
    fn least(self) -> f32 {
        intrinsic!(_mm512_reduce_min_ps(self.0))
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        intrinsic!(Self(_mm512_mask_blend_ps(mask, no.0, yes.0)))
    }
    #[inline(always)]
    fn select_negative(x: Self, yes: Self, no: Self) -> Self {
        intrinsic!({
            let mask = _mm512_movepi32_mask(_mm512_castps_si512(x.0));
            Self(_mm512_mask_blend_ps(mask, no.0, yes.0))
        })
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self {
        let values = &values[..Self::LANES];
        intrinsic!(Self(_mm512_loadu_ps(values.as_ptr())))
    }
    #[inline(always)]
    fn store(self) -> [f32; MAX_LANES] {
        let mut out = [0.0; MAX_LANES];
        intrinsic!(_mm512_storeu_ps(out.as_mut_ptr(), self.0));
        out
    }
    #[inline(always)]
    fn write(self, values: &mut [f32]) {
        let values = &mut values[..Self::LANES];
        intrinsic!(_mm512_storeu_ps(values.as_mut_ptr(), self.0));
    }
    #[inline(always)]
    fn mask_none() -> Self::Mask {
        0
    }
    #[inline(always)]
    fn mask_all() -> Self::Mask {
        u16::MAX
    }
    #[inline(always)]
    fn mask_and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a & b
    }
    #[inline(always)]
    fn mask_without(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        a & !b
    }
    #[inline(always)]
    fn mask_bits(mask: Self::Mask) -> u32 {
        mask.into()
    }
    #[inline(always)]
    fn int_splat(x: u32) -> Self::Int {
        intrinsic!(_mm512_set1_epi32(x as i32))
    }
    #[inline(always)]
    fn int_load(values: &[u32]) -> Self::Int {
        let values = &values[..Self::LANES];
        intrinsic!(_mm512_loadu_si512(values.as_ptr().cast()))
    }
    #[inline(always)]
    fn int_add(a: Self::Int, b: Self::Int) -> Self::Int {
        intrinsic!(_mm512_add_epi32(a, b))
    }
    #[inline(always)]
    fn int_mul(a: Self::Int, b: Self::Int) -> Self::Int {
        intrinsic!(_mm512_mullo_epi32(a, b))
    }
    #[inline(always)]
    fn int_xorshift16(x: Self::Int) -> Self::Int {
        intrinsic!(_mm512_xor_si512(x, _mm512_srli_epi32::<16>(x)))
    }
    #[inline(always)]
    fn upper24(x: Self::Int) -> Self {
        intrinsic!(Self(_mm512_cvtepi32_ps(_mm512_srli_epi32::<8>(x))))
    }
    #[inline(always)]
    fn sum_zero() -> Self::Sum {
        intrinsic!([_mm512_setzero_pd(); 2])
    }
    #[inline(always)]
    fn sum_add(sum: Self::Sum, x: Self) -> Self::Sum {
        intrinsic!({
            let low = _mm512_cvtps_pd(_mm512_castps512_ps256(x.0));
            let high = _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(x.0));
            [_mm512_add_pd(sum[0], low), _mm512_add_pd(sum[1], high)]
        })
    }
    #[inline(always)]
    fn sum_add_all(sum: Self::Sum, x: f64) -> Self::Sum {
        intrinsic!(sum.map(|sum| _mm512_add_pd(sum, _mm512_set1_pd(x))))
    }
    #[inline(always)]
    fn sum_store(sum: Self::Sum) -> [f64; MAX_LANES] {
        let mut out = [0.0; MAX_LANES];
        intrinsic!({
            _mm512_storeu_pd(out.as_mut_ptr(), sum[0]);
            _mm512_storeu_pd(out[8..].as_mut_ptr(), sum[1]);
        });
        out
    }
}

/// Four lanes, under FMA: the same steps as the plain twin's.
#[inline(always)]
fn range(functions: &Lanes4, rect: &Extent) -> Range4 {
    intrinsic!({
        let splat = |x| _mm_set1_ps(x);
        let abs = |x| _mm_andnot_ps(splat(-0.0), x);
        let [c, s, t] =
            [&functions.c, &functions.s, &functions.t].map(|x| _mm_loadu_ps(x.as_ptr()));
        let middle =
            _mm_fmadd_ps(s, splat(rect.middle[0]), _mm_fmadd_ps(t, splat(rect.middle[1]), c));
        let radius =
            _mm_fmadd_ps(abs(s), splat(rect.half[0]), _mm_mul_ps(abs(t), splat(rect.half[1])));
        let (lo, hi) = (_mm_sub_ps(middle, radius), _mm_add_ps(middle, radius));
        let last = |x| _mm_cvtss_f32(_mm_shuffle_ps::<0xff>(x, x));
        Range4 {
            below: _mm_movemask_ps(_mm_cmplt_ps(hi, splat(-CULL_SLACK))) as u32,
            above: _mm_movemask_ps(_mm_cmpgt_ps(lo, splat(CULL_SLACK))) as u32,
            last: [last(lo), last(hi)],
        }
    })
}

/// Likewise.
#[inline(always)]
fn ends(functions: &Lanes4, [half_s, half_t]: [f32; 2], slack: [f32; 4]) -> Ends4 {
    intrinsic!({
        let splat = |x| _mm_set1_ps(x);
        let abs = |x| _mm_andnot_ps(splat(-0.0), x);
        let [c, s, t, slack] =
            [&functions.c, &functions.s, &functions.t, &slack].map(|x| _mm_loadu_ps(x.as_ptr()));
        let radius = _mm_fmadd_ps(abs(t), splat(half_t), slack);
        let radius = _mm_fmadd_ps(abs(s), splat(half_s), radius);
        let mut ends = Ends4 { high: [0.0; 4], width: [0.0; 4] };
        _mm_storeu_ps(ends.high.as_mut_ptr(), _mm_add_ps(c, radius));
        _mm_storeu_ps(ends.width.as_mut_ptr(), _mm_add_ps(radius, radius));
        ends
    })
}
