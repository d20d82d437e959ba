//! The exponent p of `variance_of_mean ~ C N^-p`, by least squares in log space.
//!
//! [`power_law`] is the line of Mitchell 1996, Figure 3: every row counts alike.
//! [`weighted_fit`] is generalised least squares with the known noise of each row; where its
//! residuals show that no single slope describes the rows, [`two_terms`] fits a sum of two.

mod two_terms;
mod weighted;

pub use two_terms::{TwoTerms, two_terms};
pub use weighted::{
    LocalSlope, WeightedRow, both_fits, exponent_of, local_slopes, paper_fit, weighted_fit,
};

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Half the width of a normal 95 % interval, in standard errors.
pub(crate) const Z95: f64 = 1.959_963_984_540_054;

/// A straight line through (ln N, ln s²).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Fit {
    /// p
    pub exponent: f64,
    /// Standard error of p, from the variances of the ln s² and not from the residuals.
    pub std_error: f64,
    /// Ends of the 95 % interval of p.
    pub ci95: [f64; 2],
    /// log₁₀ C
    pub log10_constant: f64,
    /// Smallest N in the fit.
    pub n_min: u64,
    /// Largest N in the fit.
    pub n_max: u64,
    /// Rows in the fit: those with a variance above zero.
    pub points: usize,
    /// Σ (residual² / Var ln s²); about `points - 2` where one slope describes the rows.
    pub chi2: f64,
}

impl Fit {
    /// The line's value at N.
    pub fn variance_at(&self, n: f64) -> f64 {
        10f64.powf(self.log10_constant - self.exponent * n.log10())
    }

    /// How often rows with one slope would have residuals as large as these by chance; none
    /// for a fit without residuals.
    pub fn p_value(&self) -> Option<f64> {
        chi2_p_value(self.chi2, self.points.checked_sub(2)?)
    }
}

/// The N, at least 1, from which on a line C N^-p promises a standard error of no more than
/// `error`; none for a line that does not fall.
pub fn samples_needed(exponent: f64, log10_constant: f64, error: f64) -> Option<f64> {
    let log10_n = (log10_constant - 2.0 * error.log10()) / exponent;
    (exponent > 0.0).then(|| 10f64.powf(log10_n).max(1.0))
}

/// How often a chi-square of `dof` degrees of freedom is above `chi2`; none for 0 degrees, or
/// where `chi2` is no number.
fn chi2_p_value(chi2: f64, dof: usize) -> Option<f64> {
    if chi2.is_nan() {
        return None;
    }
    ChiSquared::new(dof as f64).ok().map(|law| law.sf(chi2.max(0.0)))
}

/// One over the variance of each row's logarithm, but none heavier than two rows of the median
/// variance: where a few rows are known far better than the others (two-valued samples at
/// N = 1), they do not pin a line that is only nearly straight. Rows without noise weigh alike.
fn weights(variances: Vec<f64>) -> Vec<f64> {
    let mut sorted = variances.clone();
    sorted.sort_by(f64::total_cmp);
    match sorted.get(sorted.len() / 2) {
        Some(median) if *median > 0.0 => {
            variances.into_iter().map(|v| v.max(0.5 * median).recip()).collect()
        }
        _ => vec![1.0; variances.len()],
    }
}

/// A line through points (x, y) with positive weights.
struct Line {
    slope: f64,
    intercept: f64,
    /// Derivative of the slope by each y.
    influence: Vec<f64>,
}

/// Least squares; none for fewer than two different x.
fn line(points: &[(f64, f64)], weights: &[f64]) -> Option<Line> {
    let total: f64 = weights.iter().sum();
    let mean = |value: fn(&(f64, f64)) -> f64| {
        points.iter().zip(weights).map(|(p, w)| w * value(p)).sum::<f64>() / total
    };
    let (x_mean, y_mean) = (mean(|p| p.0), mean(|p| p.1));
    let pull: Vec<f64> = points.iter().zip(weights).map(|(p, w)| w * (p.0 - x_mean)).collect();
    let sxx: f64 = points.iter().zip(&pull).map(|(p, a)| a * (p.0 - x_mean)).sum();
    if points.len() < 2 || sxx == 0.0 {
        return None;
    }
    let influence: Vec<f64> = pull.iter().map(|a| a / sxx).collect();
    let slope = points.iter().zip(&influence).map(|(p, a)| a * (p.1 - y_mean)).sum();
    Some(Line { slope, intercept: y_mean - slope * x_mean, influence })
}

impl Line {
    fn residual(&self, (x, y): (f64, f64)) -> f64 {
        y - self.intercept - self.slope * x
    }

    /// Standard error of the slope, whatever the weights, from the variances of the y.
    fn std_error(&self, variances: impl Iterator<Item = f64>) -> f64 {
        self.influence.iter().zip(variances).map(|(a, v)| a * a * v).sum::<f64>().sqrt()
    }

    fn fit(&self, counts: &[u64], std_error: f64, chi2: f64) -> Option<Fit> {
        let exponent = -self.slope;
        Some(Fit {
            exponent,
            std_error,
            ci95: [exponent - Z95 * std_error, exponent + Z95 * std_error],
            log10_constant: self.intercept / std::f64::consts::LN_10,
            n_min: *counts.iter().min()?,
            n_max: *counts.iter().max()?,
            points: counts.len(),
            chi2,
        })
    }
}

/// The paper's fit: an unweighted line through rows (N, value, variance of ln value) of a
/// quantity that falls as a power of N. Rows whose value is not above zero have no logarithm and
/// stay out; fewer than two rows, or one N only, have no slope.
///
/// Each ln value has its own known variance vᵢ, so with x = ln N the slope's variance is
/// Σ (xᵢ - x̄)² vᵢ / (Σ (xᵢ - x̄)²)². For variances from M = 50 normal trials at
/// N = 1, 4, …, 256 that is 0.033².
pub fn power_law(rows: impl IntoIterator<Item = (u64, f64, f64)>) -> Option<Fit> {
    let rows: Vec<_> = rows.into_iter().filter(|(_, value, _)| *value > 0.0).collect();
    let counts: Vec<u64> = rows.iter().map(|(n, ..)| *n).collect();
    let points: Vec<_> = rows.iter().map(|(n, value, _)| ((*n as f64).ln(), value.ln())).collect();
    let variances = || rows.iter().map(|(.., var_ln)| *var_ln);
    line_alike(&counts, &points, variances(), &weights(variances().collect()))
}

/// An unweighted line through (ln N, ln value) with these variances of ln value; the weights
/// are for its residuals alone.
fn line_alike(
    counts: &[u64],
    points: &[(f64, f64)],
    variances: impl Iterator<Item = f64>,
    weights: &[f64],
) -> Option<Fit> {
    let line = line(points, &vec![1.0; points.len()])?;
    let std_error = line.std_error(variances);
    let squares = points.iter().zip(weights).map(|(p, w)| w * line.residual(*p).powi(2));
    line.fit(counts, std_error, squares.sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    const VAR_LN: f64 = 2.0 / 49.0;

    #[test]
    fn samples_needed_lie_on_the_line() {
        // 0.1 N^-1.5 = 0.01^2 at N = 1000^(2/3) = 100.
        assert!((samples_needed(1.5, -1.0, 0.01).unwrap() - 100.0).abs() < 1e-9);
        assert_eq!(samples_needed(1.5, -1.0, 10.0), Some(1.0));
        assert_eq!(samples_needed(0.0, -1.0, 0.01), None);
    }

    #[test]
    fn a_planted_exponent_comes_back() {
        for p in [0.0, 0.01, 1.0, 1.5, 2.0, 3.0, 5.0] {
            let rows: Vec<_> =
                (1..=16u64).map(|k| (k * k, 0.3 * ((k * k) as f64).powf(-p), VAR_LN)).collect();
            let fit = power_law(rows).unwrap();
            assert!((fit.exponent - p).abs() < 1e-12);
            assert!((fit.log10_constant - 0.3f64.log10()).abs() < 1e-12);
            assert!(fit.chi2 < 1e-20);
            assert!((fit.std_error - 0.0334).abs() < 1e-3, "{}", fit.std_error);
            assert!((fit.variance_at(9.0) / (0.3 * 9f64.powf(-p)) - 1.0).abs() < 1e-12);
            assert!(fit.p_value().unwrap() > 0.999);
        }
    }

    #[test]
    fn zero_variance_rows_are_left_out_and_one_row_is_no_fit() {
        let rows = [(1, 1.0, VAR_LN), (4, 0.0, VAR_LN), (9, 1.0 / 9.0, VAR_LN)];
        let found = power_law(rows).unwrap();
        assert_eq!(found.points, 2);
        assert!((found.exponent - 1.0).abs() < 1e-12);
        assert_eq!(found.p_value(), None);
        assert!(power_law(rows[..2].iter().copied()).is_none());
        assert!(power_law([(4, 1.0, VAR_LN), (4, 2.0, VAR_LN)]).is_none());
        assert!(power_law(std::iter::empty()).is_none());
    }

    #[test]
    fn p_values_match_tables() {
        // Chi-square of 14 degrees of freedom: 5 % above 23.685, 1 % above 29.141.
        assert!((chi2_p_value(23.685, 14).unwrap() - 0.05).abs() < 1e-4);
        assert!((chi2_p_value(29.141, 14).unwrap() - 0.01).abs() < 1e-4);
        assert_eq!(chi2_p_value(1.0, 0), None);
        assert_eq!(chi2_p_value(f64::NAN, 3), None);
    }
}
