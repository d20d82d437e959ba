//! A trade as sentences and tables.

use crate::report::chart::label;
use crate::table::{Align, columns, number, short};
use stratcore::trade::{Choice, Quartiles, Reach, Target, TradeResult};

/// A table with its head first.
pub type Table = (String, Vec<Vec<String>>);

/// Nanoseconds in the unit that suits them.
pub fn time(ns: f64) -> String {
    match ns {
        _ if !ns.is_finite() => "-".to_owned(),
        _ if ns < 1e3 => format!("{} ns", number(ns, 3)),
        _ if ns < 1e6 => format!("{} µs", number(ns / 1e3, 3)),
        _ if ns < 1e9 => format!("{} ms", number(ns / 1e6, 3)),
        _ => format!("{} s", number(ns / 1e9, 3)),
    }
}

/// A target as it was asked for.
pub fn target(target: Target) -> String {
    match target {
        Target::Relative(share) => format!("{} %", short(100.0 * share, 4)),
        Target::Absolute(error) => short(error, 4),
    }
}

fn of(reach: &Reach) -> String {
    label(reach.name, reach.scramble)
}

/// Which sampler, how many samples, how long; where the choice changes; and whether fresh runs
/// agree.
pub fn recommendation(choice: &Choice, result: &TradeResult) -> String {
    let wanted = target(choice.target);
    if choice.error == 0.0 {
        return format!(
            "The mean is 0, and {wanted} of it too: name an error in the integrand's own unit, \
             such as --targets 0.004."
        );
    }
    let Some((best, n, ns)) = choice.best.and_then(|i| {
        let reach = &choice.reach[i];
        Some((reach, reach.n_safe?, reach.ns?))
    }) else {
        return format!(
            "No sampler is seen to reach an error of {wanted} within the measured N or on a line \
             beyond them; ask for a larger error, or measure larger N with --counts."
        );
    };
    let beyond = if best.extrapolated { ", beyond the measured N" } else { "" };
    let unit = if result.subjects == 1 { "an estimate" } else { "a pixel" };
    let mut text = format!(
        "For an error of {wanted} take {} with N = {n}{beyond}: {} {unit}.",
        of(best),
        time(ns.median)
    );
    for other in choice.reach.iter().filter(|reach| !std::ptr::eq(*reach, best)) {
        text += &match (other.n_safe, other.ns) {
            (Some(m), Some(other_ns)) => {
                let ratio = other_ns.median / ns.median;
                let tie = if overlap(other_ns, ns) { ", the same within the noise" } else { "" };
                format!(" {} needs N = {m} and {} times as long{tie}.", of(other), number(ratio, 2))
            }
            _ => format!(" {} does not reach it.", of(other)),
        };
    }
    if choice.reach.len() > 1 && !choice.by_eval_cost.is_empty() {
        let steps = choice.by_eval_cost.iter().map(|fastest| {
            let sampler = of(&choice.reach[fastest.sampler]);
            match fastest.from_ns {
                0.0 => sampler,
                from => format!("from {} per evaluation {sampler}", time(from)),
            }
        });
        let steps: Vec<_> = steps.collect();
        let range = if steps.len() == 1 { ", whatever an evaluation costs" } else { "" };
        text += &format!(
            " Where points are made apart, the fastest way is {}{range}.",
            steps.join(", ")
        );
    }
    if let Some(fresh) = choice.confirmation {
        text += &format!(
            " Of {} fresh runs (seed {}) {} % were within it.",
            fresh.runs,
            fresh.seed,
            number(100.0 * fresh.reached, 3)
        );
    }
    text
}

fn overlap(a: Quartiles, b: Quartiles) -> bool {
    a.lower <= b.upper && b.lower <= a.upper
}

/// One table per sampler, one per target.
pub fn tables(result: &TradeResult) -> Vec<Table> {
    let curves = result.samplers.iter().map(|sampler| {
        let head = [
            "N",
            "RMS error",
            "95 % interval",
            "95 of 100 within",
            "ns/sample",
            "points",
            "one estimate",
            "efficiency",
            "Pareto",
        ];
        let rows = sampler.rows.iter().map(|row| {
            let (error, time_of) = (&row.error, &row.time);
            let ns = |q: &Quartiles| {
                format!(
                    "{} ({} to {})",
                    number(q.median, 3),
                    number(q.lower, 3),
                    number(q.upper, 3)
                )
            };
            vec![
                error.n.to_string(),
                number(error.rmse, 4),
                error.mse_ci95.map(|e| number(e.sqrt(), 3)).join(" to "),
                number(error.error95, 3),
                ns(&time_of.ns_per_sample),
                number(time_of.generation_ns.median, 3),
                time(row.ns_per_estimate.median),
                row.efficiency.map_or("-".to_owned(), |e| format!("{e:.2e}")),
                if row.pareto { "*".to_owned() } else { String::new() },
            ]
        });
        let body = std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect();
        (label(sampler.name, sampler.scramble), body)
    });
    let choices = result.choices.iter().map(|choice| {
        let head = ["sampler", "N", "95 % interval", "N to take", "one estimate", "quartiles"];
        let rows = choice.reach.iter().map(|reach| {
            let count = |n: Option<f64>| n.map_or("-".to_owned(), |n| short(n.ceil(), 4));
            let mark = if reach.extrapolated { " (beyond)" } else { "" };
            vec![
                of(reach),
                count(reach.n),
                reach.n_ci95.map(count).join(" to "),
                reach.n_safe.map_or("-".to_owned(), |n| format!("{n}{mark}")),
                reach.ns.map_or("-".to_owned(), |ns| time(ns.median)),
                reach.ns.map_or("-".to_owned(), |ns| {
                    format!("{} to {}", time(ns.lower), time(ns.upper))
                }),
            ]
        });
        let body = std::iter::once(head.map(str::to_owned).to_vec()).chain(rows).collect();
        let title =
            format!("error {}, which is {}", target(choice.target), number(choice.error, 4));
        (title, body)
    });
    curves.chain(choices).collect()
}

/// What was measured and how.
pub fn method(result: &TradeResult, core: Option<usize>) -> String {
    let timing = &result.timing;
    let mut text = format!(
        "d = {}, M = {} trials, seed {}, mean {} ± {}; times of one thread, {}: median and \
         quartiles of {} measurements of each row, by turns, each of {} or more after a warm-up; \
         the clock's step is {}",
        result.dim,
        result.trials,
        result.seed,
        number(result.reference.mean, 6),
        number(result.reference.std_error, 2),
        core.map_or("not pinned".to_owned(), |core| format!("pinned to core {core}")),
        timing.rounds,
        time(timing.at_least),
        time(timing.clock_step),
    );
    if let Some(cost) = result.eval_cost {
        text += &format!("; one evaluation counts {}, with the points' own time", time(cost));
    }
    if result.samplers.iter().flat_map(|s| &s.rows).any(|row| row.time.fused) {
        text += "; pixels draw the points of some samplers as they go, so that time per sample may \
                 be less than that of points made apart";
    }
    text
}

/// Everything as text.
pub fn text(
    title: &str,
    result: &TradeResult,
    core: Option<usize>,
    recommendations: &[String],
) -> String {
    let mut text = format!("{title}\n{}\n", method(result, core));
    for (title, rows) in tables(result) {
        text += &format!("\n{title}\n{}", columns(Align::Right, &rows));
    }
    text.push('\n');
    for sentence in recommendations {
        text += &format!("{sentence}\n");
    }
    text
}
