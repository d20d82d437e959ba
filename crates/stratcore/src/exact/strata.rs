//! What a grid of strata makes of a polynomial.

use super::polynomial::Polynomial;

/// Sums over the k strata of [-1/2, 1/2], for each two powers of the coordinate below D.
#[derive(Debug, Clone)]
pub(super) struct Axis<const D: usize> {
    /// Where the strata end, from the first one's lower end on.
    lines: Vec<f64>,
    /// Mean of each power within each stratum.
    powers: Vec<[f64; D]>,
    /// Σ (mean of xᵃ)(mean of xᵇ)
    means: [[f64; D]; D],
    /// Σ covariance of xᵃ and xᵇ within the stratum
    within: [[f64; D]; D],
}

impl<const D: usize> Axis<D> {
    pub fn new(strata: u64) -> Self {
        let mut axis = Self {
            lines: (0..=strata).map(|i| i as f64 / strata as f64 - 0.5).collect(),
            powers: Vec::with_capacity(strata as usize),
            means: [[0.0; D]; D],
            within: [[0.0; D]; D],
        };
        // Mean of the n-th power of the offset from a stratum's centre.
        let moment = |n: usize| match n % 2 {
            0 => (0.5 / strata as f64).powi(n as i32) / (n + 1) as f64,
            _ => 0.0,
        };
        for i in 0..strata {
            let terms = about::<D>((i as f64 + 0.5) / strata as f64 - 0.5);
            let mean: [f64; D] =
                std::array::from_fn(|a| (0..D).map(|l| terms[a][l] * moment(l)).sum());
            axis.powers.push(mean);
            for a in 0..D {
                for b in 0..D {
                    axis.means[a][b] += mean[a] * mean[b];
                    // Sums of products of small offsets: nothing large cancels.
                    for l in 1..=a {
                        for m in 1..=b {
                            let covariance = moment(l + m) - moment(l) * moment(m);
                            axis.within[a][b] += terms[a][l] * terms[b][m] * covariance;
                        }
                    }
                }
            }
        }
        axis
    }

    pub fn strata(&self) -> u64 {
        self.powers.len() as u64
    }

    /// The lower end of stratum `i`, or the upper one of that before.
    #[inline(always)]
    pub fn line(&self, i: u64) -> f64 {
        self.lines[i as usize]
    }

    /// The mean of each power of the coordinate in stratum `i`.
    pub fn powers(&self, i: u64) -> &[f64; D] {
        &self.powers[i as usize]
    }
}

/// Powers of the coordinate, each as a polynomial in the offset from x.
fn about<const D: usize>(x: f64) -> [[f64; D]; D] {
    let mut terms = [[0.0; D]; D];
    terms[0][0] = 1.0;
    for a in 1..D {
        for l in 0..=a {
            let carried = if l > 0 { terms[a - 1][l - 1] } else { 0.0 };
            terms[a][l] = x * terms[a - 1][l] + carried;
        }
    }
    terms
}

/// Σ over all strata of a grid of the variance of `f` within the stratum.
///
/// For one product of powers the mean square within a stratum is (m² + v)(m'² + v') and the
/// squared mean m²m'², m and v of the two axes. Summed over the strata the difference is
/// V (M' + V') + M V', without a term that cancels.
pub(super) fn variance_within<const D: usize>(
    f: &Polynomial<D>,
    along_s: &Axis<D>,
    along_t: &Axis<D>,
) -> f64 {
    let mut sum = 0.0;
    for a in 0..D {
        for c in 0..D {
            let (means, within) = (along_s.means[a][c], along_s.within[a][c]);
            for b in 0..D - a {
                for d in 0..D - c {
                    let (means_t, within_t) = (along_t.means[b][d], along_t.within[b][d]);
                    let product = within * (means_t + within_t) + means * within_t;
                    sum += f.0[a][b] * f.0[c][d] * product;
                }
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_the_variance_of_its_slopes() {
        for [k, l] in [[1, 1], [2, 2], [7, 3], [1, 64], [4096, 4096]] {
            let mut ramp = Polynomial::<3>::constant(5.0);
            (ramp.0[1][0], ramp.0[0][1]) = (0.3, -0.4);
            let variance = variance_within(&ramp, &Axis::new(k), &Axis::new(l));
            let (width, height) = (1.0 / k as f64, 1.0 / l as f64);
            let n = (k * l) as f64;
            let expected = n * ((0.3 * width).powi(2) + (0.4 * height).powi(2)) / 12.0;
            assert!((variance / expected - 1.0).abs() < 1e-12, "{k} × {l}: {variance} {expected}");
        }
    }

    #[test]
    fn products_of_high_powers_match_a_fine_grid() {
        let mut f = Polynomial::<5>::ZERO;
        (f.0[2][2], f.0[4][0], f.0[1][3], f.0[0][1]) = (3.0, -1.0, 2.0, 0.1);
        let (k, l, fine) = (3, 2, 400);
        let mut expected = 0.0;
        for i in 0..k {
            for j in 0..l {
                let at = |cell: u32, sub: u32, n: u32| {
                    (f64::from(cell) + (f64::from(sub) + 0.5) / f64::from(fine)) / f64::from(n)
                        - 0.5
                };
                let values: Vec<f64> = (0..fine * fine)
                    .map(|p| f.at(at(i, p % fine, k), at(j, p / fine, l)))
                    .collect();
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                expected +=
                    values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
            }
        }
        let variance = variance_within(&f, &Axis::new(3), &Axis::new(2));
        assert!((variance / expected - 1.0).abs() < 1e-4, "{variance} {expected}");
    }
}
