//! L2 discrepancies of boxes, in any dimension.
//!
//! Each is the mean square misjudgement of a family of boxes, and each is a sum over pairs of
//! points of a product over axes (Warnock 1972; Hickernell, *A generalized discrepancy and
//! quadrature error bound*, 1998):
//!
//! D² = ∫∫ K - 2/N Σᵢ ∫ K(xᵢ, y) dy + 1/N² Σᵢⱼ K(xᵢ, xⱼ),  K(x, y) = Πₐ k(xₐ, yₐ).
//!
//! Over random points its mean is (∫ K(x, x) dx - ∫∫ K) / N. O(d N²) time; NaN for no points,
//! or for dimension 0.

use crate::variance::neumaier_sum;

/// The L2 star discrepancy, squared: boxes with a corner at the origin (Warnock 1972).
pub fn l2_star_sq(points: &[f64], dim: usize) -> f64 {
    mean_square(points, dim, 1.0 / 3.0, |x| 0.5 * (1.0 - x * x), |x, y| 1.0 - x.max(y))
}

/// The centred L2 discrepancy, squared: boxes between a point and its nearest corner of the
/// cube, and their projections (Hickernell 1998).
pub fn centred_sq(points: &[f64], dim: usize) -> f64 {
    let single = |x: f64| 1.0 + 0.5 * off_centre(x) * (1.0 - off_centre(x));
    let pair = |x: f64, y: f64| 1.0 + 0.5 * (off_centre(x) + off_centre(y) - (x - y).abs());
    mean_square(points, dim, 13.0 / 12.0, single, pair)
}

/// The wrap-around L2 discrepancy, squared: boxes between any two points of the torus
/// (Hickernell, *Lattice rules: how well do they measure up?*, 1998). No torus shift changes it.
pub fn wrap_around_sq(points: &[f64], dim: usize) -> f64 {
    let pair = |x: f64, y: f64| 1.5 - (x - y).abs() * (1.0 - (x - y).abs());
    mean_square(points, dim, 4.0 / 3.0, |_| 4.0 / 3.0, pair)
}

/// The mixture L2 discrepancy, squared: a mean of centred and wrap-around boxes (Zhou, Fang &
/// Ning, *Mixture discrepancy for quasi-random point sets*, 2013).
pub fn mixture_sq(points: &[f64], dim: usize) -> f64 {
    let single = |x: f64| 5.0 / 3.0 - 0.25 * off_centre(x) * (1.0 + off_centre(x));
    let pair = |x: f64, y: f64| {
        let apart = (x - y).abs();
        1.875 - 0.25 * (off_centre(x) + off_centre(y)) - 0.75 * apart + 0.5 * apart * apart
    };
    mean_square(points, dim, 19.0 / 12.0, single, pair)
}

fn off_centre(x: f64) -> f64 {
    (x - 0.5).abs()
}

/// D² for the kernel `pair`, whose integral over one argument is `single`, and over both `mean`.
fn mean_square(
    points: &[f64],
    dim: usize,
    mean: f64,
    single: impl Fn(f64) -> f64,
    pair: impl Fn(f64, f64) -> f64,
) -> f64 {
    if dim == 0 {
        return f64::NAN;
    }
    let n = (points.len() / dim) as f64;
    let rows = || points.chunks_exact(dim);
    let kernel = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| pair(*x, *y)).product::<f64>();
    let singles = neumaier_sum(rows().map(|x| x.iter().map(|x| single(*x)).product::<f64>()));
    let pairs = neumaier_sum(rows().enumerate().map(|(i, x)| {
        let earlier = rows().take(i).map(|y| kernel(x, y)).sum::<f64>();
        kernel(x, x) + 2.0 * earlier
    }));
    neumaier_sum([mean.powf(dim as f64), -2.0 * singles / n, pairs / (n * n)])
}

#[cfg(test)]
mod tests {
    use super::super::test_points::random;
    use super::*;
    use crate::variance::Moments;

    type Squared = fn(&[f64], usize) -> f64;

    /// The discrepancies with ∫ k(x, x) dx and ∫∫ k on one axis.
    const KNOWN: [(Squared, f64, f64); 4] = [
        (l2_star_sq, 1.0 / 2.0, 1.0 / 3.0),
        (centred_sq, 5.0 / 4.0, 13.0 / 12.0),
        (wrap_around_sq, 3.0 / 2.0, 4.0 / 3.0),
        (mixture_sq, 7.0 / 4.0, 19.0 / 12.0),
    ];

    /// Means over 3000 trials, within five of their own standard errors: 10^-6 each.
    #[test]
    fn means_of_random_points_are_known() {
        for (i, (discrepancy_sq, diagonal, mean)) in KNOWN.into_iter().enumerate() {
            for (n, dim) in [(1, 1), (7, 2), (20, 3), (5, 6)] {
                let values: Vec<_> =
                    (0..3000).map(|t| discrepancy_sq(&random(n, dim, t), dim)).collect();
                let d = dim as i32;
                let expected = (f64::powi(diagonal, d) - f64::powi(mean, d)) / n as f64;
                let spread = Moments::of(&values);
                let std_error = (spread.variance / 3000.0).sqrt();
                // Wrap-around boxes see one point as they see any other.
                let off = (spread.mean - expected).abs();
                assert!(off < 5.0 * std_error + 1e-14, "{i} {n} {dim}: {off} ± {std_error}");
            }
        }
    }

    /// The squared L2 star discrepancy of one point x on a line is x² - x + 1/3, that of the
    /// points (i + ½)/N is 1 / 12N².
    #[test]
    fn points_on_a_line_in_closed_form() {
        for x in [0.0, 0.3, 0.5, 0.99] {
            assert!((l2_star_sq(&[x], 1) - (x * x - x + 1.0 / 3.0)).abs() < 1e-15);
        }
        for n in [1, 2, 10, 100] {
            let points: Vec<_> = (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).collect();
            let expected = 1.0 / (12.0 * f64::from(n * n));
            assert!((l2_star_sq(&points, 1) - expected).abs() < 1e-15, "{n}");
        }
    }

    #[test]
    fn a_torus_shift_leaves_wrap_around_as_it_was() {
        let points = random(30, 3, 0);
        let shifted: Vec<_> = points.iter().map(|x| (x + 0.37).fract()).collect();
        let change = |f: Squared| f(&points, 3) - f(&shifted, 3);
        assert!(change(wrap_around_sq).abs() < 1e-14);
        assert!(change(centred_sq).abs() > 1e-6);
    }

    #[test]
    fn no_points_have_no_discrepancy() {
        for (discrepancy_sq, ..) in KNOWN {
            assert!(discrepancy_sq(&[], 2).is_nan() && discrepancy_sq(&[0.5], 0).is_nan());
        }
    }
}
