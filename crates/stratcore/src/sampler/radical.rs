//! Radical inverses in any prime base, with their digits scrambled.

use super::hash::{SplitMix, splitmix, unit, whole};
use super::target::Target;
use super::{BELOW_ONE, Scramble};
use crate::simd::{self, BLOCK, Divisor, Isa, Loop};

/// One coordinate of a Halton sequence: the digits of the index in base b, mirrored at the
/// point and scrambled.
///
/// A digit x becomes ax + c mod b, with random a ≠ 0 and c. In a prime base these affine maps
/// take any two different digits to any two different digits with equal probability, as
/// uniformly random permutations do; mean and variance of an estimate depend on no more than
/// that (Matoušek, *On the L2-discrepancy for anchored boxes*, 1998; Owen, *Variance with
/// alternative scramblings of digital nets*, 2003). One map for each position is
/// [`Scramble::DigitPermutation`]; one for each value of the digits before is
/// [`Scramble::Owen`].
pub(super) struct RadicalInverse {
    base: u64,
    digits: DigitMaps,
    tail: Tail,
    /// The first digits of an index, mirrored and scrambled: entry r for index mod b^t.
    table: Vec<u32>,
    /// Digits in the table, t, and b^t.
    tabled: u32,
    period: u64,
    /// b^(digits after the table), and how many those are.
    rest_scale: u64,
    rest: usize,
    /// b^(all digits), exact: it is below 2^46.
    scale: Divisor,
}

/// Most digits after the table: those of 2^32 in base 2 beside the shorter table.
const MOST_REST: usize = 20;

impl RadicalInverse {
    /// For indices below `n` ≤ 2^32, prime bases up to 2^13 and sets of `dim` coordinates (the
    /// more there are, the shorter is the table of each): as many digits as tell the indices
    /// apart, and a tail that stands for all further ones.
    pub(super) fn new(base: u64, n: u64, scramble: Scramble, key: u64, dim: usize) -> Self {
        let longest_table = if dim <= 4 { 1 << 16 } else { 1 << 12 };
        let (mut all, mut power) = (1, base);
        let (mut tabled, mut period) = (1, base);
        while power < n {
            power *= base;
            all += 1;
            // The table has no entry for an index that is not there.
            if power.min(n) <= longest_table {
                (tabled, period) = (all, power);
            }
        }
        let digits = DigitMaps::new(scramble, key);
        let table = table(Isa::detect(), base, tabled, period.min(n) as usize, &digits);
        let rest = (all - tabled) as usize;
        let rest_scale = power / period;
        let tail = Tail::new(scramble, key);
        Self {
            base,
            digits,
            tail,
            table,
            tabled,
            period,
            rest_scale,
            rest,
            scale: Divisor::new(power),
        }
    }

    /// Writes coordinate `axis` of the target's points with those of indices `first ..`.
    pub(super) fn fill(&self, isa: Isa, first: u64, target: &mut Target<'_>, axis: usize) {
        let n = target.len();
        let (tail, scale) = (&self.tail, self.scale);
        if self.rest == 0 {
            let cells = &self.table[first as usize..][..n];
            simd::run(isa, FractionLoop { cells, tail, scale, target, axis, at: 0 });
            return;
        }
        let mut mirrored = [0; BLOCK];
        let mut at = 0;
        while at < n {
            let first = first + at as u64;
            // As far as the table goes without beginning anew.
            let low = first % self.period;
            let len = (BLOCK as u64).min(self.period - low).min((n - at) as u64) as usize;
            let cells = &mut mirrored[..len];
            self.mirror(first / self.period, low, cells);
            simd::run(isa, FractionLoop { cells, tail, scale, target, axis, at });
            at += len;
        }
    }

    /// Mirrored and scrambled indices high·period + low ..
    fn mirror(&self, high: u64, low: u64, mirrored: &mut [u64]) {
        let digits = self.rest_digits(high);
        let own = self.digits.nested;
        let common = if own { 0 } else { self.mirror_rest(&digits, 0) };
        let table = &self.table[low as usize..];
        for ((low, mirrored), tabled) in (low..).zip(mirrored).zip(table) {
            let rest = if own { self.mirror_rest(&digits, low) } else { common };
            *mirrored = u64::from(*tabled) * self.rest_scale + rest;
        }
    }

    /// Digits after the table, the lowest first.
    fn rest_digits(&self, mut high: u64) -> [u32; MOST_REST] {
        let mut digits = [0; MOST_REST];
        for digit in &mut digits[..self.rest] {
            *digit = (high % self.base) as u32;
            high /= self.base;
        }
        digits
    }

    /// Mirrors and scrambles the digits after the table. `low`, the digits before them,
    /// matters only to nested maps.
    fn mirror_rest(&self, digits: &[u32; MOST_REST], low: u64) -> u64 {
        let (mut prefix, mut width) = (low, self.period);
        let mut mirrored = 0;
        for (level, &digit) in (self.tabled..).zip(&digits[..self.rest]) {
            let (factor, start) =
                self.digits.map(self.digits.level_key(level), self.base as u32, prefix);
            let scrambled = (start + factor * digit) % self.base as u32;
            mirrored = mirrored * self.base + u64::from(scrambled);
            prefix += u64::from(digit) * width;
            width *= self.base;
        }
        mirrored
    }
}

/// Writes (cell + tail) / scale for each cell to a coordinate of the target's points from number
/// `at` on.
pub(super) struct FractionLoop<'a, 'b, C> {
    pub(super) cells: &'a [C],
    pub(super) tail: &'a Tail,
    pub(super) scale: Divisor,
    pub(super) target: &'a mut Target<'b>,
    pub(super) axis: usize,
    pub(super) at: usize,
}

impl<C: Copy + Into<u64>> Loop for FractionLoop<'_, '_, C> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { cells, tail, scale, target, axis, at } = self;
        let mut made = [0.0; BLOCK];
        for (at, cells) in (at..).step_by(BLOCK).zip(cells.chunks(BLOCK)) {
            let made = &mut made[..cells.len()];
            tail.after(cells, made);
            for x in made.iter_mut() {
                *x = scale.divide::<FMA>(*x).min(BELOW_ONE);
            }
            target.put(axis, at, made);
        }
    }
}

/// Mirrors and scrambles the first `digits` digits of 0 .. `len`.
fn table(isa: Isa, base: u64, digits: u32, len: usize, maps: &DigitMaps) -> Vec<u32> {
    let mut table = vec![0u32; len];
    simd::run(isa, TableLoop { table: &mut table, base: base as u32, digits, maps });
    table
}

/// Appends one digit after the other to the table's first entry, so that there are `base` times
/// as many each time.
struct TableLoop<'a> {
    table: &'a mut [u32],
    base: u32,
    digits: u32,
    maps: &'a DigitMaps,
}

impl Loop for TableLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        /// A vector's numbers of 32 bits.
        const LANES: usize = 8;
        let Self { table, base, digits: levels, maps } = self;
        // Nothing overflows: all digits but the last tell 2^16 points apart at the most.
        let (mut factors, mut digits, mut before) = ([0; BLOCK], [0; BLOCK], [0; BLOCK]);
        let mut width = 1;
        for level in 0..levels {
            let level_key = maps.level_key(level);
            for block in (0..width.min(table.len())).step_by(BLOCK) {
                let len = BLOCK.min(width - block).min(table.len() - block);
                // Of few to the end of a vector, which is as cheap: what is too much is
                // written over by what comes next, or lies behind the table's end.
                let made = if block == 0 { len.next_multiple_of(LANES) } else { len };
                let (factors, digits) = (&mut factors[..made], &mut digits[..made]);
                let before = &mut before[..made];
                maps.list(level_key, base, block as u64, factors, digits);
                for (before, entry) in before.iter_mut().zip(&table[block..]) {
                    *before = entry.wrapping_mul(base);
                }
                let mut at = block;
                for _ in 0..base {
                    let Some(entries) = table.get_mut(at..) else { break };
                    let states = digits.iter_mut().zip(factors.iter().zip(before.iter()));
                    for (entry, (digit, (factor, before))) in entries.iter_mut().zip(states) {
                        *entry = before.wrapping_add(*digit);
                        let next = digit.wrapping_add(*factor);
                        *digit = if next >= base { next.wrapping_sub(base) } else { next };
                    }
                    at += width;
                }
            }
            width *= base as usize;
        }
    }
}

/// Which affine map a digit goes through.
struct DigitMaps {
    scrambled: bool,
    /// A map of its own for each value of the digits before.
    nested: bool,
    key: u64,
}

impl DigitMaps {
    fn new(scramble: Scramble, key: u64) -> Self {
        let nested = scramble == Scramble::Owen;
        Self { scrambled: nested || scramble == Scramble::DigitPermutation, nested, key }
    }

    fn level_key(&self, level: u32) -> u64 {
        splitmix(self.key, level.into())
    }

    /// Factors and constants of the maps of the digit at a level after the digits `prefix` ..
    #[inline(always)]
    fn list(
        &self,
        level_key: u64,
        base: u32,
        prefix: u64,
        factors: &mut [u32],
        constants: &mut [u32],
    ) {
        if !self.nested {
            let (factor, constant) = self.map(level_key, base, 0);
            factors.fill(factor);
            constants.fill(constant);
            return;
        }
        let mut bits = SplitMix::new(level_key, prefix);
        for (factor, constant) in factors.iter_mut().zip(constants) {
            (*factor, *constant) = affine_map(bits.draw(), base);
        }
    }

    /// Factor and constant of the map of the digit at a level after the digits `prefix`.
    #[inline(always)]
    fn map(&self, level_key: u64, base: u32, prefix: u64) -> (u32, u32) {
        if !self.scrambled {
            return (1, 0);
        }
        affine_map(splitmix(level_key, if self.nested { prefix } else { 0 }), base)
    }
}

/// Factor and constant from random bits.
#[inline(always)]
fn affine_map(bits: u64, base: u32) -> (u32, u32) {
    let upper = |half: u64, n: u32| (half.wrapping_mul(n.into()) >> 32) as u32;
    (upper(bits >> 32, base - 1).wrapping_add(1), upper(bits & 0xffff_ffff, base))
}

/// All digits after those that tell the points apart, in units of the last of them. They are
/// zeros, scrambled.
pub(super) enum Tail {
    /// Not scrambled.
    Zero,
    /// Scrambled by position: the same for all points.
    Common(f64),
    /// Scrambled one by one: a uniform number for each cell.
    Own(u64),
}

impl Tail {
    pub(super) fn new(scramble: Scramble, key: u64) -> Self {
        let key = splitmix(key, u64::MAX);
        match scramble {
            Scramble::Owen => Self::Own(key),
            Scramble::DigitPermutation => Self::Common(unit(key)),
            _ => Self::Zero,
        }
    }

    /// Overwrites `sums` by cell + tail of each cell.
    #[inline(always)]
    fn after<C: Copy + Into<u64>>(&self, cells: &[C], sums: &mut [f64]) {
        let points = sums.iter_mut().zip(cells);
        match self {
            Self::Zero => points.for_each(|(sum, cell)| *sum = whole((*cell).into())),
            Self::Common(tail) => {
                points.for_each(|(sum, cell)| *sum = whole((*cell).into()) + tail);
            }
            Self::Own(key) => {
                for (sum, &cell) in points {
                    let cell = cell.into();
                    *sum = whole(cell) + unit(splitmix(*key, cell));
                }
            }
        }
    }
}

/// The first `count` primes.
pub(super) fn primes(count: usize) -> Vec<u64> {
    let mut primes: Vec<u64> = Vec::with_capacity(count);
    let mut candidate = 2;
    while primes.len() < count {
        let is_prime =
            |n: u64| primes.iter().take_while(|p| *p * *p <= n).all(|p| !n.is_multiple_of(*p));
        if is_prime(candidate) {
            primes.push(candidate);
        }
        candidate += 1;
    }
    primes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coordinates(base: u64, n: u64, scramble: Scramble, first: u64, len: usize) -> Vec<f64> {
        let mut points = vec![0.0; len];
        let target = &mut Target::Rows { points: &mut points, dim: 1 };
        RadicalInverse::new(base, n, scramble, 17, 9).fill(Isa::detect(), first, target, 0);
        points
    }

    /// The definition, digit by digit.
    fn radical_inverse(mut i: u64, base: u64) -> f64 {
        let (mut numerator, mut denominator) = (0, 1);
        while i > 0 {
            numerator = numerator * base + i % base;
            denominator *= base;
            i /= base;
        }
        numerator as f64 / denominator as f64
    }

    #[test]
    fn plain_digits_follow_the_definition() {
        for base in [2, 3, 7, 131, 8161] {
            for (n, first) in [(1, 0), (50, 0), (1 << 32, 123_456_789), (1 << 32, (1 << 32) - 50)] {
                let len = 50.min(n as usize);
                for (i, x) in (first..).zip(coordinates(base, n, Scramble::None, first, len)) {
                    // Both are one rounding away from the same fraction.
                    let expected = radical_inverse(i, base);
                    assert!((x - expected).abs() <= f64::EPSILON * expected, "{base}: {i}");
                }
            }
        }
    }

    #[test]
    fn scrambled_digits_keep_one_point_per_cell() {
        for scramble in [Scramble::Owen, Scramble::DigitPermutation] {
            for (base, digits) in [(2, 16), (3, 9), (5, 6), (31, 3), (257, 2)] {
                let n = u64::pow(base, digits);
                let points = coordinates(base, n, scramble, 0, n as usize);
                for cells in (0..=digits).map(|k| u64::pow(base, k)) {
                    // Any aligned run of as many points, one in each cell.
                    let runs = points.chunks(cells as usize);
                    for run in runs.take(20) {
                        let mut seen = vec![false; cells as usize];
                        for x in run {
                            let cell = (x * cells as f64) as usize;
                            assert!(!std::mem::replace(&mut seen[cell], true), "{base} {cells}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn primes_are_prime() {
        assert_eq!(primes(10), [2, 3, 5, 7, 11, 13, 17, 19, 23, 29]);
        assert_eq!(primes(1024)[1023], 8161);
    }
}
