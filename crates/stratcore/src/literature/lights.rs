//! R1: which pattern suits which light.

use super::LiteratureError;
use super::constants::range;
use super::finding::{Check, Finding, Relation};
use super::lab::{Average, Lab, exponent_of_averages, integrand, powers, ratios, with_checks};
use super::shapes::{Circle, Line, Pulse};
use crate::integrand::Integrand;
use crate::rng::Stream;
use crate::theory::{circle_edge_constant, lattice_edge_constant};

type Outcome = Result<(), LiteratureError>;

pub(super) fn lights(lab: &mut Lab<'_>) -> Outcome {
    linear(lab)?;
    square(lab)?;
    circular(lab)?;
    gaussian(lab)
}

fn linear(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=5);
    let lit = |stream: Stream| {
        let [a, b] = stream.pair(0);
        Pulse { from: a.min(b), to: a.max(b) }
    };
    for sampler in ["jittered", "grid+torus-shift", "sobol+owen", "halton+owen"] {
        let averages = lab.placed(&lit, sampler, &counts)?;
        let case = format!("{sampler}, two steps anywhere");
        let why = "both steps fall into one stratum once in N times: a share of 1/(2N)";
        lab.push(exponent_of_averages(&case, &averages, 2.0).allowing(0.01, why));
    }
    Ok(())
}

/// The variance of uniform jitter over that of stratified points at each N, averaged over
/// placements, in units of what it should be.
fn uniform_over_stratified<I: Integrand>(
    lab: &mut Lab<'_>,
    make: &(dyn Fn(Stream) -> I + Sync),
    counts: &[u64],
    expected: impl Fn(u64) -> f64,
) -> Result<Vec<Check>, LiteratureError> {
    let uniform = lab.placed(make, "grid+torus-shift", counts)?;
    let stratified = lab.placed(make, "jittered", counts)?;
    let check = |(u, s): (&Average, &Average)| {
        let ratio = u.mean / s.mean / expected(u.n);
        let std_error = ratio * (u.std_error / u.mean).hypot(s.std_error / s.mean);
        Check { at: format!("N = {}", u.n), ratio, std_error }
    };
    Ok(uniform.iter().zip(&stratified).map(check).collect())
}

/// The light is the unit square; an occluder's edge, along one side, hides all beyond it.
fn square(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 1..=5);
    let make = |stream: Stream| Line::placed(0.0, stream.pair(0)[0]);
    let checks = uniform_over_stratified(lab, &make, &counts, |n| (n as f64).sqrt())?;
    let case = format!("square light, occluder along a side, {}", range(&counts));
    let finding = Finding::new(case, "variance of uniform jitter / (√N · jittered's)", 1.0);
    let note = "derived: 1/(6N) against N^(-3/2)/6, averaged over the occluder's place";
    lab.push(with_checks(finding, checks).noting(note));
    Ok(())
}

/// The whole light is seen, within its bounding square: its own outline is the edge.
fn circular(lab: &mut Lab<'_>) -> Outcome {
    let n = 4096;
    let radius = |u: f64| 0.25 + 0.1 * u;
    let make = |stream: Stream| Circle { centre: [0.5, 0.5], radius: radius(stream.pair(0)[0]) };
    let constant = lattice_edge_constant() / circle_edge_constant();
    let check = uniform_over_stratified(lab, &make, &[n], |_| 1.0)?.remove(0);
    let case = format!("circular lights of radius 0.25 to 0.35, N = {n}");
    let finding = Finding::new(case, "variance of uniform jitter / jittered's", constant);
    let why = "constants of X3 and K4; the allowance is what the first's oscillation leaves over a \
               range of 6 cells";
    lab.push(finding.measured(check.ratio, check.std_error).allowing(0.012, why));
    Ok(())
}

fn gaussian(lab: &mut Lab<'_>) -> Outcome {
    let f = integrand("gaussian", 2, &[("width", 0.1)])?;
    let [uniform] = lab.studies([&*f], "grid+torus-shift", &[256])?;
    let exact = f.exact_variance("jittered", 256).unwrap_or(f64::NAN);
    let checks = ratios(&uniform, |_| 0.05 * exact);
    let case = "Gaussian light of width 0.1, N = 256";
    let finding = Finding::new(case, "variance of uniform jitter / jittered's", 0.05);
    let note = "\"wins\" is taken as a twentieth; its tails are all that is not periodic";
    lab.push(with_checks(finding.being(Relation::AtMost), checks).noting(note));
    Ok(())
}
