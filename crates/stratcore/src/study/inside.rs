//! The inside of a pixel, magnified.

use super::Control;
use crate::error::StudyError;
use crate::scene::{Channel, Rgb};
use crate::trace::TracedScene;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// What a pixel sees, on a grid of `side` × `side` points at the centres of its cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Inside {
    /// Points along each side.
    pub side: u32,
    /// Linear radiance, row by row from the top left.
    pub rgb: Vec<Rgb>,
    /// The studied channel of it.
    values: Vec<f64>,
}

/// Looks into a pixel with one ray per grid point.
///
/// # Errors
/// [`StudyError::Cancelled`].
pub fn inside(
    scene: &TracedScene,
    pixel: [u32; 2],
    channel: Channel,
    side: u32,
    control: Control<'_>,
) -> Result<Inside, StudyError> {
    let camera = &scene.scene().camera;
    let frame = camera.pixel(pixel);
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let row = |y| -> Vec<Rgb> {
        if control.cancel.load(Ordering::Relaxed) {
            return Vec::new();
        }
        (0..side).map(|x| scene.radiance(camera.eye, frame.direction(at(x), at(y)))).collect()
    };
    let rgb = (0..side).into_par_iter().map(row).collect::<Vec<_>>().concat();
    if control.cancel.load(Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    let values = rgb.iter().map(|rgb| channel.of(*rgb)).collect();
    Ok(Inside { side, rgb, values })
}

impl Inside {
    /// The share that each stratum of an `across` × `down` grid has in the variance of a
    /// stratified estimate, row by row: its variance of f over the grid's points that lie in
    /// it, as a part of the sum over all strata. All zero where f is constant in every stratum,
    /// and in strata too small to hold two points.
    pub fn variance_shares(&self, [across, down]: [u64; 2]) -> Vec<f64> {
        let cells = (across * down) as usize;
        let mut sums = vec![[0.0; 3]; cells];
        let side = u64::from(self.side);
        let pivot = self.values.first().copied().unwrap_or(0.0);
        for (at, value) in (0u64..).zip(&self.values) {
            // The stratum of the point's centre, (i + 1/2) / side.
            let cell = |i: u64, n: u64| ((2 * i + 1) * n / (2 * side)) as usize;
            let sum = &mut sums[cell(at / side, down) * across as usize + cell(at % side, across)];
            let f = value - pivot;
            *sum = [sum[0] + 1.0, sum[1] + f, sum[2] + f * f];
        }
        let variance = |[n, f, ff]: [f64; 3]| {
            let mean = f / n.max(1.0);
            let variance = ff / n.max(1.0) - mean * mean;
            // What subtraction leaves of a constant is rounding.
            if variance > 1e-12 * (ff / n.max(1.0)) { variance } else { 0.0 }
        };
        let variances: Vec<f64> = sums.into_iter().map(variance).collect();
        let total: f64 = variances.iter().sum();
        variances.into_iter().map(|v| if total > 0.0 { v / total } else { 0.0 }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(side: u32, f: impl Fn(f64, f64) -> f64) -> Inside {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
        let values: Vec<f64> = (0..side)
            .flat_map(|y| (0..side).map(move |x| (x, y)))
            .map(|(x, y)| f(at(x), at(y)))
            .collect();
        Inside { side, rgb: values.iter().map(|v| [*v; 3]).collect(), values }
    }

    #[test]
    fn only_cut_strata_carry_variance() {
        let edge = of(64, |x, _| f64::from(x < 0.6));
        let shares = edge.variance_shares([4, 2]);
        for (i, share) in shares.iter().enumerate() {
            let expected = if i % 4 == 2 { 0.5 } else { 0.0 };
            assert!((share - expected).abs() < 1e-12, "{i}: {share}");
        }
        assert!(of(16, |_, _| 0.7).variance_shares([3, 3]).iter().all(|share| *share == 0.0));
    }

    #[test]
    fn strata_finer_than_the_grid_are_no_fault() {
        let shares = of(4, |x, y| x * y).variance_shares([9, 9]);
        assert_eq!((shares.len(), shares.iter().sum::<f64>()), (81, 0.0));
    }

    #[test]
    fn a_pixel_of_the_target_shows_its_edge() {
        let scene = TracedScene::new(crate::scene::load("edges").unwrap());
        let control = Control::unwatched();
        let seen = inside(&scene, [216, 24], Channel::Luminance, 32, control).unwrap();
        let bright = seen.values.iter().filter(|v| **v > 0.5).count() as f64 / 1024.0;
        // Two levels, 0.1 and 0.8, about half each.
        assert!((0.3..0.7).contains(&bright), "{bright}");
    }
}
