//! Even parts of a map, by what its tiles should cost.

use super::plan::MapPlan;
use super::region::Tiling;
use crate::study::collect;
use crate::trace::TracedScene;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fmt;
use std::str::FromStr;

/// One of the parts that a map's tiles are dealt to: `3/8` is the third of eight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "[u32; 2]", from = "[u32; 2]")]
pub struct Shard {
    /// Which part, from 1.
    pub index: u32,
    /// Number of parts.
    pub of: u32,
}

/// Words that name no shard.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0}: not a shard; write I/N, the I-th of N parts, such as 1/8 to 8/8; N is at most 100000"
)]
pub struct ShardError(pub String);

impl Shard {
    /// Everything.
    pub const WHOLE: Self = Self { index: 1, of: 1 };
    /// Most parts that a map may be split into.
    pub const MOST: u32 = 100_000;

    /// Part `index` of `of`, from 1.
    ///
    /// # Errors
    /// There is no such part.
    pub fn new(index: u32, of: u32) -> Result<Self, ShardError> {
        let exists = (1..=of).contains(&index) && of <= Self::MOST;
        exists.then_some(Self { index, of }).ok_or_else(|| ShardError(format!("{index}/{of}")))
    }

    /// This part's tiles, in order, of tiles with these expected costs. Every tile is in exactly
    /// one part. Each goes, the dearest first, to the part that has least so far (Graham 1969),
    /// so a part has tiles from all over the picture and no two differ by more than one tile.
    pub fn tiles(&self, costs: &[u64]) -> Vec<usize> {
        if self.of == 1 {
            return (0..costs.len()).collect();
        }
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by_key(|&tile| (Reverse(costs[tile]), tile));
        let mut loads: BinaryHeap<_> = (1..=self.of).map(|part| Reverse((0, part))).collect();
        let mut mine = Vec::new();
        for tile in order {
            let Some(Reverse((load, part))) = loads.pop() else { break };
            if part == self.index {
                mine.push(tile);
            }
            loads.push(Reverse((load + costs[tile], part)));
        }
        mine.sort_unstable();
        mine
    }
}

impl From<Shard> for [u32; 2] {
    fn from(shard: Shard) -> Self {
        [shard.index, shard.of]
    }
}

impl From<[u32; 2]> for Shard {
    fn from([index, of]: [u32; 2]) -> Self {
        Self { index, of }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    /// Reads `3/8`.
    fn from_str(text: &str) -> Result<Self, ShardError> {
        let pair = text.split_once('/');
        let numbers = pair
            .and_then(|(index, of)| Some((index.trim().parse().ok()?, of.trim().parse().ok()?)));
        let (index, of) = numbers.ok_or_else(|| ShardError(text.to_owned()))?;
        Self::new(index, of)
    }
}

/// What each tile should cost, in units of no meaning: the same on every machine.
///
/// The time of a pixel grows with the number of triangles in its beam. They are counted for a
/// few pixels of each tile, or of some tiles where there are very many: at most some ten
/// thousand pixels in all. Pixels that are traced by rays count as equal.
pub fn expected_costs(scene: &TracedScene, plan: &MapPlan) -> Vec<u64> {
    /// Pixels whose triangles are counted, at most.
    const PROBES: usize = 1 << 14;
    /// Of them along the side of a tile, at most.
    const ACROSS: usize = 4;
    /// Triangles that take as long as all that is done without any.
    const BASE: u64 = 6;
    let tiling = Tiling { region: plan.region, side: MapPlan::TILE_SIDE };
    let (n_tiles, columns) = (tiling.n_tiles(), tiling.columns());
    let across = (PROBES / n_tiles).isqrt().clamp(1, ACROSS) as u32;
    let stride = n_tiles.div_ceil(PROBES).isqrt().max(1);
    let stride = if stride * stride * PROBES < n_tiles { stride + 1 } else { stride };
    // The tile that speaks for this one: the top-left of a square of `stride` tiles.
    let speaker = |tile: usize| {
        let (column, row) = (tile % columns, tile / columns);
        row / stride * stride * columns + column / stride * stride
    };
    let probe = |tile: usize| -> Result<u64, std::convert::Infallible> {
        let region = tiling.tile(tile);
        let [width, height] = region.size();
        let middle = |i: u32, side: u32| (2 * i + 1) * side / (2 * across);
        let mut sum = 0;
        for (i, j) in (0..across).flat_map(|j| (0..across).map(move |i| (i, j))) {
            let pixel = [region.x0 + middle(i, width), region.y0 + middle(j, height)];
            let facets = scene.pixel(pixel, plan.channel).n_facets().unwrap_or(0);
            sum += BASE + facets as u64;
        }
        Ok(sum)
    };
    let speakers: Vec<_> = (0..n_tiles).filter(|&tile| speaker(tile) == tile).collect();
    let Ok(sums) = collect(speakers.clone(), probe);
    let cost = |tile: usize| {
        let sum = speakers.binary_search(&speaker(tile)).map_or(0, |i| sums[i]);
        sum * tiling.tile(tile).n_pixels()
    };
    (0..n_tiles).map(cost).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Region;
    use crate::scene::{Channel, load};
    use crate::study::StudyPlan;

    #[test]
    fn parts_are_even_and_have_every_tile_once() {
        let costs: Vec<u64> = (0..97).map(|i| 1 + i * i % 89).collect();
        let dearest = *costs.iter().max().unwrap();
        for of in [1, 2, 3, 8, 97, 200] {
            let parts: Vec<_> =
                (1..=of).map(|i| Shard::new(i, of).unwrap().tiles(&costs)).collect();
            let mut all = parts.concat();
            all.sort_unstable();
            assert_eq!(all, (0..97).collect::<Vec<_>>());
            let loads: Vec<u64> =
                parts.iter().map(|tiles| tiles.iter().map(|t| costs[*t]).sum()).collect();
            let (least, most) = (loads.iter().min().unwrap(), loads.iter().max().unwrap());
            assert!(most - least <= dearest, "{of}: {loads:?}");
        }
    }

    #[test]
    fn dear_tiles_are_known_and_any_number_of_tiles_is_served() {
        let mut scene = load("classic").unwrap();
        scene.camera.resolution = [128, 128];
        let plan = |size| MapPlan {
            study: StudyPlan::paper(),
            region: Region::whole(size),
            channel: Channel::Luminance,
            exact: false,
        };
        let costs = expected_costs(&TracedScene::new(scene.clone()), &plan([128, 128]));
        assert_eq!(costs.len(), 16);
        // Sky above, a crowd of triangles below.
        assert!(costs[0] < costs[8..12].iter().copied().max().unwrap() / 2, "{costs:?}");
        scene.camera.resolution = [32 * 1024, 32 * 20];
        let costs = expected_costs(&TracedScene::new(scene.clone()), &plan([32 * 1024, 32 * 20]));
        assert_eq!(costs.len(), 20 * 1024);
        assert!(costs.iter().all(|cost| *cost > 0));
    }

    #[test]
    fn shards_are_read_or_refused_with_the_way_out() {
        assert_eq!("3/8".parse::<Shard>().unwrap().to_string(), "3/8");
        for text in ["", "0/8", "9/8", "1", "1/0", "-1/8", "a/b", "1/100001"] {
            assert!(text.parse::<Shard>().unwrap_err().to_string().contains("I/N"), "{text}");
        }
    }
}
