//! The centres of a grid's cells: the deterministic set that jittering randomises.

use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble, strata_per_axis};
use crate::simd::Isa;

/// The centres of the cells of a k^d (or k₁ × … × k_d) grid. Under a torus shift all points
/// move by one random vector: uniform jitter.
#[derive(Debug, Clone, Copy)]
pub struct Grid;

impl Sampler for Grid {
    fn facts(&self) -> Facts {
        Facts {
            name: "grid",
            summary: "centres of a k^d grid; with one random shift, uniform jitter",
            source: "Ramamoorthi, Anderson, Meyer & Nowrouzezahrai 2012 (uniform jitter)",
            stream_id: 2,
            kind: Kind::Set,
            max_dim: usize::MAX,
            counts: Admissible::Cells,
            scrambles: &[Scramble::TorusShift, Scramble::Tent, Scramble::None],
            is_random: false,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        Box::new(GridPoints { strata: strata_per_axis(set.key.n_samples, set.dim) })
    }
}

struct GridPoints {
    strata: Vec<u64>,
}

impl Points for GridPoints {
    fn fill_with(&self, _isa: Isa, first: u64, points: &mut [f64]) {
        for (index, point) in (first..).zip(points.chunks_exact_mut(self.strata.len())) {
            let mut rest = index;
            for (x, &k) in point.iter_mut().zip(&self.strata) {
                *x = ((rest % k) as f64 + 0.5) / k as f64;
                rest /= k;
            }
        }
    }
}
