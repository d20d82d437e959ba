//! The acceptance table: a cheap part of it by fixed seed, its rule, its files, its exit codes.
//!
//! The whole table, with verdicts to be read: `stratcli reproduce --literature`.

use serde_json::Value;
use std::collections::HashMap;
use std::fs;
use std::process::{Command, Output};
use stratcore::literature::{Effort, Measured, Verdict, by_id};
use stratcore::study::{Control, with_threads};

fn measure(id: &str) -> Measured {
    by_id(id).unwrap().measure(1996, Effort::Quick, Control::unwatched()).unwrap()
}

/// Exact constants at each N: linear, step, edge length, the fit's noise, scanlines, single
/// gains, the checkerboard, what a shift does to strata, and the interaction under every
/// construction. False alarms: some 40 rows at 1 in 2,150.
#[test]
fn exact_constants_hold() {
    for id in ["K2", "K3", "K4", "K6", "K7", "K10", "S1", "A1"] {
        for finding in measure(id).findings {
            assert_eq!(finding.verdict(), Verdict::Holds, "{id}: {finding:#?}");
        }
    }
}

/// The same rows with an expectation that is wrong by a tenth, or an exponent by as much.
#[test]
fn a_planted_wrong_expectation_fails() {
    for id in ["K2", "K7", "K10", "F1", "M4"] {
        for mut finding in measure(id).findings {
            let Some(expected) = finding.expected.filter(|e| *e > 0.0) else { continue };
            assert_eq!(finding.verdict(), Verdict::Holds, "{id}: {finding:#?}");
            finding.expected = Some(1.15 * expected);
            // Rows of closed forms alone, without noise, and those with noise alike.
            assert_eq!(finding.verdict(), Verdict::Fails, "{id}: {finding:#?}");
        }
    }
    // One N out of line is enough, though the mean over all agrees.
    let mut finding = measure("K3").findings.remove(1);
    finding.checks[2].ratio += 10.0 * finding.checks[2].std_error;
    assert_eq!(finding.verdict(), Verdict::Fails);
}

#[test]
fn no_number_depends_on_the_threads_or_on_other_claims() {
    for id in ["K7", "F1"] {
        let [one, two] = [1, 2].map(|threads| with_threads(Some(threads), || measure(id)));
        assert_eq!(one, two, "{id}");
    }
    let other = by_id("K7").unwrap().measure(7, Effort::Quick, Control::unwatched()).unwrap();
    assert_ne!(measure("K7").findings, other.findings);
}

fn stratcli(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stratcli")).args(arguments).output().unwrap()
}

#[test]
fn the_command_leaves_a_page_a_csv_and_a_json() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_str().unwrap();
    fs::write(folder.path().join("report.html"), "<main><footer></footer></main>").unwrap();
    let arguments =
        ["reproduce", "--literature", "--quick", "--claims", "k7,O3,F1", "--out", out, "--json"];
    let run = stratcli(&arguments);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let printed: Value = serde_json::from_slice(&run.stdout).unwrap();
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(serde_json::from_str::<Value>(&read("literature.json")).unwrap(), printed);
    assert_eq!((&printed["complete"], &printed["schema"]), (&true.into(), &1.into()));
    let rows: Vec<&Value> = printed["claims"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|claim| claim["findings"].as_array().unwrap())
        .collect();
    let mut tally = HashMap::new();
    for row in &rows {
        *tally.entry(row["verdict"].as_str().unwrap()).or_insert(0) += 1;
    }
    assert_eq!(tally, HashMap::from([("holds", 8), ("not-measured", 1)]));
    assert_eq!(printed["tally"]["holds"], 8);
    assert_eq!(read("literature.csv").lines().count(), 1 + rows.len());
    let page = read("literature.html");
    for id in ["K7", "O3", "F1"] {
        assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
    }
    assert!(page.contains("<svg") && !page.contains("http://") && !page.contains("<script"));
    assert!(read("figures/edges-error.svg").starts_with("<svg"));
    // The report of the paper that lies there has its link, once.
    assert_eq!(read("report.html").matches("literature.html").count(), 1);
    assert_eq!(stratcli(&arguments).status.code(), Some(0));
    assert_eq!(read("report.html").matches("literature.html").count(), 1);
}

#[test]
fn what_cannot_be_measured_is_refused_in_words() {
    for (arguments, words) in [
        (&["--literature", "--claims", "K99"][..], "no claim is called \"K99\"; there are K1"),
        (&["--literature", "--lattice", "8"], "--lattice"),
        (&["--claims", "K1"], "--literature"),
    ] {
        let run = stratcli(&[&["reproduce"], arguments].concat());
        let error = String::from_utf8(run.stderr).unwrap();
        assert_eq!((run.status.code(), run.stdout.len()), (Some(2), 0), "{error}");
        assert!(error.contains(words) && error.trim().lines().count() == 1, "{error}");
    }
}
