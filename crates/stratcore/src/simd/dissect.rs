//! What fills each part of the pixel.

use super::raster::{SIDE, Tile};
use super::vector::{Extent, Vector};
use super::visible::EDGES;
use super::{Entry, Pixel32, Rect, Strata, Work};

/// Strata of a rectangle along each axis, at most: its samples take milliseconds.
const LARGEST: u32 = 64;

/// Strata for each of its facets up to which a tile counts as crowded: where they are more, few
/// facets are in each, and lists are short.
const STRATA_A_FACET: usize = 2;

/// A rectangle of strata and what fills it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub i: [u32; 2],
    pub j: [u32; 2],
    pub fill: Fill,
}

/// What fills a rectangle of strata.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fill {
    /// One facet, wholly lit or wholly in shadow; none: the background.
    Uniform { facet: Option<u32>, lit: bool },
    /// Several candidates, in a single stratum: a run of [`Work::list`], or of the cells' entries.
    Mixed { first: u32, end: u32 },
}

impl Fill {
    pub(super) const NOTHING: Self = Self::Uniform { facet: None, lit: true };

    /// One facet that covers a rectangle, if `entry` is wholly lit or wholly in shadow there.
    #[inline(always)]
    pub(super) fn covered_by(entry: &Entry) -> Option<Self> {
        let (facet, lit) = (Some(entry.facet), !entry.shadowed);
        entry.is_settled().then_some(Self::Uniform { facet, lit })
    }
}

/// Begins to cut the pixel into rectangles of strata; [`next_pieces`] shows them. Tiles of
/// `crowd` facets or more are not cut any further, unless their strata are many more.
pub(super) fn start(pixel: &Pixel32, strata: &Strata, crowd: usize, work: &mut Work) {
    work.crowd = crowd;
    let Work { entries, occluders, stack, tile, crowded, .. } = work;
    entries.clear();
    occluders.clear();
    stack.clear();
    *tile = None;
    *crowded = None;
    for (facet, data) in (0..).zip(&pixel.facets) {
        let first = occluders.len() as u32;
        occluders.extend(data.occluders.clone());
        let occluders = [first, occluders.len() as u32];
        entries.push(Entry { facet, occluders, edges: EDGES, ..Entry::default() });
    }
    stack.push(Rect {
        i: [0, strata.per_axis[0]],
        j: [0, strata.per_axis[1]],
        entries: [0, entries.len() as u32],
        n_occluders: occluders.len() as u32,
    });
}

/// Overwrites `work.pieces` with the next rectangles and their contents; false after the last.
/// There are none, but a tile in `work.crowded`, where that tile was not cut.
///
/// Rectangles are halved, and the list of facets filtered for each half, until one facet covers
/// the rectangle or it is small enough to be drawn into.
#[inline(always)]
pub(super) fn next_pieces<V: Vector>(pixel: &Pixel32, strata: &Strata, work: &mut Work) -> bool {
    work.pieces.clear();
    loop {
        if let Some(mut tile) = work.tile.take()
            && tile.draw::<V>(pixel, strata, work)
        {
            work.tile = Some(tile);
            return true;
        }
        let Some(rect) = work.stack.pop() else { return false };
        let Work { entries, occluders, stack, pieces, .. } = &mut *work;
        entries.truncate(rect.entries[1] as usize);
        occluders.truncate(rect.n_occluders as usize);
        let is_tile = rect.i[1] - rect.i[0] <= SIDE && rect.j[1] - rect.j[0] <= SIDE;
        let mut first = 0;
        let mut fill = None;
        // The pixel's own list is as short as a filter makes it.
        if !is_tile || rect.entries[0] != 0 || entries.len() < 2 {
            first = entries.len();
            let covered = filter::<V>(pixel, strata, &rect, entries, occluders);
            fill = match &entries[first..] {
                [] => Some(Fill::NOTHING),
                [only] if covered => Fill::covered_by(only),
                _ => None,
            };
        }
        let size = (rect.i[1] - rect.i[0]).max(rect.j[1] - rect.j[0]);
        if let Some(fill) = fill
            && size <= LARGEST
        {
            pieces.push(Piece { i: rect.i, j: rect.j, fill });
            return true;
        }
        if is_tile {
            let list = [first, entries.len()];
            let tile = Tile::new(pixel, strata, &rect, list, work);
            let n_facets = list[1] - list[0];
            if n_facets >= work.crowd && n_facets * STRATA_A_FACET >= rect.n_strata() {
                work.crowded = Some(tile);
                return true;
            }
            work.tile = Some(tile);
        } else {
            let entries = [first as u32, entries.len() as u32];
            let n_occluders = occluders.len() as u32;
            let [a, b] = rect.halves();
            stack.push(Rect { entries, n_occluders, ..b });
            stack.push(Rect { entries, n_occluders, ..a });
        }
    }
}

/// Appends to `entries` the rectangle's facets that may be seen in it, and tells whether all of
/// them cover it.
#[inline(always)]
fn filter<V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Rect,
    entries: &mut Vec<Entry>,
    occluders: &mut Vec<u32>,
) -> bool {
    let all_edges = u32::from(EDGES);
    let extent = strata.extent(rect);
    let kept = entries.len();
    let mut horizon = 0.0f32;
    let mut all_cover = true;
    for at in rect.entries[0]..rect.entries[1] {
        let mut entry = entries[at as usize];
        let facet = &pixel.facets[entry.facet as usize];
        let range = V::range(&facet.lanes, &extent);
        entry.w_hi = (range.last[1] + 3.0 * facet.w_slack).min(facet.w_hi);
        if range.below & all_edges != 0 || entry.w_hi < horizon {
            continue;
        }
        let covers = range.above & all_edges == all_edges;
        let w_lo = range.last[0] - facet.w_slack;
        if covers && w_lo > horizon {
            horizon = w_lo;
            // Those kept so far that now lie behind.
            let mut to = kept;
            for at in kept..entries.len() {
                entries[to] = entries[at];
                to += usize::from(entries[to].w_hi >= horizon);
            }
            entries.truncate(to);
            all_cover = entries.len() == kept;
        }
        all_cover &= covers;
        entries.push(entry);
    }
    for entry in &mut entries[kept..] {
        narrow::<V>(pixel, &extent, entry, occluders);
    }
    all_cover
}

/// Leaves an entry those of its occluders that shadow the rectangle in part, appended to the
/// list; or says that one of them shadows all of it.
#[inline(always)]
fn narrow<V: Vector>(
    pixel: &Pixel32,
    extent: &Extent,
    entry: &mut Entry,
    occluders: &mut Vec<u32>,
) {
    let [from, to] = entry.occluders.map(|at| at as usize);
    let first = occluders.len();
    for at in from..to {
        let id = occluders[at];
        let range = V::range(&pixel.occluders[id as usize], extent);
        if range.above == 0b1111 {
            entry.shadowed = true;
            occluders.truncate(first);
            break;
        }
        if range.below == 0 {
            occluders.push(id);
        }
    }
    entry.occluders = [first as u32, occluders.len() as u32];
}
