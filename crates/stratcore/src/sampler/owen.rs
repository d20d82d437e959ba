//! Owen scrambling of base-2 digits: true, and by a hash.

use super::Scramble;
use super::hash::{SplitMix, splitmix, unit};
use crate::simd::BLOCK;

/// Levels of the digit tree that one hash decides: 63 nodes, one bit each.
const STEP: u32 = 6;

/// How the base-2 digits of a coordinate are scrambled.
pub(super) enum DigitScramble {
    /// XORed with a word; zero: not at all.
    Xor(u64),
    /// Truly.
    Nested(NestedUniform),
    /// By a hash, with this seed.
    Hashed(u32),
}

impl DigitScramble {
    /// The scramble named by `key`, for points that `levels` digits tell apart. Those that do
    /// not work on digits leave them alone.
    pub(super) fn new(scramble: Scramble, key: u64, levels: u32) -> Self {
        match scramble {
            Scramble::Owen => Self::Nested(NestedUniform::new(key, levels)),
            Scramble::OwenHash => Self::Hashed(key as u32),
            Scramble::XorShift => Self::Xor(key),
            _ => Self::Xor(0),
        }
    }

    /// Overwrites `coordinates`, at most a block of them, with those of points of these digits,
    /// the leading one lowest; `own` makes each point's own bits from its index.
    #[inline(always)]
    pub(super) fn coordinates(
        &self,
        mirrored: &[u32; BLOCK],
        indices: Indices<'_>,
        own: OwnBits,
        coordinates: &mut [f64],
    ) {
        let points = coordinates.iter_mut().zip(mirrored);
        match self {
            Self::Xor(shift) => {
                for (x, digits) in points {
                    *x = unit(u64::from(digits.reverse_bits()) << 32 ^ shift);
                }
            }
            Self::Nested(scramble) => {
                let mut cells = [0; BLOCK];
                for (cell, digits) in cells.iter_mut().zip(mirrored) {
                    *cell = u64::from(digits.reverse_bits() >> (32 - scramble.levels));
                }
                let cells = &mut cells[..coordinates.len()];
                scramble.scramble(cells);
                let bits = own.list(indices);
                for (x, (digits, bits)) in coordinates.iter_mut().zip(cells.iter().zip(&bits)) {
                    *x = unit(scramble.fraction(*digits, *bits));
                }
            }
            Self::Hashed(seed) => {
                for (x, digits) in points {
                    *x = cell_centre(hash_reversed(*digits, *seed).reverse_bits());
                }
            }
        }
    }
}

/// Which points of their sequence a block has.
#[derive(Clone, Copy)]
pub(super) enum Indices<'a> {
    /// This one and those after it.
    From(u64),
    Listed(&'a [u64; BLOCK]),
}

/// Makes the bits that a point has of its own, 32 for each of two coordinates.
#[derive(Clone, Copy)]
pub(super) struct OwnBits {
    key: u64,
    shift: u32,
}

impl OwnBits {
    /// For the coordinate of this number, under the key of it and its neighbour.
    pub(super) fn new(key: u64, axis: usize) -> Self {
        Self { key, shift: if axis.is_multiple_of(2) { 0 } else { 32 } }
    }

    #[inline(always)]
    fn list(self, indices: Indices<'_>) -> [u64; BLOCK] {
        let mut bits = [0; BLOCK];
        match indices {
            Indices::From(first) => {
                let mut own = SplitMix::new(self.key, first);
                for bits in &mut bits {
                    *bits = own.draw();
                }
            }
            Indices::Listed(indices) => {
                for (bits, index) in bits.iter_mut().zip(indices) {
                    *bits = splitmix(self.key, *index);
                }
            }
        }
        for bits in &mut bits {
            *bits = *bits >> self.shift & 0xffff_ffff;
        }
        bits
    }
}

/// Owen's nested uniform scrambling of one coordinate (Owen, *Randomly Permuted (t,m,s)-Nets
/// and (t,s)-Sequences*, 1995): digit l is flipped or not by a random bit of its own for each
/// value of the l digits before it.
///
/// The first `levels` digits are scrambled. They tell N ≤ 2^levels points of a digital
/// sequence apart, so that all further digits of a point are its own: the caller gives it 32
/// random bits.
pub(super) struct NestedUniform {
    levels: u32,
    /// One key for each STEP levels.
    keys: [u64; 6],
}

impl NestedUniform {
    /// The scramble named by `key`, for 1 ≤ `levels` ≤ 32.
    pub(super) fn new(key: u64, levels: u32) -> Self {
        Self { levels, keys: std::array::from_fn(|step| splitmix(key, step as u64)) }
    }

    /// Overwrites each of a block of cells by its scrambled digits: a bijection of 0 .. 2^levels.
    #[inline(always)]
    pub(super) fn scramble(&self, cells: &mut [u64]) {
        let mut flipped = [0; BLOCK];
        // The first tree is that of all points.
        let mut nodes = [splitmix(self.keys[0], 0); BLOCK];
        let mut rest = self.levels;
        for (step, key) in self.keys.iter().enumerate() {
            if step > 0 {
                for (nodes, &cell) in nodes.iter_mut().zip(cells.iter()) {
                    *nodes = splitmix(*key, cell >> rest);
                }
            }
            let count = rest.min(STEP);
            rest -= count;
            let states = flipped.iter_mut().zip(nodes.iter().zip(cells.iter()));
            for (flipped, (nodes, &cell)) in states {
                // STEP digits, the missing ones zero: a node depends on those above it alone.
                let local = (cell >> rest) << (STEP - count) & ((1 << STEP) - 1);
                *flipped |= flips(*nodes, local) >> (STEP - count) << rest;
            }
            if rest == 0 {
                break;
            }
        }
        for (cell, flipped) in cells.iter_mut().zip(&flipped) {
            *cell ^= flipped;
        }
    }

    /// The coordinate of scrambled digits, a fraction of 64 bits, with the point's own 32 bits
    /// after them.
    #[inline(always)]
    fn fraction(&self, digits: u64, own: u64) -> u64 {
        digits << (64 - self.levels) | own << 32 >> self.levels
    }
}

/// The bits of the STEP nodes on the way to leaf `local` of a subtree, the top one first.
#[inline(always)]
fn flips(nodes: u64, local: u64) -> u64 {
    // Node j of level l has bit 2^l + j.
    let leaf = 1 << STEP | local;
    let node = |level: u32| nodes >> (leaf >> (STEP - level)) & 1;
    node(0) << 5 | node(1) << 4 | node(2) << 3 | node(3) << 2 | node(4) << 1 | node(5)
}

/// Nested scrambling of 32 digits by a hash, on reversed bits: each bit of the result depends
/// on the bits below it alone. The function is Laine & Karras's (*Stratified Sampling for
/// Stochastic Transparency*, 2011) as improved by N. Vegdahl (*Building a Better LK Hash*,
/// 2021).
#[inline(always)]
fn hash_reversed(mut bits: u32, seed: u32) -> u32 {
    bits ^= bits.wrapping_mul(0x3d20_adea);
    bits = bits.wrapping_add(seed);
    bits = bits.wrapping_mul(seed >> 16 | 1);
    bits ^= bits.wrapping_mul(0x0552_6c56);
    bits ^ bits.wrapping_mul(0x53a2_2864)
}

/// The middle of a cell of 2^-32.
#[inline(always)]
fn cell_centre(digits: u32) -> f64 {
    // The bits of a number in [1, 2): cheaper to make than a whole number is to convert.
    f64::from_bits(0x3ff << 52 | u64::from(digits) << 20 | 1 << 19) - 1.0
}

/// Digits that tell `n` points apart, at least one.
pub(super) fn levels(n: u64) -> u32 {
    n.max(2).next_power_of_two().trailing_zeros()
}

#[cfg(test)]
mod tests {
    use super::*;

    impl NestedUniform {
        fn digits(&self, cell: u32) -> u32 {
            let mut cells = [u64::from(cell)];
            self.scramble(&mut cells);
            cells[0] as u32
        }
    }

    #[test]
    fn common_digits_stay_common_and_no_more() {
        for levels in [1, 5, 6, 7, 12, 13, 20, 32] {
            let scramble = NestedUniform::new(99, levels);
            let mask = (u64::MAX >> (64 - levels)) as u32;
            for i in 0..2000u64 {
                let [a, b] = [2 * i, 2 * i + 1].map(|j| splitmix(3, j) as u32 & mask);
                // Force a long common prefix every other time.
                let b = if i % 2 == 0 { b } else { (a ^ b >> (i % 32)) & mask };
                let common = |x: u32, y: u32| (x ^ y).leading_zeros();
                assert_eq!(
                    common(scramble.digits(a), scramble.digits(b)),
                    common(a, b),
                    "{levels}: {a:x} {b:x}"
                );
                let [c, d] = [a, b].map(|x| hash_reversed(x.reverse_bits(), 77).reverse_bits());
                assert_eq!(common(c, d), common(a, b));
            }
        }
    }

    /// A point's own bits follow its digits at once.
    #[test]
    fn fractions_are_full() {
        for levels in [1, 6, 21, 32] {
            let scramble = NestedUniform::new(99, levels);
            let digits = u64::MAX >> (64 - levels);
            assert_eq!(scramble.fraction(digits, u32::MAX.into()).count_ones(), levels + 32);
            assert_eq!(scramble.fraction(digits, 0).leading_ones(), levels);
        }
    }

    #[test]
    fn depth_does_not_change_the_first_digits() {
        let deep = NestedUniform::new(4, 32);
        for levels in 1..32 {
            let shallow = NestedUniform::new(4, levels);
            for i in 0..200 {
                let cell = splitmix(8, i) as u32;
                let cut = 32 - levels;
                assert_eq!(shallow.digits(cell >> cut), deep.digits(cell) >> cut);
            }
        }
    }

    /// Flips of single nodes over keys, and products of the flips of different nodes (parent
    /// and child, siblings, cousins in one hash, one node in two hashes): each sum of 20,000
    /// signs has standard deviation 141; the bound is five.
    #[test]
    fn flips_are_fair_and_independent() {
        let nodes: [(u32, u32); 8] =
            [(0, 0), (1, 0), (1, 1), (5, 21), (6, 0), (6, 63), (13, 8191), (20, 1 << 19)];
        let n = 20_000;
        let mut sums = [[0i32; 8]; 8];
        for key in 0..n {
            let scramble = NestedUniform::new(splitmix(11, key), 21);
            let signs = nodes.map(|(level, prefix)| {
                let cell = prefix << (21 - level);
                let bit = scramble.digits(cell) >> (20 - level) & 1;
                1 - 2 * bit as i32
            });
            for i in 0..8 {
                sums[i][i] += signs[i];
                for j in 0..i {
                    sums[i][j] += signs[i] * signs[j];
                }
            }
        }
        for sum in sums.iter().flatten() {
            assert!(f64::from(sum.abs()) < 5.0 * (n as f64).sqrt(), "{sums:?}");
        }
    }

    #[test]
    fn extreme_digits_stay_in_range() {
        assert_eq!(cell_centre(0), 2f64.powi(-33));
        assert_eq!(cell_centre(u32::MAX), 1.0 - 2f64.powi(-33));
    }

    #[test]
    fn levels_tell_points_apart() {
        assert_eq!([1, 2, 3, 4, 5, 1 << 32].map(levels), [1, 1, 2, 2, 3, 32]);
    }
}
