//! A tile in which many facets stand before one another.
//!
//! No single facet may cover a stratum there, while its samples have long been hit. So facets
//! come front to back, some at a time, each stratum's samples meet those that touch it, and a
//! stratum is done when its farthest sample is nearer than what is still to come: the work follows
//! what is visible, and most of the facets are in no list.

use super::columns::Columns;
use super::draw::Group;
use super::raster::Tile;
use super::shader::Shader;
use super::types::{BLOCK_STRATA, Exact, Record, Work};
use super::vector::{MAX_LANES, Vector};
use super::visible::{Sample, meet_all};
use super::{Pixel32, Strata};

/// Facets of a tile from which on it counts as crowded.
pub(super) const CROWD: usize = 64;

/// Adds to each trial's sum the values of its samples in all strata of a tile.
///
/// `samples` is room for those of a block.
#[inline(always)]
pub(super) fn tile_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    mut tile: Tile,
    groups: &mut [Group<V>],
    samples: &mut Vec<Sample<V>>,
    work: &mut Work,
    exact: Exact<'_>,
) {
    // Lanes without a trial wait for nothing.
    let mut idle = [0.0; MAX_LANES];
    let n_trials = groups.last().map_or(0, |group| group.n_trials);
    idle[n_trials..].fill(f32::INFINITY);
    let idle = V::load(&idle);
    while let Some(block) = tile.next_block::<V>(pixel, strata, work) {
        let Work { entries, occluders, near, records, shades, .. } = &mut *work;
        let list = &entries[tile.list()];
        samples.clear();
        for stratum in 0..block.n_strata {
            let [i, j] = block.stratum(stratum);
            let (index, origin) = (strata.index(i, j), strata.origin(i, j));
            for group in &*groups {
                let at = group.sample(index, strata.step, origin);
                samples.push(Sample::new(pixel, at));
            }
            if let Some(last) = samples.last_mut() {
                last.nearest = idle;
            }
        }
        let strips = block.strips::<V>();
        // 1/t behind which each stratum's samples see nothing.
        let mut horizons = [0.0f32; BLOCK_STRATA];
        let horizons = &mut horizons[..block.n_strata];
        for near in near.chunks(Columns::LEN) {
            let entry = |place: &u32| &list[*place as usize];
            let facet = |place: &u32| &pixel.facets[entry(place).facet as usize];
            let w_hi = near.first().map_or(0.0, |first| facet(first).w_hi);
            if horizons.iter().all(|horizon| *horizon > w_hi) {
                break;
            }
            let columns = Columns::of(near.iter().map(facet));
            records.clear();
            shades.clear();
            for place in near {
                let entry = entry(place);
                let mut record = Record { facet: entry.facet, ..Record::default() };
                if S::SHADOWS {
                    record.shadowed = if entry.shadowed { u32::MAX } else { 0 };
                    record.strata = u32::MAX;
                    let [start, end] = entry.occluders.map(|at| at as usize);
                    strips.shadows(pixel, &occluders[start..end], &mut record, shades);
                }
                records.push(record);
            }
            let strata = horizons.iter_mut().zip(samples.chunks_mut(groups.len())).enumerate();
            for (l, (horizon, samples)) in strata {
                if *horizon > w_hi {
                    continue;
                }
                let bits = columns.touching::<V>(&block.extent(l));
                if bits == 0 {
                    continue;
                }
                let list = Bits(bits).map(|at| records[at].unbounded(l as u32, shades));
                let (pairs, single) = samples.as_chunks_mut::<2>();
                for pair in pairs {
                    meet_all::<S, V, 2>(pair, pixel, list.clone());
                }
                if let [sample] = single {
                    meet_all::<S, V, 1>(std::array::from_mut(sample), pixel, list);
                }
                let mut nearest = V::splat(f32::INFINITY);
                for sample in samples {
                    nearest = nearest.min(sample.horizon());
                }
                *horizon = nearest.least();
            }
        }
        let ids = near.iter().map(|place| list[*place as usize].facet);
        for samples in samples.chunks(groups.len()) {
            for (group, sample) in groups.iter_mut().zip(samples) {
                group.sum = V::sum_add(group.sum, sample.settled::<S>(pixel, ids.clone(), exact));
            }
        }
    }
}

/// The places of the bits that are set.
#[derive(Clone, Copy)]
struct Bits(u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let at = self.0.trailing_zeros() as usize;
        let is_one = self.0 != 0;
        self.0 &= self.0.wrapping_sub(1);
        is_one.then_some(at)
    }
}
