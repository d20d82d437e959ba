//! Edges and bounds of facets side by side, so that a rectangle or a horizon is compared with a
//! vector of them at once.

use super::Facet32;
use super::vector::{CULL_SLACK, Extent, MAX_LANES, Vector};

/// Writes the places of the bits that are set, of [`MAX_LANES`] from `first` on, and gives how many
/// there are. `out` has as many places, of which any may be overwritten.
#[inline(always)]
pub(super) fn places(bits: u32, first: u32, out: &mut [u32]) -> usize {
    let mut len = 0;
    // Eight at once, without a branch: any of them may be set.
    for (byte, at) in bits.to_le_bytes()[..MAX_LANES / 8].iter().zip((first..).step_by(8)) {
        for (out, l) in out[len..len + 8].iter_mut().zip(PLACES[usize::from(*byte)]) {
            *out = at + u32::from(l);
        }
        len += byte.count_ones() as usize;
    }
    len
}

/// The places of the bits that are set in a byte.
static PLACES: [[u8; 8]; 256] = {
    let mut places = [[0; 8]; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut n, mut l) = (0, 0);
        while l < 8 {
            if byte >> l & 1 != 0 {
                places[byte][n] = l;
                n += 1;
            }
            l += 1;
        }
        byte += 1;
    }
    places
};

/// Edges and bounds of a few facets.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    /// By edge: c, s and t.
    edges: [[[f32; MAX_LANES]; 3]; 3],
    /// Reaches from row to row.
    rows: [[f32; MAX_LANES]; 2],
    /// Neither it nor any later one is nearer than this.
    w_hi: [f32; MAX_LANES],
}

impl Columns {
    /// Facets side by side, at most.
    pub const LEN: usize = MAX_LANES;

    /// Those of the first facets; where there are fewer, no rectangle meets what is left.
    #[inline(always)]
    pub fn of<'a>(facets: impl Iterator<Item = &'a Facet32>) -> Self {
        let mut columns = Self {
            edges: [[[f32::NEG_INFINITY; MAX_LANES], [0.0; MAX_LANES], [0.0; MAX_LANES]]; 3],
            rows: [[f32::INFINITY; MAX_LANES], [f32::NEG_INFINITY; MAX_LANES]],
            w_hi: [f32::NEG_INFINITY; MAX_LANES],
        };
        for (l, facet) in facets.take(Self::LEN).enumerate() {
            let functions = &facet.lanes;
            for (which, [c, s, t]) in columns.edges.iter_mut().enumerate() {
                (c[l], s[l], t[l]) = (functions.c[which], functions.s[which], functions.t[which]);
            }
            [columns.rows[0][l], columns.rows[1][l]] = facet.rows;
            columns.w_hi[l] = facet.w_hi;
        }
        columns
    }

    /// Bit l: facet l may touch a rectangle, of the LANES from `from` on.
    #[inline(always)]
    fn touch<V: Vector>(&self, rect: &Extent, from: usize) -> u32 {
        let ([s, t], [half_s, half_t]) = (rect.middle, rect.half);
        let ends = [V::splat(t - half_t), V::splat(t + half_t)];
        let [s, t, half_s, half_t] = [V::splat(s), V::splat(t), V::splat(half_s), V::splat(half_t)];
        let mut least = V::splat(f32::INFINITY);
        for [c, along_s, along_t] in &self.edges {
            let (along_s, along_t) = (V::load(&along_s[from..]), V::load(&along_t[from..]));
            let middle = s.mul_add(along_s, t.mul_add(along_t, V::load(&c[from..])));
            let radius = half_s.mul_add(along_s.abs(), half_t.mul(along_t.abs()));
            least = middle.add(radius).min(least);
        }
        let touches = least.ge(V::splat(-CULL_SLACK));
        let above = V::load(&self.rows[1][from..]).ge(ends[0]);
        let below = ends[1].ge(V::load(&self.rows[0][from..]));
        V::mask_bits(V::mask_and(touches, V::mask_and(above, below)))
    }

    /// Bit l: facet l may touch a rectangle.
    #[inline(always)]
    pub(super) fn touching<V: Vector>(&self, rect: &Extent) -> u32 {
        let mut bits = 0;
        for from in (0..MAX_LANES).step_by(V::LANES) {
            bits |= self.touch::<V>(rect, from) << from;
        }
        bits
    }

    /// Bit l: facet l or a later one may come nearer than a horizon.
    #[inline(always)]
    pub(super) fn before<V: Vector>(&self, horizon: f32) -> u32 {
        let mut bits = 0;
        for from in (0..MAX_LANES).step_by(V::LANES) {
            bits |= V::mask_bits(V::load(&self.w_hi[from..]).ge(V::splat(horizon))) << from;
        }
        bits
    }

    /// Overwrites `near` with the places of the facets that may touch a rectangle, in their order.
    #[inline(always)]
    pub(super) fn sieve<V: Vector>(columns: &[Self], rect: &Extent, near: &mut Vec<u32>) {
        near.resize(columns.len() * MAX_LANES, 0);
        let (mut len, mut place) = (0, 0);
        for columns in columns {
            len += places(columns.touching::<V>(rect), place, &mut near[len..]);
            place += MAX_LANES as u32;
        }
        near.truncate(len);
    }
}

#[cfg(test)]
mod tests {
    use super::super::vector::Bits;
    use super::*;

    #[test]
    fn places_are_those_of_the_bits() {
        for bits in 0..1 << MAX_LANES {
            let mut out = [0; MAX_LANES];
            let n = places(bits, 7, &mut out);
            assert!(out[..n].iter().copied().eq(Bits(bits).map(|l| 7 + l as u32)), "{bits:b}");
        }
    }
}
