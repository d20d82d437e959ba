//! Radical inverses in any prime base, with their digits scrambled.

use super::hash::{splitmix, unit};
use super::{BELOW_ONE, Scramble};

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
    scale: f64,
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
            if power <= longest_table {
                (tabled, period) = (all, power);
            }
        }
        let digits = DigitMaps::new(scramble, key);
        let table = table(base, tabled, period.min(n) as usize, &digits);
        let rest = (all - tabled) as usize;
        let rest_scale = power / period;
        let tail = Tail::new(scramble, key);
        Self { base, digits, tail, table, tabled, period, rest_scale, rest, scale: power as f64 }
    }

    /// Overwrites coordinate `axis` of the row-major `points` with those of indices `first ..`.
    pub(super) fn fill(&self, first: u64, points: &mut [f64], axis: usize, dim: usize) {
        let (mut high, mut low) = (first / self.period, first % self.period);
        let mut digits = self.rest_digits(high);
        let mut common = self.mirror_rest(&digits, 0);
        for point in points.chunks_exact_mut(dim) {
            if low == self.period {
                (high, low) = (high + 1, 0);
                digits = self.rest_digits(high);
                common = self.mirror_rest(&digits, 0);
            }
            let own = self.digits.nested && self.rest > 0;
            let rest = if own { self.mirror_rest(&digits, low) } else { common };
            let mirrored = u64::from(self.table[low as usize]) * self.rest_scale + rest;
            let x = (mirrored as f64 + self.tail.at(mirrored)) / self.scale;
            point[axis] = x.min(BELOW_ONE);
            low += 1;
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

/// Mirrors and scrambles the first `digits` digits of 0 .. `len`, level by level.
fn table(base: u64, digits: u32, len: usize, maps: &DigitMaps) -> Vec<u32> {
    let mut table = vec![0u32; len];
    let mut width = 1;
    for level in 0..digits {
        let level_key = maps.level_key(level);
        for prefix in 0..width.min(len) {
            let (factor, start) = maps.map(level_key, base, prefix as u64);
            let base = base as u32;
            let before = table[prefix] * base;
            let mut digit = start;
            for entry in table[prefix..].iter_mut().step_by(width).take(base as usize) {
                *entry = before + digit;
                digit += factor;
                digit -= if digit >= base { base } else { 0 };
            }
        }
        width *= base as usize;
    }
    table
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
        RadicalInverse::new(base, n, scramble, 17, 9).fill(first, &mut points, 0, 1);
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
