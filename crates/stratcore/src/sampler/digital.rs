//! Digital sequences in base 2, a block of points at a time.

use super::hash::{splitmix, unit};
use super::owen::{DigitScramble, OwnBits, levels};
use super::{PointSet, Points, Scramble};
use crate::simd::{self, BLOCK, Isa, Loop};
use std::ops::BitXor;

/// Generator matrix of one coordinate: column c is XORed into the coordinate's digits, the
/// leading one lowest, where bit c of the index is set.
pub(super) type Columns = [u32; 32];

/// A digital sequence in base 2 under any of its scrambles.
pub(super) struct DigitalPoints {
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
        let bits = set.key.stream().scramble_bits();
        let levels = levels(set.key.n_samples);
        let axis = |(axis, columns)| {
            let key = splitmix(bits, axis);
            match set.scramble {
                Scramble::LmsShift => {
                    let columns = Box::new(linear_scramble(columns, levels, key));
                    Axis::Linear { columns, shift: key }
                }
                _ => {
                    let scramble = DigitScramble::new(set.scramble, key, levels);
                    Axis::Digits { columns, scramble }
                }
            }
        };
        Self { axes: (0..).zip(matrices).map(axis).collect(), own: splitmix(bits, u64::MAX - 1) }
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

/// XORs of the columns that 0 .. BLOCK select.
#[inline(always)]
fn low<T: Copy + Default + BitXor<Output = T>>(columns: &[T; 32]) -> [T; BLOCK] {
    let mut values = [T::default(); BLOCK];
    for (bit, &column) in columns[..BLOCK_BITS as usize].iter().enumerate() {
        let (old, new) = values.split_at_mut(1 << bit);
        for (new, old) in new.iter_mut().zip(old) {
            *new = *old ^ column;
        }
    }
    values
}

/// The XOR of `origin` and the columns that a block's first index selects.
#[inline(always)]
fn high<T: Copy + BitXor<Output = T>>(columns: &[T; 32], first: u64, origin: T) -> T {
    let mut value = origin;
    let mut bits = first as u32;
    while bits != 0 {
        value = value ^ columns[bits.trailing_zeros() as usize];
        bits &= bits - 1;
    }
    value
}

impl Points for DigitalPoints {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        let dim = self.axes.len();
        for (axis, scrambled) in self.axes.iter().enumerate() {
            let own = OwnBits::new(splitmix(self.own, axis as u64 / 2), axis);
            simd::run(isa, AxisLoop { scrambled, own, first, points, axis, dim });
        }
    }
}

/// One coordinate of points `first ..`.
struct AxisLoop<'a> {
    scrambled: &'a Axis,
    own: OwnBits,
    first: u64,
    points: &'a mut [f64],
    axis: usize,
    dim: usize,
}

impl Loop for AxisLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { scrambled, own, first, points, axis, dim } = self;
        // Blocks begin at multiples of their length.
        let mut skipped = (first % BLOCK as u64) as usize;
        let mut first = first - skipped as u64;
        let mut rest = points;
        let mut low64 = [0; BLOCK];
        let mut low32 = [0; BLOCK];
        match scrambled {
            Axis::Digits { columns, .. } => low32 = low(columns),
            Axis::Linear { columns, .. } => low64 = low(columns),
        }
        let mut made = [0.0; BLOCK];
        while !rest.is_empty() {
            let run;
            (run, rest) = rest.split_at_mut(((BLOCK - skipped) * dim).min(rest.len()));
            let coordinates = &mut made[..skipped + run.len() / dim];
            match scrambled {
                Axis::Digits { columns, scramble } => {
                    let high = high(columns, first, 0);
                    let (mut digits, mut indices) = (low32, [0; BLOCK]);
                    for (lane, (digits, index)) in (0..).zip(digits.iter_mut().zip(&mut indices)) {
                        *digits ^= high;
                        *index = first + lane;
                    }
                    scramble.coordinates(&digits, &indices, own, coordinates);
                }
                Axis::Linear { columns, shift } => {
                    let high = high(columns, first, *shift);
                    for (x, low) in coordinates.iter_mut().zip(&low64) {
                        *x = unit(low ^ high);
                    }
                }
            }
            for (point, x) in run.chunks_exact_mut(dim).zip(&coordinates[skipped..]) {
                point[axis] = *x;
            }
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
