//! The nearest of several facets at each of a vector of samples.

use super::shader::{Shader, affine};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::{Entry, Lanes4, Pixel32};

/// A sample's inside test or depth comparison closer than this, in f32 units of functions whose
/// largest coefficient is 1, is settled again in f64. Rounding of three coefficients and two
/// fused steps is below 2.4e-7.
pub(super) const DOUBT: f32 = 4e-7;

/// Values of samples that lie anywhere where `list` is complete.
#[inline(always)]
pub(super) fn visible<S: Shader, V: Vector>(
    pixel: &Pixel32,
    list: &[Entry],
    occluders: &[u32],
    s: V,
    t: V,
    exact: Exact<'_>,
) -> V {
    let zero = V::splat(0.0);
    let limit = V::splat(DOUBT);
    let mut value = V::splat(pixel.ground.background.shade[0]);
    let mut nearest = zero;
    let mut nearest_slack = zero;
    let mut doubt = V::mask_none();
    for entry in list {
        let hidden = nearest.sub(nearest_slack).ge(V::splat(entry.w_hi));
        if V::mask_bits(hidden) == V::mask_bits(V::mask_all()) {
            break;
        }
        let facet = &pixel.facets[entry.facet as usize];
        let margin = least_of_three(&facet.lanes, s, t);
        // What is hidden raises no doubt: whether a lane is settled again is its own sample's
        // matter, not that of the lanes beside it, which differ with the instruction set.
        let inside = V::mask_without(margin.ge(zero), hidden);
        doubt = V::mask_or(doubt, V::mask_without(margin.abs().le(limit), hidden));
        if V::mask_bits(inside) == 0 {
            continue;
        }
        let w = affine(&facet.lanes, 3, s, t);
        let mut lit = V::mask_all();
        if S::SHADOWS {
            if entry.shadowed {
                lit = V::mask_none();
            }
            for &id in &occluders[entry.occluders[0] as usize..entry.occluders[1] as usize] {
                let occluder = &pixel.occluders[id as usize];
                let margin = least_of_three(occluder, s, t).min(affine(occluder, 3, s, t));
                lit = V::mask_without(lit, margin.ge(zero));
                doubt = V::mask_or(doubt, V::mask_and(inside, margin.abs().le(limit)));
            }
        }
        let shade = S::shade(&pixel.ground, facet, s, t, w, lit);
        let gap = w.sub(nearest);
        let slack = V::splat(facet.w_slack);
        let tied = V::mask_and(inside, gap.abs().le(slack.add(nearest_slack)));
        let wins = V::mask_and(inside, gap.gt(zero));
        doubt = V::mask_or(doubt, tied);
        value = V::select(wins, shade, value);
        nearest = V::select(wins, w, nearest);
        nearest_slack = V::select(wins, slack, nearest_slack);
    }
    if V::mask_bits(doubt) != 0 {
        value = settle(V::mask_bits(doubt), list, value, s, t, exact);
    }
    value
}

/// Puts the f64 answer in place of each doubtful lane's.
#[cold]
#[inline(never)]
fn settle_values(
    mut lanes: u32,
    list: &[Entry],
    values: &mut [f32; MAX_LANES],
    s: &[f32; MAX_LANES],
    t: &[f32; MAX_LANES],
    exact: Exact<'_>,
) {
    while lanes != 0 {
        let l = lanes.trailing_zeros() as usize;
        values[l] = exact(list, f64::from(s[l]), f64::from(t[l])) as f32;
        lanes &= lanes - 1;
    }
}

#[inline(always)]
fn settle<V: Vector>(lanes: u32, list: &[Entry], value: V, s: V, t: V, exact: Exact<'_>) -> V {
    let mut values = value.store();
    settle_values(lanes, list, &mut values, &s.store(), &t.store(), exact);
    V::load(&values)
}

#[inline(always)]
fn least_of_three<V: Vector>(functions: &Lanes4, s: V, t: V) -> V {
    affine(functions, 0, s, t).min(affine(functions, 1, s, t)).min(affine(functions, 2, s, t))
}
