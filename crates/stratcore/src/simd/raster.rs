//! A tile of strata, drawn into by facets, in vectors of strata.
//!
//! Facets come front to back. An edge function that is nowhere positive in a stratum keeps the
//! facet out of it; three that are positive throughout make it cover the stratum and hide what
//! lies wholly behind.

use super::dissect::{Fill, Piece};
use super::shader::affine;
use super::types::{Record, Shade, Work};
use super::vector::{CULL_SLACK, MAX_LANES, Vector};
use super::{Entry, Lanes4, Pixel32, Rect, Strata};
use std::ops::Range;

/// Strata of a tile along each axis, at most.
pub(super) const SIDE: u32 = 16;
/// Lanes of the shortest vector.
const LEAST_LANES: usize = 8;
/// Strata of a tile, at most.
const MAX_STRATA: usize = (SIDE * SIDE) as usize;

/// Middles of a tile's strata, s and t; those beyond the last repeat it.
#[derive(Debug, Clone)]
pub(super) struct Middles([[f32; MAX_STRATA]; 2]);

impl Default for Middles {
    fn default() -> Self {
        Self([[0.0; MAX_STRATA]; 2])
    }
}

impl Middles {
    /// Those of LANES strata.
    #[inline(always)]
    fn load<V: Vector>(&self, first: usize) -> [V; 2] {
        let [s, t] = &self.0;
        [V::load(&s[first..]), V::load(&t[first..])]
    }
}

/// Four functions as their greatest and least values over a stratum, by the stratum's middle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Spans {
    /// Greatest.
    high: Lanes4,
    /// Greatest minus least.
    width: [f32; 4],
}

impl Spans {
    /// `slack` is the rounding of each function anywhere in the pixel, and more.
    #[inline(always)]
    fn new(functions: &Lanes4, half: [f32; 2], slack: [f32; 4]) -> Self {
        let Lanes4 { c, s, t } = *functions;
        let (mut high, mut width) = (c, [0.0; 4]);
        for l in 0..4 {
            let radius = s[l].abs() * half[0] + t[l].abs() * half[1] + slack[l];
            high[l] += radius;
            width[l] = 2.0 * radius;
        }
        Self { high: Lanes4 { c: high, s, t }, width }
    }

    #[inline(always)]
    fn high<V: Vector>(&self, which: usize, s: V, t: V) -> V {
        affine(&self.high, which, s, t)
    }

    /// Greatest minus least, of which the least is meant.
    #[inline(always)]
    fn low<V: Vector>(&self, which: usize, high: V) -> V {
        high.sub(V::splat(self.width[which]))
    }
}

/// A facet, as a tile's strata need it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Probe {
    spans: Spans,
    /// Its place in the tile's list.
    pub entry: u32,
    /// As [`super::Facet32`] has them.
    pub w_hi: f32,
    rows: [f32; 2],
}

/// Where a facet meets a vector of strata.
pub(super) struct Met<V: Vector> {
    /// Greatest values of the edges and of 1/t in each stratum.
    edges: [V; 3],
    w_high: V,
    /// No nearer than this in each stratum.
    pub w_hi: V,
    touches: V::Mask,
    /// Bit l: it may be seen in stratum l.
    pub strata: u32,
}

/// Up to LANES strata of a tile, one after the other.
pub(super) struct Strip<V: Vector> {
    /// The middles; lanes beyond the last repeat some.
    s: V,
    t: V,
    /// Lower and upper ends, t of the pixel; and from the first's to the last's.
    ends: [V; 2],
    rows: [f32; 2],
    /// Bit l: there is a stratum l.
    real: u32,
}

/// Strata in rows, one after the other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tile {
    rect: Rect,
    width: u32,
    n_strata: usize,
    /// The first stratum that is not drawn yet.
    next: usize,
    /// Its facets, a run of the work's entries.
    list: [usize; 2],
    /// Half a stratum's width and height.
    half: [f32; 2],
    /// Those of the work's occluders that belong to the tile and not to a stratum.
    n_occluders: usize,
}

impl Tile {
    /// `rect` is at most [`SIDE`] strata wide and high, `list` holds its facets.
    #[inline(always)]
    pub(super) fn new<V: Vector>(
        pixel: &Pixel32,
        strata: &Strata,
        rect: &Rect,
        list: [usize; 2],
        work: &mut Work,
    ) -> Self {
        let width = rect.i[1] - rect.i[0];
        let Middles([s, t]) = &mut work.middles;
        let mut at = 0;
        let mut middle = [0.0; 2];
        for j in rect.j[0]..rect.j[1] {
            for i in rect.i[0]..rect.i[1] {
                middle = strata.middle(i, j);
                [s[at], t[at]] = middle;
                at += 1;
            }
        }
        let n_strata = at;
        let end = n_strata.next_multiple_of(MAX_LANES);
        s[n_strata..end].fill(middle[0]);
        t[n_strata..end].fill(middle[1]);
        let half = strata.half();
        work.probes.clear();
        for (entry, at) in work.entries[list[0]..list[1]].iter().zip(0..) {
            let facet = &pixel.facets[entry.facet as usize];
            let slack = [CULL_SLACK, CULL_SLACK, CULL_SLACK, 3.0 * facet.w_slack];
            let spans = Spans::new(&facet.lanes, half, slack);
            work.probes.push(Probe { spans, entry: at, w_hi: facet.w_hi, rows: facet.rows });
        }
        Self {
            rect: *rect,
            width,
            n_strata,
            next: 0,
            list,
            half,
            n_occluders: work.occluders.len(),
        }
    }

    pub(super) fn n_strata(&self) -> usize {
        self.n_strata
    }

    /// Its facets, a run of the work's entries.
    pub(super) fn list(&self) -> Range<usize> {
        self.list[0]..self.list[1]
    }

    /// Column and row of a stratum of the tile.
    pub(super) fn stratum(&self, at: usize) -> [u32; 2] {
        let at = at as u32;
        [self.rect.i[0] + at % self.width, self.rect.j[0] + at / self.width]
    }

    /// Overwrites the work's pieces with the next strata, [`MAX_LANES`] of them under every
    /// instruction set so that all cut alike; false after the last.
    #[inline(always)]
    pub(super) fn draw<V: Vector>(&mut self, pixel: &Pixel32, work: &mut Work) -> bool {
        let first = self.next;
        if first == self.n_strata {
            return false;
        }
        let n = MAX_LANES.min(self.n_strata - first);
        self.next += n;
        let Work { entries, occluders, probes, records, shades, list, pieces, middles, .. } = work;
        records.clear();
        shades.clear();
        let n_strips = n.div_ceil(V::LANES);
        let strip = |at: usize| {
            let lane = at * V::LANES;
            self.strip::<V>(first + lane, V::LANES.min(n - lane), middles)
        };
        // A strip that is not there repeats the first; nobody asks it.
        let strips = [strip(0), if n_strips > 1 { strip(1) } else { strip(0) }];
        let strips = &strips[..n_strips];
        candidates::<V>(strips, probes, records);
        for record in &mut *records {
            let [start, end] = entries[self.list[0] + record.entry as usize].occluders;
            if start != end {
                let ids = &occluders[start as usize..end as usize];
                self.shadows::<V>(pixel, strips, ids, record, shades);
            }
        }
        occluders.truncate(self.n_occluders);
        let facets = &entries[self.list()];
        let mixed = self.uniform(first, n, facets, records, shades, pieces);
        // A stratum's entries lie side by side, with room for all records.
        let room = records.len();
        list.resize(list.len().max(room * MAX_LANES), Entry::default());
        let mut lens = [0; MAX_LANES];
        for (at, record) in (0..).zip(&records[..]) {
            let facet = facets[record.entry as usize];
            let mut left = record.strata & mixed;
            while left != 0 {
                let l = left.trailing_zeros() as usize;
                left &= left - 1;
                let w_hi = record.w_hi[l];
                let shadowed = facet.shadowed || record.shadowed >> l & 1 != 0;
                let edges = record.edges(l);
                // Its record, until its occluders are known.
                let occluders = [at, at];
                list[l * room + lens[l]] = Entry { w_hi, shadowed, edges, occluders, ..facet };
                lens[l] += 1;
            }
        }
        let mut left = mixed;
        while left != 0 {
            let l = left.trailing_zeros() as usize;
            left &= left - 1;
            let run = l * room..l * room + lens[l];
            // Each entry's bound becomes that of all from it on.
            let mut farthest = 0.0f32;
            for entry in list[run.clone()].iter_mut().rev() {
                farthest = farthest.max(entry.w_hi);
                entry.w_hi = farthest;
                let start = occluders.len() as u32;
                if !entry.shadowed {
                    let [start, end] = records[entry.occluders[0] as usize].shades;
                    let run = &shades[start as usize..end as usize];
                    let here = run.iter().filter(|shade| shade.strata >> l & 1 != 0);
                    occluders.extend(here.map(|shade| shade.occluder));
                }
                entry.occluders = [start, occluders.len() as u32];
            }
            let [i, j] = self.stratum(first + l);
            let fill = Fill::Mixed { first: run.start as u32, end: run.end as u32 };
            pieces.push(Piece { i: [i, i + 1], j: [j, j + 1], fill });
        }
        true
    }

    /// Appends the pieces of those of the `n` strata from `first` on that nothing or a single
    /// facet fills, wholly lit or wholly in shadow. Bit l of what it gives: stratum l is none of
    /// them.
    #[inline(always)]
    fn uniform(
        &self,
        first: usize,
        n: usize,
        facets: &[Entry],
        records: &[Record],
        shades: &[Shade],
        pieces: &mut Vec<Piece>,
    ) -> u32 {
        let (mut met, mut shared) = (0, 0);
        for record in records {
            shared |= met & record.strata;
            met |= record.strata;
        }
        let real = u32::MAX >> (u32::BITS as usize - n);
        self.runs(first, real & !met, Fill::NOTHING, pieces);
        let mut mixed = met;
        for record in records {
            let [a, b, c] = record.inside;
            let alone = record.strata & !shared & a & b & c;
            if alone == 0 {
                continue;
            }
            let entry = facets[record.entry as usize];
            let facet = Some(entry.facet);
            let shadowed = alone & if entry.shadowed { u32::MAX } else { record.shadowed };
            let [start, end] = record.shades.map(|at| at as usize);
            let partly = shades[start..end].iter().fold(0, |strata, shade| strata | shade.strata);
            let lit = alone & !shadowed & !partly;
            self.runs(first, lit, Fill::Uniform { facet, lit: true }, pieces);
            self.runs(first, shadowed, Fill::Uniform { facet, lit: false }, pieces);
            mixed &= !(lit | shadowed);
        }
        mixed
    }

    /// Appends the strata of `first ..` whose bits are set, a piece for each run within a row.
    #[inline(always)]
    fn runs(&self, first: usize, mut strata: u32, fill: Fill, pieces: &mut Vec<Piece>) {
        while strata != 0 {
            let l = strata.trailing_zeros();
            let [i, j] = self.stratum(first + l as usize);
            let len = (strata >> l).trailing_ones().min(self.rect.i[1] - i);
            pieces.push(Piece { i: [i, i + len], j: [j, j + 1], fill });
            strata &= !((u32::MAX >> (u32::BITS - len)) << l);
        }
    }

    /// `n` strata from `first` on.
    #[inline(always)]
    pub(super) fn strip<V: Vector>(&self, first: usize, n: usize, middles: &Middles) -> Strip<V> {
        let [s, t] = middles.load(first);
        let [_, rows] = &middles.0;
        let half = V::splat(self.half[1]);
        Strip {
            s,
            t,
            ends: [t.sub(half), t.add(half)],
            rows: [rows[first] - self.half[1], rows[first + n - 1] + self.half[1]],
            real: V::mask_bits(V::mask_all()) >> (V::LANES - n),
        }
    }

    /// Says of a facet's record in which strata an occluder shadows it, and appends those that
    /// may do so in a part of some. The strips are those of the record.
    #[inline(always)]
    pub(super) fn shadows<V: Vector>(
        &self,
        pixel: &Pixel32,
        strips: &[Strip<V>],
        ids: &[u32],
        record: &mut Record,
        shades: &mut Vec<Shade>,
    ) {
        let zero = V::splat(0.0);
        record.shades = [shades.len() as u32; 2];
        for &occluder in ids {
            let lanes = &pixel.occluders[occluder as usize];
            let spans = Spans::new(lanes, self.half, [CULL_SLACK; 4]);
            let (mut touches, mut blocks) = (0, 0);
            for (at, strip) in strips.iter().enumerate() {
                let Strip { s, t, .. } = *strip;
                let [a, b] = [spans.high(0, s, t), spans.high(1, s, t)];
                let [c, d] = [spans.high(2, s, t), spans.high(3, s, t)];
                let lane = at * V::LANES;
                touches |= V::mask_bits(a.min(b).min(c.min(d)).ge(zero)) << lane;
                let [a, b] = [spans.low(0, a), spans.low(1, b)];
                let [c, d] = [spans.low(2, c), spans.low(3, d)];
                blocks |= V::mask_bits(a.min(b).min(c.min(d)).gt(zero)) << lane;
            }
            record.shadowed |= blocks;
            let strata = touches & record.strata & !blocks;
            if strata != 0 {
                shades.push(Shade { occluder, strata });
            }
        }
        record.shades[1] = shades.len() as u32;
    }
}

impl<V: Vector> Strip<V> {
    /// Which strata a facet may be seen in, before `horizon`; none: in none.
    #[inline(always)]
    pub(super) fn meet(&self, probe: &Probe, horizon: V) -> Option<Met<V>> {
        let Self { s, t, ends, rows, real } = *self;
        if probe.rows[1] < rows[0] || probe.rows[0] > rows[1] {
            return None;
        }
        let spans = &probe.spans;
        let edges = [spans.high(0, s, t), spans.high(1, s, t), spans.high(2, s, t)];
        let w_high = spans.high(3, s, t);
        let w_hi = w_high.min(V::splat(probe.w_hi));
        let least = edges[0].min(edges[1]).min(edges[2]);
        // Stratum by stratum, so that what is cut does not go by the vector's length.
        let [above, below] =
            [V::splat(probe.rows[1]).ge(ends[0]), ends[1].ge(V::splat(probe.rows[0]))];
        let touches = V::mask_and(least.ge(V::splat(0.0)), w_hi.ge(horizon));
        let touches = V::mask_and(touches, V::mask_and(above, below));
        let strata = V::mask_bits(touches) & real;
        (strata != 0).then_some(Met { edges, w_high, w_hi, touches, strata })
    }
}

/// Appends the facets that may be seen in some strata of the strips, which follow one another.
#[inline(always)]
fn candidates<V: Vector>(strips: &[Strip<V>], probes: &[Probe], records: &mut Vec<Record>) {
    let zero = V::splat(0.0);
    let all = V::mask_bits(V::mask_all());
    // 1/t behind which each stratum is covered.
    let mut horizons = [zero; MAX_LANES / LEAST_LANES];
    for probe in probes {
        let mut record = Record { entry: probe.entry, ..Record::default() };
        let mut is_open = false;
        for (at, (strip, horizon)) in strips.iter().zip(&mut horizons).enumerate() {
            if V::mask_bits(horizon.gt(V::splat(probe.w_hi))) == all {
                continue;
            }
            is_open = true;
            let Some(met) = strip.meet(probe, *horizon) else { continue };
            let (spans, edges) = (&probe.spans, met.edges);
            let a = spans.low(0, edges[0]).gt(zero);
            let b = spans.low(1, edges[1]).gt(zero);
            let c = spans.low(2, edges[2]).gt(zero);
            let covers = V::mask_and(met.touches, V::mask_and(V::mask_and(a, b), c));
            let w_lo = spans.low(3, met.w_high);
            let nearer = V::mask_and(covers, w_lo.gt(*horizon));
            *horizon = V::select(nearer, w_lo, *horizon);
            let lane = at * V::LANES;
            record.strata |= met.strata << lane;
            for (inside, edge) in record.inside.iter_mut().zip([a, b, c]) {
                *inside |= V::mask_bits(edge) << lane;
            }
            let bounds = &met.w_hi.store()[..V::LANES];
            record.w_hi[lane..lane + V::LANES].copy_from_slice(bounds);
        }
        if !is_open {
            break;
        }
        if record.strata != 0 {
            records.push(record);
        }
    }
    // What a facet that came later hides.
    for record in records {
        let mut open = 0;
        for (at, horizon) in horizons[..strips.len()].iter().enumerate() {
            let bounds = V::load(&record.w_hi[at * V::LANES..]);
            open |= V::mask_bits(bounds.ge(*horizon)) << (at * V::LANES);
        }
        record.strata &= open;
    }
}
