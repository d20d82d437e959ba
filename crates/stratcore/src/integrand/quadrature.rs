//! Gauss-Legendre quadrature: where "exact" needs an integral without an elementary form, f is
//! analytic and a few nodes reach rounding error.

use super::exact::AxisMoments;
use crate::variance::neumaier_sum;
use std::f64::consts::PI;

/// Nodes in [0, 1] and weights that sum to 1 of the rule with `count` nodes, exact for
/// polynomials of degree 2 count - 1.
pub(crate) fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let n = count as f64;
    (0..count)
        .map(|i| {
            // Tricomi's estimate of the root, then Newton's method.
            let mut x = -((i as f64 + 0.75) / (n + 0.5) * PI).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let value;
                (value, slope) = legendre(count, x);
                x -= value / slope;
            }
            (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The same rule in each of so many equal panels of [0, 1].
pub(super) fn composite(count: usize, panels: u64) -> Vec<(f64, f64)> {
    let rule = gauss_legendre(count);
    let n = panels as f64;
    (0..panels)
        .flat_map(|panel| rule.iter().map(move |(x, w)| ((panel as f64 + x) / n, w / n)))
        .collect()
}

/// Nodes that leave an error of 1e-12 or so of a function on [-1, 1] that is analytic but at
/// least `away` off the real axis: it falls as ρ^(-2 nodes), ρ the sum of the half axes of the
/// largest ellipse without a singularity. For one on the axis, at x, `away` is √(x² - 1).
pub(super) fn nodes_for(away: f64) -> usize {
    let ellipse = away + (away * away + 1.0).sqrt();
    (1e12f64.ln() / (2.0 * ellipse.ln())).ceil().max(2.0) as usize
}

/// The Legendre polynomial of this degree and its derivative, inside (-1, 1).
fn legendre(degree: usize, x: f64) -> (f64, f64) {
    let (mut before, mut here) = (1.0, x);
    for j in 2..=degree {
        let j = j as f64;
        (before, here) = (here, ((2.0 * j - 1.0) * x * here - (j - 1.0) * before) / j);
    }
    (here, degree as f64 * (x * here - before) / (x * x - 1.0))
}

/// ∫g over [0, 1]; `length` as in [`axis_moments`].
pub(super) fn integral(length: f64, g: impl Fn(f64) -> f64) -> f64 {
    let panels = (1.0 / length).ceil().max(1.0) as u64;
    composite(12, panels).into_iter().map(|(x, w)| w * g(x)).sum()
}

/// Moments of `g` over the k strata of [0, 1]. `length` is how far `g` runs between features:
/// longer strata are cut into panels no longer than that.
pub(super) fn axis_moments(k: u64, length: f64, g: impl Fn(f64) -> f64) -> AxisMoments {
    let rule = gauss_legendre(12);
    let panels = (1.0 / (k as f64 * length)).ceil().max(1.0);
    let step = 1.0 / (k as f64 * panels);
    let mut values = vec![0.0; panels as usize * rule.len()];
    let weights: Vec<f64> = (0..values.len()).map(|i| rule[i % rule.len()].1 / panels).collect();
    let mut strata = Vec::with_capacity(k as usize);
    for stratum in 0..k {
        for (panel, values) in values.chunks_exact_mut(rule.len()).enumerate() {
            let start = stratum as f64 * panels + panel as f64;
            for (value, (node, _)) in values.iter_mut().zip(&rule) {
                *value = g((start + node) * step);
            }
        }
        let mean: f64 = values.iter().zip(&weights).map(|(v, w)| w * v).sum();
        let variance: f64 = values.iter().zip(&weights).map(|(v, w)| w * (v - mean).powi(2)).sum();
        strata.push((mean * mean, variance));
    }
    AxisMoments {
        squared_means: neumaier_sum(strata.iter().map(|s| s.0)),
        variances: neumaier_sum(strata.iter().map(|s| s.1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_of_n_nodes_integrates_degree_2n_minus_1() {
        for count in 1..=16 {
            let rule = gauss_legendre(count);
            for degree in 0..2 * count as i32 {
                let integral: f64 = rule.iter().map(|(x, w)| w * x.powi(degree)).sum();
                assert!((integral * f64::from(degree + 1) - 1.0).abs() < 1e-13, "{count} {degree}");
            }
        }
    }

    #[test]
    fn moments_of_a_line_and_of_an_exponential() {
        for k in [1, 2, 7, 100_000] {
            let n = k as f64;
            let line = axis_moments(k, 1.0, |x| 1.0 + x);
            assert!((line.variances * 12.0 * n - 1.0).abs() < 1e-9, "{k}: {}", line.variances);
            let total = line.squared_means + line.variances;
            assert!((total / n * 3.0 / 7.0 - 1.0).abs() < 1e-13);
        }
        let exponential = axis_moments(1, 0.3, f64::exp);
        let e = std::f64::consts::E;
        assert!((exponential.squared_means - (e - 1.0).powi(2)).abs() < 1e-14);
        assert!((exponential.variances - (0.5 * (e * e - 1.0) - (e - 1.0).powi(2))).abs() < 1e-14);
    }
}
