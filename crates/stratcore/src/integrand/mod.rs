//! What is sampled: a function on the unit cube whose mean is wanted.
//!
//! Besides the trait, the closed-form integrands of [`CATALOGUE`]: each knows its exact mean,
//! its regularity, and its exact variance under the paper's two samplers where one exists.

mod catalogue;
mod checkerboard;
mod disk;
mod disks;
mod exact;
mod form_factor;
mod half_space;
mod koch;
mod linear;
mod perpendicular;
mod product;
pub(crate) mod quadrature;
mod rough_edge;
mod step;
#[cfg(test)]
mod test_support;

pub(crate) use quadrature::gauss_legendre;

pub use catalogue::{CATALOGUE, IntegrandError, IntegrandInfo, ParamInfo, by_name};

use crate::sampler::{PointSet, Sampler};
use serde::Serialize;
use std::sync::atomic::AtomicBool;

/// A function f on [0, 1)^d.
pub trait Integrand: Sync {
    /// Dimensions d, at least 1: what the function requires and no more.
    fn dim(&self) -> usize;

    /// Name of each axis, `dim` of them: "pixel_x", "lens_u", "x0".
    fn axes(&self) -> Vec<String> {
        (0..self.dim()).map(|i| format!("x{i}")).collect()
    }

    /// f at one point of `dim` coordinates in [0, 1).
    fn eval(&self, point: &[f64]) -> f64;

    /// f at many points: `points` is row-major `[values.len(), dim]`.
    fn eval_block(&self, points: &[f64], values: &mut [f64]) {
        for (value, point) in values.iter_mut().zip(points.chunks_exact(self.dim())) {
            *value = self.eval(point);
        }
    }

    /// Whether an estimate is the weighted mean Σ w f / Σ w; then [`Integrand::eval_block`]
    /// gives w f and [`Integrand::weigh_block`] w.
    fn is_weighted(&self) -> bool {
        false
    }

    /// Weights w at many points, as [`Integrand::eval_block`]; called only where
    /// [`Integrand::is_weighted`].
    fn weigh_block(&self, _points: &[f64], weights: &mut [f64]) {
        weights.fill(1.0);
    }

    /// A faster way to the means of trials `first_trial ..`, where this integrand has one for
    /// this sampler: overwrites `means` and returns true. Otherwise the points are drawn and
    /// evaluated one by one ([`crate::trial`]). Once `cancel` is set, what is written means
    /// nothing.
    fn trial_means(
        &self,
        _sampler: &dyn Sampler,
        _set: &PointSet,
        _first_trial: u32,
        _means: &mut [f64],
        _cancel: &AtomicBool,
    ) -> bool {
        false
    }

    /// The mean of f, where it is known.
    fn reference(&self) -> Option<Reference> {
        None
    }

    /// What is known of f's smoothness, for [`theory`](crate::theory).
    fn regularity(&self) -> Regularity {
        Regularity::Unknown
    }

    /// The same where opposite faces of the cube are joined, as a torus shift joins them: a
    /// smooth f that is not periodic jumps there.
    fn regularity_on_torus(&self) -> Regularity {
        match self.regularity() {
            Regularity::Smooth => Regularity::Unknown,
            Regularity::Discontinuous { discontinuity_dim } => Regularity::Discontinuous {
                discontinuity_dim: discontinuity_dim.max(self.dim() as f64 - 1.0),
            },
            same => same,
        }
    }

    /// How f lies to the axes.
    fn alignment(&self) -> Alignment {
        Alignment::General
    }

    /// ∫|∇f|² over the cube, where a closed form or quadrature gives it: the constant of
    /// stratified sampling of a smooth f.
    fn mean_square_gradient(&self) -> Option<f64> {
        None
    }

    /// The exact variance of the mean of `n` points of this sampler (unscrambled `random`, or
    /// `jittered` with n = k^d), where a closed form exists.
    fn exact_variance(&self, _sampler: &str, _n: u64) -> Option<f64> {
        None
    }
}

/// An integrand is as good by reference.
impl<I: Integrand + ?Sized> Integrand for &I {
    fn dim(&self) -> usize {
        (**self).dim()
    }
    fn axes(&self) -> Vec<String> {
        (**self).axes()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        (**self).eval(point)
    }
    fn eval_block(&self, points: &[f64], values: &mut [f64]) {
        (**self).eval_block(points, values);
    }
    fn is_weighted(&self) -> bool {
        (**self).is_weighted()
    }
    fn weigh_block(&self, points: &[f64], weights: &mut [f64]) {
        (**self).weigh_block(points, weights);
    }
    fn trial_means(
        &self,
        sampler: &dyn Sampler,
        set: &PointSet,
        first_trial: u32,
        means: &mut [f64],
        cancel: &AtomicBool,
    ) -> bool {
        (**self).trial_means(sampler, set, first_trial, means, cancel)
    }
    fn reference(&self) -> Option<Reference> {
        (**self).reference()
    }
    fn regularity(&self) -> Regularity {
        (**self).regularity()
    }
    fn regularity_on_torus(&self) -> Regularity {
        (**self).regularity_on_torus()
    }
    fn alignment(&self) -> Alignment {
        (**self).alignment()
    }
    fn mean_square_gradient(&self) -> Option<f64> {
        (**self).mean_square_gradient()
    }
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        (**self).exact_variance(sampler, n)
    }
}

/// A known mean and how far it may be off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Reference {
    /// The mean of f.
    pub mean: f64,
    /// Its standard error; 0 for a closed form.
    pub std_error: f64,
}

/// The feature of f that decides how fast stratified estimates converge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Regularity {
    /// f is constant: every estimate is exact.
    Constant,
    /// f is Lipschitz.
    Smooth,
    /// f jumps across a set of this dimension k, fractal or not; d - 1 for an edge.
    Discontinuous {
        /// k
        discontinuity_dim: f64,
    },
    /// Nothing is known.
    Unknown,
}

/// How an integrand lies to the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Alignment {
    /// A sum of functions of one coordinate each; one of them may be all there is.
    Additive,
    /// Anything else, or not known.
    General,
}
