//! An edge at an angle, in any dimension.

use super::catalogue::{IntegrandInfo, ParamInfo};
use super::exact::{direction, indicator_strata_variance, variance_of_mean};
use super::{Alignment, Integrand, Reference, Regularity};

pub(super) const HALF_SPACE: IntegrandInfo = IntegrandInfo {
    name: "half-space",
    summary: "1 on one side of a plane at an angle: the edge of the theory",
    params: &[
        ParamInfo {
            name: "angle",
            default: 60.0,
            meaning: "every hyperspherical angle of the normal, in degrees; 0 is along x0",
            min: 0.0,
            max: 90.0,
        },
        ParamInfo {
            name: "offset",
            default: 0.1,
            meaning: "distance of the plane from the cube's centre, along the normal",
            min: -2.0,
            max: 2.0,
        },
    ],
    min_dim: 1,
    max_dim: 10,
    build: |dim, params| Box::new(HalfSpace::new(direction(dim, params[0]), params[1])),
};

/// 1 where n·x < t, with n of unit length and components ≥ 0.
struct HalfSpace {
    normal: Vec<f64>,
    threshold: f64,
    volume: f64,
}

impl HalfSpace {
    fn new(normal: Vec<f64>, offset: f64) -> Self {
        let threshold = offset + 0.5 * normal.iter().sum::<f64>();
        let volume = CubeCut::new(&normal).volume(threshold);
        Self { normal, threshold, volume }
    }
}

impl Integrand for HalfSpace {
    fn dim(&self) -> usize {
        self.normal.len()
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let along: f64 = self.normal.iter().zip(point).map(|(n, x)| n * x).sum();
        f64::from(u8::from(along < self.threshold))
    }
    fn reference(&self) -> Option<Reference> {
        Some(Reference { mean: self.volume, std_error: 0.0 })
    }
    fn regularity(&self) -> Regularity {
        if self.volume == 0.0 || self.volume == 1.0 {
            return Regularity::Constant;
        }
        Regularity::Discontinuous { discontinuity_dim: self.normal.len() as f64 - 1.0 }
    }
    fn alignment(&self) -> Alignment {
        match self.normal.iter().filter(|n| **n > 0.0).count() {
            1 => Alignment::Additive,
            _ => Alignment::General,
        }
    }
    /// From the volume that the plane cuts off each stratum.
    fn exact_variance(&self, sampler: &str, n: u64) -> Option<f64> {
        let dim = self.normal.len();
        variance_of_mean(sampler, n, dim, |k| {
            let threshold = k as f64 * self.threshold;
            let mut cut = CubeCut::new(&self.normal);
            indicator_strata_variance(k, dim, |corner| {
                let along: f64 = self.normal.iter().zip(corner).map(|(n, c)| n * c).sum();
                cut.volume(threshold - along)
            })
        })
    }
}

/// Volumes that the planes of one normal cut off the unit cube.
///
/// The well-known alternating sum over the 2^d corners divides by the product of the normal's
/// components, and loses every digit where one of them is small. This uses the divergence
/// theorem: seen from a point on the plane, the body {n·u < t} is made of the pyramids over
/// the parts of the cube's faces that lie in it, so
///
/// d V = Σᵢ s Vᵢ(t) + (1 - s) Vᵢ(t - nᵢ),  s = t / Σn,
///
/// with Vᵢ the same volume in the d - 1 dimensions without axis i, and the point s(1, …, 1).
/// All terms are positive; there are 3^d faces of all dimensions.
struct CubeCut {
    /// Digit i of a face's number in base 3 tells of axis i: 0 free, 1 fixed at u = 0, 2 fixed
    /// at u = 1. The whole cube is face 0.
    faces: Vec<Face>,
    /// Volume of the cut within each face, in the face's own dimensions.
    volumes: Vec<f64>,
}

/// A face of the cube of any dimension, as planes of one normal see it.
struct Face {
    /// Smallest n·u on the face.
    start: f64,
    /// Range of n·u on the face.
    span: f64,
    /// One per free axis: this face's number plus one step is the number of its own face at
    /// u = 0, plus two steps of that at u = 1.
    steps: Vec<usize>,
}

impl CubeCut {
    fn new(normal: &[f64]) -> Self {
        let face = |number: usize| {
            let mut face = Face { start: 0.0, span: 0.0, steps: Vec::new() };
            let (mut digits, mut place) = (number, 1);
            for n in normal {
                match digits % 3 {
                    0 => {
                        face.span += n;
                        face.steps.push(place);
                    }
                    1 => {}
                    _ => face.start += n,
                }
                digits /= 3;
                place *= 3;
            }
            face
        };
        let faces: Vec<_> = (0..3usize.pow(normal.len() as u32)).map(face).collect();
        Self { volumes: vec![0.0; faces.len()], faces }
    }

    /// Volume of {u in the unit cube: n·u < t}.
    fn volume(&mut self, t: f64) -> f64 {
        if t <= 0.0 {
            return 0.0;
        }
        if t >= self.faces[0].span {
            return 1.0;
        }
        // A face's own faces have higher numbers.
        for (number, face) in self.faces.iter().enumerate().rev() {
            let t = t - face.start;
            self.volumes[number] = if t <= 0.0 {
                0.0
            } else if t >= face.span {
                1.0
            } else {
                let s = t / face.span;
                let pyramid = |step: &usize| {
                    s * self.volumes[number + step] + (1.0 - s) * self.volumes[number + 2 * step]
                };
                face.steps.iter().map(pyramid).sum::<f64>() / face.steps.len() as f64
            };
        }
        self.volumes[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::test_support::{build, check_against_grid};

    /// Inclusion-exclusion over the corners: Σ (-1)^|v| (t - n·v)₊^d / (d! Πn).
    fn alternating_sum(normal: &[f64], t: f64) -> f64 {
        let dim = normal.len();
        let sum: f64 = (0..1u32 << dim)
            .map(|v| {
                let at: f64 = (0..dim).filter(|i| v >> i & 1 == 1).map(|i| normal[i]).sum();
                (-1f64).powi(v.count_ones() as i32) * (t - at).max(0.0).powi(dim as i32)
            })
            .sum();
        sum / (1..=dim).map(|i| i as f64 * normal[i - 1]).product::<f64>()
    }

    #[test]
    fn volumes_match_inclusion_exclusion() {
        for dim in 1..=7 {
            let normal = direction(dim, 55.0);
            let span: f64 = normal.iter().sum();
            for step in 0..=20 {
                let t = span * f64::from(step) / 20.0;
                let (a, b) = (CubeCut::new(&normal).volume(t), alternating_sum(&normal, t));
                assert!((a - b).abs() < 1e-11, "d = {dim}, t = {t}: {a} {b}");
            }
        }
    }

    #[test]
    fn small_components_lose_nothing() {
        // Almost a step at 0.3; the last component is 1e-25, the alternating sum is noise.
        let normal = [1.0, 1e-5, 1e-10, 1e-15, 1e-20, 1e-25];
        let t = 0.3 + 0.5 * normal[1..].iter().sum::<f64>();
        assert!((CubeCut::new(&normal).volume(t) - 0.3).abs() < 1e-15);
        assert!((CubeCut::new(&[1.0, 0.0, 0.0]).volume(0.25) - 0.25).abs() < 1e-15);
    }

    #[test]
    fn moments_match_a_grid() {
        // A grid of m points per axis knows an edge to about m^-1.5.
        check_against_grid("half-space", 1, &[], 5e-3);
        check_against_grid("half-space", 2, &[], 5e-3);
        check_against_grid("half-space", 3, &[], 2e-2);
    }

    #[test]
    fn an_aligned_plane_is_a_step() {
        let plane = build("half-space", 3, &[("angle", 0.0), ("offset", 0.2)]);
        let step = build("step", 3, &[("edge", 0.7)]);
        for k in 1..=9u64 {
            let [a, b] = [&plane, &step].map(|f| f.exact_variance("jittered", k.pow(3)).unwrap());
            assert!((a - b).abs() < 1e-14, "k = {k}: {a} {b}");
        }
    }
}
