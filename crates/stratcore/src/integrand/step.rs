//! An edge along the axes.

use super::catalogue::{IntegrandInfo, MAX_DIM, ParamInfo};
use super::exact::variance_of_mean;
use super::{Alignment, Integrand, Reference, Regularity};
use std::f64::consts::FRAC_1_SQRT_2;

pub(super) const STEP: IntegrandInfo = IntegrandInfo {
    name: "step",
    summary: "1 where x0 < edge: an edge that the strata can be aligned with",
    params: &[ParamInfo {
        name: "edge",
        default: FRAC_1_SQRT_2,
        meaning: "where f falls from 1 to 0 along x0",
        min: 0.0,
        max: 1.0,
    }],
    min_dim: 1,
    max_dim: MAX_DIM,
    build: |dim, params| Box::new(Step { dim, edge: params[0] }),
};

struct Step {
    dim: usize,
    edge: f64,
}

impl Integrand for Step {
    fn dim(&self) -> usize {
        self.dim
    }
    fn eval(&self, point: &[f64]) -> f64 {
        f64::from(u8::from(point[0] < self.edge))
    }
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: self.edge, std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        if self.edge == 0.0 || self.edge == 1.0 {
            return Regularity::Constant;
        }
        Regularity::Discontinuous { discontinuity_dim: self.dim as f64 - 1.0 }
    }
    fn alignment(&self) -> Alignment {
        Alignment::Additive
    }
    /// One layer of k^(d-1) strata is cut, at the fraction q of its thickness.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        variance_of_mean(sampler, n, self.dim, |k| {
            let k = k as f64;
            let q = (k * self.edge).fract();
            Some(q * (1.0 - q) * k.powi(self.dim as i32 - 1))
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::integrand::test_support::{build, check_against_grid};

    #[test]
    fn moments_match_a_grid() {
        for dim in 1..=3 {
            // 720 or 72 grid points along the axis: the edge lies half way between two.
            check_against_grid("step", dim, &[("edge", 0.625)], 1e-12);
        }
    }

    #[test]
    fn an_edge_between_strata_has_no_variance() {
        for dim in 1..=4u32 {
            let step = build("step", dim as usize, &[("edge", 0.5)]);
            for k in 1..=8u64 {
                let variance = step.exact_variance("jittered", k.pow(dim)).unwrap();
                assert_eq!(variance == 0.0, k % 2 == 0, "{k} {variance}");
            }
        }
    }
}
