//! Digital sequences in base 2, a block of points at a time.

use super::hash::{splitmix, unit};
use super::owen::{DigitScramble, Indices, levels, own_bits};
use super::target::{ByAxis, Target};
use super::{PointSet, Points, Scramble};
use crate::rng::Stream;
use crate::simd::{self, BLOCK, Isa, Loop};
use std::ops::BitXor;

/// Generator matrix of one coordinate: column c is XORed into the coordinate's digits, the
/// leading one lowest, where bit c of the index is set.
pub(super) type Columns = [u32; 32];

/// A digital sequence in base 2 under any of its scrambles.
pub(super) struct DigitalPoints {
    matrices: &'static [Columns],
    scramble: Scramble,
    levels: u32,
    axes: Vec<Axis>,
    /// Key of the bits that truly scrambled points have of their own.
    own: u64,
}

enum Axis {
    /// The matrix as it is, and a scramble of its digits.
    Digits { columns: &'static Columns, scramble: DigitScramble },
    /// A matrix of 64 rows, the leading digit highest, and a shift: linear scrambling.
    Linear { columns: Box<[u64; 32]>, shift: u64 },
}

impl DigitalPoints {
    pub(super) fn new(matrices: &'static [Columns], set: &PointSet) -> Self {
        let axis = |columns| match set.scramble {
            Scramble::LmsShift => Axis::Linear { columns: Box::new([0; 32]), shift: 0 },
            _ => Axis::Digits { columns, scramble: DigitScramble::Xor(0) },
        };
        let (scramble, levels) = (set.scramble, levels(set.key.n_samples));
        let axes = matrices.iter().map(axis).collect();
        let mut points = Self { matrices, scramble, levels, axes, own: 0 };
        points.renew(&set.key.stream());
        points
    }
}

/// The first `levels` columns times a random lower triangular matrix with a unit diagonal and
/// 64 rows (Matoušek 1998). Column c of that matrix, a word that begins with c zeros and a
/// one, takes the place of digit c.
fn linear_scramble(columns: &Columns, levels: u32, key: u64) -> [u64; 32] {
    let key = splitmix(key, 0);
    let lower: [u64; 32] = std::array::from_fn(|c| (splitmix(key, c as u64) | 1 << 63) >> c);
    let mut scrambled = [0; 32];
    for (scrambled, &column) in scrambled.iter_mut().zip(columns).take(levels as usize) {
        let mut digits = column;
        while digits != 0 {
            *scrambled ^= lower[digits.trailing_zeros() as usize];
            digits &= digits - 1;
        }
    }
    scrambled
}

/// Index bits that count within a block.
const BLOCK_BITS: u32 = BLOCK.trailing_zeros();

/// The XORs of `origin` and the columns that the indices of a block select; the block begins at a
/// multiple of its length.
#[inline(always)]
fn xors<T: Copy + BitXor<Output = T>>(columns: &[T; 32], first: u64, origin: T) -> [T; BLOCK] {
    let mut values = [origin; BLOCK];
    let mut bits = first as u32;
    while bits != 0 {
        values[0] = values[0] ^ columns[bits.trailing_zeros() as usize];
        bits &= bits - 1;
    }
    for (bit, &column) in columns[..BLOCK_BITS as usize].iter().enumerate() {
        let (old, new) = values.split_at_mut(1 << bit);
        for (new, old) in new.iter_mut().zip(old) {
            *new = *old ^ column;
        }
    }
    values
}

impl Axis {
    /// Whether points have bits of their own behind the digits that tell them apart.
    #[inline(always)]
    fn has_own_bits(&self) -> bool {
        matches!(self, Self::Digits { scramble, .. } if scramble.has_own_bits())
    }

    /// Coordinates of the points of a block, which begins at a multiple of its length; `own` are
    /// the bits of those that have some.
    #[inline(always)]
    fn block(&self, first: u64, own: &[u32; BLOCK], coordinates: &mut [f64]) {
        match self {
            Self::Digits { columns, scramble } => {
                scramble.coordinates(&xors(columns, first, 0), own, coordinates);
            }
            Self::Linear { columns, shift } => {
                for (x, bits) in coordinates.iter_mut().zip(xors(columns, first, *shift)) {
                    *x = unit(bits);
                }
            }
        }
    }
}

impl ByAxis for DigitalPoints {
    fn dim(&self) -> usize {
        self.axes.len()
    }
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>) {
        for (pair, axes) in self.axes.chunks(2).enumerate() {
            let own = splitmix(self.own, pair as u64);
            simd::run(isa, PairLoop { axes, own, first, target, axis: 2 * pair });
        }
    }
    fn renew_axes(&mut self, stream: &Stream) -> bool {
        let bits = stream.scramble_bits();
        for (number, (axis, matrix)) in (0..).zip(self.axes.iter_mut().zip(self.matrices)) {
            let key = splitmix(bits, number);
            match axis {
                Axis::Digits { scramble, .. } => {
                    scramble.renew(self.scramble, key, self.levels, self.matrices.len());
                }
                Axis::Linear { columns, shift } => {
                    **columns = linear_scramble(matrix, self.levels, key);
                    *shift = key;
                }
            }
        }
        self.own = splitmix(bits, u64::MAX - 1);
        true
    }
}

/// One or two coordinates of points `first ..`, from number `axis` on.
struct PairLoop<'a, 'b> {
    axes: &'a [Axis],
    /// Key of the bits that points have of their own.
    own: u64,
    first: u64,
    target: &'a mut Target<'b>,
    axis: usize,
}

impl Loop for PairLoop<'_, '_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { axes, own: key, first, target, axis } = self;
        let has_own_bits = axes.iter().any(Axis::has_own_bits);
        let mut skipped = (first % BLOCK as u64) as usize;
        let mut first = first - skipped as u64;
        let (mut made, mut own) = ([0.0; BLOCK], [[0; BLOCK]; 2]);
        let (mut at, len) = (0, target.len());
        while at < len {
            let end = BLOCK.min(skipped + len - at);
            if has_own_bits {
                own_bits(key, Indices::From(first), end, &mut own);
            }
            for (axis, (scrambled, own)) in (axis..).zip(axes.iter().zip(&own)) {
                scrambled.block(first, own, &mut made[..end]);
                target.put(axis, at, made[skipped..end].iter().copied());
            }
            at += end - skipped;
            first += BLOCK as u64;
            skipped = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sobol::sobol_matrices;
    use super::*;

    #[test]
    fn a_linear_scramble_keeps_the_leading_digit() {
        let columns = &sobol_matrices()[5];
        for (scrambled, column) in linear_scramble(columns, 32, 9).iter().zip(columns) {
            assert_eq!(scrambled.leading_zeros(), column.trailing_zeros());
        }
    }
}
