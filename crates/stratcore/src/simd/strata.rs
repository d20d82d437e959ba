//! Samples of which each has a stratum of its own.
//!
//! A lane is a trial: the same stratum of neighbouring trials meets the same few facets, so one
//! short list serves all lanes.

use super::crowd::{self, CROWD};
use super::dissect::{self, Fill, Piece};
use super::draw::Group;
use super::shader::{Shader, affine};
use super::types::Exact;
use super::vector::Vector;
use super::visible::visible;
use super::{Entry, Facet32, Pixel32, Strata, Work};
use std::sync::atomic::{AtomicBool, Ordering};

/// Samples added in f32 before the sum moves to f64: few enough to lose nothing.
const RUN: u32 = 16;

/// Adds to each trial's sum the values of its samples in all strata: one sample per stratum.
/// `next_pieces` is [`super::dissect::next_pieces`], compiled once for all shaders.
#[inline(always)]
pub(super) fn strata_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    groups: &mut [Group<V>],
    work: &mut Work,
    next_pieces: impl Fn(&mut Work) -> bool,
    exact: Exact<'_>,
    cancel: &AtomicBool,
) {
    dissect::start(pixel, strata, CROWD, work);
    let mut samples = Vec::new();
    while next_pieces(work) && !cancel.load(Ordering::Relaxed) {
        if let Some(tile) = work.crowded.take() {
            crowd::tile_sums::<S, V>(pixel, strata, &tile, groups, &mut samples, work, exact);
        }
        for piece in &work.pieces {
            match piece.fill {
                Fill::Uniform { facet, lit } => {
                    fill_rect::<S, V>(pixel, strata, piece, pixel.facet(facet), lit, groups);
                }
                Fill::Mixed { first, end } => {
                    let list = &work.list[first as usize..end as usize];
                    let at = [piece.i[0], piece.j[0]];
                    let occluders = &work.occluders;
                    sample_stratum::<S, V>(pixel, strata, at, list, occluders, groups, exact);
                }
            }
        }
    }
}

/// One facet, or the background, fills the rectangle.
#[inline(always)]
fn fill_rect<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Piece,
    facet: &Facet32,
    lit: bool,
    groups: &mut [Group<V>],
) {
    if facet.is_flat || (S::SHADOWS && !lit) {
        let sum = f64::from(facet.flat_value(lit))
            * f64::from((rect.i[1] - rect.i[0]) * (rect.j[1] - rect.j[0]));
        if sum != 0.0 {
            for group in groups {
                group.sum = V::sum_add_all(group.sum, sum);
            }
        }
        return;
    }
    for group in groups {
        let mut sum = group.sum;
        for j in rect.j[0]..rect.j[1] {
            let mut i = rect.i[0];
            while i < rect.i[1] {
                let end = rect.i[1].min(i + RUN);
                let mut run = V::splat(0.0);
                while i < end {
                    let origin = strata.origin(i, j);
                    let [s, t] = group.sample(strata.index(i, j), strata.step, origin);
                    let w = affine(&facet.lanes, 3, s, t);
                    run = run.add(S::shade(&pixel.ground, facet, s, t, w, V::mask_all()));
                    i += 1;
                }
                sum = V::sum_add(sum, run);
            }
        }
        group.sum = sum;
    }
}

/// One stratum with several candidates: the nearest facet hit gives the value.
#[inline(always)]
fn sample_stratum<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    [i, j]: [u32; 2],
    list: &[Entry],
    occluders: &[u32],
    groups: &mut [Group<V>],
    exact: Exact<'_>,
) {
    for group in groups {
        let [s, t] = group.sample(strata.index(i, j), strata.step, strata.origin(i, j));
        let value = visible::<S, V>(pixel, list, occluders, s, t, exact);
        group.sum = V::sum_add(group.sum, value);
    }
}
