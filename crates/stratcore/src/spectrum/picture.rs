//! The periodogram of a picture.

use super::Spectrum;
use std::f64::consts::TAU;

/// The periodogram of a picture of real values, row by row, `width` to a row, |Σ v exp(-2πi k·x)|²
/// over Σ v²: 1 on average over all frequencies, and 1 in the mean at each if pixels are
/// independent with mean 0, whatever their variances. NaN for values that are all 0, or do not
/// fill their rows.
///
/// The sum is taken axis by axis, O(width height (width + height)): exact at any size.
pub fn of_picture(values: &[f64], width: usize) -> Spectrum {
    let height = values.len().checked_div(width).unwrap_or(0);
    let size = [width, height];
    let step = size.map(|side| 1.0 / side as f64);
    if width * height != values.len() || values.is_empty() {
        return Spectrum { size, step, power: vec![f64::NAN; width * height], periodograms: 1 };
    }
    let squares: f64 = values.iter().map(|v| v * v).sum();
    let real = values.iter().map(|v| [*v, 0.0]).collect::<Vec<_>>();
    // Once along x, once along y: each transposes, and two restore the order.
    let sums = transformed(&transformed(&real, width), height);
    let mut power: Vec<_> = sums.iter().map(|[re, im]| (re * re + im * im) / squares).collect();
    power[height / 2 * width + width / 2] = f64::NAN;
    Spectrum { size, step, power, periodograms: 1 }
}

/// The discrete Fourier transform of every row, frequency zero at `width / 2`, as columns.
fn transformed(rows: &[[f64; 2]], width: usize) -> Vec<[f64; 2]> {
    let height = rows.len() / width;
    let wave: Vec<[f64; 2]> = (0..width)
        .map(|turn| {
            let (s, c) = (-TAU * turn as f64 / width as f64).sin_cos();
            [c, s]
        })
        .collect();
    let mut columns = vec![[0.0; 2]; rows.len()];
    for (frequency, column) in columns.chunks_exact_mut(height).enumerate() {
        // k modulo the width, for k from -width/2.
        let k = (frequency + width - width / 2) % width;
        for (sum, row) in column.iter_mut().zip(rows.chunks_exact(width)) {
            let mut turn = 0;
            for [re, im] in row {
                let [c, s] = wave[turn];
                *sum = [sum[0] + re * c - im * s, sum[1] + re * s + im * c];
                turn += k;
                turn -= if turn >= width { width } else { 0 };
            }
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discrepancy::test_points::random;

    #[test]
    fn agrees_with_the_definition() {
        for (width, height) in [(6, 5), (5, 8), (1, 4), (7, 1)] {
            let values: Vec<_> = random(width * height, 1, 3).iter().map(|v| v - 0.5).collect();
            let spectrum = of_picture(&values, width);
            let squares: f64 = values.iter().map(|v| v * v).sum();
            let lowest = |side: usize| -(side as i64 / 2);
            for y in (lowest(height)..).take(height) {
                for x in (lowest(width)..).take(width) {
                    let turns = |i: usize| {
                        let [column, row] = [(i % width) as f64, (i / width) as f64];
                        TAU * (x as f64 * column / width as f64 + y as f64 * row / height as f64)
                    };
                    let sum = |f: fn(f64) -> f64| {
                        values.iter().enumerate().map(|(i, v)| v * f(turns(i))).sum::<f64>()
                    };
                    let expected = (sum(f64::cos).powi(2) + sum(f64::sin).powi(2)) / squares;
                    let found = spectrum.at([x, y]).unwrap();
                    let is_zero = [x, y] == [0, 0] && found.is_nan();
                    assert!(is_zero || (found - expected).abs() < 1e-12, "{x} {y}: {found}");
                }
            }
        }
    }

    #[test]
    fn what_is_no_picture_has_no_power() {
        assert!(of_picture(&[], 3).power().is_empty());
        assert!(of_picture(&[1.0], 0).power().is_empty());
        for values in [&[0.0; 6][..], &[1.0; 7]] {
            assert!(of_picture(values, 3).power().iter().all(|power| power.is_nan()));
        }
    }
}
