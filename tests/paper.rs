//! The paper's numbers, small: the exponents of pixels whose exact variances can be worked out,
//! the form factor, and the whole report on a tiny lattice.
//!
//! Measured exponents are held against what the *exact* variances at the same N fit to, not
//! against 2, 3/2 and 1: at finite N the two differ.

use serde_json::Value;
use std::path::Path;
use std::process::Command;
use stratcore::fit::paper_fit;
use stratcore::integrand;
use stratcore::scene::{self, Channel};
use stratcore::study::{Control, SamplerChoice, StudyPlan, study};
use stratcore::theory::Class;
use stratcore::trace::TracedScene;
use stratcore::variance::Spread;

/// The exponent that exact variances fit to.
fn exact_exponent(rows: impl Iterator<Item = (u64, f64)>) -> f64 {
    let rows: Vec<_> = rows
        .map(|(n, variance_of_mean)| (n, Spread { grand_mean: 0.0, variance_of_mean, var_ln: 1.0 }))
        .collect();
    paper_fit(rows.iter().map(|(n, spread)| (*n, spread))).unwrap().exponent
}

/// Studies a pixel of `edges` with 200 trials: `random` must have p = 1 and `jittered` the
/// `expected` one, each within 4 of the fit's standard errors (one false alarm in 16,000).
fn check_pixel(scene: &TracedScene, pixel: [u32; 2], expected: f64, class: Class) {
    let plan = StudyPlan { n_trials: 200, ..StudyPlan::paper() };
    let integrand = scene.pixel(pixel, Channel::Luminance);
    let result = study(&integrand, pixel, &plan, Control::unwatched()).unwrap();
    for (sampler, expected) in result.samplers.iter().zip([1.0, expected]) {
        let fit = sampler.paper_fit.unwrap();
        let z = (fit.exponent - expected) / fit.std_error;
        assert!(
            z.abs() < 4.0,
            "{pixel:?} {}: p = {} ± {}, expected {expected}",
            sampler.name,
            fit.exponent,
            fit.std_error
        );
    }
    assert_eq!(result.samplers[1].class, Some(class));
}

/// k × k strata of the unit square with a function that is 0 or 1: the variance of the mean is
/// Σ q (1 - q) / N², q the share of a stratum where it is 1.
fn two_valued(share: impl Fn(usize, usize, usize) -> f64) -> impl Iterator<Item = (u64, f64)> {
    (1..=16usize).map(move |k| {
        let cells = (0..k * k).map(|i| share(k, i % k, i / k));
        let n = (k * k) as f64;
        ((k * k) as u64, cells.map(|q| q * (1.0 - q)).sum::<f64>() / (n * n))
    })
}

#[test]
fn a_smooth_an_edge_and_a_complex_pixel_converge_as_their_exact_variances() {
    let scene = TracedScene::new(scene::load("edges").unwrap());

    // On a leaning panel: linear across the pixel to a part in a hundred, so exactly N^-2.
    check_pixel(&scene, [100, 230], 2.0, Class::Smooth);

    // An edge through (216, 24), turned by 5.5/32 of a full turn. The share of a stratum on one
    // side of the line, averaged over 400 columns of it.
    let (sin, cos) = (5.5f64 / 32.0 * std::f64::consts::TAU).sin_cos();
    let pixel = [217u32, 21];
    let below = |k: usize, i: usize, j: usize| {
        const COLUMNS: u32 = 400;
        let size = 1.0 / k as f64;
        let covered = |column: u32| {
            let within = (f64::from(column) + 0.5) / f64::from(COLUMNS);
            let x = f64::from(pixel[0]) - 216.0 + (i as f64 + within) * size;
            let y = -x * sin / cos - (f64::from(pixel[1]) - 24.0);
            ((y - j as f64 * size) / size).clamp(0.0, 1.0)
        };
        (0..COLUMNS).map(covered).sum::<f64>() / f64::from(COLUMNS)
    };
    let edge = exact_exponent(two_valued(below));
    assert!((edge - 1.5).abs() < 0.1, "{edge}");
    check_pixel(&scene, pixel, edge, Class::Edge);

    // A checkerboard of 6.3 squares to the pixel that starts at (224, 96).
    let pixel = [240u32, 110];
    let wave = |from: f64, to: f64| {
        // Mean of ±1, alternating at every whole number, by its integral: a triangle wave.
        let integral = |x: f64| 1.0 - (x.rem_euclid(2.0) - 1.0).abs();
        (integral(to) - integral(from)) / (to - from)
    };
    let white = |k: usize, i: usize, j: usize| {
        let mean = |at: u32, start: u32, i: usize| {
            let square = |i: usize| 6.3 * (f64::from(at - start) + i as f64 / k as f64);
            wave(square(i), square(i + 1))
        };
        (1.0 + mean(pixel[0], 224, i) * mean(pixel[1], 96, j)) / 2.0
    };
    let complex = exact_exponent(two_valued(white));
    assert!((1.0..1.25).contains(&complex), "{complex}");
    check_pixel(&scene, pixel, complex, Class::Complex);
}

/// Twelve runs of the paper's protocol. Their mean must agree with what the exact variances fit
/// to within four standard errors (one false alarm in 16,000), and the paper's value must lie
/// within 2.6 times the scatter of one run (one in 100). The scatters are those of 150 runs of
/// an independent program; ln s² of 50 trials is low by 1/49 at every N alike, which leaves p as
/// it is.
#[test]
fn the_form_factor_converges_as_in_the_paper() {
    const RUNS: u32 = 12;
    let counts: Vec<u64> = (1..=10u64).map(|k| k.pow(4)).collect();
    let cases = [
        (vec![], [(1.430, 0.024), (1.501, 0.035)]),
        (vec![("occluder".to_owned(), 0.5)], [(1.233, 0.018), (1.245, 0.034)]),
    ];
    for (params, paper) in cases {
        let integrand = integrand::by_name("form-factor", None, &params).unwrap();
        let reference = integrand.reference().unwrap().mean;
        let mut exponents = [Vec::new(), Vec::new()];
        let mut estimates = Vec::new();
        for run in 0..RUNS {
            let plan = StudyPlan {
                samplers: vec![SamplerChoice::named("jittered").unwrap()],
                counts: counts.clone(),
                seed: 1996 + u64::from(run),
                ..StudyPlan::paper()
            };
            let result = study(&*integrand, [0, 0], &plan, Control::unwatched()).unwrap();
            let jittered = &result.samplers[0];
            exponents[0].push(jittered.paper_fit.unwrap().exponent);
            exponents[1].push(jittered.paper_fit_without_first.unwrap().exponent);
            let last = jittered.rows.last().unwrap();
            estimates.push((last.grand_mean, last.variance_of_mean / f64::from(plan.n_trials)));
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        for (skip, (paper, scatter)) in paper.into_iter().enumerate() {
            let ours = mean(&exponents[skip]);
            let exact = counts.iter().skip(skip);
            let exact = exact_exponent(
                exact.map(|&n| (n, integrand.exact_variance("jittered", n).unwrap())),
            );
            let error = scatter / f64::from(RUNS).sqrt();
            assert!((ours - exact).abs() < 4.0 * error, "{params:?}: {ours}, exactly {exact}");
            assert!((paper - ours).abs() < 2.6 * scatter, "{params:?}: {ours}, paper {paper}");
        }
        let estimate = mean(&estimates.iter().map(|e| e.0).collect::<Vec<_>>());
        let variance = mean(&estimates.iter().map(|e| e.1).collect::<Vec<_>>());
        let error = (variance / f64::from(RUNS)).sqrt();
        assert!((estimate - reference).abs() < 4.0 * error, "{params:?}: {estimate} {reference}");
    }
}

fn number(summary: &Value, pointer: &str) -> f64 {
    let value = summary.pointer(pointer).and_then(Value::as_f64);
    value.unwrap_or_else(|| panic!("{pointer} of summary.json is no number"))
}

#[test]
fn reproduce_writes_every_figure_number_and_a_page_that_stands_alone() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("new/folder");
    let run = Command::new(env!("CARGO_BIN_EXE_stratcli"))
        .args(["reproduce", "--lattice", "6", "--repeats", "3", "--json", "--out"])
        .arg(&out)
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&run.stderr);
    assert_eq!((run.status.code(), stderr.as_ref()), (Some(0), ""));

    let read = |name: &str| std::fs::read(out.join(name)).unwrap();
    let summary: Value = serde_json::from_slice(&read("summary.json")).unwrap();
    assert_eq!(summary, serde_json::from_slice::<Value>(&run.stdout).unwrap());
    assert_eq!(summary["complete"], true);
    for pointer in [
        "/schema",
        "/protocol/triangles",
        "/protocol/noise_of_p",
        "/pixels/studied",
        "/pixels/random/mean",
        "/pixels/random/std_error",
        "/pixels/random/std_deviation",
        "/pixels/jittered/mean",
        "/pixels/jittered/percentiles/2",
        "/pixels/classes/3/share",
        "/claims/rows/15/mean_ln_ratio",
        "/claims/beyond_one/looks_worse",
        "/claims/beyond_one/expected_false_alarms",
        "/claims/gains/0/quartiles/15/1",
        "/close_ups/0/exponent",
        "/close_ups/1/std_error",
        "/form_factor/estimate",
        "/form_factor/analytic",
        "/form_factor/z",
        "/form_factor/cases/0/mean/0",
        "/form_factor/cases/0/mean/1",
        "/form_factor/cases/4/std_error/1",
        "/form_factor/cases/4/scatter/0",
        "/form_factor/cases/4/exact/1",
    ] {
        number(&summary, pointer);
    }
    assert_eq!(number(&summary, "/pixels/studied"), 36.0);
    assert_eq!(number(&summary, "/form_factor/repeats"), 3.0);
    assert_eq!(number(&summary, "/form_factor/cases/4/occluder"), 0.5);
    let histogram = summary.pointer("/pixels/jittered/histogram/bins").unwrap();
    let drawn: f64 = histogram.as_array().unwrap().iter().map(|n| n.as_f64().unwrap()).sum();
    let outside = number(&summary, "/pixels/jittered/histogram/outside");
    let apart = number(&summary, "/pixels/exact") + number(&summary, "/pixels/partly_exact");
    assert_eq!(drawn + outside + apart, 36.0);

    let page = String::from_utf8(read("report.html")).unwrap();
    for address in page.split("href=\"").skip(1).chain(page.split("src=\"").skip(1)) {
        assert!(address.starts_with("data:image/png;base64,"), "{}", &address[..40]);
    }
    for outside in ["http:", "https:", "file:", "url(", "@import"] {
        assert!(!page.contains(outside), "the page mentions {outside}");
    }
    let figures: Vec<_> =
        summary["figures"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    for name in [
        "fig1-picture",
        "fig2-random",
        "fig3-one-pixel",
        "fig4-jittered",
        "fig4-map",
        "fig5-close-ups",
        "form-factor",
        "form-factor-occluded",
        "form-factor-sides",
        "claims-gain",
    ] {
        assert!(figures.contains(&name), "{name} is not among {figures:?}");
    }
    for name in &figures {
        assert!(page.contains(&format!("id=\"{name}\"")), "{name} is not in the page");
        let svg = String::from_utf8(read(&format!("figures/{name}.svg"))).unwrap();
        assert!(svg.starts_with("<svg xmlns=") && svg.trim_end().ends_with("</svg>"));
        // Outside of the pictures' base 64, which may spell anything.
        let pieces = svg.split("base64,").enumerate();
        for (i, piece) in pieces {
            let drawn = if i == 0 { piece } else { piece.split_once('"').unwrap().1 };
            assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{name}: {drawn}");
        }
        let png = read(&format!("figures/{name}.png"));
        assert!(png.starts_with(b"\x89PNG\r\n\x1a\n") && png.len() > 5000, "{name}.png");
    }
    assert_eq!(files(&out.join("figures")), 2 * figures.len());
    assert_eq!(files(&out), 3);
}

#[test]
fn a_study_is_drawn_to_the_kind_of_file_that_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |name: &str| {
        let path = folder.path().join(name);
        let arguments = ["integrand", "ramp", "--counts", "1..4^2", "--quiet", "--plot"];
        let run = Command::new(env!("CARGO_BIN_EXE_stratcli")).args(arguments).arg(&path).output();
        (run.unwrap(), std::fs::read(path).unwrap_or_default())
    };
    let (run, svg) = draw("ramp.svg");
    assert!(run.status.success());
    assert!(String::from_utf8(svg).unwrap().contains("jittered p = "));
    let (run, png) = draw("ramp.PNG");
    assert!(run.status.success());
    assert!(png.starts_with(b"\x89PNG"));
    for name in ["ramp.pdf", "ramp", "absent/ramp.svg"] {
        let (run, _) = draw(name);
        let stderr = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(2), "{stderr}");
        assert!(stderr.contains(name) && stderr.lines().count() == 1, "{stderr}");
    }
    assert_eq!(files(folder.path()), 2);
}

/// Interrupted once the first figure is there: that figure stays, in a page that says what it
/// is. A million repeats of the form factor take hours on any machine.
#[cfg(unix)]
#[test]
fn what_was_finished_before_an_interrupt_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_stratcli"))
        .args(["reproduce", "--repeats", "1000000", "--out"])
        .arg(folder.path())
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let figure = folder.path().join("figures/fig1-picture.png");
    while !figure.exists() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("is not complete") && page.contains("id=\"fig1-picture\""));
    let summary = std::fs::read(folder.path().join("summary.json")).unwrap();
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    assert_eq!(summary["complete"], false);
    assert!(summary["pixels"].is_null());
}

fn files(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}
