//! A tile of strata, drawn into by facets, as many strata at a time as a vector has lanes.
//!
//! Facets come front to back. An edge function that is nowhere positive in a stratum keeps the
//! facet out of it; three that are positive throughout make it cover the stratum and hide what
//! lies wholly behind.

use super::dissect::{Fill, Visit};
use super::shader::{Shader, affine};
use super::types::{Record, Work};
use super::vector::{CULL_SLACK, MAX_LANES, Vector};
use super::{Entry, Lanes4, Pixel32, Rect, Strata};

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
    entry: u32,
    /// As [`super::Facet32`] has them.
    w_hi: f32,
    rows: [f32; 2],
}

/// Strata in rows, one after the other.
pub(super) struct Tile {
    rect: Rect,
    width: u32,
    n_strata: usize,
    /// Middles of the strata; those beyond the last repeat it.
    s: [f32; MAX_STRATA],
    t: [f32; MAX_STRATA],
    /// Half a stratum's width and height.
    half: [f32; 2],
}

impl Tile {
    /// `rect` is at most [`SIDE`] strata wide and high.
    #[inline(always)]
    pub(super) fn new(strata: &Strata, rect: &Rect) -> Self {
        let width = rect.i[1] - rect.i[0];
        let height = rect.j[1] - rect.j[0];
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
        let n_strata = (width * height) as usize;
        let end = n_strata.next_multiple_of(MAX_LANES);
        s[n_strata..end].fill(middle[0]);
        t[n_strata..end].fill(middle[1]);
        Self { rect: *rect, width, n_strata, s, t, half: strata.half() }
    }

    /// Shows `visitor` what fills each stratum, or each run of strata with the same content.
    #[inline(always)]
    pub(super) fn draw<S: Shader, V: Vector>(
        &self,
        pixel: &Pixel32,
        strata: &Strata,
        [first, end]: [usize; 2],
        work: &mut Work,
        visitor: &mut impl Visit,
    ) {
        let Work { entries, occluders, probes, records, strata: lists, strata_occluders, .. } =
            work;
        let list = &entries[first..end];
        probes.clear();
        for (entry, at) in list.iter().zip(0..) {
            let facet = &pixel.facets[entry.facet as usize];
            let w = 2.0 * facet.w_slack;
            let slack = [CULL_SLACK, CULL_SLACK, CULL_SLACK, w];
            let spans = Spans::new(&facet.lanes, self.half, slack);
            probes.push(Probe { spans, entry: at, w_hi: facet.w_hi, rows: facet.rows });
        }
        for first in (0..self.n_strata).step_by(V::LANES) {
            let n = V::LANES.min(self.n_strata - first);
            let horizon = self.candidates::<V>(first, n, probes, records);
            // What was hidden by a facet that came later.
            for record in &mut records[..] {
                let visible = V::load(&record.w_hi).ge(horizon);
                record.strata &= V::mask_bits(visible);
            }
            let room = records.len();
            lists.resize(lists.len().max(room * V::LANES), Entry::default());
            let mut lens = [0; MAX_LANES];
            let mut covered = 0u32;
            for record in &records[..] {
                let mut left = record.strata;
                covered |= record.covers;
                while left != 0 {
                    let l = left.trailing_zeros() as usize;
                    left &= left - 1;
                    let entry = list[record.entry as usize];
                    lists[l * room + lens[l]] = Entry { w_hi: record.w_hi[l], ..entry };
                    lens[l] += 1;
                }
            }
            // Each entry's bound becomes that of all from it on.
            for l in 0..n {
                let mut farthest = 0.0f32;
                for entry in lists[l * room..l * room + lens[l]].iter_mut().rev() {
                    farthest = farthest.max(entry.w_hi);
                    entry.w_hi = farthest;
                }
            }
            if S::SHADOWS {
                strata_occluders.clear();
                for l in 0..n {
                    let middle = [self.s[first + l], self.t[first + l]];
                    for entry in &mut lists[l * room..l * room + lens[l]] {
                        let run = &occluders[entry.occluders[0] as usize..entry.occluders[1] as usize];
                        let from = strata_occluders.len();
                        for &id in run {
                            let extent = super::vector::Extent { middle, half: self.half };
                            let range = V::range(&pixel.occluders[id as usize], &extent);
                            if range.above == 0b1111 {
                                entry.shadowed = true;
                                strata_occluders.truncate(from);
                                break;
                            }
                            if range.below == 0 {
                                strata_occluders.push(id);
                            }
                        }
                        entry.occluders = [from as u32, strata_occluders.len() as u32];
                    }
                }
            }
            self.show::<S>(pixel, strata, first, n, room, &lens, covered, lists, strata_occluders, visitor);
        }
    }

    /// The facets that touch some of the strata `first ..`, and the inverse depth behind which
    /// each stratum is covered.
    #[inline(always)]
    fn candidates<V: Vector>(
        &self,
        first: usize,
        n: usize,
        probes: &[Probe],
        records: &mut Vec<Record>,
    ) -> V {
        let (s, t) = (V::load(&self.s[first..]), V::load(&self.t[first..]));
        let rows = [self.t[first] - self.half[1], self.t[first + n - 1] + self.half[1]];
        let zero = V::splat(0.0);
        let all = V::mask_bits(V::mask_all());
        let real = all >> (V::LANES - n);
        let mut horizon = zero;
        records.clear();
        for probe in probes {
            if probe.rows[1] < rows[0] || probe.rows[0] > rows[1] {
                continue;
            }
            if V::mask_bits(horizon.gt(V::splat(probe.w_hi))) == all {
                break;
            }
            let spans = &probe.spans;
            let edges = [spans.high(0, s, t), spans.high(1, s, t), spans.high(2, s, t)];
            let w_hi = spans.high(3, s, t);
            let least = edges[0].min(edges[1]).min(edges[2]);
            let touches = V::mask_and(least.ge(zero), w_hi.ge(horizon));
            let strata = V::mask_bits(touches) & real;
            if strata == 0 {
                continue;
            }
            let edges = [spans.low(0, edges[0]), spans.low(1, edges[1]), spans.low(2, edges[2])];
            let least = edges[0].min(edges[1]).min(edges[2]);
            let covers = V::mask_and(touches, least.gt(zero));
            let w_lo = spans.low(3, w_hi);
            let nearer = V::mask_and(covers, w_lo.gt(horizon));
            horizon = V::select(nearer, w_lo, horizon);
            let covers = V::mask_bits(covers) & real;
            records.push(Record { entry: probe.entry, strata, covers, w_hi: w_hi.store() });
        }
        horizon
    }

    #[expect(clippy::too_many_arguments, reason = "tmp")]
    #[inline(always)]
    fn show<S: Shader>(
        &self,
        pixel: &Pixel32,
        strata: &Strata,
        first: usize,
        n: usize,
        room: usize,
        lens: &[usize; MAX_LANES],
        covered: u32,
        lists: &[Entry],
        occluders: &[u32],
        visitor: &mut impl Visit,
    ) {
        let uniform = |l: usize| -> Option<(Option<u32>, bool)> {
            match &lists[l * room..l * room + lens[l]] {
                [] => Some((None, true)),
                [only] if covered >> l & 1 != 0 && (!S::SHADOWS || only.is_settled()) => {
                    Some((Some(only.facet), !only.shadowed))
                }
                _ => None,
            }
        };
        let mut l = 0;
        while l < n {
            let at = (first + l) as u32;
            let (i, j) = (self.rect.i[0] + at % self.width, self.rect.j[0] + at / self.width);
            let rect = Rect { i: [i, i + 1], j: [j, j + 1], ..self.rect };
            let Some((facet, lit)) = uniform(l) else {
                let list = &lists[l * room..l * room + lens[l]];
                visitor.visit(pixel, strata, &rect, Fill::Mixed { list, occluders });
                l += 1;
                continue;
            };
            let row_end = n.min(l + (self.rect.i[1] - i) as usize);
            let from = l;
            l += 1;
            while l < row_end && uniform(l) == Some((facet, lit)) {
                l += 1;
            }
            let rect = Rect { i: [i, i + (l - from) as u32], ..rect };
            visitor.visit(pixel, strata, &rect, Fill::Uniform { facet, lit });
        }
    }
}
