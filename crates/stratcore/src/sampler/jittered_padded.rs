//! Padded jittered sets: how distribution ray tracing fills its dimensions.

use super::hash::splitmix;
use super::jittered::planar_strata;
use super::permutation::Permutation;
use super::random::UniformPoints;
use super::{Admissible, BELOW_ONE, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
use crate::simd::Isa;

/// A jittered set of N = k² points for each two axes and, where d is odd, one of N strata for
/// the last; the sets are put together in random orders. Every pair of axes is stratified as
/// `jittered` is in the plane; nothing is across pairs.
#[derive(Debug, Clone, Copy)]
pub struct JitteredPadded;

impl Sampler for JitteredPadded {
    fn facts(&self) -> Facts {
        Facts {
            name: "jittered-padded",
            summary: "jittered sets padded: k^2 cells for each two axes, each in a random order",
            source: "Cook, Porter & Carpenter 1984; Cook 1986",
            stream_id: 18,
            kind: Kind::Set,
            max_dim: usize::MAX,
            counts: Admissible::Rule("k^2; any with --n-policy rect"),
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn admits(&self, n: u64, dim: usize, rectangular: bool) -> bool {
        Admissible::Cells.admits(n, dim.min(2), rectangular)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        Admissible::Cells.neighbours(n, dim.min(2))
    }
    fn strata(&self, n: u64, dim: usize) -> Option<Vec<u64>> {
        // A grid of the whole only where there is one set.
        match dim {
            1 => Some(vec![n]),
            2 => Some(planar_strata(n).to_vec()),
            _ => None,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let (n, stream) = (set.key.n_samples, set.key.stream());
        // The first set keeps its order: the whole is the same.
        let others = (1..set.dim.div_ceil(2) as u64)
            .map(|pair| Permutation::new(n, splitmix(stream.scramble_bits(), pair)))
            .collect();
        Box::new(PaddedCells {
            n,
            strata: planar_strata(n),
            others,
            offsets: UniformPoints { stream, dim: set.dim },
        })
    }
}

struct PaddedCells {
    n: u64,
    /// Columns and rows of each pair's grid.
    strata: [u64; 2],
    /// In which order each set but the first takes its cells.
    others: Vec<Permutation>,
    offsets: UniformPoints,
}

impl Points for PaddedCells {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        self.offsets.fill_with(isa, first, points);
        let [columns, rows] = self.strata;
        // With many strata a point can round up to 1.
        let within = |cell: u64, x: f64, k: u64| ((cell as f64 + x) / k as f64).min(BELOW_ONE);
        for (index, point) in (first..).zip(points.chunks_exact_mut(self.offsets.dim)) {
            let cells = std::iter::once(index).chain(self.others.iter().map(|o| o.get(index)));
            for (slot, cell) in point.chunks_mut(2).zip(cells) {
                match slot {
                    [x, y] => {
                        *x = within(cell % columns, *x, columns);
                        *y = within(cell / columns, *y, rows);
                    }
                    // A last axis by itself.
                    [x] => *x = within(cell, *x, self.n),
                    _ => {}
                }
            }
        }
    }
    fn renew(&mut self, stream: &Stream) -> bool {
        self.offsets.stream = *stream;
        let bits = stream.scramble_bits();
        for (pair, order) in (1..).zip(&mut self.others) {
            order.renew(splitmix(bits, pair));
        }
        true
    }
}
