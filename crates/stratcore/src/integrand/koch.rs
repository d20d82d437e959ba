//! A Koch snowflake: an edge of fractal dimension.

use super::catalogue::{IntegrandInfo, ParamInfo};
use super::exact::{generic_centre, variance_of_mean};
use super::{Integrand, Reference, Regularity};

pub(super) const KOCH: IntegrandInfo = IntegrandInfo {
    name: "koch",
    summary: "1 inside a Koch snowflake, whose edge has dimension ln 4 / ln 3",
    params: &[ParamInfo {
        name: "radius",
        default: 0.45,
        meaning: "of the circle through the tips; the square has side 1",
        min: 0.001,
        max: 0.45,
    }],
    min_dim: 2,
    max_dim: 2,
    build: |_, params| Box::new(Koch { radius: params[0] }),
};

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// The tilt of the starting triangle, in radians: on no symmetry of the square.
const TILT: f64 = 0.2;

/// Refinements of the edge: after 33 of them a side of 1 has shrunk to 2^-52.
const DEPTH: u32 = 33;

struct Koch {
    radius: f64,
}

/// Whether a point lies between the base y = 0, 0 ≤ x ≤ 1, and the Koch curve above it.
fn under_koch_curve(mut x: f64, mut y: f64) -> bool {
    for _ in 0..DEPTH {
        x = x.min(1.0 - x);
        // The curve's hull is a triangle with angles of 30 degrees at its base.
        if y > x / SQRT_3 {
            return false;
        }
        let beyond = x - 1.0 / 3.0;
        if beyond < 0.0 {
            // Under the first of four copies, or outside: its hull ends at x = 1/3.
            (x, y) = (3.0 * x, 3.0 * y);
        } else if y <= SQRT_3 * beyond {
            return true;
        } else {
            // Outside the middle triangle, beside its left flank: turn that to the base.
            (x, y) = (1.5 * (beyond + SQRT_3 * y), 1.5 * (y - SQRT_3 * beyond));
        }
    }
    true
}

impl Integrand for Koch {
    fn dim(&self) -> usize {
        2
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let x = (point[0] - generic_centre(0)) / self.radius;
        let y = (point[1] - generic_centre(1)) / self.radius;
        // The triangle inscribed in the unit circle has sides √3 at distance 1/2. A point of
        // the snowflake is beyond one side at most.
        let side = |turn: f64| {
            let (sin, cos) = (TILT + turn * std::f64::consts::TAU / 3.0).sin_cos();
            let (out, along) = (cos * x + sin * y - 0.5, cos * y - sin * x);
            (out > 0.0).then(|| under_koch_curve(along / SQRT_3 + 0.5, out / SQRT_3))
        };
        let beyond = [0.0, 1.0, 2.0].into_iter().find_map(side);
        f64::from(u8::from(beyond.unwrap_or(true)))
    }
    /// 8/5 of the starting triangle.
    fn reference(&self) -> Option<Reference> {
        let mean = 1.2 * SQRT_3 * self.radius * self.radius;
        Some(Reference { mean, std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Discontinuous { discontinuity_dim: 4f64.ln() / 3f64.ln() }
    }
    /// For `random`; the areas within strata have no closed form.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        let area = self.reference()?.mean;
        variance_of_mean(sampler, n, 2, |k| (k == 1).then_some(area * (1.0 - area)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::test_support::{build, check_against_grid};

    #[test]
    fn the_area_is_eight_fifths_of_the_triangle() {
        check_against_grid("koch", 2, &[], 5e-3);
        // A fractal edge is known to a grid of side 1/m to about m^-1.37.
        let koch = build("koch", 2, &[("radius", 0.4)]);
        let m = 2000;
        let inside: f64 = (0..m * m)
            .map(|i| {
                koch.eval(&[(f64::from(i % m) + 0.5) / 2000.0, (f64::from(i / m) + 0.5) / 2000.0])
            })
            .sum();
        let triangle = 0.75 * SQRT_3 * 0.16;
        assert!((inside / 4e6 - 1.6 * triangle).abs() < 3e-5, "{}", inside / 4e6);
    }

    #[test]
    fn the_curve_is_its_own_copy() {
        for i in 0..40_000 {
            let (x, y) = (f64::from(i % 200) / 200.0 + 1e-3, f64::from(i / 200) / 650.0 + 1e-4);
            assert_eq!(under_koch_curve(x, y), under_koch_curve(1.0 - x, y));
            assert_eq!(under_koch_curve(x, y), under_koch_curve(x / 3.0, y / 3.0), "{x} {y}");
        }
        assert!(under_koch_curve(0.5, SQRT_3 / 6.0 - 1e-9) && under_koch_curve(0.4, 0.1));
        assert!(!under_koch_curve(0.5, SQRT_3 / 6.0 + 1e-9) && !under_koch_curve(0.3, 0.15));
        // The tip of the second copy's own triangle, at x = 1/3.
        let tip = SQRT_3 / 9.0;
        assert!(under_koch_curve(1.0 / 3.0 + 2e-6, tip - 1e-6));
        assert!(!under_koch_curve(1.0 / 3.0 - 2e-6, tip - 1e-6));
    }

    /// Counting boxes that the edge enters: their number grows by 4 when they shrink by 3.
    #[test]
    fn the_edge_has_dimension_ln4_over_ln3() {
        let koch = Koch { radius: 0.45 };
        let boxes = |m: u32| {
            let corner = |i: u32| f64::from(i) / f64::from(m);
            let cut = (0..m * m).filter(|i| {
                let (i, j) = (i % m, i / m);
                let values = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
                    .map(|(a, b)| koch.eval(&[corner(a), corner(b)]));
                values.iter().any(|v| *v != values[0])
            });
            cut.count() as f64
        };
        let dim = (boxes(1500) / boxes(1500 / 27)).ln() / 27f64.ln();
        assert!((dim - 4f64.ln() / 3f64.ln()).abs() < 0.03, "{dim}");
    }
}
