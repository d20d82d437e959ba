//! A tile in which many facets stand before one another.
//!
//! No single facet may cover a stratum there, while its samples have long been hit. So facets
//! come front to back, some at a time, and each stratum's samples meet those that touch it and
//! are not behind all that they see: the work follows what is visible, and most of the facets are
//! in no list.

use super::columns::{Columns, places};
use super::draw::Group;
use super::raster::Tile;
use super::shader::Shader;
use super::strata::Room;
use super::types::{BLOCK_STRATA, Exact, Record, Work};
use super::vector::{Bits, MAX_LANES, Vector};
use super::visible::{Sample, Shadow, W_SLACK, farthest, meet_each};
use super::{Pixel32, Strata};

/// Facets of a tile from which on it counts as crowded, if it has no more than two strata for each.
pub(super) const CROWD: usize = 64;

/// Adds to each trial's sum the values of its samples in all strata of a tile.
#[inline(always)]
pub(super) fn tile_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    mut tile: Tile,
    groups: &mut [Group<V>],
    room: &mut Room<V>,
    work: &mut Work,
    exact: Exact<'_>,
) {
    // Lanes without a trial wait for nothing.
    let mut idle = [0.0; MAX_LANES];
    let n_trials = groups.last().map_or(0, |group| group.n_trials);
    idle[n_trials..].fill(f32::INFINITY);
    let idle = V::load(&idle);
    // Stratum times LEN plus the facet's place.
    let mut pairs = [0; BLOCK_STRATA * Columns::LEN];
    while let Some(block) = tile.next_block::<V>(pixel, strata, work) {
        let Work { entries, occluders, near, records, shades, list_occluders, .. } = &mut *work;
        let list = &entries[tile.list()];
        let samples = &mut room.samples;
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
        // 1/t behind which the samples of each stratum see nothing.
        let mut horizons = [0.0; BLOCK_STRATA];
        let strips = block.strips::<V>();
        let mut open = u32::MAX >> (u32::BITS as usize - block.n_strata);
        for near in near.chunks(Columns::LEN) {
            if open == 0 {
                break;
            }
            let entry = |place: &u32| &list[*place as usize];
            let facet = |place: &u32| &pixel.facets[entry(place).facet as usize];
            let columns = Columns::of(near.iter().map(facet));
            let mut facets = [&pixel.ground.background; Columns::LEN];
            for (to, place) in facets.iter_mut().zip(near) {
                *to = facet(place);
            }
            records.clear();
            shades.clear();
            if S::SHADOWS {
                for place in near {
                    let mut record = Record { strata: u32::MAX, ..Record::default() };
                    strips.shade(pixel, entry(place), occluders, &mut record, shades);
                    records.push(record);
                }
            }
            // All pairs first: how many there are of a stratum is anybody's guess.
            let (mut n_pairs, mut met) = (0, 0);
            for l in Bits(open) {
                let before = columns.before::<V>(horizons[l % BLOCK_STRATA]);
                let bits = before & columns.touching::<V>(&block.extent(l));
                open &= !(u32::from(before == 0) << l);
                met |= u32::from(bits != 0) << l;
                let first = (l * Columns::LEN) as u32;
                n_pairs += places(bits, first, &mut pairs[n_pairs..]);
            }
            for pair in &pairs[..n_pairs] {
                let (l, at) = (*pair as usize / Columns::LEN, *pair as usize % Columns::LEN);
                let mut is_whole = false;
                if S::SHADOWS {
                    let shadow = records[at].shadow(l as u32, shades);
                    is_whole = shadow.is_whole;
                    list_occluders.clear();
                    list_occluders.extend(shadow.occluders);
                }
                let shadow = Shadow { is_whole, occluders: list_occluders.iter().copied() };
                let samples = &mut samples[l * groups.len()..(l + 1) * groups.len()];
                meet_each::<S, V>(samples, pixel, facets[at], &shadow);
            }
            for l in Bits(met) {
                let samples = &samples[l * groups.len()..(l + 1) * groups.len()];
                horizons[l % BLOCK_STRATA] = farthest(samples).least() - W_SLACK;
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
