//! M1 to M9 and F1: what Mitchell's paper says, on integrands with known answers.

use super::constants::{range, words};
use super::finding::{Curve, Figure, Finding, Relation, Slope};
use super::lab::{
    Lab, allowing_exact, cells, exact_exponent, exponent_of, exponent_of_averages, exponent_row,
    integrand, powers, ratios, with_checks,
};
use super::shapes::Line;
use super::{Claim, LiteratureError, Standing};
use crate::fit::power_law;
use crate::integrand::Integrand;
use crate::study::SamplerChoice;

type Outcome = Result<(), LiteratureError>;

pub(super) const CLAIMS: &[Claim] = &[
    Claim {
        id: "M1",
        statement: "random: p = 1 for any pixel",
        source: "Mitchell 1996, Figure 2",
        standing: Standing::Sure,
        measure: random,
    },
    Claim {
        id: "M2",
        statement: "jittered, smooth in the plane: p = 2",
        source: "Mitchell 1996, Figure 5 (a pixel of 1.89)",
        standing: Standing::Sure,
        measure: smooth,
    },
    Claim {
        id: "M3",
        statement: "jittered, edges in the plane: p = 3/2",
        source: "Mitchell 1996, Figure 5 (a pixel of 1.45)",
        standing: Standing::Sure,
        measure: edges,
    },
    Claim {
        id: "M4",
        statement: "jittered, detail finer than the strata: p = 1",
        source: "Mitchell 1996, Figure 5 (a pixel of 1.12)",
        standing: Standing::Sure,
        measure: complex,
    },
    Claim {
        id: "M5",
        statement: "form factor of unit squares two apart, d = 4: p = 3/2",
        source: "Mitchell 1996 (1.430; 1.501 without N = 1)",
        standing: Standing::Sure,
        measure: form_factor,
    },
    Claim {
        id: "M6",
        statement: "the same with an occluder, k = 3: p = 5/4",
        source: "Mitchell 1996 (1.233; 1.245 without N = 1)",
        standing: Standing::Sure,
        measure: occluded,
    },
    Claim {
        id: "M7",
        statement: "jittered: p = 1 + 2/d for smooth f, 2 - k/d across a discontinuity of \
                    dimension k, fractal or not",
        source: "Mitchell 1996, Theoretical analysis",
        standing: Standing::Sure,
        measure: general,
    },
    Claim {
        id: "M8",
        statement: "jittered is never worse than random, at any N",
        source: "Mitchell 1996, Conclusions",
        standing: Standing::Sure,
        measure: never_worse,
    },
    Claim {
        id: "M9",
        statement: "arbitrary-edge discrepancy: N^(-3/4) for jittered, up to √log N, N^(-1/2) for \
                    random; optimised patterns about half of jittered",
        source: "Beck & Chen 1987, Dobkin et al. 1994, Cross 1995, by way of Mitchell 1996",
        standing: Standing::Sure,
        measure: discrepancy,
    },
    Claim {
        id: "F1",
        statement: "edges: the error falls as N^(-3/4), not as 1/N",
        source: "Mitchell 1996, against a reading of it in Shirley's blog",
        standing: Standing::Abstract,
        measure: folklore,
    },
];

/// A row on an exponent, held against theory with the allowance that exact variances give,
/// and against those variances at each N.
fn against_exact(
    lab: &mut Lab<'_>,
    case: &str,
    f: &dyn Integrand,
    sampler: &str,
    counts: &[u64],
    expected: f64,
) -> Result<Finding, LiteratureError> {
    let result = lab.study(f, SamplerChoice::named(sampler)?, counts)?;
    let finding = exponent_of(case, &result, expected);
    let law = |n| f.exact_variance(sampler, n).unwrap_or(f64::NAN);
    let Some(exact) = exact_exponent(counts, law).filter(|p| p.is_finite()) else {
        return Ok(finding);
    };
    Ok(allowing_exact(Finding { checks: ratios(&result.rows, law), ..finding }, exact))
}

fn random(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    for name in ["ramp", "gaussian", "half-space", "disk", "checkerboard", "koch"] {
        let f = integrand(name, 2, &[])?;
        let row = against_exact(lab, name, &*f, "random", &counts, 1.0)?;
        lab.push(row);
    }
    Ok(())
}

fn smooth(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    for name in ["ramp", "gaussian", "cosines", "multilinear"] {
        let f = integrand(name, 2, &[])?;
        let row = against_exact(lab, name, &*f, "jittered", &counts, 2.0)?;
        lab.push(row);
    }
    Ok(())
}

fn edges(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    for (case, name, params) in [
        ("one line at 60°", "half-space", &[][..]),
        ("one line at 45°", "half-space", &[("angle", 45.0), ("offset", 0.123)]),
        ("disk", "disk", &[]),
    ] {
        let f = integrand(name, 2, params)?;
        let row = against_exact(lab, case, &*f, "jittered", &counts, 1.5)?;
        lab.push(row);
    }
    for degrees in [0.0f64, 30.0, 45.0] {
        let angle = degrees.to_radians();
        let averages =
            lab.placed(&|stream| Line::placed(angle, stream.pair(0)[0]), "jittered", &counts)?;
        let case = format!("lines at {degrees}°, every offset");
        let note = "averaged over placements, where the law is exact at every N";
        lab.push(exponent_of_averages(&case, &averages, 1.5).noting(note));
    }
    Ok(())
}

fn complex(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    let f = integrand("checkerboard", 2, &[("frequency", 1000.5)])?;
    let row = against_exact(lab, "checkerboard, 1000.5 checks", &*f, "jittered", &counts, 1.0)?;
    lab.push(row);
    Ok(())
}

fn form_factor(lab: &mut Lab<'_>) -> Outcome {
    squares(lab, &[], 1.5)
}

fn occluded(lab: &mut Lab<'_>) -> Outcome {
    squares(lab, &[("occluder", 0.5)], 1.25)
}

fn squares(lab: &mut Lab<'_>, params: &[(&str, f64)], expected: f64) -> Outcome {
    let f = integrand("form-factor", 4, params)?;
    let largest = lab.either(6, 8);
    for (case, from) in [("all N", 1), ("without N = 1", 2)] {
        let counts = cells(&(from..=largest).collect::<Vec<_>>(), 4);
        let row = against_exact(lab, case, &*f, "jittered", &counts, expected)?;
        lab.push(row);
    }
    Ok(())
}

fn general(lab: &mut Lab<'_>) -> Outcome {
    let strata: [&[u64]; 6] = [
        &[16, 32, 64, 128, 256],
        &[4, 8, 16, 32, 64],
        &[3, 5, 8, 12, 16],
        &[3, 4, 5, 6, 8],
        &[2, 3, 4, 5],
        &[2, 3, 4],
    ];
    for (dim, ks) in (1..).zip(strata) {
        let d = dim as f64;
        let counts = cells(ks, dim);
        let f = integrand("gaussian", dim, &[("width", 0.5)])?;
        let case = format!("gaussian, d = {dim}");
        let row = against_exact(lab, &case, &*f, "jittered", &counts, 1.0 + 2.0 / d)?;
        lab.push(row);
        if dim > 1 {
            let f = integrand("half-space", dim, &[])?;
            let case = format!("half-space, d = {dim}");
            let row = against_exact(lab, &case, &*f, "jittered", &counts, 1.0 + 1.0 / d)?;
            lab.push(row);
        }
    }
    let f = integrand("koch", 2, &[])?;
    let counts = cells(&[3, 9, 27, 81], 2);
    let fractal = 2.0 - 0.5 * 4f64.ln() / 3f64.ln();
    let row = lab.exponent("koch, k = ln 4/ln 3", &*f, "jittered", &counts, fractal)?;
    let why = "strata of a third of the size see the curve's next stage; the first stages still \
               differ (0.03 stated beforehand)";
    lab.push(row.allowing(0.03, why));
    Ok(())
}

fn never_worse(lab: &mut Lab<'_>) -> Outcome {
    for (name, dim, params) in [
        ("gaussian", 2, &[][..]),
        ("half-space", 2, &[]),
        ("disk", 2, &[]),
        ("koch", 2, &[]),
        ("checkerboard", 2, &[("frequency", 1000.5)]),
        ("checkerboard", 2, &[("frequency", 7.0)]),
        ("form-factor", 4, &[("occluder", 0.5)]),
    ] {
        let f = integrand(name, dim, params)?;
        let variance = f.exact_variance("random", 1).unwrap_or(f64::NAN);
        let counts =
            if dim == 4 { cells(&[1, 2, 3, 4, 5], 4) } else { cells(&[1, 2, 3, 5, 7, 12, 20], 2) };
        let rows = lab.study(&*f, SamplerChoice::named("jittered")?, &counts)?.rows;
        let case = format!("{name}{}, {}: the largest", words(params), range(&counts));
        let finding = Finding::new(case, "variance / (σ²/N)", 1.0).being(Relation::AtMost);
        lab.push(with_checks(finding, ratios(&rows, |n| variance / n as f64)));
    }
    Ok(())
}

fn discrepancy(lab: &mut Lab<'_>) -> Outcome {
    let counts = cells(&[4, 6, 8, 12, 16], 2);
    let sets = lab.either(40, 600);
    let mut curves = Vec::new();
    for (sampler, expected) in [("random", 0.5), ("jittered", 0.75)] {
        let rows = lab.edge_discrepancies(sampler, &counts, sets)?;
        let fit = power_law(rows.iter().map(|a| (a.n, a.mean, (a.std_error / a.mean).powi(2))));
        let row =
            exponent_row(&format!("{sampler}, mean over {sets} sets"), fit.as_ref(), expected);
        let quantity = "exponent of the discrepancy";
        let why = "the bounds leave room for √log N, which at these N looks like an exponent \
                   smaller by 0.12";
        lab.push(Finding { quantity, ..row }.allowing(0.12, why));
        curves.push(rows);
    }
    for n in [16, 64, 256] {
        let optimised = lab.edge_discrepancies("annealed+none", &[n], 4)?;
        let jittered = curves[1].iter().find(|a| a.n == n);
        let (Some(a), Some(j)) = (optimised.first(), jittered) else { continue };
        let ratio = a.mean / j.mean;
        let relative = (a.std_error / a.mean).hypot(j.std_error / j.mean);
        let finding = Finding::new(format!("annealed, N = {n}"), "discrepancy / jittered's", 0.5);
        let note = "four patterns; \"about half\" was said of patterns that are not at hand";
        lab.push(finding.measured(ratio, ratio * relative).noting(note).recalled());
    }
    Ok(())
}

fn folklore(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 1..=6);
    let mut curves = Vec::new();
    let placed = |stream: crate::rng::Stream| {
        let [offset, angle] = stream.pair(0);
        Line::placed(angle * std::f64::consts::TAU, offset)
    };
    for (sampler, expected) in [("random", 0.5), ("jittered", 0.75)] {
        let averages = lab.placed(&placed, sampler, &counts)?;
        let case = format!("{sampler}, lines at every angle and offset");
        let row = exponent_of_averages(&case, &averages, 2.0 * expected);
        let half = |value: Option<f64>| value.map(|v| 0.5 * v);
        let (p, error) = (half(row.measured), half(row.std_error));
        let note = match (p, error) {
            (Some(p), Some(error)) if sampler == "jittered" => {
                format!("1/N would be {:.0} standard errors away", (1.0 - p) / error)
            }
            _ => String::new(),
        };
        lab.push(Finding {
            quantity: "exponent of the error",
            expected: Some(expected),
            measured: p,
            std_error: error,
            note,
            ..row
        });
        let points = averages.iter().map(|a| {
            let ends = [0.0, -1.96, 1.96].map(|z| (a.mean + z * a.std_error).max(0.0).sqrt());
            [a.n as f64, ends[0], ends[1], ends[2]]
        });
        curves.push(Curve { name: sampler.to_owned(), points: points.collect() });
    }
    let at = |i: usize| curves[i].points.first().map_or(1.0, |p| p[1]);
    let first = counts[0] as f64;
    let slopes = vec![
        Slope { name: "N^{\u{2212}1/2}", factor: at(0) * first.powf(0.5), power: -0.5 },
        Slope { name: "N^{\u{2212}3/4}", factor: at(1) * first.powf(0.75), power: -0.75 },
        Slope { name: "1/N", factor: at(1) * first, power: -1.0 },
    ];
    lab.draw(Figure {
        name: "edges-error",
        title: "An edge: the error falls as N^{\u{2212}3/4}, not as 1/N",
        caption: "F1. Root mean square error of estimates of an edge through the pixel, averaged \
                  over its angle and offset. Jittered points gain a power of N over random ones, \
                  a quarter and not a half."
            .to_owned(),
        axes: ["samples in one estimate, N", "root mean square error"],
        log_x: true,
        curves,
        slopes,
    });
    Ok(())
}
