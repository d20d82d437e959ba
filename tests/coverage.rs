//! Whether intervals hold what they promise: how often nominal 95 % intervals of variances and
//! of p contain the true value.
//!
//! The true variance is the closed form's. The true p is what the same estimator, with the
//! weights of the same run, makes of the closed form's variances. A row whose trials were all
//! alike claims no interval; the share of such rows is counted apart.

use rayon::prelude::*;
use stratcore::fit::exponent_of;
use stratcore::integrand::{Integrand, by_name};
use stratcore::study::{
    Control, SamplerChoice, SamplerResult, StudyPlan, Tightness, study, study_until,
};

type Case = (&'static str, &'static str, &'static [(&'static str, f64)]);

/// Sampler, integrand, parameters.
const CASES: [Case; 18] = [
    ("random", "ramp", &[]),
    ("random", "gaussian", &[]),
    ("random", "half-space", &[]),
    ("random", "step", &[("edge", 0.3)]),
    ("random", "checkerboard", &[]),
    ("random", "disk", &[]),
    ("random", "disk", &[("radius", 0.15)]),
    ("random", "disk", &[("radius", 0.05)]),
    ("jittered", "ramp", &[]),
    ("jittered", "gaussian", &[]),
    ("jittered", "cosines", &[]),
    ("jittered", "half-space", &[]),
    ("jittered", "step", &[("edge", 0.3)]),
    ("jittered", "checkerboard", &[]),
    ("jittered", "half-space", &[("offset", 0.0707)]),
    ("jittered", "disk", &[]),
    ("jittered", "disk", &[("radius", 0.15)]),
    ("jittered", "disk", &[("radius", 0.05)]),
];

fn integrand(case: Case) -> Box<dyn Integrand> {
    let params: Vec<_> = case.2.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    by_name(case.1, None, &params).unwrap()
}

fn plan(case: Case, last: u64, n_trials: u32, seed: u64) -> StudyPlan {
    StudyPlan {
        samplers: vec![SamplerChoice::named(case.0).unwrap()],
        counts: (1..=last).map(|k| k * k).collect(),
        n_trials,
        seed,
        ..StudyPlan::paper()
    }
}

/// Hits and tries.
#[derive(Debug, Default, Clone, Copy)]
struct Count {
    hits: u32,
    tries: u32,
}

impl Count {
    fn add(&mut self, hit: bool) {
        self.hits += u32::from(hit);
        self.tries += 1;
    }

    fn percent(self) -> f64 {
        100.0 * f64::from(self.hits) / f64::from(self.tries)
    }
}

/// What came of the repeats of one case.
#[derive(Debug, Default)]
struct Coverage {
    /// Variance intervals, per N.
    rows: Vec<Count>,
    /// Rows without a variance where the truth has one.
    missed: Count,
    exponent: Count,
    /// (p̂ - p)/se.
    scores: Vec<f64>,
}

impl Coverage {
    fn of(f: &dyn Integrand, sampler: &str, results: &[SamplerResult]) -> Self {
        let counts: Vec<_> = results[0].rows.iter().map(|row| row.n_used).collect();
        let exact: Vec<_> = counts.iter().map(|n| f.exact_variance(sampler, *n).unwrap()).collect();
        let mut found = Self { rows: vec![Count::default(); exact.len()], ..Self::default() };
        for result in results {
            for ((row, exact), count) in result.rows.iter().zip(&exact).zip(&mut found.rows) {
                // An edge on the grid is exact there, and measured so.
                if *exact < 1e-25 {
                    continue;
                }
                found.missed.add(row.variance_of_mean == 0.0);
                if row.variance_of_mean > 0.0 {
                    let [lo, hi] = row.ci95();
                    let slack = 1e-9 * exact;
                    count.add((lo - slack..=hi + slack).contains(exact));
                }
            }
            let rows = result.weighted_rows();
            let truth: Vec<_> = rows
                .iter()
                .map(|row| exact[counts.iter().position(|n| *n == row.n).unwrap()])
                .collect();
            if let Some((fit, p)) = result.fit.zip(exponent_of(&rows, &truth)) {
                found.exponent.add((fit.ci95[0]..=fit.ci95[1]).contains(&p));
                found.scores.push((fit.exponent - p) / fit.std_error);
            }
        }
        found
    }

    fn variance(&self) -> Count {
        self.rows.iter().fold(Count::default(), |sum, row| Count {
            hits: sum.hits + row.hits,
            tries: sum.tries + row.tries,
        })
    }

    fn worst_row(&self) -> (usize, f64) {
        let seen = self.rows.iter().enumerate().filter(|(_, row)| row.tries > 0);
        let all = seen.map(|(i, row)| (i + 1, row.percent()));
        all.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
    }
}

fn repeat(case: Case, last: u64, n_trials: u32, repeats: u64) -> Coverage {
    let f = integrand(case);
    let results: Vec<_> = (0..repeats)
        .into_par_iter()
        .map(|seed| {
            let plan = plan(case, last, n_trials, seed);
            study(&*f, [0, 0], &plan, Control::unwatched()).unwrap().samplers.remove(0)
        })
        .collect();
    Coverage::of(&*f, case.0, &results)
}

fn name(case: Case) -> String {
    let params: Vec<_> = case.2.iter().map(|(name, value)| format!(" {name} {value}")).collect();
    format!("{} {}{}", case.0, case.1, params.concat())
}

/// What no interval made of so few trials can know: a disk of 0.8 % of the area that most
/// studies of few trials miss at small N, and edges whose rows of few trials are a handful of
/// discrete values. METHOD.md shows the numbers.
fn is_extreme(case: Case, n_trials: u32) -> bool {
    match case.2 {
        [("radius", 0.05)] => n_trials <= 50,
        [("radius", 0.15)] | [("edge", _)] => n_trials <= 10,
        _ => false,
    }
}

/// The short form: M = 10 and 50, N = 1 to 36, 600 repeats. The sd of a coverage of 95 % over
/// 600 repeats is 0.9 %; 93 to 97 % are asked for with 4 of them (1 false alarm in 16,000, for
/// some 60 numbers 1 in 250). The rows of one study are independent, so the variance's
/// coverage over 6 of them is known better.
#[test]
fn intervals_cover_as_they_promise() {
    const REPEATS: u64 = 600;
    let allowed = 2.0 + 4.0 * (95.0 * 5.0 / REPEATS as f64).sqrt();
    for n_trials in [10, 50] {
        for case in CASES.into_iter().filter(|case| !is_extreme(*case, n_trials)) {
            let found = repeat(case, 6, n_trials, REPEATS);
            for (what, count) in [("variance", found.variance()), ("p", found.exponent)] {
                let percent = count.percent();
                let case = name(case);
                assert!(
                    (percent - 95.0).abs() < allowed,
                    "{case}, M = {n_trials}: {what} {percent}"
                );
            }
        }
    }
}

/// The long form, N = 1 to 100 and 2,000 repeats:
///
///     cargo test --test coverage -- --ignored --nocapture every_case
///
/// prints METHOD.md's table and holds every case that is not extreme to 93 to 97 %, with 3 sd
/// of 0.49 %: 1 false alarm in 370 a number.
#[test]
#[ignore = "minutes of work; prints the table of METHOD.md"]
fn every_case_at_every_number_of_trials() {
    const REPEATS: u64 = 2000;
    let allowed = 2.0 + 3.0 * (95.0 * 5.0 / REPEATS as f64).sqrt();
    let mut faults = Vec::new();
    eprintln!(
        "| sampler, integrand | M | variance, % | worst N | missed, % | p, % | (p - true)/se |"
    );
    eprintln!("| --- | --- | --- | --- | --- | --- | --- |");
    for n_trials in [10, 50, 1000] {
        for case in CASES {
            let found = repeat(case, 10, n_trials, REPEATS);
            let (variance, exponent) = (found.variance().percent(), found.exponent.percent());
            let (k, worst) = found.worst_row();
            let mean = found.scores.iter().sum::<f64>() / found.scores.len() as f64;
            eprintln!(
                "| {} | {n_trials} | {variance:.1} | {worst:.1} at {} | {:.1} | {exponent:.1} | {mean:+.2} |",
                name(case),
                k * k,
                found.missed.percent(),
            );
            for (what, percent) in [("variance", variance), ("p", exponent)] {
                if !is_extreme(case, n_trials) && (percent - 95.0).abs() > allowed {
                    faults.push(format!("{}, M = {n_trials}: {what} {percent}", name(case)));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{faults:?}");
}

/// Stopping when sure: 400 studies that stop by themselves, per case and target. The sd of a
/// coverage is 1.1 %; 93 to 97 % are asked for with 4 of them.
#[test]
fn studies_that_stop_when_sure_still_cover() {
    const REPEATS: u64 = 400;
    let allowed = 2.0 + 4.0 * (95.0 * 5.0 / REPEATS as f64).sqrt();
    let calm = [CASES[0], CASES[2], CASES[6], CASES[9], CASES[11], CASES[14], CASES[15]];
    for until in [Tightness::Exponent(0.12), Tightness::Variance(0.3)] {
        for case in calm {
            let f = integrand(case);
            let results: Vec<_> = (0..REPEATS)
                .into_par_iter()
                .map(|seed| {
                    let plan = plan(case, 5, 5000, 7000 + seed);
                    let control = Control::unwatched();
                    let (result, _) =
                        study_until(&*f, [0, 0], &plan, until, control, &mut |_| {}).unwrap();
                    (result.trials, result)
                })
                .collect();
            let trials = results.iter().map(|(m, _)| f64::from(*m)).sum::<f64>() / REPEATS as f64;
            let samplers: Vec<_> =
                results.into_iter().map(|(_, mut r)| r.samplers.remove(0)).collect();
            let found = Coverage::of(&*f, case.0, &samplers);
            let percent = match until {
                Tightness::Exponent(_) => found.exponent.percent(),
                Tightness::Variance(_) => found.variance().percent(),
            };
            eprintln!("{until:?} {}: {percent:.1} % after {trials:.0} trials", name(case));
            assert!((percent - 95.0).abs() < allowed, "{until:?} {}: {percent}", name(case));
        }
    }
}
