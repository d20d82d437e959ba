//! Radical inverses in any prime base, with their digits scrambled.

use super::hash::{splitmix, unit};
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

    /// Overwrites coordinate `axis` of the row-major `points` with those of indices `first ..`.
    pub(super) fn fill(&self, isa: Isa, first: u64, points: &mut [f64], axis: usize, dim: usize) {
        let mut first = first;
        let mut rest = points;
        let mut mirrored = [0; BLOCK];
        while !rest.is_empty() {
            // As far as the table goes without beginning anew.
            let low = first % self.period;
            let len = (BLOCK as u64).min(self.period - low) as usize;
            let run;
            (run, rest) = rest.split_at_mut((len * dim).min(rest.len()));
            let len = run.len() / dim;
            self.mirror(first / self.period, low, &mut mirrored[..len]);
            let (tail, scale) = (&self.tail, self.scale);
            simd::run(isa, FractionLoop { cells: &mirrored[..len], tail, scale, run, axis, dim });
            first += len as u64;
        }
    }

    /// Mirrored and scrambled indices high·period + low ..
    fn mirror(&self, high: u64, low: u64, mirrored: &mut [u64]) {
        let digits = self.rest_digits(high);
        let own = self.digits.nested && self.rest > 0;
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
            let (factor, start) = self.digits.map(self.digits.level_key(level), self.base, prefix);
            let scrambled = (start + factor * digit) % self.base as u32;
            mirrored = mirrored * self.base + u64::from(scrambled);
            prefix += u64::from(digit) * width;
            width *= self.base;
        }
        mirrored
    }
}

/// Writes (cell + tail) / scale for each cell to one coordinate of the points of a run.
pub(super) struct FractionLoop<'a> {
    pub(super) cells: &'a [u64],
    pub(super) tail: &'a Tail,
    pub(super) scale: Divisor,
    pub(super) run: &'a mut [f64],
    pub(super) axis: usize,
    pub(super) dim: usize,
}

impl Loop for FractionLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { cells, tail, scale, run, axis, dim } = self;
        for (point, &cell) in run.chunks_exact_mut(dim).zip(cells) {
            let x = scale.divide::<FMA>(cell as f64 + tail.at(cell));
            point[axis] = x.min(BELOW_ONE);
        }
    }
}

/// Mirrors and scrambles the first `digits` digits of 0 .. `len`, level by level.
fn table(isa: Isa, base: u64, digits: u32, len: usize, maps: &DigitMaps) -> Vec<u32> {
    let mut table = vec![0u32; len];
    let mut width = 1;
    for level in 0..digits {
        let level_key = maps.level_key(level);
        simd::run(isa, LevelLoop { table: &mut table, width, base, level_key, maps });
        width *= base as usize;
    }
    table
}

/// Appends one digit to the table's first `width` entries, so that there are `base` as many.
struct LevelLoop<'a> {
    table: &'a mut [u32],
    width: usize,
    base: u64,
    level_key: u64,
    maps: &'a DigitMaps,
}

impl Loop for LevelLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { table, width, base, level_key, maps } = self;
        let base32 = base as u32;
        for block in (0..width.min(table.len())).step_by(BLOCK) {
            let len = BLOCK.min(width - block).min(table.len() - block);
            let (mut digits, mut before) = ([(0, 0); BLOCK], [0; BLOCK]);
            let (digits, before) = (&mut digits[..len], &mut before[..len]);
            for (prefix, map) in (block as u64..).zip(digits.iter_mut()) {
                *map = maps.map(level_key, base, prefix);
            }
            for (before, entry) in before.iter_mut().zip(&table[block..]) {
                *before = entry * base32;
            }
            for at in (block..table.len()).step_by(width).take(base as usize) {
                let states = digits.iter_mut().zip(before.iter());
                for (entry, ((factor, digit), before)) in table[at..].iter_mut().zip(states) {
                    *entry = before + *digit;
                    let next = *digit + *factor;
                    *digit = if next >= base32 { next - base32 } else { next };
                }
            }
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

    /// Factor and constant of the map of the digit at a level after the digits `prefix`.
    #[inline(always)]
    fn map(&self, level_key: u64, base: u64, prefix: u64) -> (u32, u32) {
        if !self.scrambled {
            return (1, 0);
        }
        let bits = splitmix(level_key, if self.nested { prefix } else { 0 });
        let factor = 1 + (((bits >> 32) * (base - 1)) >> 32);
        (factor as u32, (((bits & 0xffff_ffff) * base) >> 32) as u32)
    }
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

    #[inline(always)]
    pub(super) fn at(&self, cell: u64) -> f64 {
        match self {
            Self::Zero => 0.0,
            Self::Common(tail) => *tail,
            Self::Own(key) => unit(splitmix(*key, cell)),
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
        RadicalInverse::new(base, n, scramble, 17, 9).fill(Isa::detect(), first, &mut points, 0, 1);
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
