//! The form factor between parallel disks: an oracle in four dimensions whose points come by the
//! concentric map, as those of lenses and disk lights do.

use super::catalogue::{IntegrandInfo, ParamInfo};
use super::exact::{MAX_STRATA, variance_of_mean};
use super::form_factor::axes;
use super::quadrature::{composite, gauss_legendre, nodes_for};
use super::{Integrand, Reference, Regularity};
use crate::scene::disk;
use crate::variance::neumaier_sum;
use std::f64::consts::{FRAC_PI_4, PI};

pub(super) const DISKS: IntegrandInfo = IntegrandInfo {
    name: "form-factor-disks",
    summary: "form factor of parallel disks on one axis, from one of radius 1 to another",
    params: &[
        ParamInfo {
            name: "radius",
            default: 1.0,
            meaning: "radius of the other disk",
            min: 0.01,
            max: 100.0,
        },
        ParamInfo {
            name: "distance",
            default: 1.0,
            meaning: "distance between the two",
            min: 0.05,
            max: 100.0,
        },
    ],
    min_dim: 4,
    max_dim: 4,
    build: |_, params| Box::new(Disks { radius: params[0], distance: params[1] }),
};

/// f = A h² / (π r⁴), A the area of the other disk; both by the concentric map.
struct Disks {
    radius: f64,
    distance: f64,
}

impl Disks {
    /// f from the squared distance of the two points across the axis.
    #[inline(always)]
    fn at(&self, across_sq: f64) -> f64 {
        let h2 = self.distance * self.distance;
        let distance_sq = across_sq + h2;
        self.radius * self.radius * h2 / (distance_sq * distance_sq)
    }

    /// Mean of g(f) over both disks: an integral over the distance s of the two points across
    /// the axis, whose density is 2 s L(s) / (π R²), L being the area that both disks share when
    /// their centres are s apart.
    fn mean_of(&self, g: impl Fn(f64) -> f64) -> f64 {
        const NODES: usize = 10;
        let (r, smaller) = (self.radius, self.radius.min(1.0));
        // f is analytic but at ± i h: panels of h/2 are short enough.
        let panels = |length: f64| (2.0 * length / self.distance).ceil().max(1.0) as u64;
        let part = |s: f64, shared: f64| 2.0 * s * shared / (PI * r * r) * g(self.at(s * s));
        // As long as one disk is within the other.
        let inner = (1.0 - r).abs();
        let whole = composite(NODES, panels(inner)).into_iter();
        let whole = whole.map(|(x, w)| w * inner * part(x * inner, PI * smaller * smaller));
        // Then s = inner + 2 smaller sin²(θ/2), which takes the square roots out of L. Where the
        // disks are almost alike L still turns fast near θ = 0: panels halve towards it.
        let rest = (0..40).flat_map(|halving| {
            let top = PI * 0.5f64.powi(halving);
            let bottom = if halving == 39 { 0.0 } else { 0.5 * top };
            let length = top - bottom;
            composite(NODES, panels(smaller * length)).into_iter().map(move |(x, w)| {
                let half = 0.5 * (bottom + length * x);
                let s = inner + 2.0 * smaller * half.sin().powi(2);
                w * length * smaller * (2.0 * half).sin() * part(s, shared_area(r, s))
            })
        });
        neumaier_sum(whole.chain(rest))
    }

    /// The variances of f within the k⁴ strata, summed; none where that is more than a second's
    /// work. Each pair of strata by Gauss' rule in four dimensions; only strata of the first disk
    /// that no rotation or reflection takes to one another are tried.
    fn strata_variance(&self, k: u64) -> Option<f64> {
        if k == 1 {
            let mean = self.mean_of(|f| f);
            return Some(self.mean_of(|f| (f - mean).powi(2)));
        }
        self.strata_variance_by_cells(k)
    }

    fn strata_variance_by_cells(&self, k: u64) -> Option<f64> {
        /// Pairs of nodes that are evaluated.
        const MOST_PAIRS: f64 = 2e9;
        if k.checked_pow(4)? > MAX_STRATA {
            return None;
        }
        // In a cell of half the side l f is analytic but for places i h away: cells are no longer
        // than h.
        let larger = self.radius.max(1.0);
        let split = (2.0 * larger / (self.distance * k as f64)).ceil().max(1.0);
        let nodes = nodes_for(self.distance * k as f64 * split / larger);
        if (k as f64 * split * nodes as f64).powi(4) > MOST_PAIRS {
            return None;
        }
        let split = split as u64;
        let strata: Vec<Vec<Node>> = (0..k)
            .flat_map(|i| (0..k).map(move |j| (i, j)))
            .map(|(i, j)| stratum_nodes(k, split, [i, j], nodes))
            .collect();
        let pair = |first: &[Node], second: &[Node]| {
            let sum = |g: &dyn Fn(f64) -> f64| {
                let mut sum = 0.0;
                for p in first {
                    let part = |q: &Node| {
                        let across = [0, 1].map(|i| p.at[i] - self.radius * q.at[i]);
                        q.weight * g(self.at(across[0] * across[0] + across[1] * across[1]))
                    };
                    sum += p.weight * second.iter().map(part).sum::<f64>();
                }
                sum
            };
            let mean = sum(&|f| f);
            sum(&|f| (f - mean).powi(2))
        };
        let (k, strata, pair) = (k as i64, &strata, &pair);
        let first = (0..k).flat_map(|i| (0..k).map(move |j| (i, j)));
        Some(neumaier_sum(first.flat_map(move |(i, j)| {
            // Twice the place of its middle from the disk's.
            let [u, v] = [2 * i + 1 - k, 2 * j + 1 - k];
            let alike = match (u, v) {
                _ if v < 0 || u < v => 0,
                (0, 0) => 1,
                _ if v == 0 || u == v => 4,
                _ => 8,
            };
            let own = &strata[(i * k + j) as usize];
            let second = if alike == 0 { &[][..] } else { strata };
            second.iter().map(move |other| f64::from(alike) * pair(own, other))
        })))
    }
}

/// The area that disks of radius 1 and r share when their centres are s apart, none of them
/// within the other.
fn shared_area(r: f64, s: f64) -> f64 {
    let segment = |cosine: f64| {
        let angle = cosine.clamp(-1.0, 1.0).acos();
        angle - angle.sin() * angle.cos()
    };
    let ahead = (s * s + (1.0 - r) * (1.0 + r)) / (2.0 * s);
    segment(ahead) + r * r * segment((s - ahead) / r)
}

/// A node of a rule over a part of the disk of radius 1.
struct Node {
    at: [f64; 2],
    weight: f64,
}

/// Nodes of stratum (i, j) of k × k, cut into `split`² cells; weights sum to 1.
fn stratum_nodes(k: u64, split: u64, stratum: [u64; 2], nodes: usize) -> Vec<Node> {
    let cells = (0..split).flat_map(|i| (0..split).map(move |j| [i, j]));
    let share = 1.0 / (split * split) as f64;
    cells
        .flat_map(|[i, j]| {
            let cell = [stratum[0] * split + i, stratum[1] * split + j];
            cell_nodes((k * split) as i64, cell.map(|i| i as i64), nodes)
        })
        .map(|node| Node { weight: node.weight * share, ..node })
        .collect()
}

/// Nodes of cell (i, j) of k × k. The diagonals of the square cut it in four; in the quarter
/// about the axis of a > 0, |b| < a, the map is (a cos φ, a sin φ), φ = π b / (4 a).
fn cell_nodes(k: i64, [i, j]: [i64; 2], nodes: usize) -> Vec<Node> {
    // In units of 1/k from the middle, so that the sides of cells compare exactly.
    let ([a0, a1], [b0, b1]) = ([2 * i - k, 2 * i + 2 - k], [2 * j - k, 2 * j + 2 - k]);
    let quarters = [
        ([1.0, 0.0], [a0, a1], [b0, b1]),
        ([0.0, 1.0], [b0, b1], [-a1, -a0]),
        ([-1.0, 0.0], [-a1, -a0], [-b1, -b0]),
        ([0.0, -1.0], [-b1, -b0], [a0, a1]),
    ];
    let mut found = Vec::new();
    for ([cos, sin], [a0, a1], [b0, b1]) in quarters {
        let from = a0.max(0);
        if a1 <= 0 || b0 >= a1 || b1 <= -a1 {
            continue;
        }
        let length = (a1 - from) as f64;
        // φ is analytic but where a = 0.
        let from_middle = (a1 + from) as f64 / length;
        let nodes = if from == 0 {
            nodes
        } else {
            nodes.max(nodes_for((from_middle * from_middle - 1.0).sqrt()))
        };
        let rule = gauss_legendre(nodes.max(8));
        for (x, wa) in &rule {
            let a = from as f64 + x * length;
            let low = if b0 >= -from { b0 as f64 } else { -a };
            let high = if b1 <= from { b1 as f64 } else { a };
            for (y, wb) in &rule {
                let angle = FRAC_PI_4 * (low + y * (high - low)) / a;
                let [x, y] = [angle.cos(), angle.sin()].map(|part| part * a / k as f64);
                let at = [cos * x - sin * y, sin * x + cos * y];
                // A cell has the area 4.
                found.push(Node { at, weight: wa * length * wb * (high - low) / 4.0 });
            }
        }
    }
    found
}

impl Integrand for Disks {
    fn dim(&self) -> usize {
        4
    }
    fn axes(&self) -> Vec<String> {
        axes()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let &[a, b, c, d] = point else { return f64::NAN };
        let ([x, y], [p, q]) = (disk(a, b), disk(c, d));
        self.at((x - p * self.radius).powi(2) + (y - q * self.radius).powi(2))
    }
    /// Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, C-41.
    fn reference(&self) -> Option<Reference> {
        let [own, other] = [1.0, self.radius].map(|r| (r / self.distance).powi(2));
        let x = 1.0 + (1.0 + other) / own;
        // The smaller root of F² - x F + other/own, without its cancellation.
        let ratio = other / own;
        let mean = 2.0 * ratio / (x + (x * x - 4.0 * ratio).sqrt());
        Some(Reference { mean, std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Smooth
    }
    /// By quadrature: over the distance across the axis, and over each pair of strata.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        variance_of_mean(sampler, n, 4, |k| self.strata_variance(k))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::test_support::{build, check_against_grid};

    /// A far disk has the form factor of a point: A / (π h²). A wide near one sees all.
    #[test]
    fn disks_have_the_right_limits() {
        let mean = |radius, distance| {
            let f = build("form-factor-disks", 4, &[("radius", radius), ("distance", distance)]);
            f.reference().unwrap().mean
        };
        assert!((mean(0.01, 100.0) / 1e-8 - 1.0).abs() < 1e-3);
        assert!((mean(100.0, 0.05) - 1.0).abs() < 1e-6);
        // What leaves the one and meets the other is the same both ways.
        assert!((mean(2.0, 3.0) - 4.0 * mean(0.5, 1.5)).abs() < 1e-12);
    }

    /// The integral over the distance across gives the published mean over all of the range.
    #[test]
    fn the_integral_over_the_distance_has_the_known_mean() {
        for radius in [0.01, 0.5, 0.999, 1.0, 1.0001, 3.0, 100.0] {
            for distance in [0.05, 0.3, 1.0, 100.0] {
                let disks = Disks { radius, distance };
                let (found, known) = (disks.mean_of(|f| f), disks.reference().unwrap().mean);
                assert!(
                    (found / known - 1.0).abs() < 1e-10,
                    "{radius} {distance}: {found} {known}"
                );
            }
        }
    }

    /// Two quadratures that share nothing but f: over one distance, and over both squares.
    #[test]
    fn both_quadratures_agree() {
        for (radius, distance) in [(1.0, 1.0), (0.5, 0.4), (2.0, 5.0), (1.0, 30.0)] {
            let disks = Disks { radius, distance };
            let by_distance = disks.strata_variance(1).unwrap();
            let by_cells = disks.strata_variance_by_cells(1).unwrap();
            let off = by_cells / by_distance - 1.0;
            assert!(off.abs() < 1e-9, "{radius} {distance}: {by_cells} {by_distance}, {off:e}");
        }
    }

    #[test]
    fn weights_of_a_cell_sum_to_one() {
        for k in 1..=5 {
            for i in 0..k {
                for j in 0..k {
                    let sum: f64 = cell_nodes(k, [i, j], 6).iter().map(|node| node.weight).sum();
                    assert!((sum - 1.0).abs() < 1e-14, "{k} {i} {j}: {sum}");
                }
            }
        }
    }

    #[test]
    fn moments_match_a_grid() {
        check_against_grid("form-factor-disks", 4, &[], 2e-2);
        let far = [("radius", 3.0), ("distance", 2.0)];
        check_against_grid("form-factor-disks", 4, &far, 2e-2);
    }

    #[test]
    fn too_near_disks_have_no_exact_variance_under_jittered() {
        let near = build("form-factor-disks", 4, &[("distance", 0.05)]);
        assert!(near.exact_variance("jittered", 16).is_none());
        assert!(near.exact_variance("random", 16).is_some());
    }
}
