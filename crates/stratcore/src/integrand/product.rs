//! Smooth products of functions of one coordinate each.

use super::catalogue::{IntegrandInfo, MAX_DIM, ParamInfo};
use super::exact::{
    AxisMoments, MAX_STRATA, generic_centre, product_strata_variance, variance_of_mean,
};
use super::quadrature::{axis_moments, integral};
use super::{Integrand, Reference, Regularity};
use statrs::function::erf::erf;
use std::f64::consts::{FRAC_PI_2, SQRT_2, TAU};

pub(super) const GAUSSIAN: IntegrandInfo = IntegrandInfo {
    name: "gaussian",
    summary: "a Gaussian bump near the cube's centre: smooth and curved",
    params: &[ParamInfo {
        name: "width",
        default: 0.25,
        meaning: "standard deviation of the bump; the cube has side 1",
        min: 0.01,
        max: 100.0,
    }],
    min_dim: 1,
    max_dim: MAX_DIM,
    build: |dim, params| {
        let centre = (0..dim).map(generic_centre).collect();
        Box::new(Gaussian { centre, width: params[0] })
    },
};

pub(super) const COSINES: IntegrandInfo = IntegrandInfo {
    name: "cosines",
    summary: "product of cosines of one frequency: smooth, as fine as asked",
    params: &[ParamInfo {
        name: "frequency",
        default: 0.4,
        meaning: "cycles across the cube along each axis",
        min: 0.0,
        max: 1000.0,
    }],
    min_dim: 1,
    max_dim: MAX_DIM,
    build: |dim, params| Box::new(Cosines { dim, frequency: params[0] }),
};

pub(super) const MULTILINEAR: IntegrandInfo = IntegrandInfo {
    name: "multilinear",
    summary: "product of the coordinates: smooth, neither additive nor periodic",
    params: &[],
    min_dim: 1,
    max_dim: MAX_DIM,
    build: |dim, _| Box::new(Multilinear(dim)),
};

/// Π xᵢ
struct Multilinear(usize);

impl Integrand for Multilinear {
    fn dim(&self) -> usize {
        self.0
    }
    fn eval(&self, point: &[f64]) -> f64 {
        point.iter().product()
    }
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: 0.5f64.powi(self.0 as i32), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Smooth
    }
    fn regularity_on_torus(&self) -> Regularity {
        Regularity::Discontinuous { discontinuity_dim: self.0 as f64 - 1.0 }
    }
    fn mean_square_gradient(&self) -> Option<f64> {
        Some(product_gradient(std::iter::repeat_n([1.0 / 3.0, 1.0], self.0)))
    }
    /// A stratum of the axis has its centre for mean and 1/(12 k²) for variance.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        variance_of_mean(sampler, n, self.0, |k| {
            let k = k as f64;
            let variances = 1.0 / (12.0 * k);
            let axis = AxisMoments { squared_means: k / 3.0 - variances, variances };
            Some(product_strata_variance(std::iter::repeat_n(axis, self.0)))
        })
    }
}

/// ∫|∇f|² of a product f(x) = Π gᵢ(xᵢ), from each axis's ∫g² and ∫g'².
fn product_gradient(axes: impl IntoIterator<Item = [f64; 2]>) -> f64 {
    let (mut gradient, mut square) = (0.0, 1.0);
    for [g, slope] in axes {
        gradient = gradient * g + square * slope;
        square *= g;
    }
    gradient
}

/// exp(-|x - c|² / 2w²)
struct Gaussian {
    centre: Vec<f64>,
    width: f64,
}

impl Integrand for Gaussian {
    fn dim(&self) -> usize {
        self.centre.len()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let distance_sq: f64 = self.centre.iter().zip(point).map(|(c, x)| (x - c).powi(2)).sum();
        (-0.5 * distance_sq / (self.width * self.width)).exp()
    }
    fn reference(&self) -> Option<Reference> {
        let mean = |c: &f64| {
            let from_centre = |x: f64| erf(x / (self.width * SQRT_2));
            self.width * FRAC_PI_2.sqrt() * (from_centre(1.0 - c) + from_centre(*c))
        };
        Some(Reference { mean: self.centre.iter().map(mean).product(), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Smooth
    }
    fn regularity_on_torus(&self) -> Regularity {
        Regularity::Discontinuous { discontinuity_dim: self.dim() as f64 - 1.0 }
    }
    fn mean_square_gradient(&self) -> Option<f64> {
        let width_sq = self.width * self.width;
        Some(product_gradient(self.centre.iter().map(|c| {
            let g_sq = |x: f64| (-(x - c).powi(2) / width_sq).exp();
            let slope_sq = |x: f64| (x - c).powi(2) / (width_sq * width_sq) * g_sq(x);
            [integral(self.width, g_sq), integral(self.width, slope_sq)]
        })))
    }
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        let dim = self.centre.len();
        variance_of_mean(sampler, n, dim, |k| {
            (k <= MAX_STRATA).then(|| {
                product_strata_variance(self.centre.iter().map(|c| {
                    let g = |x: f64| (-0.5 * ((x - c) / self.width).powi(2)).exp();
                    axis_moments(k, self.width, g)
                }))
            })
        })
    }
}

/// Π cos(2π f xᵢ)
struct Cosines {
    dim: usize,
    frequency: f64,
}

impl Integrand for Cosines {
    fn dim(&self) -> usize {
        self.dim
    }
    fn eval(&self, point: &[f64]) -> f64 {
        point.iter().map(|x| (TAU * self.frequency * x).cos()).product()
    }
    fn reference(&self) -> Option<Reference> {
        let cycle = TAU * self.frequency;
        let mean = if cycle == 0.0 { 1.0 } else { cycle.sin() / cycle };
        Some(Reference { mean: mean.powi(self.dim as i32), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        if self.frequency == 0.0 { Regularity::Constant } else { Regularity::Smooth }
    }
    fn regularity_on_torus(&self) -> Regularity {
        if self.frequency.fract() == 0.0 {
            return self.regularity();
        }
        Regularity::Discontinuous { discontinuity_dim: self.dim as f64 - 1.0 }
    }
    fn mean_square_gradient(&self) -> Option<f64> {
        let cycle = TAU * self.frequency;
        // ∫ cos² and ∫ sin² over [0, 1].
        let half_wave = if cycle == 0.0 { 0.5 } else { 0.25 * (2.0 * cycle).sin() / cycle };
        let axis = [0.5 + half_wave, cycle * cycle * (0.5 - half_wave)];
        Some(product_gradient(std::iter::repeat_n(axis, self.dim)))
    }
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        if self.frequency == 0.0 {
            return variance_of_mean(sampler, n, self.dim, |_| Some(0.0));
        }
        variance_of_mean(sampler, n, self.dim, |k| {
            let quarter_cycle = 0.25 / self.frequency;
            (k <= MAX_STRATA).then(|| {
                let axis = axis_moments(k, quarter_cycle, |x| (TAU * self.frequency * x).cos());
                product_strata_variance(std::iter::repeat_n(axis, self.dim))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::integrand::test_support::{build, check_against_grid};
    use std::f64::consts::TAU;

    #[test]
    fn moments_match_a_grid() {
        for dim in 1..=3 {
            check_against_grid("gaussian", dim, &[], 2e-3);
            check_against_grid("cosines", dim, &[("frequency", 1.3)], 2e-3);
            check_against_grid("multilinear", dim, &[], 2e-3);
        }
    }

    #[test]
    fn gradients_match_differences() {
        for (name, params) in [
            ("gaussian", &[("width", 0.2)][..]),
            ("cosines", &[("frequency", 0.7)]),
            ("multilinear", &[]),
        ] {
            let f = build(name, 2, params);
            let (m, h) = (200, 1e-5);
            let at = |i: usize| (i as f64 + 0.5) / m as f64;
            let square = |x: f64, y: f64| {
                let slope = |a: [f64; 2], b: [f64; 2]| (f.eval(&a) - f.eval(&b)) / (2.0 * h);
                slope([x + h, y], [x - h, y]).powi(2) + slope([x, y + h], [x, y - h]).powi(2)
            };
            let sum: f64 = (0..m * m).map(|i| square(at(i / m), at(i % m))).sum();
            let (grid, exact) = (sum / (m * m) as f64, f.mean_square_gradient().unwrap());
            assert!((grid / exact - 1.0).abs() < 1e-3, "{name}: {grid} {exact}");
        }
    }

    #[test]
    fn a_cosine_has_elementary_moments() {
        let frequency = 0.4;
        let cosine = build("cosines", 1, &[("frequency", frequency)]);
        let w = TAU * frequency;
        for k in [1u64, 2, 5, 64] {
            let h = 1.0 / k as f64;
            let sum: f64 = (0..k)
                .map(|j| {
                    let (a, b) = (w * h * j as f64, w * h * (j + 1) as f64);
                    let mean = (b.sin() - a.sin()) / (w * h);
                    let square = 0.5 + ((2.0 * b).sin() - (2.0 * a).sin()) / (4.0 * w * h);
                    square - mean * mean
                })
                .sum();
            let exact = cosine.exact_variance("jittered", k).unwrap() * (k * k) as f64;
            assert!((exact / sum - 1.0).abs() < 1e-10, "{k}: {exact} {sum}");
        }
    }

    /// Smooth f: N^(1 + 2/d) Var tends to the mean of |∇f|²/12.
    #[test]
    fn fine_strata_see_the_gradient() {
        for frequency in [0.4, 3.0] {
            let k = 100_000u64;
            let w = TAU * frequency;
            let gradient_sq = w * w * (0.5 - (2.0 * w).sin() / (4.0 * w));
            let cosine = build("cosines", 1, &[("frequency", frequency)]);
            let variance = cosine.exact_variance("jittered", k).unwrap() * (k as f64).powi(3);
            assert!((variance * 12.0 / gradient_sq - 1.0).abs() < 1e-6, "{variance}");
        }
    }
}
