//! Best-candidate patterns.

use super::hash::{splitmix, unit};
use super::patterns::{PATTERNS, TorusGrid, pattern};
use super::{Kind, PointSet, Points, Sampler, Scramble};

/// Each point is the one, of a number of candidates that grows with the points there are, that
/// lies farthest from them on the torus.
///
/// Patterns are made once and kept; a torus shift moves them.
#[derive(Debug, Clone, Copy)]
pub struct BestCandidate;

/// The largest N: the work grows as its square.
const MOST: u64 = 1024;
/// Candidates for each point there is.
const CANDIDATES: usize = 4;

impl Sampler for BestCandidate {
    fn name(&self) -> &'static str {
        "best-candidate"
    }
    fn summary(&self) -> &'static str {
        "best-candidate pattern: each point far from those before it"
    }
    fn source(&self) -> &'static str {
        "Mitchell 1991"
    }
    fn stream_id(&self) -> u8 {
        14
    }
    fn kind(&self) -> Kind {
        Kind::Sequence
    }
    fn max_dim(&self) -> usize {
        4
    }
    fn scrambles(&self) -> &'static [Scramble] {
        &[Scramble::TorusShift, Scramble::None]
    }
    fn is_randomised(&self, scramble: Scramble) -> bool {
        scramble != Scramble::None
    }
    fn most_trials(&self, _n: u64, scramble: Scramble) -> u32 {
        if scramble == Scramble::None { PATTERNS } else { u32::MAX }
    }
    fn admits(&self, n: u64, _dim: usize, _rectangular: bool) -> bool {
        (1..=MOST).contains(&n)
    }
    fn neighbours(&self, n: u64, _dim: usize) -> (Option<u64>, Option<u64>) {
        if n == 0 { (None, Some(1)) } else { (Some(MOST), None) }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        pattern(self.stream_id(), set, choose_candidates)
    }
}

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
