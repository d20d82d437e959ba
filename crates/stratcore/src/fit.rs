//! The exponent p of `variance_of_mean ~ C N^-p`, by least squares in log space.
//!
//! Source: Mitchell 1996, Figure 3; the standard error is ours.

use crate::variance::Spread;
use serde::Serialize;

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
}

/// The N, at least 1, from which on a line C N^-p promises a standard error of no more than
/// `error`; none for a line that does not fall.
pub fn samples_needed(exponent: f64, log10_constant: f64, error: f64) -> Option<f64> {
    let log10_n = (log10_constant - 2.0 * error.log10()) / exponent;
    (exponent > 0.0).then(|| 10f64.powf(log10_n).max(1.0))
}

/// The paper's fit: an unweighted line through the rows (N, spread) that have a variance.
/// Fewer than two such rows, or one N only, have no slope.
///
/// Each ln s² has its own known variance vᵢ, so with x = ln N the slope's variance is
/// Σ (xᵢ - x̄)² vᵢ / (Σ (xᵢ - x̄)²)². For M = 50 normal trials at N = 1, 4, …, 256 that is
/// 0.033².
pub fn fit<'a>(rows: impl IntoIterator<Item = (u64, &'a Spread)>) -> Option<Fit> {
    let rows: Vec<_> = rows
        .into_iter()
        .filter(|(_, s)| s.variance_of_mean > 0.0)
        .map(|(n, s)| (n, (n as f64).ln(), s.variance_of_mean.ln(), s.var_ln))
        .collect();
    let count = rows.len() as f64;
    let x_mean = rows.iter().map(|r| r.1).sum::<f64>() / count;
    let y_mean = rows.iter().map(|r| r.2).sum::<f64>() / count;
    let sxx: f64 = rows.iter().map(|r| (r.1 - x_mean).powi(2)).sum();
    if rows.len() < 2 || sxx == 0.0 {
        return None;
    }
    let sxy: f64 = rows.iter().map(|r| (r.1 - x_mean) * (r.2 - y_mean)).sum();
    let slope = sxy / sxx;
    let ln_constant = y_mean - slope * x_mean;
    let slope_var = rows.iter().map(|r| (r.1 - x_mean).powi(2) * r.3).sum::<f64>() / (sxx * sxx);
    let std_error = slope_var.sqrt();
    let chi2 = rows.iter().map(|r| (r.2 - ln_constant - slope * r.1).powi(2) / r.3).sum();
    let half_width = 1.959_963_985 * std_error;
    Some(Fit {
        exponent: -slope,
        std_error,
        ci95: [-slope - half_width, -slope + half_width],
        log10_constant: ln_constant / std::f64::consts::LN_10,
        n_min: rows.iter().map(|r| r.0).min()?,
        n_max: rows.iter().map(|r| r.0).max()?,
        points: rows.len(),
        chi2,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(variance: f64) -> Spread {
        Spread { grand_mean: 0.5, variance_of_mean: variance, var_ln: 2.0 / 49.0 }
    }

    #[test]
    fn a_planted_exponent_comes_back() {
        for p in [0.0, 0.01, 1.0, 1.5, 2.0, 3.0, 5.0] {
            let rows: Vec<_> =
                (1..=16u64).map(|k| (k * k, row(0.3 * ((k * k) as f64).powf(-p)))).collect();
            let fit = fit(rows.iter().map(|(n, s)| (*n, s))).unwrap();
            assert!((fit.exponent - p).abs() < 1e-12);
            assert!((fit.log10_constant - 0.3f64.log10()).abs() < 1e-12);
            assert!(fit.chi2 < 1e-20);
            assert!((fit.std_error - 0.0334).abs() < 1e-3, "{}", fit.std_error);
            assert!((fit.variance_at(9.0) / (0.3 * 9f64.powf(-p)) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn samples_needed_lie_on_the_line() {
        // 0.1 N^-1.5 = 0.01^2 at N = 1000^(2/3) = 100.
        assert!((samples_needed(1.5, -1.0, 0.01).unwrap() - 100.0).abs() < 1e-9);
        assert_eq!(samples_needed(1.5, -1.0, 10.0), Some(1.0));
        assert_eq!(samples_needed(0.0, -1.0, 0.01), None);
    }

    #[test]
    fn zero_variance_rows_are_left_out_and_one_row_is_no_fit() {
        let rows = [(1, row(1.0)), (4, row(0.0)), (9, row(1.0 / 9.0))];
        let found = fit(rows.iter().map(|(n, s)| (*n, s))).unwrap();
        assert_eq!(found.points, 2);
        assert!((found.exponent - 1.0).abs() < 1e-12);
        assert!(fit(rows[..2].iter().map(|(n, s)| (*n, s))).is_none());
        assert!(fit([(4, &row(1.0)), (4, &row(2.0))]).is_none());
        assert!(fit(std::iter::empty()).is_none());
    }
}
