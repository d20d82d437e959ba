//! A vector of strata, and where a facet or an occluder meets it.

use super::shader::at;
use super::types::{BLOCK_STRATA, Record, Shade};
use super::vector::{CULL_SLACK, Ends4, Vector};
use super::{Entry, Facet32, Lanes4, Pixel32};

/// Four functions over strata of one size, by the stratum's middle.
struct Spans<'a> {
    functions: &'a Lanes4,
    ends: Ends4,
}

impl Spans<'_> {
    /// Greatest value of a function in each stratum.
    #[inline(always)]
    fn high<V: Vector>(&self, which: usize, s: V, t: V) -> V {
        let Lanes4 { s: along_s, t: along_t, .. } = self.functions;
        let high = V::splat(self.ends.high[which]);
        at([high, V::splat(along_s[which]), V::splat(along_t[which])], s, t)
    }

    /// The least, by the greatest.
    #[inline(always)]
    fn low<V: Vector>(&self, which: usize, high: V) -> V {
        high.sub(V::splat(self.ends.width[which]))
    }
}

/// Vectors of a block's strata, at most: the shortest vector has eight lanes.
const MAX_STRIPS: usize = BLOCK_STRATA / 8;

/// Up to LANES strata of one size.
#[derive(Clone, Copy)]
struct Strip<V: Vector> {
    /// The middles; lanes beyond the last repeat some.
    s: V,
    t: V,
    /// Lower and upper ends, t of the pixel.
    ends: [V; 2],
    /// Bit l: there is a stratum l.
    real: u32,
}

impl<V: Vector> Strip<V> {
    /// The first `n` of the strata with these middles.
    #[inline(always)]
    fn new([s, t]: [&[f32]; 2], n: usize, half: [f32; 2]) -> Self {
        let (s, t) = (V::load(s), V::load(t));
        let half_t = V::splat(half[1]);
        Self {
            s,
            t,
            ends: [t.sub(half_t), t.add(half_t)],
            real: V::mask_bits(V::mask_all()) >> (V::LANES - n),
        }
    }

    /// Notes in a facet's record where it may be seen before `horizon`, the strata of the strip
    /// being the record's from `lane` on; moves the horizon where the facet covers a stratum.
    #[inline(always)]
    fn note(
        &self,
        facet: &Facet32,
        spans: &Spans<'_>,
        horizon: &mut V,
        lane: usize,
        record: &mut Record,
    ) {
        let Self { s, t, ends, real } = *self;
        let zero = V::splat(0.0);
        let edges = [spans.high(0, s, t), spans.high(1, s, t), spans.high(2, s, t)];
        let w_high = spans.high(3, s, t);
        let w_hi = w_high.min(V::splat(facet.w_hi));
        let least = edges[0].min(edges[1]).min(edges[2]);
        let [above, below] =
            [V::splat(facet.rows[1]).ge(ends[0]), ends[1].ge(V::splat(facet.rows[0]))];
        let touches = V::mask_and(least.ge(zero), w_hi.ge(*horizon));
        let touches = V::mask_and(touches, V::mask_and(above, below));
        let a = spans.low(0, edges[0]).gt(zero);
        let b = spans.low(1, edges[1]).gt(zero);
        let c = spans.low(2, edges[2]).gt(zero);
        let covers = V::mask_and(touches, V::mask_and(V::mask_and(a, b), c));
        let w_lo = spans.low(3, w_high);
        let nearer = V::mask_and(covers, w_lo.gt(*horizon));
        *horizon = V::select(nearer, w_lo, *horizon);
        record.strata |= (V::mask_bits(touches) & real) << lane;
        for (inside, edge) in record.inside.iter_mut().zip([a, b, c]) {
            *inside |= V::mask_bits(edge) << lane;
        }
        w_hi.write(&mut record.w_hi[lane..]);
    }

    /// Where an occluder may shadow a part of a stratum, and where it shadows all of it.
    #[inline(always)]
    fn shadow(&self, spans: &Spans<'_>) -> [u32; 2] {
        let Self { s, t, .. } = *self;
        let zero = V::splat(0.0);
        let [a, b] = [spans.high(0, s, t), spans.high(1, s, t)];
        let [c, d] = [spans.high(2, s, t), spans.high(3, s, t)];
        let touches = V::mask_bits(a.min(b).min(c.min(d)).ge(zero));
        let [a, b] = [spans.low(0, a), spans.low(1, b)];
        let [c, d] = [spans.low(2, c), spans.low(3, d)];
        [touches, V::mask_bits(a.min(b).min(c.min(d)).gt(zero))]
    }
}

/// A block's strata in vectors.
pub(super) struct Strips<V: Vector> {
    strips: [Strip<V>; MAX_STRIPS],
    n: usize,
    /// Half a stratum's width and height.
    half: [f32; 2],
    /// 1/t behind which each stratum is covered.
    horizons: [V; MAX_STRIPS],
}

impl<V: Vector> Strips<V> {
    /// Of `n_strata` with these middles, the last of which is repeated to the end.
    #[inline(always)]
    pub fn new([s, t]: &[[f32; BLOCK_STRATA]; 2], n_strata: usize, half: [f32; 2]) -> Self {
        let n = n_strata.div_ceil(V::LANES);
        // Those that are not there repeat the first; nobody asks them.
        let mut strips = [Strip::new([s, t], V::LANES.min(n_strata), half); MAX_STRIPS];
        for (at, strip) in strips.iter_mut().enumerate().take(n).skip(1) {
            let first = at * V::LANES;
            *strip = Strip::new([&s[first..], &t[first..]], V::LANES.min(n_strata - first), half);
        }
        Self { strips, n, half, horizons: [V::splat(0.0); MAX_STRIPS] }
    }

    /// Overwrites a record with where a facet may be seen, before what was noted until now; false:
    /// it is behind all of it, and so are those that come no nearer.
    #[inline(always)]
    pub fn note(&mut self, facet: &Facet32, record: &mut Record) -> bool {
        let slack = [CULL_SLACK, CULL_SLACK, CULL_SLACK, 3.0 * facet.w_slack];
        let functions = &facet.lanes;
        let spans = Spans { functions, ends: V::ends(functions, self.half, slack) };
        record.strata = 0;
        record.inside = [0; 3];
        let mut is_hidden = true;
        for at in 0..self.n {
            let horizon = &mut self.horizons[at];
            let hides = horizon.gt(V::splat(facet.w_hi));
            is_hidden &= V::mask_bits(hides) == V::mask_bits(V::mask_all());
            self.strips[at].note(facet, &spans, horizon, at * V::LANES, record);
        }
        !is_hidden
    }

    /// Takes from a record what was noted since to hide it.
    #[inline(always)]
    pub fn close(&self, record: &mut Record) {
        let mut open = 0;
        for at in 0..self.n {
            let bounds = V::load(&record.w_hi[at * V::LANES..]);
            open |= V::mask_bits(bounds.ge(self.horizons[at])) << (at * V::LANES);
        }
        record.strata &= open;
    }

    /// Says in the record of a facet in which strata it is wholly in shadow, and appends those
    /// occluders that may shadow a part of some.
    #[inline(always)]
    pub fn shade(
        &self,
        pixel: &Pixel32,
        entry: &Entry,
        occluders: &[u32],
        record: &mut Record,
        shades: &mut Vec<Shade>,
    ) {
        record.shadowed = if entry.shadowed { u32::MAX } else { 0 };
        let first = shades.len();
        let [start, end] = entry.occluders.map(|at| at as usize);
        for &occluder in &occluders[start..end] {
            let functions = &pixel.occluders[occluder as usize];
            let ends = V::ends(functions, self.half, [CULL_SLACK; 4]);
            let spans = Spans { functions, ends };
            let (mut touches, mut blocks) = (0, 0);
            for at in 0..self.n {
                let [touched, blocked] = self.strips[at].shadow(&spans);
                touches |= touched << (at * V::LANES);
                blocks |= blocked << (at * V::LANES);
            }
            record.shadowed |= blocks;
            let strata = touches & record.strata & !record.shadowed;
            if strata != 0 {
                shades.push(Shade { occluder, strata });
            }
        }
        for shade in &mut shades[first..] {
            shade.strata &= !record.shadowed;
        }
        record.shades = [first as u32, shades.len() as u32];
    }
}
