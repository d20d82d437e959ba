//! A tile of strata, drawn into by facets, a block of strata after the other.
//!
//! Facets come front to back. An edge function that is nowhere positive in a stratum keeps the
//! facet out of it; three that are positive throughout make it cover the stratum and hide what
//! lies wholly behind.

use super::columns::Columns;
use super::dissect::{Fill, Piece};
use super::strip::Strips;
use super::types::{BLOCK_STRATA, Record, Work};
use super::vector::{Bits, Extent, Vector};
use super::{Entry, Pixel32, Rect, Strata};
use std::ops::Range;

/// Strata of a tile along each axis, at most.
pub(super) const SIDE: u32 = 16;
/// Facets of a tile from which on its blocks are squares, which fewer facets touch than rows.
const MANY: usize = 24;

/// A rectangle of strata.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tile {
    rect: Rect,
    /// Strata of a block along each axis, at most.
    block: [u32; 2],
    /// The first stratum of the next block.
    next: [u32; 2],
    /// Its facets, a run of the work's entries.
    list: [usize; 2],
    /// Those of the pixel, all of them.
    is_whole: bool,
    /// Half a stratum's width and height.
    half: [f32; 2],
}

/// A rectangle of a tile's strata, in rows.
pub(super) struct Block {
    i: [u32; 2],
    j: [u32; 2],
    pub n_strata: usize,
    /// Middles, s and t; those beyond the last repeat it.
    middles: [[f32; BLOCK_STRATA]; 2],
    half: [f32; 2],
}

impl Tile {
    /// `rect` is at most [`SIDE`] strata wide and high, `list` holds its facets.
    pub(super) fn new(
        pixel: &Pixel32,
        strata: &Strata,
        rect: &Rect,
        list: [usize; 2],
        work: &mut Work,
    ) -> Self {
        let is_whole = list[0] == 0;
        if !is_whole {
            let Work { entries, columns, .. } = work;
            let facet = |entry: &Entry| &pixel.facets[entry.facet as usize];
            let some = entries[list[0]..list[1]].chunks(Columns::LEN);
            columns.clear();
            columns.extend(some.map(|some| Columns::of(some.iter().map(facet))));
        }
        let block = if list[1] - list[0] < MANY {
            let width = rect.i[1] - rect.i[0];
            [width, BLOCK_STRATA as u32 / width]
        } else {
            [4, 4]
        };
        Self {
            rect: *rect,
            block,
            next: [rect.i[0], rect.j[0]],
            list,
            is_whole,
            half: strata.half(),
        }
    }

    /// Its facets, a run of the work's entries.
    pub(super) fn list(&self) -> Range<usize> {
        self.list[0]..self.list[1]
    }

    /// The next block, and in `work.near` the places in the tile's list of the facets that may
    /// touch it.
    #[inline(always)]
    pub(super) fn next_block<V: Vector>(
        &mut self,
        pixel: &Pixel32,
        strata: &Strata,
        work: &mut Work,
    ) -> Option<Block> {
        let [i, j] = self.next;
        if j == self.rect.j[1] {
            return None;
        }
        let i = [i, self.rect.i[1].min(i + self.block[0])];
        let j = [j, self.rect.j[1].min(j + self.block[1])];
        let is_last = i[1] == self.rect.i[1];
        self.next = if is_last { [self.rect.i[0], j[1]] } else { [i[1], j[0]] };
        let columns = if self.is_whole { &pixel.columns } else { &work.columns };
        let extent = strata.extent(&Rect { i, j, ..self.rect });
        Columns::sieve::<V>(columns, &extent, &mut work.near);
        Some(Block::new(strata, i, j, self.half))
    }

    /// Overwrites the work's pieces with those of the next block; false after the last.
    #[inline(always)]
    pub(super) fn draw<V: Vector>(
        &mut self,
        pixel: &Pixel32,
        strata: &Strata,
        work: &mut Work,
    ) -> bool {
        let Some(block) = self.next_block::<V>(pixel, strata, work) else { return false };
        let Work { entries, occluders, near, records, shades, .. } = &mut *work;
        let facets = &entries[self.list()];
        shades.clear();
        let mut strips = block.strips::<V>();
        let mut n_records = 0;
        for &place in &*near {
            let entry = &facets[place as usize];
            // In place: records are large.
            if n_records == records.len() {
                records.push(Record::default());
            }
            let record = &mut records[n_records];
            if !strips.note(&pixel.facets[entry.facet as usize], record) {
                break;
            }
            if record.strata != 0 {
                record.facet = entry.facet;
                strips.shade(pixel, entry, occluders, record, shades);
                n_records += 1;
            }
        }
        records.truncate(n_records);
        for record in &mut *records {
            strips.close(record);
        }
        let mixed = block.uniform(work);
        block.list(mixed, work);
        true
    }
}

impl Block {
    #[inline(always)]
    fn new(strata: &Strata, i: [u32; 2], j: [u32; 2], half: [f32; 2]) -> Self {
        let mut at = 0;
        let mut middles = [[0.0; BLOCK_STRATA]; 2];
        let mut last = [0.0; 2];
        for row in j[0]..j[1] {
            for column in i[0]..i[1] {
                last = strata.middle(column, row);
                [middles[0][at], middles[1][at]] = last;
                at += 1;
            }
        }
        middles[0][at..].fill(last[0]);
        middles[1][at..].fill(last[1]);
        Self { i, j, n_strata: at, middles, half }
    }

    /// The rectangle of a stratum.
    pub(super) fn extent(&self, at: usize) -> Extent {
        Extent { middle: [self.middles[0][at], self.middles[1][at]], half: self.half }
    }

    /// Column and row of a stratum.
    #[inline(always)]
    pub(super) fn stratum(&self, at: usize) -> [u32; 2] {
        let (at, width) = (at as u32, self.i[1] - self.i[0]);
        [self.i[0] + at % width, self.j[0] + at / width]
    }

    /// Its strata in vectors.
    #[inline(always)]
    pub(super) fn strips<V: Vector>(&self) -> Strips<V> {
        Strips::new(&self.middles, self.n_strata, self.half)
    }

    /// Appends the pieces of those strata that nothing or a single facet fills, wholly lit or
    /// wholly in shadow. Bit l of what it gives: stratum l is none of them.
    #[inline(always)]
    fn uniform(&self, work: &mut Work) -> u32 {
        let Work { records, shades, pieces, .. } = work;
        let (mut met, mut shared) = (0, 0);
        for record in &*records {
            shared |= met & record.strata;
            met |= record.strata;
        }
        let real = u32::MAX >> (u32::BITS as usize - self.n_strata);
        self.runs(real & !met, Fill::NOTHING, pieces);
        let mut mixed = met;
        for record in &*records {
            let [a, b, c] = record.inside;
            let alone = record.strata & !shared & a & b & c;
            if alone == 0 {
                continue;
            }
            let facet = Some(record.facet);
            let shadowed = alone & record.shadowed;
            let [start, end] = record.shades.map(|at| at as usize);
            let partly = shades[start..end].iter().fold(0, |strata, shade| strata | shade.strata);
            let lit = alone & !shadowed & !partly;
            self.runs(lit, Fill::Uniform { facet, lit: true }, pieces);
            self.runs(shadowed, Fill::Uniform { facet, lit: false }, pieces);
            mixed &= !(lit | shadowed);
        }
        mixed
    }

    /// Appends the pieces of the strata whose bits are set, and lists what may be seen in each.
    #[inline(always)]
    fn list(&self, mixed: u32, work: &mut Work) {
        let Work { records, shades, list, list_occluders, pieces, .. } = work;
        // A stratum's entries lie side by side, written from the last to the first.
        let ends = list_ends(records, mixed);
        let mut firsts = ends;
        list.resize(list.len().max(ends[BLOCK_STRATA - 1]), Entry::default());
        list_occluders.clear();
        let mut bounds = [0.0; BLOCK_STRATA];
        for record in records.iter().rev() {
            for l in Bits(record.strata & mixed) {
                let l = l % BLOCK_STRATA;
                let (bound, w_hi) = (&mut bounds[l], record.w_hi[l]);
                *bound = if w_hi > *bound { w_hi } else { *bound };
                let shadow = record.shadow(l as u32, shades);
                let start = list_occluders.len() as u32;
                list_occluders.extend(shadow.occluders);
                firsts[l] -= 1;
                list[firsts[l]] = Entry {
                    facet: record.facet,
                    occluders: [start, list_occluders.len() as u32],
                    shadowed: shadow.is_whole,
                    edges: record.edges(l as u32),
                    w_hi: *bound,
                };
            }
        }
        for l in Bits(mixed) {
            let [i, j] = self.stratum(l);
            let l = l % BLOCK_STRATA;
            let fill = Fill::Mixed { first: firsts[l] as u32, end: ends[l] as u32 };
            pieces.push(Piece { i: [i, i + 1], j: [j, j + 1], fill });
        }
    }

    /// Appends the strata whose bits are set: all of the block, or a piece for each run within a
    /// row.
    #[inline(always)]
    fn runs(&self, mut strata: u32, fill: Fill, pieces: &mut Vec<Piece>) {
        if strata.count_ones() as usize == self.n_strata {
            pieces.push(Piece { i: self.i, j: self.j, fill });
            return;
        }
        while strata != 0 {
            let l = strata.trailing_zeros();
            let [i, j] = self.stratum(l as usize);
            let len = (strata >> l).trailing_ones().min(self.i[1] - i);
            pieces.push(Piece { i: [i, i + len], j: [j, j + 1], fill });
            strata &= !((u32::MAX >> (u32::BITS - len)) << l);
        }
    }
}

/// Where the lists of the strata may end, one after the other.
#[inline(always)]
fn list_ends(records: &[Record], mixed: u32) -> [usize; BLOCK_STRATA] {
    let n = records.len();
    if n < MANY {
        // Room for all of them takes less time than counting.
        return std::array::from_fn(|l| (l + 1) * n);
    }
    let mut ends = [0; BLOCK_STRATA];
    for record in records {
        for l in Bits(record.strata & mixed) {
            ends[l % BLOCK_STRATA] += 1;
        }
    }
    let mut end = 0;
    ends.map(|n| {
        end += n;
        end
    })
}
