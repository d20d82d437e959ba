//! K8 to K10: what a variance never exceeds, and the integrands that reach it.

use super::LiteratureError;
use super::constants::{range, words};
use super::finding::{Finding, Relation};
use super::lab::{Lab, integrand, powers, ratios, with_checks};
use crate::study::SamplerChoice;
use std::cmp::Ordering;

type Outcome = Result<(), LiteratureError>;

pub(super) fn gain(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(2, 1..=12);
    for (name, params) in [
        ("gaussian", &[][..]),
        ("half-space", &[]),
        ("disk", &[]),
        ("koch", &[]),
        ("checkerboard", &[("frequency", 11.3)]),
        ("cosines", &[("frequency", 5.3)]),
    ] {
        let f = integrand(name, 2, params)?;
        let bound = 2.0 * f.exact_variance("random", 1).unwrap_or(f64::NAN);
        let choice = SamplerChoice::named("sobol+owen")?;
        let rows = lab.study(&*f, choice, &counts)?.rows;
        let case = format!("sobol+owen, {name}, N = 2 to 4096: the largest");
        let finding = Finding::new(case, "gain N·variance/σ²", 2.0).being(Relation::AtMost);
        lab.push(with_checks(finding, ratios(&rows, |n| bound / n as f64)));
    }
    // A checkerboard of 2^j × 2^j checks is one Walsh function: it has a single gain, which is
    // 1 while a net is too coarse to see it, 2 at N = 2^(2j-1), and 0 from there on.
    for j in [1, 2, 3] {
        let f = integrand("checkerboard", 2, &[("frequency", f64::from(1 << j))])?;
        let counts = powers(2, 0..=2 * j + 1);
        let case = format!("sobol+owen, one Walsh function (2^{j} checks), {}", range(&counts));
        let law = |n: u64| {
            let gain = match n.cmp(&(1 << (2 * j - 1))) {
                Ordering::Less => 1.0,
                Ordering::Equal => 2.0,
                Ordering::Greater => 0.0,
            };
            0.25 * gain / n as f64
        };
        let row = lab.exact(&case, &*f, "sobol+owen", &counts, law)?;
        let why = "gains 1, 2 at N = 2^(2j-1), then 0: the bound is reached";
        lab.push(row.noting(why));
    }
    Ok(())
}

pub(super) fn latin_bound(lab: &mut Lab<'_>) -> Outcome {
    let counts = [2, 3, 4, 8, 16, 64, 256];
    for (name, dim, params) in [
        ("gaussian", 2, &[][..]),
        ("half-space", 2, &[]),
        ("checkerboard", 2, &[("frequency", 2.0)]),
        ("checkerboard", 2, &[("frequency", 64.0)]),
        ("form-factor", 4, &[("occluder", 0.5)]),
    ] {
        let f = integrand(name, dim, params)?;
        let variance = f.exact_variance("random", 1).unwrap_or(f64::NAN);
        let choice = SamplerChoice::named("lhs")?;
        let rows = lab.study(&*f, choice, &counts)?.rows;
        let case = format!("{name}{}, {}: the largest", words(params), range(&counts));
        let finding = Finding::new(case, "(N-1)·variance/σ²", 1.0).being(Relation::AtMost);
        let row = with_checks(finding, ratios(&rows, |n| variance / (n as f64 - 1.0)));
        lab.push(
            row.noting("the bound is elementary: it is tested although the paper is recalled"),
        );
    }
    Ok(())
}

pub(super) fn checkerboard(lab: &mut Lab<'_>) -> Outcome {
    let f = integrand("checkerboard", 2, &[("frequency", 64.0)])?;
    let counts = [1, 4, 16, 64];
    let row =
        lab.exact("sobol+xor-shift, N = 1 to 64", &*f, "sobol+xor-shift", &counts, |_| 0.25)?;
    lab.push(row.noting("variance 1/4 at each N: N times that of random"));
    let nested = [16, 64];
    let row =
        lab.exact("sobol+owen, N = 16 and 64", &*f, "sobol+owen", &nested, |n| 0.25 / n as f64)?;
    lab.push(row.noting("0.95 to 0.98 was seen; the gain of this Walsh function is exactly 1"));
    // All of N = 2^12: one point in each check.
    let row = lab.exact("sobol+xor-shift, N = 4096", &*f, "sobol+xor-shift", &[4096], |_| 0.0)?;
    lab.push(row.noting("one point in each check: exactly no variance"));
    Ok(())
}
