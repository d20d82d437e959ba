//! Results as text for people: columns, numbers, and the sentences below a table.

use crate::report::chart::label;
use crate::report::spectrum::{SamplerSpectrum, Spectra};
use std::fmt::Write;
use stratcore::StudyResult;
use stratcore::dimensions::Bound;
use stratcore::exact::Unresolved;
use stratcore::fit::Fit;
use stratcore::study::{Discrepancies, Method, Row, SamplerResult, Stop, StopReason, Tightness};
use stratcore::theory::{Basis, Class};

/// Which side of a column its cells stand at.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// At its left.
    Left,
    /// At its right.
    Right,
}

/// Rows of cells, indented by two and in columns.
pub fn columns(align: Align, rows: &[Vec<String>]) -> String {
    let width_of = |cell: &String| cell.chars().count();
    let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widths: Vec<_> = (0..n_columns)
        .map(|i| rows.iter().filter_map(|row| row.get(i)).map(width_of).max().unwrap_or(0))
        .collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (cell, &width) in row.iter().zip(&widths) {
            line += &match align {
                Align::Left => format!("  {cell:<width$}"),
                Align::Right => format!("  {cell:>width$}"),
            };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// A number to `digits` significant digits: plain where that is short, scientific elsewhere.
pub fn number(x: f64, digits: usize) -> String {
    let scientific = format!("{x:.*e}", digits - 1);
    let exponent = scientific.split_once('e').and_then(|(_, e)| e.parse::<i32>().ok());
    match exponent {
        Some(e) if x != 0.0 && (-3..6).contains(&e) => {
            let decimals = usize::try_from(digits as i32 - 1 - e).unwrap_or(0);
            format!("{x:.decimals$}")
        }
        Some(_) if x != 0.0 => scientific,
        _ => format!("{x}"),
    }
}

/// The same without trailing zeros, for numbers that were chosen rather than measured.
pub fn short(x: f64, digits: usize) -> String {
    number(x, digits).parse::<f64>().map_or_else(|_| x.to_string(), |x| x.to_string())
}

/// A value and its standard error, with as many decimals as show the error's first digit, but
/// two at the least.
pub fn with_error(value: f64, std_error: f64) -> String {
    let first_digit = -std_error.log10().floor();
    let decimals = if first_digit.is_finite() { first_digit.clamp(2.0, 9.0) as usize } else { 2 };
    format!("{value:.decimals$} ± {std_error:.decimals$}")
}

/// A study: what was measured, then a table and its reading for each sampler.
pub fn study(title: &str, result: &StudyResult) -> String {
    let mut text = format!("{title}\nd = {} ({}), ", result.dim, result.axes.join(", "));
    if result.samplers.iter().all(|sampler| sampler.method == Method::Exact) {
        text += "exact: no random numbers\n";
    } else {
        let _ = writeln!(text, "M = {} trials, seed {}", result.trials, result.seed);
    }
    if let Some(reference) = result.reference {
        let by_polygons = result.samplers.iter().any(|sampler| {
            sampler.method == Method::Exact || sampler.unresolved == Some(Unresolved::Sampler)
        });
        let source = if by_polygons { "from the visible polygons" } else { "closed form" };
        let _ = match reference.std_error {
            0.0 => writeln!(text, "reference mean {} ({source})", reference.mean),
            error => writeln!(text, "reference mean {} ± {}", reference.mean, number(error, 2)),
        };
    }
    for sampler in &result.samplers {
        let _ = write!(text, "\n{} (scramble: {})", sampler.name, sampler.scramble);
        text += match (sampler.method, &sampler.unresolved) {
            (Method::Exact, _) => ", exact\n".to_owned(),
            (Method::Trials, Some(reason @ Unresolved::Rays)) => {
                format!(
                    ", by trials: {reason}; without --tracer bvh, `stratcli inspect` with --at \
                     says why\n"
                )
            }
            (Method::Trials, Some(reason)) => format!(", by trials: {reason}\n"),
            (Method::Trials, None) => "\n".to_owned(),
        }
        .as_str();
        text += &rows(&sampler.rows, sampler.method);
        text += &reading(sampler);
    }
    text
}

/// Discrepancies: a table for each sampler and measure.
pub fn discrepancies(result: &Discrepancies) -> String {
    let Discrepancies { dim, seed, trials, .. } = result;
    let mut text =
        format!("discrepancy of up to {trials} point sets at each N, d = {dim}, seed {seed}\n");
    for curve in &result.curves {
        let (sampler, measure) = (curve.sampler, curve.measure);
        let _ = write!(
            text,
            "\n{sampler} (scramble: {}), {}: {}\n",
            curve.scramble,
            measure.name(),
            measure.summary()
        );
        let snapped = curve.rows.iter().any(|row| row.n_used != row.n);
        let mean_square = if measure.is_l2() { "mean square" } else { "" };
        let mut header = vec!["N", "N used", "sets", "mean", "± std error", mean_square];
        if !snapped {
            header.remove(1);
        }
        let mut table = vec![header.into_iter().map(str::to_owned).collect::<Vec<_>>()];
        for row in &curve.rows {
            let mut cells = vec![row.n.to_string()];
            if snapped {
                cells.push(row.n_used.to_string());
            }
            cells.push(row.trials.to_string());
            cells.push(number(row.mean, 5));
            cells.push(row.std_error.map_or("-".to_owned(), |error| number(error, 2)));
            cells.extend(row.mean_sq.map(|mean| number(mean, 5)));
            table.push(cells);
        }
        text += &columns(Align::Right, &table);
        text += &match &curve.fit {
            Some(fit) => format!(
                "  mean ~ N^-p: p = {} (95 %: {:.3} to {:.3}), N = {} to {}\n",
                with_error(fit.exponent, fit.std_error),
                fit.ci95[0],
                fit.ci95[1],
                fit.n_min,
                fit.n_max
            ),
            None => "  no fit: it needs two different N with more than one set each\n".to_owned(),
        };
    }
    text
}

/// Spectra: the radial means of all samplers side by side, at about twenty frequencies.
pub fn spectra(spectra: &Spectra) -> String {
    const SHOWN: usize = 20;
    let mut text = format!("{}, seed {}\n", spectra.title, spectra.seed);
    if let Some(spp) = spectra.reference_spp {
        let _ = writeln!(text, "reference: jittered, about {spp} spp");
    }
    for sampler in &spectra.samplers {
        let SamplerSpectrum { name, scramble, n_used, trials, mse, rings, .. } = sampler;
        let _ =
            write!(text, "\n{name} (scramble: {scramble}), N = {n_used}, {trials} periodograms");
        let _ = match mse {
            Some(mse) => writeln!(text, ", mean square error {}", number(*mse, 4)),
            None => writeln!(text),
        };
        let header = ["frequency", "power", "± std error", "anisotropy, dB"];
        let mut table = vec![header.map(str::to_owned).to_vec()];
        for ring in rings.iter().step_by(rings.len().div_ceil(SHOWN).max(1)) {
            table.push(vec![
                number(ring.frequency, 4),
                number(ring.power, 4),
                number(ring.std_error, 2),
                format!("{:.1}", ring.anisotropy_db),
            ]);
        }
        text += &columns(Align::Right, &table);
    }
    let _ = writeln!(
        text,
        "\nfrequency in {}; power 1 is white noise; anisotropy of a spectrum that is the same in \
         all directions: -10 log10(periodograms) dB",
        spectra.unit
    );
    text
}

fn rows(rows: &[Row], method: Method) -> String {
    let measured = method == Method::Trials;
    let snapped = rows.iter().any(|row| row.n_used != row.n);
    let strata = rows.iter().any(|row| row.strata.is_some());
    let exact = rows.iter().any(|row| row.exact_variance.is_some());
    let timed = rows.iter().any(|row| row.ns_per_sample.is_some());
    let optional = |value: Option<f64>, digits| value.map_or("-".to_owned(), |x| number(x, digits));
    let pick = |cells: [(bool, String); 8]| -> Vec<String> {
        cells.into_iter().filter(|(shown, _)| *shown).map(|(_, cell)| cell).collect()
    };
    let header = pick([
        (true, "N".to_owned()),
        (snapped, "N used".to_owned()),
        (strata, "strata".to_owned()),
        (true, "mean".to_owned()),
        (true, "variance of mean".to_owned()),
        (measured, "95 % interval".to_owned()),
        (exact, "exact variance".to_owned()),
        (timed, "ns/sample".to_owned()),
    ]);
    let body = rows.iter().map(|row| {
        let strata_used = row.strata.iter().flatten().map(u64::to_string).collect::<Vec<_>>();
        pick([
            (true, row.n.to_string()),
            (snapped, row.n_used.to_string()),
            (strata, strata_used.join(" × ")),
            (true, number(row.grand_mean, 6)),
            (true, number(row.variance_of_mean, 4)),
            (measured, row.ci95().map(|end| number(end, 3)).join(" to ")),
            (exact, optional(row.exact_variance, 4)),
            (timed, optional(row.ns_per_sample, 3)),
        ])
    });
    columns(Align::Right, &std::iter::once(header).chain(body).collect::<Vec<_>>())
}

/// The sentences below one sampler's table.
fn reading(sampler: &SamplerResult) -> String {
    let mut text = String::new();
    let zero: Vec<_> = sampler.rows.iter().filter(|row| row.variance_of_mean == 0.0).collect();
    if sampler.exact && sampler.method == Method::Exact {
        text += "  zero variance at every N: the estimate is exact and has no exponent\n";
    } else if sampler.exact {
        text += "  zero variance: every trial gave the same number at every N, so the estimate is \
                 exact and has no exponent\n";
    } else if !zero.is_empty() {
        let counts = zero.iter().map(|row| row.n_used.to_string()).collect::<Vec<_>>();
        let _ = writeln!(
            text,
            "  zero variance at N = {}: exact there; the fit is through the other rows",
            counts.join(", ")
        );
    }
    match (&sampler.fit, sampler.exact) {
        (Some(fit), _) if sampler.method == Method::Exact => {
            let _ = writeln!(
                text,
                "  p = {}, N = {} to {}",
                number(fit.exponent, 5),
                fit.n_min,
                fit.n_max
            );
            if let Some(fit) = sampler.paper_fit_without_first {
                let _ =
                    writeln!(text, "  without the first point: p = {}", number(fit.exponent, 5));
            }
        }
        (Some(fit), _) => {
            let _ = writeln!(
                text,
                "  p = {} (95 %: {:.2} to {:.2}), N = {} to {}",
                with_error(fit.exponent, fit.std_error),
                fit.ci95[0],
                fit.ci95[1],
                fit.n_min,
                fit.n_max,
            );
            text += &misfit(fit, sampler);
            let p = |fit: Option<Fit>| {
                fit.map_or("none".to_owned(), |fit| with_error(fit.exponent, fit.std_error))
            };
            let _ = writeln!(
                text,
                "  unweighted, as in the paper: p = {}; without the first point {}",
                p(sampler.paper_fit),
                p(sampler.paper_fit_without_first)
            );
        }
        (None, false) => text += "  no fit: it needs two different N with a variance\n",
        (None, true) => {}
    }
    if let Some(class) = sampler.class.filter(|class| *class != Class::Exact) {
        let doubt = if sampler.class_is_sure { "" } else { ", but the interval reaches further" };
        let _ = writeln!(text, "  class: {class}{doubt}");
    }
    if let Some(p) = sampler.predicted {
        let sign = if sampler.predicted_bound == Some(Bound::AtLeast) { ">=" } else { "=" };
        let [when, whence] = match sampler.predicted_from {
            Some(Basis::Axes) => {
                [" for large N", "; from the pixel's axes, not from the variances"]
            }
            _ => ["", ""],
        };
        let source = sampler.predicted_source.unwrap_or_default();
        let _ = writeln!(text, "  predicted: p {sign} {}{when} ({source}{whence})", short(p, 5));
    }
    text
}

/// Why a study stopped, after how many trials, and what it would have said after 50.
pub fn stop(stop: &Stop, result: &StudyResult) -> String {
    let (what, wanted) = match stop.until {
        Tightness::Exponent(width) => ("p", width),
        Tightness::Variance(share) => ("a variance, as a share of it,", share),
    };
    let reached = stop.half_width.map_or("none".to_owned(), |width| number(width, 2));
    let why = match stop.reason {
        StopReason::Sure => "sure",
        StopReason::MaxTrials => "not sure: the most trials allowed",
        StopReason::Cancelled => "interrupted",
    };
    let mut text = format!(
        "\nstopped after {} trials, {why}; widest half interval of {what} {reached}, asked for {}\n",
        result.trials,
        short(wanted, 4)
    );
    if result.trials > 50 {
        for early in &stop.after_50_trials {
            let p = early.fit.map_or("none".to_owned(), |f| with_error(f.exponent, f.std_error));
            let width = early.half_width.map_or("none".to_owned(), |width| number(width, 2));
            let name = label(early.name, early.scramble);
            let _ = writeln!(text, "  after 50 trials {name} had p = {p}; half interval {width}");
        }
    }
    text
}

/// Whether one slope describes the rows, and what describes them better.
fn misfit(fit: &Fit, sampler: &SamplerResult) -> String {
    let dof = fit.points.saturating_sub(2);
    let Some(probability) = sampler.misfit_p_value else { return String::new() };
    let mut text =
        format!("  residuals: chi2 = {} for {dof} degrees of freedom", number(fit.chi2, 3));
    text += match probability {
        p if p < 0.01 => "; one slope does not describe the rows\n",
        _ => "\n",
    };
    if let Some(two) = &sampler.two_terms {
        let term = |i: usize| with_error(two.exponents[i], two.std_errors[i]);
        let _ = writeln!(
            text,
            "  two terms: N^-p with p = {} and p = {}, equal at N = {}; chi2 = {}",
            term(0),
            term(1),
            number(two.n_equal, 3),
            number(two.chi2, 3),
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_say_enough() {
        assert_eq!(number(0.25, 3), "0.250");
        assert_eq!(number(123_456.7, 4), "123457");
        assert_eq!(number(1.5e-9, 2), "1.5e-9");
        assert_eq!(number(0.0, 4), "0");
        assert_eq!(number(-0.5, 2), "-0.50");
        assert_eq!(number(f64::NAN, 4), "NaN");
        assert_eq!(short(196.0, 4), "196");
        assert_eq!(short(1.369_07, 5), "1.3691");
        assert_eq!(short(f64::INFINITY, 4), "inf");
        assert_eq!(with_error(1.4893, 0.0334), "1.49 ± 0.03");
        assert_eq!(with_error(1.489_34, 0.000_42), "1.4893 ± 0.0004");
        assert_eq!(with_error(1.0, 0.0), "1.00 ± 0.00");
    }

    #[test]
    fn columns_line_up_by_characters() {
        let rows = [vec!["σ²".to_owned(), "b".to_owned()], vec!["1".to_owned(), "22".to_owned()]];
        assert_eq!(columns(Align::Right, &rows), "  σ²   b\n   1  22\n");
        assert_eq!(columns(Align::Left, &rows), "  σ²  b\n  1   22\n");
    }
}
