//! Samples that may lie anywhere in the pixel: sorted into the cells of a fixed grid.

use super::cells::Sorted;
use super::dissect::Fill;
use super::draw::Group;
use super::shader::{Shader, alone};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::visible::visible;
use super::{Cells, Pixel32};
use std::sync::atomic::{AtomicBool, Ordering};

/// Values of samples within cells of one fill.
#[inline(always)]
fn in_cell<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    fill: Fill,
    s: V,
    t: V,
    exact: Exact<'_>,
) -> V {
    match fill {
        Fill::Uniform { facet, lit } => {
            let facet = pixel.facet(facet);
            if facet.is_flat || (S::SHADOWS && !lit) {
                return V::splat(facet.flat_value(lit));
            }
            alone::<S, V>(&pixel.ground, facet, s, t)
        }
        Fill::Mixed { first, end } => {
            let list = &cells.entries[first as usize..end as usize];
            let list = list.iter().map(|entry| entry.candidate::<S>(&cells.occluders));
            let [value] = visible::<S, V, 1>(pixel, list, [[s, t]], exact);
            value
        }
    }
}

/// Overwrites `values` with those at positions (s, t) about the pixel's centre, in any order.
/// Samples are sorted by cell first, so that a vector of them shares one list.
#[inline(always)]
pub(super) fn values_at<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    positions: [&[f32]; 2],
    values: &mut [f32],
    sorted: &mut Sorted,
    exact: Exact<'_>,
) {
    if cells.is_single() {
        let (fill, _) = cells.fills[0];
        return run::<S, V>(pixel, cells, fill, positions, values, exact);
    }
    sorted.resize(cells, values.len());
    cells.sort(positions, sorted);
    let Sorted { ends, places, s, t, values: found } = sorted;
    let mut start = 0;
    for &(fill, end) in &cells.fills {
        let end = ends[end as usize - 1] as usize;
        let found = &mut found[start..end];
        run::<S, V>(pixel, cells, fill, [&s[start..end], &t[start..end]], found, exact);
        start = end;
    }
    for (value, place) in values.iter_mut().zip(places) {
        *value = found[*place as usize];
    }
}

/// Overwrites `values` with those at positions within cells of one fill.
#[inline(always)]
fn run<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    fill: Fill,
    [s, t]: [&[f32]; 2],
    values: &mut [f32],
    exact: Exact<'_>,
) {
    let lanes = values.chunks_mut(V::LANES).zip(s.chunks(V::LANES).zip(t.chunks(V::LANES)));
    for (values, (s, t)) in lanes {
        let len = values.len();
        if len == V::LANES {
            let found = in_cell::<S, V>(pixel, cells, fill, V::load(s), V::load(t), exact);
            found.write(values);
        } else {
            // Idle lanes repeat the first sample: it is certainly in the cell.
            let (mut all_s, mut all_t) = ([s[0]; MAX_LANES], [t[0]; MAX_LANES]);
            all_s[..len].copy_from_slice(s);
            all_t[..len].copy_from_slice(t);
            let (s, t) = (V::load(&all_s), V::load(&all_t));
            let found = in_cell::<S, V>(pixel, cells, fill, s, t, exact);
            values.copy_from_slice(&found.store()[..len]);
        }
    }
}

/// Adds to each trial's sum the values of its samples, which may lie anywhere.
#[inline(always)]
pub(super) fn scattered_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    samples: Anywhere<'_>,
    groups: &mut [Group<V>],
    room: &mut Scattered,
    exact: Exact<'_>,
    cancel: &AtomicBool,
) {
    /// Samples that are sorted together: enough for a vector in most cells, few enough for a
    /// near cache.
    const ROUND: usize = 1 << 13;
    let Anywhere { n, cells } = samples;
    if cells.is_single() {
        let (fill, _) = cells.fills[0];
        for group in groups {
            for index in (0..n).take_while(|_| !cancel.load(Ordering::Relaxed)) {
                let [s, t] = group.anywhere(index);
                let value = in_cell::<S, V>(pixel, cells, fill, s, t, exact);
                group.sum = V::sum_add(group.sum, value);
            }
        }
        return;
    }
    // Lanes without a trial are not evaluated.
    let n_trials = groups.iter().map(|group| group.n_trials).sum::<usize>();
    let together = (ROUND / n_trials).clamp(1, n as usize);
    let ([s, t, values], sorted) = room.columns(together * n_trials);
    for first in (0..n).step_by(together).take_while(|_| !cancel.load(Ordering::Relaxed)) {
        let indices = first..n.min(first.saturating_add(together as u32));
        let mut at = 0;
        for index in indices.clone() {
            for group in &*groups {
                let [ps, pt] = group.anywhere(index);
                ps.write(&mut s[at..]);
                pt.write(&mut t[at..]);
                at += group.n_trials;
            }
        }
        values_at::<S, V>(pixel, cells, [&s[..at], &t[..at]], &mut values[..at], sorted, exact);
        let mut at = 0;
        for _ in indices {
            for group in &mut *groups {
                group.sum = V::sum_add(group.sum, V::load(&values[at..]));
                at += group.n_trials;
            }
        }
    }
}

/// Samples that may lie anywhere in the pixel: so many, found through its cells.
#[derive(Clone, Copy)]
pub(crate) struct Anywhere<'a> {
    pub n: u32,
    pub cells: &'a Cells,
}

/// Room for samples on their way into the order of the cells and back.
#[derive(Default)]
pub(crate) struct Scattered {
    s: Vec<f32>,
    t: Vec<f32>,
    values: Vec<f32>,
    pub sorted: Sorted,
}

impl Scattered {
    /// Columns s, t and values of at least `n` samples, with room to sort them. Vectors are
    /// written and read whole, so there is one more behind the last sample.
    #[inline(always)]
    pub fn columns(&mut self, n: usize) -> ([&mut [f32]; 3], &mut Sorted) {
        let Self { s, t, values, sorted } = self;
        for column in [&mut *s, t, values] {
            column.resize(column.len().max(n + MAX_LANES), 0.0);
        }
        ([s, t, values], sorted)
    }
}
