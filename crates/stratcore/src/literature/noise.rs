//! K5 and K6: what estimates and fits say of their own error.

use super::LiteratureError;
use super::constants::range;
use super::finding::{Check, Curve, Figure, Finding, Slope};
use super::lab::{Lab, cells, integrand, powers, with_checks};
use super::shapes::{NormalMeans, Squared};

type Outcome = Result<(), LiteratureError>;

/// E[s²]/N over the variance of the mean. E[s²] = N/(N-1) (E f² - mean²) is measured without
/// looking at single samples: E f² is the grand mean of f² at the same points.
pub(super) fn naive_error(lab: &mut Lab<'_>) -> Outcome {
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

pub(super) fn noise_of_fit(lab: &mut Lab<'_>) -> Outcome {
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
