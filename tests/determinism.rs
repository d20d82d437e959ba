//! Same seed, same bytes: for any number of threads, and for a pixel alone or in a picture.

use serde_json::Value;
use std::fs;
use std::process::Command;
use stratcore::scene::Channel;
use stratcore::study::{Control, StudyPlan, study, study_pixels, with_threads};
use stratcore::trace::TracedScene;

fn stratcli(arguments: &[&str]) -> Vec<u8> {
    let output = Command::new(env!("CARGO_BIN_EXE_stratcli")).args(arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}

/// As many threads as a small machine has cores, and more than any test machine has.
const THREADS: [&str; 2] = ["2", "7"];

const STUDIES: [&[&str]; 5] = [
    &["pixel", "classic", "--at", "100,140", "--trials", "10", "--json"],
    &["integrand", "form-factor", "--counts", "1..5^4", "--trials", "10", "--json"],
    &["integrand", "koch", "--counts", "3,70000", "--n-policy", "rect", "--trials", "3", "--json"],
    &["discrepancy", "--samplers", "jittered", "--counts", "4,16", "--trials", "20", "--json"],
    &["spectrum", "--samplers", "jittered", "-n", "16", "--trials", "10", "--json"],
];

#[test]
fn threads_change_no_byte() {
    for arguments in STUDIES {
        let with = |threads| stratcli(&[arguments, &["--threads", threads]].concat());
        let one = with("1");
        for threads in THREADS {
            assert_eq!(one, with(threads), "{arguments:?}, {threads} threads");
        }
        assert_eq!(one, stratcli(arguments), "{arguments:?}");
    }
}

/// Times differ from run to run; errors do not.
#[test]
fn threads_change_no_error_of_a_trade() {
    const TIMED: [&str; 6] =
        ["ns_per_sample", "generation_ns", "ns_per_estimate", "fused", "efficiency", "pareto"];
    let trade = ["trade", "gaussian", "--trials", "20", "--counts", "1..4^2", "--json"];
    let rows = |threads| {
        let text = stratcli(&[&trade[..], &["--threads", threads]].concat());
        let mut found: Value = serde_json::from_slice(&text).unwrap();
        for sampler in found["samplers"].as_array_mut().unwrap() {
            for row in sampler["rows"].as_array_mut().unwrap() {
                TIMED
                    .iter()
                    .for_each(|key| assert!(row.as_object_mut().unwrap().remove(*key).is_some()));
            }
        }
        found["samplers"].as_array().unwrap().iter().map(|s| s["rows"].clone()).collect::<Vec<_>>()
    };
    let one = rows("1");
    assert!(one.len() == 2 && one[1][3]["mse"].as_f64().unwrap() > 0.0, "{one:?}");
    THREADS.iter().for_each(|threads| assert_eq!(one, rows(threads), "{threads} threads"));
}

#[test]
fn the_seed_changes_them() {
    for arguments in STUDIES {
        let with = |seed| stratcli(&[arguments, &["--seed", seed]].concat());
        let default = stratcli(arguments);
        assert_eq!(default, with("1996"), "{arguments:?}");
        // Seeds that differ in their high half only are two seeds.
        assert_ne!(default, with("4294969292"), "{arguments:?}");
    }
}

#[test]
fn pictures_are_the_same_files() {
    let folder = tempfile::tempdir().unwrap();
    for extension in ["png", "exr"] {
        let render = |name: &str, more: &[&str]| {
            let path = folder.path().join(format!("{name}.{extension}"));
            let arguments = ["render", "classic", "--spp", "1", "-o", path.to_str().unwrap()];
            stratcli(&[&arguments, more].concat());
            fs::read(path).unwrap()
        };
        let one = render("one", &["--threads", "1"]);
        for threads in THREADS {
            assert!(one == render("more", &["--threads", threads]), "{extension}, {threads}");
        }
        assert!(one != render("other", &["--seed", "7"]), "{extension}");
    }
}

/// A pixel's study is the same alone, in a crop, in any order of pixels, on any threads.
#[test]
fn a_crop_equals_the_whole() {
    let scene = TracedScene::new(stratcore::scene::load("classic").unwrap());
    let integrand_of = |pixel| scene.pixel(pixel, Channel::Luminance);
    let plan = StudyPlan { counts: vec![1, 4, 9], n_trials: 5, ..StudyPlan::paper() };
    let study_all = |pixels: Vec<[u32; 2]>, threads| {
        let mut results = Vec::new();
        with_threads(Some(threads), || {
            let each = &mut |result| results.push(result);
            study_pixels(&integrand_of, pixels, &plan, Control::unwatched(), each).unwrap();
        });
        results
    };
    let region = |x: std::ops::Range<u32>, y: std::ops::Range<u32>| -> Vec<[u32; 2]> {
        y.flat_map(|y| x.clone().map(move |x| [x, y])).collect()
    };
    let whole = study_all(region(60..100, 120..160), 2);
    let crop = region(75..83, 131..140);
    let cropped = study_all(crop.iter().rev().copied().collect(), 1);
    assert_eq!(cropped.len(), crop.len());
    for result in cropped {
        let in_whole = whole.iter().find(|r| r.pixel == result.pixel);
        assert_eq!(in_whole, Some(&result));
        let alone =
            study(&integrand_of(result.pixel), result.pixel, &plan, Control::unwatched()).unwrap();
        assert_eq!(alone, result);
    }
    assert!(whole.windows(2).any(|pair| pair[0].samplers != pair[1].samplers));
}
