//! What fills each part of the pixel.

use super::raster::{SIDE, Tile};
use super::shader::Shader;
use super::vector::Vector;
use super::{Entry, Pixel32, Rect, Strata, Work};

/// What fills a rectangle of strata.
pub(super) enum Fill<'a> {
    /// One facet, wholly lit or wholly in shadow; none: the background.
    Uniform { facet: Option<u32>, lit: bool },
    /// Several candidates, in a single stratum; with the occluders that they index.
    Mixed { list: &'a [Entry], occluders: &'a [u32] },
}

/// Is shown what fills each rectangle. A trait and not a closure: a closure would be compiled
/// without the kernels' instruction set.
pub(super) trait Visit {
    /// Whether to end early; asked once for a tile.
    fn is_cancelled(&self) -> bool {
        false
    }
    fn visit(&mut self, pixel: &Pixel32, strata: &Strata, rect: &Rect, fill: Fill<'_>);
}

/// Cuts the pixel into rectangles of strata and shows `visitor` what fills each.
///
/// Rectangles are halved, and the list of facets filtered for each half, until one facet covers
/// the rectangle or it is small enough to be drawn into.
#[inline(always)]
pub(super) fn dissect<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    work: &mut Work,
    visitor: &mut impl Visit,
) {
    work.entries.clear();
    work.occluders.clear();
    work.stack.clear();
    for (facet, data) in (0..).zip(&pixel.facets) {
        let first = work.occluders.len() as u32;
        work.occluders.extend(data.occluders.clone());
        let occluders = [first, work.occluders.len() as u32];
        work.entries.push(Entry { facet, occluders, ..Entry::default() });
    }
    work.stack.push(Rect {
        i: [0, strata.per_axis[0]],
        j: [0, strata.per_axis[1]],
        entries: [0, work.entries.len() as u32],
        n_occluders: work.occluders.len() as u32,
    });
    while let Some(rect) = work.stack.pop()
        && !visitor.is_cancelled()
    {
        let Work { entries, occluders, .. } = &mut *work;
        entries.truncate(rect.entries[1] as usize);
        occluders.truncate(rect.n_occluders as usize);
        let is_tile = rect.i[1] - rect.i[0] <= SIDE && rect.j[1] - rect.j[0] <= SIDE;
        let is_whole = rect.entries[0] == 0;
        if is_tile && is_whole && entries.len() > 1 {
            let tile = Tile::new(strata, &rect);
            tile.draw::<S, V>(pixel, strata, [0, work.entries.len()], work, visitor);
            continue;
        }
        let first = entries.len();
        let covered = filter::<S, V>(pixel, strata, &rect, entries, occluders);
        match &entries[first..] {
            [] => visitor.visit(pixel, strata, &rect, Fill::Uniform { facet: None, lit: true }),
            [only] if covered && (!S::SHADOWS || only.is_settled()) => {
                let fill = Fill::Uniform { facet: Some(only.facet), lit: !only.shadowed };
                visitor.visit(pixel, strata, &rect, fill);
            }
            _ if is_tile => {
                let tile = Tile::new(strata, &rect);
                tile.draw::<S, V>(pixel, strata, [first, work.entries.len()], work, visitor);
            }
            _ => {
                let entries = [first as u32, entries.len() as u32];
                let n_occluders = occluders.len() as u32;
                let [a, b] = rect.halves();
                work.stack.push(Rect { entries, n_occluders, ..b });
                work.stack.push(Rect { entries, n_occluders, ..a });
            }
        }
    }
}

/// Appends to `entries` the rectangle's facets that may be seen in it, and tells whether all of
/// them cover it.
#[inline(always)]
fn filter<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Rect,
    entries: &mut Vec<Entry>,
    occluders: &mut Vec<u32>,
) -> bool {
    /// Bits of a facet's three edges.
    const EDGES: u32 = 0b0111;
    let extent = strata.extent(rect);
    let kept = entries.len();
    let mut horizon = 0.0f32;
    let mut all_cover = true;
    for at in rect.entries[0]..rect.entries[1] {
        let mut entry = entries[at as usize];
        let facet = &pixel.facets[entry.facet as usize];
        let range = V::range(&facet.lanes, &extent);
        entry.w_hi = range.last[1] + facet.w_slack;
        if range.below & EDGES != 0 || entry.w_hi < horizon {
            continue;
        }
        let covers = range.above & EDGES == EDGES;
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
    if S::SHADOWS {
        for entry in &mut entries[kept..] {
            let first = occluders.len();
            for at in entry.occluders[0]..entry.occluders[1] {
                let id = occluders[at as usize];
                let range = V::range(&pixel.occluders[id as usize], &extent);
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
    }
    all_cover
}

