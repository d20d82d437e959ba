//! Discrepancy: by how much a point set misjudges the size of regions of the unit cube.
//!
//! Two kinds of regions. *Half-planes* are what a pixel's edges cut off: [`edge`] is the
//! largest misjudgement of any ([`edge_l2_sq`] the mean square over all), in two dimensions,
//! and it does not care how the axes lie. *Boxes* along the axes are those of quasi-Monte Carlo:
//! [`star`], and the L2 discrepancies, in any dimension.
//!
//! Points are row-major `[N, dim]`, every coordinate in [0, 1]. No points have no share of
//! anything: their discrepancy is NaN. L2 discrepancies are squares and say so: `_sq`.

mod edge;
mod edge_l2;
mod half_plane;
mod l2;
mod measure;
mod star;

pub use edge::edge;
pub use edge_l2::edge_l2_sq;
pub(crate) use half_plane::SquareCut;
pub use l2::{centred_sq, l2_star_sq, mixture_sq, wrap_around_sq};
pub use measure::Measure;
pub use star::star;

/// Row-major coordinates in the plane as pairs.
fn pairs(points: &[f64]) -> Vec<[f64; 2]> {
    points.chunks_exact(2).map(|p| [p[0], p[1]]).collect()
}

/// Points that several tests measure.
#[cfg(test)]
pub(crate) mod test_points {
    use crate::rng::StreamKey;

    pub fn random(n: usize, dim: usize, trial: u32) -> Vec<f64> {
        let key = StreamKey { seed: 1996, pixel: [0, 0], sampler: 0, n_samples: n as u64, trial };
        let stream = key.stream();
        (0..).flat_map(|i| stream.pair(i)).take(n * dim).collect()
    }

    pub fn centred_grid(k: usize) -> Vec<f64> {
        let at = |i: usize| (i as f64 + 0.5) / k as f64;
        (0..k * k).flat_map(|i| [at(i % k), at(i / k)]).collect()
    }

    pub fn jittered(k: usize, trial: u32) -> Vec<f64> {
        let offsets = random(k * k, 2, trial);
        let cell = |i: usize| [i % k, i / k];
        let place = |(i, u): (usize, &[f64])| [0, 1].map(|a| (cell(i)[a] as f64 + u[a]) / k as f64);
        offsets.chunks(2).enumerate().flat_map(place).collect()
    }
}
