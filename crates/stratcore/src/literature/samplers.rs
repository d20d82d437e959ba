//! Samplers that only claims need: the Sobol' sequence without its first point, and
//! multi-jittered points whose offsets are not correlated.

use crate::rng::{Stream, StreamKey};
use crate::sampler::{
    Admissible, Facts, Jittered, Kind, PointSet, Points, Sampler, Scramble, Sobol, strata_per_axis,
};
use crate::simd::Isa;

/// The Sobol' sequence from its second point on, as some programs hand it out.
pub(super) struct SobolFromSecond;

impl Sampler for SobolFromSecond {
    fn facts(&self) -> Facts {
        Facts {
            name: "sobol without its first point",
            summary: "points 1 to N of the Sobol' sequence",
            source: "Owen 2020",
            stream_id: 254,
            ..Sobol.facts()
        }
    }
    fn admits(&self, n: u64, dim: usize, rectangular: bool) -> bool {
        Sobol.admits(n + 1, dim, rectangular)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        Sobol.neighbours(n, dim)
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        // One point more: the last index has to be there.
        let key = StreamKey { n_samples: set.key.n_samples + 1, ..set.key };
        Box::new(FromSecond(Sobol.construct(&PointSet { key, ..*set })))
    }
}

struct FromSecond(Box<dyn Points>);

impl Points for FromSecond {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        self.0.fill_with(isa, first + 1, points);
    }
}

/// Multi-jittered points as first published (Chiu, Shirley & Wang, *Multi-jittered sampling*,
/// 1994): one in each of k × k cells and in each of N columns and rows, with an order of the
/// offsets drawn for each column of cells and for each row. `cmj` has one order for all.
pub(super) struct MultiJittered;

impl Sampler for MultiJittered {
    fn facts(&self) -> Facts {
        Facts {
            name: "multi-jittered",
            summary: "stratified in cells and along both axes, offsets drawn for each column and row",
            source: "Chiu, Shirley & Wang 1994",
            stream_id: 253,
            kind: Kind::Set,
            max_dim: 2,
            counts: Admissible::Rule("k^2"),
            scrambles: &[Scramble::None],
            is_random: true,
        }
    }
    fn admits(&self, n: u64, dim: usize, _rectangular: bool) -> bool {
        dim == 2 && Jittered.admits(n, dim, false)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        Jittered.neighbours(n, dim)
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let stream = set.key.stream();
        let n = set.key.n_samples;
        let k = strata_per_axis(n, 2)[0];
        // Orders of the columns, then of the rows; the first N draws are the points' own.
        let orders = (0..2 * k).flat_map(|line| order(&stream, n + line * k, k)).collect();
        Box::new(MultiJitteredPoints { stream, k, orders })
    }
}

/// 0 .. k in random order (Fisher & Yates), from draws `first ..`.
fn order(stream: &Stream, first: u64, k: u64) -> Vec<u64> {
    let mut order: Vec<u64> = (0..k).collect();
    for i in (1..k).rev() {
        let [word, ..] = stream.draw(first + i);
        order.swap(i as usize, ((u64::from(word) * (i + 1)) >> 32) as usize);
    }
    order
}

struct MultiJitteredPoints {
    stream: Stream,
    k: u64,
    /// k orders of the columns of cells, then k of the rows.
    orders: Vec<u64>,
}

impl Points for MultiJitteredPoints {
    fn fill_with(&self, _: Isa, first: u64, points: &mut [f64]) {
        let k = self.k;
        for (index, point) in (first..).zip(points.chunks_exact_mut(2)) {
            let (column, row) = (index % k, index / k);
            let slabs = [
                column * k + self.orders[(column * k + row) as usize],
                row * k + self.orders[((k + row) * k + column) as usize],
            ];
            let jitter = self.stream.pair(index);
            for axis in 0..2 {
                let x = (slabs[axis] as f64 + jitter[axis]) / (k * k) as f64;
                point[axis] = x.min(1f64.next_down());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_and_every_slab_has_one_point() {
        for k in [1u64, 2, 5, 8] {
            let n = k * k;
            let key = StreamKey { seed: 3, pixel: [0, 0], sampler: 253, n_samples: n, trial: 1 };
            let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
            let mut points = vec![0.0; 2 * n as usize];
            MultiJittered.points(&set).fill(0, &mut points);
            let strata = |count: u64, of: &dyn Fn(&[f64]) -> u64| {
                let mut seen: Vec<u64> = points.chunks(2).map(of).collect();
                seen.sort_unstable();
                assert_eq!(seen, (0..count).collect::<Vec<_>>(), "k = {k}");
            };
            let within = |x: f64, count: u64| (x * count as f64) as u64;
            strata(n, &|p| within(p[0], n));
            strata(n, &|p| within(p[1], n));
            strata(n, &|p| within(p[0], k) + k * within(p[1], k));
        }
    }

    #[test]
    fn the_second_point_comes_first() {
        let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 8, n_samples: 9, trial: 0 };
        let set = |n_samples| PointSet {
            key: StreamKey { n_samples, ..key },
            dim: 2,
            scramble: Scramble::Owen,
            rectangular: false,
        };
        let (mut whole, mut rest) = ([0.0; 18], [0.0; 16]);
        Sobol.points(&set(9)).fill(0, &mut whole);
        SobolFromSecond.points(&set(8)).fill(0, &mut rest);
        assert_eq!(whole[2..], rest);
    }
}
