//! Generalised least squares with the known noise of each row.

use super::{Fit, Line, line};
use crate::noise::Noise;
use serde::Serialize;

/// What fits know of one row: its logarithms are taken once for all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedRow {
    /// N
    pub n: u64,
    /// s², above zero.
    pub variance: f64,
    /// Variance of ln s² ([`Noise::var_ln`]).
    pub var_ln: f64,
    ln_n: f64,
    ln_s2: f64,
    /// ln s² without its bias ([`Noise::ln_variance`]).
    ln_variance: f64,
}

impl WeightedRow {
    /// A row whose s², above zero, scatters about the true variance as `noise` says.
    pub fn new(n: u64, variance: f64, noise: Noise) -> Self {
        Self {
            n,
            variance,
            var_ln: noise.var_ln(),
            ln_n: (n as f64).ln(),
            ln_s2: variance.ln(),
            ln_variance: noise.ln_variance(variance),
        }
    }

    /// (ln N, ln of the variance without the bias of its logarithm).
    pub(super) fn point(&self) -> (f64, f64) {
        (self.ln_n, self.ln_variance)
    }
}

pub(super) fn weights(rows: &[WeightedRow]) -> Vec<f64> {
    super::weights(rows.iter().map(|row| row.var_ln).collect())
}

/// The generalised least-squares line. Fewer than two different N have no slope.
///
/// The rows are independent, so the covariance of their logarithms is diagonal. The bias of
/// each ln s² is removed first. The standard error is that of the slope under the rows' own
/// variances, not only under those that the weights were made of.
pub fn weighted_fit(rows: &[WeightedRow]) -> Option<Fit> {
    weighted_line(rows, &counts(rows), &weights(rows))
}

/// [`weighted_fit`], and the paper's fit ([`power_law`](super::power_law)) through the same
/// rows.
pub fn both_fits(rows: &[WeightedRow]) -> [Option<Fit>; 2] {
    let (counts, weights) = (counts(rows), weights(rows));
    [weighted_line(rows, &counts, &weights), paper_line(rows, &counts, &weights)]
}

/// The paper's fit alone.
pub fn paper_fit(rows: &[WeightedRow]) -> Option<Fit> {
    paper_line(rows, &counts(rows), &weights(rows))
}

fn counts(rows: &[WeightedRow]) -> Vec<u64> {
    rows.iter().map(|row| row.n).collect()
}

fn weighted_line(rows: &[WeightedRow], counts: &[u64], weights: &[f64]) -> Option<Fit> {
    let points: Vec<_> = rows.iter().map(WeightedRow::point).collect();
    let line = line(&points, weights)?;
    let std_error = line.std_error(rows.iter().map(|row| row.var_ln));
    let chi2 = chi2(&line, &points, weights, std_error);
    line.fit(counts, std_error, chi2)
}

fn paper_line(rows: &[WeightedRow], counts: &[u64], weights: &[f64]) -> Option<Fit> {
    let points: Vec<_> = rows.iter().map(|row| (row.ln_n, row.ln_s2)).collect();
    super::line_alike(counts, &points, rows.iter().map(|row| row.var_ln), weights)
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
        let variance = pair[0].var_ln + pair[1].var_ln;
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
        WeightedRow::new(n, variance, noise)
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
        rows[0] = row(1, 20.0, Noise::ChiSquare { dof: 49.0 });
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
