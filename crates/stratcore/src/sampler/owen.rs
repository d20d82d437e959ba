//! Owen scrambling of base-2 digits: true, and by a hash.

use super::Scramble;
use super::hash::{SplitMix, splitmix, unit};
use crate::simd::{self, BLOCK, Isa, Loop};

/// Levels of the digit tree that one hash decides: 63 nodes, one bit each.
const STEP: u32 = 6;

/// Levels up to which a scramble is a table: two hashes from the root to a leaf, 16 KiB.
const MOST_TABLED: u32 = 2 * STEP;

/// Coordinates of a set up to which it has such tables: 16 MiB in all.
const MOST_TABLES: usize = 1024;

/// How the base-2 digits of a coordinate are scrambled.
pub(super) enum DigitScramble {
    /// XORed with a word; zero: not at all.
    Xor(u64),
    /// Truly, digit by digit.
    Nested(NestedUniform),
    /// Truly: the scrambled digits of every cell, as [`tabulate`] has them.
    Tabled(Vec<u32>),
    /// By a hash, with this seed.
    Hashed(u32),
}

impl DigitScramble {
    /// The scramble named by `key`, for sets of `dim` coordinates whose points `levels` digits
    /// tell apart. Those that do not work on digits leave them alone.
    pub(super) fn new(scramble: Scramble, key: u64, levels: u32, dim: usize) -> Self {
        match scramble {
            Scramble::Owen if levels <= MOST_TABLED && dim <= MOST_TABLES => {
                let mut table = vec![0; 1 << levels];
                tabulate(key, levels, &mut table);
                Self::Tabled(table)
            }
            Scramble::Owen => Self::Nested(NestedUniform::new(key, levels)),
            Scramble::OwenHash => Self::Hashed(key as u32),
            Scramble::XorShift => Self::Xor(key),
            _ => Self::Xor(0),
        }
    }

    /// Becomes the same scramble named by another key.
    pub(super) fn renew(&mut self, scramble: Scramble, key: u64, levels: u32, dim: usize) {
        match self {
            Self::Tabled(table) => tabulate(key, levels, table),
            _ => *self = Self::new(scramble, key, levels, dim),
        }
    }

    /// Whether points have bits of their own behind the digits that tell them apart.
    #[inline(always)]
    pub(super) fn has_own_bits(&self) -> bool {
        matches!(self, Self::Nested(_) | Self::Tabled(_))
    }

    /// Overwrites `coordinates`, at most a block of them, with those of points of these digits,
    /// the leading one lowest, and of each point's own 32 bits, which not every scramble asks
    /// for.
    #[inline(always)]
    pub(super) fn coordinates(
        &self,
        mirrored: &[u32; BLOCK],
        own: &[u32; BLOCK],
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
                for (x, (digits, own)) in coordinates.iter_mut().zip(cells.iter().zip(own)) {
                    *x = unit(fraction(*digits, scramble.levels, *own));
                }
            }
            Self::Tabled(table) => {
                let (table, levels) = (&table[..], table.len().trailing_zeros());
                let last = table.len() - 1;
                let mut cells = [0; BLOCK];
                let (cells, _) = cells[..whole_vectors(coordinates.len())].as_chunks_mut::<8>();
                let (mirrored, _) = mirrored.as_chunks::<8>();
                for (cells, mirrored) in cells.iter_mut().zip(mirrored) {
                    for (cell, digits) in cells.iter_mut().zip(mirrored) {
                        *cell = table[*digits as usize & last];
                    }
                }
                let cells = cells.as_flattened().iter().zip(own);
                for (x, (digits, own)) in coordinates.iter_mut().zip(cells) {
                    *x = unit(fraction((*digits).into(), levels, *own));
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

/// The coordinate of `levels` scrambled digits, a fraction of 64 bits, with the point's own 32
/// bits after them.
#[inline(always)]
fn fraction(digits: u64, levels: u32, own: u32) -> u64 {
    digits << (64 - levels) | u64::from(own) << 32 >> levels
}

/// Which points of their sequence a block has.
#[derive(Clone, Copy)]
pub(super) enum Indices<'a> {
    /// This one and those after it.
    From(u64),
    Listed(&'a [u64; BLOCK]),
}

/// Overwrites `own` with the bits that the first `len` points of a block have of their own, 32 for
/// each of two coordinates, under the key of both.
#[inline(always)]
pub(super) fn own_bits(key: u64, indices: Indices<'_>, len: usize, own: &mut [[u32; BLOCK]; 2]) {
    let len = whole_vectors(len);
    let [low, high] = own;
    let own = low[..len].iter_mut().zip(&mut high[..len]);
    match indices {
        Indices::From(first) => {
            let mut bits = SplitMix::new(key, first);
            for (low, high) in own {
                [*low, *high] = halves(bits.draw());
            }
        }
        Indices::Listed(indices) => {
            for ((low, high), index) in own.zip(indices) {
                [*low, *high] = halves(splitmix(key, *index));
            }
        }
    }
}

/// As many points of a block, or a few more, that no loop ends within a vector.
#[inline(always)]
pub(super) fn whole_vectors(len: usize) -> usize {
    len.next_multiple_of(8).min(BLOCK)
}

#[inline(always)]
fn halves(bits: u64) -> [u32; 2] {
    [bits as u32, (bits >> 32) as u32]
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
}

/// Overwrites `table`, 2^levels long for at most [`MOST_TABLED`] levels, with the scrambled digits
/// that [`NestedUniform`] gives every cell: that of its own digits mirrored, the leading one
/// lowest.
fn tabulate(key: u64, levels: u32, table: &mut [u32]) {
    let keys = [0, 1].map(|step| splitmix(key, step));
    simd::run(Isa::detect(), TableLoop { keys, levels, table });
}

/// Makes the leaves of the first tree, then appends one digit after the other. Cells that share
/// their leading digits lie a power of two apart, so both halves of each are made in vectors.
struct TableLoop<'a> {
    keys: [u64; 2],
    levels: u32,
    table: &'a mut [u32],
}

impl Loop for TableLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { keys, levels, table } = self;
        let append = |digits: &mut u32, one: &mut u32, flip: u32| {
            let before = *digits << 1;
            (*digits, *one) = (before | flip, before | flip ^ 1);
        };
        // All leaves at once: level by level the first ones would be less than a vector.
        let tree = halves(splitmix(keys[0], 0));
        let mut leaves = [0; 1 << STEP];
        let known = levels.min(STEP);
        // Fewer digits are those of the first leaves that begin with them.
        let leaves = &mut leaves[..whole_vectors(1 << known)];
        for (level, places) in (0..known).zip(&PLACES) {
            let nodes = tree[usize::from(level == STEP - 1)];
            for (leaf, place) in leaves.iter_mut().zip(places) {
                *leaf = *leaf << 1 | nodes >> place & 1;
            }
        }
        for (digits, (leaf, own)) in table.iter_mut().zip(leaves.iter().zip(MIRRORED)) {
            *digits = leaf ^ own >> (STEP - known);
        }
        if levels <= STEP {
            return;
        }
        let mut trees = [[0; 1 << STEP]; 2];
        let [low, high] = &mut trees;
        for (digits, (low, high)) in MIRRORED.iter().zip(low.iter_mut().zip(high)) {
            [*low, *high] = halves(splitmix(keys[1], (*digits).into()));
        }
        for level in STEP..levels {
            let (digits, ones) = table.split_at_mut(1 << level);
            let blocks = digits.chunks_exact_mut(1 << STEP).zip(ones.chunks_exact_mut(1 << STEP));
            for (block, (digits, ones)) in (0..).zip(blocks) {
                let node = 1 << (level - STEP) | mirrored(block, level - STEP);
                let trees = &trees[node as usize / 32];
                for (nodes, (digits, one)) in trees.iter().zip(digits.iter_mut().zip(ones)) {
                    append(digits, one, nodes >> (node % 32) & 1);
                }
            }
        }
    }
}

/// The lowest `count` bits, at most 31, in the opposite order.
#[inline(always)]
const fn mirrored(bits: u32, count: u32) -> u32 {
    bits.reverse_bits() >> 1 >> (31 - count)
}

/// A leaf's digits, and by level the bit of its node on the way from the root, modulo 32; leaves
/// in the order of their digits mirrored. Node j of a level has bit 2^level + j of the tree.
const MIRRORED: [u32; 1 << STEP] = leaf_tables().0;
const PLACES: [[u32; 1 << STEP]; STEP as usize] = leaf_tables().1;

const fn leaf_tables() -> ([u32; 1 << STEP], [[u32; 1 << STEP]; STEP as usize]) {
    let (mut digits, mut places) = ([0; 1 << STEP], [[0; 1 << STEP]; STEP as usize]);
    let mut at = 0;
    while at < 1 << STEP {
        digits[at as usize] = mirrored(at, STEP);
        let mut level = 0;
        while level < STEP {
            places[level as usize][at as usize] = (1 << level | mirrored(at, level)) % 32;
            level += 1;
        }
        at += 1;
    }
    (digits, places)
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

    #[test]
    fn tables_hold_every_cell() {
        for levels in 1..=MOST_TABLED {
            let scramble = NestedUniform::new(99, levels);
            let mut table = vec![u32::MAX; 1 << levels];
            tabulate(99, levels, &mut table);
            for cell in 0..1 << levels {
                let found = table[mirrored(cell, levels) as usize];
                assert_eq!(found, scramble.digits(cell), "{levels}: {cell:b}");
            }
        }
    }

    /// A point's own bits follow its digits at once.
    #[test]
    fn fractions_are_full() {
        for levels in [1, 6, 21, 32] {
            let digits = u64::MAX >> (64 - levels);
            assert_eq!(fraction(digits, levels, u32::MAX).count_ones(), levels + 32);
            assert_eq!(fraction(digits, levels, 0).leading_ones(), levels);
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
