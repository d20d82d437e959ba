//! What the kernels read and write, in f32 and in the order in which they want it.

use super::columns::Columns;
use super::dissect::Piece;
use super::draw::MAX_SPREAD;
use super::raster::Tile;
use super::shader::Shader;
use super::vector::{Extent, MAX_LANES, Vector};
use super::visible::{Candidate, Shadow};
use std::ops::Range;

/// Four affine functions of the position (s, t) in the pixel, side by side: three edges and
/// the inverse depth of a facet, or the four conditions of an occluder.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Lanes4 {
    pub c: [f32; 4],
    pub s: [f32; 4],
    pub t: [f32; 4],
}

/// A facet for the kernels.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facet32 {
    /// Three edges, inside where none is negative; 1/t in a unit that the pixel chooses.
    pub lanes: Lanes4,
    /// What is added to 1/t of a steep facet.
    pub w_bias: f32,
    /// Rounding of 1/t anywhere in the pixel, twice that of a steep facet.
    pub w_slack: f32,
    /// Its 1/t rounds by more than others do: where it is seen among others, or might be, f64
    /// decides.
    pub is_steep: bool,
    /// No sample that its edges leave in doubt is given a 1/t as great as this, nor by any later
    /// facet: it falls from facet to facet.
    pub w_hi: f32,
    /// Reaches from row to row, t of the pixel, at the most.
    pub rows: [f32; 2],
    /// Radiance as a polynomial c, s, t, ss, st, tt; under other shaders than the polynomial
    /// one only c counts, the part that needs no light.
    pub shade: [f32; 6],
    /// What the light adds: an affine cosine, or a factor alone; of a headlight through a narrow
    /// pixel, the factor that takes 1/t over |D| to the radiance.
    pub shade_gain: [f32; 3],
    /// |l w - D|² for a point light at l.
    pub to_light: [f32; 6],
    /// The radiance is the same at every sample, but for shadows.
    pub is_flat: bool,
    /// Its occluders in [`Pixel32::occluders`].
    pub occluders: Range<u32>,
}

impl Facet32 {
    /// The value of a facet that is flat, or in shadow.
    #[inline(always)]
    pub(super) fn flat_value(&self, lit: bool) -> f32 {
        self.shade[0] + if lit && self.is_flat { self.shade_gain[0] } else { 0.0 }
    }
}

/// How radiance depends on the sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shading {
    Headlight,
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
    /// What radiances are relative to.
    pub value: f32,
    /// |D|² over the pixel, and 1/|D| to the second order.
    pub length_squared: [f32; 6],
    pub inverse_length: [f32; 6],
}

/// A pixel for the kernels. Radiance is relative to a ground value that the caller adds again,
/// so that a smooth pixel keeps its small differences in f32.
#[derive(Debug, Clone)]
pub(crate) struct Pixel32 {
    pub facets: Vec<Facet32>,
    /// Of all facets.
    pub columns: Vec<Columns>,
    pub occluders: Vec<Lanes4>,
    pub ground: Ground,
}

impl Pixel32 {
    /// A facet, or the background.
    #[inline(always)]
    pub(super) fn facet(&self, facet: Option<u32>) -> &Facet32 {
        facet.map_or(&self.ground.background, |id| &self.facets[id as usize])
    }
}

/// A candidate facet, with a run of the work list's occluders.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Entry {
    pub facet: u32,
    pub occluders: [u32; 2],
    /// Wholly in shadow here.
    pub shadowed: bool,
    /// Bit e: a part of the rectangle may lie outside of edge e.
    pub(super) edges: u8,
    /// No nearer than this anywhere in the rectangle; in a stratum's list, neither it nor any later
    /// entry.
    pub(super) w_hi: f32,
}

impl Entry {
    /// The facet where it is seen in the rectangle, with a run of `occluders` if `S` has shadows.
    #[inline(always)]
    pub(super) fn candidate<'a, S: Shader>(
        &self,
        occluders: &'a [u32],
    ) -> Candidate<impl Iterator<Item = u32> + Clone + 'a> {
        let Self { facet, w_hi, shadowed, edges, occluders: [start, end] } = *self;
        let run = if S::SHADOWS { start as usize..end as usize } else { 0..0 };
        let occluders = occluders[run].iter().copied();
        Candidate { facet, w_hi, edges, shadow: Shadow { is_whole: shadowed, occluders } }
    }

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
    pub(super) fn n_strata(&self) -> usize {
        (self.i[1] - self.i[0]) as usize * (self.j[1] - self.j[0]) as usize
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
#[derive(Debug, Clone, Default)]
pub(crate) struct Strata {
    pub per_axis: [u32; 2],
    /// Width of a stratum over 2^24.
    pub(super) step: [f32; 2],
    /// Lower ends of the strata along each axis, about the pixel's centre; one more at the end.
    bounds: [Vec<f32>; 2],
    /// The bounds along s, once each and twice each, with room for a vector to be read anywhere.
    repeated: [Vec<f32>; MAX_SPREAD],
}

impl Strata {
    pub fn new(per_axis: [u32; 2]) -> Self {
        let mut strata = Self::default();
        strata.set(per_axis);
        strata
    }

    /// Becomes the grid of so many strata.
    pub fn set(&mut self, per_axis: [u32; 2]) {
        self.per_axis = per_axis;
        self.step = per_axis.map(|k| ((1.0 / f64::from(k)) * 2f64.powi(-24)) as f32);
        for (bounds, k) in self.bounds.iter_mut().zip(per_axis) {
            bounds.clear();
            bounds.extend((0..=k).map(|i| (f64::from(i) / f64::from(k) - 0.5) as f32));
        }
        for (repeated, times) in self.repeated.iter_mut().zip(1..) {
            repeated.clear();
            for &bound in &self.bounds[0] {
                repeated.resize(repeated.len() + times, bound);
            }
            repeated.resize(repeated.len() + MAX_LANES, 0.5);
        }
    }

    #[inline(always)]
    pub(super) fn index(&self, i: u32, j: u32) -> u32 {
        j * self.per_axis[0] + i
    }

    #[inline(always)]
    pub(super) fn origin(&self, i: u32, j: u32) -> [f32; 2] {
        [self.bounds[0][i as usize], self.bounds[1][j as usize]]
    }

    /// Lower ends along s of the strata from i on, each T times; beyond the last they mean nothing.
    #[inline(always)]
    pub(super) fn origins<V: Vector, const T: usize>(&self, i: u32) -> V {
        V::load(&self.repeated[T - 1][i as usize * T..])
    }

    /// The middle of a stratum.
    #[inline(always)]
    pub(super) fn middle(&self, i: u32, j: u32) -> [f32; 2] {
        let middle = |axis: usize, at: u32| {
            0.5 * (self.bounds[axis][at as usize] + self.bounds[axis][at as usize + 1])
        };
        [middle(0, i), middle(1, j)]
    }

    /// Half the width and height of a stratum.
    #[inline(always)]
    pub(super) fn half(&self) -> [f32; 2] {
        self.per_axis.map(|k| 0.5 / k as f32)
    }

    #[inline(always)]
    pub(super) fn extent(&self, rect: &Rect) -> Extent {
        let ends = |axis: usize, ends: [u32; 2]| ends.map(|end| self.bounds[axis][end as usize]);
        let ([i0, i1], [j0, j1]) = (ends(0, rect.i), ends(1, rect.j));
        Extent {
            middle: [0.5 * (i0 + i1), 0.5 * (j0 + j1)],
            half: [0.5 * (i1 - i0), 0.5 * (j1 - j0)],
        }
    }
}

/// Settles a doubtful sample at (s, t) in f64, among the listed facets.
pub(crate) type Exact<'a> = &'a dyn Fn(&mut dyn Iterator<Item = u32>, f64, f64) -> f64;

/// Lists that the kernels keep while they work.
#[derive(Default)]
pub(crate) struct Work {
    pub(super) entries: Vec<Entry>,
    pub(super) occluders: Vec<u32>,
    pub(super) stack: Vec<Rect>,
    /// Of the tile's facets, unless they are all of the pixel's.
    pub(super) columns: Vec<Columns>,
    /// Places in the tile's list.
    pub(super) near: Vec<u32>,
    pub(super) records: Vec<Record>,
    pub(super) shades: Vec<Shade>,
    pub(super) tile: Option<Tile>,
    /// Facets from which on a tile is crowded, and such a tile.
    pub(super) crowd: usize,
    pub(super) crowded: Option<Tile>,
    /// The lists of the pieces' strata, and their occluders.
    pub(super) list: Vec<Entry>,
    pub(super) list_occluders: Vec<u32>,
    pub(super) pieces: Vec<Piece>,
}

/// Strata of a block at most: a bit for each in a word. Blocks are the same under every instruction
/// set, so that all cut alike.
pub(super) const BLOCK_STRATA: usize = 32;

/// Where a facet meets a block of strata.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Record {
    pub facet: u32,
    /// Bit l: it may be seen in stratum l.
    pub strata: u32,
    /// By edge, bit l: stratum l lies inside.
    pub inside: [u32; 3],
    /// Bit l: it is wholly in shadow in stratum l.
    pub shadowed: u32,
    /// What may shadow a part of it, a run of [`Work::shades`].
    pub shades: [u32; 2],
    /// Greatest 1/t in each stratum.
    pub w_hi: [f32; BLOCK_STRATA],
}

impl Record {
    /// Bit e: a part of stratum l may lie outside of edge e.
    #[inline(always)]
    pub fn edges(&self, l: u32) -> u8 {
        let [a, b, c] = self.inside.map(|strata| !(strata >> l) & 1);
        (a | b << 1 | c << 2) as u8
    }

    /// What shadow lies on the facet in stratum l.
    #[inline(always)]
    pub fn shadow<'a>(
        &self,
        l: u32,
        shades: &'a [Shade],
    ) -> Shadow<impl Iterator<Item = u32> + Clone + 'a> {
        let [start, end] = self.shades.map(|at| at as usize);
        let here = shades[start..end].iter().filter(move |shade| shade.strata >> l & 1 != 0);
        let is_whole = self.shadowed >> l & 1 != 0;
        Shadow { is_whole, occluders: here.map(|shade| shade.occluder) }
    }
}

/// An occluder, and the strata of a block in which it may shadow a part of a facet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shade {
    pub occluder: u32,
    pub strata: u32,
}
