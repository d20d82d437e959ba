//! What is found of an integrand against what is known of it.

use super::expected::{Grouping, within_cube};
use super::*;
use crate::dimensions::draw::Draws;
use crate::integrand::{Integrand, by_name};
use crate::sampler::Scramble;
use crate::study::{Control, SamplerChoice, StudyPlan, study};

/// f = 2 x0 + (x0 - ½)(x1 - ½) + 3 (x0 - ½)(x2 - ½) + 30 (x0 - ½)(x1 - ½)(x2 - ½), and a step
/// of height 1 along x3; x4 is not used.
struct Known;

impl Integrand for Known {
    fn dim(&self) -> usize {
        5
    }
    fn eval(&self, point: &[f64]) -> f64 {
        let c: Vec<f64> = point.iter().map(|x| x - 0.5).collect();
        let step = f64::from(point[3] < 0.3);
        2.0 * c[0] + c[0] * c[1] + 3.0 * c[0] * c[2] + 30.0 * c[0] * c[1] * c[2] + step
    }
}

fn needs(f: &dyn Integrand) -> Needs {
    Needs::of(f, [0, 0], 1996, 1 << 18, Control::unwatched()).unwrap()
}

/// Twelve estimates within 4.5 standard errors: a false alarm once in 12,000 seeds.
#[test]
fn a_known_integrand_is_taken_apart() {
    let found = needs(&Known);
    // Var c = 1/12 for each factor.
    let one = 4.0 / 12.0;
    let (pair, across) = (1.0 / 144.0, 9.0 / 144.0);
    let three = 900.0 / 1728.0;
    let step = 0.3 * 0.7;
    let total = one + pair + across + three + step;
    let close = |name: &str, found: Estimate, exact: f64| {
        let z = (found.value - exact) / found.std_error;
        assert!(z.abs() < 4.5, "{name}: {} against {exact}, z = {z}", found.value);
    };
    close("variance", found.variance, total);
    close("beyond axes", found.beyond_axes, pair + across + three);
    close("beyond pairs", found.beyond_pairs, across + three);
    close("beyond two", found.beyond_two, three);
    let shares = [one + pair + across + three, pair + three, across + three, step];
    for (axis, exact) in found.axes.iter().zip(shares) {
        close(&axis.name, axis.share, exact / total);
    }
    assert_eq!(found.axes[4].share.value, 0.0);
    let behaviours: Vec<_> = found.axes.iter().map(|axis| axis.behaviour).collect();
    use Behaviour::{Jumps, Smooth, Unused};
    assert_eq!(behaviours, [Smooth, Smooth, Smooth, Jumps, Unused]);
    assert_eq!((found.jumping_axes(), found.discontinuity_dim()), (1, Some(4)));
}

/// Of a sampler in its default scramble.
fn limit_of(sampler: &str, needs: &Needs) -> Option<Limit> {
    limit(sampler, SamplerChoice::named(sampler).unwrap().scramble, needs)
}

#[test]
fn predictions_follow_from_needs() {
    let exponent = |sampler: &str, needs: &Needs| limit_of(sampler, needs).map(|l| l.exponent);
    let found = needs(&Known);
    assert_eq!(exponent("jittered", &found), Some(1.2));
    for sampler in ["random", "jittered-padded", "padded", "lhs", "oa"] {
        assert_eq!(exponent(sampler, &found), Some(1.0), "{sampler}");
    }
    assert_eq!(exponent("sobol", &found), Some(2.0));
    // All within the first pair: padding loses nothing.
    let disk = needs(&*by_name("disk", Some(2), &[]).unwrap());
    assert_eq!(exponent("jittered-padded", &disk), Some(1.5));
    assert_eq!(exponent("sobol", &disk), Some(1.0 + 1.0 / 3.0));
    let smooth = needs(&*by_name("gaussian", Some(3), &[]).unwrap());
    assert_eq!(exponent("jittered", &smooth), Some(1.0 + 2.0 / 3.0));
    assert_eq!(exponent("sobol", &smooth), Some(3.0));
    let constant = needs(&*by_name("constant", Some(2), &[]).unwrap());
    assert_eq!(exponent("random", &constant), None);
    // Of another scramble nothing is known.
    assert_eq!(limit("jittered", Scramble::TorusShift, &smooth), None);
}

/// Fields of 1/200: strata of 1/128 do not tell them apart. Fields of 1/6 are edges.
#[test]
fn detail_is_told_from_edges() {
    let board = |frequency| {
        let params = [("frequency".to_owned(), frequency)];
        needs(&*by_name("checkerboard", Some(2), &params).unwrap())
    };
    let (fine, coarse) = (board(200.0), board(6.0));
    assert_eq!((fine.discontinuity_dim(), coarse.discontinuity_dim()), (Some(2), Some(1)));
    assert!(fine.is_sure() && coarse.is_sure());
    let exponent = |needs| limit_of("jittered", needs).map(|l| l.exponent);
    assert_eq!((exponent(&fine), exponent(&coarse)), (Some(1.0), Some(1.5)));
    assert_eq!(limit_of("sobol", &fine), None);
}

/// Where the noise of a codimension reaches across a mark nothing is predicted but what does not
/// depend on it.
#[test]
fn an_unsure_axis_predicts_nothing() {
    let mut found = needs(&*by_name("gaussian", Some(2), &[]).unwrap());
    assert!(found.is_sure());
    for axis in &mut found.axes {
        axis.codimension = Some(Estimate { value: 1.9, std_error: 0.3 });
    }
    assert!(!found.is_sure());
    assert_eq!(limit_of("jittered", &found), None);
    assert_eq!(limit_of("random", &found).map(|l| l.exponent), Some(1.0));
    // One sure edge decides, whatever the other axis does.
    found.axes[0].behaviour = Behaviour::Jumps;
    found.axes[0].codimension = Some(Estimate { value: 1.0, std_error: 0.1 });
    assert_eq!(limit_of("jittered", &found).map(|l| l.exponent), Some(1.5));
}

/// Differences within strata against variances in closed form, to 4.5 standard errors: twelve
/// of them, a false alarm once in 12,000 seeds.
#[test]
fn differences_give_the_exact_variance_of_jittered() {
    for (name, dim) in [("gaussian", 2), ("form-factor", 4), ("half-space", 2), ("ramp", 3)] {
        let f = by_name(name, Some(dim), &[]).unwrap();
        let control = Control::unwatched();
        let draws = Draws { integrand: &*f, seed: 1996, pixel: [0, 0], control };
        for k in [1u64, 3, 5] {
            let n = k.pow(dim as u32);
            let found = within_cube(draws, k as f64, 1 << 15).unwrap();
            let exact = f.exact_variance("jittered", n).unwrap() * n as f64;
            let z = (found.value - exact) / found.std_error;
            assert!(z.abs() < 4.5, "{name}, N = {n}: {} against {exact}", found.value);
        }
    }
}

/// Measured against expected variances where cells hold two axes, or one, and what they leave
/// is large: s²/σ² of 4,000 trials is known to 2.2 % if they are normal, to 4.5 of which (and
/// the expected value's own error) six may be off. A false alarm once in 25,000 seeds.
#[test]
fn padded_cells_have_the_expected_variance() {
    let found = needs(&Known);
    for (sampler, grouping) in [("jittered-padded", Grouping::Pairs), ("lhs", Grouping::Axes)] {
        let control = Control::unwatched();
        let plan = StudyPlan {
            samplers: vec![SamplerChoice::named(sampler).unwrap()],
            counts: vec![16, 64, 256],
            n_trials: 4000,
            ..StudyPlan::paper()
        };
        let result = study(&Known, [0, 0], &plan, control).unwrap();
        let draws = Draws { integrand: &Known, seed: 1996, pixel: [0, 0], control };
        for row in &result.samplers[0].rows {
            let expected = grouping.expected(draws, &found, row.n, 1 << 14).unwrap();
            let ratio = row.variance_of_mean / expected.variance;
            let unsure = (expected.std_error / expected.variance).powi(2) + row.var_ln();
            let z = (ratio - 1.0) / unsure.sqrt();
            assert!(z.abs() < 4.5, "{sampler}, N = {}: {ratio}, z = {z}", row.n);
        }
    }
}

#[test]
fn too_many_axes_are_refused() {
    let f = by_name("ramp", Some(11), &[]).unwrap();
    let refused = Needs::of(&*f, [0, 0], 1996, 1 << 12, Control::unwatched());
    assert!(refused.unwrap_err().to_string().contains("beyond 10"));
}
