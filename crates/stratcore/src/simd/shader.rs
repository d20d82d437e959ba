//! How radiance depends on the sample, for a vector of samples.

use super::vector::Vector;
use super::{Facet32, Ground, Lanes4};

/// How a facet's radiance depends on the sample; chosen once per pixel.
pub(super) trait Shader {
    /// Whether shadows exist under this shader.
    const SHADOWS: bool;
    /// Whether what is seen is first known by its [factor](Facet32::shade_gain), and shaded by
    /// [`late`](Self::late).
    const LATE: bool = false;
    /// Radiance at samples (s, t) with inverse depth `w`, relative to the pixel's ground value.
    fn shade<V: Vector>(ground: &Ground, facet: &Facet32, s: V, t: V, w: V, lit: V::Mask) -> V;
    /// The same where facets of these factors are seen, or the background where `w` is 0.
    #[inline(always)]
    fn late<V: Vector>(_: &Ground, factor: V, _: [V; 2], _: V) -> V {
        factor
    }
}

/// A headlight seen through a narrow pixel: albedo (n·D) / |D|, which is a factor of the facet
/// times 1/t over |D|. Where one facet fills a rectangle, it is the polynomial.
pub(super) struct Headlight;

impl Shader for Headlight {
    const SHADOWS: bool = false;
    const LATE: bool = true;
    #[inline(always)]
    fn shade<V: Vector>(ground: &Ground, facet: &Facet32, s: V, t: V, w: V, lit: V::Mask) -> V {
        Polynomial::shade(ground, facet, s, t, w, lit)
    }
    #[inline(always)]
    fn late<V: Vector>(ground: &Ground, factor: V, [s, t]: [V; 2], w: V) -> V {
        let inverse_length = quadratic(&ground.inverse_length, s, t);
        let radiance = factor.mul(w).mul_add(inverse_length, V::splat(-ground.value));
        V::select(w.gt(V::splat(0.0)), radiance, V::splat(ground.background.shade[0]))
    }
}

/// A polynomial of second order: exact to rounding for a narrow pixel under a headlight, for
/// emission and for the background.
pub(super) struct Polynomial;

impl Shader for Polynomial {
    const SHADOWS: bool = false;
    #[inline(always)]
    fn shade<V: Vector>(_: &Ground, facet: &Facet32, s: V, t: V, _: V, _: V::Mask) -> V {
        quadratic(&facet.shade, s, t)
    }
}

/// A headlight seen through a wide pixel: albedo (n·D) / |D|.
pub(super) struct WideHeadlight;

impl Shader for WideHeadlight {
    const SHADOWS: bool = false;
    #[inline(always)]
    fn shade<V: Vector>(ground: &Ground, facet: &Facet32, s: V, t: V, _: V, _: V::Mask) -> V {
        let [c, along_s, along_t, ..] = facet.shade_gain;
        let cosine = s.mul_add(V::splat(along_s), t.mul_add(V::splat(along_t), V::splat(c)));
        let length = quadratic(&ground.length_squared, s, t).sqrt();
        cosine.div(length).add(V::splat(facet.shade[0]))
    }
}

/// A directional light: what is lit adds a constant.
pub(super) struct Directional;

impl Shader for Directional {
    const SHADOWS: bool = true;
    #[inline(always)]
    fn shade<V: Vector>(_: &Ground, facet: &Facet32, _: V, _: V, _: V, lit: V::Mask) -> V {
        let base = facet.shade[0];
        V::select(lit, V::splat(base + facet.shade_gain[0]), V::splat(base))
    }
}

/// A point light: what is lit adds albedo h w³ / |l w - D|³, h the light's height over the
/// facet's plane.
pub(super) struct Point;

impl Shader for Point {
    const SHADOWS: bool = true;
    #[inline(always)]
    fn shade<V: Vector>(_: &Ground, facet: &Facet32, s: V, t: V, w: V, lit: V::Mask) -> V {
        let ratio = w.div(quadratic(&facet.to_light, s, t).sqrt());
        let cube = ratio.mul(ratio).mul(ratio);
        let base = V::splat(facet.shade[0]);
        V::select(lit, cube.mul_add(V::splat(facet.shade_gain[0]), base), base)
    }
}

#[inline(always)]
fn quadratic<V: Vector>(q: &[f32; 6], s: V, t: V) -> V {
    let [c, qs, qt, qss, qst, qtt] = *q;
    let along_s = s.mul_add(V::splat(qss), t.mul_add(V::splat(qst), V::splat(qs)));
    let along_t = t.mul_add(V::splat(qtt), V::splat(qt));
    s.mul_add(along_s, t.mul_add(along_t, V::splat(c)))
}

#[inline(always)]
pub(super) fn affine<V: Vector>(functions: &Lanes4, which: usize, s: V, t: V) -> V {
    at(coefficients(functions, which), s, t)
}

/// Radiance of a lit facet that nothing hides.
#[inline(always)]
pub(super) fn alone<S: Shader, V: Vector>(ground: &Ground, facet: &Facet32, s: V, t: V) -> V {
    let w = affine(&facet.lanes, 3, s, t).sub(V::splat(facet.w_bias));
    S::shade(ground, facet, s, t, w, V::mask_all())
}

/// c, s and t of one of the functions in every lane.
#[inline(always)]
pub(super) fn coefficients<V: Vector>(functions: &Lanes4, which: usize) -> [V; 3] {
    let Lanes4 { c, s, t } = functions;
    [V::splat(c[which]), V::splat(s[which]), V::splat(t[which])]
}

#[inline(always)]
pub(super) fn at<V: Vector>([c, along_s, along_t]: [V; 3], s: V, t: V) -> V {
    s.mul_add(along_s, t.mul_add(along_t, c))
}
