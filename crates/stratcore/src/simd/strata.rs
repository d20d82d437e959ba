//! Samples of which each has a stratum of its own.
//!
//! A lane is a trial: the same stratum of neighbouring trials meets the same few facets, so one
//! short list serves all lanes.

use super::crowd::{self, CROWD};
use super::dissect::{self, Fill, Piece};
use super::draw::{Group, Spread};
use super::shader::{Shader, affine};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::visible::visible;
use super::{Entry, Facet32, Pixel32, Strata, Work};
use std::sync::atomic::{AtomicBool, Ordering};

/// Samples added in f32 before the sum moves to f64: few enough to lose nothing.
const RUN: usize = 16;

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
    let groups = match groups.split_last_mut() {
        Some((Group { spread: Some(spread), sum, n_trials, .. }, others)) => {
            *sum = fill_spread::<S, V>(pixel, strata, rect, facet, spread, *n_trials, *sum);
            others
        }
        _ => groups,
    };
    // Two at a time: they share what is read of the facet.
    let (pairs, single) = groups.as_chunks_mut::<2>();
    for pair in pairs {
        fill_groups::<S, V, 2>(pixel, strata, rect, facet, pair);
    }
    if let [group] = single {
        fill_groups::<S, V, 1>(pixel, strata, rect, facet, std::array::from_mut(group));
    }
}

#[inline(always)]
fn fill_groups<S: Shader, V: Vector, const K: usize>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Piece,
    facet: &Facet32,
    groups: &mut [Group<V>; K],
) {
    let mut sums = groups.each_ref().map(|group| group.sum);
    for j in rect.j[0]..rect.j[1] {
        for start in (rect.i[0]..rect.i[1]).step_by(RUN) {
            let mut runs = [V::splat(0.0); K];
            for i in start..rect.i[1].min(start + RUN as u32) {
                let (index, origin) = (strata.index(i, j), strata.origin(i, j));
                for (run, group) in runs.iter_mut().zip(&*groups) {
                    let place = group.sample(index, strata.step, origin);
                    *run = run.add(shade::<S, V>(pixel, facet, place));
                }
            }
            for (sum, run) in sums.iter_mut().zip(runs) {
                *sum = V::sum_add(*sum, run);
            }
        }
    }
    for (group, sum) in groups.iter_mut().zip(sums) {
        group.sum = sum;
    }
}

/// The same sums of the same values, several strata at once.
#[inline(always)]
fn fill_spread<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Piece,
    facet: &Facet32,
    spread: &Spread<V>,
    n_trials: usize,
    mut sum: V::Sum,
) -> V::Sum {
    for start in (rect.i[0]..rect.i[1]).step_by(RUN) {
        let end = rect.i[1].min(start + RUN as u32);
        // Lower ends of the strata, lane by lane; beyond the last nobody reads.
        let mut origins = [V::splat(0.0); RUN];
        for (i, origin) in (start..end).step_by(spread.n_strata).zip(&mut origins) {
            let of_lane = |lane: u32| strata.origin((i + lane).min(end), rect.j[0])[0];
            *origin = V::load(&spread.strata.map(of_lane));
        }
        for j in rect.j[0]..rect.j[1] {
            let mut run = [0.0; MAX_LANES];
            for (i, origin) in (start..end).step_by(spread.n_strata).zip(origins) {
                let origin = [origin, V::splat(strata.origin(i, j)[1])];
                let place = spread.sample(strata.index(i, j), strata.step, origin);
                let values = shade::<S, V>(pixel, facet, place).store();
                let mut lane = 0;
                for _ in 0..spread.n_strata.min((end - i) as usize) {
                    for run in &mut run[..n_trials] {
                        *run += values[lane];
                        lane += 1;
                    }
                }
            }
            sum = V::sum_add(sum, V::load(&run));
        }
    }
    sum
}

/// Radiance of a lit facet.
#[inline(always)]
fn shade<S: Shader, V: Vector>(pixel: &Pixel32, facet: &Facet32, [s, t]: [V; 2]) -> V {
    let w = affine(&facet.lanes, 3, s, t);
    S::shade(&pixel.ground, facet, s, t, w, V::mask_all())
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
