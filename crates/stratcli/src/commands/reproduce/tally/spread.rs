//! How numbers spread.

use crate::report::histogram::Histogram;
use crate::report::summary::Exponents;
use stratcore::fit::Fit;

/// The 99th percentile of a normal number.
pub const QUANTILE: f64 = 2.326_347_874;

/// Whether the residuals are no larger than noise makes them: χ² below its 99th percentile, by
/// the cube-root approximation of Wilson & Hilferty (1931).
pub fn is_straight(fit: &Fit) -> bool {
    let dof = fit.points.saturating_sub(2) as f64;
    let spread = 2.0 / (9.0 * dof);
    fit.chi2 <= dof * (1.0 - spread + QUANTILE * spread.sqrt()).powi(3)
}

/// Linear interpolation between order statistics; NaN without any.
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = q * last as f64;
    let low = at.floor() as usize;
    let high = (low + 1).min(last);
    sorted[low] + (at - low as f64) * (sorted[high] - sorted[low])
}

/// Mean and standard deviation (divisor n - 1); NaN where they do not exist.
pub fn mean_and_deviation(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    [mean, if n < 2.0 { f64::NAN } else { (squares / (n - 1.0)).sqrt() }]
}

/// What exponents with their standard errors say together.
pub fn exponents(fits: Vec<[f64; 2]>) -> Exponents {
    let mut p: Vec<_> = fits.iter().map(|f| f[0]).collect();
    p.sort_by(f64::total_cmp);
    let [mean, std_deviation] = mean_and_deviation(&p);
    let n = p.len() as f64;
    let mean_square = fits.iter().map(|f| f[1] * f[1]).sum::<f64>() / n;
    Exponents {
        pixels: p.len(),
        mean,
        std_error: std_deviation / n.sqrt(),
        std_deviation,
        robust_deviation: (quantile(&p, 0.75) - quantile(&p, 0.25)) / 1.349,
        typical_std_error: mean_square.sqrt(),
        percentiles: [0.01, 0.5, 0.99].map(|q| quantile(&p, q)),
        histogram: Histogram::of_exponents(p.into_iter()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_fit_has_a_chi_square_below_its_99th_percentile() {
        let fit = |chi2, points| Fit {
            exponent: 1.0,
            std_error: 0.03,
            ci95: [0.9, 1.1],
            log10_constant: 0.0,
            n_min: 1,
            n_max: 256,
            points,
            chi2,
        };
        // Tables: 29.14 at 14 degrees of freedom, 13.28 at 4.
        assert!(is_straight(&fit(29.1, 16)) && !is_straight(&fit(29.2, 16)));
        assert!(is_straight(&fit(13.2, 6)) && !is_straight(&fit(13.4, 6)));
    }

    #[test]
    fn quantiles_of_few_numbers() {
        assert!(quantile(&[], 0.5).is_nan());
        assert_eq!(quantile(&[3.0], 0.99), 3.0);
        assert_eq!(quantile(&[0.0, 1.0, 2.0, 4.0], 0.5), 1.5);
    }
}
