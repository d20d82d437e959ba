//! Patterns and their spectra: scanlines, homogenised sets, anisotropic samplers, lattices.

use super::constants::range;
use super::finding::{Check, Finding};
use super::lab::{
    Lab, allowing_exact, cells, exact_exponent, exponent_of, exponent_of_averages, integrand,
    powers, ratios, with_checks,
};
use super::samplers::MultiJittered;
use super::shapes::{Circle, Interaction, Line, PairSum, Wave};
use super::{Claim, LiteratureError, Standing, lights};
use crate::rng::Stream;
use crate::sampler::Scramble;
use crate::study::SamplerChoice;
use crate::theory::{
    interaction_variance, lattice_edge_constant, shifted_ramp_variance, step_variance,
    stratified_variance,
};
use std::f64::consts::PI;

type Outcome = Result<(), LiteratureError>;

pub(super) const CLAIMS: &[Claim] = &[
    Claim {
        id: "R1",
        statement: "linear lights: p = 2 for every stratified pattern; with two discontinuities \
                    uniform jitter has half the variance of stratified points (values in K7). \
                    Planar lights: uniform jitter loses on a square one, whose scanlines err \
                    alike, and wins on a circular or Gaussian one",
        source: "Ramamoorthi et al. 2012, abstract",
        standing: Standing::Abstract,
        measure: lights::lights,
    },
    Claim {
        id: "S1",
        statement: "a random torus shift removes the bias of any pattern, and takes its strata \
                    apart: jittered p = 3/2 and grid p = 1 for a smooth f that is not periodic",
        source: "Subr & Kautz 2013 for the idea; exponents derived here",
        standing: Standing::Measured,
        measure: homogenised,
    },
    Claim {
        id: "P1",
        statement: "power spectrum ~ρ^b at low frequency: jittered b = 2, hence p = 1 + 2/d at \
                    best and 1 + 1/d at worst; random b = 0",
        source: "Pilleboue et al. 2015, figure caption; formula derived",
        standing: Standing::Derived,
        measure: spectra,
    },
    Claim {
        id: "P2",
        statement: "worst and best exponents: random 1/1, Poisson-disk 1/1, jittered 1.5/2, \
                    CCVT 1.5/2.5 in the plane",
        source: "Pilleboue et al. 2015, table",
        standing: Standing::Sure,
        measure: worst_and_best,
    },
    Claim {
        id: "A1",
        statement: "the rate depends on alignment: lhs 3 for additive f (2 for a step along an \
                    axis), else 1; multi-jittered 1.5 for an oblique edge, 2 for smooth f if offsets are drawn \
                    for each column (3/2 if they are shared, as in cmj)",
        source: "Singh & Jarosz 2017, abstract; numbers derived",
        standing: Standing::Derived,
        measure: anisotropic,
    },
    Claim {
        id: "J1",
        statement: "padding 2-D sets takes truly 4-D integrands back to p = 1",
        source: "Jarosz et al. 2019, abstract",
        standing: Standing::Abstract,
        measure: padded,
    },
    Claim {
        id: "J2",
        statement: "orthogonal arrays of strength 2: sums of functions of two coordinates keep \
                    the rates of the plane; an interaction of three has p = 1",
        source: "Jarosz et al. 2019, abstract for the property; rate derived",
        standing: Standing::Derived,
        measure: orthogonal,
    },
    Claim {
        id: "X1",
        statement: "Halton and R2 under a torus shift: p of 1.7 to 2.2 for smooth f, 1.4 to 1.9 \
                    for edges",
        source: "no theorem at finite N; seen in earlier measurements",
        standing: Standing::Measured,
        measure: shifted_sequences,
    },
    Claim {
        id: "X3",
        statement: "shifted grid: p = 1 for a smooth f that is not periodic, 3/2 for circles",
        source: "derived here; circles: Kendall 1948",
        standing: Standing::Measured,
        measure: shifted_grid,
    },
];

fn homogenised(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    let ramp = integrand("ramp", 2, &[])?;
    let case = format!("jittered+torus-shift, ramp, {}", range(&counts));
    let row = lab.exact(&case, &*ramp, "jittered+torus-shift", &counts, |n| {
        shifted_ramp_variance((n as f64).sqrt().round() as u64, 2)
    })?;
    lab.push(row.noting("derived: strata at a face are cut by it, N^(-3/2)/6 at first order"));
    let large = powers(4, 3..=6);
    for (sampler, expected) in [("jittered+torus-shift", 1.5), ("grid+torus-shift", 1.0)] {
        let f = integrand("multilinear", 2, &[])?;
        let case = format!("{sampler}, multilinear");
        let row = lab.exponent(&case, &*f, sampler, &large, expected)?;
        lab.push(
            row.allowing(0.05, "the next order falls as N^-2 beside it; 1.47 to 1.50 was seen"),
        );
    }
    let gaussian = integrand("gaussian", 2, &[])?;
    for sampler in ["grid+torus-shift", "hammersley+torus-shift", "rank1+torus-shift"] {
        let [rows] = lab.studies([&*gaussian], sampler, &[16])?;
        let row = &rows[0];
        let exact = gaussian.reference().map_or(f64::NAN, |r| r.mean);
        // Trials are as many as the budget pays for; their spread gives the error of the mean.
        let trials = lab.trials(&[16]);
        let error = (row.variance_of_mean / f64::from(trials)).sqrt();
        let finding = Finding::new(format!("{sampler}, gaussian, N = 16"), "bias", 0.0);
        lab.push(finding.measured(row.grand_mean - exact, error));
    }
    Ok(())
}

/// Mean power of a set's spectrum at an integer frequency, (1/N) E|Σ exp(2πi ν·x)|², from the
/// variances of the means of a cosine and a sine at the same points.
fn power(
    lab: &mut Lab<'_>,
    sampler: &str,
    n: u64,
    frequency: [f64; 2],
) -> Result<[f64; 2], LiteratureError> {
    let cosine = Wave { frequency, phase: 0.0 };
    let sine = Wave { frequency, phase: 0.25 };
    let [a, b] = lab.studies([&cosine, &sine], sampler, &[n])?;
    let scaled = |row: &crate::study::Row| {
        let power = n as f64 * row.variance_of_mean;
        [power, power * power * row.var_ln()]
    };
    let ([p, v], [q, w]) = (scaled(&a[0]), scaled(&b[0]));
    Ok([p + q, (v + w).sqrt()])
}

fn spectra(lab: &mut Lab<'_>) -> Outcome {
    let k = 32u64;
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    let law = |[a, b]: [f64; 2]| 1.0 - (sinc(a / k as f64) * sinc(b / k as f64)).powi(2);
    let mut checks = Vec::new();
    for frequency in
        [[1.0, 0.0], [1.0, 1.0], [2.0, 0.0], [3.0, 1.0], [4.0, 0.0], [6.0, 5.0], [16.0, 7.0]]
    {
        let [p, error] = power(lab, "jittered", k * k, frequency)?;
        let exact = law(frequency);
        let at = format!("ν = ({}, {})", frequency[0], frequency[1]);
        checks.push(Check { at, ratio: p / exact, std_error: error / exact });
    }
    let finding = Finding::new("jittered, N = 1024", "power / exact, mean over ν", 1.0);
    let note = "exactly 1 - sinc²(ν₁/k) sinc²(ν₂/k), which begins as π²|ν|²/(3N): b = 2";
    lab.push(with_checks(finding, checks).noting(note));
    let axis: Vec<u64> = vec![1, 2, 4];
    let b = exact_exponent(&axis, |nu| law([nu as f64, 0.0])).unwrap_or(f64::NAN);
    let finding = Finding::new("jittered: slope of that law over ν = 1 to 4", "b", 2.0);
    lab.push(finding.measured(-b, 0.0).allowing(0.02, "no sampling: the law's own next order"));
    let mut checks = Vec::new();
    for frequency in [[1.0, 0.0], [4.0, 0.0], [6.0, 5.0]] {
        let [p, error] = power(lab, "random", k * k, frequency)?;
        let at = format!("ν = ({}, {})", frequency[0], frequency[1]);
        checks.push(Check { at, ratio: p, std_error: error });
    }
    lab.push(with_checks(Finding::new("random, N = 1024", "power, mean over ν", 1.0), checks));
    for (dim, ks) in [(1, &[8u64, 16, 32, 64][..]), (2, &[4, 8, 16, 32]), (3, &[3, 5, 8, 12])] {
        let d = f64::from(dim);
        let counts = cells(ks, dim as usize);
        let f = integrand("ramp", dim as usize, &[])?;
        let case = format!("jittered, d = {dim}: best case, a ramp");
        let row = lab.exponent(&case, &*f, "jittered", &counts, 1.0 + 2.0 / d)?;
        lab.push(row);
    }
    lab.push(Finding::not_measured(
        "worst case 1 + 1/d; ideal step spectrum",
        "worst cases are the edges of M3 and M7; the step spectrum has no sampler on the shelf",
    ));
    Ok(())
}

fn worst_and_best(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=5);
    let gaussian = integrand("gaussian", 2, &[])?;
    let disk = integrand("disk", 2, &[])?;
    for (sampler, expected) in [("random", [1.0, 1.0]), ("jittered", [1.5, 2.0])] {
        for (case, f, p) in [("disk", &disk, expected[0]), ("gaussian", &gaussian, expected[1])] {
            let row = lab.exponent(&format!("{sampler}, {case}"), &**f, sampler, &counts, p)?;
            let law = |n| f.exact_variance(sampler, n).unwrap_or(f64::NAN);
            let exact = exact_exponent(&counts, law).unwrap_or(f64::NAN);
            lab.push(allowing_exact(row, exact));
        }
    }
    let counts = powers(4, 3..=5);
    for sampler in ["poisson+torus-shift", "best-candidate+torus-shift"] {
        for (case, f) in [("disk", &disk), ("gaussian", &gaussian)] {
            let case = format!("{sampler}, {case}");
            let row = lab.exponent(&case, &**f, sampler, &counts, 1.0)?;
            let why = "tends to 1: at these N the low plateau of the spectrum is not reached; 1.13 \
                       to 1.27 was seen up to N = 256";
            lab.push(row.noting(why).recalled());
        }
    }
    lab.push(Finding::not_measured("CCVT", "not on the shelf; file:PATH reads such sets"));
    Ok(())
}

fn anisotropic(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    let ramp = integrand("ramp", 2, &[])?;
    let edge = 0.3;
    let step = integrand("step", 2, &[("edge", edge)])?;
    for sampler in ["lhs", "cmj"] {
        let case = format!("{sampler}, ramp, {}: |a|²/12 N^-3", range(&counts));
        let row = lab.exact(&case, &*ramp, sampler, &counts, |n| {
            stratified_variance(1.0, n as f64, n as f64)
        })?;
        lab.push(row);
        let case = format!("{sampler}, step, {}: q(1-q) N^-2", range(&counts));
        let row = lab.exact(&case, &*step, sampler, &counts, |n| step_variance(edge, n, 1))?;
        lab.push(row);
    }
    let f = Interaction(2);
    for sampler in ["lhs", "cmj"] {
        let case = format!("{sampler}, (x - 1/2)(y - 1/2), {}", range(&counts));
        let row = lab.exact(&case, &f, sampler, &counts, |n| {
            interaction_variance(sampler, n).unwrap_or(f64::NAN)
        })?;
        lab.push(match sampler {
            "cmj" => row.noting(
                "derived: N^(-3/2)/72, not N^-2. Correlated offsets move whole rows of cells as \
                 one; the claim's 2 is of offsets drawn for each column",
            ),
            _ => row.noting("derived: 1/(144 N) at first order, the rate of random"),
        });
    }
    let choice = SamplerChoice { sampler: &MultiJittered, scramble: Scramble::None };
    let rows = lab.study(&f, choice, &counts)?.rows;
    let checks = ratios(&rows, |n| interaction_variance("multi-jittered", n).unwrap_or(f64::NAN));
    let case = format!(
        "multi-jittered, offsets drawn for each column, (x - 1/2)(y - 1/2), {}",
        range(&counts)
    );
    let finding = Finding::new(case, "variance / exact, mean over N", 1.0);
    let note = "derived: N^-2/72 at first order; made for this row, not on the shelf";
    lab.push(with_checks(finding, checks).noting(note));
    let gaussian = integrand("gaussian", 2, &[])?;
    let result = lab.study(&*gaussian, choice, &counts)?;
    let row = exponent_of("multi-jittered, gaussian", &result, 2.0);
    lab.push(row.allowing(0.15, "its additive part falls as N^-3 beside; 2.07 to 2.13 was seen"));
    let row = lab.exponent("lhs, gaussian", &*gaussian, "lhs", &counts, 1.0)?;
    lab.push(row.allowing(0.05, "its additive part falls as N^-3 beside the interaction"));
    let multilinear = integrand("multilinear", 2, &[])?;
    let row = lab.exponent("cmj, multilinear", &*multilinear, "cmj", &counts, 1.5)?;
    lab.push(row.allowing(0.05, "theory's N^(-3/2) for correlated offsets, with N^-3 beside it"));
    let averages =
        lab.placed(&|stream| Line::placed(30f64.to_radians(), stream.pair(0)[0]), "cmj", &counts)?;
    let row = exponent_of_averages("cmj, lines at 30°, every offset", &averages, 1.5);
    lab.push(row.allowing(0.05, "strata of the axes help most at small N"));
    Ok(())
}

fn padded(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    for (case, params, seen) in [
        ("padded+owen, form factor", &[][..], 1.04),
        ("padded+owen, form factor with occluder", &[("occluder", 0.5)], 0.99),
    ] {
        let f = integrand("form-factor", 4, params)?;
        let row = lab.exponent(case, &*f, "padded+owen", &counts, 1.0)?;
        let why = format!("parts in one pair of coordinates fall faster beside; {seen} was seen");
        lab.push(row.allowing(0.06, why));
    }
    Ok(())
}

fn orthogonal(lab: &mut Lab<'_>) -> Outcome {
    let counts = cells(&[5, 7, 11, 17, 29, 47], 2);
    let smooth = PairSum { dim: 4, pair: |x, y| (x - 0.45) * (y - 0.55) };
    let row = lab.exponent("oa, smooth pairs, d = 4", &smooth, "oa", &counts, 1.5)?;
    let why = "the rate of cmj in the plane, whose shared offsets this array has (see A1): 3/2; \
               2 would need offsets of their own";
    lab.push(row.allowing(0.05, why));
    let f = Interaction(2);
    let case = format!("oa, (x - 1/2)(y - 1/2), d = 2, {}", range(&counts));
    let row =
        lab.exact(&case, &f, "oa", &counts, |n| interaction_variance("oa", n).unwrap_or(f64::NAN))?;
    lab.push(row.noting("in the plane the array is cmj with its strata in random order"));
    let edges = PairSum { dim: 4, pair: |x, y| f64::from(u8::from(0.5 * x + 0.87 * y < 0.71)) };
    let row = lab.exponent("oa, edges across pairs, d = 4", &edges, "oa", &counts, 1.5)?;
    lab.push(row.allowing(0.1, "fixed edges wander about the law; strata of the axes help"));
    let row = lab.exponent("oa, interaction of three", &Interaction(3), "oa", &counts, 1.0)?;
    lab.push(row.allowing(0.1, "at few points an array is not yet independent across three axes"));
    Ok(())
}

fn shifted_sequences(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(2, 4..=12);
    let smooth = [1.7, 2.2];
    let edge = [1.4, 1.9];
    for (sampler, name, [low, high]) in [
        ("halton+torus-shift", "ramp", smooth),
        ("halton+torus-shift", "gaussian", smooth),
        ("halton+torus-shift", "disk", edge),
        ("rd+torus-shift", "ramp", smooth),
        ("rd+torus-shift", "disk", edge),
    ] {
        let f = integrand(name, 2, &[])?;
        let case = format!("{sampler}, {name}");
        let row = lab.exponent(&case, &*f, sampler, &counts, f64::midpoint(low, high))?;
        let why = format!("no theorem: {low} to {high} is what was seen");
        lab.push(row.allowing(0.5 * (high - low), why));
    }
    let gaussian = integrand("gaussian", 2, &[])?;
    let row =
        lab.exponent("rd+torus-shift, gaussian", &*gaussian, "rd+torus-shift", &counts, 1.95)?;
    lab.push(Finding { expected: None, recalled: true, ..row }.noting(
        "no law: it is nearly periodic, and a lattice then errs in bursts; p = 2.3 up to N = 4096, \
         1.1 from there to 65,536",
    ));
    Ok(())
}

fn shifted_grid(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    let ramp = integrand("ramp", 2, &[])?;
    let case = format!("grid+torus-shift, ramp, {}: |a|²/12 N^-1", range(&counts));
    let row = lab.exact(&case, &*ramp, "grid+torus-shift", &counts, |n| 1.0 / (12.0 * n as f64))?;
    lab.push(row.noting("exactly that of random points: the shift moves all of a row at once"));
    let radii = [0.25, 0.35];
    let circle = |stream: Stream| {
        let [u, _] = stream.pair(0);
        Circle { centre: [0.5, 0.5], radius: radii[0] + (radii[1] - radii[0]) * u }
    };
    let averages = lab.placed(&circle, "grid+torus-shift", &powers(4, 3..=6))?;
    let row =
        exponent_of_averages("grid+torus-shift, circles of radius 0.25 to 0.35", &averages, 1.5);
    let why = "averaged over the radius, about which the variance oscillates; 1.62 was seen for \
               one radius";
    lab.push(row.allowing(0.02, why));
    let length = PI * (radii[0] + radii[1]);
    if let Some(last) = averages.last() {
        let law = length * (last.n as f64).powf(-1.5);
        let case = format!("circles of radius 0.25 to 0.35, N = {}", last.n);
        let finding = Finding::new(case, "c of Kendall's law", lattice_edge_constant());
        let why = "what the oscillation leaves over a range of 6 cells";
        lab.push(finding.measured(last.mean / law, last.std_error / law).allowing(0.002, why));
    }
    Ok(())
}
