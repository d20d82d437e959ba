//! Best-candidate patterns.

use super::hash::{splitmix, unit};
use super::patterns::{Pattern, TorusGrid};
use super::{Admissible, Facts, Kind, Scramble};

/// Each point is the one, of a number of candidates that grows with the points there are, that
/// lies farthest from them on the torus.
pub const BEST_CANDIDATE: Pattern = Pattern {
    facts: Facts {
        name: "best-candidate",
        summary: "best-candidate pattern: each point far from those before it",
        source: "Mitchell 1991",
        stream_id: 14,
        kind: Kind::Sequence,
        max_dim: 4,
        // The work grows as its square.
        counts: Admissible::UpTo(1024),
        scrambles: &[Scramble::TorusShift, Scramble::None],
        is_random: false,
    },
    min_dim: 1,
    make: choose_candidates,
};

/// Candidates for each point there is.
const CANDIDATES: usize = 4;

fn choose_candidates(n: usize, dim: usize, key: u64) -> Vec<f64> {
    let mut numbers = (0..).map(|i| unit(splitmix(key, i)));
    let mut grid = TorusGrid::new(n, dim);
    let mut candidate = vec![0.0; dim];
    let mut best = vec![0.0; dim];
    while grid.len() < n {
        let mut farthest = f64::NEG_INFINITY;
        for _ in 0..=CANDIDATES * grid.len() {
            candidate.fill_with(|| numbers.next().unwrap_or(0.0));
            let distance = grid.nearest_sq(&candidate, farthest);
            if distance > farthest {
                farthest = distance;
                best.copy_from_slice(&candidate);
            }
        }
        grid.insert(&best);
    }
    grid.into_points()
}
