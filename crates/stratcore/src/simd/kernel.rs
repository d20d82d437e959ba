//! The loops over samples, written once for any vector.
//!
//! A lane is a trial: the same stratum of neighbouring trials meets the same few facets, so one
//! short list serves all lanes. [`super`] compiles these functions for each instruction set;
//! they must stay `inline(always)` to be compiled with it. Operations come in the same order for
//! every vector, so all paths give the same bits.

use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::{Cells, Entry, Facet32, Ground, Lanes4, Pixel32, Rect, Strata, Work};
use crate::rng::Stream;
use std::marker::PhantomData;

/// A sample's inside test or depth comparison closer than this, in f32 units of functions whose
/// largest coefficient is 1, is settled again in f64. Rounding of three coefficients and two
/// fused steps is below 2.4e-7.
pub(super) const DOUBT: f32 = 4e-7;
/// Samples added in f32 before the sum moves to f64: few enough to lose nothing.
const RUN: u32 = 16;

/// How a facet's radiance depends on the sample; chosen once per pixel.
pub(super) trait Shader {
    /// Whether shadows exist under this shader.
    const SHADOWS: bool;
    /// Radiance at samples (s, t) with inverse depth `w`, relative to the pixel's ground value.
    fn shade<V: Vector>(ground: &Ground, facet: &Facet32, s: V, t: V, w: V, lit: V::Mask) -> V;
}

/// A polynomial of second order: exact to rounding for a narrow pixel under a headlight, for
/// emission and for the background.
pub(super) struct Polynomial;

impl Shader for Polynomial {
    const SHADOWS: bool = false;
    #[inline(always)]
    fn shade<V: Vector>(_: &Ground, facet: &Facet32, s: V, t: V, _: V, _: V::Mask) -> V {
        quadratic(&facet.shade, s, t)
    }
}

/// A headlight seen through a wide pixel: albedo (n·D) / |D|.
pub(super) struct WideHeadlight;

impl Shader for WideHeadlight {
    const SHADOWS: bool = false;
    #[inline(always)]
    fn shade<V: Vector>(ground: &Ground, facet: &Facet32, s: V, t: V, _: V, _: V::Mask) -> V {
        let [c, along_s, along_t, ..] = facet.shade_gain;
        let cosine = s.mul_add(V::splat(along_s), t.mul_add(V::splat(along_t), V::splat(c)));
        let length = quadratic(&ground.length_squared, s, t).sqrt();
        cosine.div(length).add(V::splat(facet.shade[0]))
    }
}

/// A directional light: what is lit adds a constant.
pub(super) struct Directional;

impl Shader for Directional {
    const SHADOWS: bool = true;
    #[inline(always)]
    fn shade<V: Vector>(_: &Ground, facet: &Facet32, _: V, _: V, _: V, lit: V::Mask) -> V {
        let base = facet.shade[0];
        V::select(lit, V::splat(base + facet.shade_gain[0]), V::splat(base))
    }
}

/// A point light: what is lit adds albedo h w³ / |l w - D|³, h the light's height over the
/// facet's plane.
pub(super) struct Point;

impl Shader for Point {
    const SHADOWS: bool = true;
    #[inline(always)]
    fn shade<V: Vector>(_: &Ground, facet: &Facet32, s: V, t: V, w: V, lit: V::Mask) -> V {
        let ratio = w.div(quadratic(&facet.to_light, s, t).sqrt());
        let cube = ratio.mul(ratio).mul(ratio);
        let base = V::splat(facet.shade[0]);
        V::select(lit, cube.mul_add(V::splat(facet.shade_gain[0]), base), base)
    }
}

#[inline(always)]
fn quadratic<V: Vector>(q: &[f32; 6], s: V, t: V) -> V {
    let [c, qs, qt, qss, qst, qtt] = q.map(V::splat);
    let along_s = s.mul_add(qss, t.mul_add(qst, qs));
    let along_t = t.mul_add(qtt, qt);
    s.mul_add(along_s, t.mul_add(along_t, c))
}

#[inline(always)]
fn affine<V: Vector>(functions: &Lanes4, which: usize, s: V, t: V) -> V {
    let [c, along_s, along_t] =
        [functions.c[which], functions.s[which], functions.t[which]].map(V::splat);
    s.mul_add(along_s, t.mul_add(along_t, c))
}

#[inline(always)]
fn least_of_three<V: Vector>(functions: &Lanes4, s: V, t: V) -> V {
    affine(functions, 0, s, t).min(affine(functions, 1, s, t)).min(affine(functions, 2, s, t))
}

/// LANES trials: what each draws from, and the sum of its values.
#[derive(Clone, Copy)]
pub(super) struct Group<V: Vector> {
    y: V::Int,
    z: V::Int,
    yz: V::Int,
    pub(super) sum: V::Sum,
}

impl<V: Vector> Group<V> {
    /// Of up to LANES streams; further lanes draw from a stream that nobody reads.
    #[inline(always)]
    pub(super) fn new(streams: &[Stream]) -> Self {
        let (mut y, mut z) = ([1; MAX_LANES], [1; MAX_LANES]);
        for (l, stream) in streams.iter().enumerate() {
            y[l] = first_step(stream.words[0]);
            z[l] = first_step(stream.words[1]);
        }
        let (y, z) = (V::int_load(&y), V::int_load(&z));
        Self { y, z, yz: V::int_mul(y, z), sum: V::sum_zero() }
    }

    /// One sample per trial in the stratum `index`: its position about the pixel's centre, from
    /// the upper 24 bits of the first two words of [`pcg3d`](crate::rng::pcg3d).
    #[inline(always)]
    fn sample(&self, index: u32, step: [f32; 2], origin: [f32; 2]) -> [V; 2] {
        let x = V::int_add(V::int_splat(first_step(index)), self.yz);
        let y = V::int_add(self.y, V::int_mul(self.z, x));
        let z = V::int_add(self.z, V::int_mul(x, y));
        let [x, y, z] = [x, y, z].map(V::int_xorshift16);
        let x = V::int_add(x, V::int_mul(y, z));
        let y = V::int_add(y, V::int_mul(z, x));
        let place = |word, axis: usize| {
            V::upper24(word).mul_add(V::splat(step[axis]), V::splat(origin[axis]))
        };
        [place(x, 0), place(y, 1)]
    }
}

/// pcg3d's first step, an LCG, on one word.
#[inline(always)]
fn first_step(word: u32) -> u32 {
    word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223)
}

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
    fn visit(&mut self, pixel: &Pixel32, strata: &Strata, rect: &Rect, fill: Fill<'_>);
}

/// Cuts the pixel into rectangles of strata and shows `visitor` what fills each.
///
/// Rectangles are halved, and the list of facets filtered for each half, until one facet covers
/// the rectangle or it is a single stratum.
#[inline(always)]
pub(super) fn dissect<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    work: &mut Work,
    visitor: &mut impl Visit,
) {
    let Work { entries, occluders, stack } = work;
    entries.clear();
    occluders.clear();
    stack.clear();
    for (facet, data) in (0..).zip(&pixel.facets) {
        let first = occluders.len() as u32;
        occluders.extend(data.occluders.clone());
        let occluders = [first, occluders.len() as u32];
        entries.push(Entry { facet, occluders, ..Entry::default() });
    }
    stack.push(Rect {
        i: [0, strata.per_axis[0]],
        j: [0, strata.per_axis[1]],
        entries: [0, entries.len() as u32],
        n_occluders: occluders.len() as u32,
    });
    while let Some(rect) = stack.pop() {
        entries.truncate(rect.entries[1] as usize);
        occluders.truncate(rect.n_occluders as usize);
        let first = entries.len();
        let covered = filter::<S, V>(pixel, strata, &rect, entries, occluders);
        let list = &entries[first..];
        match list {
            [] => visitor.visit(pixel, strata, &rect, Fill::Uniform { facet: None, lit: true }),
            [only] if covered && (!S::SHADOWS || only.is_settled()) => {
                let fill = Fill::Uniform { facet: Some(only.facet), lit: !only.shadowed };
                visitor.visit(pixel, strata, &rect, fill);
            }
            _ if rect.is_single() => {
                visitor.visit(pixel, strata, &rect, Fill::Mixed { list, occluders });
            }
            _ => {
                let entries = [first as u32, entries.len() as u32];
                let n_occluders = occluders.len() as u32;
                let [a, b] = rect.halves();
                stack.push(Rect { entries, n_occluders, ..b });
                stack.push(Rect { entries, n_occluders, ..a });
            }
        }
    }
}

/// Adds to each trial's sum the values of its samples in all strata: one sample per stratum.
#[inline(always)]
pub(super) fn strata_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    groups: &mut [Group<V>],
    work: &mut Work,
    exact: Exact<'_>,
) {
    let mut sums = StrataSums::<S, V> { groups, exact, shader: PhantomData };
    dissect::<S, V>(pixel, strata, work, &mut sums);
}

struct StrataSums<'a, S, V: Vector> {
    groups: &'a mut [Group<V>],
    exact: Exact<'a>,
    shader: PhantomData<S>,
}

impl<S: Shader, V: Vector> Visit for StrataSums<'_, S, V> {
    #[inline(always)]
    fn visit(&mut self, pixel: &Pixel32, strata: &Strata, rect: &Rect, fill: Fill<'_>) {
        match fill {
            Fill::Uniform { facet, lit } => {
                let facet = pixel.facet(facet);
                fill_rect::<S, V>(pixel, strata, rect, facet, lit, self.groups);
            }
            Fill::Mixed { list, occluders } => {
                let (groups, exact) = (&mut *self.groups, self.exact);
                sample_stratum::<S, V>(pixel, strata, rect, list, occluders, groups, exact);
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

/// One facet, or the background, fills the rectangle.
#[inline(always)]
fn fill_rect<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Rect,
    facet: &Facet32,
    lit: bool,
    groups: &mut [Group<V>],
) {
    if facet.is_flat || (S::SHADOWS && !lit) {
        let sum = f64::from(facet.flat_value(lit))
            * f64::from((rect.i[1] - rect.i[0]) * (rect.j[1] - rect.j[0]));
        if sum != 0.0 {
            for group in groups {
                group.sum = V::sum_add_all(group.sum, sum);
            }
        }
        return;
    }
    for group in groups {
        let mut sum = group.sum;
        for j in rect.j[0]..rect.j[1] {
            let mut i = rect.i[0];
            while i < rect.i[1] {
                let end = rect.i[1].min(i + RUN);
                let mut run = V::splat(0.0);
                while i < end {
                    let origin = strata.origin(i, j);
                    let [s, t] = group.sample(strata.index(i, j), strata.step, origin);
                    let w = affine(&facet.lanes, 3, s, t);
                    run = run.add(S::shade(&pixel.ground, facet, s, t, w, V::mask_all()));
                    i += 1;
                }
                sum = V::sum_add(sum, run);
            }
        }
        group.sum = sum;
    }
}

/// One stratum with several candidates: the nearest facet hit gives the value.
#[inline(always)]
fn sample_stratum<S: Shader, V: Vector>(
    pixel: &Pixel32,
    strata: &Strata,
    rect: &Rect,
    list: &[Entry],
    occluders: &[u32],
    groups: &mut [Group<V>],
    exact: Exact<'_>,
) {
    let (i, j) = (rect.i[0], rect.j[0]);
    for group in groups {
        let [s, t] = group.sample(strata.index(i, j), strata.step, strata.origin(i, j));
        let value = visible::<S, V>(pixel, list, occluders, s, t, exact);
        group.sum = V::sum_add(group.sum, value);
    }
}

/// Values of samples that lie anywhere where `list` is complete.
#[inline(always)]
pub(super) fn visible<S: Shader, V: Vector>(
    pixel: &Pixel32,
    list: &[Entry],
    occluders: &[u32],
    s: V,
    t: V,
    exact: Exact<'_>,
) -> V {
    let zero = V::splat(0.0);
    let limit = V::splat(DOUBT);
    let mut value = V::splat(pixel.ground.background.shade[0]);
    let mut nearest = zero;
    let mut nearest_slack = zero;
    let mut doubt = V::mask_none();
    for entry in list {
        let facet = &pixel.facets[entry.facet as usize];
        let margin = least_of_three(&facet.lanes, s, t);
        let w = affine(&facet.lanes, 3, s, t);
        let mut lit = V::mask_all();
        if S::SHADOWS {
            if entry.shadowed {
                lit = V::mask_none();
            }
            for &id in &occluders[entry.occluders[0] as usize..entry.occluders[1] as usize] {
                let occluder = &pixel.occluders[id as usize];
                let margin = least_of_three(occluder, s, t).min(affine(occluder, 3, s, t));
                lit = V::mask_without(lit, margin.ge(zero));
                doubt = V::mask_or(doubt, margin.abs().le(limit));
            }
        }
        let shade = S::shade(&pixel.ground, facet, s, t, w, lit);
        let inside = margin.ge(zero);
        let gap = w.sub(nearest);
        let slack = V::splat(facet.w_slack);
        let tied = V::mask_and(inside, gap.abs().le(slack.add(nearest_slack)));
        let wins = V::mask_and(inside, gap.gt(zero));
        doubt = V::mask_or(doubt, V::mask_or(margin.abs().le(limit), tied));
        value = V::select(wins, shade, value);
        nearest = V::select(wins, w, nearest);
        nearest_slack = V::select(wins, slack, nearest_slack);
    }
    if V::mask_bits(doubt) != 0 {
        value = settle(V::mask_bits(doubt), list, value, s, t, exact);
    }
    value
}

/// The dissection of the pixel into a fixed grid, for samples that may lie anywhere.
#[inline(always)]
pub(super) fn cells<S: Shader, V: Vector>(pixel: &Pixel32, per_axis: u32) -> Cells {
    let strata = Strata::new([per_axis; 2]);
    let mut cells = Cells::new(per_axis);
    dissect::<S, V>(pixel, &strata, &mut Work::default(), &mut cells);
    cells
}

impl Visit for Cells {
    #[inline(always)]
    fn visit(&mut self, _: &Pixel32, strata: &Strata, rect: &Rect, fill: Fill<'_>) {
        for j in rect.j[0]..rect.j[1] {
            for i in rect.i[0]..rect.i[1] {
                self.set(strata.index(i, j), &fill);
            }
        }
    }
}

/// Values of samples within one cell.
#[inline(always)]
fn in_cell<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    cell: u32,
    s: V,
    t: V,
    exact: Exact<'_>,
) -> V {
    match cells.fill(cell) {
        Fill::Uniform { facet, lit } => {
            let facet = pixel.facet(facet);
            if facet.is_flat || (S::SHADOWS && !lit) {
                return V::splat(facet.flat_value(lit));
            }
            let w = affine(&facet.lanes, 3, s, t);
            S::shade(&pixel.ground, facet, s, t, w, V::mask_all())
        }
        Fill::Mixed { list, occluders } => visible::<S, V>(pixel, list, occluders, s, t, exact),
    }
}

/// Overwrites `values` with those at positions (s, t) about the pixel's centre, in any order.
/// Samples are sorted by cell first, so that a vector of them shares one list; `order` is room
/// for that.
#[inline(always)]
pub(super) fn values_at<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    positions: [&[f32]; 2],
    values: &mut [f32],
    order: &mut [u32],
    exact: Exact<'_>,
) {
    let [s, t] = positions;
    let order = &mut order[..values.len()];
    let ends = cells.sort(s, t, order);
    let mut start = 0;
    for (cell, end) in (0..).zip(ends) {
        for lanes in order[start as usize..end as usize].chunks(V::LANES) {
            let (mut ls, mut lt) = ([0.0; MAX_LANES], [0.0; MAX_LANES]);
            for (l, &at) in lanes.iter().enumerate() {
                ls[l] = s[at as usize];
                lt[l] = t[at as usize];
            }
            // Idle lanes repeat the first sample: it is certainly in the cell.
            for l in lanes.len()..V::LANES {
                ls[l] = ls[0];
                lt[l] = lt[0];
            }
            let found =
                in_cell::<S, V>(pixel, cells, cell, V::load(&ls), V::load(&lt), exact).store();
            for (l, &at) in lanes.iter().enumerate() {
                values[at as usize] = found[l];
            }
        }
        start = end;
    }
}

/// Adds to each trial's sum the values of its samples at `n` positions of `place`, which may lie
/// anywhere.
#[inline(always)]
pub(super) fn scattered_sums<S: Shader, V: Vector>(
    pixel: &Pixel32,
    cells: &Cells,
    placement: &Placement<'_>,
    groups: &mut [Group<V>],
    n_trials: usize,
    exact: Exact<'_>,
) {
    /// Samples that are sorted together.
    const ROUND: usize = 1 << 14;
    let n = placement.len();
    if cells.is_single() {
        for group in groups {
            for index in 0..n {
                let [s, t] = placement.sample(group, index);
                let value = in_cell::<S, V>(pixel, cells, 0, s, t, exact);
                group.sum = V::sum_add(group.sum, value);
            }
        }
        return;
    }
    let capacity = ROUND.min(n as usize * V::LANES);
    let [mut s, mut t, mut values] =
        [vec![0.0; capacity], vec![0.0; capacity], vec![0.0; capacity + V::LANES]];
    let mut order = vec![0; capacity];
    for (first_trial, group) in (0..n_trials).step_by(V::LANES).zip(groups) {
        // Lanes without a trial are not evaluated.
        let lanes = V::LANES.min(n_trials - first_trial);
        let per_round = (capacity / lanes) as u32;
        let mut index = 0;
        while index < n {
            let end = n.min(index + per_round);
            let len = (end - index) as usize * lanes;
            for (at, index) in (0..len).step_by(lanes).zip(index..end) {
                let [ps, pt] = placement.sample(group, index);
                s[at..at + lanes].copy_from_slice(&ps.store()[..lanes]);
                t[at..at + lanes].copy_from_slice(&pt.store()[..lanes]);
            }
            let positions = [&s[..len], &t[..len]];
            values_at::<S, V>(pixel, cells, positions, &mut values[..len], &mut order, exact);
            for at in (0..len).step_by(lanes) {
                group.sum = V::sum_add(group.sum, V::load(&values[at..at + V::LANES]));
            }
            index = end;
        }
    }
}

/// Where the samples of a trial lie.
pub(crate) enum Placement<'a> {
    /// This many, anywhere in the pixel.
    Anywhere(u32),
    /// One in each stratum.
    Strata(&'a Strata),
}

impl Placement<'_> {
    #[inline(always)]
    fn len(&self) -> u32 {
        match self {
            Self::Anywhere(n) => *n,
            Self::Strata(strata) => strata.per_axis[0] * strata.per_axis[1],
        }
    }

    #[inline(always)]
    fn sample<V: Vector>(&self, group: &Group<V>, index: u32) -> [V; 2] {
        match self {
            Self::Anywhere(_) => group.sample(index, [1.0 / (1 << 24) as f32; 2], [-0.5; 2]),
            Self::Strata(strata) => {
                let [i, j] = [index % strata.per_axis[0], index / strata.per_axis[0]];
                group.sample(index, strata.step, strata.origin(i, j))
            }
        }
    }
}

/// Puts the f64 answer in place of each doubtful lane's.
#[cold]
#[inline(never)]
fn settle_values(
    mut lanes: u32,
    list: &[Entry],
    values: &mut [f32; MAX_LANES],
    s: &[f32; MAX_LANES],
    t: &[f32; MAX_LANES],
    exact: Exact<'_>,
) {
    while lanes != 0 {
        let l = lanes.trailing_zeros() as usize;
        values[l] = exact(list, f64::from(s[l]), f64::from(t[l])) as f32;
        lanes &= lanes - 1;
    }
}

#[inline(always)]
fn settle<V: Vector>(lanes: u32, list: &[Entry], value: V, s: V, t: V, exact: Exact<'_>) -> V {
    let mut values = value.store();
    settle_values(lanes, list, &mut values, &s.store(), &t.store(), exact);
    V::load(&values)
}
