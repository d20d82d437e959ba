//! The paper's four-dimensional experiment: the form factor between two squares.
//!
//! Source: Mitchell 1996, "A four-dimensional experiment".

use super::catalogue::{IntegrandInfo, ParamInfo};
use super::exact::{MAX_STRATA, variance_of_mean};
use super::quadrature::gauss_legendre;
use super::{Integrand, Reference, Regularity};
use crate::variance::neumaier_sum;
use std::f64::consts::PI;

pub(super) const FORM_FACTOR: IntegrandInfo = IntegrandInfo {
    name: "form-factor",
    summary: "form factor of parallel unit squares two apart, with or without an occluder",
    params: &[ParamInfo {
        name: "occluder",
        default: 0.0,
        meaning: "side of an aligned square half way that blocks; 0 for none, 1 blocks all",
        min: 0.0,
        max: 1.0,
    }],
    min_dim: 4,
    max_dim: 4,
    build: |_, params| Box::new(FormFactor { occluder: params[0] }),
};

/// A point of the one and a point of the other.
pub(super) fn axes() -> Vec<String> {
    ["from_u", "from_v", "to_u", "to_v"].map(str::to_owned).to_vec()
}

/// f = V cos²θ / (π r²) between a point (x0, x1) of one square and (x2, x3) of the other.
struct FormFactor {
    /// Side of the occluder.
    occluder: f64,
}

/// cos²θ / (π r²) over the offset (a, b) between the two points: both cosines are 2/r.
#[inline(always)]
fn unoccluded(a: f64, b: f64) -> f64 {
    let distance_sq = 4.0 + a * a + b * b;
    4.0 / (PI * distance_sq * distance_sq)
}

impl FormFactor {
    /// For each pair of strata (i, j) of k along one axis of both squares, at i k + j.
    fn axis_pairs(&self, k: u64) -> Vec<AxisPair> {
        let rule = gauss_legendre(10);
        (0..k)
            .flat_map(|i| (0..k).map(move |j| (i as f64, j as f64)))
            .map(|(i, j)| AxisPair::new(i, j, k as f64, self.occluder, &rule))
            .collect()
    }

    /// Mean of f: the only stratum of a grid with one per axis.
    fn mean(&self) -> f64 {
        let [pair] = &self.axis_pairs(1)[..] else { return f64::NAN };
        pair.visible_with(pair, unoccluded)
    }
}

impl Integrand for FormFactor {
    fn dim(&self) -> usize {
        4
    }
    fn axes(&self) -> Vec<String> {
        axes()
    }
    /// The ray is half way at ((x0 + x2)/2, (x1 + x3)/2).
    fn eval(&self, point: &[f64]) -> f64 {
        let &[x0, x1, x2, x3] = point else { return f64::NAN };
        let blocked =
            (x0 + x2 - 1.0).abs() < self.occluder && (x1 + x3 - 1.0).abs() < self.occluder;
        if blocked { 0.0 } else { unoccluded(x0 - x2, x1 - x3) }
    }
    /// By quadrature, to rounding error; without an occluder 0.0685895888185526.
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: self.mean(), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        match self.occluder {
            0.0 => Regularity::Smooth,
            1.0 => Regularity::Constant,
            _ => Regularity::Discontinuous { discontinuity_dim: 3.0 },
        }
    }
    /// By quadrature over each stratum.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        variance_of_mean(sampler, n, 4, |k| {
            if k.checked_pow(4)? > MAX_STRATA {
                return None;
            }
            let pairs = self.axis_pairs(k);
            Some(neumaier_sum(pairs.iter().flat_map(|p| pairs.iter().map(|q| p.variance(q)))))
        })
    }
}

/// What two strata of one axis, i on one square and j on the other, have between them.
///
/// With x = (i + ξ)/k and y = (j + η)/k the integrand depends on α = ξ - η through the offset
/// x - y, and on γ = ξ + η through the occluder, |x + y - 1| < side. On the diamond
/// |α| ≤ γ ≤ 2 - |α| the density of (α, γ) is 1/2.
struct AxisPair {
    nodes: Vec<Node>,
    /// Part of the pair that is inside the occluder's slab.
    inside: f64,
}

/// A value of α and its share of the pair, by whether the ray passes the occluder's slab.
struct Node {
    offset: f64,
    inside: f64,
    outside: f64,
}

impl AxisPair {
    fn new(i: f64, j: f64, k: f64, occluder: f64, rule: &[(f64, f64)]) -> Self {
        // γ between these ends is inside the slab.
        let slab = [k * (1.0 - occluder) - (i + j), k * (1.0 + occluder) - (i + j)];
        // Shares of α inside the slab, and outside on either hand of it.
        let shares = |alpha: f64| {
            let [lo, hi] = [alpha.abs(), 2.0 - alpha.abs()];
            let length = |from: f64, to: f64| 0.5 * (to - from).max(0.0);
            let inside = length(lo.max(slab[0]), hi.min(slab[1]));
            [inside, length(lo, hi.min(slab[0])) + length(lo.max(slab[1]), hi)]
        };
        // Between these the share of each node is linear in α.
        let mut kinks = vec![-1.0, 0.0, 1.0];
        for end in slab.into_iter().flat_map(|gamma| [gamma, 2.0 - gamma]) {
            if 0.0 < end && end < 1.0 {
                kinks.extend([-end, end]);
            }
        }
        kinks.sort_by(f64::total_cmp);
        let mut nodes = Vec::new();
        for piece in kinks.windows(2).filter(|piece| piece[1] > piece[0]) {
            let length = piece[1] - piece[0];
            for (x, weight) in rule {
                let alpha = piece[0] + x * length;
                let [inside, outside] = shares(alpha).map(|share| share * weight * length);
                nodes.push(Node { offset: (i - j + alpha) / k, inside, outside });
            }
        }
        let inside = nodes.iter().map(|node| node.inside).sum();
        Self { nodes, inside }
    }

    /// Mean of `g` V over the stratum that this pair makes with another one across.
    fn visible_with(&self, across: &Self, g: impl Fn(f64, f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for p in &self.nodes {
            for q in &across.nodes {
                let visible = p.outside * (q.inside + q.outside) + p.inside * q.outside;
                sum += visible * g(p.offset, q.offset);
            }
        }
        sum
    }

    /// Variance of f V within that stratum: with m its mean, the visible part's (f - m)² and
    /// m² where it is blocked.
    fn variance(&self, across: &Self) -> f64 {
        let mean = self.visible_with(across, unoccluded);
        let visible = self.visible_with(across, |a, b| (unoccluded(a, b) - mean).powi(2));
        visible + self.inside * across.inside * mean * mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::test_support::{build, check_against_grid};

    #[test]
    fn the_known_form_factor() {
        let mean = build("form-factor", 4, &[]).reference().unwrap().mean;
        // Two ways to write the integral over aligned parallel squares: the published closed
        // form (Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, C-11)
        // with both sides at X = 1/2 of the distance, and this quadrature.
        let x: f64 = 0.5;
        let one = 1.0 + x * x;
        let closed = 2.0 / (PI * x * x)
            * ((one * one / (1.0 + 2.0 * x * x)).sqrt().ln()
                + 2.0 * x * one.sqrt() * (x / one.sqrt()).atan()
                - 2.0 * x * x.atan());
        assert!((mean - closed).abs() < 1e-15, "{mean} {closed}");
        assert!((mean - 0.068_589_588_818_552_6).abs() < 1e-15, "{mean}");
    }

    #[test]
    fn moments_match_a_grid() {
        check_against_grid("form-factor", 4, &[], 1e-2);
        // x + y - 1 takes multiples of 1/24 on the grid: these edges lie half way between two.
        for side in [11.0 / 48.0, 25.0 / 48.0, 37.0 / 48.0] {
            check_against_grid("form-factor", 4, &[("occluder", side)], 2e-2);
        }
    }

    #[test]
    fn a_full_occluder_blocks_all_and_a_vanishing_one_nothing() {
        let f = |side| build("form-factor", 4, &[("occluder", side)]);
        assert_eq!(f(1.0).reference().unwrap().mean, 0.0);
        assert_eq!(f(1.0).exact_variance("jittered", 81), Some(0.0));
        let [open, almost] =
            [0.0, 1e-6].map(|side| f(side).exact_variance("jittered", 81).unwrap());
        assert!((open / almost - 1.0).abs() < 1e-6);
    }
}
