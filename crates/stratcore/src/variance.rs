//! Variance of the mean, measured by repeating one estimate, and its interval.
//!
//! * Input: `trial_means`, shape `[M]`: the M independent estimates of one integral at one N,
//!   in the integrand's unit (linear radiance for a pixel).
//! * Output: unbiased (divisor M - 1), in that unit squared.
//! * Source: Mitchell 1996, "Experimental observations", second equation.

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The spread of M trial means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Mean of the trial means.
    pub grand_mean: f64,
    /// Mitchell's σ²: divisor M - 1. Exactly 0 where the trials differ by no more than rounding.
    pub variance_of_mean: f64,
    /// Variance of ln s², from M and the trial means' kurtosis; what weights a fit.
    pub var_ln: f64,
}

impl Spread {
    /// Ends of the 95 % interval of the variance; equal to it where it is 0 or not measured but
    /// known (`var_ln` = 0).
    pub fn ci95(&self) -> [f64; 2] {
        if self.variance_of_mean == 0.0 || self.var_ln == 0.0 {
            return [self.variance_of_mean; 2];
        }
        interval(self.variance_of_mean, 2.0 / self.var_ln)
    }
}

/// Measures the spread of at least two finite trial means.
///
/// The mean and the sum of squared deviations are taken in two passes over values shifted by
/// the first, so a mean of 1e6 with a spread of 1e-3 loses nothing that the values have.
///
/// For a population of excess kurtosis κ, Var(s²)/σ⁴ = 2/(M - 1) + κ/M. With κ estimated from
/// the trials (unbiased for normal ones), s² is taken for a scaled chi-square with as many
/// degrees of freedom as give it that variance (Box 1953): for normal trials the familiar
/// M - 1, fewer for heavy tails, more for a Bernoulli pixel.
pub fn spread(trial_means: &[f64]) -> Spread {
    let m = trial_means.len() as f64;
    debug_assert!(trial_means.len() >= 2);
    let pivot = trial_means[0];
    let shift = neumaier_sum(trial_means.iter().map(|x| x - pivot)) / m;
    let grand_mean = pivot + shift;
    let deviation = |x: &f64| (x - pivot) - shift;
    // Powers are taken in units of a power of two near the largest deviation: exact, and no
    // fourth power leaves the range of numbers.
    let largest = trial_means.iter().map(|x| deviation(x).abs()).fold(0.0, f64::max);
    let unit = if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
    let power = |n| neumaier_sum(trial_means.iter().map(|x| (deviation(x) / unit).powi(n)));
    let squares = power(2);
    let variance = squares / (m - 1.0) * unit * unit;
    // A trial mean is a rounded number: equal trials may differ in their last bit or two.
    let rounding = 2.0 * f64::EPSILON * grand_mean.abs();
    if variance <= rounding * rounding {
        let var_ln = var_ln_of_normal(m);
        return Spread { grand_mean, variance_of_mean: 0.0, var_ln };
    }
    let var_ln = var_ln(m, excess_kurtosis(m, squares, power(4)));
    Spread { grand_mean, variance_of_mean: variance, var_ln }
}

/// 95 % interval of a variance known by a chi-square of `dof` degrees of freedom.
fn interval(variance: f64, dof: f64) -> [f64; 2] {
    let Ok(chi) = ChiSquared::new(dof) else { return [f64::NAN; 2] };
    [0.975, 0.025].map(|q| variance * dof / chi.inverse_cdf(q))
}

/// Fisher's G2, unbiased for normal samples; 0 below four values, where it does not exist.
fn excess_kurtosis(m: f64, squares: f64, fourth: f64) -> f64 {
    if m < 4.0 || squares == 0.0 {
        return 0.0;
    }
    let g2 = m * fourth / (squares * squares) - 3.0;
    (m - 1.0) / ((m - 2.0) * (m - 3.0)) * ((m + 1.0) * g2 + 6.0)
}

fn var_ln_of_normal(m: f64) -> f64 {
    2.0 / (m - 1.0)
}

fn var_ln(m: f64, excess_kurtosis: f64) -> f64 {
    // Two-point trials (excess -2) have the least variance there is; an estimate from few
    // trials can fall below even that, and no interval should shrink to nothing for it.
    (var_ln_of_normal(m) + excess_kurtosis / m).max(0.1 * var_ln_of_normal(m))
}

/// Sum with Neumaier's compensation (1974): the error does not grow with the number of terms.
pub fn neumaier_sum(values: impl IntoIterator<Item = f64>) -> f64 {
    let (mut sum, mut lost) = (0.0f64, 0.0f64);
    for value in values {
        let next = sum + value;
        lost += if sum.abs() >= value.abs() { (sum - next) + value } else { (value - next) + sum };
        sum = next;
    }
    sum + lost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divisor_is_m_minus_one() {
        assert_eq!(spread(&[1.0, 3.0]).variance_of_mean, 2.0);
        assert_eq!(spread(&[1.0, 2.0, 3.0, 4.0]).variance_of_mean, 5.0 / 3.0);
    }

    #[test]
    fn a_bright_pixel_keeps_its_variance() {
        // Values representable at 1e6: steps of 2^-10 ≈ 1e-3.
        let small: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17) / 1024.0).collect();
        let bright: Vec<f64> = small.iter().map(|x| x + 1e6).collect();
        let (a, b) = (spread(&small).variance_of_mean, spread(&bright).variance_of_mean);
        assert!((a / b - 1.0).abs() < 1e-13, "{a} {b}");
    }

    #[test]
    fn the_scale_of_the_values_changes_nothing_else() {
        let means: Vec<f64> = (0..50).map(|i| f64::from(i * i % 17)).collect();
        let one = spread(&means);
        for exponent in [-500, -260, -30, 30, 260, 500] {
            let unit = 2f64.powi(exponent);
            let scaled = spread(&means.iter().map(|x| x * unit).collect::<Vec<_>>());
            assert_eq!(scaled.var_ln, one.var_ln, "2^{exponent}");
            assert_eq!(scaled.variance_of_mean, one.variance_of_mean * unit * unit);
        }
    }

    #[test]
    fn equal_trials_are_exact_even_in_the_last_bit() {
        let x = 0.1f64;
        assert_eq!(spread(&[x, x, x]).variance_of_mean, 0.0);
        assert_eq!(spread(&[x, x.next_up(), x]).variance_of_mean, 0.0);
        assert_eq!(spread(&[0.0, -0.0]).variance_of_mean, 0.0);
        assert!(spread(&[0.0, 1e-160]).variance_of_mean > 0.0);
    }

    #[test]
    fn normal_interval_is_the_chi_square_one() {
        // 49 degrees of freedom: quantiles 31.555 and 70.222 (tables).
        let [lo, hi] = interval(1.0, 49.0);
        assert!((lo - 49.0 / 70.222).abs() < 1e-4 && (hi - 49.0 / 31.555).abs() < 1e-4);
    }

    #[test]
    fn compensation_survives_cancellation() {
        assert_eq!(neumaier_sum([1e100, 1.0, -1e100]), 1.0);
        assert_eq!(neumaier_sum(std::iter::repeat_n(0.1, 1000)), 100.0);
    }
}
