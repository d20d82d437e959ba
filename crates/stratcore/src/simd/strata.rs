//! Samples of which each has a stratum of its own.
//!
//! A lane is a trial: the same stratum of neighbouring trials meets the same few facets, so one
//! short list serves all lanes.

use super::crowd::{self, CROWD};
use super::dissect::{self, Fill, Piece};
use super::draw::{Group, MAX_SPREAD, Spread};
use super::shader::{Shader, alone};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::visible::{Candidate, Sample, visible};
use super::{Facet32, Pixel32, Strata, Work};
use std::sync::atomic::{AtomicBool, Ordering};

/// Samples added in f32 before the sum moves to f64: few enough to lose no more than the rounding
/// of the values themselves does.
const RUN: usize = 16;

/// The trials of a call, and room for their samples.
pub(super) struct Drawn<'a, V: Vector> {
    pub groups: &'a mut [Group<V>],
    pub room: &'a mut Room<V>,
    /// The last group's trials, if they are few.
    pub spread: Option<Spread<V>>,
    pub cancel: &'a AtomicBool,
}

/// Room for samples, kept from call to call.
pub(super) struct Room<V: Vector> {
    /// Where a stratum's samples lie.
    pub places: Vec<[V; 2]>,
    /// Those of a block of a crowd, a run for each stratum.
    pub samples: Vec<Sample<V>>,
}

impl<V: Vector> Default for Room<V> {
    fn default() -> Self {
        Self { places: Vec::new(), samples: Vec::new() }
    }
}

impl<V: Vector> Room<V> {
    /// Too large to be kept: made for more trials than studies show at once.
    pub fn is_large(&self) -> bool {
        const MOST: usize = 1 << 20;
        self.samples.capacity() * size_of::<Sample<V>>() > MOST
    }
}

/// A rectangle of strata that one facet fills.
struct Filled<'a> {
    pixel: &'a Pixel32,
    strata: &'a Strata,
    rect: &'a Piece,
    facet: &'a Facet32,
}

/// Adds to each trial's sum the values of its samples in all strata: one sample per stratum.
/// `next_pieces` is [`super::dissect::next_pieces`], compiled once for all shaders.
#[inline(always)]
pub(super) fn strata_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    drawn: Drawn<'_, V>,
    work: &mut Work,
    next_pieces: impl Fn(&mut Work) -> bool,
    exact: Exact<'_>,
) {
    let Drawn { groups, room, spread, cancel } = drawn;
    room.places.resize(groups.len(), [V::splat(0.0); 2]);
    dissect::start(pixel, strata, CROWD, work);
    while next_pieces(work) && !cancel.load(Ordering::Relaxed) {
        if let Some(tile) = work.crowded.take() {
            crowd::tile_sums::<S, V>(pixel, strata, tile, groups, room, work, exact);
        }
        for piece in &work.pieces {
            match piece.fill {
                Fill::Uniform { facet, lit } => {
                    let filled = Filled { pixel, strata, rect: piece, facet: pixel.facet(facet) };
                    fill_rect::<S, V>(&filled, lit, groups, spread.as_ref());
                }
                Fill::Mixed { first, end } => {
                    let at = [piece.i[0], piece.j[0]];
                    let list = work.list[first as usize..end as usize].iter();
                    let list = list.map(|entry| entry.candidate::<S>(&work.list_occluders));
                    sample_stratum::<S, V>(
                        pixel,
                        strata,
                        at,
                        list,
                        groups,
                        &mut room.places,
                        exact,
                    );
                }
            }
        }
    }
}

/// One facet, or the background, fills the rectangle.
#[inline(always)]
fn fill_rect<S: Shader, V: Vector>(
    filled: &Filled<'_>,
    lit: bool,
    groups: &mut [Group<V>],
    spread: Option<&Spread<V>>,
) {
    let Filled { rect, facet, .. } = *filled;
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
    let groups = match (spread, groups.split_last_mut()) {
        (Some(spread), Some((Group { sum, n_trials, .. }, others))) => {
            *sum = match n_trials {
                1 => fill_spread::<S, V, 1>(filled, spread, *sum),
                _ => fill_spread::<S, V, MAX_SPREAD>(filled, spread, *sum),
            };
            others
        }
        _ => groups,
    };
    // Two at a time: they share what is read of the facet.
    let (pairs, single) = groups.as_chunks_mut::<2>();
    for pair in pairs {
        fill_groups::<S, V, 2>(filled, pair);
    }
    if let [group] = single {
        fill_groups::<S, V, 1>(filled, std::array::from_mut(group));
    }
}

#[inline(always)]
fn fill_groups<S: Shader, V: Vector, const K: usize>(
    filled: &Filled<'_>,
    groups: &mut [Group<V>; K],
) {
    let Filled { pixel, strata, rect, facet } = *filled;
    let mut sums = [V::sum_zero(); K];
    for (sum, group) in sums.iter_mut().zip(&*groups) {
        *sum = group.sum;
    }
    for start in (rect.i[0]..rect.i[1]).step_by(RUN) {
        for j in rect.j[0]..rect.j[1] {
            let mut runs = [V::splat(0.0); K];
            // One ahead of what is evaluated: neither waits for the other.
            let mut places = [[V::splat(0.0); 2]; K];
            for (place, group) in places.iter_mut().zip(&*groups) {
                *place = group.sample(strata.index(start, j), strata.step, strata.origin(start, j));
            }
            for next in start + 1..rect.i[1].min(start + RUN as u32) {
                let (index, origin) = (strata.index(next, j), strata.origin(next, j));
                for ((run, group), place) in runs.iter_mut().zip(&*groups).zip(&mut places) {
                    let [s, t] = *place;
                    *place = group.sample(index, strata.step, origin);
                    *run = run.add(alone::<S, V>(&pixel.ground, facet, s, t));
                }
            }
            for (run, [s, t]) in runs.iter_mut().zip(places) {
                *run = run.add(alone::<S, V>(&pixel.ground, facet, s, t));
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

/// The same sums of the same values for T trials, several strata at once.
#[inline(always)]
fn fill_spread<S: Shader, V: Vector, const T: usize>(
    filled: &Filled<'_>,
    spread: &Spread<V>,
    mut sum: V::Sum,
) -> V::Sum {
    let Filled { pixel, strata, rect, facet } = *filled;
    let at_once = V::LANES / T;
    for start in (rect.i[0]..rect.i[1]).step_by(RUN) {
        let end = rect.i[1].min(start + RUN as u32);
        for j in rect.j[0]..rect.j[1] {
            // Stratum after stratum; beyond the last nobody reads.
            let mut values = [0.0; RUN * MAX_SPREAD];
            for (i, values) in (start..end).step_by(at_once).zip(values.chunks_mut(V::LANES)) {
                let origin = [strata.origins::<V, T>(i), V::splat(strata.origin(i, j)[1])];
                let [s, t] = spread.sample(strata.index(i, j), strata.step, origin);
                alone::<S, V>(&pixel.ground, facet, s, t).write(values);
            }
            // A vector from the start: numbers stored one by one are waited for when it is read.
            let mut lanes = [0.0; MAX_LANES];
            for stratum in &values.as_chunks::<T>().0[..(end - start) as usize] {
                for (lane, value) in lanes.iter_mut().zip(stratum) {
                    *lane += value;
                }
            }
            sum = V::sum_add(sum, V::load(&lanes));
        }
    }
    sum
}

/// One stratum with several candidates: the nearest facet hit gives the value.
#[inline(always)]
fn sample_stratum<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    [i, j]: [u32; 2],
    list: impl Iterator<Item = Candidate<impl Iterator<Item = u32> + Clone>> + Clone,
    groups: &mut [Group<V>],
    places: &mut [[V; 2]],
    exact: Exact<'_>,
) {
    let (index, origin) = (strata.index(i, j), strata.origin(i, j));
    // All of them first: none waits for what others meet.
    for (place, group) in places.iter_mut().zip(&*groups) {
        *place = group.sample(index, strata.step, origin);
    }
    // Two at a time: they share what is read of a facet.
    let (pairs, single) = groups.as_chunks_mut::<2>();
    let (pairs_places, single_place) = places.as_chunks::<2>();
    for ([a, b], places) in pairs.iter_mut().zip(pairs_places) {
        let [x, y] = visible::<S, V, 2>(pixel, list.clone(), *places, exact);
        a.sum = V::sum_add(a.sum, x);
        b.sum = V::sum_add(b.sum, y);
    }
    for (group, place) in single.iter_mut().zip(single_place) {
        let [value] = visible::<S, V, 1>(pixel, list.clone(), [*place], exact);
        group.sum = V::sum_add(group.sum, value);
    }
}
