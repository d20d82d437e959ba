//! Two power laws in one curve: a pixel that is smooth here and cut by an edge there.

use super::weighted::{WeightedRow, weights};
use super::{Fit, line};
use serde::Serialize;

/// `variance_of_mean ~ a₁ N^-p₁ + a₂ N^-p₂`, both terms positive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TwoTerms {
    /// p₁ < p₂: the first rules at large N.
    pub exponents: [f64; 2],
    /// Standard errors of the exponents.
    pub std_errors: [f64; 2],
    /// log₁₀ of a₁ and a₂.
    pub log10_constants: [f64; 2],
    /// N at which both terms are equal.
    pub n_equal: f64,
    /// Σ (residual² / Var ln s²).
    pub chi2: f64,
    /// Akaike's criterion corrected for few rows, of the single line minus that of this curve;
    /// positive, and the larger the more the second term explains.
    pub aicc_gain: f64,
}

/// Rows below this probability of a single slope are tried with two.
const LEVEL: f64 = 0.01;

/// Fits two terms where one slope does not describe the rows. Both of these must hold:
///
/// * χ² rejects the single line `single` at 1 %;
/// * the corrected Akaike criterion, χ² + 2k + 2k(k + 1)/(n - k - 1) with k = 4 parameters
///   against 2, is lower (Akaike 1974; Hurvich & Tsai 1989).
///
/// A sum of two falling powers is convex in log space; rows that bend the other way keep the
/// single line.
pub fn two_terms(rows: &[WeightedRow], single: &Fit) -> Option<TwoTerms> {
    const PARAMETERS: usize = 4;
    if rows.len() < PARAMETERS + 3 || single.p_value()? > LEVEL {
        return None;
    }
    let points: Vec<_> = rows.iter().map(WeightedRow::point).collect();
    let weights = weights(rows);
    let start = start(&points, &weights)?;
    let (parameters, chi2, covariance) = levenberg_marquardt(&points, &weights, start)?;
    let [c1, p1, c2, p2] = parameters;
    let criterion = |chi2: f64, k: usize| {
        chi2 + 2.0 * k as f64 + 2.0 * (k * (k + 1)) as f64 / (rows.len() - k - 1) as f64
    };
    let aicc_gain = criterion(single.chi2, 2) - criterion(chi2, PARAMETERS);
    let order = if p1 <= p2 { [0, 1] } else { [1, 0] };
    let (p, c) = ([p1, p2], [c1, c2]);
    let errors = [covariance[1][1].sqrt(), covariance[3][3].sqrt()];
    let found = TwoTerms {
        exponents: order.map(|i| p[i]),
        std_errors: order.map(|i| errors[i]),
        log10_constants: order.map(|i| c[i] / std::f64::consts::LN_10),
        n_equal: ((c[order[1]] - c[order[0]]) / (p[order[1]] - p[order[0]])).exp(),
        chi2,
        aicc_gain,
    };
    let sound = found.std_errors.iter().chain(&[found.n_equal]).all(|x| x.is_finite());
    (sound && aicc_gain > 0.0).then_some(found)
}

impl TwoTerms {
    /// The curve's value at N.
    pub fn variance_at(&self, n: f64) -> f64 {
        let term = |i: usize| 10f64.powf(self.log10_constants[i] - self.exponents[i] * n.log10());
        term(0) + term(1)
    }
}

/// [ln a, p] of lines through the last and the first half of the rows, a little apart.
fn start(points: &[(f64, f64)], weights: &[f64]) -> Option<[f64; 4]> {
    let half = points.len() / 2;
    let late = line(&points[half..], &weights[half..])?;
    let early = line(&points[..=half], &weights[..=half])?;
    let apart = (late.slope - early.slope).max(0.2);
    let steeper = late.slope - apart;
    let (x0, y0) = points[0];
    // Both lines lie above their sum by up to ln 2 where they cross.
    Some([late.intercept - 0.3, -late.slope, y0 - steeper * x0 - 0.3, -steeper])
}

/// ln(a₁ N^-p₁ + a₂ N^-p₂) at x = ln N, and its derivatives by ln a₁, p₁, ln a₂, p₂.
fn model([c1, p1, c2, p2]: [f64; 4], x: f64) -> (f64, [f64; 4]) {
    let (t1, t2) = (c1 - p1 * x, c2 - p2 * x);
    let largest = t1.max(t2);
    let (e1, e2) = ((t1 - largest).exp(), (t2 - largest).exp());
    let (s1, s2) = (e1 / (e1 + e2), e2 / (e1 + e2));
    (largest + (e1 + e2).ln(), [s1, -s1 * x, s2, -s2 * x])
}

type Solution = ([f64; 4], f64, [[f64; 4]; 4]);

/// Marquardt's damped least squares (1963): parameters, χ², and their covariance.
fn levenberg_marquardt(
    points: &[(f64, f64)],
    weights: &[f64],
    mut at: [f64; 4],
) -> Option<Solution> {
    const STEPS: usize = 200;
    // χ² and the normal equations, of one pass: the model's exponentials are what costs.
    let evaluate = |at| {
        let (mut chi2, mut matrix, mut vector) = (0.0, [[0.0; 4]; 4], [0.0; 4]);
        for ((x, y), w) in points.iter().zip(weights) {
            let (value, slope) = model(at, *x);
            chi2 += w * (y - value).powi(2);
            for i in 0..4 {
                vector[i] += w * slope[i] * (y - value);
                for j in 0..4 {
                    matrix[i][j] += w * slope[i] * slope[j];
                }
            }
        }
        (chi2, matrix, vector)
    };
    let (mut chi2, mut matrix, mut vector) = evaluate(at);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let mut damped = matrix;
        for (i, row) in damped.iter_mut().enumerate() {
            row[i] += damping * row[i].max(1e-12);
        }
        let inverse = inverse(damped)?;
        let step = inverse.map(|row| row.iter().zip(&vector).map(|(a, b)| a * b).sum::<f64>());
        let tried = std::array::from_fn(|i| at[i] + step[i]);
        let (new, new_matrix, new_vector) = evaluate(tried);
        if new <= chi2 {
            let gained = chi2 - new;
            (at, damping) = (tried, (damping * 0.2).max(1e-12));
            (chi2, matrix, vector) = (new, new_matrix, new_vector);
            if gained < 1e-9 * (1.0 + chi2) {
                break;
            }
        } else {
            damping *= 5.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    Some((at, chi2, inverse(matrix)?))
}

/// By Gauss and Jordan with pivots; none for a singular matrix.
fn inverse(mut a: [[f64; 4]; 4]) -> Option<[[f64; 4]; 4]> {
    let mut inverse: [[f64; 4]; 4] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for column in 0..4 {
        let pivot =
            (column..4).max_by(|i, j| a[*i][column].abs().total_cmp(&a[*j][column].abs()))?;
        if a[pivot][column].abs() < 1e-14 || !a[pivot][column].is_finite() {
            return None;
        }
        a.swap(column, pivot);
        inverse.swap(column, pivot);
        let scale = a[column][column].recip();
        a[column] = a[column].map(|v| v * scale);
        inverse[column] = inverse[column].map(|v| v * scale);
        for row in (0..4).filter(|row| *row != column) {
            let factor = a[row][column];
            for j in 0..4 {
                a[row][j] -= factor * a[column][j];
                inverse[row][j] -= factor * inverse[column][j];
            }
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::weighted_fit;
    use crate::noise::Noise;

    fn rows(variance: impl Fn(f64) -> f64, dof: f64) -> Vec<WeightedRow> {
        let noise = Noise::ChiSquare { dof };
        let bias = noise.ln_variance(1.0).exp();
        let row = |k: u64| WeightedRow::new(k * k, variance((k * k) as f64) / bias, noise);
        (1..=16).map(row).collect()
    }

    #[test]
    fn planted_terms_come_back() {
        let rows = rows(|n| 0.02 * n.powf(-1.5) + 1.0 * n.powf(-2.5), 2e5);
        let single = weighted_fit(&rows).unwrap();
        let found = two_terms(&rows, &single).unwrap();
        assert!((found.exponents[0] - 1.5).abs() < 1e-3, "{found:?}");
        assert!((found.exponents[1] - 2.5).abs() < 1e-3, "{found:?}");
        assert!((found.n_equal - 50.0).abs() < 0.5, "{found:?}");
        assert!(found.chi2 < 1e-3 && found.aicc_gain > 100.0);
        assert!(
            (found.variance_at(7.0) / (0.02 * 7f64.powf(-1.5) + 7f64.powf(-2.5)) - 1.0).abs()
                < 1e-4
        );
    }

    #[test]
    fn one_slope_keeps_one_term_and_so_does_a_bend_the_other_way() {
        let straight = rows(|n| n.powf(-1.5), 49.0);
        assert_eq!(two_terms(&straight, &weighted_fit(&straight).unwrap()), None);
        let concave = rows(|n| 1.0 / (n.powf(1.0) + 0.01 * n.powf(2.0)), 1e5);
        assert_eq!(two_terms(&concave, &weighted_fit(&concave).unwrap()), None);
    }
}
