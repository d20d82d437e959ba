//! Patterns that are searched for, not written down: made once, kept, and shifted.

use super::hash::splitmix;
use super::memo::Memo;
use super::{Facts, PointSet, Points, Sampler, Scramble};
use crate::simd::Isa;
use std::sync::Arc;

/// Different patterns of one kind, size and dimension.
const PATTERNS: u32 = 4;

/// A sampler whose points are sought by a costly rule: a few patterns of each size are made
/// once and kept for the life of the process.
///
/// Trial t under seed s takes pattern number (s + t) modulo as many as there are. A torus shift
/// of its own for each trial makes the estimates of trials with the same pattern independent
/// and unbiased; unshifted, patterns serve for no more trials than there are of them.
#[derive(Debug)]
pub struct Pattern {
    pub(super) facts: Facts,
    /// Least dimension; [`Facts::max_dim`] is the largest.
    pub(super) min_dim: usize,
    /// Makes a pattern, row-major, of N, the dimension and a key.
    pub(super) make: fn(usize, usize, u64) -> Vec<f64>,
}

impl Sampler for Pattern {
    fn facts(&self) -> Facts {
        self.facts
    }
    fn most_trials(&self, _n: u64, scramble: Scramble) -> u32 {
        if scramble == Scramble::None { PATTERNS } else { u32::MAX }
    }
    fn admits(&self, n: u64, dim: usize, rectangular: bool) -> bool {
        dim >= self.min_dim && self.facts.counts.admits(n, dim, rectangular)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        if dim < self.min_dim { (None, None) } else { self.facts.counts.neighbours(n, dim) }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        static MADE: Memo<(u8, u64, usize, u64), f64> = Memo::new();
        let (sampler, n) = (self.facts.stream_id, set.key.n_samples);
        let class = set.key.seed.wrapping_add(set.key.trial.into()) % u64::from(PATTERNS);
        let key = splitmix(sampler.into(), class);
        let make = || (self.make)(n as usize, set.dim, key);
        let points = MADE.get((sampler, n, set.dim, class), make);
        Box::new(StoredPoints { points, dim: set.dim })
    }
}

/// Points in memory.
pub(super) struct StoredPoints {
    pub(super) points: Arc<[f64]>,
    pub(super) dim: usize,
}

impl Points for StoredPoints {
    fn fill_with(&self, _isa: Isa, first: u64, points: &mut [f64]) {
        let at = first as usize * self.dim;
        points.copy_from_slice(&self.points[at..at + points.len()]);
    }
}

/// Points on the unit torus in cells of a grid, to find the nearest.
pub(super) struct TorusGrid {
    dim: usize,
    cells_per_axis: i64,
    /// Indices of the points in each cell.
    cells: Vec<Vec<u32>>,
    points: Vec<f64>,
}

impl TorusGrid {
    /// For about `n` points.
    pub(super) fn new(n: usize, dim: usize) -> Self {
        let cells_per_axis = (n as f64).powf(1.0 / dim as f64).floor().max(1.0) as i64;
        let cells = vec![Vec::new(); cells_per_axis.pow(dim as u32) as usize];
        Self { dim, cells_per_axis, cells, points: Vec::with_capacity(n * dim) }
    }

    pub(super) fn len(&self) -> usize {
        self.points.len() / self.dim
    }

    pub(super) fn into_points(self) -> Vec<f64> {
        self.points
    }

    pub(super) fn insert(&mut self, point: &[f64]) {
        let cell = self.cell(point, &vec![0; self.dim]);
        let index = self.len() as u32;
        self.cells[cell].push(index);
        self.points.extend_from_slice(point);
    }

    /// Squared distance to the nearest point, or any value up to `enough` if it is no more
    /// than that; infinite where there is no point.
    pub(super) fn nearest_sq(&self, point: &[f64], enough: f64) -> f64 {
        let mut nearest = f64::INFINITY;
        let mut offset = vec![0; self.dim];
        for ring in 0..=self.cells_per_axis / 2 + 1 {
            offset.fill(-ring);
            loop {
                if offset.iter().any(|o| o.abs() == ring) {
                    for &other in &self.cells[self.cell(point, &offset)] {
                        nearest = nearest.min(self.distance_sq(point, other as usize));
                    }
                }
                if !next_offset(&mut offset, ring) {
                    break;
                }
            }
            // Points of the rings outside are further away than the rings inside are wide.
            let reach = (ring as f64 / self.cells_per_axis as f64).powi(2);
            if nearest <= enough.max(reach) {
                break;
            }
        }
        nearest
    }

    /// The cell of a point, moved by so many cells.
    fn cell(&self, point: &[f64], offset: &[i64]) -> usize {
        let m = self.cells_per_axis;
        let axis_cell = |(x, o): (&f64, &i64)| ((x * m as f64) as i64 + o).rem_euclid(m);
        point.iter().zip(offset).map(axis_cell).fold(0, |cell, c| cell * m + c) as usize
    }

    fn distance_sq(&self, point: &[f64], other: usize) -> f64 {
        let other = &self.points[other * self.dim..][..self.dim];
        let torus = |(a, b): (&f64, &f64)| {
            let d = (a - b).abs();
            d.min(1.0 - d).powi(2)
        };
        point.iter().zip(other).map(torus).sum()
    }
}

/// Counts through all offsets from -ring to ring; false after the last.
fn next_offset(offset: &mut [i64], ring: i64) -> bool {
    for o in offset {
        if *o < ring {
            *o += 1;
            return true;
        }
        *o = -ring;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::super::hash::unit;
    use super::*;

    #[test]
    fn the_nearest_point_is_that_of_a_plain_search() {
        for (n, dim) in [(1, 2), (2, 1), (50, 1), (200, 2), (100, 3), (81, 4)] {
            let mut numbers = (0..).map(|i| unit(splitmix(n as u64, i)));
            let mut draw = || numbers.by_ref().take(dim).collect::<Vec<_>>();
            let mut grid = TorusGrid::new(n, dim);
            for _ in 0..n {
                grid.insert(&draw());
            }
            assert_eq!(grid.len(), n);
            for _ in 0..200 {
                let point = draw();
                let plain =
                    (0..n).map(|i| grid.distance_sq(&point, i)).fold(f64::INFINITY, f64::min);
                assert_eq!(grid.nearest_sq(&point, 0.0), plain);
                let enough = grid.nearest_sq(&point, 0.01);
                assert!(enough == plain || enough <= 0.01);
            }
        }
    }
}
