//! The loops over samples, written once on arrays of `L` lanes.
//!
//! A lane is a trial: the same stratum of neighbouring trials meets the same few facets, so one
//! short list serves all lanes. [`super`] compiles these functions for each instruction set;
//! they must stay `inline(always)` to be compiled with it. Every operation is a plain IEEE one
//! or a fused multiply-add, in the same order for every L and instruction set: all paths give
//! the same bits.

use super::types::Exact;
use super::{Entry, Facet32, Ground, Pixel32, Rect, Strata, TrialStreams, Work};

/// A sample's inside test or depth comparison closer than this, in f32 units of functions whose
/// largest coefficient is 1, is settled again in f64. Rounding of three coefficients and two
/// fused steps is below 2.4e-7.
pub(super) const DOUBT: f32 = 4e-7;
/// Slack of every decision about a whole rectangle.
const CULL_SLACK: f32 = 1e-6;
/// Samples added in f32 before the sum moves to f64: few enough to lose nothing.
const RUN: u32 = 16;

/// How a facet's radiance depends on the sample; chosen once per pixel.
pub(super) trait Shader {
    /// Radiance at L samples with inverse depth `w`, relative to the pixel's ground value.
    fn shade<const L: usize>(
        ground: &Ground,
        facet: &Facet32,
        s: &[f32; L],
        t: &[f32; L],
        w: &[f32; L],
        lit: &[bool; L],
    ) -> [f32; L];
    /// Whether shadows exist under this shader.
    const SHADOWS: bool;
}

/// A polynomial of second order: exact to rounding for a narrow pixel under a headlight, for
/// emission and for the background.
pub(super) struct Polynomial;

impl Shader for Polynomial {
    const SHADOWS: bool = false;
    #[inline(always)]
    fn shade<const L: usize>(
        _: &Ground,
        facet: &Facet32,
        s: &[f32; L],
        t: &[f32; L],
        _: &[f32; L],
        _: &[bool; L],
    ) -> [f32; L] {
        quadratic(&facet.shade, s, t)
    }
}

/// A headlight seen through a wide pixel: albedo (n·D) / |D|.
pub(super) struct WideHeadlight;

impl Shader for WideHeadlight {
    const SHADOWS: bool = false;
    #[inline(always)]
    fn shade<const L: usize>(
        ground: &Ground,
        facet: &Facet32,
        s: &[f32; L],
        t: &[f32; L],
        _: &[f32; L],
        _: &[bool; L],
    ) -> [f32; L] {
        let q = &facet.shade;
        let cosine = affine(q[1], q[2], q[3], s, t);
        let length_squared = quadratic(&ground.length_squared, s, t);
        let mut out = [0.0; L];
        for l in 0..L {
            out[l] = cosine[l] / length_squared[l].sqrt() + q[0];
        }
        out
    }
}

/// A directional light: what is lit adds a constant.
pub(super) struct Directional;

impl Shader for Directional {
    const SHADOWS: bool = true;
    #[inline(always)]
    fn shade<const L: usize>(
        _: &Ground,
        facet: &Facet32,
        _: &[f32; L],
        _: &[f32; L],
        _: &[f32; L],
        lit: &[bool; L],
    ) -> [f32; L] {
        let mut out = [0.0; L];
        for l in 0..L {
            out[l] = if lit[l] { facet.shade[0] + facet.shade[1] } else { facet.shade[0] };
        }
        out
    }
}

/// A point light: what is lit adds albedo h w³ / |l w - D|³, h the light's height over the
/// facet's plane.
pub(super) struct Point;

impl Shader for Point {
    const SHADOWS: bool = true;
    #[inline(always)]
    fn shade<const L: usize>(
        _: &Ground,
        facet: &Facet32,
        s: &[f32; L],
        t: &[f32; L],
        w: &[f32; L],
        lit: &[bool; L],
    ) -> [f32; L] {
        let square = quadratic(&facet.to_light, s, t);
        let mut out = [0.0; L];
        for l in 0..L {
            let ratio = w[l] / square[l].sqrt();
            let term = facet.shade[1] * ratio * ratio * ratio;
            out[l] = facet.shade[0] + if lit[l] { term } else { 0.0 };
        }
        out
    }
}

#[inline(always)]
fn affine<const L: usize>(c: f32, fs: f32, ft: f32, s: &[f32; L], t: &[f32; L]) -> [f32; L] {
    let mut out = [0.0; L];
    for l in 0..L {
        out[l] = s[l].mul_add(fs, t[l].mul_add(ft, c));
    }
    out
}

#[inline(always)]
fn quadratic<const L: usize>(q: &[f32; 6], s: &[f32; L], t: &[f32; L]) -> [f32; L] {
    let mut out = [0.0; L];
    for l in 0..L {
        let along_s = s[l].mul_add(q[3], t[l].mul_add(q[4], q[1]));
        let along_t = t[l].mul_add(q[5], q[2]);
        out[l] = s[l].mul_add(along_s, t[l].mul_add(along_t, q[0]));
    }
    out
}

/// pcg3d's first step, an LCG, on one word.
#[inline(always)]
pub(super) fn first_step(word: u32) -> u32 {
    word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)
}

/// Samples of stratum `index` in L trials: position about the pixel's centre, from the upper
/// 24 bits of the first two words of [`pcg3d`](crate::rng::pcg3d).
#[inline(always)]
fn samples<const L: usize>(
    index: u32,
    group: &TrialStreams<L>,
    step: [f32; 2],
    origin: [f32; 2],
) -> [[f32; L]; 2] {
    let index = first_step(index);
    let mut out = [[0.0; L]; 2];
    for l in 0..L {
        let mut x = index.wrapping_add(group.yz[l]);
        let mut y = group.y[l].wrapping_add(group.z[l].wrapping_mul(x));
        let mut z = group.z[l].wrapping_add(x.wrapping_mul(y));
        x ^= x >> 16;
        y ^= y >> 16;
        z ^= z >> 16;
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        out[0][l] = ((x >> 8) as i32 as f32).mul_add(step[0], origin[0]);
        out[1][l] = ((y >> 8) as i32 as f32).mul_add(step[1], origin[1]);
    }
    out
}

/// Adds to each trial's sum the values of its samples in all strata: one sample per stratum.
///
/// Rectangles of strata are halved, and the list of facets filtered for each half, until one
/// facet covers the rectangle, or it is a single stratum.
#[inline(always)]
pub(super) fn strata_sums<S: Shader, const L: usize>(
    pixel: &Pixel32,
    strata: &Strata,
    groups: &mut [TrialStreams<L>],
    work: &mut Work<'_>,
) {
    let Work { entries, occluders, stack, exact } = work;
    let exact = *exact;
    entries.clear();
    occluders.clear();
    stack.clear();
    for (facet, data) in (0..).zip(&pixel.facets) {
        let first = occluders.len() as u32;
        occluders.extend(data.occluders.clone());
        entries.push(Entry { facet, occluders: [first, occluders.len() as u32], shadowed: false });
    }
    stack.push(Rect {
        i: [0, strata.per_axis[0]],
        j: [0, strata.per_axis[1]],
        entries: [0, entries.len() as u32],
        n_occluders: occluders.len() as u32,
    });
    while let Some(rect) = stack.pop() {
        entries.truncate(rect.entries[1] as usize);
        occluders.truncate(rect.n_occluders as usize);
        let first = entries.len();
        let covered = filter::<S>(pixel, strata, &rect, entries, occluders);
        let list = &entries[first..];
        let uniform = match list {
            [] => Some(&pixel.ground.background),
            [only] if covered && (!S::SHADOWS || only.is_settled()) => {
                Some(&pixel.facets[only.facet as usize])
            }
            _ => None,
        };
        if let Some(facet) = uniform {
            let lit = list.first().is_none_or(|only| !only.shadowed);
            fill_rect::<S, L>(pixel, strata, &rect, facet, lit, groups);
        } else if rect.is_single() {
            sample_stratum::<S, L>(pixel, strata, &rect, list, occluders, groups, exact);
        } else {
            let entries = [first as u32, entries.len() as u32];
            let n_occluders = occluders.len() as u32;
            let [a, b] = rect.halves();
            stack.push(Rect { entries, n_occluders, ..b });
            stack.push(Rect { entries, n_occluders, ..a });
        }
    }
}

/// Appends to `entries` the rectangle's facets that may be seen in it, and tells whether a lone
/// one of them covers it.
#[inline(always)]
fn filter<S: Shader>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Rect,
    entries: &mut Vec<Entry>,
    occluders: &mut Vec<u32>,
) -> bool {
    let (centre, half) = strata.centre_and_half(rect);
    let mut horizon = 0.0f32;
    let mut all_cover = true;
    let kept = entries.len();
    for at in rect.entries[0]..rect.entries[1] {
        let entry = entries[at as usize];
        let facet = &pixel.facets[entry.facet as usize];
        let [lo, hi] = facet.lanes.range(centre, half);
        let edge_hi = hi[0].min(hi[1]).min(hi[2]);
        let edge_lo = lo[0].min(lo[1]).min(lo[2]);
        let (w_lo, w_hi) = (lo[3] - facet.w_slack, hi[3] + facet.w_slack);
        if edge_hi < -CULL_SLACK || w_hi < horizon {
            continue;
        }
        let covers = edge_lo > CULL_SLACK;
        if covers && w_lo > horizon {
            horizon = w_lo;
        }
        all_cover &= covers;
        entries.push(entry);
    }
    // What was kept before the horizon came nearer.
    if horizon > 0.0 && entries.len() > kept + 1 {
        let mut to = kept;
        for at in kept..entries.len() {
            let entry = entries[at];
            let facet = &pixel.facets[entry.facet as usize];
            let [_, hi] = facet.lanes.range(centre, half);
            if hi[3] + facet.w_slack >= horizon {
                entries[to] = entry;
                to += 1;
            }
        }
        entries.truncate(to);
        if let [only] = &entries[kept..] {
            let [lo, _] = pixel.facets[only.facet as usize].lanes.range(centre, half);
            all_cover = lo[0].min(lo[1]).min(lo[2]) > CULL_SLACK;
        }
    }
    if S::SHADOWS {
        for entry in &mut entries[kept..] {
            let from = entry.occluders;
            entry.occluders[0] = occluders.len() as u32;
            for at in from[0]..from[1] {
                let id = occluders[at as usize];
                let [lo, hi] = pixel.occluders[id as usize].range(centre, half);
                let (lo, hi) = (least(lo), least(hi));
                if lo > CULL_SLACK {
                    entry.shadowed = true;
                    break;
                }
                if hi >= -CULL_SLACK {
                    occluders.push(id);
                }
            }
            if entry.shadowed {
                occluders.truncate(entry.occluders[0] as usize);
            }
            entry.occluders[1] = occluders.len() as u32;
        }
    }
    all_cover
}

#[inline(always)]
fn least(x: [f32; 4]) -> f32 {
    x[0].min(x[1]).min(x[2].min(x[3]))
}

/// One facet, or the background, fills the rectangle.
#[inline(always)]
fn fill_rect<S: Shader, const L: usize>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Rect,
    facet: &Facet32,
    lit: bool,
    groups: &mut [TrialStreams<L>],
) {
    if facet.is_flat || (S::SHADOWS && !lit) {
        let lit = facet.is_flat && lit;
        let value = f64::from(facet.shade[0]) + if lit { f64::from(facet.flat_lit) } else { 0.0 };
        let sum = value * f64::from((rect.i[1] - rect.i[0]) * (rect.j[1] - rect.j[0]));
        if sum != 0.0 {
            for group in groups {
                for l in 0..L {
                    group.sum[l] += sum;
                }
            }
        }
        return;
    }
    for group in groups {
        let mut total = group.sum;
        for j in rect.j[0]..rect.j[1] {
            let mut i = rect.i[0];
            while i < rect.i[1] {
                let end = rect.i[1].min(i + RUN);
                let mut run = [0.0f32; L];
                while i < end {
                    let [s, t] =
                        samples(strata.index(i, j), group, strata.step, strata.origin(i, j));
                    let w = facet.lanes.inverse_depth(&s, &t);
                    let value = S::shade(&pixel.ground, facet, &s, &t, &w, &[true; L]);
                    for l in 0..L {
                        run[l] += value[l];
                    }
                    i += 1;
                }
                for l in 0..L {
                    total[l] += f64::from(run[l]);
                }
            }
        }
        group.sum = total;
    }
}

/// One stratum with several candidates: the nearest facet hit gives the value.
#[inline(always)]
fn sample_stratum<S: Shader, const L: usize>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Rect,
    list: &[Entry],
    occluders: &[u32],
    groups: &mut [TrialStreams<L>],
    exact: Exact<'_>,
) {
    let (i, j) = (rect.i[0], rect.j[0]);
    for group in groups {
        let [s, t] = samples(strata.index(i, j), group, strata.step, strata.origin(i, j));
        let value = visible::<S, L>(pixel, list, occluders, &s, &t, exact);
        for l in 0..L {
            group.sum[l] += f64::from(value[l]);
        }
    }
}

/// Values of L samples that lie anywhere where `list` is complete.
#[inline(always)]
pub(super) fn visible<S: Shader, const L: usize>(
    pixel: &Pixel32,
    list: &[Entry],
    occluders: &[u32],
    s: &[f32; L],
    t: &[f32; L],
    exact: Exact<'_>,
) -> [f32; L] {
    let mut value = [pixel.ground.background.shade[0]; L];
    let mut nearest = [0.0f32; L];
    let mut nearest_slack = [0.0f32; L];
    let mut doubt = [0u32; L];
    for entry in list {
        let facet = &pixel.facets[entry.facet as usize];
        let [e0, e1, e2, w] = facet.lanes.at(s, t);
        let mut lit = [true; L];
        if S::SHADOWS {
            lit = [!entry.shadowed; L];
            for &id in &occluders[entry.occluders[0] as usize..entry.occluders[1] as usize] {
                let [o0, o1, o2, o3] = pixel.occluders[id as usize].at(s, t);
                for l in 0..L {
                    let margin = o0[l].min(o1[l]).min(o2[l].min(o3[l]));
                    lit[l] &= margin < 0.0;
                    doubt[l] |= u32::from(margin.abs() <= DOUBT);
                }
            }
        }
        let shade = S::shade(&pixel.ground, facet, s, t, &w, &lit);
        for l in 0..L {
            let margin = e0[l].min(e1[l]).min(e2[l]);
            let inside = margin >= 0.0;
            let gap = w[l] - nearest[l];
            let wins = inside & (gap > 0.0);
            let tied = inside & (gap.abs() <= facet.w_slack + nearest_slack[l]);
            doubt[l] |= u32::from((margin.abs() <= DOUBT) | tied);
            value[l] = if wins { shade[l] } else { value[l] };
            nearest[l] = if wins { w[l] } else { nearest[l] };
            nearest_slack[l] = if wins { facet.w_slack } else { nearest_slack[l] };
        }
    }
    let mut any = 0;
    for l in 0..L {
        any |= doubt[l];
    }
    if any != 0 {
        for l in 0..L {
            if doubt[l] != 0 {
                value[l] = exact(list, f64::from(s[l]), f64::from(t[l])) as f32;
            }
        }
    }
    value
}
