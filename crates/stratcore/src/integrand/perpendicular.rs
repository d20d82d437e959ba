//! The form factor between perpendicular squares: an oracle in four dimensions beside the paper's
//! parallel squares.

use super::catalogue::{IntegrandInfo, ParamInfo};
use super::exact::{MAX_STRATA, variance_of_mean};
use super::form_factor::axes;
use super::quadrature::composite;
use super::{Integrand, Reference, Regularity};
use crate::variance::neumaier_sum;
use std::f64::consts::PI;

pub(super) const PERPENDICULAR: IntegrandInfo = IntegrandInfo {
    name: "form-factor-perpendicular",
    summary: "form factor of unit squares on the two sides of a right angle",
    params: &[ParamInfo {
        name: "gap",
        default: 0.5,
        meaning: "distance of both from the line where their planes meet; with none the variance \
                  is infinite",
        min: 0.05,
        max: 100.0,
    }],
    min_dim: 4,
    max_dim: 4,
    build: |_, params| Box::new(Perpendicular { gap: params[0] }),
};

/// f = x z / (π r⁴) between (x, y, 0) and (0, η, z), x and z from the gap on.
struct Perpendicular {
    gap: f64,
}

impl Perpendicular {
    /// f from x, z and the offset y - η.
    #[inline(always)]
    fn at(x: f64, z: f64, offset: f64) -> f64 {
        let distance_sq = x * x + offset * offset + z * z;
        x * z / (PI * distance_sq * distance_sq)
    }

    /// The variances of f within the k⁴ strata, summed. f depends on y and η by their offset
    /// alone, which has the density 1 - |α| over a pair of strata; on the sign of it, and on the
    /// order of x and z, it does not depend.
    fn strata_variance(&self, k: u64) -> Option<f64> {
        /// Enough for 1e-12 of f: it is analytic but for points a gap away from a panel as long
        /// as the gap, where the rule's error falls as 6^(-2 nodes).
        const NODES: usize = 8;
        if k.checked_pow(4)? > MAX_STRATA {
            return None;
        }
        let side = 1.0 / k as f64;
        let panels = (side / self.gap).ceil().max(1.0) as u64;
        let along = composite(NODES, panels);
        // Both halves of the tent over (-1, 1).
        let tent = |(a, w): &(f64, f64)| [(-a, w * (1.0 - a)), (*a, w * (1.0 - a))];
        let offsets: Vec<_> = along.iter().flat_map(tent).collect();
        let stratum = |i: u64, j: u64, apart: u64| {
            let sum = |g: &dyn Fn(f64) -> f64| {
                let mut sum = 0.0;
                for (x, wx) in &along {
                    let x = self.gap + (i as f64 + x) * side;
                    for (z, wz) in &along {
                        let z = self.gap + (j as f64 + z) * side;
                        let part =
                            |(a, w): &(f64, f64)| w * g(Self::at(x, z, (apart as f64 + a) * side));
                        sum += wx * wz * offsets.iter().map(part).sum::<f64>();
                    }
                }
                sum
            };
            let mean = sum(&|f| f);
            sum(&|f| (f - mean).powi(2))
        };
        let times = |twice: bool| if twice { 2.0 } else { 1.0 };
        let pairs = (0..k).flat_map(|i| (0..=i).map(move |j| (i, j)));
        Some(neumaier_sum(pairs.flat_map(|(i, j)| {
            (0..k).map(move |apart| {
                times(i != j) * times(apart > 0) * (k - apart) as f64 * stratum(i, j, apart)
            })
        })))
    }
}

impl Integrand for Perpendicular {
    fn dim(&self) -> usize {
        4
    }
    fn axes(&self) -> Vec<String> {
        axes()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let &[u, y, eta, v] = point else { return f64::NAN };
        Self::at(self.gap + u, self.gap + v, y - eta)
    }
    /// A sum over the corners of both (J. R. Ehlert, T. F. Smith, *View Factors for
    /// Perpendicular and Parallel Rectangular Plates*, Journal of Thermophysics and Heat
    /// Transfer 7(1), 1993).
    fn reference(&self) -> Option<Reference> {
        let ends = [self.gap, self.gap + 1.0];
        let corner = |x: f64, across: f64, z: f64| {
            let sum = x * x + z * z;
            let k = across / sum.sqrt();
            let logarithm = (sum * (1.0 + k * k)).ln();
            across * sum.sqrt() * k.atan() - 0.25 * sum * (1.0 - k * k) * logarithm
        };
        // y - η is 0 at two pairs of corners, 1 at one and -1 at one; the last two are equal.
        let along = |x, z| 2.0 * corner(x, 0.0, z) - 2.0 * corner(x, 1.0, z);
        let [a, b] = ends;
        let mean = (along(a, a) + along(b, b) - 2.0 * along(a, b)) / (2.0 * PI);
        Some(Reference { mean, std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Smooth
    }
    /// By quadrature over each stratum.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        variance_of_mean(sampler, n, 4, |k| self.strata_variance(k))
    }
}

#[cfg(test)]
mod tests {
    use crate::integrand::gauss_legendre;
    use crate::integrand::test_support::{build, check_against_grid};

    /// Against Gauss' rule in four dimensions, whose error at 24 nodes is below 1e-9.
    #[test]
    fn mean_and_variance_match_quadrature() {
        let rule = gauss_legendre(24);
        for gap in [0.5, 1.0, 3.0] {
            let f = build("form-factor-perpendicular", 4, &[("gap", gap)]);
            let [mut sum, mut squares] = [0.0; 2];
            let exact = f.reference().unwrap().mean;
            for (a, wa) in &rule {
                for (b, wb) in &rule {
                    for (c, wc) in &rule {
                        for (d, wd) in &rule {
                            let (weight, value) = (wa * wb * wc * wd, f.eval(&[*a, *b, *c, *d]));
                            sum += weight * value;
                            squares += weight * (value - exact).powi(2);
                        }
                    }
                }
            }
            assert!((sum / exact - 1.0).abs() < 1e-7, "{gap}: {sum} {exact}");
            let variance = f.exact_variance("random", 1).unwrap();
            assert!((squares / variance - 1.0).abs() < 1e-7, "{gap}: {squares} {variance}");
        }
    }

    #[test]
    fn moments_match_a_grid() {
        check_against_grid("form-factor-perpendicular", 4, &[("gap", 1.0)], 1e-2);
        check_against_grid("form-factor-perpendicular", 4, &[("gap", 100.0)], 1e-2);
    }
}
