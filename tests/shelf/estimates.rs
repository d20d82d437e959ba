//! What estimates must do: have the right mean, exact variances where they are known, and no
//! correlation between trials, pixels and counts.

use crate::{Set, every_random_set, moments, variance};
use stratcore::sampler::Scramble;

/// An integrand and a number that belongs to it.
type Known = (fn(&[f64]) -> f64, f64);

/// Integrands in any dimension, with their means.
fn integrands(dim: usize) -> [Known; 5] {
    let e = std::f64::consts::E;
    [
        (|p| p[0], 0.5),
        (|p| p.iter().product(), 0.5f64.powi(dim as i32)),
        (|p| p.iter().map(|x| x.exp()).product(), (e - 1.0).powi(dim as i32)),
        (|p| f64::from(p[p.len() - 1] < 0.3), 0.3),
        // A triangle at the origin, in the first and the last axis, or a step.
        (
            |p| f64::from(p[0] + 1.7 * p[p.len() - 1] < 0.9),
            if dim == 1 { 0.9 / 2.7 } else { 0.9 * 0.9 / (2.0 * 1.7) },
        ),
    ]
}

/// The grand mean of 1,500 trials is within five of its standard errors; over the 700 tests
/// below a false alarm has the probability 4e-4.
#[test]
fn every_sampler_is_unbiased_under_every_scramble() {
    const TRIALS: u32 = 1500;
    for (n, dim) in [(1, 2), (7, 2), (16, 2), (9, 1), (16, 3), (25, 5)] {
        for set in every_random_set(n, dim) {
            let sets: Vec<_> = (0..TRIALS).map(|trial| Set { trial, ..set }.points()).collect();
            for (index, (f, mean)) in integrands(dim).into_iter().enumerate() {
                let estimate =
                    |points: &Vec<f64>| points.chunks(dim).map(f).sum::<f64>() / set.n as f64;
                let estimates: Vec<_> = sets.iter().map(estimate).collect();
                let (grand_mean, variance) = moments(&estimates);
                let bound = 5.0 * (variance / f64::from(TRIALS)).sqrt() + 1e-9;
                assert!(
                    (grand_mean - mean).abs() < bound,
                    "{set}, integrand {index}: {grand_mean} instead of {mean} ± {bound}"
                );
            }
        }
    }
}

/// Correlation of k pairs of independent estimates has standard deviation 1/√k; the bound is
/// five. The integrand is neither periodic nor additive, so that no sampler is exact for it.
#[test]
fn trials_pixels_and_counts_are_independent() {
    const PAIRS: u32 = 3000;
    let f = |p: &[f64]| (p[0] * 2.0).exp() * (1.0 + p[1]) + f64::from(p[0] + 0.7 * p[1] < 0.6);
    for n in [1, 16] {
        for set in every_random_set(n, 2) {
            let uncorrelated = |what: &str, other: &dyn Fn(Set) -> Set| {
                let set = |trial| Set { trial: 2 * trial, ..set };
                let [a, b]: [Vec<_>; 2] =
                    [&|s: Set| s, other].map(|change: &dyn Fn(Set) -> Set| {
                        (0..PAIRS).map(|trial| change(set(trial)).estimate(f)).collect()
                    });
                let ((mean_a, var_a), (mean_b, var_b)) = (moments(&a), moments(&b));
                let covariance = a.iter().zip(&b).map(|(a, b)| (a - mean_a) * (b - mean_b));
                let sum = covariance.sum::<f64>();
                let r = sum / f64::from(PAIRS) / (var_a * var_b).sqrt();
                assert!(r.abs() < 5.0 / f64::from(PAIRS).sqrt(), "{}, {what}: {r}", set(0));
            };
            uncorrelated("trials", &|set| Set { trial: set.trial + 1, ..set });
            uncorrelated("seeds", &|set| Set { seed: set.seed + 1, ..set });
            if set.sampler.name() != "zsobol" {
                uncorrelated("pixels", &|set| Set { pixel: [6, 9], ..set });
            }
            let next = [set.n + 1, 4 * set.n, 2, 4, 9, 49, 64];
            let other = next.into_iter().find(|n| *n != set.n && set.sampler.admits(*n, 2, false));
            uncorrelated("counts", &|set| Set { n: other.unwrap(), ..set });
        }
    }
}

/// Mean of N points, one in each of N slabs of every axis: the sum of the coordinates has the
/// variance d/(12 N³). s²/σ² of 2,000 nearly normal trials has standard deviation 0.032; the
/// bound is five.
#[test]
fn one_point_per_slab_makes_additive_integrands_third_order() {
    for (sampler, scramble, n, dim) in [
        ("lhs", Scramble::None, 10, 1),
        ("lhs", Scramble::None, 17, 4),
        ("cmj", Scramble::None, 36, 2),
        ("cmj", Scramble::None, 12, 2),
        ("oa", Scramble::None, 25, 5),
        ("hammersley", Scramble::Owen, 32, 2),
        ("halton", Scramble::Owen, 32, 1),
        ("sobol", Scramble::Owen, 16, 3),
        ("sobol", Scramble::OwenHash, 16, 3),
        ("padded", Scramble::Owen, 32, 4),
        ("padded", Scramble::OwenHash, 32, 4),
        ("pmj02", Scramble::None, 64, 2),
        ("zsobol", Scramble::Owen, 32, 4),
        ("zsobol", Scramble::OwenHash, 32, 4),
    ] {
        let set = Set::named(sampler, scramble, n, dim);
        let measured = variance(&set.estimates(2000, |p| p.iter().sum()));
        let ratio = measured / (dim as f64 / (12.0 * (n as f64).powi(3)));
        assert!((ratio - 1.0).abs() < 0.16, "{set}: {ratio}");
    }
}

/// Latin hypercubes gain nothing where no axis explains anything: for f = Π (x_j - 1/2) in two
/// dimensions the variance of the mean is σ²/N (1 + O(1/N)), and never above σ²/(N - 1).
#[test]
fn latin_hypercubes_are_random_where_nothing_is_additive() {
    let f = |p: &[f64]| (p[0] - 0.5) * (p[1] - 0.5);
    let n = 50;
    let measured = variance(&Set::named("lhs", Scramble::None, n, 2).estimates(2000, f));
    let ratio = measured * n as f64 * 144.0;
    assert!((ratio - 1.0).abs() < 0.18, "{ratio}");
}

/// Nested scrambles share their mean and variance whatever makes them: true Owen scrambling,
/// its hash, random linear scrambling, pmj02's matrices, the padded pair. Two variances of
/// 3,000 trials each differ by 3.7 % in standard deviation; the bound is five. N = 8 keeps the
/// tails of the linear scramble short.
#[test]
fn nested_scrambles_have_one_variance() {
    let f = |p: &[f64]| (-((p[0] - 0.3).powi(2) + (p[1] - 0.6).powi(2)) * 4.0).exp();
    let of = |sampler, scramble| variance(&Set::named(sampler, scramble, 8, 2).estimates(3000, f));
    let truth = of("sobol", Scramble::Owen);
    for (sampler, scramble) in [
        ("sobol", Scramble::OwenHash),
        ("sobol", Scramble::LmsShift),
        ("padded", Scramble::Owen),
        ("zsobol", Scramble::Owen),
        ("zsobol", Scramble::OwenHash),
    ] {
        let ratio = of(sampler, scramble) / truth;
        assert!((ratio - 1.0).abs() < 0.19, "{sampler} {scramble}: {ratio}");
    }
}

/// Scrambled nets: Var ≤ 2^(t + d - 1) σ²/N at N = 2^m, here 2σ²/N, even for integrands made to
/// hurt (Pan & Owen 2021).
#[test]
fn scrambled_nets_are_never_twice_as_bad_as_random() {
    // With their σ², or more than it.
    let hostile: [Known; 3] = [
        (|p| f64::from(((p[0] * 32.0) as u32 + (p[1] * 32.0) as u32) & 1), 0.25),
        (|p| f64::from(((p[0] * 4.0) as u32 + (p[1] * 4.0) as u32) & 1), 0.25),
        (|p| (p[0] * 40.0).sin() * (p[1] * 40.0).sin(), 0.26),
    ];
    for (sampler, scramble) in
        [("sobol", Scramble::Owen), ("sobol", Scramble::OwenHash), ("pmj02", Scramble::None)]
    {
        for n in [4, 16, 64] {
            for (f, bound) in hostile {
                let set = Set::named(sampler, scramble, n, 2);
                let gain = variance(&set.estimates(1000, f)) * n as f64 / bound;
                // s²/σ² of 1,000 trials: 0.045 in standard deviation, five of them above.
                assert!(gain < 2.0 * 1.23, "{set}: {gain}");
            }
        }
    }
}

/// The exponent p between two counts: the standard error of ln s² is √(2/M) each.
fn exponent(
    sampler: &str,
    scramble: Scramble,
    counts: [u64; 2],
    f: impl Fn(&[f64]) -> f64,
    dim: usize,
) -> f64 {
    let [a, b] =
        counts.map(|n| variance(&Set::named(sampler, scramble, n, dim).estimates(400, &f)));
    (a / b).ln() / (counts[1] as f64 / counts[0] as f64).ln()
}

/// Rates over a factor of 64 in N from 400 trials: the standard error of p is 0.024 (normal
/// trials), the bounds are ±0.2 and wider only where the rate itself is still rising.
#[test]
fn rates_are_those_of_the_literature() {
    let gauss = |p: &[f64]| (-p.iter().map(|x| (x - 0.4).powi(2)).sum::<f64>() * 3.0).exp();
    let grows = |p: &[f64]| (p[0] + 0.6 * p[1]).exp();
    // Two of four axes that padding does not stratify together.
    let crossed = |p: &[f64]| (p[0] - 0.5) * (p[2] - 0.5);
    let step = |p: &[f64]| f64::from(p[0] < std::f64::consts::FRAC_1_PI);
    let n = [16, 1024];
    for (what, p, low, high) in [
        ("owen, smooth: 3", exponent("sobol", Scramble::Owen, n, gauss, 2), 2.6, 3.2),
        ("owen-hash, smooth: 3", exponent("sobol", Scramble::OwenHash, n, gauss, 2), 2.6, 3.2),
        ("pmj02, smooth: 3", exponent("pmj02", Scramble::None, n, gauss, 2), 2.6, 3.2),
        ("xor-shift, smooth: 2", exponent("sobol", Scramble::XorShift, n, grows, 2), 1.8, 2.2),
        ("cmj, step: 2", exponent("cmj", Scramble::None, n, step, 2), 1.8, 2.2),
        ("lhs, product: 1", exponent("lhs", Scramble::None, n, crossed, 3), 0.8, 1.2),
        ("padded across pairs: 1", exponent("padded", Scramble::Owen, n, crossed, 4), 0.8, 1.2),
        (
            "jittered-padded across pairs: 1",
            exponent("jittered-padded", Scramble::None, n, crossed, 4),
            0.8,
            1.2,
        ),
        (
            "jittered-padded in a pair: 2",
            exponent("jittered-padded", Scramble::None, n, |p| p[2] * p[3], 4),
            1.8,
            2.2,
        ),
        ("sobol, the same: 3", exponent("sobol", Scramble::Owen, n, crossed, 4), 2.6, 3.2),
        (
            "oa, the same: 2 and more",
            exponent("oa", Scramble::None, [25, 961], crossed, 4),
            1.8,
            3.2,
        ),
        (
            "rank1 with tent, smooth: 4",
            exponent("rank1", Scramble::Tent, [34, 2584], gauss, 2),
            3.2,
            4.4,
        ),
    ] {
        assert!((low..high).contains(&p), "{what}, measured {p:.3}");
    }
}
