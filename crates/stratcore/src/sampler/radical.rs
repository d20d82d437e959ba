//! Radical inverses in any prime base, with their digits scrambled.

use super::hash::{splitmix, unit};
use super::nested::{LANES, Nested};
use super::target::Target;
use super::{BELOW_ONE, Scramble};
use crate::rng::{Stream, unit_pair};
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
    /// The first digits of an index, mirrored and scrambled: entry r for index mod b^t. Where
    /// there are no others, with the tail. Behind the last is room to the end of a vector.
    table: Vec<f64>,
    len: usize,
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
    pub(super) fn new(base: u64, n: u64, scramble: Scramble, dim: usize) -> Self {
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
        let rest = (all - tabled) as usize;
        let len = period.min(n) as usize;
        Self {
            base,
            digits: DigitMaps { scramble, key: 0 },
            tail: Tail::Common(0.0),
            table: vec![0.0; len.next_multiple_of(LANES) + LANES],
            len,
            tabled,
            period,
            rest_scale: power / period,
            rest,
            scale: Divisor::new(power),
        }
    }

    /// Scrambles the digits under a key, which comes before any use.
    pub(super) fn scramble(&mut self, key: u64) {
        self.digits.key = key;
        self.tail = Tail::new(self.digits.scramble, key);
        let (isa, base, digits, len) = (Isa::detect(), self.base as usize, self.tabled, self.len);
        let (table, maps, has_tails) = (&mut self.table[..], &self.digits, self.rest == 0);
        if !maps.nested() {
            table[0] = 0.0;
            let tail = if has_tails { self.tail.common() } else { 0.0 };
            simd::run(isa, TableLoop { table, base, digits, len, maps, tail });
            return;
        }
        let stream = Stream::of_bits(maps.level_key(0));
        Nested { stream, base, digits, len, has_tails }.fill(isa, table);
    }

    /// Writes coordinate `axis` of the target's points with those of indices `first ..`.
    pub(super) fn fill(&self, isa: Isa, first: u64, target: &mut Target<'_>, axis: usize) {
        let n = target.len();
        let scale = self.scale;
        if self.rest == 0 {
            let sums = &self.table[first as usize..][..n];
            simd::run(isa, FractionLoop { sums, scale, target, axis, at: 0 });
            return;
        }
        let mut mirrored = [0.0; BLOCK];
        let mut at = 0;
        while at < n {
            let first = first + at as u64;
            // As far as the table goes without beginning anew.
            let low = first % self.period;
            let len = (BLOCK as u64).min(self.period - low).min((n - at) as u64) as usize;
            let sums = &mut mirrored[..len];
            self.mirror(first / self.period, low, sums);
            simd::run(isa, TailLoop { tail: &self.tail, first, sums });
            simd::run(isa, FractionLoop { sums, scale, target, axis, at });
            at += len;
        }
    }

    /// Mirrored and scrambled indices high·period + low ..
    fn mirror(&self, high: u64, low: u64, mirrored: &mut [f64]) {
        let digits = self.rest_digits(high);
        let own = self.digits.nested();
        let common = if own { 0 } else { self.mirror_rest(&digits, 0) };
        let table = &self.table[low as usize..];
        for ((low, mirrored), tabled) in (low..).zip(mirrored).zip(table) {
            let rest = if own { self.mirror_rest(&digits, low) } else { common };
            // Whole numbers below 2^46.
            *mirrored = tabled * self.rest_scale as f64 + rest as f64;
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
            let (factor, start) = self.digits.map(level, self.base as u32, prefix);
            let scrambled = (start + factor * digit) % self.base as u32;
            mirrored = mirrored * self.base + u64::from(scrambled);
            prefix += u64::from(digit) * width;
            width *= self.base;
        }
        mirrored
    }
}

/// Writes sum / scale for each sum to a coordinate of the target's points from number `at` on.
struct FractionLoop<'a, 'b> {
    sums: &'a [f64],
    scale: Divisor,
    target: &'a mut Target<'b>,
    axis: usize,
    at: usize,
}

impl Loop for FractionLoop<'_, '_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { sums, scale, target, axis, at } = self;
        let fraction = |sum: &f64| scale.divide::<FMA>(*sum).min(BELOW_ONE);
        target.put(axis, at, sums.iter().map(fraction));
    }
}

/// Appends one digit after the other to the table's first entry, so that there are `base` times
/// as many each time: one map for each position. Adds the tail.
struct TableLoop<'a> {
    /// Room behind the table's end: to the end of a vector.
    table: &'a mut [f64],
    base: usize,
    digits: u32,
    len: usize,
    maps: &'a DigitMaps,
    tail: f64,
}

impl Loop for TableLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { table, base, digits: levels, len, maps, tail } = self;
        let b = base as f64;
        let mut width = 1;
        for level in 0..levels {
            let (factor, constant) = maps.map(level, base as u32, 0);
            let (factor, constant) = (f64::from(factor), f64::from(constant));
            let known = width.min(len);
            let mut digit = constant;
            for at in (width..width * base).step_by(width).take_while(|at| *at < len) {
                digit += factor;
                digit = if digit >= b { digit - b } else { digit };
                let (before, entries) = table.split_at_mut(at);
                for (entry, before) in entries.iter_mut().zip(&before[..known]) {
                    *entry = *before * b + digit;
                }
            }
            for entry in &mut table[..known] {
                *entry = *entry * b + constant;
            }
            width *= base;
        }
        for sum in table {
            *sum += tail;
        }
    }
}

/// Which affine map a digit goes through.
struct DigitMaps {
    scramble: Scramble,
    key: u64,
}

impl DigitMaps {
    /// A map of its own for each value of the digits before.
    fn nested(&self) -> bool {
        self.scramble == Scramble::Owen
    }

    fn level_key(&self, level: u32) -> u64 {
        splitmix(self.key, level.into())
    }

    /// Factor and constant of the map of the digit at a level after the digits `prefix`, one that
    /// no [`Nested`] makes.
    #[inline(always)]
    fn map(&self, level: u32, base: u32, prefix: u64) -> (u32, u32) {
        let prefix = match self.scramble {
            Scramble::Owen => prefix,
            Scramble::DigitPermutation => 0,
            _ => return (1, 0),
        };
        let bits = splitmix(self.level_key(level), prefix);
        let upper = |half: u64, n: u32| (half.wrapping_mul(n.into()) >> 32) as u32;
        (upper(bits >> 32, base - 1).wrapping_add(1), upper(bits & 0xffff_ffff, base))
    }
}

/// All digits after those that tell the points apart, in units of the last of them. They are
/// zeros, scrambled.
pub(super) enum Tail {
    /// Scrambled by position, the same for all points; zero: not scrambled.
    Common(f64),
    /// Scrambled one by one: a uniform number for each index.
    Own(Stream),
}

impl Tail {
    pub(super) fn new(scramble: Scramble, key: u64) -> Self {
        let key = splitmix(key, u64::MAX);
        match scramble {
            Scramble::Owen => Self::Own(Stream::of_bits(key)),
            Scramble::DigitPermutation => Self::Common(unit(key)),
            _ => Self::Common(0.0),
        }
    }

    /// The one that all points share, if they do.
    fn common(&self) -> f64 {
        match self {
            Self::Common(tail) => *tail,
            Self::Own(_) => 0.0,
        }
    }

    /// Adds to `sums` the tails of indices `first ..`, below 2^32.
    #[inline(always)]
    pub(super) fn add(&self, first: u64, sums: &mut [f64]) {
        match self {
            Self::Common(tail) => {
                for sum in sums {
                    *sum += tail;
                }
            }
            Self::Own(stream) => {
                let mut draws = [[0; BLOCK]; 3];
                for (first, sums) in (first..).step_by(BLOCK).zip(sums.chunks_mut(BLOCK)) {
                    stream.draws(first, 1, sums.len(), &mut draws);
                    for (l, sum) in sums.iter_mut().enumerate() {
                        let [tail, _] = unit_pair([draws[0][l], draws[1][l], draws[2][l]]);
                        *sum += tail;
                    }
                }
            }
        }
    }
}

/// Adds to `sums` the tails of indices `first ..`
struct TailLoop<'a> {
    tail: &'a Tail,
    first: u64,
    sums: &'a mut [f64],
}

impl Loop for TailLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        self.tail.add(self.first, self.sums);
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
        let mut axis = RadicalInverse::new(base, n, scramble, 9);
        axis.scramble(17);
        axis.fill(Isa::detect(), first, target, 0);
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

    /// The nested maps by their definition: from digit to digit of one index.
    fn nested(base: u64, n: u64, index: u64) -> f64 {
        let stream = Stream::of_bits(DigitMaps { scramble: Scramble::Owen, key: 17 }.level_key(0));
        let b = base as f64;
        let [mut tail, mut turn] = stream.pair(0);
        let word = |index| {
            let [high, low, _] = stream.draw(index);
            u64::from(high) << 32 | u64::from(low)
        };
        let mut bits = word(0);
        let (mut cell, mut scale, mut prefix, mut rest) = (0, 1, 0, index);
        while scale < n.max(2) {
            let digit = rest % base;
            let constant = if base == 2 { bits >> 63 } else { (tail * b) as u64 };
            let factor = (turn * (b - 1.0)) as u64 + 1;
            cell = cell * base + (constant + factor * digit) % base;
            prefix += digit * scale;
            if digit == 0 {
                bits <<= 1;
                tail = (tail * b).fract();
                turn = (turn * (b - 1.0)).fract();
            } else {
                bits = word(prefix);
                [tail, turn] = stream.pair(prefix);
            }
            rest /= base;
            scale *= base;
        }
        if base == 2 {
            let digits = scale.trailing_zeros();
            return unit(cell << (64 - digits) | bits >> digits);
        }
        ((cell as f64 + tail) / scale as f64).min(BELOW_ONE)
    }

    #[test]
    fn nested_maps_follow_their_definition() {
        for base in [2, 3, 5, 31, 8161] {
            for n in [1, 2, 3, 4, 5, 9, 13, 64, 65, 100, 128, 200, 256, 700, 2187, 4096] {
                let points = coordinates(base, n, Scramble::Owen, 0, n as usize);
                for (index, x) in (0..).zip(points) {
                    let expected = nested(base, n, index);
                    assert_eq!(x.to_bits(), expected.to_bits(), "{base}, {n}: {index}");
                }
            }
        }
    }

    /// Over keys, each pair of points of b² lies in each pair of cells as often as nested uniform
    /// permutations would have it. Up to 20,000 counts, the bound is six standard deviations.
    #[test]
    fn nested_maps_are_fair_and_independent() {
        let keys = 20_000;
        for base in [2u64, 3, 5] {
            let n = base.pow(2);
            // Digits of the points, the first one and the second one.
            let mut counts = vec![0u32; (n * n * n * n) as usize];
            for key in 0..keys {
                let mut points = vec![0.0; n as usize];
                let target = &mut Target::Rows { points: &mut points, dim: 1 };
                let mut axis = RadicalInverse::new(base, n, Scramble::Owen, 9);
                axis.scramble(splitmix(23, key));
                axis.fill(Isa::detect(), 0, target, 0);
                let cell = |index: u64| (points[index as usize] * n as f64) as u64;
                for i in 0..n {
                    for j in 0..n {
                        counts[(((i * n + j) * n + cell(i)) * n + cell(j)) as usize] += 1;
                    }
                }
            }
            for (at, count) in (0..).zip(counts) {
                let [i, j, x, y] = [n * n * n, n * n, n, 1].map(|place| at / place % n);
                let share = match (i == j, i % base == j % base) {
                    (true, _) if x == y => 1.0 / n as f64,
                    (true, _) => 0.0,
                    // They share the first digit and differ in the second.
                    (_, true) if x / base == y / base && x != y => 1.0 / (n * (base - 1)) as f64,
                    (_, false) if x / base != y / base => 1.0 / (n * (n - base)) as f64,
                    _ => 0.0,
                };
                let (expected, count) = (share * keys as f64, f64::from(count));
                let off = (count - expected).abs();
                assert!(off <= 6.0 * expected.sqrt(), "{base}: {i} {j} {x} {y}: {count}");
            }
        }
    }

    #[test]
    fn primes_are_prime() {
        assert_eq!(primes(10), [2, 3, 5, 7, 11, 13, 17, 19, 23, 29]);
        assert_eq!(primes(1024)[1023], 8161);
    }
}
