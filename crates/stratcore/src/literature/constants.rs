//! K1 to K10: exact or nearly exact constants, the strongest tests.

use super::finding::{Check, Finding};
use super::lab::{Lab, average_ratios, cells, integrand, powers, with_checks};
use super::shapes::{Circle, Line, Pulse};
use super::{Claim, LiteratureError, Standing, bounds, noise};
use crate::rng::StreamKey;
use crate::sampler::{Grid, PointSet, Sampler, Scramble};
use crate::theory::{circle_edge_constant, edge_constant, step_variance, stratified_variance};
use crate::trial::trial_means;
use std::f64::consts::PI;

type Outcome = Result<(), LiteratureError>;

pub(super) const CLAIMS: &[Claim] = &[
    Claim {
        id: "K1",
        statement: "random: the variance is σ²/N, whatever f",
        source: "central limit theorem",
        standing: Standing::Sure,
        measure: random,
    },
    Claim {
        id: "K2",
        statement: "jittered, f = a·x: the variance is |a|²/12 · N^(-1-2/d)",
        source: "Mitchell 1996, Theoretical analysis, worked out",
        standing: Standing::Sure,
        measure: linear,
    },
    Claim {
        id: "K2b",
        statement: "jittered, smooth f: the variance tends to ∫|∇f|²/12 · N^(-1-2/d)",
        source: "Mitchell 1996, Theoretical analysis, worked out",
        standing: Standing::Sure,
        measure: smooth,
    },
    Claim {
        id: "K3",
        statement: "jittered, step along an axis: q(1-q) N^(-1-1/d), q the cut part of a layer",
        source: "Mitchell 1996, Theoretical analysis, worked out",
        standing: Standing::Sure,
        measure: step,
    },
    Claim {
        id: "K4",
        statement: "edge-length law: jittered, an edge of contrast Δ and length L has the \
                    variance c(θ) L Δ² N^(-3/2), c from 0.16667 at 0° to 0.16499 at 45°",
        source: "derived here; not seen in print",
        standing: Standing::Derived,
        measure: edge_length,
    },
    Claim {
        id: "K5",
        statement: "s²/N of one jittered estimate overstates its variance: N-fold for a smooth \
                    f, √N-fold for an edge",
        source: "derived here",
        standing: Standing::Derived,
        measure: noise::naive_error,
    },
    Claim {
        id: "K6",
        statement: "noise of the paper's fit: sd(p) = √(2/(M-1)) / √Sxx",
        source: "derived here; the width of the peaks in Mitchell's Figure 4",
        standing: Standing::Derived,
        measure: noise::noise_of_fit,
    },
    Claim {
        id: "K7",
        statement: "a scanline with one step or two, averaged over where they lie: variance × N² \
                    is 1/6 and 1/3 jittered, 1/12 and 1/6 centred grid, 1/6 and 1/6 shifted grid",
        source: "derived here; direction agrees with Ramamoorthi et al. 2012, abstract",
        standing: Standing::Derived,
        measure: scanline,
    },
    Claim {
        id: "K8",
        statement: "scrambled nets in base 2: variance ≤ Γσ²/N with Γ ≤ 2^(t+s-1), 2 for the \
                    plane; gains that are not zero are powers of two",
        source: "Pan & Owen 2021, abstract",
        standing: Standing::Abstract,
        measure: bounds::gain,
    },
    Claim {
        id: "K9",
        statement: "lhs: variance ≤ σ²/(N-1), whatever f",
        source: "Owen 1997; standard",
        standing: Standing::Recalled,
        measure: bounds::latin_bound,
    },
    Claim {
        id: "K10",
        statement: "Sobol' under an XOR shift alone fails on a 64 × 64 checkerboard: variance \
                    1/4 up to N = 64; nested scrambling does as well as random",
        source: "Burley 2020, Figure 1c, for the direction",
        standing: Standing::Measured,
        measure: bounds::checkerboard,
    },
];

fn random(lab: &mut Lab<'_>) -> Outcome {
    let plane = powers(4, 0..=6);
    let four = powers(16, 0..=3);
    for (name, dim, params, counts) in [
        ("ramp", 2, &[][..], &plane),
        ("gaussian", 2, &[], &plane),
        ("half-space", 2, &[], &plane),
        ("checkerboard", 2, &[], &plane),
        ("koch", 2, &[], &plane),
        ("form-factor", 4, &[], &four),
        ("form-factor", 4, &[("occluder", 0.5)], &four),
    ] {
        let f = integrand(name, dim, params)?;
        let variance = f.exact_variance("random", 1).unwrap_or(f64::NAN);
        let case = format!("{name}{}, d = {dim}, {}", words(params), range(counts));
        let row = lab.exact(&case, &*f, "random", counts, |n| variance / n as f64)?;
        lab.push(row);
    }
    Ok(())
}

/// "N = 1 to 256"
pub(super) fn range(counts: &[u64]) -> String {
    match counts {
        [first, .., last] => format!("N = {first} to {last}"),
        _ => counts.iter().map(|n| format!("N = {n}")).collect(),
    }
}

/// ", frequency 64"
pub(super) fn words(params: &[(&str, f64)]) -> String {
    params.iter().map(|(name, value)| format!(", {name} {value}")).collect()
}

/// Strata per axis that make N = 4 to a few thousand in d dimensions.
fn strata(dim: usize) -> &'static [u64] {
    match dim {
        1 => &[4, 16, 64, 256, 1024],
        2 => &[2, 4, 8, 16, 32, 64],
        3 => &[2, 3, 5, 8, 13],
        4 => &[2, 3, 4, 6, 8],
        _ => &[2, 3, 4],
    }
}

fn per_axis(n: u64, dim: usize) -> f64 {
    (n as f64).powf(1.0 / dim as f64).round()
}

fn linear(lab: &mut Lab<'_>) -> Outcome {
    for dim in 1..=5 {
        let f = integrand("ramp", dim, &[])?;
        let counts = cells(strata(dim), dim);
        let case = format!("ramp, d = {dim}, {}", range(&counts));
        let row = lab.exact(&case, &*f, "jittered", &counts, |n| {
            stratified_variance(1.0, n as f64, per_axis(n, dim))
        })?;
        lab.push(row);
    }
    Ok(())
}

fn smooth(lab: &mut Lab<'_>) -> Outcome {
    for (name, dim) in [("gaussian", 2), ("multilinear", 2), ("gaussian", 1), ("gaussian", 4)] {
        let f = integrand(name, dim, &[])?;
        let k = *strata(dim).last().unwrap_or(&1);
        let n = k.pow(dim as u32);
        let gradient = f.mean_square_gradient().unwrap_or(f64::NAN);
        let limit = stratified_variance(gradient, n as f64, k as f64);
        let exact = f.exact_variance("jittered", n).unwrap_or(f64::NAN) / limit;
        let case = format!("{name}, d = {dim}, N = {n}");
        let row = lab.exact(&case, &*f, "jittered", &[n], |_| limit)?;
        let finding = Finding { quantity: "variance / leading term", checks: Vec::new(), ..row };
        let why = format!("finite N: the exact variance is {exact:.5} of the leading term here");
        lab.push(finding.allowing((exact - 1.0).abs(), why));
        // How the distance itself vanishes, by the closed form: four times for twice the strata.
        let finer = f.exact_variance("jittered", (2 * k).pow(dim as u32)).unwrap_or(f64::NAN)
            / stratified_variance(gradient, (2 * k).pow(dim as u32) as f64, 2.0 * k as f64);
        let case = format!("{name}, d = {dim}: closed form, {k} to {} strata per axis", 2 * k);
        let finding = Finding::new(case, "distance from the leading term shrinks by", 4.0);
        lab.push(
            finding
                .measured((exact - 1.0) / (finer - 1.0), 0.0)
                .allowing(0.2, "no sampling: exact variances; the next order in 1/k² is left out"),
        );
    }
    Ok(())
}

fn step(lab: &mut Lab<'_>) -> Outcome {
    for (dim, edge) in
        [(1, 0.3), (2, 0.3), (2, std::f64::consts::FRAC_1_SQRT_2), (3, 0.3), (4, 0.3)]
    {
        let f = integrand("step", dim, &[("edge", edge)])?;
        let counts = cells(strata(dim), dim);
        let case = format!("step at {edge:.3}, d = {dim}, {}", range(&counts));
        let row = lab.exact(&case, &*f, "jittered", &counts, |n| {
            step_variance(edge, per_axis(n, dim) as u64, dim)
        })?;
        lab.push(row);
    }
    Ok(())
}

fn edge_length(lab: &mut Lab<'_>) -> Outcome {
    let counts = cells(&[2, 4, 8, 16, 32], 2);
    for degrees in [0.0f64, 15.0, 30.0, 45.0] {
        let angle = degrees.to_radians();
        let c = edge_constant(angle);
        let averages =
            lab.placed(&|stream| Line::placed(angle, stream.pair(0)[0]), "jittered", &counts)?;
        // The law at every N: the mean length of a chord is 1 / span.
        let span = angle.cos() + angle.sin();
        let checks = average_ratios(&averages, |n| (n as f64).powf(-1.5) * c / span);
        let case = format!("line at {degrees}°, every offset, {}", range(&counts));
        let row = with_checks(Finding::new(case, "c(θ)", 1.0), checks);
        let scaled = |value: Option<f64>| value.map(|v| v * c);
        lab.push(Finding {
            expected: Some(c),
            measured: scaled(row.measured),
            std_error: scaled(row.std_error),
            ..row
        });
    }
    let radius = 0.3;
    // The centre's range of 0.4 is a whole number of cells: every offset equally often.
    let counts = cells(&[5, 10, 20, 40], 2);
    let circle = |stream: crate::rng::Stream| Circle {
        centre: stream.pair(0).map(|u| 0.3 + 0.4 * u),
        radius,
    };
    let averages = lab.placed(&circle, "jittered", &counts)?;
    let c = circle_edge_constant();
    for (average, check) in averages
        .iter()
        .zip(average_ratios(&averages, |n| 2.0 * PI * radius * (n as f64).powf(-1.5)))
    {
        let curvature = 1.0 / (radius * radius * average.n as f64);
        let case = format!("circle of radius {radius}, N = {}", average.n);
        let finding = Finding::new(case, "c", c).measured(check.ratio, check.std_error);
        let why = "the law takes the edge as straight across a cell; left out is a share of \
                   (cell / radius)² / 24";
        lab.push(finding.allowing(c * curvature / 24.0, why));
    }
    Ok(())
}

fn scanline(lab: &mut Lab<'_>) -> Outcome {
    let counts = [4, 16, 64, 256];
    let one = |stream: crate::rng::Stream| Pulse { from: 0.0, to: stream.pair(0)[0] };
    // One step in either half, so that no stratum holds both.
    let two = |stream: crate::rng::Stream| {
        let [from, to] = stream.pair(0);
        Pulse { from: 0.5 * from, to: 0.5 + 0.5 * to }
    };
    for (case, make, values) in [
        ("one step", &one as &(dyn Fn(crate::rng::Stream) -> Pulse + Sync), [6.0, 12.0, 6.0]),
        ("two steps", &two, [3.0, 6.0, 6.0]),
    ] {
        for (sampler, value) in [("jittered", values[0]), ("grid+torus-shift", values[2])] {
            let averages = lab.placed(make, sampler, &counts)?;
            let checks = average_ratios(&averages, |n| (n as f64).powi(-2) / value);
            let case = format!("{case}, {sampler}, {}", range(&counts));
            let row = with_checks(Finding::new(case, "variance × N²", 1.0), checks);
            let scaled = |v: Option<f64>| v.map(|v| v / value);
            lab.push(Finding {
                expected: Some(1.0 / value),
                measured: scaled(row.measured),
                std_error: scaled(row.std_error),
                ..row
            });
        }
        let row = centred_grid(lab, case, make, &counts, values[1])?;
        lab.push(row);
    }
    Ok(())
}

/// A centred grid has no variance; what is averaged over placements is its squared error.
fn centred_grid(
    lab: &mut Lab<'_>,
    case: &str,
    make: &(dyn Fn(crate::rng::Stream) -> Pulse + Sync),
    counts: &[u64],
    value: f64,
) -> Result<Finding, LiteratureError> {
    let key = lab.key();
    let placements = lab.either(4000, 40_000u32);
    let mut checks = Vec::new();
    for &n in counts {
        let set = PointSet {
            key: StreamKey { sampler: Grid.stream_id(), n_samples: n, ..key },
            dim: 1,
            scramble: Scramble::None,
            rectangular: false,
        };
        let errors: Vec<f64> = (0..placements)
            .map(|trial| {
                let pulse = make(StreamKey { trial, n_samples: n, ..key }.stream());
                let mut mean = [0.0];
                trial_means(&pulse, &Grid, &set, 0, &mut mean, lab.control().cancel);
                (mean[0] - (pulse.to - pulse.from)).powi(2)
            })
            .collect();
        let p = f64::from(placements);
        let mean = errors.iter().sum::<f64>() / p;
        let squares: f64 = errors.iter().map(|e| (e - mean).powi(2)).sum();
        let expected = (n as f64).powi(-2) / value;
        checks.push(Check {
            at: format!("N = {n}"),
            ratio: mean / expected,
            std_error: (squares / (p - 1.0) / p).sqrt() / expected,
        });
    }
    let case = format!("{case}, centred grid, {}", range(counts));
    let row = with_checks(Finding::new(case, "squared error × N²", 1.0), checks);
    let scaled = |v: Option<f64>| v.map(|v| v / value);
    Ok(Finding {
        expected: Some(1.0 / value),
        measured: scaled(row.measured),
        std_error: scaled(row.std_error),
        ..row
    })
}
