//! K1 to K10: exact or nearly exact constants, the strongest tests.

use super::finding::{Check, Curve, Figure, Finding, Relation, Slope};
use super::lab::{Lab, average_ratios, cells, integrand, powers, ratios, with_checks};
use super::shapes::{Circle, Line, NormalMeans, Pulse, Squared};
use super::{Claim, LiteratureError, Standing};
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
        measure: naive_error,
    },
    Claim {
        id: "K6",
        statement: "noise of the paper's fit: sd(p) = √(2/(M-1)) / √Sxx",
        source: "derived here; the width of the peaks in Mitchell's Figure 4",
        standing: Standing::Derived,
        measure: noise_of_fit,
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
        measure: gain,
    },
    Claim {
        id: "K9",
        statement: "lhs: variance ≤ σ²/(N-1), whatever f",
        source: "Owen 1997; standard",
        standing: Standing::Recalled,
        measure: latin_bound,
    },
    Claim {
        id: "K10",
        statement: "Sobol' under an XOR shift alone fails on a 64 × 64 checkerboard: variance \
                    1/4 up to N = 64; nested scrambling does as well as random",
        source: "Burley 2020, Figure 1c, for the direction",
        standing: Standing::Measured,
        measure: checkerboard,
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

/// E[s²]/N over the variance of the mean. E[s²] = N/(N-1) (E f² - mean²) is measured without
/// looking at single samples: E f² is the grand mean of f² at the same points.
fn naive_error(lab: &mut Lab<'_>) -> Outcome {
    let counts = powers(4, 2..=6);
    let mut curves = Vec::new();
    for (name, params, label) in [
        ("ramp", &[][..], "ramp"),
        ("gaussian", &[], "gaussian"),
        ("half-space", &[], "edge at 60°"),
        ("disk", &[], "disk"),
    ] {
        let f = integrand(name, 2, params)?;
        let squared = Squared(&*f);
        let [rows, squares] = lab.studies([&*f, &squared], "jittered", &counts)?;
        let sigma = f.exact_variance("random", 1).unwrap_or(f64::NAN);
        let mut points = Vec::new();
        let mut checks = Vec::new();
        for (row, square) in rows.iter().zip(&squares) {
            let (n, s2) = (row.n_used as f64, row.variance_of_mean);
            // Mean over trials of (mean of f² - (mean of f)²): s² of the means stands for
            // their spread, up to 1/M of itself.
            let within = square.grand_mean - row.grand_mean.powi(2) - s2;
            let factor = within / (n - 1.0) / s2;
            let exact = f.exact_variance("jittered", row.n_used).unwrap_or(f64::NAN);
            let expected = (sigma - exact) / ((n - 1.0) * exact);
            let std_error = row.var_ln().sqrt() * factor / expected;
            checks.push(Check {
                at: format!("N = {n}, {expected:.1}-fold"),
                ratio: factor / expected,
                std_error,
            });
            let half = 1.96 * row.var_ln().sqrt() * factor;
            points.push([n, factor, factor - half, factor + half]);
        }
        let largest = points.last().map_or(f64::NAN, |p| p[1]);
        let case = format!("{label}, {}", range(&counts));
        let finding = Finding::new(case, "overstatement / exact, mean over N", 1.0);
        let note =
            format!("exactly (σ² - V)/((N-1)V), V the variance; {largest:.0}-fold at N = 4096");
        lab.push(with_checks(finding, checks).noting(note));
        curves.push(Curve { name: label.to_owned(), points });
    }
    lab.draw(Figure {
        name: "naive-error",
        title: "s²/N overstates the variance of jittered estimates",
        caption: "K5. The usual estimate of a mean's variance, s²/N from the samples of one \
                  estimate, over the variance it is meant for. It is right for independent \
                  samples alone: for a smooth pixel it is N times too large, for an edge √N times."
            .to_owned(),
        axes: ["samples in one estimate, N", "s²/N over the variance of the mean"],
        log_x: true,
        curves,
        slopes: vec![
            Slope { name: "N", factor: 1.0, power: 1.0 },
            Slope { name: "N^{1/2}", factor: 1.0, power: 0.5 },
        ],
    });
    Ok(())
}

fn noise_of_fit(lab: &mut Lab<'_>) -> Outcome {
    const TRIALS: u32 = 50;
    let repeats = lab.either(3000, 30_000);
    for (dim, ks, claimed) in
        [(2, 1..=16, 0.033), (2, 2..=16, 0.043), (4, 1..=10, 0.023), (4, 2..=10, 0.033)]
    {
        let counts = cells(&ks.clone().collect::<Vec<u64>>(), dim);
        let mut exponents = Vec::new();
        lab.each_replicate(&|_| NormalMeans, "random", &counts, TRIALS, repeats, &mut |result| {
            exponents.extend(result.fit.map(|fit| fit.exponent));
        })?;
        let count = exponents.len() as f64;
        let mean = exponents.iter().sum::<f64>() / count;
        let squares: f64 = exponents.iter().map(|p| (p - mean).powi(2)).sum();
        let deviation = (squares / (count - 1.0)).sqrt();
        let x: Vec<f64> = counts.iter().map(|n| (*n as f64).ln()).collect();
        let middle = x.iter().sum::<f64>() / x.len() as f64;
        let sxx: f64 = x.iter().map(|x| (x - middle).powi(2)).sum();
        // Var ln s² of M normal trials is ψ'((M-1)/2), of which 2/(M-1) is the first term.
        let expected = (var_ln_of_normal(TRIALS) / sxx).sqrt();
        let simple = (2.0 / f64::from(TRIALS - 1) / sxx).sqrt();
        let case = format!("M = 50, N = k^{dim}, k = {} to {}", ks.start(), ks.end());
        let note = format!(
            "normal trial means, {repeats} fits; the claim's first-order {simple:.4} ({claimed}) \
             is 1 % below ψ'((M-1)/2), which is what is expected here"
        );
        let finding = Finding::new(case, "sd of p", expected).noting(note);
        lab.push(finding.measured(deviation, deviation / (2.0 * (count - 1.0)).sqrt()));
    }
    Ok(())
}

/// ψ'(ν/2) for ν = M - 1 degrees of freedom, by its asymptotic series.
pub(super) fn var_ln_of_normal(trials: u32) -> f64 {
    let x = 0.5 * f64::from(trials - 1);
    1.0 / x + 0.5 / (x * x) + 1.0 / (6.0 * x.powi(3)) - 1.0 / (30.0 * x.powi(5))
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

fn gain(lab: &mut Lab<'_>) -> Outcome {
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
        let choice = crate::study::SamplerChoice::named("sobol+owen")?;
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
                std::cmp::Ordering::Less => 1.0,
                std::cmp::Ordering::Equal => 2.0,
                std::cmp::Ordering::Greater => 0.0,
            };
            0.25 * gain / n as f64
        };
        let row = lab.exact(&case, &*f, "sobol+owen", &counts, law)?;
        let why = "gains 1, 2 at N = 2^(2j-1), then 0: the bound is reached";
        lab.push(row.noting(why));
    }
    Ok(())
}

fn latin_bound(lab: &mut Lab<'_>) -> Outcome {
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
        let choice = crate::study::SamplerChoice::named("lhs")?;
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

fn checkerboard(lab: &mut Lab<'_>) -> Outcome {
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
