//! A tile in which many facets stand before one another.
//!
//! No single facet may cover a stratum there, while its samples have long been hit. So facets
//! come front to back, each meets the samples of the strata that it touches, and a stratum is
//! done when its farthest sample is nearer than what is still to come: the work follows what is
//! visible, and no list is made.

use super::draw::Group;
use super::raster::Tile;
use super::shader::{Shader, coefficients};
use super::types::{Exact, Record, Work};
use super::vector::{MAX_LANES, Vector};
use super::visible::{Candidate, EDGES, Sample};
use super::{Pixel32, Strata};
use std::slice::from_ref;

/// Adds to each trial's sum the values of its samples in all strata of a tile.
///
/// `samples` is room for those of a vector of strata.
#[inline(always)]
pub(super) fn tile_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    tile: &Tile,
    groups: &mut [Group<V>],
    samples: &mut Vec<Sample<V>>,
    work: &mut Work,
    exact: Exact<'_>,
) {
    let Work { entries, occluders, probes, shades, middles, .. } = work;
    let list = &entries[tile.list()];
    // Lanes without a trial wait for nothing.
    let mut idle = [0.0; MAX_LANES];
    let n_trials = groups.last().map_or(0, |group| group.n_trials);
    idle[n_trials..].fill(f32::INFINITY);
    let idle = V::load(&idle);
    for first in (0..tile.n_strata()).step_by(V::LANES) {
        let n = V::LANES.min(tile.n_strata() - first);
        samples.clear();
        for stratum in first..first + n {
            let [i, j] = tile.stratum(stratum);
            let (index, origin) = (strata.index(i, j), strata.origin(i, j));
            for group in &*groups {
                let at = group.sample(index, strata.step, origin);
                samples.push(Sample::new(pixel, at));
            }
            if let Some(last) = samples.last_mut() {
                last.nearest = idle;
            }
        }
        // 1/t behind which each stratum's samples see nothing; strata that are none see nothing.
        let mut horizon = [f32::INFINITY; MAX_LANES];
        horizon[..n].fill(0.0);
        let mut behind = V::load(&horizon);
        let strip = tile.strip::<V>(first, n, middles);
        for probe in &probes[..] {
            if V::mask_bits(behind.gt(V::splat(probe.w_hi))) == V::mask_bits(V::mask_all()) {
                break;
            }
            let Some(met) = strip.meet(probe, behind) else { continue };
            let entry = &list[probe.entry as usize];
            let facet = &pixel.facets[entry.facet as usize];
            let w_hi = met.w_hi.store();
            let mut record = Record { strata: met.strata, ..Record::default() };
            if S::SHADOWS {
                shades.clear();
                let [from, to] = entry.occluders.map(|at| at as usize);
                let ids = &occluders[from..to];
                tile.shadows::<V>(pixel, from_ref(&strip), ids, &mut record, shades);
            }
            let edge = |which| coefficients(&facet.lanes, which);
            let edges = [edge(0), edge(1), edge(2)];
            let mut left = met.strata;
            let mut nearer = false;
            while left != 0 {
                let l = left.trailing_zeros() as usize;
                left &= left - 1;
                let shadowed = entry.shadowed || record.shadowed >> l & 1 != 0;
                let candidate = Candidate { facet, shadowed, edges: EDGES };
                let samples = &mut samples[l * groups.len()..(l + 1) * groups.len()];
                let bound = V::splat(w_hi[l]);
                let mut seen = V::mask_none();
                for batch in samples.chunks_mut(BATCH) {
                    // Without a branch: which vectors are hit is anybody's guess.
                    let mut hit = 0u32;
                    for (at, sample) in (0..).zip(&*batch) {
                        hit |= u32::from(sample.may_see(&edges, bound)) << at;
                    }
                    while hit != 0 {
                        let sample = &mut batch[hit.trailing_zeros() as usize];
                        hit &= hit - 1;
                        let here = shades.iter().filter(|shade| shade.strata >> l & 1 != 0);
                        let ids = here.map(|shade| shade.occluder);
                        let sees = sample.meet::<S, true>(pixel, &candidate, ids);
                        seen = V::mask_or(seen, sees);
                    }
                }
                if V::mask_bits(seen) != 0 {
                    let mut nearest = V::splat(f32::INFINITY);
                    for sample in &*samples {
                        nearest = nearest.min(sample.horizon());
                    }
                    horizon[l] = nearest.least();
                    nearer |= horizon[l] > 0.0;
                }
            }
            if nearer {
                behind = V::load(&horizon);
            }
        }
        for samples in samples.chunks(groups.len()) {
            for (group, sample) in groups.iter_mut().zip(samples) {
                group.sum = V::sum_add(group.sum, sample.settled(list, exact));
            }
        }
    }
}

/// Vectors of a stratum that are tried together, a bit for each.
const BATCH: usize = 32;
/// Facets of a tile from which on it counts as crowded.
pub(super) const CROWD: usize = 64;
