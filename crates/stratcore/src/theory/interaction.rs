//! The purest interaction of two coordinates, f = (x - 1/2)(y - 1/2), whose variance is known
//! exactly under every construction that stratifies: it tells them apart where a sum of
//! functions of one coordinate does not.

/// Variance of the mean of `n` points for f = (x - 1/2)(y - 1/2) on the square, σ² = 1/144; none
/// where no closed form is at hand, or the sampler has no set of `n` points.
///
/// With a = (i + 1/2)/k - 1/2 the centres of k strata, Σa² = k(1 - 1/k²)/12; two lists of k
/// centres, one of them in random order, have a sum of products of variance (Σa²)²/(k - 1).
///
/// * `random`: σ²/N. `jittered`: the strata's own variances.
/// * `lhs`: the N centres of one axis in random order against those of the other.
/// * `cmj`, `oa`: all columns of cells share one order of offsets, so that a whole row moves
///   together: N^(-3/2)/72 at first order, the rate of an edge. `multi-jittered` (Chiu, Shirley
///   & Wang 1994) draws an order for each column: N^-2/72.
/// * `sobol`, `pmj02` (under Owen's scrambling, N = 2^m): digits i of x and j of y have the
///   variance 4^-(i + j)/256 (from 0), and a (0,m,2)-net gains 0 where i + j < m - 1, 2 where it
///   is m - 1, 1 beyond (Owen 1997): N^-3 (28 m/3 + 16/9)/256.
///
/// Source: derived here.
pub fn interaction_variance(sampler: &str, n: u64) -> Option<f64> {
    let points = n as f64;
    let k = points.sqrt().round();
    let square = k * k == points;
    // Centres of all N strata of an axis, and the jitter within a stratum.
    let centres = points * (1.0 - points.powi(-2)) / 12.0;
    let jitter = 1.0 / (12.0 * points * points);
    let within = 2.0 * centres * jitter + points * jitter * jitter;
    // Centres of k strata, against k slabs within a stratum in random order.
    let coarse = k * (1.0 - k.powi(-2)) / 12.0;
    let shuffled = if k > 1.0 { (coarse / k).powi(2) / (k - 1.0) } else { 0.0 };
    let sum = match sampler {
        "random" => points / 144.0,
        "jittered" if square => (2.0 * coarse + 1.0 / (12.0 * k)) / (12.0 * k),
        "lhs" if n == 1 => within,
        "lhs" => centres * centres / (points - 1.0) + within,
        "cmj" | "oa" if square => 2.0 * points * shuffled + within,
        "multi-jittered" if square => {
            let slabs = (1.0 - 1.0 / points) / (12.0 * points);
            2.0 * k * shuffled + points * slabs * slabs + within
        }
        "sobol" | "pmj02" if n.is_power_of_two() => {
            let m = f64::from(n.trailing_zeros());
            // Σ of 4^-(i + j) over i + j = m - 1, twice, and over i + j ≥ m.
            let rest = 4.0 / 3.0 * (m + 1.0) + 4.0 / 9.0;
            (8.0 * m + rest) / (256.0 * points)
        }
        _ => return None,
    };
    (n > 0).then_some(sum / (points * points))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_point_has_the_variance_of_f() {
        let samplers =
            ["random", "jittered", "lhs", "cmj", "oa", "multi-jittered", "sobol", "pmj02"];
        for sampler in samplers {
            let variance = interaction_variance(sampler, 1).unwrap();
            assert!((variance - 1.0 / 144.0).abs() < 1e-15, "{sampler}: {variance}");
        }
    }

    /// Two strata per axis by hand. `lhs` of two points is one of the two diagonals; the mean
    /// of each is ±1/16 before jitter.
    #[test]
    fn the_smallest_sets_by_hand() {
        let jitter = 1.0 / 48.0;
        let lhs = 1.0 / 256.0 + 0.25 * (4.0 * jitter / 16.0 + 2.0 * jitter * jitter);
        assert!((interaction_variance("lhs", 2).unwrap() - lhs).abs() < 1e-15);
        // A net of two points is that same set.
        assert!((interaction_variance("sobol", 2).unwrap() - lhs).abs() < 1e-15);
        // One point in each quarter: variances Π(m² + v) - m⁴ with m² = 1/16 and v = 1/48.
        let quarter = (1.0f64 / 16.0 + jitter).powi(2) - 1.0 / 256.0;
        assert!((interaction_variance("jittered", 4).unwrap() - quarter / 4.0).abs() < 1e-15);
    }

    #[test]
    fn rates_are_those_stated() {
        let large = 1u64 << 40;
        let n = large as f64;
        for (sampler, law) in [
            ("lhs", 1.0 / (144.0 * n)),
            ("cmj", n.powf(-1.5) / 72.0),
            ("multi-jittered", n.powi(-2) / 72.0),
            ("jittered", n.powi(-2) / 72.0),
            ("sobol", n.powi(-3) * (28.0 * 40.0 / 3.0 + 16.0 / 9.0) / 256.0),
        ] {
            let ratio = interaction_variance(sampler, large).unwrap() / law;
            assert!((ratio - 1.0).abs() < 1e-5, "{sampler}: {ratio}");
        }
        assert_eq!(interaction_variance("cmj", 8), None);
        assert_eq!(interaction_variance("sobol", 12), None);
        assert_eq!(interaction_variance("halton", 16), None);
        assert_eq!(interaction_variance("random", 0), None);
    }
}
