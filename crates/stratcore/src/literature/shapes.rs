//! Integrands and one sampler that only claims need: features at random places, sums over
//! pairs of coordinates, single waves, and the Sobol' sequence without its first point.

use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{Kind, PointSet, Points, Sampler, Scramble, Sobol};
use statrs::distribution::{ContinuousCDF, Normal};
use std::f64::consts::TAU;

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

/// The Sobol' sequence from its second point on, as some programs hand it out.
pub(super) struct SobolFromSecond;

impl Sampler for SobolFromSecond {
    fn name(&self) -> &'static str {
        "sobol without its first point"
    }
    fn summary(&self) -> &'static str {
        "points 1 to N of the Sobol' sequence"
    }
    fn source(&self) -> &'static str {
        "Owen 2020"
    }
    fn stream_id(&self) -> u8 {
        254
    }
    fn kind(&self) -> Kind {
        Kind::Sequence
    }
    fn max_dim(&self) -> usize {
        Sobol.max_dim()
    }
    fn scrambles(&self) -> &'static [Scramble] {
        Sobol.scrambles()
    }
    fn is_randomised(&self, scramble: Scramble) -> bool {
        Sobol.is_randomised(scramble)
    }
    fn admits(&self, n: u64, dim: usize, rectangular: bool) -> bool {
        Sobol.admits(n + 1, dim, rectangular)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        Sobol.neighbours(n, dim)
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        // One point more: the last index has to be there.
        let key = StreamKey { n_samples: set.key.n_samples + 1, ..set.key };
        Box::new(FromSecond(Sobol.construct(&PointSet { key, ..*set })))
    }
}

struct FromSecond(Box<dyn Points>);

impl Points for FromSecond {
    fn fill(&self, first: u64, points: &mut [f64]) {
        self.0.fill(first + 1, points);
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

    #[test]
    fn the_second_point_comes_first() {
        let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 8, n_samples: 9, trial: 0 };
        let set = |n_samples| PointSet {
            key: StreamKey { n_samples, ..key },
            dim: 2,
            scramble: Scramble::Owen,
            rectangular: false,
        };
        let (mut whole, mut rest) = ([0.0; 18], [0.0; 16]);
        Sobol.points(&set(9)).fill(0, &mut whole);
        SobolFromSecond.points(&set(8)).fill(0, &mut rest);
        assert_eq!(whole[2..], rest);
    }
}
