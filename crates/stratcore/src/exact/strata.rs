//! What a grid of strata makes of a polynomial.

use super::polynomial::Polynomial;
use super::walk::LANES;

/// Sums over the k strata of [-1/2, 1/2], for each two powers of the coordinate below D.
#[derive(Debug, Clone)]
pub(super) struct Axis<const D: usize> {
    strata: usize,
    /// Where the strata end, from the first one's lower end on; then room for a vector.
    lines: Vec<f64>,
    /// Mean of each power within each stratum, so many strata side by side.
    powers: Vec<[[f64; LANES]; D]>,
    /// Σ (mean of xᵃ)(mean of xᵇ)
    means: [[f64; D]; D],
    /// Σ covariance of xᵃ and xᵇ within the stratum
    within: [[f64; D]; D],
}

impl<const D: usize> Axis<D> {
    pub fn new(strata: usize) -> Self {
        let k = strata as f64;
        let line = |i: usize| i as f64 / k - 0.5;
        let mut axis = Self {
            strata,
            lines: (0..=strata + LANES).map(line).collect(),
            powers: vec![[[0.0; LANES]; D]; strata.div_ceil(LANES)],
            means: [[0.0; D]; D],
            within: [[0.0; D]; D],
        };
        // Mean of the n-th power of the offset from a stratum's centre.
        let moment = |n: usize| match n % 2 {
            0 => (0.5 / k).powi(n as i32) / (n + 1) as f64,
            _ => 0.0,
        };
        for i in 0..strata {
            let terms = about::<D>((i as f64 + 0.5) / k - 0.5);
            let mean: [f64; D] =
                std::array::from_fn(|a| (0..D).map(|l| terms[a][l] * moment(l)).sum());
            for a in 0..D {
                axis.powers[i / LANES][a][i % LANES] = mean[a];
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

    pub fn strata(&self) -> usize {
        self.strata
    }

    /// The lower end of each stratum, the upper one of the last, and as many more as a vector
    /// has lanes.
    pub fn lines(&self) -> &[f64] {
        &self.lines
    }

    /// The mean of each power of the coordinate in stratum `i`.
    pub fn powers(&self, i: usize) -> [f64; D] {
        self.powers[i / LANES].map(|means| means[i % LANES])
    }

    /// The same in the strata from `first` on, a multiple of as many: zero beyond the last.
    pub fn powers_from(&self, first: usize) -> &[[f64; LANES]; D] {
        &self.powers[first / LANES]
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

/// Σ over all strata of a grid of a polynomial's variance within the stratum: a quadratic form
/// of its coefficients.
///
/// For one product of powers the mean square within a stratum is (m² + v)(m'² + v') and the
/// squared mean m²m'², m and v of the two axes. Summed over the strata the difference is
/// V (M' + V') + M V', without a term that cancels.
pub(super) struct VarianceWithin {
    /// What each of the [`products`] counts.
    weights: Vec<f64>,
}

impl VarianceWithin {
    pub fn new<const D: usize>(along_s: &Axis<D>, along_t: &Axis<D>) -> Self {
        let mut weights = Vec::new();
        for_pairs::<D>(|[[a, b], [c, d]]| {
            let (means, within) = (along_s.means[a][c], along_s.within[a][c]);
            let (means_t, within_t) = (along_t.means[b][d], along_t.within[b][d]);
            let twice = if [a, b] == [c, d] { 1.0 } else { 2.0 };
            weights.push(twice * (within * (means_t + within_t) + means * within_t));
        });
        Self { weights }
    }

    /// For the polynomial of these [`products`].
    pub fn of(&self, products: &[f64]) -> f64 {
        self.weights.iter().zip(products).map(|(weight, product)| weight * product).sum()
    }
}

/// The products of any two of a polynomial's coefficients but the constant one, which has no
/// part in variances.
pub(super) fn products<const D: usize>(f: &Polynomial<D>) -> Vec<f64> {
    let n_powers = D * (D + 1) / 2 - 1;
    let mut products = Vec::with_capacity(n_powers * (n_powers + 1) / 2);
    for_pairs::<D>(|[[a, b], [c, d]]| products.push(f.0[a][b] * f.0[c][d]));
    products
}

/// Calls `visit` with each two powers of s and t, different or the same, in one order of them.
fn for_pairs<const D: usize>(mut visit: impl FnMut([[usize; 2]; 2])) {
    for a in 0..D {
        for b in usize::from(a == 0)..D - a {
            for c in a..D {
                for d in if c == a { b } else { 0 }..D - c {
                    visit([[a, b], [c, d]]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_has_the_variance_of_its_slopes() {
        for [k, l] in [[1, 1], [2, 2], [7, 3], [1, 64], [4096, 4096]] {
            let mut ramp = Polynomial::<3>::constant(5.0);
            (ramp.0[1][0], ramp.0[0][1]) = (0.3, -0.4);
            let form = VarianceWithin::new::<3>(&Axis::new(k), &Axis::new(l));
            let variance = form.of(&products(&ramp));
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
        let form = VarianceWithin::new::<5>(&Axis::new(3), &Axis::new(2));
        let variance = form.of(&products(&f));
        assert!((variance / expected - 1.0).abs() < 1e-4, "{variance} {expected}");
    }
}
