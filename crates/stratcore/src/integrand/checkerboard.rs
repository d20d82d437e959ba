//! A checkerboard: complex until the strata are finer than its checks.

use super::catalogue::{IntegrandInfo, MAX_DIM, ParamInfo};
use super::exact::{AxisMoments, MAX_STRATA, product_strata_variance, variance_of_mean};
use super::{Integrand, Reference, Regularity};

pub(super) const CHECKERBOARD: IntegrandInfo = IntegrandInfo {
    name: "checkerboard",
    summary: "1 on every other check: complex until the strata are finer than the checks",
    params: &[ParamInfo {
        name: "frequency",
        default: 64.0,
        meaning: "checks across the cube along each axis",
        min: 1.0,
        max: 1e6,
    }],
    min_dim: 1,
    max_dim: MAX_DIM,
    build: |dim, params| Box::new(Checkerboard { dim, frequency: params[0] }),
};

/// (1 + Π s(xᵢ)) / 2 with the square wave s = 1, -1, 1, … on checks of side 1/frequency.
struct Checkerboard {
    dim: usize,
    frequency: f64,
}

impl Checkerboard {
    /// Mean of the square wave over the stratum [j/k, (j + 1)/k]. Whole frequencies are
    /// computed without rounding, so an aligned grid has exactly no variance.
    fn wave_mean(&self, j: f64, k: f64) -> f64 {
        // k times the wave's integral from 0 to `checks` / k checks: a triangle wave.
        let integral = |checks: f64| {
            let phase = checks.rem_euclid(2.0 * k);
            phase.min(2.0 * k - phase)
        };
        (integral((j + 1.0) * self.frequency) - integral(j * self.frequency)) / self.frequency
    }

    fn axis_moments(&self, k: u64) -> AxisMoments {
        let mut axis = AxisMoments { squared_means: 0.0, variances: 0.0 };
        for j in 0..k {
            let mean = self.wave_mean(j as f64, k as f64);
            axis.squared_means += mean * mean;
            axis.variances += (1.0 - mean * mean).max(0.0);
        }
        axis
    }
}

impl Integrand for Checkerboard {
    fn dim(&self) -> usize {
        self.dim
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let checks: u64 = point.iter().map(|x| (x * self.frequency) as u64).sum();
        f64::from(u8::from(checks.is_multiple_of(2)))
    }
    fn reference(&self) -> Option<Reference> {
        let product = self.wave_mean(0.0, 1.0).powi(self.dim as i32);
        Some(Reference { mean: f64::midpoint(1.0, product), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        if self.frequency == 1.0 {
            return Regularity::Constant;
        }
        Regularity::Discontinuous { discontinuity_dim: self.dim as f64 - 1.0 }
    }
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        variance_of_mean(sampler, n, self.dim, |k| {
            (k <= MAX_STRATA).then(|| {
                let axis = self.axis_moments(k);
                0.25 * product_strata_variance(std::iter::repeat_n(axis, self.dim))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::integrand::test_support::{build, check_against_grid};

    #[test]
    fn moments_match_a_grid() {
        for dim in 1..=3 {
            for frequency in [1.0, 2.0, 3.0, 4.5] {
                // 720 (or 72) grid points per axis fall evenly on these checks.
                check_against_grid("checkerboard", dim, &[("frequency", frequency)], 1e-12);
            }
        }
    }

    #[test]
    fn aligned_strata_have_no_variance_and_coarse_ones_no_gain() {
        for dim in 1..=4u32 {
            for frequency in [7u64, 12] {
                let board = build("checkerboard", dim as usize, &[("frequency", frequency as f64)]);
                for multiple in [1, 2, 3] {
                    let n = (frequency * multiple).pow(dim);
                    assert_eq!(board.exact_variance("jittered", n), Some(0.0));
                }
            }
            let board = build("checkerboard", dim as usize, &[("frequency", 64.0)]);
            for k in [1u64, 2, 4, 8, 16, 32] {
                let n = k.pow(dim);
                assert_eq!(board.exact_variance("jittered", n), board.exact_variance("random", n));
            }
        }
    }
}
