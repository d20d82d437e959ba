//! A disk, or the ball of any dimension: a curved edge.

use super::catalogue::{IntegrandInfo, ParamInfo};
use super::exact::{generic_centre, indicator_strata_variance, variance_of_mean};
use super::{Integrand, Reference, Regularity};
use std::f64::consts::PI;

pub(super) const DISK: IntegrandInfo = IntegrandInfo {
    name: "disk",
    summary: "1 inside a ball near the cube's centre: an edge at every angle",
    params: &[ParamInfo {
        name: "radius",
        default: 0.4,
        meaning: "of the ball; the cube has side 1",
        min: 0.001,
        max: 0.45,
    }],
    min_dim: 1,
    max_dim: 16,
    build: |dim, params| {
        let centre = (0..dim).map(generic_centre).collect();
        Box::new(Disk { centre, radius: params[0] })
    },
};

struct Disk {
    centre: Vec<f64>,
    radius: f64,
}

impl Disk {
    fn volume(&self) -> f64 {
        let dim = self.centre.len();
        // V(d) = V(d - 2) 2π/d from V(0) = 1, V(1) = 2.
        let start = if dim.is_multiple_of(2) { 1.0 } else { 2.0 };
        let unit_ball = (1..=dim)
            .filter(|j| *j >= 2 && (dim - j).is_multiple_of(2))
            .fold(start, |volume, j| volume * 2.0 * PI / j as f64);
        unit_ball * self.radius.powi(dim as i32)
    }

    /// Part of the stratum at `corner`, in units of strata of side 1/k, that the disk covers.
    fn covered(&self, corner: &[f64], k: f64) -> f64 {
        // The stratum from the disk's centre, in radii.
        let sides: Vec<[f64; 2]> = corner
            .iter()
            .zip(&self.centre)
            .map(|(lo, c)| [0.0, 1.0].map(|end| ((lo + end) / k - c) / self.radius))
            .collect();
        let nearest: f64 = sides.iter().map(|[lo, hi]| lo.max(-hi).max(0.0).powi(2)).sum();
        let farthest: f64 = sides.iter().map(|[lo, hi]| hi.max(-lo).powi(2)).sum();
        if nearest >= 1.0 {
            return 0.0;
        }
        if farthest <= 1.0 {
            return 1.0;
        }
        let in_radii = match sides[..] {
            [[lo, hi]] => hi.min(1.0) - lo.max(-1.0),
            [[x0, x1], [y0, y1]] => {
                (disk_below(x1, y1) - disk_below(x0, y1))
                    - (disk_below(x1, y0) - disk_below(x0, y0))
            }
            _ => f64::NAN,
        };
        (in_radii * (self.radius * k).powi(corner.len() as i32)).clamp(0.0, 1.0)
    }
}

/// Area of the unit disk where X < x and Y < y.
fn disk_below(x: f64, y: f64) -> f64 {
    let (x, y) = (x.clamp(-1.0, 1.0), y.clamp(-1.0, 1.0));
    // Area under the upper half circle between two abscissas.
    let primitive = |x: f64| 0.5 * (x * (1.0 - x * x).sqrt() + x.asin());
    let under = |a: f64, b: f64| primitive(b) - primitive(a);
    // Where |X| < h, the line Y = y crosses the disk; elsewhere the chord is below it or above.
    let h = (1.0 - y * y).sqrt();
    let crossing_end = x.clamp(-h, h);
    let crossing = y * (crossing_end + h) + under(-h, crossing_end);
    if y <= 0.0 {
        return crossing;
    }
    crossing + 2.0 * (under(-1.0, x.min(-h)) + under(h, x.max(h)))
}

impl Integrand for Disk {
    fn dim(&self) -> usize {
        self.centre.len()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let distance_sq: f64 = self.centre.iter().zip(point).map(|(c, x)| (x - c).powi(2)).sum();
        f64::from(u8::from(distance_sq < self.radius * self.radius))
    }
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: self.volume(), std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        Regularity::Discontinuous { discontinuity_dim: self.centre.len() as f64 - 1.0 }
    }
    /// From the area that the disk covers of each stratum, for d ≤ 2; beyond, `random` alone.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        let dim = self.centre.len();
        variance_of_mean(sampler, n, dim, |k| match (k, dim) {
            (1, _) => Some(self.volume() * (1.0 - self.volume())),
            (_, 1 | 2) => {
                indicator_strata_variance(k, dim, |corner| self.covered(corner, k as f64))
            }
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::test_support::{build, check_against_grid};

    #[test]
    fn the_volumes_of_balls() {
        for (dim, volume) in [(1, 2.0), (2, PI), (3, 4.0 / 3.0 * PI), (4, PI * PI / 2.0)] {
            let mean = build("disk", dim, &[("radius", 0.3)]).reference().unwrap().mean;
            assert!((mean / (volume * 0.3f64.powi(dim as i32)) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn corners_of_the_disk() {
        assert_eq!(disk_below(-1.0, 5.0), 0.0);
        for (x, y, area) in [
            (2.0, 2.0, PI),
            (0.0, 2.0, PI / 2.0),
            (0.0, 0.0, PI / 4.0),
            (0.0, -0.5, PI / 6.0 - 3f64.sqrt() / 8.0),
            (2.0, 0.5, PI - (PI / 3.0 - 3f64.sqrt() / 4.0)),
        ] {
            assert!((disk_below(x, y) - area).abs() < 1e-15, "{x} {y}");
            assert!((disk_below(y, x) - area).abs() < 1e-15, "{y} {x}");
        }
    }

    #[test]
    fn the_strata_make_up_the_disk() {
        let disk = Disk { centre: vec![0.47, 0.52], radius: 0.4 };
        for k in [1u32, 2, 7, 300] {
            let corners = (0..k * k).map(|i| [f64::from(i % k), f64::from(i / k)]);
            let area: f64 = corners.map(|corner| disk.covered(&corner, f64::from(k))).sum();
            assert!((area / f64::from(k * k) - disk.volume()).abs() < 1e-13, "{k}");
        }
    }

    #[test]
    fn moments_match_a_grid() {
        check_against_grid("disk", 1, &[], 5e-3);
        check_against_grid("disk", 2, &[], 5e-3);
        check_against_grid("disk", 3, &[], 1e-2);
    }

    /// The edge-length law: an edge of length L averaged over its placement gives
    /// L N^-3/2 / 6 to 1 % (the average over angles is 0.1657 against 1/6). One placement
    /// wanders about it.
    #[test]
    fn a_circle_follows_the_edge_length_law() {
        let disk = build("disk", 2, &[("radius", 0.3)]);
        let ks = 30..60u64;
        let constants = ks.clone().map(|k| {
            disk.exact_variance("jittered", k * k).unwrap() * (k as f64).powi(3) / (0.6 * PI)
        });
        let mean = constants.sum::<f64>() / ks.count() as f64;
        assert!((mean * 6.0 - 1.0).abs() < 0.02, "{mean}");
    }
}
