//! A tile of strata, drawn into by facets, as many strata at a time as a vector has lanes.
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
/// Strata of a tile, at most.
const MAX_STRATA: usize = (SIDE * SIDE) as usize;

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
        let radius: [f32; 4] =
            std::array::from_fn(|l| s[l].abs() * half[0] + t[l].abs() * half[1] + slack[l]);
        Self {
            high: Lanes4 { c: std::array::from_fn(|l| c[l] + radius[l]), s, t },
            width: radius.map(|r| 2.0 * r),
        }
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

/// Strata in rows, one after the other.
#[derive(Debug, Clone)]
pub(super) struct Tile {
    rect: Rect,
    width: u32,
    n_strata: usize,
    /// The first stratum that is not drawn yet.
    next: usize,
    /// Its facets, a run of the work's entries.
    list: [usize; 2],
    /// Middles of the strata; those beyond the last repeat it.
    s: [f32; MAX_STRATA],
    t: [f32; MAX_STRATA],
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
        let (mut s, mut t) = ([0.0; MAX_STRATA], [0.0; MAX_STRATA]);
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
            let slack = [CULL_SLACK, CULL_SLACK, CULL_SLACK, 2.0 * facet.w_slack];
            let spans = Spans::new(&facet.lanes, half, slack);
            work.probes.push(Probe { spans, entry: at, w_hi: facet.w_hi, rows: facet.rows });
        }
        Self {
            rect: *rect,
            width,
            n_strata,
            next: 0,
            list,
            s,
            t,
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
        let Work { entries, occluders, probes, records, shades, list, pieces, .. } = work;
        records.clear();
        shades.clear();
        for lane in (0..n).step_by(V::LANES) {
            let from = records.len();
            self.candidates::<V>(first, lane, V::LANES.min(n - lane), probes, records);
            for record in &mut records[from..] {
                let [start, end] = entries[self.list[0] + record.entry as usize].occluders;
                let ids = &occluders[start as usize..end as usize];
                self.shadows::<V>(pixel, first, lane, ids, record, shades);
            }
        }
        // A stratum's entries lie side by side, with room for all records.
        let room = records.len();
        list.resize(list.len().max(room * MAX_LANES), Entry::default());
        occluders.truncate(self.n_occluders);
        let mut lens = [0; MAX_LANES];
        let mut covered = 0u32;
        let facets = &entries[self.list()];
        for (at, record) in (0..).zip(&records[..]) {
            covered |= record.covers;
            let facet = facets[record.entry as usize];
            let mut left = record.strata;
            while left != 0 {
                let l = left.trailing_zeros() as usize;
                left &= left - 1;
                let w_hi = record.w_hi[l % V::LANES];
                let shadowed = facet.shadowed || record.shadowed >> l & 1 != 0;
                let covers = record.covers >> l & 1 != 0;
                // Its record, until its occluders are known.
                let occluders = [at, at];
                list[l * room + lens[l]] = Entry { w_hi, shadowed, covers, occluders, ..facet };
                lens[l] += 1;
            }
        }
        for (l, len) in lens[..n].iter().enumerate() {
            let run = l * room..l * room + len;
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
            let fill = match &list[run.clone()] {
                [] => Some(Fill::NOTHING),
                [only] if covered >> l & 1 != 0 => Fill::covered_by(only),
                _ => None,
            };
            let fill = fill.unwrap_or(Fill::Mixed { first: run.start as u32, end: run.end as u32 });
            let [i, j] = self.stratum(first + l);
            match pieces.last_mut() {
                // A run of equal strata in a row is one piece.
                Some(last) if last.fill == fill && last.j[0] == j => last.i[1] = i + 1,
                _ => pieces.push(Piece { i: [i, i + 1], j: [j, j + 1], fill }),
            }
        }
        true
    }

    /// Which of the `n` strata from `first` on a facet may be seen in, before `horizon`; none:
    /// in none.
    #[inline(always)]
    pub(super) fn meet<V: Vector>(
        &self,
        probe: &Probe,
        first: usize,
        n: usize,
        horizon: V,
    ) -> Option<Met<V>> {
        let rows = [self.t[first] - self.half[1], self.t[first + n - 1] + self.half[1]];
        if probe.rows[1] < rows[0] || probe.rows[0] > rows[1] {
            return None;
        }
        let (s, t) = (V::load(&self.s[first..]), V::load(&self.t[first..]));
        let spans = &probe.spans;
        let edges = [spans.high(0, s, t), spans.high(1, s, t), spans.high(2, s, t)];
        let w_high = spans.high(3, s, t);
        let w_hi = w_high.min(V::splat(probe.w_hi));
        let least = edges[0].min(edges[1]).min(edges[2]);
        let touches = V::mask_and(least.ge(V::splat(0.0)), w_hi.ge(horizon));
        let real = V::mask_bits(V::mask_all()) >> (V::LANES - n);
        let strata = V::mask_bits(touches) & real;
        (strata != 0).then_some(Met { edges, w_high, w_hi, touches, strata })
    }

    /// Appends the facets that may be seen in some of the `n` strata `first + lane ..`.
    #[inline(always)]
    fn candidates<V: Vector>(
        &self,
        first: usize,
        lane: usize,
        n: usize,
        probes: &[Probe],
        records: &mut Vec<Record>,
    ) {
        let first = first + lane;
        let zero = V::splat(0.0);
        let all = V::mask_bits(V::mask_all());
        let real = all >> (V::LANES - n);
        let from = records.len();
        // 1/t behind which each stratum is covered.
        let mut horizon = zero;
        for probe in probes {
            if V::mask_bits(horizon.gt(V::splat(probe.w_hi))) == all {
                break;
            }
            let Some(met) = self.meet(probe, first, n, horizon) else { continue };
            let (spans, edges) = (&probe.spans, met.edges);
            let edges = [spans.low(0, edges[0]), spans.low(1, edges[1]), spans.low(2, edges[2])];
            let least = edges[0].min(edges[1]).min(edges[2]);
            let covers = V::mask_and(met.touches, least.gt(zero));
            let w_lo = spans.low(3, met.w_high);
            let nearer = V::mask_and(covers, w_lo.gt(horizon));
            horizon = V::select(nearer, w_lo, horizon);
            let covers = (V::mask_bits(covers) & real) << lane;
            let strata = met.strata << lane;
            records.push(Record {
                entry: probe.entry,
                strata,
                covers,
                w_hi: met.w_hi.store(),
                ..Record::default()
            });
        }
        // What a facet that came later hides.
        for record in &mut records[from..] {
            record.strata &= V::mask_bits(V::load(&record.w_hi).ge(horizon)) << lane;
        }
    }

    /// Says of a facet's record in which strata an occluder shadows it, and appends those that
    /// may do so in a part of some.
    #[inline(always)]
    pub(super) fn shadows<V: Vector>(
        &self,
        pixel: &Pixel32,
        first: usize,
        lane: usize,
        ids: &[u32],
        record: &mut Record,
        shades: &mut Vec<Shade>,
    ) {
        let first = first + lane;
        let (s, t) = (V::load(&self.s[first..]), V::load(&self.t[first..]));
        let zero = V::splat(0.0);
        record.shades = [shades.len() as u32; 2];
        for &occluder in ids {
            let lanes = &pixel.occluders[occluder as usize];
            let spans = Spans::new(lanes, self.half, [CULL_SLACK; 4]);
            let [a, b] = [spans.high(0, s, t), spans.high(1, s, t)];
            let [c, d] = [spans.high(2, s, t), spans.high(3, s, t)];
            let touches = V::mask_bits(a.min(b).min(c.min(d)).ge(zero)) << lane;
            if touches & record.strata == 0 {
                continue;
            }
            let [a, b] = [spans.low(0, a), spans.low(1, b)];
            let [c, d] = [spans.low(2, c), spans.low(3, d)];
            let blocks = V::mask_bits(a.min(b).min(c.min(d)).gt(zero)) << lane;
            record.shadowed |= blocks;
            let strata = touches & record.strata & !blocks;
            if strata != 0 {
                shades.push(Shade { occluder, strata });
            }
        }
        record.shades[1] = shades.len() as u32;
    }
}
