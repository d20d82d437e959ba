//! Exact variances of the mean, from the variances of f within the strata.

use crate::sampler::{Jittered, Sampler, strata_per_axis};
use crate::variance::neumaier_sum;

/// Most strata that are summed one by one: a fraction of a second of work.
pub(super) const MAX_STRATA: u64 = 1 << 20;

/// The exact variance of the mean of `n` points.
///
/// `strata_variance(k)` is the sum, over the k^d strata of a grid, of the variance of f within
/// the stratum, or none where it is not known. One point per stratum makes it
/// `strata_variance(k) / n²`; independent points `strata_variance(1) / n`.
pub(super) fn variance_of_mean(
    sampler: &str,
    n: u64,
    dim: usize,
    strata_variance: impl Fn(u64) -> Option<f64>,
) -> Option<f64> {
    let points = n as f64;
    match sampler {
        "random" if n >= 1 => Some(strata_variance(1)? / points),
        "jittered" if Jittered.admits(n, dim, false) => {
            let k = strata_per_axis(n, dim)[0];
            Some(strata_variance(k)? / points / points)
        }
        _ => None,
    }
}

/// [`variance_of_mean`]'s sum for an indicator function, whose variance within a stratum is
/// v(1 - v): `covered` gives v, the part of the stratum where f = 1, from the stratum's lower
/// corner in units of strata. None beyond [`MAX_STRATA`].
pub(super) fn indicator_strata_variance(
    k: u64,
    dim: usize,
    mut covered: impl FnMut(&[f64]) -> f64,
) -> Option<f64> {
    let strata = u32::try_from(dim).ok().and_then(|dim| k.checked_pow(dim))?;
    if strata > MAX_STRATA {
        return None;
    }
    let mut corner = vec![0.0; dim];
    Some(neumaier_sum((0..strata).map(|stratum| {
        let mut rest = stratum;
        for coordinate in &mut corner {
            *coordinate = (rest % k) as f64;
            rest /= k;
        }
        let v = covered(&corner);
        v * (1.0 - v)
    })))
}

/// One factor of a product f(x) = Π gᵢ(xᵢ), over the k strata of its axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct AxisMoments {
    /// Σ (mean of g within the stratum)².
    pub(super) squared_means: f64,
    /// Σ variance of g within the stratum.
    pub(super) variances: f64,
}

/// [`variance_of_mean`]'s sum for a product of functions of one coordinate each. A stratum of
/// the cube has the variance Π(mᵢ² + vᵢ) - Πmᵢ², so the sum over all is Π(Aᵢ + Vᵢ) - ΠAᵢ with
/// the axes' A = Σm² and V = Σv. It is built up from positive terms: nothing cancels.
pub(super) fn product_strata_variance(axes: impl IntoIterator<Item = AxisMoments>) -> f64 {
    let (mut variance, mut squared_means) = (0.0, 1.0);
    for axis in axes {
        variance =
            variance * (axis.squared_means + axis.variances) + squared_means * axis.variances;
        squared_means *= axis.squared_means;
    }
    variance
}

/// Where a feature is centred along an axis: near the middle of the cube, on no symmetry of
/// any grid, different for each axis. Between 0.45 and 0.55.
pub(super) fn generic_centre(axis: usize) -> f64 {
    let golden_ratio = f64::midpoint(1.0, 5f64.sqrt());
    0.45 + 0.1 * ((axis + 1) as f64 * golden_ratio).fract()
}

/// A unit vector with components ≥ 0 whose d - 1 hyperspherical angles are all `degrees`:
/// (cos a, sin a cos a, …, sin^(d-1) a).
pub(super) fn direction(dim: usize, degrees: f64) -> Vec<f64> {
    // Both ends of [0°, 90°] give exact zeros, so that an aligned plane is aligned.
    let cos = if degrees == 90.0 { 0.0 } else { degrees.to_radians().cos() };
    let sin = degrees.to_radians().sin();
    let mut rest = 1.0;
    let mut direction: Vec<f64> = (1..dim)
        .map(|_| {
            let component = rest * cos;
            rest *= sin;
            component
        })
        .collect();
    direction.push(rest);
    direction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_two_samplers_of_the_paper_have_exact_variances() {
        let ask = |sampler, n| variance_of_mean(sampler, n, 2, |k| Some((k * k) as f64));
        assert_eq!(ask("random", 5), Some(0.2));
        assert_eq!(ask("jittered", 16), Some(1.0 / 16.0));
        assert_eq!(ask("jittered", 5), None);
        assert_eq!(ask("random", 0), None);
        assert_eq!(ask("jittered", 0), None);
        assert_eq!(ask("halton", 16), None);
    }

    #[test]
    fn directions_have_unit_length() {
        for dim in 1..=8 {
            for degrees in [0.0, 1.0, 45.0, 60.0, 90.0] {
                let squares: f64 = direction(dim, degrees).iter().map(|a| a * a).sum();
                assert!((squares - 1.0).abs() < 1e-15);
            }
        }
        assert_eq!(direction(2, 0.0), [1.0, 0.0]);
        assert_eq!(direction(2, 90.0), [0.0, 1.0]);
    }
}
