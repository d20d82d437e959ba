//! A tile in which many facets stand before one another.
//!
//! No single facet may cover a stratum there, while its samples have long been hit. So facets
//! come front to back, some at a time, and each stratum's samples meet those that touch it and
//! are not behind all that they see: the work follows what is visible, and most of the facets are
//! in no list.

use super::columns::Columns;
use super::draw::Group;
use super::raster::Tile;
use super::shader::Shader;
use super::strata::Room;
use super::types::{Exact, Record, Work};
use super::vector::{Bits, MAX_LANES, Vector};
use super::visible::{Sample, Shadow, W_SLACK, meet_each};
use super::{Pixel32, Strata};

/// Facets of a tile from which on it counts as crowded.
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
    while let Some(block) = tile.next_block::<V>(pixel, strata, work) {
        let Work { entries, occluders, near, records, shades, list_occluders, .. } = &mut *work;
        let list = &entries[tile.list()];
        let Room { samples, horizons, .. } = &mut *room;
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
        horizons.clear();
        horizons.resize(block.n_strata, 0.0);
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
                    strips.shadows(pixel, entry(place), occluders, &mut record, shades);
                    records.push(record);
                }
            }
            for l in Bits(open) {
                let before = columns.before::<V>(horizons[l]);
                if before == 0 {
                    open &= !(1 << l);
                    continue;
                }
                let bits = before & columns.touching::<V>(&block.extent(l));
                if bits == 0 {
                    continue;
                }
                let samples = &mut samples[l * groups.len()..(l + 1) * groups.len()];
                for at in Bits(bits) {
                    let mut is_whole = false;
                    if S::SHADOWS {
                        let shadow = records[at].shadow(l as u32, shades);
                        is_whole = shadow.is_whole;
                        list_occluders.clear();
                        list_occluders.extend(shadow.occluders);
                    }
                    let shadow = Shadow { is_whole, occluders: list_occluders.iter().copied() };
                    meet_each::<S, V>(samples, pixel, facets[at % Columns::LEN], &shadow);
                }
                let mut farthest = V::splat(f32::INFINITY);
                for sample in samples {
                    farthest = sample.nearest.min(farthest);
                }
                horizons[l] = farthest.least() - W_SLACK;
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
