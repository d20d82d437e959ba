//! What the kernels read and write, in f32 and in the order in which they want it.

use super::kernel::first_step;
use crate::rng::Stream;
use std::ops::Range;

/// Four affine functions of the position (s, t) in the pixel, side by side: three edges and
/// the inverse depth of a facet, or the four conditions of an occluder.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Lanes4 {
    pub c: [f32; 4],
    pub s: [f32; 4],
    pub t: [f32; 4],
}

impl Lanes4 {
    /// Least and greatest values on a rectangle.
    #[inline(always)]
    pub(super) fn range(&self, centre: [f32; 2], half: [f32; 2]) -> [[f32; 4]; 2] {
        let (mut lo, mut hi) = ([0.0; 4], [0.0; 4]);
        for l in 0..4 {
            let middle = self.s[l].mul_add(centre[0], self.t[l].mul_add(centre[1], self.c[l]));
            let radius = self.s[l].abs().mul_add(half[0], self.t[l].abs() * half[1]);
            lo[l] = middle - radius;
            hi[l] = middle + radius;
        }
        [lo, hi]
    }

    /// All four at L positions.
    #[inline(always)]
    pub(super) fn at<const L: usize>(&self, s: &[f32; L], t: &[f32; L]) -> [[f32; L]; 4] {
        let mut out = [[0.0; L]; 4];
        for f in 0..4 {
            for l in 0..L {
                out[f][l] = s[l].mul_add(self.s[f], t[l].mul_add(self.t[f], self.c[f]));
            }
        }
        out
    }

    /// The last of the four at L positions.
    #[inline(always)]
    pub(super) fn inverse_depth<const L: usize>(&self, s: &[f32; L], t: &[f32; L]) -> [f32; L] {
        let mut out = [0.0; L];
        for l in 0..L {
            out[l] = s[l].mul_add(self.s[3], t[l].mul_add(self.t[3], self.c[3]));
        }
        out
    }
}

/// A facet for the kernels.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facet32 {
    /// Three edges, inside where none is negative; 1/t.
    pub lanes: Lanes4,
    /// Rounding of 1/t anywhere in the pixel.
    pub w_slack: f32,
    /// Shading coefficients; their meaning is the [`Shading`]'s.
    pub shade: [f32; 6],
    /// |l w - D|² for a point light at l.
    pub to_light: [f32; 6],
    /// The radiance is the same at every sample, but for shadows.
    pub is_flat: bool,
    /// What a flat facet gains where it is lit.
    pub flat_lit: f32,
    /// Its occluders in [`Pixel32::occluders`].
    pub occluders: Range<u32>,
}

/// How radiance depends on the sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shading {
    Polynomial,
    WideHeadlight,
    Directional,
    Point,
}

/// What the facets of a pixel share.
#[derive(Debug, Clone)]
pub(crate) struct Ground {
    pub shading: Shading,
    /// What is seen where no facet is: flat.
    pub background: Facet32,
    /// |D|² over the pixel.
    pub length_squared: [f32; 6],
}

/// A pixel for the kernels. Radiance is relative to a ground value that the caller adds again,
/// so that a smooth pixel keeps its small differences in f32.
#[derive(Debug, Clone)]
pub(crate) struct Pixel32 {
    pub facets: Vec<Facet32>,
    pub occluders: Vec<Lanes4>,
    pub ground: Ground,
}

/// A candidate facet, with a run of the work list's occluders.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Entry {
    pub facet: u32,
    pub occluders: [u32; 2],
    /// Wholly in shadow here.
    pub shadowed: bool,
}

impl Entry {
    /// Wholly lit or wholly in shadow.
    #[inline(always)]
    pub(super) fn is_settled(&self) -> bool {
        self.shadowed || self.occluders[0] == self.occluders[1]
    }
}

/// A rectangle of strata, with the list of facets of the one that it is part of.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Rect {
    pub i: [u32; 2],
    pub j: [u32; 2],
    pub entries: [u32; 2],
    pub n_occluders: u32,
}

impl Rect {
    #[inline(always)]
    pub(super) fn is_single(&self) -> bool {
        self.i[1] - self.i[0] == 1 && self.j[1] - self.j[0] == 1
    }

    /// Halves across the longer side.
    #[inline(always)]
    pub(super) fn halves(&self) -> [Self; 2] {
        let (width, height) = (self.i[1] - self.i[0], self.j[1] - self.j[0]);
        if width > height {
            let middle = self.i[0] + width / 2;
            [Self { i: [self.i[0], middle], ..*self }, Self { i: [middle, self.i[1]], ..*self }]
        } else {
            let middle = self.j[0] + height / 2;
            [Self { j: [self.j[0], middle], ..*self }, Self { j: [middle, self.j[1]], ..*self }]
        }
    }
}

/// A grid of strata over the pixel.
#[derive(Debug, Clone)]
pub(crate) struct Strata {
    pub per_axis: [u32; 2],
    /// Width of a stratum over 2^24.
    pub(super) step: [f32; 2],
    /// Lower ends of the strata along each axis, about the pixel's centre; one more at the end.
    bounds: [Vec<f32>; 2],
}

impl Strata {
    pub fn new(per_axis: [u32; 2]) -> Self {
        let bounds =
            per_axis.map(|k| (0..=k).map(|i| (f64::from(i) / f64::from(k) - 0.5) as f32).collect());
        let step = per_axis.map(|k| ((1.0 / f64::from(k)) * 2f64.powi(-24)) as f32);
        Self { per_axis, step, bounds }
    }

    #[inline(always)]
    pub(super) fn index(&self, i: u32, j: u32) -> u32 {
        j * self.per_axis[0] + i
    }

    #[inline(always)]
    pub(super) fn origin(&self, i: u32, j: u32) -> [f32; 2] {
        [self.bounds[0][i as usize], self.bounds[1][j as usize]]
    }

    #[inline(always)]
    pub(super) fn centre_and_half(&self, rect: &Rect) -> ([f32; 2], [f32; 2]) {
        let (mut centre, mut half) = ([0.0; 2], [0.0; 2]);
        for (axis, ends) in [rect.i, rect.j].into_iter().enumerate() {
            let lo = self.bounds[axis][ends[0] as usize];
            let hi = self.bounds[axis][ends[1] as usize];
            centre[axis] = 0.5 * (lo + hi);
            half[axis] = 0.5 * (hi - lo);
        }
        (centre, half)
    }
}

/// L trials: what each draws from, and the sum of its values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrialStreams<const L: usize> {
    pub(super) y: [u32; L],
    pub(super) z: [u32; L],
    pub(super) yz: [u32; L],
    pub(super) sum: [f64; L],
}

impl<const L: usize> TrialStreams<L> {
    /// Of up to L streams; further lanes draw from a stream that nobody reads.
    pub(super) fn new(streams: &[Stream]) -> Self {
        let (mut y, mut z, mut yz) = ([1; L], [1; L], [1; L]);
        for (l, stream) in streams.iter().enumerate() {
            y[l] = first_step(stream.words[0]);
            z[l] = first_step(stream.words[1]);
            yz[l] = y[l].wrapping_mul(z[l]);
        }
        Self { y, z, yz, sum: [0.0; L] }
    }
}

/// Settles a doubtful sample at (s, t) in f64, among the listed facets.
pub(crate) type Exact<'a> = &'a dyn Fn(&[Entry], f64, f64) -> f64;

/// Lists that the kernels keep while they work.
pub(crate) struct Work<'a> {
    pub(super) entries: Vec<Entry>,
    pub(super) occluders: Vec<u32>,
    pub(super) stack: Vec<Rect>,
    pub(super) exact: Exact<'a>,
}

impl<'a> Work<'a> {
    pub fn new(exact: Exact<'a>) -> Self {
        Self { entries: Vec::new(), occluders: Vec::new(), stack: Vec::new(), exact }
    }
}
