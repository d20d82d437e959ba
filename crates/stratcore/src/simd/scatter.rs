//! Samples that may lie anywhere in the pixel: sorted into the cells of a fixed grid.

use super::dissect::Fill;
use super::draw::Group;
use super::shader::{Shader, affine};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::visible::visible;
use super::{Cells, Pixel32};
use std::sync::atomic::{AtomicBool, Ordering};

/// Values of samples within one cell.
#[inline(always)]
fn in_cell<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    cell: u32,
    s: V,
    t: V,
    exact: Exact<'_>,
) -> V {
    match cells.fills[cell as usize] {
        Fill::Uniform { facet, lit } => {
            let facet = pixel.facet(facet);
            if facet.is_flat || (S::SHADOWS && !lit) {
                return V::splat(facet.flat_value(lit));
            }
            let w = affine(&facet.lanes, 3, s, t);
            S::shade(&pixel.ground, facet, s, t, w, V::mask_all())
        }
        Fill::Mixed { first, end } => {
            let list = &cells.entries[first as usize..end as usize];
            visible::<S, V>(pixel, list, &cells.occluders, s, t, exact)
        }
    }
}

/// Overwrites `values` with those at positions (s, t) about the pixel's centre, in any order.
/// Samples are sorted by cell first, so that a vector of them shares one list; `order` is room
/// for that.
#[inline(always)]
pub(super) fn values_at<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    positions: [&[f32]; 2],
    values: &mut [f32],
    order: &mut [u32],
    exact: Exact<'_>,
) {
    let [s, t] = positions;
    let order = &mut order[..values.len()];
    let ends = cells.sort(s, t, order);
    let mut start = 0;
    for (cell, end) in (0..).zip(ends) {
        for lanes in order[start as usize..end as usize].chunks(V::LANES) {
            let (mut ls, mut lt) = ([0.0; MAX_LANES], [0.0; MAX_LANES]);
            for (l, &at) in lanes.iter().enumerate() {
                ls[l] = s[at as usize];
                lt[l] = t[at as usize];
            }
            // Idle lanes repeat the first sample: it is certainly in the cell.
            for l in lanes.len()..V::LANES {
                ls[l] = ls[0];
                lt[l] = lt[0];
            }
            let found =
                in_cell::<S, V>(pixel, cells, cell, V::load(&ls), V::load(&lt), exact).store();
            for (l, &at) in lanes.iter().enumerate() {
                values[at as usize] = found[l];
            }
        }
        start = end;
    }
}

/// Adds to each trial's sum the values of its `n` samples, which may lie anywhere.
#[inline(always)]
pub(super) fn scattered_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    n: u32,
    groups: &mut [Group<V>],
    n_trials: usize,
    exact: Exact<'_>,
    cancel: &AtomicBool,
) {
    /// Samples that are sorted together.
    const ROUND: usize = 1 << 14;
    if cells.is_single() {
        for group in groups {
            let mut index = 0;
            while index < n && !cancel.load(Ordering::Relaxed) {
                let end = n.min(index.saturating_add(ROUND as u32));
                while index < end {
                    let [s, t] = group.anywhere(index);
                    let value = in_cell::<S, V>(pixel, cells, 0, s, t, exact);
                    group.sum = V::sum_add(group.sum, value);
                    index += 1;
                }
            }
        }
        return;
    }
    let capacity = ROUND.min(n as usize * V::LANES);
    let [mut s, mut t, mut values] =
        [vec![0.0; capacity], vec![0.0; capacity], vec![0.0; capacity + V::LANES]];
    let mut order = vec![0; capacity];
    for (first_trial, group) in (0..n_trials).step_by(V::LANES).zip(groups) {
        // Lanes without a trial are not evaluated.
        let lanes = V::LANES.min(n_trials - first_trial);
        let per_round = (capacity / lanes) as u32;
        let mut index = 0;
        while index < n && !cancel.load(Ordering::Relaxed) {
            let end = n.min(index.saturating_add(per_round));
            let len = (end - index) as usize * lanes;
            for (at, index) in (0..len).step_by(lanes).zip(index..end) {
                let [ps, pt] = group.anywhere(index);
                s[at..at + lanes].copy_from_slice(&ps.store()[..lanes]);
                t[at..at + lanes].copy_from_slice(&pt.store()[..lanes]);
            }
            let at = [&s[..len], &t[..len]];
            values_at::<S, V>(pixel, cells, at, &mut values[..len], &mut order, exact);
            for at in (0..len).step_by(lanes) {
                group.sum = V::sum_add(group.sum, V::load(&values[at..at + V::LANES]));
            }
            index = end;
        }
    }
}
