//! Constant and linear functions.

use super::catalogue::{IntegrandInfo, MAX_DIM, ParamInfo};
use super::exact::{direction, variance_of_mean};
use super::{Alignment, Integrand, Reference, Regularity};

pub(super) const CONSTANT: IntegrandInfo = IntegrandInfo {
    name: "constant",
    summary: "the same value everywhere: every estimate is exact",
    params: &[ParamInfo { name: "value", default: 0.5, meaning: "f", min: -1e12, max: 1e12 }],
    min_dim: 1,
    max_dim: MAX_DIM,
    build: |dim, params| Box::new(Constant { dim, value: params[0] }),
};

pub(super) const RAMP: IntegrandInfo = IntegrandInfo {
    name: "ramp",
    summary: "linear a·x: the purest smooth pixel",
    params: &[
        ParamInfo { name: "slope", default: 1.0, meaning: "|a|", min: 0.0, max: 1e12 },
        ParamInfo {
            name: "angle",
            default: 60.0,
            meaning: "every hyperspherical angle of a, in degrees; 0 is along x0",
            min: 0.0,
            max: 90.0,
        },
    ],
    min_dim: 1,
    max_dim: MAX_DIM,
    build: |dim, params| {
        let gradient = direction(dim, params[1]).iter().map(|a| params[0] * a).collect();
        Box::new(Ramp { gradient, slope: params[0] })
    },
};

struct Constant {
    dim: usize,
    value: f64,
}

impl Integrand for Constant {
    fn dim(&self) -> usize {
        self.dim
    }
    fn eval(&self, _point: &[f64]) -> f64 {
        self.value
    }
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: self.value, std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Constant
    }
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        variance_of_mean(sampler, n, self.dim, |_| Some(0.0))
    }
}

struct Ramp {
    /// a
    gradient: Vec<f64>,
    /// |a|
    slope: f64,
}

impl Integrand for Ramp {
    fn dim(&self) -> usize {
        self.gradient.len()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        self.gradient.iter().zip(point).map(|(a, x)| a * x).sum()
    }
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: 0.5 * self.gradient.iter().sum::<f64>(), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        if self.slope == 0.0 { Regularity::Constant } else { Regularity::Smooth }
    }
    fn regularity_on_torus(&self) -> Regularity {
        if self.slope == 0.0 {
            return Regularity::Constant;
        }
        Regularity::Discontinuous { discontinuity_dim: self.gradient.len() as f64 - 1.0 }
    }
    fn alignment(&self) -> Alignment {
        Alignment::Additive
    }
    fn mean_square_gradient(&self) -> Option<f64> {
        Some(self.slope * self.slope)
    }
    /// Within a stratum of side 1/k the variance is |a|²/(12 k²).
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        let dim = self.gradient.len();
        variance_of_mean(sampler, n, dim, |k| {
            let k = k as f64;
            Some(self.slope * self.slope / 12.0 * k.powi(dim as i32) / (k * k))
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::integrand::test_support::{build, check_against_grid};

    #[test]
    fn moments_match_a_grid() {
        for dim in 1..=3 {
            check_against_grid("constant", dim, &[("value", -3.0)], 1e-15);
            // A midpoint rule is exact to the grid's own 1/m² for a line.
            check_against_grid("ramp", dim, &[("slope", 3.0)], 1e-3);
        }
    }

    #[test]
    fn the_variance_depends_on_the_length_of_the_gradient_alone() {
        for angle in [0.0, 20.0, 90.0] {
            let ramp = build("ramp", 3, &[("slope", 2.0), ("angle", angle)]);
            let expected = 4.0 / (12.0 * 64.0 * 16.0);
            assert!((ramp.exact_variance("jittered", 64).unwrap() / expected - 1.0).abs() < 1e-14);
            let expected = 4.0 / (12.0 * 5.0);
            assert!((ramp.exact_variance("random", 5).unwrap() / expected - 1.0).abs() < 1e-14);
        }
    }
}
