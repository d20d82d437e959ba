//! One point per cell of a grid: the paper's stratified sampling.

use super::random::UniformPoints;
use super::{BELOW_ONE, Kind, Placement, PointSet, Points, Sampler, Scramble};

/// One uniform point in each of the N = k^d cells of a grid, or of the k₁ × … × k_d cells of a
/// rectangular one. Cells are numbered with the first coordinate running fastest.
#[derive(Debug, Clone, Copy)]
pub struct Jittered;

impl Sampler for Jittered {
    fn name(&self) -> &'static str {
        "jittered"
    }
    fn summary(&self) -> &'static str {
        "one uniform point in each cell of a k^d grid (stratified sampling)"
    }
    fn source(&self) -> &'static str {
        "Cook, Porter & Carpenter 1984; Mitchell 1996"
    }
    fn stream_id(&self) -> u8 {
        1
    }
    fn kind(&self) -> Kind {
        Kind::Set
    }
    fn max_dim(&self) -> usize {
        usize::MAX
    }
    fn scrambles(&self) -> &'static [Scramble] {
        &[Scramble::None, Scramble::TorusShift]
    }
    fn is_randomised(&self, _scramble: Scramble) -> bool {
        true
    }
    fn admits(&self, n: u64, dim: usize, rectangular: bool) -> bool {
        n >= 1 && (rectangular || root_floor(n, dim).checked_pow(dim as u32) == Some(n))
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        let k = root_floor(n, dim);
        ((k >= 1).then(|| k.pow(dim as u32)), (k + 1).checked_pow(dim as u32))
    }
    fn strata(&self, n: u64, dim: usize) -> Option<Vec<u64>> {
        Some(strata_per_axis(n, dim))
    }
    fn placement(&self) -> Placement {
        Placement::Strata
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let strata = strata_per_axis(set.key.n_samples, set.dim);
        let offsets = UniformPoints { stream: set.key.stream(), dim: set.dim };
        Box::new(JitteredPoints { strata, offsets })
    }
}

/// Strata along each axis for N points in `dim` dimensions: k each where N = k^d, otherwise
/// the split of N into factors that a greedy choice makes as equal as it can, largest first.
/// A prime N is one row of N strata.
pub fn strata_per_axis(n: u64, dim: usize) -> Vec<u64> {
    let mut rest = n;
    (0..dim)
        .map(|axis| {
            let axes_left = dim - axis;
            let balanced = root_floor(rest, axes_left);
            let exact = balanced.checked_pow(axes_left as u32) == Some(rest);
            let k = if exact { balanced } else { smallest_divisor_from(rest, balanced + 1) };
            rest /= k;
            k
        })
        .collect()
}

fn smallest_divisor_from(n: u64, start: u64) -> u64 {
    // A divisor above sqrt(n) is n over one below it, so no search is longer than sqrt(n).
    let root = root_floor(n, 2);
    let small = (start..=root).find(|k| n.is_multiple_of(*k));
    small.unwrap_or_else(|| {
        let largest_quotient = n / start.max(root + 1);
        (1..=largest_quotient).rev().find(|q| n.is_multiple_of(*q)).map_or(n, |q| n / q)
    })
}

/// The largest k with k^dim ≤ n.
pub(super) fn root_floor(n: u64, dim: usize) -> u64 {
    if dim == 1 {
        return n;
    }
    let Ok(dim) = u32::try_from(dim) else { return u64::from(n >= 1) };
    let mut k = (n as f64).powf(1.0 / f64::from(dim)).round() as u64;
    while k.checked_pow(dim).is_none_or(|power| power > n) {
        k -= 1;
    }
    while (k + 1).checked_pow(dim).is_some_and(|power| power <= n) {
        k += 1;
    }
    k
}

struct JitteredPoints {
    strata: Vec<u64>,
    offsets: UniformPoints,
}

impl Points for JitteredPoints {
    fn fill(&self, first: u64, points: &mut [f64]) {
        self.offsets.fill(first, points);
        for (index, point) in (first..).zip(points.chunks_exact_mut(self.strata.len())) {
            let mut rest = index;
            for (coordinate, &k) in point.iter_mut().zip(&self.strata) {
                let cell = rest % k;
                rest /= k;
                // With 2^26 strata the last point can round up to 1.
                *coordinate = ((cell as f64 + *coordinate) / k as f64).min(BELOW_ONE);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::StreamKey;

    fn fill(n: u64, dim: usize) -> Vec<f64> {
        let key = StreamKey { seed: 1996, pixel: [3, 4], sampler: 1, n_samples: n, trial: 2 };
        let set = PointSet { key, dim, scramble: Scramble::None, rectangular: true };
        let mut points = vec![0.0; n as usize * dim];
        Jittered.points(&set).fill(0, &mut points);
        points
    }

    #[test]
    fn every_stratum_holds_one_point() {
        for (n, dim) in
            [(1, 1), (7, 1), (49, 2), (12, 2), (17, 2), (64, 3), (30, 3), (625, 4), (729, 6)]
        {
            let strata = strata_per_axis(n, dim);
            assert_eq!(strata.iter().product::<u64>(), n, "{n} in {dim}: {strata:?}");
            let mut seen = vec![false; n as usize];
            for point in fill(n, dim).chunks(dim) {
                let cell = point.iter().zip(&strata).rev().fold(0, |cell, (x, k)| {
                    assert!((0.0..1.0).contains(x));
                    cell * k + (x * *k as f64) as u64
                });
                assert!(!std::mem::replace(&mut seen[cell as usize], true), "{n} in {dim}");
            }
        }
    }

    #[test]
    fn a_run_from_the_middle_equals_the_whole() {
        let key = StreamKey { seed: 7, pixel: [0, 0], sampler: 1, n_samples: 125, trial: 0 };
        let set = PointSet { key, dim: 3, scramble: Scramble::None, rectangular: false };
        let whole = fill(125, 3);
        let points = Jittered.points(&PointSet {
            key: StreamKey { seed: 1996, pixel: [3, 4], trial: 2, ..key },
            ..set
        });
        let mut run = vec![0.0; 20 * 3];
        points.fill(70, &mut run);
        assert_eq!(run, whole[70 * 3..90 * 3]);
    }

    #[test]
    fn roots_are_exact_at_the_extremes() {
        assert_eq!(root_floor(u64::MAX, 1), u64::MAX);
        assert_eq!(root_floor(u64::MAX, 2), (1 << 32) - 1);
        assert_eq!(root_floor(u64::MAX, 64), 1);
        assert_eq!(root_floor(0, 3), 0);
        for k in [3u64, 1000, (1 << 21) - 1] {
            assert_eq!(root_floor(k.pow(3), 3), k);
            assert_eq!(root_floor(k.pow(3) - 1, 3), k - 1);
        }
    }

    #[test]
    fn rectangles_are_as_square_as_the_count_allows() {
        assert_eq!(strata_per_axis(12, 2), [4, 3]);
        assert_eq!(strata_per_axis(512, 2), [32, 16]);
        assert_eq!(strata_per_axis(7, 2), [7, 1]);
        assert_eq!(strata_per_axis(64, 3), [4, 4, 4]);
    }

    #[test]
    fn the_finest_strata_stay_below_one() {
        let k = 1u64 << 26;
        let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 1, n_samples: 1 << 43, trial: 0 };
        let strata = vec![k, k];
        let points =
            JitteredPoints { strata, offsets: UniformPoints { stream: key.stream(), dim: 2 } };
        let mut last = vec![0.0; 2000];
        points.fill(k * k - 1000, &mut last);
        assert!(last.iter().all(|x| (0.0..1.0).contains(x)));
    }
}
