//! Reconstruction filters: a pixel as a weighted mean of the picture about its centre.

use crate::integrand::gauss_legendre;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A separable filter and how its weights enter an estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter {
    /// Its shape along each axis.
    pub shape: FilterShape,
    /// Half its width, in pixels: weights are 0 beyond it.
    pub radius: f64,
    /// How weights enter.
    pub method: FilterMethod,
    profile: Profile,
}

/// Weights along one axis, x in pixels from the pixel's centre, r the radius.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FilterShape {
    /// 1
    Box,
    /// 1 - |x|/r
    Tent,
    /// exp(-x²/2σ²) - exp(-r²/2σ²), σ = r/3
    Gaussian,
    /// The cubic of B = C = 1/3, stretched from 2 to r (D. P. Mitchell, A. N. Netravali,
    /// *Reconstruction Filters in Computer Graphics*, SIGGRAPH 1988, equation 8); negative lobes
    Mitchell,
    /// sinc(x) sinc(x/r) (C. E. Duchon, *Lanczos Filtering in One and Two Dimensions*, Journal
    /// of Applied Meteorology 18, 1979); negative lobes
    Lanczos,
}

/// How a filter's weights enter an estimate from points x over its support.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FilterMethod {
    /// Uniform points, Σ w f / Σ w: what renderers do. Biased by O(1/N).
    #[default]
    WeightedMean,
    /// Uniform points, (support / ∫w) Σ w f / N: unbiased.
    WeightedSum,
    /// Points of density |w|, (∫|w| / ∫w) Σ sign(w) f / N: unbiased (M. Ernst, M. Stamminger,
    /// G. Greiner, *Filter Importance Sampling*, IEEE Symposium on Interactive Ray Tracing 2006).
    Importance,
}

impl FilterShape {
    /// The radius that is usual for this shape.
    pub fn usual_radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian => 1.5,
            Self::Mitchell => 2.0,
            Self::Lanczos => 3.0,
        }
    }

    fn weight(self, radius: f64, x: f64) -> f64 {
        let x = x.abs();
        if x > radius {
            return 0.0;
        }
        match self {
            Self::Box => 1.0,
            Self::Tent => 1.0 - x / radius,
            Self::Gaussian => {
                let exponential = |x: f64| (-4.5 * (x / radius).powi(2)).exp();
                exponential(x) - exponential(radius)
            }
            Self::Mitchell => {
                let x = 2.0 * x / radius;
                if x < 1.0 {
                    ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0
                } else {
                    (((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0) / 6.0
                }
            }
            Self::Lanczos => sinc(x) * sinc(x / radius),
        }
    }
}

impl std::fmt::Display for FilterShape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Box => "box",
            Self::Tent => "tent",
            Self::Gaussian => "gaussian",
            Self::Mitchell => "mitchell",
            Self::Lanczos => "lanczos",
        })
    }
}

impl std::fmt::Display for FilterMethod {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::WeightedMean => "weighted-mean",
            Self::WeightedSum => "weighted-sum",
            Self::Importance => "importance",
        })
    }
}

fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-8 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

impl Filter {
    /// A filter of this shape and radius.
    pub fn new(shape: FilterShape, radius: f64, method: FilterMethod) -> Self {
        Self { shape, radius, method, profile: Profile::new(shape, radius) }
    }

    /// Weight at (u, v) in [0, 1)² of the support.
    pub fn weight(&self, u: f64, v: f64) -> f64 {
        let along = |u: f64| self.shape.weight(self.radius, (2.0 * u - 1.0) * self.radius);
        along(u) * along(v)
    }

    /// Mean of the weights over the support.
    pub fn mean_weight(&self) -> f64 {
        (self.profile.signed / (2.0 * self.radius)).powi(2)
    }

    /// Where in the support, [0, 1)², a point of density |w| lies that has the shares (u, v) of
    /// |w| to its left and above, and what its value counts: ±(∫|w| / ∫w).
    pub fn place(&self, u: f64, v: f64) -> ([f64; 2], f64) {
        let [x, y] = [u, v].map(|share| self.profile.place(self.shape, self.radius, share));
        let sign = |x: f64| self.shape.weight(self.radius, x).signum();
        let gain = (self.profile.absolute() / self.profile.signed).powi(2);
        let within = |x: f64| ((x / self.radius + 1.0) / 2.0).clamp(0.0, 1.0);
        ([within(x), within(y)], sign(x) * sign(y) * gain)
    }
}

/// The integral of |w|, knot by knot; between knots w is smooth and of one sign.
#[derive(Debug, Clone, PartialEq)]
struct Profile {
    /// x and ∫|w| up to there.
    knots: Vec<[f64; 2]>,
    /// ∫w
    signed: f64,
    /// Nodes and weights that are exact to rounding between knots.
    rule: Vec<(f64, f64)>,
}

impl Profile {
    fn new(shape: FilterShape, radius: f64) -> Self {
        const INTERVALS: u32 = 96;
        const NODES: usize = 8;
        let rule = gauss_legendre(NODES);
        let w = |x: f64| shape.weight(radius, x);
        let mut ends: Vec<f64> = (0..=INTERVALS)
            .map(|i| radius * (2.0 * f64::from(i) / f64::from(INTERVALS) - 1.0))
            .collect();
        let crossings: Vec<f64> = ends
            .windows(2)
            .filter(|ends| w(ends[0]) * w(ends[1]) < 0.0)
            .map(|ends| root(ends[0], ends[1], w))
            .collect();
        ends.extend(crossings);
        ends.sort_by(f64::total_cmp);
        let (mut signed, mut absolute) = (0.0, 0.0);
        let mut knots = vec![[-radius, 0.0]];
        for pair in ends.windows(2) {
            let part = integral(&rule, pair[0], pair[1], w);
            signed += part;
            absolute += part.abs();
            knots.push([pair[1], absolute]);
        }
        Self { knots, signed, rule }
    }

    fn absolute(&self) -> f64 {
        self.knots.last().map_or(0.0, |knot| knot[1])
    }

    /// The x with this share of ∫|w| to its left.
    fn place(&self, shape: FilterShape, radius: f64, share: f64) -> f64 {
        let target = share * self.absolute();
        let at =
            self.knots.partition_point(|knot| knot[1] <= target).clamp(1, self.knots.len() - 1);
        let [[from, before], [to, after]] = [self.knots[at - 1], self.knots[at]];
        let w = |x: f64| shape.weight(radius, x).abs();
        let (mut low, mut high) = (from, to);
        let mut x = from + (to - from) * (target - before) / (after - before);
        for _ in 0..60 {
            let excess = before + integral(&self.rule, from, x, w) - target;
            if excess > 0.0 {
                high = x
            } else {
                low = x
            }
            // Newton's step, or half the interval where it would leave it.
            let step = x - excess / w(x);
            let next = if step > low && step < high { step } else { low.midpoint(high) };
            if (next - x).abs() <= 1e-15 * radius {
                return next;
            }
            x = next;
        }
        x
    }
}

fn integral(rule: &[(f64, f64)], from: f64, to: f64, w: impl Fn(f64) -> f64) -> f64 {
    let sum: f64 = rule.iter().map(|(x, weight)| weight * w(from + x * (to - from))).sum();
    sum * (to - from)
}

fn root(mut low: f64, mut high: f64, w: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..80 {
        let middle = low.midpoint(high);
        if w(low) * w(middle) <= 0.0 { high = middle } else { low = middle }
    }
    low.midpoint(high)
}
