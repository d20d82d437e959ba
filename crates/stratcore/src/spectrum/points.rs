//! The periodogram of a point set.

use super::Spectrum;
use std::f64::consts::TAU;

/// The periodogram of two coordinates of a point set, |Σⱼ exp(-2πi k·xⱼ)|² / N, at every integer
/// frequency k up to `cutoff` along each axis. `points` is row-major `[N, dim]`, and `axes` are
/// two of `0 .. dim`; axes that do not exist, and no points, give NaN.
///
/// At integer frequencies the sum is that of the points on the torus and no window is needed.
/// It is taken directly, O(N cutoff²), one product per point and frequency.
pub fn of_points(points: &[f64], dim: usize, axes: [usize; 2], cutoff: u32) -> Spectrum {
    let cutoff = cutoff as usize;
    let width = 2 * cutoff + 1;
    let n = points.len().checked_div(dim).unwrap_or(0) as f64;
    // Frequencies with y >= 0; the power at -k is that at k.
    let mut real = vec![0.0; width * (cutoff + 1)];
    let mut imaginary = real.clone();
    let mut waves = Waves::new(cutoff);
    if axes.iter().all(|axis| *axis < dim) {
        for point in points.chunks_exact(dim) {
            waves.set(axes.map(|axis| point[axis]));
            for (ky, [c, s]) in waves.along_y.iter().enumerate() {
                let row = ky * width..(ky + 1) * width;
                let sums = real[row.clone()].iter_mut().zip(&mut imaginary[row]);
                for ((re, im), (x_re, x_im)) in sums.zip(waves.x_re.iter().zip(&waves.x_im)) {
                    *re += c * x_re - s * x_im;
                    *im += c * x_im + s * x_re;
                }
            }
        }
    } else {
        real.fill(f64::NAN);
    }
    let half: Vec<_> =
        real.iter().zip(&imaginary).map(|(re, im)| (re * re + im * im) / n).collect();
    let mut power: Vec<_> =
        half[width..].rchunks(width).flat_map(|row| row.iter().rev()).copied().collect();
    power.extend(half);
    power[cutoff * width + cutoff] = f64::NAN;
    Spectrum { size: [width; 2], step: [1.0; 2], power, periodograms: 1 }
}

/// exp(-2πi k x) of one point along each axis.
struct Waves {
    /// For k = -cutoff ..= cutoff.
    x_re: Vec<f64>,
    x_im: Vec<f64>,
    /// For k = 0 ..= cutoff.
    along_y: Vec<[f64; 2]>,
}

impl Waves {
    fn new(cutoff: usize) -> Self {
        let x = vec![0.0; 2 * cutoff + 1];
        Self { x_re: x.clone(), x_im: x, along_y: vec![[0.0; 2]; cutoff + 1] }
    }

    fn set(&mut self, [x, y]: [f64; 2]) {
        // Whole turns are dropped first: high frequencies keep their digits.
        let wave = |k: usize, x: f64| (-TAU * (k as f64 * x).fract()).sin_cos();
        let cutoff = self.along_y.len() - 1;
        for k in 0..=cutoff {
            let (s, c) = wave(k, x);
            (self.x_re[cutoff + k], self.x_im[cutoff + k]) = (c, s);
            (self.x_re[cutoff - k], self.x_im[cutoff - k]) = (c, -s);
            let (s, c) = wave(k, y);
            self.along_y[k] = [c, s];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrepancy::test_points::{centred_grid, random};

    #[test]
    fn agrees_with_the_definition() {
        let points = random(23, 3, 1);
        let spectrum = of_points(&points, 3, [2, 0], 7);
        for y in -7..=7i64 {
            for x in -7..=7i64 {
                let turns = |p: &[f64]| TAU * (x as f64 * p[2] + y as f64 * p[0]);
                let sum = |f: fn(f64) -> f64| points.chunks(3).map(|p| f(turns(p))).sum::<f64>();
                let expected = (sum(f64::cos).powi(2) + sum(f64::sin).powi(2)) / 23.0;
                let found = spectrum.at([x, y]).unwrap();
                assert!(
                    (found - expected).abs() < 1e-11 || [x, y] == [0, 0] && found.is_nan(),
                    "{x} {y}: {found} {expected}"
                );
            }
        }
        assert_eq!(spectrum.at([8, 0]), None);
    }

    /// A grid has all its power where both frequencies are multiples of k.
    #[test]
    fn a_grid_is_a_comb() {
        let spectrum = of_points(&centred_grid(6), 2, [0, 1], 20);
        for y in -20..=20 {
            for x in -20..=20 {
                let expected = if x % 6 == 0 && y % 6 == 0 { 36.0 } else { 0.0 };
                let found = spectrum.at([x, y]).unwrap();
                assert!((found - expected).abs() < 1e-9 || [x, y] == [0, 0], "{x} {y}: {found}");
            }
        }
    }

    #[test]
    fn nothing_has_no_power() {
        for (points, dim, axes) in [(&[][..], 2, [0, 1]), (&[0.5], 1, [0, 1]), (&[0.5], 0, [0, 0])]
        {
            let spectrum = of_points(points, dim, axes, 2);
            assert!(spectrum.power().iter().all(|power| power.is_nan()));
        }
    }
}
