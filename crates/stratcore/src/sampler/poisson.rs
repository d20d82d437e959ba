//! Poisson-disk patterns with an exact number of points.

use super::hash::{splitmix, unit};
use super::patterns::{Pattern, TorusGrid};
use super::{Admissible, Facts, Kind, Scramble};

/// Uniform points on the torus, none nearer to another than a radius. The radius starts at that
/// of dense packing and shrinks whenever no room is found, until all N points have their
/// place.
pub const POISSON: Pattern = Pattern {
    facts: Facts {
        name: "poisson",
        summary: "Poisson-disk pattern on the torus, exactly N points",
        source: "Cook 1986; relaxation dart throwing: McCool & Fiume 1992",
        stream_id: 13,
        kind: Kind::Set,
        max_dim: 4,
        // A tenth of a second.
        counts: Admissible::UpTo(4096),
        scrambles: &[Scramble::TorusShift, Scramble::None],
        is_random: false,
    },
    min_dim: 1,
    make: throw_darts,
};

fn throw_darts(n: usize, dim: usize, key: u64) -> Vec<f64> {
    // Hexagonal packing in the plane (2/√3 N)^(1/2); a little more than that elsewhere.
    let mut radius = 1.1 * (n as f64).powf(-1.0 / dim as f64);
    let mut numbers = (0..).map(|i| unit(splitmix(key, i)));
    let mut grid = TorusGrid::new(n, dim);
    let mut dart = vec![0.0; dim];
    let mut misses = 0;
    while grid.len() < n {
        dart.fill_with(|| numbers.next().unwrap_or(0.0));
        // The next smaller number: a dart exactly at the radius is good.
        if grid.nearest_sq(&dart, (radius * radius).next_down()) >= radius * radius {
            grid.insert(&dart);
            misses = 0;
        } else {
            misses += 1;
            if misses == 4 * n {
                radius *= 0.98;
                misses = 0;
            }
        }
    }
    grid.into_points()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_keep_their_distance() {
        for (n, dim) in [(2, 2), (64, 2), (500, 2), (64, 3), (81, 4)] {
            let points = throw_darts(n, dim, 3);
            let mut grid = TorusGrid::new(n, dim);
            let mut least = f64::INFINITY;
            for point in points.chunks(dim) {
                least = least.min(grid.nearest_sq(point, 0.0));
                grid.insert(point);
            }
            // Maximal patterns reach 0.7 of N^(-1/d) in the plane, random points far less.
            assert!(least.sqrt() > 0.65 * (n as f64).powf(-1.0 / dim as f64), "{n} {dim}: {least}");
        }
    }
}
