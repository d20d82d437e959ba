//! Radiance over a facet as a polynomial of the position in the pixel.

use crate::integrand::quadrature::gauss_legendre;

/// Σ c[a][b] sᵃ tᵇ over a + b < D, (s, t) in [-1/2, 1/2]² about the pixel's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Polynomial<const D: usize>(pub [[f64; D]; D]);

impl<const D: usize> Polynomial<D> {
    pub const ZERO: Self = Self([[0.0; D]; D]);

    pub fn constant(value: f64) -> Self {
        let mut polynomial = Self::ZERO;
        polynomial.0[0][0] = value;
        polynomial
    }

    /// The coefficients of its powers of s at one t.
    #[inline(always)]
    pub fn row(&self, t: f64) -> [f64; D] {
        std::array::from_fn(|a| {
            let mut value = 0.0;
            for b in (0..D - a).rev() {
                value = value * t + self.0[a][b];
            }
            value
        })
    }

    #[inline(always)]
    pub fn at(&self, s: f64, t: f64) -> f64 {
        horner(&self.row(t), s)
    }

    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|a| std::array::from_fn(|b| self.0[a][b] - other.0[a][b])))
    }
}

/// Σ c[a] xᵃ
#[inline(always)]
pub(super) fn horner<const D: usize>(c: &[f64; D], x: f64) -> f64 {
    let mut value = 0.0;
    for a in (0..D).rev() {
        value = value * x + c[a];
    }
    value
}

/// Makes polynomials of total degree D - 1 from functions: the projection on Legendre
/// polynomials over a box, by the tensor Gauss rule of D nodes an axis.
pub(super) struct Fitter<const D: usize> {
    /// The Gauss rule of D nodes on [0, 1].
    pub rule: [(f64, f64); D],
    /// (2n + 1) × weight × Pₙ at each node.
    project: [[f64; D]; D],
}

impl<const D: usize> Fitter<D> {
    pub fn new() -> Self {
        let nodes = gauss_legendre(D);
        let rule: [_; D] = std::array::from_fn(|i| nodes[i]);
        let project = std::array::from_fn(|n| {
            rule.map(|(node, weight)| {
                (2 * n + 1) as f64 * weight * horner(&legendre::<D>(0.5, 2.0)[n], node - 0.5)
            })
        });
        Self { rule, project }
    }

    /// The polynomial next to `f` on a box of the pixel, and how far it is off: the largest
    /// deviation found at the nodes and at the box's corners, where the first terms that a
    /// projection leaves out are largest.
    pub fn fit(&self, bounds: [[f64; 2]; 2], f: impl Fn(f64, f64) -> f64) -> (Polynomial<D>, f64) {
        let place = |axis: usize, x: f64| bounds[axis][0] + x * (bounds[axis][1] - bounds[axis][0]);
        let position = |i: usize, j: usize| [place(0, self.rule[i].0), place(1, self.rule[j].0)];
        let values: [[f64; D]; D] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let [s, t] = position(i, j);
                f(s, t)
            })
        });
        let [in_s, in_t] = bounds.map(|[lo, hi]| legendre::<D>(-lo / (hi - lo), 2.0 / (hi - lo)));
        let mut fitted = Polynomial::ZERO;
        for (n, in_s) in in_s.iter().enumerate() {
            let sums: [f64; D] =
                std::array::from_fn(|j| (0..D).map(|i| self.project[n][i] * values[i][j]).sum());
            for (m, in_t) in in_t.iter().enumerate().take(D - n) {
                let coefficient: f64 = (0..D).map(|j| self.project[m][j] * sums[j]).sum();
                for (a, in_s) in in_s.iter().enumerate().take(n + 1) {
                    for (b, in_t) in in_t.iter().enumerate().take(m + 1) {
                        fitted.0[a][b] += coefficient * in_s * in_t;
                    }
                }
            }
        }
        let mut error = 0.0f64;
        for (i, values) in values.iter().enumerate() {
            for (j, value) in values.iter().enumerate() {
                let [s, t] = position(i, j);
                error = error.max((value - fitted.at(s, t)).abs());
            }
        }
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let (s, t) = (place(0, x), place(1, y));
            // Not `max`, which would lose a NaN.
            let deviation = (f(s, t) - fitted.at(s, t)).abs();
            error = if deviation <= error { error } else { deviation };
        }
        (fitted, error)
    }
}

/// Coefficients in x of the Legendre polynomials Pₙ(u), u = scale x + 2 middle - 1: those of
/// [0, 1] as seen from x where `middle` is the place of x = 0 in it.
fn legendre<const D: usize>(middle: f64, scale: f64) -> [[f64; D]; D] {
    let shift = 2.0 * middle - 1.0;
    let mut p = [[0.0; D]; D];
    p[0][0] = 1.0;
    for n in 1..D {
        let degree = n as f64;
        for a in 0..=n {
            let times_u = shift * p[n - 1][a] + if a > 0 { scale * p[n - 1][a - 1] } else { 0.0 };
            let before = if n > 1 { p[n - 2][a] } else { 0.0 };
            p[n][a] = ((2.0 * degree - 1.0) * times_u - (degree - 1.0) * before) / degree;
        }
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_is_its_own_fit() {
        let f = |s: f64, t: f64| 0.3 - 2.0 * s + t + 4.0 * s * t - s * s + 0.5 * t * t;
        let (fitted, error) = Fitter::<3>::new().fit([[-0.1, 0.4], [-0.5, 0.25]], f);
        assert!(error < 1e-14, "{error}");
        let expected = [[0.3, 1.0, 0.5], [-2.0, 4.0, 0.0], [-1.0, 0.0, 0.0]];
        for (a, b) in fitted.0.iter().flatten().zip(expected.iter().flatten()) {
            assert!((a - b).abs() < 1e-13, "{fitted:?}");
        }
    }

    #[test]
    fn the_error_found_is_about_the_error_made() {
        let f = |s: f64, t: f64| (1.0 + 0.3 * s - 0.2 * t).powi(-3);
        fn check<const D: usize>(f: impl Fn(f64, f64) -> f64, limit: f64) {
            let (fitted, error) = Fitter::<D>::new().fit([[-0.5, 0.5]; 2], &f);
            let worst = (0..=40)
                .flat_map(|i| (0..=40).map(move |j| (f64::from(i), f64::from(j))))
                .map(|(i, j)| (i / 40.0 - 0.5, j / 40.0 - 0.5))
                .map(|(s, t)| (f(s, t) - fitted.at(s, t)).abs())
                .fold(0.0, f64::max);
            assert!(error < limit && worst < 1.5 * error, "{D}: {worst} {error}");
        }
        check::<3>(f, 0.2);
        check::<5>(f, 0.02);
        check::<9>(f, 2e-4);
    }
}
