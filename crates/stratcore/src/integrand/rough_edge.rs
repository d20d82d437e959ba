//! An edge of any dimension k between d - 1 and d: the region under a rough graph.

use super::catalogue::{IntegrandInfo, ParamInfo};
use super::exact::{generic_centre, variance_of_mean};
use super::{Integrand, Reference, Regularity};

pub(super) const ROUGH_EDGE: IntegrandInfo = IntegrandInfo {
    name: "rough-edge",
    summary: "1 below a rough graph over x1: an edge of any dimension k from d - 1 to d",
    params: &[ParamInfo {
        name: "roughness",
        default: 0.5,
        meaning: "of the edge: k - (d - 1), where k is its dimension",
        min: 0.1,
        max: 0.9,
    }],
    min_dim: 2,
    max_dim: 16,
    build: |dim, params| Box::new(RoughEdge::new(dim, params[0])),
};

/// Waves of the graph, each twice as fine as the one before: after them x has no bits left.
const WAVES: i32 = 52;

/// The standard deviation of the graph, in sides of the cube: as rough as there is room for.
const DEVIATION: f64 = 0.22;

/// 1 where x0 < g(x1), with g = c + A Σ 2^(-nH) w(2^n (x1 - c')), a Weierstrass function of
/// triangle waves w. Its graph has dimension 2 - H (Falconer, Fractal Geometry, chapter 11), so
/// H = 1 - roughness. Where g would leave the cube it is cut off, above and below alike.
struct RoughEdge {
    dim: usize,
    roughness: f64,
    /// A 2^(-nH) for each wave.
    amplitudes: Vec<f64>,
}

/// An odd triangle wave: period 1, from -1/2 to 1/2, 0 at 0.
fn wave(x: f64) -> f64 {
    let x = x - x.floor();
    if x < 0.25 {
        2.0 * x
    } else if x < 0.75 {
        1.0 - 2.0 * x
    } else {
        2.0 * x - 2.0
    }
}

impl RoughEdge {
    fn new(dim: usize, roughness: f64) -> Self {
        let ratio = (roughness - 1.0).exp2();
        // A wave has variance 1/12, and waves of different n are hardly correlated.
        let first = DEVIATION * (12.0 * (1.0 - ratio * ratio)).sqrt();
        let amplitudes = (0..WAVES).map(|n| first * ratio.powi(n)).collect();
        Self { dim, roughness, amplitudes }
    }

    /// Height of the middle of the graph, and its mean: every wave is odd about one point.
    fn middle(&self) -> f64 {
        generic_centre(0)
    }

    fn graph(&self, x: f64) -> f64 {
        let mut phase = x - generic_centre(1);
        let mut sum = 0.0;
        for amplitude in &self.amplitudes {
            sum += amplitude * wave(phase);
            phase *= 2.0;
        }
        let room = self.middle().min(1.0 - self.middle());
        self.middle() + sum.clamp(-room, room)
    }
}

impl Integrand for RoughEdge {
    fn dim(&self) -> usize {
        self.dim
    }
    fn eval(&self, point: &[f64]) -> f64 {
        f64::from(u8::from(point[0] < self.graph(point[1])))
    }
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: self.middle(), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Discontinuous { discontinuity_dim: self.dim as f64 - 1.0 + self.roughness }
    }
    /// For `random`; the areas within strata have no closed form.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        let area = self.middle();
        variance_of_mean(sampler, n, self.dim, |k| (k == 1).then_some(area * (1.0 - area)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::test_support::check_against_grid;

    #[test]
    fn the_mean_is_the_middle() {
        for roughness in [0.1, 0.5, 0.9] {
            check_against_grid("rough-edge", 2, &[("roughness", roughness)], 1e-2);
        }
        check_against_grid("rough-edge", 3, &[], 3e-2);
    }

    #[test]
    fn the_graph_is_odd_about_a_point_of_itself() {
        let edge = RoughEdge::new(2, 0.5);
        let (centre, middle) = (generic_centre(1), edge.middle());
        for i in 0..1000 {
            let x = f64::from(i) / 1024.0;
            let [above, below] = [x, -x].map(|x| edge.graph(centre + x) - middle);
            // The last waves turn rounding of the phase into noise of their own size.
            assert!((above + below).abs() < 1e-6, "{x}: {above} {below}");
        }
    }

    /// The variance within strata falls as their number to the power of k/d - 2, where they are
    /// fine enough: measured by areas, without sampling.
    #[test]
    fn the_edge_has_its_dimension() {
        for roughness in [0.2, 0.5, 0.8] {
            let edge = RoughEdge::new(2, roughness);
            let variance = |m: u32| -> f64 {
                let fine = 40_000 / m;
                let side = f64::from(m);
                let mut sum = 0.0;
                for column in 0..m {
                    let mut covered = vec![0.0; m as usize];
                    for i in 0..fine {
                        let x = (f64::from(column) + (f64::from(i) + 0.5) / f64::from(fine)) / side;
                        let height = edge.graph(x) * side;
                        for (row, covered) in (0..).map(f64::from).zip(&mut covered) {
                            *covered += (height - row).clamp(0.0, 1.0) / f64::from(fine);
                        }
                    }
                    sum += covered.iter().map(|v| v * (1.0 - v)).sum::<f64>();
                }
                sum / side.powi(4)
            };
            // From 256 to 16,384 strata: a factor of 64.
            let exponent = (variance(16) / variance(128)).ln() / 64f64.ln();
            let theory = 2.0 - (1.0 + roughness) / 2.0;
            assert!((exponent - theory).abs() < 0.03, "{roughness}: {exponent} {theory}");
        }
    }
}
