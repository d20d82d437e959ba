//! Against another implementation.

use crate::{Set, moments};
use stratcore::sampler::Scramble;

/// SciPy 1.17.1; `contrib/reference/scipy_points.py` has the command. Sobol' coordinates are
/// exact; Halton ones may differ in their last bits, since SciPy adds digit by digit.
#[test]
fn sobol_and_halton_are_those_of_scipy() {
    let rows = include_str!("scipy_points.csv").lines().skip(1);
    let mut compared = 0;
    for row in rows {
        let fields: Vec<_> = row.split(',').collect();
        let (axis, index): (usize, u64) = (fields[1].parse().unwrap(), fields[2].parse().unwrap());
        let expected: f64 = fields[3].parse().unwrap();
        let set = Set::named(fields[0], Scramble::None, 1 << 21, axis + 1);
        let x = set.fill(index, 1)[axis];
        let tolerance = if fields[0] == "sobol" { 0.0 } else { 4.0 * f64::EPSILON };
        assert!((x - expected).abs() <= tolerance, "{row}: {x}");
        compared += 1;
    }
    assert_eq!(compared, 360);
}

/// Fibonacci lattice of 13 points: i and 8i modulo 13.
#[test]
fn the_fibonacci_lattice_is_the_known_one() {
    let points = Set::named("rank1", Scramble::None, 13, 2).points();
    for (i, point) in (0..).zip(points.chunks(2)) {
        assert_eq!(point, [f64::from(i) / 13.0, f64::from(8 * i % 13) / 13.0]);
    }
}

/// R_2 as published: from 1/2 in steps of the plastic number's inverse powers.
#[test]
fn the_r2_sequence_is_the_known_one() {
    let plastic: f64 = 1.324_717_957_244_746;
    let points = Set::named("rd", Scramble::None, 100, 2).points();
    for (i, point) in (0..).zip(points.chunks(2)) {
        for (x, power) in point.iter().zip([1, 2]) {
            let expected = (0.5 + f64::from(i) * plastic.powi(-power)).fract();
            assert!((x - expected).abs() < 1e-13);
        }
    }
}

/// The `sobol_burley` crate has 2^16 points in 256 dimensions, of 32 bits.
#[test]
fn sobol_points_are_those_of_sobol_burley() {
    let set = Set::named("sobol", Scramble::None, 1 << 16, 256);
    for first in [0, 1000, 65_535 - 40] {
        for (index, point) in (first..).zip(set.fill(first, 40).chunks(256)) {
            for (dim, x) in (0..).zip(point) {
                let theirs = sobol_burley::parts::sobol_rev((index as u32).reverse_bits(), dim);
                let theirs = f64::from(theirs.reverse_bits()) * 2f64.powi(-32);
                assert_eq!(*x, theirs, "point {index}, dimension {dim}");
            }
        }
    }
}

/// Its hashed Owen scrambling and ours draw from one distribution: on an integrand that is
/// smooth and one that is not, means and variances of 3,000 trials agree. Two variances differ
/// by 3.7 % in standard deviation, or more for heavier tails; the bound is five.
#[test]
fn hashed_scrambling_is_that_of_sobol_burley() {
    let smooth = |p: &[f64]| (-((p[0] - 0.3).powi(2) + (p[1] - 0.6).powi(2)) * 4.0).exp();
    let edge = |p: &[f64]| f64::from(p[0] + 1.7 * p[1] < 0.9);
    const TRIALS: u32 = 3000;
    for f in [&smooth as &dyn Fn(&[f64]) -> f64, &edge] {
        for n in [8, 16] {
            let ours = Set::named("sobol", Scramble::OwenHash, n, 2).estimates(TRIALS, f);
            let theirs: Vec<_> = (0..TRIALS)
                .map(|seed| {
                    let point = |i| [0, 1].map(|d| sobol_burley::sample(i, d, seed).into());
                    (0..n as u32).map(|i| f(&point(i))).sum::<f64>() / n as f64
                })
                .collect();
            let ((mean, variance), (their_mean, their_variance)) =
                (moments(&ours), moments(&theirs));
            let error = (2.0 * variance / f64::from(TRIALS)).sqrt();
            assert!((mean - their_mean).abs() < 5.0 * error, "{n}: {mean} {their_mean}");
            let ratio = variance / their_variance;
            assert!((ratio - 1.0).abs() < 0.19, "{n}: {ratio}");
        }
    }
}
