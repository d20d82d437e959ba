//! Leading constants in closed form.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI, SQRT_2};

/// c(θ) of the edge-length law: an edge of contrast Δ and length L (the pixel's side is 1) has
/// under `jittered` the variance c(θ) L Δ² N^(-3/2), averaged over where it lies.
///
/// A cell of side 1 is covered in part where the line crosses it. With t the line's distance
/// from the cell's first corner along its normal (A, B), A ≥ B ≥ 0, the covered part a(t) grows
/// as t²/(2AB) to t = B, then by 1/A per unit to t = A, then symmetrically to 1 at t = A + B. A
/// line of length L lies at every offset equally often, so it meets L dt cells at t to t + dt,
/// each a Bernoulli trial of variance a(1 - a):
///
/// c = ∫ a(1 - a) dt = A/6 + B²/(12 A) - B³/(60 A²),
///
/// from 1/6 along an axis to 7√2/60 = 0.16499 on the diagonal. `angle` is in radians, of the
/// edge or of its normal, to any axis.
///
/// Source: derived here from Mitchell 1996, "Theoretical analysis", which states the exponent.
pub fn edge_constant(angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let (a, b) = (sin.abs().max(cos.abs()), sin.abs().min(cos.abs()));
    a / 6.0 + b * b / (12.0 * a) - b.powi(3) / (60.0 * a * a)
}

/// Mean of [`edge_constant`] over all angles, as a circle has them: 0.165968. What is left out
/// is the circle's curvature over one cell, a share of the order of (cell / radius)².
pub fn circle_edge_constant() -> f64 {
    // ∫ over 0 .. 45° of the three terms: cos/6, (1/cos - cos)/12, (sin/cos² - sin)/60.
    let cosine = FRAC_1_SQRT_2 / 6.0;
    let secant = ((1.0 + SQRT_2).ln() - FRAC_1_SQRT_2) / 12.0;
    let tangent = (SQRT_2 + FRAC_1_SQRT_2 - 2.0) / 60.0;
    (cosine + secant - tangent) / FRAC_PI_4
}

/// The same for a curved edge of every angle under the randomly shifted square grid: 0.07284,
/// so that the variance is 0.07284 L Δ² N^(-3/2), averaged over the figure's size.
///
/// The number of points of a shifted lattice inside a disk of radius R cells has the variance
/// Σ R²/|m|² J₁(2πR|m|)² over all m ≠ 0 in Z² (Poisson summation). J₁(x)² is 1/(πx) on average,
/// which leaves 2πR Σ|m|⁻³/(4π³), and Σ|m|⁻³ = 4 ζ(3/2) β(3/2) (Hardy 1919).
///
/// Source: Kendall, *On the number of lattice points inside a random oval*, 1948.
pub fn lattice_edge_constant() -> f64 {
    const ZETA: f64 = 2.612_375_348_685_488;
    const BETA: f64 = 0.864_502_653_461_202_1;
    ZETA * BETA / PI.powi(3)
}

/// Variance of the mean of N = k^d jittered points for a step of height 1 at `edge` along one
/// axis: q(1 - q) N^(-1 - 1/d) with q = frac(k · edge), the cut part of one layer of strata.
/// With d = 1 and k = N it is the variance of every sampler with one point in each of N
/// strata of the axis: `lhs`, `cmj`, and nets.
///
/// Source: Mitchell 1996, "Theoretical analysis", worked out.
pub fn step_variance(edge: f64, strata_per_axis: u64, dim: usize) -> f64 {
    let k = strata_per_axis as f64;
    let cut = (k * edge).fract();
    cut * (1.0 - cut) * k.powi(-(dim as i32) - 1)
}

/// Leading term of the variance of the mean for a smooth f, with one point in each of N strata
/// that have `strata_per_axis` along each axis: ∫|∇f|² / (12 N k²). It is exact for a linear f.
///
/// Within a stratum f is its tangent plane, and a coordinate in a stratum of side 1/k has the
/// variance 1/(12 k²). For `jittered` k = N^(1/d) and C = ∫|∇f|²/12 with p = 1 + 2/d. For a sum
/// of functions of one coordinate each, any sampler with one point in each of N strata of every
/// axis has k = N and p = 3.
///
/// Source: Mitchell 1996, "Theoretical analysis", worked out; Owen, *Scrambled net variance for
/// integrals of smooth functions*, 1997.
pub fn stratified_variance(mean_square_gradient: f64, n: f64, strata_per_axis: f64) -> f64 {
    mean_square_gradient / (12.0 * n * strata_per_axis * strata_per_axis)
}

/// Variance of the mean of N = k^d jittered points under a torus shift, for a linear f with
/// |∇f| = 1: the strata at a face are cut by it, and a point of theirs falls to either side of
/// the unit jump. N^(-1 - 1/d)/6 at first order, the rate of an edge.
///
/// Given the shift, N/k strata are cut at a fraction q that the shift makes uniform. Along the
/// axis such a stratum has the variance q(1 - q)(1 - 1/(2k))² + (q³ + (1 - q)³)/(12 k²), on
/// average (1 - 1/(2k))²/6 + 1/(24 k²); the others have 1/(12 k²).
///
/// Source: derived here.
pub fn shifted_ramp_variance(strata_per_axis: u64, dim: usize) -> f64 {
    let k = strata_per_axis as f64;
    let whole = 1.0 / (12.0 * k * k);
    let cut = (1.0 - 0.5 / k).powi(2) / 6.0 + 0.5 * whole;
    ((1.0 - 1.0 / k) * whole + cut / k) / k.powi(dim as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shift averaged over by a sum, the variance in each stratum by another.
    #[test]
    fn a_shifted_ramp_by_sums() {
        let steps = 400;
        let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
        for k in [1u64, 2, 5] {
            let width = 1.0 / k as f64;
            let stratum = |shift: f64, j: u64| {
                let at = |i| (shift + (j as f64 + middle(i)) * width).fract();
                let mean = (0..steps).map(at).sum::<f64>() / f64::from(steps);
                (0..steps).map(|i| (at(i) - mean).powi(2)).sum::<f64>() / f64::from(steps)
            };
            let sum: f64 = (0..steps)
                .flat_map(|s| (0..k).map(move |j| (s, j)))
                .map(|(s, j)| stratum(middle(s) * width, j))
                .sum();
            let variance = sum / f64::from(steps) * width * width;
            let law = shifted_ramp_variance(k, 1);
            // The sums misplace the ramp's fall by up to half a step.
            let off = (variance / law - 1.0).abs();
            assert!(off < 0.5 / f64::from(steps), "k = {k}: {variance} {law}");
        }
    }

    /// Covered part of the unit cell where A x + B y < t, by clipping: no formula shared.
    fn covered(t: f64, [a, b]: [f64; 2]) -> f64 {
        // Midpoint rule over x of the covered length in y.
        let steps = 4000;
        let length = |x: f64| {
            if b == 0.0 {
                f64::from(u8::from(a * x < t))
            } else {
                ((t - a * x) / b).clamp(0.0, 1.0)
            }
        };
        (0..steps).map(|i| length((f64::from(i) + 0.5) / f64::from(steps))).sum::<f64>()
            / f64::from(steps)
    }

    #[test]
    fn the_edge_constant_is_the_integral_that_it_stands_for() {
        for degrees in [0.0f64, 3.0, 15.0, 30.0, 44.9, 45.0, 60.0, 90.0, 120.0, 225.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let normal = [cos.abs(), sin.abs()];
            let (steps, span) = (1000, normal[0] + normal[1]);
            let sum: f64 = (0..steps)
                .map(|i| covered(span * (f64::from(i) + 0.5) / f64::from(steps), normal))
                .map(|a| a * (1.0 - a))
                .sum();
            let integral = sum * span / f64::from(steps);
            let c = edge_constant(degrees.to_radians());
            assert!((integral - c).abs() < 2e-6, "{degrees}: {integral} {c}");
        }
        assert!((edge_constant(0.0) - 1.0 / 6.0).abs() < 1e-15);
        assert!((edge_constant(FRAC_PI_4) - 7.0 * SQRT_2 / 60.0).abs() < 1e-15);
        assert!((edge_constant(PI / 6.0) - 0.16562).abs() < 5e-6);
    }

    #[test]
    fn the_circle_has_every_angle() {
        let steps = 100_000;
        let mean = (0..steps)
            .map(|i| edge_constant(PI * (f64::from(i) + 0.5) / f64::from(steps)))
            .sum::<f64>()
            / f64::from(steps);
        assert!((mean - circle_edge_constant()).abs() < 1e-9, "{mean}");
    }

    #[test]
    fn the_lattice_constant_is_its_sum() {
        // Σ|m|⁻³ over 0 < |m| ≤ R lacks 2π/R of the whole.
        let radius = 400i32;
        let sum: f64 = (-radius..=radius)
            .flat_map(|x| (-radius..=radius).map(move |y| f64::from(x * x + y * y)))
            .filter(|r2| *r2 > 0.0 && *r2 <= f64::from(radius * radius))
            .map(|r2| r2.powf(-1.5))
            .sum();
        let whole = sum + 2.0 * PI / f64::from(radius);
        let c = whole / (4.0 * PI.powi(3));
        assert!((c - lattice_edge_constant()).abs() < 1e-6, "{c}");
    }

    #[test]
    fn constants_are_the_exact_variances_of_the_catalogue() {
        use crate::integrand::by_name;
        for dim in 1..=5usize {
            let ramp = by_name("ramp", Some(dim), &[("slope".to_owned(), 2.0)]).unwrap();
            let step = by_name("step", Some(dim), &[("edge".to_owned(), 0.3)]).unwrap();
            for k in 1..=9u64 {
                let n = k.pow(dim as u32);
                let exact = ramp.exact_variance("jittered", n).unwrap();
                assert!((stratified_variance(4.0, n as f64, k as f64) / exact - 1.0).abs() < 1e-14);
                let exact = step.exact_variance("jittered", n).unwrap();
                assert!((step_variance(0.3, k, dim) - exact).abs() < 1e-15, "d = {dim}, k = {k}");
            }
        }
    }

    /// Averaged over where the edge lies, the law is exact at every N; over the disk's curvature
    /// it is the limit.
    #[test]
    fn the_edge_length_law_averages_exact_variances() {
        use crate::integrand::by_name;
        let placements = 2000;
        for degrees in [0.0f64, 20.0, 45.0] {
            let span = degrees.to_radians().cos() + degrees.to_radians().sin();
            for k in [1u64, 2, 5] {
                let mean = (0..placements)
                    .map(|i| span * ((f64::from(i) + 0.5) / f64::from(placements) - 0.5))
                    .map(|offset| {
                        let params = [("angle".to_owned(), degrees), ("offset".to_owned(), offset)];
                        let line = by_name("half-space", Some(2), &params).unwrap();
                        line.exact_variance("jittered", k * k).unwrap()
                    })
                    .sum::<f64>()
                    / f64::from(placements);
                // The mean length of the chord is 1 / span.
                let law = edge_constant(degrees.to_radians()) / span * (k as f64).powi(-3);
                assert!((mean / law - 1.0).abs() < 1e-4, "{degrees}, k = {k}: {mean} {law}");
            }
        }
        let disk = by_name("disk", Some(2), &[]).unwrap();
        let length = 2.0 * PI * 0.4;
        let means = (200..=300u64).map(|k| {
            let exact = disk.exact_variance("jittered", k * k).unwrap();
            exact / (circle_edge_constant() * length * (k as f64).powi(-3))
        });
        let mean = means.sum::<f64>() / 101.0;
        assert!((mean - 1.0).abs() < 3e-3, "{mean}");
    }
}
