//! The arbitrary-edge discrepancy: the largest misjudgement of any half-plane.

use super::{SquareCut, pairs};

/// The arbitrary-edge discrepancy of points in the unit square, row-major `[N, 2]`: the largest
/// difference, over all half-planes, between the share of points in it and the area of the
/// square in it. Exact up to rounding; O(N² log N) time, O(N) memory. NaN for no points.
///
/// A half-plane that is open misjudges by too few points where a closed one misjudges by too
/// many: the supremum is over both. It is taken by a line through a point, for a line between
/// points can be moved until it makes things worse. A line that turns about a point keeps
/// its count until it meets another point; its area is smooth and has one stationary value,
/// where the point halves the chord and the line cuts off a corner. So the candidates are the
/// lines through two points, in angular order about each point, and one more line for each.
///
/// Three or more points on a line may look in order, by rounding, as if they were not: the
/// outermost one sees all others to one side and judges that line by all of them in any order.
///
/// Source: Dobkin, Eppstein & Mitchell, *Computing the Discrepancy with Applications to
/// Supersampling Patterns*, ACM Trans. Graphics 15(4), 1996; Mitchell 1996, after its first
/// equation of the variance along an edge.
pub fn edge(points: &[f64]) -> f64 {
    let points = pairs(points);
    let mut turn = Turn::default();
    points.iter().map(|pivot| turn.about(*pivot, &points)).fold(f64::NAN, f64::max)
}

/// A line that turns through half a circle about a point. It starts along the x axis and turns
/// towards y; what was on its left at the start is ahead of it, and falls behind.
#[derive(Default)]
struct Turn {
    /// Where the line meets each point that is ahead of the pivot, in order.
    ahead: Vec<f64>,
    /// The same for the points behind, which enter on the left.
    behind: Vec<f64>,
}

impl Turn {
    /// The largest misjudgement of a line through the pivot.
    fn about(&mut self, pivot: [f64; 2], points: &[[f64; 2]]) -> f64 {
        let mut here = 0;
        self.ahead.clear();
        self.behind.clear();
        for point in points {
            let [dx, dy] = [point[0] - pivot[0], point[1] - pivot[1]];
            if dx == 0.0 && dy == 0.0 {
                here += 1;
            } else if dy > 0.0 || dy == 0.0 && dx > 0.0 {
                self.ahead.push(pseudo_angle(dx, dy));
            } else {
                self.behind.push(pseudo_angle(-dx, -dy));
            }
        }
        self.ahead.sort_unstable_by(f64::total_cmp);
        self.behind.sort_unstable_by(f64::total_cmp);

        let n = points.len() as f64;
        let off = |angle: f64, open: usize, closed: usize| {
            // The direction whose pseudo-angle this is, turned to the left.
            let area = SquareCut::new([angle.abs() - 1.0, -angle]).before(pivot);
            let left = 1.0 - area;
            (left - open as f64 / n).max(closed as f64 / n - left)
        };
        let (ahead, behind) = (&self.ahead, &self.behind);
        let corner = corner_cut(pivot);
        let open = ahead.len() - up_to(ahead, corner) + before(behind, corner);
        let closed = ahead.len() - before(ahead, corner) + up_to(behind, corner);
        let mut largest = off(corner, open, closed + here);

        let (mut i, mut j) = (0, 0);
        while let Some(angle) = earlier(ahead.get(i), behind.get(j)) {
            let (left, entered) = (i, j);
            i += run(&ahead[i..], angle);
            j += run(&behind[j..], angle);
            let open = ahead.len() - i + entered;
            let closed = ahead.len() - left + j + here;
            largest = largest.max(off(angle, open, closed));
        }
        largest
    }
}

/// Grows from -1 to 1 as a direction turns from +x by way of +y to -x, with `dy >= 0`; the
/// direction is (-angle, 1 - |angle|) again.
fn pseudo_angle(dx: f64, dy: f64) -> f64 {
    // Adding zero makes a negative zero positive: both are the same angle.
    -dx / (dx.abs() + dy) + 0.0
}

/// Pseudo-angle of the line whose chord of the square the pivot halves: it cuts off the nearest
/// corner, with sides of twice the pivot's distances from the square's.
fn corner_cut([x, y]: [f64; 2]) -> f64 {
    let sides = [x.min(1.0 - x).max(0.0), y.min(1.0 - y).max(0.0)];
    // In the corner itself any line will do that only touches it.
    let [u, v] = if sides == [0.0; 2] { [1.0; 2] } else { sides };
    pseudo_angle(if (x < 0.5) == (y < 0.5) { -u } else { u }, v)
}

fn before(angles: &[f64], angle: f64) -> usize {
    angles.partition_point(|a| *a < angle)
}

fn up_to(angles: &[f64], angle: f64) -> usize {
    angles.partition_point(|a| *a <= angle)
}

/// How many of the first angles are this one.
fn run(angles: &[f64], angle: f64) -> usize {
    angles.iter().take_while(|a| a.total_cmp(&angle).is_eq()).count()
}

fn earlier(a: Option<&f64>, b: Option<&f64>) -> Option<f64> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if a.total_cmp(b).is_le() { *a } else { *b }),
        (one, other) => one.or(other).copied(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_points::{centred_grid, random};
    use super::*;

    fn on_left(a: [f64; 2], direction: [f64; 2], p: [f64; 2]) -> f64 {
        direction[0] * (p[1] - a[1]) - direction[1] * (p[0] - a[0])
    }

    /// The worse of a line's two counts, points within `slack` of it counted both ways.
    fn of_line(points: &[[f64; 2]], a: [f64; 2], direction: [f64; 2], slack: f64) -> f64 {
        let area = 1.0 - SquareCut::new([-direction[1], direction[0]]).before(a);
        let share = |least| {
            let inside = points.iter().filter(|p| on_left(a, direction, **p) > least);
            inside.count() as f64 / points.len() as f64
        };
        (area - share(slack)).max(share(-slack) - area)
    }

    /// Every line through two points, and for each point 4000 lines around it: O(N³).
    fn brute_force(points: &[f64]) -> f64 {
        let points = pairs(points);
        let mut largest = 0.0f64;
        for (i, &a) in points.iter().enumerate() {
            for b in &points[..i] {
                let direction = [b[0] - a[0], b[1] - a[1]];
                if direction != [0.0; 2] {
                    largest = largest.max(of_line(&points, a, direction, 1e-12));
                }
            }
            for step in 0..4000 {
                let (s, c) = (f64::from(step) / 4000.0 * std::f64::consts::PI).sin_cos();
                largest = largest.max(of_line(&points, a, [c, s], 1e-12));
            }
        }
        largest
    }

    /// Turning a line by an angle changes its area by no more than the angle, half the square of
    /// the longest chord: half the fan's step bounds what the fan misses.
    #[test]
    fn agrees_with_every_line_tried() {
        for n in [1, 2, 3, 5, 8, 13, 34] {
            for trial in 0..6 {
                let points = random(n, 2, trial);
                let missed = edge(&points) - brute_force(&points);
                assert!((-1e-11..4e-4).contains(&missed), "{n}: {missed}");
            }
        }
    }

    #[test]
    fn agrees_on_points_in_lines_and_on_each_other() {
        let lattice = |p: &f64| (p * 5.0).floor() / 5.0;
        for trial in 0..20 {
            let crowded: Vec<_> = random(40, 2, trial).iter().map(lattice).collect();
            let missed = edge(&crowded) - brute_force(&crowded);
            assert!((-1e-11..4e-4).contains(&missed), "{missed}");
        }
    }

    /// A point's worst line cuts off its nearest corner, with area 2 u v.
    #[test]
    fn one_point_in_closed_form() {
        for (point, expected) in [
            ([0.5, 0.5], 0.5),
            ([0.25, 0.25], 0.875),
            ([0.9, 0.3], 0.94),
            ([0.2, 0.9], 0.96),
            ([0.5, 0.1], 0.9),
            ([0.0, 0.3], 1.0),
            ([0.0, 0.0], 1.0),
            ([1.0, 0.0], 1.0),
        ] {
            let found = edge(&point);
            assert!((found - expected).abs() < 1e-15, "{point:?}: {found}");
            // The same point three times.
            assert_eq!(edge(&[point; 3].concat()), found);
        }
    }

    /// A line along a row of a centred k × k grid has half a row too few or too many.
    #[test]
    fn centred_grids_in_closed_form() {
        for k in 1..=16 {
            let found = edge(&centred_grid(k));
            assert!((found - 0.5 / k as f64).abs() < 1e-14, "{k}: {found}");
        }
    }

    #[test]
    fn no_symmetry_of_the_square_changes_it() {
        let points = random(50, 2, 7);
        let image = |map: fn([f64; 2]) -> [f64; 2]| {
            let moved: Vec<_> = pairs(&points).into_iter().flat_map(map).collect();
            edge(&moved)
        };
        let value = edge(&points);
        let maps: [fn([f64; 2]) -> [f64; 2]; 3] =
            [|[x, y]| [y, x], |[x, y]| [1.0 - x, y], |[x, y]| [y, 1.0 - x]];
        for map in maps {
            assert!((image(map) - value).abs() < 1e-14);
        }
    }

    #[test]
    fn nothing_and_nonsense_do_not_stop_it() {
        assert!(edge(&[]).is_nan());
        edge(&[f64::NAN, 0.5, 0.1, f64::INFINITY, 0.2, 0.2]);
    }
}
