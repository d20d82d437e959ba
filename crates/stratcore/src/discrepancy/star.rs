//! The star discrepancy in two dimensions.

use super::pairs;

/// The L∞ star discrepancy of points in the unit square, row-major `[N, 2]`: the largest
/// difference, over all boxes with a corner at the origin, between the share of points in the
/// box and its area. Exact up to rounding; O(N²) time, O(N) memory. NaN for no points.
///
/// A box with too few points grows until a point stops it, and is open there; one with too
/// many shrinks onto its points, and is closed. For each width the heights are the points' y
/// in order (Niederreiter, *Discrepancy and convex programming*, 1972; the two-dimensional
/// case is de Clerck's, 1986).
pub fn star(points: &[f64]) -> f64 {
    let mut points = pairs(points);
    if points.is_empty() {
        return f64::NAN;
    }
    let n = points.len() as f64;
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    // y of the points so far, in order.
    let mut ys: Vec<f64> = Vec::with_capacity(points.len());
    let too_few = |ys: &[f64], x: f64| {
        let tops = ys.iter().copied().chain([1.0]).enumerate();
        tops.map(|(below, y)| x * y - below as f64 / n).fold(0.0, f64::max)
    };
    let too_many = |ys: &[f64], x: f64| {
        ys.iter().zip(1..).map(|(y, up_to)| f64::from(up_to) / n - x * y).fold(0.0, f64::max)
    };
    let mut largest = 0.0f64;
    for column in points.chunk_by(|a, b| a[0] == b[0]) {
        let x = column[0][0];
        largest = largest.max(too_few(&ys, x));
        for [_, y] in column {
            let at = ys.partition_point(|other| other < y);
            ys.insert(at, *y);
        }
        largest = largest.max(too_many(&ys, x));
    }
    largest.max(too_few(&ys, 1.0))
}

#[cfg(test)]
mod tests {
    use super::super::test_points::{centred_grid, random};
    use super::*;

    /// Every box with sides at the points' coordinates or 1, both open and closed.
    fn brute_force(points: &[f64]) -> f64 {
        let n = points.len() as f64 / 2.0;
        let sides = |axis: usize| points.iter().copied().skip(axis).step_by(2).chain([1.0]);
        let mut largest = 0.0f64;
        for a in sides(0) {
            for b in sides(1) {
                let open = points.chunks(2).filter(|p| p[0] < a && p[1] < b).count() as f64;
                let closed = points.chunks(2).filter(|p| p[0] <= a && p[1] <= b).count() as f64;
                largest = largest.max(a * b - open / n).max(closed / n - a * b);
            }
        }
        largest
    }

    #[test]
    fn agrees_with_every_box() {
        for n in [1, 2, 3, 7, 30] {
            for trial in 0..10 {
                let points = random(n, 2, trial);
                assert!((star(&points) - brute_force(&points)).abs() < 1e-14);
                let lattice: Vec<_> = points.iter().map(|x| (x * 6.0).floor() / 6.0).collect();
                assert!((star(&lattice) - brute_force(&lattice)).abs() < 1e-14);
            }
        }
    }

    /// The closed box up to the last centre has all points and (1 - 1/2k)² of the area.
    #[test]
    fn known_sets_in_closed_form() {
        for k in 1..=20 {
            let expected = (k as f64 - 0.25) / (k * k) as f64;
            let found = star(&centred_grid(k));
            assert!((found - expected).abs() < 1e-14, "{k}: {found}");
        }
        assert_eq!(star(&[0.0, 0.0]), 1.0);
        assert!((star(&[0.9, 0.8]) - 0.9).abs() < 1e-15);
        assert!(star(&[]).is_nan());
        star(&[f64::NAN, 0.5, 0.5, f64::NAN]);
    }
}
