//! Against another implementation.

use crate::Set;
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
