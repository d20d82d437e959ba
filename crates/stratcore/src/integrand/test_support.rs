//! The oracle of this folder's tests: moments by brute force on a fine grid.

use super::{Integrand, by_name};

pub(super) fn build(name: &str, dim: usize, params: &[(&str, f64)]) -> Box<dyn Integrand> {
    let params: Vec<_> = params.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    by_name(name, Some(dim), &params).unwrap()
}

/// Compares the reference and the exact variances for `random` and for `jittered` with 1 to 4
/// strata per axis against a midpoint grid of 720, 72 or 24 points per axis. Variances within
/// strata may differ by `tolerance` of f's variance, the mean by as much of f's size.
pub(super) fn check_against_grid(name: &str, dim: usize, params: &[(&str, f64)], tolerance: f64) {
    let f = build(name, dim, params);
    let points_per_axis = match dim {
        1 | 2 => 720u64,
        3 => 72,
        _ => 24,
    };
    let case = format!("{name} {params:?} d = {dim}");
    let variance = f.exact_variance("random", 1).unwrap();
    let mean = f.reference().unwrap().mean;
    let (grid_mean, grid_variance) = moments(&*f, points_per_axis, 1);
    let size = mean.abs() + variance.sqrt();
    assert!((grid_mean - mean).abs() <= tolerance * size, "{case}: {grid_mean} {mean}");
    let bound = tolerance * variance + 1e-28;
    assert!((grid_variance - variance).abs() <= bound, "{case}: {grid_variance} {variance}");
    for k in 1..=4u64 {
        let n = k.pow(dim as u32);
        let Some(exact) = f.exact_variance("jittered", n) else { continue };
        let (exact, (_, grid)) = (exact * n as f64, moments(&*f, points_per_axis, k));
        assert!((exact - grid).abs() <= bound, "{case}, k = {k}: {exact} {grid}");
    }
}

/// The mean, and the variance within a stratum averaged over the strata.
fn moments(f: &dyn Integrand, points_per_axis: u64, k: u64) -> (f64, f64) {
    let dim = f.dim() as u32;
    let per_stratum = points_per_axis / k;
    let mut strata = vec![(f64::NAN, 0.0, 0.0); k.pow(dim) as usize];
    let mut point = vec![0.0; dim as usize];
    for index in 0..points_per_axis.pow(dim) {
        let (mut rest, mut stratum) = (index, 0);
        for x in &mut point {
            let i = rest % points_per_axis;
            rest /= points_per_axis;
            stratum = stratum * k + i / per_stratum;
            *x = (i as f64 + 0.5) / points_per_axis as f64;
        }
        // Sums of deviations from a value of the stratum itself keep small variances.
        let (pivot, sum, squares) = &mut strata[stratum as usize];
        let value = f.eval(&point);
        if pivot.is_nan() {
            *pivot = value;
        }
        *sum += value - *pivot;
        *squares += (value - *pivot).powi(2);
    }
    let count = per_stratum.pow(dim) as f64;
    let mean = strata.iter().map(|(pivot, sum, _)| pivot + sum / count).sum::<f64>();
    let variance = strata.iter().map(|(_, sum, squares)| (squares - sum * sum / count) / count);
    (mean / strata.len() as f64, variance.sum::<f64>() / strata.len() as f64)
}
