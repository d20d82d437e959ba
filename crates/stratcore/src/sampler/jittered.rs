//! One point per cell of a grid: the paper's stratified sampling.

use super::random::{PairLoop, UniformPoints};
use super::{Admissible, BELOW_ONE, Facts, Kind, Placement, PointSet, Points, Sampler, Scramble};
use crate::rng::{PairMap, Stream};
use crate::simd::{self, Divisor, Isa};

/// One uniform point in each of the N = k^d cells of a grid, or of the k₁ × … × k_d cells of a
/// rectangular one. Cells are numbered with the first coordinate running fastest.
#[derive(Debug, Clone, Copy)]
pub struct Jittered;

impl Sampler for Jittered {
    fn facts(&self) -> Facts {
        Facts {
            name: "jittered",
            summary: "one uniform point in each cell of a k^d grid (stratified sampling)",
            source: "Cook, Porter & Carpenter 1984; Mitchell 1996",
            stream_id: 1,
            kind: Kind::Set,
            max_dim: usize::MAX,
            counts: Admissible::Cells,
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn placement(&self, _dim: usize) -> Placement {
        Placement::Strata
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let (n, stream) = (set.key.n_samples, set.key.stream());
        if set.dim == 2 {
            return Box::new(PlanarPoints { stream, strata: planar_strata(n).map(Divisor::new) });
        }
        let offsets = UniformPoints { stream, dim: set.dim };
        Box::new(JitteredPoints { strata: strata_per_axis(n, set.dim), offsets })
    }
}

/// [`strata_per_axis`] in two dimensions, without asking for memory where it need not.
pub(super) fn planar_strata(n: u64) -> [u64; 2] {
    let root = n.isqrt();
    if root * root == n {
        return [root, root];
    }
    let strata = strata_per_axis(n, 2);
    [strata[0], strata[1]]
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
    if dim == 2 {
        return n.isqrt();
    }
    let mut k = (n as f64).powf(1.0 / f64::from(dim)).round() as u64;
    while k.checked_pow(dim).is_none_or(|power| power > n) {
        k -= 1;
    }
    while (k + 1).checked_pow(dim).is_some_and(|power| power <= n) {
        k += 1;
    }
    k
}

/// Points in any number of dimensions.
struct JitteredPoints {
    strata: Vec<u64>,
    offsets: UniformPoints,
}

impl Points for JitteredPoints {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        self.offsets.fill_with(isa, first, points);
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

/// Points in two dimensions: the same, a block at a time.
struct PlanarPoints {
    stream: Stream,
    strata: [Divisor; 2],
}

impl Points for PlanarPoints {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        let Self { stream, strata } = *self;
        simd::run(isa, PairLoop { stream, first, pairs: points, map: IntoCells(strata) });
    }
}

/// Moves pair i into cell i of a grid of columns and rows.
#[derive(Clone, Copy)]
struct IntoCells([Divisor; 2]);

impl PairMap for IntoCells {
    #[inline(always)]
    fn map<const FMA: bool>(self, index: f64, [x, y]: [f64; 2]) -> [f64; 2] {
        let [columns, rows] = self.0;
        let [row, column] = columns.div_rem::<FMA>(index);
        [
            columns.divide::<FMA>(column + x).min(BELOW_ONE),
            rows.divide::<FMA>(row + y).min(BELOW_ONE),
        ]
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

    /// 2^26 strata along each axis, more than any N has: positions keep 27 bits within their
    /// stratum, no two of 2,000 are the same (expected are 0.015 equal pairs), and none leaves
    /// it by more than its upper end.
    #[test]
    fn the_finest_strata_hold_their_points() {
        let k = 1u64 << 26;
        let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 1, n_samples: 1 << 43, trial: 0 };
        let points = PlanarPoints { stream: key.stream(), strata: [k, k].map(Divisor::new) };
        for first in [0, k * k / 3, k * k - 1000] {
            let mut run = vec![0.0; 2000];
            points.fill(first, &mut run);
            assert!(run.iter().all(|x| (0.0..1.0).contains(x)));
            let mut offsets = Vec::new();
            for (index, point) in (first..).zip(run.chunks(2)) {
                for (x, cell) in point.iter().zip([index % k, index / k]) {
                    let offset = x * k as f64 - cell as f64;
                    assert!((0.0..=1.0).contains(&offset), "{index}: {x}");
                    offsets.push(offset);
                }
            }
            offsets.sort_by(f64::total_cmp);
            offsets.dedup();
            assert_eq!(offsets.len(), 2000, "from {first}");
        }
    }

    /// Draws at both ends of their range, in the first and the last cells of every grid: with and
    /// without fused multiply-adds a coordinate stays in [0, 1), on or below its cell's upper end.
    #[test]
    fn extreme_draws_stay_in_the_cube() {
        let draws = [0.0, 2f64.powi(-48), 0.5, 1.0 - 2f64.powi(-48)];
        let large = (12..=24).flat_map(|e| [(1 << e) - 1, 1 << e, (1 << e) + 1]);
        for k in (1..3000u64).chain(large) {
            let map = IntoCells([k, k].map(Divisor::new));
            for cell in [0, k / 2, k - 1] {
                let index = (cell * k + cell) as f64;
                for draw in draws {
                    let plain = ((cell as f64 + draw) / k as f64).min(BELOW_ONE);
                    for point in
                        [map.map::<true>(index, [draw; 2]), map.map::<false>(index, [draw; 2])]
                    {
                        assert_eq!(point, [plain; 2], "{k}, cell {cell}, {draw}");
                        assert!((0.0..1.0).contains(&plain));
                    }
                }
            }
        }
    }

    /// The block loop and the plain one are two ways to write one definition.
    #[test]
    fn planar_points_are_those_of_the_definition() {
        let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 1, n_samples: 1, trial: 0 };
        for strata in [[1, 1], [7, 3], [16, 16], [101, 1], [65_536, 65_536], [999_983, 1 << 24]] {
            let stream = key.stream();
            let plain = JitteredPoints {
                strata: strata.to_vec(),
                offsets: UniformPoints { stream, dim: 2 },
            };
            let planar = PlanarPoints { stream, strata: strata.map(Divisor::new) };
            let n = strata[0] * strata[1];
            for first in [0, n / 3, n.saturating_sub(300)] {
                let len = 300.min(n - first) as usize;
                let (mut a, mut b) = (vec![0.0; 2 * len], vec![0.0; 2 * len]);
                plain.fill_with(Isa::BASELINE, first, &mut a);
                for isa in Isa::available() {
                    planar.fill_with(isa, first, &mut b);
                    assert_eq!(a, b, "{strata:?} from {first}, {}", isa.name());
                }
            }
        }
    }
}
