//! Faults of other tools, one test each, named after the fault.

use crate::{Set, every_random_set, every_set, variance};
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;
use stratcore::integrand;
use stratcore::rng::StreamKey;
use stratcore::sampler::{
    Admissible, CountPolicy, PointSet, Random, SHELF, Sampler, Scramble, by_name, check,
};
use stratcore::scene::{self, Channel, Light, Material, Mesh};
use stratcore::study::{Control, SamplerChoice, StudyPlan};
use stratcore::trace::{TracedScene, Tracer};
use stratcore::trial::trial_means;

/// A torus shift that nobody asked for makes jitter on a smooth, non-periodic integrand read
/// p = 3/2 instead of 2: the shifted border cuts strata like an edge. For f = x + y the exact
/// variance of jitter is 2/(12 N²). p from a factor of 64 in N and 500 trials has standard
/// error 0.022; the bound is five.
#[test]
fn trap_implicit_torus_shift_turns_smooth_two_into_three_halves() {
    let exponent = |scramble| {
        let [a, b] = [64, 4096].map(|n| {
            variance(&Set::named("jittered", scramble, n, 2).estimates(500, |p| p[0] + p[1]))
        });
        (a / b).ln() / 64f64.ln()
    };
    let (plain, shifted) = (exponent(Scramble::None), exponent(Scramble::TorusShift));
    assert!((plain - 2.0).abs() < 0.11, "{plain}");
    assert!((shifted - 1.5).abs() < 0.11, "{shifted}");
}

/// A shifted grid reads p = 1 on the same integrand: its one random number moves all points.
#[test]
fn trap_shifted_grid_is_no_better_than_random_on_smooth() {
    let [a, b] = [64, 4096].map(|n| {
        let set = Set::named("grid", Scramble::TorusShift, n, 2);
        variance(&set.estimates(500, |p| p[0] + p[1]))
    });
    let exponent = (a / b).ln() / 64f64.ln();
    assert!((exponent - 1.0).abs() < 0.11, "{exponent}");
}

/// Points asked for and never written stay at the origin.
#[test]
fn trap_unwritten_points_at_the_origin() {
    for set in every_set(512, 2) {
        let at_origin = set.points().chunks(2).filter(|p| **p == [0.0, 0.0]).count();
        // Unscrambled sequences and lattices begin there.
        assert!(at_origin <= usize::from(set.scramble == Scramble::None), "{set}: {at_origin}");
    }
}

/// Points at i/N instead of within their cell: f = x gets variance 0 and bias 1/(2N).
#[test]
fn trap_n_rooks_at_i_over_n_is_biased() {
    let estimates = Set::named("lhs", Scramble::None, 10, 2).estimates(1000, |p| p[0]);
    let (mean, variance) = crate::moments(&estimates);
    assert!(variance > 0.0);
    // Bias would be 0.05; the standard error is √(1/(12 · 10³) / 1000) = 0.0003.
    assert!((mean - 0.5).abs() < 0.0015, "{mean}");
}

/// A swap that is not Fisher and Yates' makes some orders likelier than others. 24 orders of
/// four rooks: chi-square of 23 degrees of freedom, mean 23, P(> 70) = 10^-6.
#[test]
fn trap_rooks_in_unequal_orders() {
    let mut counts = std::collections::BTreeMap::new();
    for trial in 0..12_000 {
        let points = Set { trial, ..Set::named("lhs", Scramble::None, 4, 2) }.points();
        let mut order = [0; 4];
        for p in points.chunks(2) {
            order[(p[0] * 4.0) as usize] = (p[1] * 4.0) as u32;
        }
        *counts.entry(order).or_insert(0.0) += 1.0;
    }
    let chi: f64 = counts.values().map(|c: &f64| (c - 500.0).powi(2) / 500.0).sum();
    assert!(counts.len() == 24 && chi < 70.0, "{chi}");
}

/// A seed that leaves some axis where it was: variance zero, or too small, across seeds.
#[test]
fn trap_seed_that_does_not_reach_an_axis() {
    for dim in [1, 2, 5] {
        for set in every_random_set(16, dim) {
            let first = set.points();
            for other in [Set { seed: 7, ..set }, Set { trial: 1, ..set }] {
                let second = other.points();
                for axis in 0..dim {
                    let mut axes = first.iter().zip(&second).skip(axis).step_by(dim);
                    assert!(axes.any(|(a, b)| a != b), "{set}: axis {axis}");
                }
            }
        }
    }
}

/// A deterministic set repeated is not an experiment: its variance is not zero, it has none.
#[test]
fn trap_variance_of_a_deterministic_set() {
    for sampler in SHELF {
        for scramble in sampler.scrambles() {
            let set = Set::new(*sampler, *scramble, 16, 2);
            let admitted = sampler.admits(16, 2, false);
            let repeats = admitted && set.points() != Set { trial: 1, ..set }.points();
            let random = check(*sampler, *scramble).is_ok();
            assert_eq!(random, sampler.is_randomised(*scramble), "{set}");
            // Stored patterns differ from trial to trial, but are few.
            let few = ["poisson", "best-candidate", "annealed"].contains(&sampler.name());
            assert!(random == repeats || !admitted || few && !random, "{set}");
        }
    }
    let error = check(by_name("sobol").unwrap(), Scramble::None).unwrap_err().to_string();
    assert!(error.contains("deterministic") && error.contains("owen"), "{error}");
}

/// A shift that is implied, not named: every sampler can be shifted, and none is unless asked.
#[test]
fn trap_scrambles_that_are_not_named() {
    for sampler in SHELF {
        assert!(sampler.scrambles().contains(&Scramble::TorusShift), "{}", sampler.name());
        assert!(check(*sampler, sampler.scrambles()[0]).is_ok(), "{}", sampler.name());
    }
}

/// Linear scrambling has the variance of Owen's in the mean, but single estimates of it scatter
/// far more: 20 estimates from 50 trials each, at N = 4,096 on a Gaussian. Of normal trials the
/// largest exceeds the smallest sixfold less than once in 10^5 times.
#[test]
fn trap_linear_scrambles_have_heavy_tails() {
    let f = |p: &[f64]| (-((p[0] - 0.3).powi(2) + (p[1] - 0.6).powi(2)) * 4.0).exp();
    let spread = |scramble| {
        let estimates = Set::named("sobol", scramble, 4096, 2).estimates(1000, f);
        let variances: Vec<_> = estimates.chunks(50).map(variance).collect();
        let largest = variances.iter().copied().fold(0.0, f64::max);
        largest / variances.into_iter().fold(f64::INFINITY, f64::min)
    };
    let (owen, linear) = (spread(Scramble::Owen), spread(Scramble::LmsShift));
    assert!(owen < 6.0, "{owen}");
    assert!(linear > 6.0, "{linear}");
}

/// XOR alone keeps the points' differences: on a checkerboard of 64 × 64 all of up to 64 points
/// fall on one colour, and the variance is that of a single point, 1/4.
#[test]
fn trap_xor_shift_on_a_checkerboard() {
    let f = |p: &[f64]| f64::from(((p[0] * 64.0) as u32 + (p[1] * 64.0) as u32) & 1);
    for n in [16, 64] {
        let gain = |scramble| {
            variance(&Set::named("sobol", scramble, n, 2).estimates(2000, f)) * n as f64 / 0.25
        };
        // A Bernoulli variable of 2,000 trials at one half: s² is 0.25 to within 0.1 %.
        assert!((gain(Scramble::XorShift) / n as f64 - 1.0).abs() < 0.01);
        assert!(gain(Scramble::Owen) < 1.2);
    }
}

/// The screen-space sampler's pixels: each alone has the variance of the scrambled sequence,
/// and a square of four errs far less than four that know nothing of each other.
#[test]
fn trap_neighbouring_pixels_that_share_or_ignore_their_strata() {
    let f = |p: &[f64]| (p[0] * p[1] * 3.0).exp();
    let alone = |sampler, pixel| {
        let set = Set { pixel, ..Set::named(sampler, Scramble::OwenHash, 4, 2) };
        set.estimates(2000, f)
    };
    let square = |sampler| {
        let pixels = [[6, 8], [7, 8], [6, 9], [7, 9]].map(|pixel| alone(sampler, pixel));
        let means: Vec<_> =
            (0..2000).map(|t| pixels.iter().map(|p| p[t]).sum::<f64>() / 4.0).collect();
        (variance(&pixels[0]), variance(&means))
    };
    let ((z_one, z_four), (one, four)) = (square("zsobol"), square("padded"));
    // Two variances of 2,000 trials: 4.5 % in standard deviation, five of them.
    assert!((z_one / one - 1.0).abs() < 0.23, "{z_one} {one}");
    assert!((four / one * 4.0 - 1.0).abs() < 0.23, "{four} {one}");
    assert!(z_four < 0.3 * four, "{z_four} {four}");
}

/// A variance with divisor M instead of M - 1: at M = 2 it is half as large.
#[test]
fn trap_divisor_m() {
    let spread = stratcore::variance::Moments::of(&[1.0, 3.0]);
    assert_eq!((spread.mean, spread.variance), (2.0, 2.0));
}

/// The first points of a larger set used as a smaller one: strata left empty, trials that share
/// points. The points of each N are its own, for sequences too.
#[test]
fn trap_prefix_that_serves_as_a_smaller_set() {
    for set in every_random_set(16, 2) {
        let small = Set { n: 4, ..set };
        if !set.sampler.admits(4, 2, false) {
            continue;
        }
        let large = set.points();
        for point in small.points().chunks(2) {
            assert!(large.chunks(2).all(|p| p != point), "{set}");
        }
    }
}

/// Samples that meet nothing left out of the variance: at a silhouette, the very place where it
/// is largest. A triangle of radiance 1 covers 0.3 of a pixel before a black background: the
/// variance of single samples is 0.3 · 0.7. Of 4,000 Bernoulli trials s² has the standard
/// deviation 0.0029; the bound is five of them.
#[test]
fn trap_misses_that_are_no_samples() {
    let mut scene = scene::load("classic").unwrap();
    scene.light = Light::Headlight;
    (scene.ambient, scene.background) = ([0.0; 3], [0.0; 3]);
    let pixel = [30, 40];
    let frame = scene.camera.pixel(pixel);
    let corners = [[0.3, -500.0], [0.3, 700.0], [-900.0, 0.5]];
    let positions = corners.map(|[u, v]| scene.camera.eye + frame.direction(u, v)).to_vec();
    scene.mesh =
        Mesh { positions, triangles: vec![[0, 1, 2]], materials: vec![0], corner_normals: None };
    scene.materials = vec![Material { ke: [1.0; 3], ..Material::default() }];
    for tracer in [Tracer::Beam, Tracer::Bvh] {
        let scene = TracedScene::new(scene.clone()).with_tracer(tracer);
        let sampler = Random.stream_id();
        let key = StreamKey { seed: 1996, pixel, sampler, n_samples: 1, trial: 0 };
        let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
        let mut means = [0.0; 4000];
        let integrand = scene.pixel(pixel, Channel::Luminance);
        trial_means(&integrand, &Random, &set, 0, &mut means, &AtomicBool::new(false));
        let measured = variance(&means);
        assert!((measured - 0.21).abs() < 0.0145, "{measured}");
    }
}

/// A prime N made one row of N strata without a word: the row says which strata it used, for
/// every sampler that has them.
#[test]
fn trap_strata_of_a_prime_count_unsaid() {
    let cells = SHELF.iter().filter(|s| s.facts().counts == Admissible::Cells);
    let samplers: Vec<_> =
        cells.map(|s| SamplerChoice { sampler: *s, scramble: s.scrambles()[0] }).collect();
    assert!(samplers.len() >= 3);
    let plan = StudyPlan {
        samplers,
        counts: vec![7, 12],
        count_policy: CountPolicy::Rect,
        n_trials: 2,
        ..StudyPlan::paper()
    };
    let ramp = integrand::by_name("ramp", None, &[]).unwrap();
    let result = stratcore::study(&*ramp, [0, 0], &plan, Control::unwatched()).unwrap();
    for sampler in &result.samplers {
        let strata: Vec<_> = sampler.rows.iter().map(|row| row.strata.clone()).collect();
        assert_eq!(strata, [Some(vec![7, 1]), Some(vec![4, 3])], "{}", sampler.name);
    }
}

fn run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stratcli")).args(arguments).output().unwrap()
}

fn stratcli(arguments: &[&str]) -> serde_json::Value {
    let output = run(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// A tool that edits the scene file to set the number of samples: two runs at once spoil each
/// other.
#[test]
fn trap_scene_file_that_is_edited() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("one.obj");
    let text = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(&path, text).unwrap();
    let scene = path.to_str().unwrap();
    stratcli(&["pixel", scene, "--at", "9,9", "--counts", "1,4", "--trials", "3", "--json"]);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
}

/// A seed drawn from the machine and told to nobody: without `--seed` two runs give the same
/// bytes, and the seed stands in them.
#[test]
fn trap_seeds_untold() {
    let arguments = ["integrand", "step", "--counts", "1,4", "--trials", "5", "--json"];
    let result = stratcli(&arguments);
    assert_eq!(result, stratcli(&arguments));
    assert_eq!(result["seed"], 1996);
    let points = stratcli(&["points", "--sampler", "random", "-n", "3", "--json"]);
    assert_eq!(points["seed"], 1996);
}

/// A column whose name does not say which variance, or that divides by the mean where its square
/// is meant: none has such a name, and what an error relative to the mean needs does not change
/// with the integrand's unit. A ramp ten times as steep has ten times the mean and the error.
#[test]
fn trap_relative_variance_over_the_mean() {
    let trade = |slope: &str| {
        let plan = ["--counts", "1,4,16,64", "--trials", "20", "--targets", "10%", "--json"];
        stratcli(&[&["trade", "ramp", "--set", slope][..], &plan].concat())
    };
    let [one, ten] = ["slope=1", "slope=10"].map(trade);
    for sampler in [0, 1] {
        let [a, b] = [&one, &ten]
            .map(|result| result["choices"][0]["reach"][sampler]["n"].as_f64().unwrap());
        assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
    }
    let result = stratcli(&["integrand", "step", "--counts", "1,4", "--trials", "5", "--json"]);
    let row = result["samplers"][0]["rows"][0].as_object().unwrap();
    assert!(row.contains_key("variance_of_mean"), "{row:?}");
    for vague in ["variance", "error", "relative_variance"] {
        assert!(!row.contains_key(vague), "{vague}");
    }
}

/// A mean square error with divisor K - 1, or a variance by that name: what `trade` calls `mse`
/// is the plain mean over trials of the squared distance from the reference, (M - 1)/M s² and
/// the square of the bias.
#[test]
fn trap_mean_square_that_is_a_variance() {
    let plan = ["--counts", "4,16", "--trials", "3", "--json"];
    let trade = stratcli(&[&["trade", "step"][..], &plan].concat());
    let study = stratcli(&[&["integrand", "step"][..], &plan].concat());
    let reference = study["reference"]["mean"].as_f64().unwrap();
    for (sampler, row) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        let of = |document: &serde_json::Value, name: &str| {
            document["samplers"][sampler]["rows"][row][name].as_f64().unwrap()
        };
        let bias = of(&study, "grand_mean") - reference;
        let expected = of(&study, "variance_of_mean") * 2.0 / 3.0 + bias * bias;
        let measured = of(&trade, "mse");
        assert!((measured / expected - 1.0).abs() < 1e-12, "{measured} {expected}");
    }
}

/// Sets of a binary file that are all the first: as trials they would have variance zero. Two
/// sets come out of a file as two, and a file that repeats one is refused.
#[test]
fn trap_binary_sets_that_are_all_the_first() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("sets.dat");
    let sampler = format!("file:{}", path.to_str().unwrap());
    let points =
        |more: &[&str]| run(&[&["points", "--sampler", &sampler, "-n", "2"], more].concat());
    let write = |sets: [[f64; 4]; 2]| {
        let mut bytes = b"UTK!\x05\0\0\0".to_vec();
        bytes.extend([2u32, 2, 2].map(u32::to_le_bytes).concat());
        bytes.extend(sets.concat().into_iter().flat_map(f64::to_le_bytes));
        std::fs::write(&path, bytes).unwrap();
    };
    let [a, b] = [[0.5, 0.25, 0.125, 0.75], [0.1, 0.2, 0.3, 0.4]];
    write([a, b]);
    let read = String::from_utf8(points(&["--sets", "2", "--format", "utk"]).stdout).unwrap();
    assert_eq!(read, "0.5 0.25\n0.125 0.75\n#\n0.1 0.2\n0.3 0.4\n");
    write([a, a]);
    let refused = points(&[]);
    let error = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && error.contains("sets 1 and 2 are identical"), "{error}");
}

/// Squares of some discrepancies among roots of others: functions that give squares say so in
/// their names, and what is asked for by name are roots.
#[test]
fn trap_squares_among_discrepancies() {
    use stratcore::discrepancy::{Measure, centred_sq, l2_star_sq, mixture_sq, wrap_around_sq};
    let points = Set::named("random", Scramble::None, 20, 2).points();
    for (measure, square) in [
        (Measure::L2Star, l2_star_sq(&points, 2)),
        (Measure::Centred, centred_sq(&points, 2)),
        (Measure::WrapAround, wrap_around_sq(&points, 2)),
        (Measure::Mixture, mixture_sq(&points, 2)),
    ] {
        assert_eq!(measure.of(&points, 2), square.sqrt(), "{}", measure.name());
    }
}
