//! The mean square misjudgement of half-planes.

use super::pairs;
use crate::variance::neumaier_sum;

/// The mean, over straight lines that meet the unit square, of the squared difference between
/// the share of points on one side and the area of the square on that side. Points are row-major
/// `[N, 2]`; NaN for no points. Exact up to rounding of about 1e-16; O(N²) time.
///
/// Lines are weighted by the one measure that no motion of the plane changes, dp dθ for the line
/// at distance p from the origin with its normal at the angle θ. Lines that meet a convex body
/// have its perimeter as measure, here 4; lines that separate x from y have 2|x - y| (Crofton;
/// Santaló, *Integral Geometry and Geometric Probability*, 1976, I.3). Let μ be the points' mass
/// 1/N each minus the area. The two sides of a line have opposite μ, so μ(side)² is
/// -½ ∫∫ [x, y separated] dμ dμ, and the integral over all lines
///
/// ∫ μ(side)² = -∫∫ |x - y| dμ dμ = 2/N Σᵢ g(xᵢ) - 1/N² Σᵢⱼ |xᵢ - xⱼ| - c
///
/// with g the mean distance of a point from the square's points and c that between two of
/// them: an energy distance (Székely & Rizzo, *Energy statistics*, 2013). Its mean over random
/// points is c / N, over jittered ones c / N^(3/2): only pairs in one cell, whose distances
/// are those of the square shrunk by √N, are not independent and uniform.
pub fn edge_l2_sq(points: &[f64]) -> f64 {
    const MEASURE_OF_LINES: f64 = 4.0;
    let points = pairs(points);
    let n = points.len() as f64;
    let to_square = neumaier_sum(points.iter().map(|p| distance_to_square(*p)));
    let between = neumaier_sum(points.iter().enumerate().map(|(i, [x, y])| {
        points[..i].iter().map(|[u, v]| ((x - u).powi(2) + (y - v).powi(2)).sqrt()).sum::<f64>()
    }));
    let terms = [2.0 * to_square / n, -2.0 * between / (n * n), -mean_distance()];
    neumaier_sum(terms) / MEASURE_OF_LINES
}

/// Mean distance of two points of the unit square, 0.5214…
pub(super) fn mean_distance() -> f64 {
    (2.0 + 2f64.sqrt() + 5.0 * 1f64.asinh()) / 15.0
}

/// Mean distance of a point of the unit square from all of it: four rectangles meet there.
fn distance_to_square([x, y]: [f64; 2]) -> f64 {
    let quarter = |a, b| distance_to_corner(a, b);
    quarter(x, y) + quarter(1.0 - x, y) + quarter(x, 1.0 - y) + quarter(1.0 - x, 1.0 - y)
}

/// Integral of the distance from a corner over a rectangle with these sides.
fn distance_to_corner(a: f64, b: f64) -> f64 {
    if a <= 0.0 || b <= 0.0 {
        return 0.0;
    }
    let [a_part, b_part] = [(a, b), (b, a)].map(|(s, t)| s.powi(3) * (t / s).asinh());
    (2.0 * a * b * a.hypot(b) + a_part + b_part) / 6.0
}

#[cfg(test)]
mod tests {
    use super::super::SquareCut;
    use super::super::test_points::{centred_grid, jittered, random};
    use super::*;
    use crate::variance::Moments;

    /// Lines drawn by their measure, and the difference at each: a mean with its error.
    fn monte_carlo(points: &[f64], lines: u32) -> [f64; 2] {
        let n = points.len() as f64 / 2.0;
        let misjudged: Vec<f64> = random(lines as usize, 2, 99)
            .chunks(2)
            .map(|u| {
                let (s, c) = (u[0] * std::f64::consts::PI).sin_cos();
                // Of the strip |p| < 1/√2 about the centre, which covers the square for every
                // angle, lines that miss the square misjudge nothing.
                let p = (u[1] - 0.5) * 2f64.sqrt();
                let on_line = [0.5 + p * c, 0.5 + p * s];
                let level = c * on_line[0] + s * on_line[1];
                let inside = points.chunks(2).filter(|x| c * x[0] + s * x[1] < level).count();
                let area = SquareCut::new([c, s]).before(on_line);
                (inside as f64 / n - area).powi(2)
            })
            .collect();
        let spread = Moments::of(&misjudged);
        // The strip's measure is √2 π, that of lines that meet the square 4.
        let scale = 2f64.sqrt() * std::f64::consts::PI / 4.0;
        let std_error = (spread.variance / f64::from(lines)).sqrt();
        [spread.mean * scale, std_error * scale]
    }

    /// Five standard errors: a false alarm in 10^6 runs of other seeds.
    #[test]
    fn agrees_with_random_lines() {
        for points in [random(1, 2, 0), random(5, 2, 1), random(40, 2, 2), centred_grid(6)] {
            let exact = edge_l2_sq(&points);
            let [mean, std_error] = monte_carlo(&points, 400_000);
            assert!((mean - exact).abs() < 5.0 * std_error, "{exact}: {mean} ± {std_error}");
            assert!(std_error < 0.01 * exact);
        }
    }

    /// Means over trials against c / 4N and c / 4N^(3/2), within five of their own errors.
    #[test]
    fn means_of_random_and_jittered_points_are_known() {
        for k in [1usize, 2, 5, 12] {
            let n = (k * k) as f64;
            let check = |values: Vec<f64>, expected: f64| {
                let spread = Moments::of(&values);
                let std_error = (spread.variance / values.len() as f64).sqrt();
                let off = (spread.mean - expected) / std_error;
                assert!(off.abs() < 5.0, "{n}: {} is {off} errors off", spread.mean);
            };
            let c = mean_distance() / 4.0;
            check((0..2000).map(|t| edge_l2_sq(&random(k * k, 2, t))).collect(), c / n);
            check((0..2000).map(|t| edge_l2_sq(&jittered(k, t))).collect(), c / n.powf(1.5));
        }
    }

    #[test]
    fn distances_meet_their_closed_forms() {
        assert!((mean_distance() - 0.521_405_433_164_720_7).abs() < 1e-15);
        let corner = (2f64.sqrt() + 1f64.asinh()) / 3.0;
        assert!((distance_to_square([0.0, 0.0]) - corner).abs() < 1e-15);
        assert!((distance_to_square([0.5, 0.5]) - corner / 2.0).abs() < 1e-15);
        assert!(edge_l2_sq(&[]).is_nan());
    }
}
