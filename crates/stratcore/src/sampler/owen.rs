//! Owen scrambling of base-2 digits: true, and by a hash.

use super::hash::splitmix;

/// Levels of the digit tree that one hash decides: 63 nodes, one bit each.
const STEP: u32 = 6;

/// Owen's nested uniform scrambling of one coordinate (Owen, *Randomly Permuted (t,m,s)-Nets
/// and (t,s)-Sequences*, 1995): digit l is flipped or not by a random bit of its own for each
/// value of the l digits before it.
///
/// The first `levels` digits are scrambled. They tell N ≤ 2^levels points of a digital
/// sequence apart, so that all further digits of a point are its own: the caller gives it 32
/// random bits.
pub(super) struct NestedUniform {
    levels: u32,
    /// The first `tabled` digits, scrambled: all of them, or a multiple of STEP.
    table: Vec<u32>,
    tabled: u32,
    /// One key for each STEP levels.
    keys: [u64; 6],
}

impl NestedUniform {
    /// The scramble named by `key`, for 1 ≤ `levels` ≤ 32. The table is no longer than `n`
    /// points in `dim` dimensions deserve; the digits do not depend on it.
    pub(super) fn new(key: u64, levels: u32, n: u64, dim: usize) -> Self {
        let keys = std::array::from_fn(|step| splitmix(key, step as u64));
        let longest = if dim <= 4 { 3 * STEP } else { 2 * STEP };
        let worthwhile = n.next_power_of_two().trailing_zeros().clamp(STEP, longest);
        let tabled = if levels <= worthwhile { levels } else { worthwhile / STEP * STEP };
        let mut table = vec![0; 1 << tabled];
        for level in 0..tabled {
            let (step, local) = (level / STEP, level % STEP);
            // Backwards, so that no prefix is overwritten before it is read. The prefixes of
            // one subtree are adjacent: its hash is needed once.
            for subtree in (0..1u64 << (step * STEP)).rev() {
                let nodes = splitmix(keys[step as usize], subtree);
                for node in (0..1u64 << local).rev() {
                    let prefix = (subtree << local | node) as usize;
                    let flip = (nodes >> (1 << local | node)) as u32 & 1;
                    let digits = table[prefix] << 1 | flip;
                    table[2 * prefix] = digits;
                    table[2 * prefix + 1] = digits ^ 1;
                }
            }
        }
        Self { levels, table, tabled, keys }
    }

    /// The scrambled digits of a cell: a bijection of 0 .. 2^levels.
    #[inline(always)]
    pub(super) fn digits(&self, cell: u32) -> u32 {
        let mut rest = self.levels - self.tabled;
        // The mask changes nothing: it tells the compiler that the index is in range.
        let mut digits = self.table[(cell >> rest) as usize & (self.table.len() - 1)];
        let mut step = (self.tabled / STEP) as usize;
        while rest > 0 {
            let nodes = splitmix(self.keys[step], u64::from(cell >> rest));
            let count = rest.min(STEP);
            rest -= count;
            // STEP digits, the missing ones zero: a node depends on those above it alone.
            let local = (cell >> rest) << (STEP - count) & ((1 << STEP) - 1);
            digits = digits << count | (local ^ flips(nodes, local)) >> (STEP - count);
            step += 1;
        }
        digits
    }

    /// The scrambled coordinate of a cell, a fraction of 64 bits, with the point's own 32 bits
    /// after the digits.
    #[inline(always)]
    pub(super) fn fraction(&self, cell: u32, own: u32) -> u64 {
        let tail = u64::from(own) << 32 >> self.levels;
        u64::from(self.digits(cell)) << (64 - self.levels) | tail
    }
}

/// The bits of the STEP nodes on the way to leaf `local` of a subtree, the top one first.
#[inline(always)]
fn flips(nodes: u64, local: u32) -> u32 {
    (0..STEP).fold(0, |flips, level| {
        let node = 1 << level | local >> (STEP - level);
        flips << 1 | (nodes >> node) as u32 & 1
    })
}

/// Nested scrambling of 32 digits by a hash, on reversed bits: each bit of the result depends
/// on the bits below it alone. The function is Laine & Karras's (*Stratified Sampling for
/// Stochastic Transparency*, 2011) as improved by N. Vegdahl (*Building a Better LK Hash*,
/// 2021).
#[inline(always)]
pub(super) fn hash_reversed(mut bits: u32, seed: u32) -> u32 {
    bits ^= bits.wrapping_mul(0x3d20_adea);
    bits = bits.wrapping_add(seed);
    bits = bits.wrapping_mul(seed >> 16 | 1);
    bits ^= bits.wrapping_mul(0x0552_6c56);
    bits ^ bits.wrapping_mul(0x53a2_2864)
}

/// The middle of a cell of 2^-32.
#[inline(always)]
pub(super) fn cell_centre(digits: u32) -> f64 {
    (f64::from(digits) + 0.5) * 2f64.powi(-32)
}

/// Digits that tell `n` points apart, at least one.
pub(super) fn levels(n: u64) -> u32 {
    n.max(2).next_power_of_two().trailing_zeros()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn common_digits_stay_common_and_no_more() {
        for levels in [1, 5, 6, 7, 12, 13, 20, 32] {
            let scramble = NestedUniform::new(99, levels, 1 << (levels / 2), levels as usize);
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
                let top = (scramble.fraction(a, u32::MAX) >> (64 - levels)) as u32;
                assert_eq!(top, scramble.digits(a));
                let [c, d] = [a, b].map(|x| hash_reversed(x.reverse_bits(), 77).reverse_bits());
                assert_eq!(common(c, d), common(a, b));
            }
        }
    }

    /// The table and the hashes are one function: a deeper tree begins like a shallow one.
    #[test]
    fn depth_does_not_change_the_first_digits() {
        let deep = NestedUniform::new(4, 32, 1, 1);
        for levels in 1..32 {
            let shallow = NestedUniform::new(4, levels, 1 << levels, 2);
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
            let scramble = NestedUniform::new(splitmix(11, key), 21, 64, 1);
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
    fn levels_tell_points_apart() {
        assert_eq!([1, 2, 3, 4, 5, 1 << 32].map(levels), [1, 1, 2, 2, 3, 32]);
    }
}
