//! Variance of the mean, measured by repeating one estimate.
//!
//! * Input: `trial_means`, shape `[M]`: the M independent estimates of one integral at one N,
//!   in the integrand's unit (linear radiance for a pixel).
//! * Output: unbiased (divisor M - 1), in that unit squared.
//! * Source: Mitchell 1996, "Experimental observations", second equation.
//!
//! How well the variance is known is in [`noise`](crate::noise).

use crate::simd::{self, Isa, Loop};
use serde::Serialize;

/// Count, mean, variance and shape of a set of numbers: all that intervals need of it. Two of
/// them [merge](Self::merge) into that of both sets.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Moments {
    /// How many numbers; 0 where mean and variance are computed and no numbers were drawn.
    pub count: u64,
    /// Their mean.
    pub mean: f64,
    /// Unbiased, divisor `count - 1`; 0 where they differ by no more than rounding.
    pub variance: f64,
    /// g₁ = m₃/m₂^(3/2) of these numbers, divisor `count`; 0 without a variance.
    pub skewness: f64,
    /// g₂ = m₄/m₂² - 3 of these numbers, divisor `count`; 0 without a variance.
    pub kurtosis: f64,
}

impl Moments {
    /// The moments of at least two finite numbers.
    ///
    /// Mean and deviations are taken in two passes over values shifted by the first, so a mean
    /// of 1e6 with a spread of 1e-3 loses nothing that the values have. Powers are taken in
    /// units of a power of two near the largest deviation: exact, and none leaves the range of
    /// numbers. The variance itself does where the spread is below 1e-154 or above 1e154:
    /// [`is_out_of_range`](Self::is_out_of_range).
    pub fn of(values: &[f64]) -> Self {
        debug_assert!(values.len() >= 2);
        let m = values.len() as f64;
        let pivot = values[0];
        let shift = neumaier_sum(values.iter().map(|x| x - pivot)) / m;
        let mean = pivot + shift;
        let (mut unit, mut powers) = (0.0, [CompensatedSums::default(); 3]);
        let (out_unit, sums) = (&mut unit, &mut powers);
        simd::run(Isa::detect(), PowerSums { values, pivot, shift, unit: out_unit, sums });
        let powers = powers.map(CompensatedSums::total);
        Self::from_sums(values.len() as u64, mean, unit, powers)
    }

    /// From sums of the second, third and fourth powers of deviations in `unit`s.
    fn from_sums(count: u64, mean: f64, unit: f64, [second, third, fourth]: [f64; 3]) -> Self {
        let m = count as f64;
        // A trial mean is a rounded number: equal trials may differ in their last bit or two,
        // which for subnormal means is the smallest number there is.
        let rounding = (2.0 * f64::EPSILON * mean.abs()).max(f64::from_bits(2));
        if second == 0.0 || (second / (m - 1.0)).sqrt() * unit <= rounding {
            return Self { count, mean, ..Self::default() };
        }
        Self {
            count,
            mean,
            variance: second / (m - 1.0) * unit * unit,
            skewness: m.sqrt() * third / second.powf(1.5),
            kurtosis: m * fourth / (second * second) - 3.0,
        }
    }

    /// Whether the numbers differ, but by so little or so much that their variance is no
    /// number of full precision.
    pub fn is_out_of_range(&self) -> bool {
        (self.skewness != 0.0 || self.kurtosis != 0.0) && !self.variance.is_normal()
    }

    /// The moments of both sets together (Chan, Golub & LeVeque 1979; Pébay 2008).
    #[must_use]
    pub fn merge(&self, other: &Self) -> Self {
        let (a, b) = (self.count as f64, other.count as f64);
        let n = a + b;
        let delta = other.mean - self.mean;
        let unit = delta.abs().max(self.variance.sqrt()).max(other.variance.sqrt());
        let mean = self.mean + delta * (b / n);
        let unit = if unit == 0.0 { 1.0 } else { unit };
        let d = delta / unit;
        // Sums of the second, third and fourth powers of deviations, in units.
        let sums = |m: &Self| {
            let squares = (m.variance / unit / unit) * (m.count as f64 - 1.0);
            let second = squares / m.count as f64;
            let third = m.skewness * second.powf(1.5) * m.count as f64;
            [squares, third, (m.kurtosis + 3.0) * second * second * m.count as f64]
        };
        let ([a2, a3, a4], [b2, b3, b4]) = (sums(self), sums(other));
        let squares = a2 + b2 + d * d * a * b / n;
        let third =
            a3 + b3 + d.powi(3) * a * b * (a - b) / (n * n) + 3.0 * d * (a * b2 - b * a2) / n;
        let fourth = a4
            + b4
            + d.powi(4) * a * b * (a * a - a * b + b * b) / n.powi(3)
            + 6.0 * d * d * (a * a * b2 + b * b * a2) / (n * n)
            + 4.0 * d * (a * b3 - b * a3) / n;
        Self::from_sums(self.count + other.count, mean, unit, [squares, third, fourth])
    }

    /// Fisher's G₂, the estimate of the population's excess kurtosis that is unbiased for
    /// normal samples. None without a variance, and below four numbers.
    pub fn excess_kurtosis(&self) -> Option<f64> {
        let m = self.count as f64;
        (self.variance > 0.0 && self.count >= 4)
            .then(|| (m - 1.0) / ((m - 2.0) * (m - 3.0)) * ((m + 1.0) * self.kurtosis + 6.0))
    }

    /// How many of the numbers are the rarer of two values, where there are two values and no
    /// more: exactly then kurtosis = skewness² - 2 (Pearson's bound).
    pub fn rarer_of_two(&self) -> Option<u64> {
        let square = self.skewness * self.skewness;
        if self.variance <= 0.0 || (self.kurtosis + 2.0 - square).abs() > 1e-9 * (square + 1.0) {
            return None;
        }
        // A share q has the skewness (1 - 2q)/√(q(1 - q)).
        let share = 0.5 - 0.5 * (square / (square + 4.0)).sqrt();
        Some(((share * self.count as f64).round() as u64).max(1))
    }
}

impl Default for Moments {
    fn default() -> Self {
        Self { count: 0, mean: 0.0, variance: 0.0, skewness: 0.0, kurtosis: 0.0 }
    }
}

/// The greatest power of two that is not above `x`, among those that have a reciprocal.
#[inline(always)]
fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(x.to_bits() & EXPONENT).max(f64::MIN_POSITIVE)
}

/// Values that are summed side by side: none waits for the one before.
const LANES: usize = 4;

/// Compensated sums, lane by lane, of the second, third and fourth powers of (x - pivot) - shift in
/// units of a power of two near the largest.
struct PowerSums<'a> {
    values: &'a [f64],
    pivot: f64,
    shift: f64,
    unit: &'a mut f64,
    sums: &'a mut [CompensatedSums; 3],
}

impl Loop for PowerSums<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Self { values, pivot, shift, unit, sums } = self;
        let (blocks, rest) = values.as_chunks::<LANES>();
        // What is missing of the last block counts as no deviation.
        let mut last = [0.0; LANES];
        last[..rest.len()].copy_from_slice(rest);
        let is_there: [bool; LANES] = std::array::from_fn(|l| l < rest.len());
        let deviation = |x: f64| (x - pivot) - shift;
        let mut largest = [0.0; LANES];
        for block in blocks {
            for (largest, x) in largest.iter_mut().zip(block) {
                let size = deviation(*x).abs();
                *largest = if size > *largest { size } else { *largest };
            }
        }
        for l in 0..LANES {
            let size = if is_there[l] { deviation(last[l]).abs() } else { 0.0 };
            largest[l] = if size > largest[l] { size } else { largest[l] };
        }
        *unit = power_of_two_below(largest.into_iter().fold(0.0, f64::max));
        let factor = unit.recip();
        let mut powers = [CompensatedSums::default(); 3];
        for block in blocks {
            add_powers(&mut powers, block.map(|x| deviation(x) * factor));
        }
        let deviations = |l: usize| if is_there[l] { deviation(last[l]) * factor } else { 0.0 };
        add_powers(&mut powers, std::array::from_fn(deviations));
        *sums = powers;
    }
}

/// Adds the powers of a deviation to the sums of its lane.
#[inline(always)]
fn add_powers([second, third, fourth]: &mut [CompensatedSums; 3], d: [f64; LANES]) {
    let (mut squares, mut cubes, mut fourths) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
    for l in 0..LANES {
        squares[l] = d[l] * d[l];
        cubes[l] = squares[l] * d[l];
        fourths[l] = squares[l] * squares[l];
    }
    second.add(squares);
    third.add(cubes);
    fourth.add(fourths);
}

/// A [`CompensatedSum`] for each lane.
#[derive(Clone, Copy, Default)]
struct CompensatedSums {
    sums: [f64; LANES],
    lost: [f64; LANES],
}

impl CompensatedSums {
    #[inline(always)]
    fn add(&mut self, values: [f64; LANES]) {
        let Self { sums, lost } = self;
        for l in 0..LANES {
            let mut one = CompensatedSum { sum: sums[l], lost: lost[l] };
            one.add(values[l]);
            (sums[l], lost[l]) = (one.sum, one.lost);
        }
    }

    /// The sum of all lanes.
    fn total(self) -> f64 {
        let mut total = CompensatedSum::default();
        for (lane, lost) in self.sums.into_iter().zip(self.lost) {
            total.add(lane);
            total.lost += lost;
        }
        total.total()
    }
}

/// Sum with Neumaier's compensation (1974): the error does not grow with the number of terms.
pub fn neumaier_sum(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut sum = CompensatedSum::default();
    values.into_iter().for_each(|value| sum.add(value));
    sum.total()
}

/// The same, a number at a time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CompensatedSum {
    sum: f64,
    lost: f64,
}

impl CompensatedSum {
    /// What rounding loses is found by Knuth's two-sum (1969), which need not know which of the
    /// two terms is the larger.
    #[inline(always)]
    pub(crate) fn add(&mut self, value: f64) {
        let next = self.sum + value;
        let added = next - self.sum;
        self.lost += (self.sum - (next - added)) + (value - added);
        self.sum = next;
    }

    pub(crate) fn total(self) -> f64 {
        self.sum + self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variance(values: &[f64]) -> f64 {
        Moments::of(values).variance
    }

    #[test]
    fn divisor_is_m_minus_one() {
        assert_eq!(variance(&[1.0, 3.0]), 2.0);
        assert_eq!(variance(&[1.0, 2.0, 3.0, 4.0]), 5.0 / 3.0);
    }

    #[test]
    fn a_bright_pixel_keeps_its_variance() {
        // Values representable at 1e6: steps of 2^-10 ≈ 1e-3.
        let small: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17) / 1024.0).collect();
        let bright: Vec<f64> = small.iter().map(|x| x + 1e6).collect();
        let (a, b) = (variance(&small), variance(&bright));
        assert!((a / b - 1.0).abs() < 1e-13, "{a} {b}");
    }

    #[test]
    fn the_scale_of_the_values_changes_nothing_else() {
        let means: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17)).collect();
        let one = Moments::of(&means);
        for exponent in [-500, -260, -30, 30, 260, 500] {
            let unit = 2f64.powi(exponent);
            let scaled = Moments::of(&means.iter().map(|x| x * unit).collect::<Vec<_>>());
            assert_eq!((scaled.skewness, scaled.kurtosis), (one.skewness, one.kurtosis));
            assert_eq!(scaled.variance, one.variance * unit * unit);
        }
    }

    #[test]
    fn equal_numbers_are_exact_even_in_the_last_bit() {
        let x = 0.1f64;
        assert_eq!(variance(&[x, x, x]), 0.0);
        assert_eq!(variance(&[x, x.next_up(), x]), 0.0);
        assert_eq!(variance(&[0.0, -0.0]), 0.0);
        assert!(variance(&[0.0, 1e-153]) > 0.0);
        // Beyond the range of a variance the shape still tells that the numbers differ.
        let tiny = Moments::of(&[0.0, 1e-200, 0.0]);
        assert!(tiny.variance == 0.0 && tiny.is_out_of_range());
        assert!(Moments::of(&[0.0, 1e160]).is_out_of_range());
        // Subnormal numbers that differ are no less different; in their last bit they are equal.
        let subnormal = Moments::of(&[0.0, 1e-310, 0.0]);
        assert!(subnormal.variance == 0.0 && subnormal.is_out_of_range());
        assert!(Moments::of(&[1e-312, 5e-320, 3e-316]).is_out_of_range());
        assert!(!Moments::of(&[1e-320, 1e-320f64.next_up()]).is_out_of_range());
        assert!(!Moments::of(&[0.5, 0.5]).is_out_of_range());
    }

    #[test]
    fn merging_gives_the_moments_of_both() {
        let all: Vec<f64> = (0..60).map(|i| f64::from(i * i % 23) + 100.0).collect();
        let whole = Moments::of(&all);
        for cut in [2, 7, 30, 58] {
            let parts = Moments::of(&all[..cut]).merge(&Moments::of(&all[cut..]));
            assert_eq!(parts.count, 60);
            for (a, b) in [
                (parts.mean, whole.mean),
                (parts.variance, whole.variance),
                (parts.skewness, whole.skewness),
                (parts.kurtosis, whole.kurtosis),
            ] {
                assert!((a - b).abs() < 1e-11 * b.abs().max(1.0), "cut {cut}: {a} {b}");
            }
        }
        let flat = Moments::of(&[5.0, 5.0]).merge(&Moments::of(&[5.0, 5.0, 5.0]));
        assert_eq!((flat.count, flat.mean, flat.variance), (5, 5.0, 0.0));
    }

    #[test]
    fn two_values_are_recognised_and_counted() {
        for rare in [1usize, 3, 25] {
            let mut values = vec![0.25; 50];
            values[..rare].fill(7.0);
            assert_eq!(Moments::of(&values).rarer_of_two(), Some(rare as u64));
        }
        assert_eq!(Moments::of(&[0.0, 0.5, 1.0, 1.0, 0.0]).rarer_of_two(), None);
        assert_eq!(Moments::of(&[1.0, 1.0]).rarer_of_two(), None);
        let many: Vec<f64> = (0..1_000_000).map(|i| f64::from(u8::from(i < 3))).collect();
        assert_eq!(Moments::of(&many).rarer_of_two(), Some(3));
    }

    #[test]
    fn compensation_survives_cancellation() {
        assert_eq!(neumaier_sum([1e100, 1.0, -1e100]), 1.0);
        assert_eq!(neumaier_sum(std::iter::repeat_n(0.1, 1000)), 100.0);
    }
}
