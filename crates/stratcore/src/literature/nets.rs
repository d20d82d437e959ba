//! Scrambled nets: Owen's results, their cheaper relatives, and screen-space sampling.

use super::constants::range;
use super::finding::{Check, Curve, Figure, Finding, Relation};
use super::lab::{
    Lab, exact_exponent, exponent_of, exponent_row, integrand, powers, ratios, with_checks,
};
use super::noise::var_ln_of_normal;
use super::samplers::SobolFromSecond;
use super::shapes::Interaction;
use super::{Claim, LiteratureError, Standing, screen};
use crate::fit::power_law;
use crate::integrand::Integrand;
use crate::sampler::Scramble;
use crate::study::{Row, SamplerChoice};
use crate::theory::{interaction_variance, step_variance, stratified_variance};

type Outcome = Result<(), LiteratureError>;

pub(super) const CLAIMS: &[Claim] = &[
    Claim {
        id: "C1",
        statement: "p = 3/2 on edges for jittered families and nets, 1 for random and \
                    best-candidate; 2 on a step along an axis; Owen-scrambled nets and pmj02 \
                    p = 3 on smooth f at powers of two",
        source: "Christensen et al. 2018, figures",
        standing: Standing::Measured,
        measure: progressive,
    },
    Claim {
        id: "B1",
        statement: "hashed Owen scrambling is as good as Owen's; far below random where f is \
                    favourable, as random where it is not",
        source: "Burley 2020, Figure 1",
        standing: Standing::Abstract,
        measure: hashed,
    },
    Claim {
        id: "O1",
        statement: "scrambled nets: o(1/N) for any f; N^-3 (log N)^(d-1) for smooth f",
        source: "Owen 1997",
        standing: Standing::Sure,
        measure: smooth,
    },
    Claim {
        id: "O2",
        statement: "without the first Sobol' point the error of smooth f is √N larger: p = 2",
        source: "Owen 2020, abstract",
        standing: Standing::Abstract,
        measure: dropped_point,
    },
    Claim {
        id: "O3",
        statement: "local antithetic sampling p = 3 + 2/d; higher-order scrambling 2α + 1",
        source: "Owen 2008; Dick 2011",
        standing: Standing::Recalled,
        measure: beyond,
    },
    Claim {
        id: "O4",
        statement: "LMS + shift has the mean variance of Owen's scrambling, but its variances \
                    scatter far more from one repeat to the next",
        source: "Matoušek 1998; Goda & Suzuki 2025, abstract",
        standing: Standing::Measured,
        measure: heavy_tails,
    },
    Claim {
        id: "O5",
        statement: "scrambled nets on discontinuous f: p = 3/2 in the plane",
        source: "He & Wang 2015",
        standing: Standing::Measured,
        measure: discontinuous,
    },
    Claim {
        id: "H1",
        statement: "stochastic generation of (t,s)-sequences is Owen scrambling in distribution",
        source: "Helmer et al. 2021",
        standing: Standing::Recalled,
        measure: stochastic,
    },
    Claim {
        id: "X2",
        statement: "an XOR shift alone: p = 2 for smooth f, not 3",
        source: "seen in earlier measurements; L'Ecuyer & Lemieux 2002",
        standing: Standing::Measured,
        measure: digital_shift,
    },
    Claim {
        id: "Z1",
        statement: "screen-space Sobol': each pixel has the variance of Owen-scrambled Sobol', \
                    the error image little power at low frequency",
        source: "Heitz et al. 2019, abstract; Ahmed & Wonka 2020",
        standing: Standing::Abstract,
        measure: screen::screen_space,
    },
    Claim {
        id: "Z2",
        statement: "shifted rank-1 lattices are on a par with Owen-scrambled Sobol' on integrands \
                    of rendering",
        source: "Belcour & Heitz 2021, abstract",
        standing: Standing::Abstract,
        measure: screen::lattices,
    },
];

fn progressive(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    let disk = integrand("disk", 2, &[])?;
    let line = integrand("half-space", 2, &[])?;
    for sampler in ["jittered", "sobol+owen", "halton+owen", "pmj02"] {
        for (name, f) in [("disk", &disk), ("line at 60°", &line)] {
            let row = lab.exponent(&format!("{sampler}, {name}"), &**f, sampler, &counts, 1.5)?;
            lab.push(row.allowing(0.1, "one fixed edge wanders about the law"));
        }
    }
    let edge = std::f64::consts::FRAC_1_PI;
    let step = integrand("step", 2, &[("edge", edge)])?;
    for sampler in ["sobol+owen", "pmj02", "cmj"] {
        let case = format!("{sampler}, step at 1/π, {}: q(1-q) N^-2", range(&counts));
        let row = lab.exact(&case, &*step, sampler, &counts, |n| step_variance(edge, n, 1))?;
        lab.push(row);
    }
    let gaussian = integrand("gaussian", 2, &[])?;
    let counts = powers(2, 6..=12);
    for (name, f) in [("gaussian", gaussian), ("multilinear", integrand("multilinear", 2, &[])?)] {
        let row = lab.exponent(&format!("pmj02, {name}"), &*f, "pmj02", &counts, 3.0)?;
        lab.push(allowing_logarithm(row, &counts));
    }
    Ok(())
}

/// With room for the factor log N: as much as the exact law of an interaction shows at these
/// N, and a little for other derivatives.
fn allowing_logarithm(row: Finding, counts: &[u64]) -> Finding {
    const CURVATURE: f64 = 0.03;
    let law = |n| interaction_variance("sobol", n).unwrap_or(f64::NAN);
    let exact = exact_exponent(counts, law).unwrap_or(f64::NAN);
    let why = format!(
        "the factor log N: (x - 1/2)(y - 1/2) fits to {exact:.3} here, exactly; {CURVATURE} beyond \
         that for another f"
    );
    row.allowing(3.0 - exact + CURVATURE, why)
}

/// Ratios of two samplers' variances at each N.
pub(super) fn against(
    lab: &mut Lab<'_>,
    f: &dyn Integrand,
    [a, b]: [&str; 2],
    counts: &[u64],
) -> Result<Vec<Check>, LiteratureError> {
    let [rows] = lab.studies([f], a, counts)?;
    let [others] = lab.studies([f], b, counts)?;
    let check = |(row, other): (&Row, &Row)| {
        let ratio = row.variance_of_mean / other.variance_of_mean;
        let std_error = ratio * (row.var_ln() + other.var_ln()).sqrt();
        Check { at: format!("N = {}", row.n_used), ratio, std_error }
    };
    Ok(rows.iter().zip(&others).map(check).collect())
}

fn hashed(lab: &mut Lab<'_>) -> Outcome {
    let counts = [4, 16, 64, 256];
    for name in ["gaussian", "half-space", "disk"] {
        let f = integrand(name, 2, &[])?;
        let checks = against(lab, &*f, ["sobol+owen-hash", "sobol+owen"], &counts)?;
        let case = format!("{name}, {}", range(&counts));
        lab.push(with_checks(Finding::new(case, "variance / that of Owen's", 1.0), checks));
    }
    let f = integrand("checkerboard", 2, &[("frequency", 64.0)])?;
    let case = "unfavourable: 64 × 64 checkerboard, N = 16 and 64";
    let row = lab.exact(case, &*f, "sobol+owen-hash", &[16, 64], |n| 0.25 / n as f64)?;
    lab.push(Finding { quantity: "variance / that of random", ..row });
    let f = integrand("gaussian", 2, &[])?;
    let variance = f.exact_variance("random", 1).unwrap_or(f64::NAN);
    let [rows] = lab.studies([&*f], "sobol+owen-hash", &[64])?;
    let finding = Finding::new("favourable: gaussian, N = 64", "variance / that of random", 0.05)
        .being(Relation::AtMost);
    let checks = ratios(&rows, |_| 0.05 * variance / 64.0);
    lab.push(with_checks(finding, checks).noting("\"far below\" is taken as a twentieth"));
    Ok(())
}

fn smooth(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(2, 4..=12);
    let ramp = integrand("ramp", 2, &[])?;
    let case = format!("sobol+owen, ramp, {}: |a|²/12 N^-3", range(&counts));
    let row = lab.exact(&case, &*ramp, "sobol+owen", &counts, |n| {
        stratified_variance(1.0, n as f64, n as f64)
    })?;
    lab.push(row);
    let case = format!("sobol+owen, (x - 1/2)(y - 1/2), {}", range(&counts));
    let row = lab.exact(&case, &Interaction(2), "sobol+owen", &counts, |n| {
        interaction_variance("sobol", n).unwrap_or(f64::NAN)
    })?;
    lab.push(row.noting("N^-3 (28 log₂N/3 + 16/9)/256: the factor log N, exactly"));
    let large = powers(2, 6..=12);
    for name in ["gaussian", "cosines", "multilinear"] {
        let f = integrand(name, 2, &[])?;
        let row = lab.exponent(&format!("sobol+owen, {name}"), &*f, "sobol+owen", &large, 3.0)?;
        lab.push(allowing_logarithm(row, &large));
    }
    let f = integrand("form-factor", 4, &[])?;
    let row = lab.exponent("sobol+owen, form factor, d = 4", &*f, "sobol+owen", &counts, 3.0)?;
    lab.push(row.noting("far from its limit (log N)³: 2.49 was seen").recalled());
    // Any f at all: o(1/N) on a function of jumps.
    let f = integrand("koch", 2, &[])?;
    let variance = f.exact_variance("random", 1).unwrap_or(f64::NAN);
    let [rows] = lab.studies([&*f], "sobol+owen", &[4096])?;
    let finding = Finding::new("sobol+owen, koch, N = 4096", "variance / (σ²/N)", 0.2)
        .being(Relation::AtMost);
    let checks = ratios(&rows, |n| 0.2 * variance / n as f64);
    lab.push(with_checks(finding, checks).noting("o(1/N) is taken as a fifth at this N"));
    Ok(())
}

fn dropped_point(lab: &mut Lab<'_>) -> Outcome {
    // Below, the net's own N^-3 is still seen beside the penalty.
    let counts = powers(2, 8..=12);
    let choice = SamplerChoice { sampler: &SobolFromSecond, scramble: Scramble::Owen };
    for name in ["ramp", "gaussian", "multilinear"] {
        let f = integrand(name, 2, &[])?;
        let result = lab.study(&*f, choice, &counts)?;
        let row = exponent_of(&format!("points 1 to N, {name}"), &result, 2.0);
        lab.push(row.allowing(0.1, "the net's own N^-3 beside; 2.01 to 2.03 was seen"));
        let [whole] = lab.studies([&*f], "sobol+owen", &counts)?;
        let penalties = result.rows.iter().zip(&whole).map(|(without, with)| {
            let ratio = without.variance_of_mean / with.variance_of_mean;
            (with.n_used, ratio, without.var_ln() + with.var_ln())
        });
        let fit = power_law(penalties);
        let row = exponent_row(&format!("{name}: variance / with the point"), fit.as_ref(), -1.0);
        let why =
            "the factor log N of the whole net, 0.13 here, and what is left of its N^-3 without";
        lab.push(Finding { quantity: "p of the ratio", ..row }.allowing(0.2, why));
    }
    Ok(())
}

fn beyond(lab: &mut Lab<'_>) -> Outcome {
    lab.push(Finding::not_measured(
        "local antithetic sampling, higher-order scrambling",
        "neither is on the shelf; file:PATH reads sets made elsewhere",
    ));
    Ok(())
}

fn heavy_tails(lab: &mut Lab<'_>) -> Outcome {
    const TRIALS: u32 = 50;
    let gaussian = || integrand("gaussian", 2, &[]);
    let f = gaussian()?;
    let repeats = lab.either(60, 600u32);
    let n = 4096;
    let mut curves = Vec::new();
    let mut spreads = Vec::new();
    for sampler in ["sobol+owen", "sobol+lms-shift"] {
        let shared = |_| &*f;
        let mut variances = lab.replicates(&shared, sampler, &[n], TRIALS, repeats)?.remove(0);
        variances.sort_by(f64::total_cmp);
        let count = variances.len() as f64;
        let logs: Vec<f64> = variances.iter().map(|v| v.ln()).collect();
        let mean = logs.iter().sum::<f64>() / count;
        let fourth: f64 = logs.iter().map(|l| (l - mean).powi(4)).sum::<f64>() / count;
        let square: f64 = logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let deviation = square.sqrt();
        // Standard error of a standard deviation, whatever the distribution.
        let error = ((fourth - square * square).max(0.0) / count).sqrt() / (2.0 * deviation);
        let whole = variances.iter().sum::<f64>() / count;
        let ratio = variances[variances.len() - 1] / variances[0];
        spreads.push((deviation, error, ratio));
        let points = variances.iter().enumerate().map(|(i, v)| {
            let v = v / whole;
            [(i as f64 + 0.5) / count, v, v, v]
        });
        curves.push(Curve { name: sampler.to_owned(), points: points.collect() });
    }
    let normal = var_ln_of_normal(TRIALS).sqrt();
    let words = |ratio: f64| format!("largest over smallest of {repeats} repeats: {ratio:.1}");
    let [(owen, owen_error, owen_ratio), (lms, lms_error, lms_ratio)] = [spreads[0], spreads[1]];
    let case = format!("sobol+owen, gaussian, N = {n}, M = 50");
    let why = format!(
        "√ψ'((M-1)/2) for normal trial means, which these nearly are; {}",
        words(owen_ratio)
    );
    lab.push(
        Finding::new(case, "sd of ln s²", normal).measured(owen, owen_error).allowing(0.05, why),
    );
    let case = format!("sobol+lms-shift, gaussian, N = {n}, M = 50");
    let finding = Finding::new(case, "sd of ln s²", 2.0 * normal).being(Relation::AtLeast);
    let note = format!("at least twice what normal trials have; {}", words(lms_ratio));
    lab.push(finding.measured(lms, lms_error).noting(note));
    let counts = [8, 32];
    let checks = against(lab, &*f, ["sobol+lms-shift", "sobol+owen"], &counts)?;
    let finding = Finding::new("gaussian, N = 8 and 32", "mean variance / that of Owen's", 1.0);
    lab.push(with_checks(finding, checks).noting("at small N, where the tails can be averaged"));
    lab.draw(Figure {
        name: "heavy-tails",
        title: "Spread of measured variances: LMS + shift against Owen's scrambling",
        caption: format!(
            "O4. {repeats} measurements of one variance, each from M = 50 trials at N = {n} of a \
             smooth integrand, in order, over their mean. Under Owen's scrambling they scatter as \
             chi-square says; under LMS + shift most are too small and a few far too large, so \
             an interval from one of them is wrong."
        ),
        axes: ["share of the repeats", "variance over the mean of all"],
        log_x: false,
        curves,
        slopes: Vec::new(),
    });
    Ok(())
}

fn discontinuous(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(2, 4..=12);
    for name in ["half-space", "disk"] {
        let f = integrand(name, 2, &[])?;
        let row = lab.exponent(&format!("sobol+owen, {name}"), &*f, "sobol+owen", &counts, 1.5)?;
        lab.push(row.allowing(0.07, "one fixed edge wanders about the law; 1.47 to 1.51 was seen"));
    }
    let f = integrand("form-factor", 4, &[("occluder", 0.5)])?;
    let counts = powers(2, 4..=12);
    let case = "sobol+owen, form factor with occluder, d = 4";
    let row = lab.exponent(case, &*f, "sobol+owen", &counts, 1.25)?;
    let note = "the paper's bound 1 + 1/d for indicators is quoted from memory; 1.33 was seen";
    lab.push(row.being(Relation::AtLeast).noting(note).recalled());
    Ok(())
}

fn stochastic(lab: &mut Lab<'_>) -> Outcome {
    let counts = [4, 16, 64, 256];
    for name in ["gaussian", "half-space", "disk"] {
        let f = integrand(name, 2, &[])?;
        let checks = against(lab, &*f, ["pmj02", "sobol+owen"], &counts)?;
        let case = format!("pmj02 against sobol+owen, {name}, {}", range(&counts));
        let note =
            "two scrambled (0,m,2)-nets have one variance at N = 2^m, whatever their matrices";
        lab.push(with_checks(Finding::new(case, "ratio of variances", 1.0), checks).noting(note));
    }
    Ok(())
}

fn digital_shift(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(2, 4..=12);
    let ramp = integrand("ramp", 2, &[])?;
    let case = format!("sobol+xor-shift, ramp, {}: |a|²/12 N^-2", range(&counts));
    let row =
        lab.exact(&case, &*ramp, "sobol+xor-shift", &counts, |n| 1.0 / (12.0 * (n * n) as f64))?;
    lab.push(row.noting("one shift within a stratum for all N points: as a shifted grid in 1-D"));
    let multilinear = integrand("multilinear", 2, &[])?;
    let case = "sobol+xor-shift, multilinear";
    let row = lab.exponent(case, &*multilinear, "sobol+xor-shift", &counts, 2.0)?;
    lab.push(row.allowing(0.05, "finite N; 1.98 to 1.99 was seen"));
    let gaussian = integrand("gaussian", 2, &[])?;
    let large = powers(2, 12..=16);
    let case = "sobol+xor-shift, gaussian";
    let row = lab.exponent(case, &*gaussian, "sobol+xor-shift", &large, 2.0)?;
    let why = "it is nearly periodic, its step across the faces small: 3.2 up to N = 4096, and 2 \
               only from there on";
    lab.push(row.allowing(0.1, why));
    Ok(())
}
