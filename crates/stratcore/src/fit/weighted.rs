//! Generalised least squares with the known noise of each row.

use super::{Fit, Line, line};
use crate::noise::Noise;
use serde::Serialize;

/// What a weighted fit knows of one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedRow {
    /// N
    pub n: u64,
    /// s², above zero.
    pub variance: f64,
    /// How s² scatters about the true variance.
    pub noise: Noise,
}

impl WeightedRow {
    /// (ln N, ln of the variance without the bias of its logarithm).
    pub(super) fn point(&self) -> (f64, f64) {
        ((self.n as f64).ln(), self.noise.ln_variance(self.variance))
    }
}

pub(super) fn weights(rows: &[WeightedRow]) -> Vec<f64> {
    super::weights(rows.iter().map(|row| row.noise.var_ln()).collect())
}

/// The generalised least-squares line. Fewer than two different N have no slope.
///
/// The rows are independent, so the covariance of their logarithms is diagonal. The bias of
/// each ln s² is removed first. The standard error is that of the slope under the rows' own
/// variances, not only under those that the weights were made of.
pub fn weighted_fit(rows: &[WeightedRow]) -> Option<Fit> {
    let points: Vec<_> = rows.iter().map(WeightedRow::point).collect();
    let counts: Vec<u64> = rows.iter().map(|row| row.n).collect();
    let weights = weights(rows);
    let line = line(&points, &weights)?;
    let std_error = line.std_error(rows.iter().map(|row| row.noise.var_ln()));
    let chi2 = chi2(&line, &points, &weights, std_error);
    line.fit(&counts, std_error, chi2)
}

/// The exponent that the fit of `rows` would give to other variances at the same N: what it
/// estimates when `variances` are the true ones.
pub fn exponent_of(rows: &[WeightedRow], variances: &[f64]) -> Option<f64> {
    let points: Vec<_> =
        rows.iter().zip(variances).map(|(row, v)| ((row.n as f64).ln(), v.ln())).collect();
    Some(-line(&points, &weights(rows))?.slope)
}

/// NaN for rows without noise: every residual is then infinitely unlikely, and the number
/// would only say how small the weights were.
fn chi2(line: &Line, points: &[(f64, f64)], weights: &[f64], std_error: f64) -> f64 {
    if std_error == 0.0 {
        return f64::NAN;
    }
    points.iter().zip(weights).map(|(p, w)| w * line.residual(*p).powi(2)).sum()
}

/// The exponent between two neighbouring N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LocalSlope {
    /// The smaller N.
    pub n_lo: u64,
    /// The larger N.
    pub n_hi: u64,
    /// p between them.
    pub exponent: f64,
    /// Its standard error. Neighbouring slopes share a row and are not independent.
    pub std_error: f64,
}

/// The exponents between neighbouring rows, which are in the order of N.
pub fn local_slopes(rows: &[WeightedRow]) -> Vec<LocalSlope> {
    let between = |pair: &[WeightedRow]| {
        let [(x0, y0), (x1, y1)] = [pair[0].point(), pair[1].point()];
        let variance = pair[0].noise.var_ln() + pair[1].noise.var_ln();
        LocalSlope {
            n_lo: pair[0].n,
            n_hi: pair[1].n,
            exponent: (y0 - y1) / (x1 - x0),
            std_error: variance.sqrt() / (x1 - x0),
        }
    };
    rows.windows(2).map(between).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(n: u64, variance: f64, noise: Noise) -> WeightedRow {
        WeightedRow { n, variance, noise }
    }

    #[test]
    fn a_planted_exponent_comes_back_whatever_the_weights() {
        let noise = |n| Noise::ChiSquare { dof: if n < 50 { 9.0 } else { 900.0 } };
        // ln s² is biased; the planted values are biased as much.
        let planted = |n: u64| {
            let unbiased = noise(n).ln_variance(1.0);
            (n as f64).powf(-1.5) / unbiased.exp()
        };
        let rows: Vec<_> = (1..=16).map(|k| row(k * k, planted(k * k), noise(k * k))).collect();
        let fit = weighted_fit(&rows).unwrap();
        assert!((fit.exponent - 1.5).abs() < 1e-12 && fit.log10_constant.abs() < 1e-12, "{fit:?}");
        assert!(fit.chi2 < 1e-20);
        for slope in local_slopes(&rows) {
            assert!((slope.exponent - 1.5).abs() < 1e-9, "{slope:?}");
        }
    }

    #[test]
    fn noisy_rows_pull_less() {
        let mut rows: Vec<_> = (1..=16)
            .map(|k| row(k * k, 1.0 / (k * k) as f64, Noise::ChiSquare { dof: 49.0 }))
            .collect();
        rows[0] = row(1, 20.0, Noise::ChiSquare { dof: 1.0 });
        let weighted = weighted_fit(&rows).unwrap();
        rows[0].noise = Noise::ChiSquare { dof: 49.0 };
        let alike = weighted_fit(&rows).unwrap();
        assert!((weighted.exponent - 1.0).abs() < 0.5 * (alike.exponent - 1.0), "{weighted:?}");
    }

    #[test]
    fn rows_without_noise_make_a_plain_line_without_error() {
        let rows: Vec<_> = (1..=5)
            .map(|k| row(k, (k as f64).powi(-2) * (1.0 + 0.01 * k as f64), Noise::None))
            .collect();
        let fit = weighted_fit(&rows).unwrap();
        assert!(fit.std_error == 0.0 && fit.chi2.is_nan() && fit.p_value().is_none());
        assert!(weighted_fit(&rows[..1]).is_none() && weighted_fit(&[]).is_none());
    }
}
