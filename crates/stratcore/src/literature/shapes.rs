//! Integrands that only claims need: features at random places, sums over pairs of coordinates,
//! single waves.

use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Sampler};
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

/// 1 where n·x < t, in the plane.
pub(super) struct Line {
    pub(super) normal: [f64; 2],
    pub(super) threshold: f64,
}

impl Line {
    /// At an angle, with `u` in [0, 1) uniform over every offset that meets the square. Its
    /// mean length within the square is 1 / (|cos| + |sin|).
    pub(super) fn placed(angle: f64, u: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        let low = cos.min(0.0) + sin.min(0.0);
        Self { normal: [cos, sin], threshold: low + u * (cos.abs() + sin.abs()) }
    }
}

impl Integrand for Line {
    fn dim(&self) -> usize {
        2
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let along = self.normal[0] * point[0] + self.normal[1] * point[1];
        f64::from(u8::from(along < self.threshold))
    }
}

/// 1 inside a circle.
pub(super) struct Circle {
    pub(super) centre: [f64; 2],
    pub(super) radius: f64,
}

impl Integrand for Circle {
    fn dim(&self) -> usize {
        2
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let [x, y] = [point[0] - self.centre[0], point[1] - self.centre[1]];
        f64::from(u8::from(x * x + y * y < self.radius * self.radius))
    }
}

/// 1 between two places on the unit interval: two steps; one if the pulse starts at 0.
pub(super) struct Pulse {
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Integrand for Pulse {
    fn dim(&self) -> usize {
        1
    }
    fn eval(&self, point: &[f64]) -> f64 {
        f64::from(u8::from((self.from..self.to).contains(&point[0])))
    }
}

/// cos(2π(ν·x + phase))
pub(super) struct Wave {
    pub(super) frequency: [f64; 2],
    pub(super) phase: f64,
}

impl Integrand for Wave {
    fn dim(&self) -> usize {
        2
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let [a, b] = self.frequency;
        (TAU * (a * point[0] + b * point[1] + self.phase)).cos()
    }
}

/// f², to learn the mean square of the samples.
pub(super) struct Squared<'a>(pub(super) &'a dyn Integrand);

impl Integrand for Squared<'_> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        self.0.eval(point).powi(2)
    }
}

/// A function of each pair of neighbouring coordinates, summed.
pub(super) struct PairSum {
    pub(super) dim: usize,
    pub(super) pair: fn(f64, f64) -> f64,
}

impl Integrand for PairSum {
    fn dim(&self) -> usize {
        self.dim
    }
    fn eval(&self, point: &[f64]) -> f64 {
        point.windows(2).map(|xy| (self.pair)(xy[0], xy[1])).sum()
    }
}

/// Π (xᵢ - 1/2): nothing but an interaction of all coordinates.
pub(super) struct Interaction(pub(super) usize);

impl Integrand for Interaction {
    fn dim(&self) -> usize {
        self.0
    }
    fn eval(&self, point: &[f64]) -> f64 {
        point.iter().map(|x| x - 0.5).product()
    }
}

/// An integrand whose trial means are normal with variance N^-1, whatever the sampler: what a
/// fit makes of noise alone.
pub(super) struct NormalMeans;

impl Integrand for NormalMeans {
    fn dim(&self) -> usize {
        2
    }
    fn eval(&self, point: &[f64]) -> f64 {
        Normal::standard().inverse_cdf(point[0])
    }
    fn trial_means(
        &self,
        _sampler: &dyn Sampler,
        set: &PointSet,
        first_trial: u32,
        means: &mut [f64],
        _cancel: &AtomicBool,
    ) -> bool {
        let scale = (set.key.n_samples as f64).sqrt().recip();
        for (trial, mean) in (first_trial..).zip(means) {
            let [u, _] = StreamKey { trial, ..set.key }.stream().pair(0);
            // The middle of the 2^-48 that u stands for: never 0.
            *mean = scale * Normal::standard().inverse_cdf(u + 2f64.powi(-49));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_placed_line_covers_what_its_offset_says() {
        for angle in [0.0, 0.4, 1.0, 2.0, 4.0] {
            for (u, covered) in [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0)] {
                let line = Line::placed(angle, u);
                let at = |i: u32| (f64::from(i) + 0.5) / 200.0;
                let sum: f64 = (0..40_000).map(|i| line.eval(&[at(i / 200), at(i % 200)])).sum();
                assert!((sum / 40_000.0 - covered).abs() < 5e-3, "{angle} {u}: {sum}");
            }
        }
    }
}
