//! Discrepancies, spectra and point sets as a user meets them, against other implementations and
//! closed forms; and every wrong use in one clear line.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;
use stratcore::discrepancy::{centred_sq, l2_star_sq, mixture_sq, wrap_around_sq};
use stratcore::rng::StreamKey;
use stratcore::sampler::{PointFile, PointSet, whole_set};
use stratcore::study::SamplerChoice;

struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn stratcli(arguments: &str) -> Run {
    let output = Command::new(env!("CARGO_BIN_EXE_stratcli"))
        .args(arguments.split_whitespace())
        .output()
        .unwrap();
    Run {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

fn done(arguments: &str) -> String {
    let run = stratcli(arguments);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{arguments}");
    run.stdout
}

fn json(arguments: &str) -> Value {
    let document: Value = serde_json::from_str(&done(&format!("{arguments} --json"))).unwrap();
    assert_eq!(document["schema"], 1);
    document
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// SciPy's `discrepancy`, which gives squares but for L2-star: see
/// contrib/reference/scipy_discrepancy.py.
#[test]
fn agrees_with_scipy() {
    let reference = include_str!("reference/scipy_discrepancy.csv");
    let mut rows = 0;
    for line in reference.lines().skip(1) {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let (n, dim) = (cells[0] as u64, cells[1] as u64);
        let coordinate = |i: u64, a: u64| ((i + 1) * (a + 1) * 40_503 + 7919 * i * i) % 65_536;
        let points: Vec<f64> = (0..n)
            .flat_map(|i| (0..dim).map(move |a| coordinate(i, a) as f64 / 65_536.0))
            .collect();
        let dim = dim as usize;
        let ours = [
            centred_sq(&points, dim),
            wrap_around_sq(&points, dim),
            mixture_sq(&points, dim),
            l2_star_sq(&points, dim).sqrt(),
        ];
        for (ours, theirs) in ours.iter().zip(&cells[2..]) {
            assert!((ours - theirs).abs() < 1e-12, "{n} {dim}: {ours} {theirs}");
        }
        rows += 1;
    }
    assert_eq!(rows, 8);
}

/// The mean square over edges has a closed form for both of the paper's samplers, c/4N and
/// c/4N^(3/2) with c = 0.5214: each mean within five of its standard errors, 10^-6 each. Its root
/// falls as N^-1/2 and N^-3/4; fitted exponents scatter by 0.005, five of which are the bound.
#[test]
fn edges_in_the_mean_fall_by_known_rates() {
    const C: f64 = 0.521_405_433_164_720_7;
    let found = json("discrepancy --measure edge-l2 --counts 4..16^2 --trials 100");
    for (curve, p) in [(0, 0.5), (1, 0.75)] {
        let curve = &found["curves"][curve];
        for row in curve["rows"].as_array().unwrap() {
            let expected = C / 4.0 * number(&row["n"]).powf(-2.0 * p);
            let off = (number(&row["mean_sq"]) - expected) / number(&row["std_error_sq"]);
            assert!(off.abs() < 5.0, "{curve}: {row} is {off} errors off");
        }
        let exponent = number(&curve["fit"]["exponent"]);
        assert!((exponent - p).abs() < 0.025, "{exponent}");
    }
}

/// The worst edge: N^-1/2 for random points; for jittered ones between N^-3/4 and √log N times
/// that (Beck & Chen 1987). Between 64 and 1024 points the exponent is 0.66 as it stands, and 0.76
/// once √ln N is divided out. Eight sets know it to 0.015, and random's to 0.05: five of these.
#[test]
fn the_worst_edge_falls_by_the_papers_rates() {
    let found = json("discrepancy --counts 64,1024 --trials 8");
    let exponent = |curve: usize, correction: fn(f64) -> f64| {
        let rows = found["curves"][curve]["rows"].as_array().unwrap();
        let corrected: Vec<_> =
            rows.iter().map(|r| number(&r["mean"]) / correction(number(&r["n"]))).collect();
        (corrected[0] / corrected[1]).ln() / 16f64.ln()
    };
    let random = exponent(0, |_| 1.0);
    assert!((random - 0.5).abs() < 0.25, "{random}");
    let jittered = exponent(1, |n| n.ln().sqrt());
    assert!((jittered - 0.75).abs() < 0.075, "{jittered}");
    assert!(random + 0.05 < exponent(1, |_| 1.0));
}

#[test]
fn threads_change_no_bit() {
    let with = |threads: u32| {
        let command = "--counts 4,9 --trials 9 --measure edge,star,mixture";
        done(&format!("discrepancy {command} --json --threads {threads}"))
    };
    assert_eq!(with(1), with(3));
}

/// What is written reads back as the same numbers, each set as itself.
#[test]
fn point_sets_survive_their_files() {
    let folder = tempfile::tempdir().unwrap();
    let sets = "--sampler sobol+owen -n 16 -d 3 --trial 2 --sets 3";
    let document = json(&format!("points {sets}"));
    assert_eq!((&document["scramble"], &document["n_used"]), (&"owen".into(), &16.into()));
    let coordinates = |set: &Value| -> Vec<f64> {
        set.as_array().unwrap().iter().flat_map(|p| p.as_array().unwrap()).map(number).collect()
    };
    let SamplerChoice { sampler, scramble } = SamplerChoice::named("sobol+owen").unwrap();
    let draw = |trial| {
        let stream = sampler.stream_id();
        let key = StreamKey { seed: 1996, pixel: [0, 0], sampler: stream, n_samples: 16, trial };
        whole_set(sampler, &PointSet { key, dim: 3, scramble, rectangular: false }).unwrap()
    };
    let drawn = [2, 3, 4].map(draw);
    assert!(drawn[0] != drawn[1] && drawn[1] != drawn[2]);
    // The reader of JSON here is not exact in the last bit.
    let close = |ours: &[f64], theirs: &[f64]| {
        ours.len() == theirs.len() && ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() < 1e-15)
    };
    for (ours, theirs) in drawn.iter().zip(document["sets"].as_array().unwrap()) {
        assert!(close(ours, &coordinates(theirs)));
    }
    for format in ["csv", "utk"] {
        let path = folder.path().join(format);
        let path = path.to_str().unwrap();
        assert_eq!(done(&format!("points {sets} --format {format} -o {path}")), "");
        let text = fs::read_to_string(path).unwrap();
        assert_eq!(text.lines().filter(|line| *line == "#").count(), 2);
        assert_eq!(text.starts_with("x0,x1,x2\n"), format == "csv");
        let file = PointFile::load(path).unwrap();
        assert_eq!(file.sets().collect::<Vec<_>>(), drawn.iter().collect::<Vec<_>>(), "{format}");
        // And as a sampler: trial t is set t.
        let again =
            done(&format!("points --sampler file:{path} -n 16 -d 3 --trial 1 --format utk"));
        let again: Vec<f64> = again.split_whitespace().map(|word| word.parse().unwrap()).collect();
        assert_eq!(again, drawn[1]);
    }
}

#[test]
fn a_set_depends_on_its_trial_alone() {
    let two = done("points --sampler jittered -n 9 --sets 2 --quiet");
    let second = done("points --sampler jittered -n 9 --trial 1 --quiet");
    assert_eq!(two.split_once("#\n").unwrap().1, second.split_once('\n').unwrap().1);
}

#[test]
fn a_file_is_measured_set_by_set() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.csv");
    fs::write(&path, "0.5,0.5\n#\n0.25,0.25\n#\n0.1,0.2\n0.7,0.6\n").unwrap();
    let path = path.to_str().unwrap();
    let rows = json(&format!("discrepancy {path}"))["curves"][0]["rows"].clone();
    // One point: 1/2 in the middle, 1 - 2/16 in a quarter's middle.
    assert_eq!((&rows[0]["n"], &rows[0]["trials"]), (&1.into(), &2.into()));
    assert!((number(&rows[0]["mean"]) - 0.5 * (0.5 + 0.875)).abs() < 1e-15);
    assert_eq!((&rows[1]["n"], &rows[1]["trials"]), (&2.into(), &1.into()));
    assert!(rows[1]["std_error"].is_null() && rows[1]["mean_sq"].is_null());
    let spectrum = json(&format!("spectrum {path} --cutoff 4"));
    assert_eq!((&spectrum["n"], &spectrum["samplers"][0]["trials"]), (&1.into(), &2.into()));
    // One point has power 1 everywhere.
    for ring in spectrum["samplers"][0]["rings"].as_array().unwrap() {
        assert!((number(&ring["power"]) - 1.0).abs() < 1e-12, "{ring}");
    }
}

/// A deterministic set has a discrepancy, but neither an error nor an exponent.
#[test]
fn one_set_has_no_error() {
    let found = json("discrepancy --samplers sobol --scramble none --counts 4,16 --dim 3");
    let curve = &found["curves"][0];
    assert_eq!((&curve["measure"], &curve["scramble"]), (&"centred".into(), &"none".into()));
    assert!(curve["fit"].is_null());
    for row in curve["rows"].as_array().unwrap() {
        assert!(row["trials"] == 1 && row["std_error"].is_null(), "{row}");
    }
}

#[test]
fn every_file_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for (arguments, files) in [
        (
            "discrepancy --counts 4,9 --trials 3 --measure edge,l2-star --plot d.svg --csv d.csv",
            &["d.svg", "d.csv"][..],
        ),
        (
            "spectrum --samplers jittered -n 16 --trials 3 --plot s.png --csv s.csv -o s.exr",
            &["s.png", "s.csv", "s.exr"],
        ),
        ("spectrum --samplers random -n 16 --trials 3 -o t.png", &["t.png"]),
        ("points --sampler jittered -n 16 --plot p.svg -o p.csv", &["p.svg", "p.csv"]),
    ] {
        let placed: Vec<_> = arguments
            .split(' ')
            .map(|word| if files.contains(&word) { at(word) } else { word.to_owned() })
            .collect();
        done(&placed.join(" "));
        for file in files {
            let bytes = fs::read(at(file)).unwrap();
            let magic: &[u8] = match file.rsplit_once('.').unwrap().1 {
                "svg" => b"<svg",
                "png" => b"\x89PNG",
                "exr" => &[0x76, 0x2f, 0x31, 0x01],
                _ => b"",
            };
            assert!(bytes.starts_with(magic) && bytes.len() > 100, "{file}");
        }
    }
    let csv = fs::read_to_string(at("d.csv")).unwrap();
    let cells: Vec<Vec<_>> = csv.lines().map(|line| line.split(',').collect()).collect();
    // Two samplers, two measures, two counts, and the names.
    assert_eq!(cells.len(), 1 + 8);
    assert!(cells.iter().all(|row| row.len() == 12));
    assert_eq!((cells[1][7], cells[1][10], cells[3][7]), ("edge", "", "l2-star"));
    let svg = fs::read_to_string(at("d.svg")).unwrap();
    for words in ["edge: ", "l2-star: ", "Beck", "jittered p = "] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}

#[test]
fn a_picture_takes_any_sampler_and_its_error_has_a_spectrum() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("quad.obj", "v -1 -1 0\nv 0.3 -1 0\nv 0.3 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n");
    write(
        "quad.toml",
        "[camera]\neye = [0.0, 0.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\nfov_y = 45.0\n\
         resolution = [8, 6]\n[[mesh]]\npath = \"quad.obj\"\n",
    );
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let picture = |sampler: &str| {
        let out = at("out.exr");
        let run = done(&format!("render {} --spp 4 --sampler {sampler} -o {out}", at("quad.toml")));
        assert!(run.contains(sampler.split('+').next().unwrap()), "{run}");
        fs::read(out).unwrap()
    };
    assert_ne!(picture("jittered"), picture("sobol+owen"));

    let found = json(&format!(
        "spectrum {} --samplers random,jittered --spp 4 --reference-spp 256 --trials 3",
        at("quad.toml")
    ));
    assert_eq!((&found["scene"], &found["unit"]), (&"quad".into(), &"cycles per pixel".into()));
    let mse = |i: usize| number(&found["samplers"][i]["mse"]);
    assert!(mse(0) > mse(1) && mse(1) > 0.0);
    assert!(!found["samplers"][1]["rings"].as_array().unwrap().is_empty());
}

/// Every wrong use is one line that names the input, the fault and the way out.
#[test]
fn each_wrong_use_is_one_clear_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("p.csv");
    fs::write(&file, "0.5,0.5\n").unwrap();
    let file = file.to_str().unwrap();
    let file_and_counts = format!("discrepancy {file} --counts 4");
    let file_and_samplers = format!("spectrum {file} --samplers random");
    let file_and_n = format!("spectrum {file} -n 4");
    let table: &[(&str, &[&str])] = &[
        ("points --sampler jitterd -n 4", &["jitterd", "random, jittered", "file:PATH"]),
        ("points --sampler jittered -n 5", &["jittered", "N = 5", "4 and 9", "--n-policy"]),
        ("points --sampler annealed -n 16 -d 3", &["annealed", "2 dimensions", "3"]),
        ("points --sampler random -n 0", &["-n 0", "at least 1"]),
        ("points --sampler random -n 4 -d 0", &["--dim 0", "at least 1"]),
        ("points --sampler random -n 4 --sets 0", &["--sets", "0"]),
        ("points --sampler random -n 99999999999", &["99999999999", "fewer"]),
        ("points --sampler random -n 4 --scramble owen", &["owen", "none, torus-shift"]),
        ("points --sampler random -n 4 --scramble ovens", &["--scramble", "ovens", "owen-hash"]),
        (
            "points --sampler sobol+none -n 4 --sets 2",
            &["sobol", "1 different sets", "torus-shift"],
        ),
        ("points --sampler random -n 4 --plot p.svg --axes 0,2", &["--axes 0,2", "from 0 to 1"]),
        ("points --sampler random -n 4 --plot p.jpg", &["p.jpg", ".svg or .png"]),
        ("points --sampler random -n 99999 --plot p.svg", &["--plot", "99999", "65536"]),
        ("points --sampler random -n 4 --json --format csv", &["--json", "--format"]),
        ("points --sampler random", &["-n <N>", "--help"]),
        ("discrepancy --measure stars", &["--measure", "stars", "wrap-around"]),
        ("discrepancy --measure edge,edge", &["edge,edge", "once"]),
        ("discrepancy -d 3 --measure edge", &["edge", "2 dimensions", "3"]),
        ("discrepancy --counts 5", &["jittered", "N = 5", "4 and 9"]),
        ("discrepancy --counts 0", &["--counts", "from 1"]),
        ("discrepancy --trials 0", &["--trials", "0"]),
        ("discrepancy absent.csv", &["absent.csv"]),
        (&file_and_counts, &["--counts", "FILE"]),
        ("spectrum absent", &["absent", "scene", "point file"]),
        ("spectrum classic -n 4", &["-n", "--spp"]),
        ("spectrum --spp 4", &["--spp", "-n"]),
        ("spectrum edges --samplers zsobol --spp 5", &["--spp 5", "zsobol", "4 and 8"]),
        ("spectrum edges --samplers grid+none", &["grid", "1 different sets", "fewer trials"]),
        ("spectrum edges --spp 64 --reference-spp 16", &["--reference-spp 16", "64"]),
        ("spectrum --axes 1,1", &["--axes 1,1", "different"]),
        ("spectrum --cutoff 1", &["--cutoff", "1", "1024"]),
        ("spectrum -o s.png", &["--output", "--plot"]),
        ("spectrum --samplers random -o s.gif", &["s.gif", ".png or .exr"]),
        (&file_and_samplers, &["p.csv", "--samplers", "file:PATH"]),
        (&file_and_n, &["N = 4", "1"]),
        ("render classic --sampler owen -o out.png", &["--sampler", "owen", "zsobol"]),
        ("render edges --sampler zsobol --spp 5 -o out.png", &["--spp 5", "4 and 8"]),
    ];
    let mut faults = Vec::new();
    for (arguments, words) in table {
        let run = stratcli(arguments);
        let one_line = run.stdout.is_empty() && run.stderr.lines().count() == 1;
        let unsaid: Vec<_> = words.iter().filter(|word| !run.stderr.contains(**word)).collect();
        if run.code != Some(2) || !one_line || !unsaid.is_empty() {
            let Run { code, stdout, stderr } = run;
            faults.push(format!("{arguments} {code:?}, unsaid {unsaid:?}:\n{stdout}{stderr}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(!Path::new("out.png").exists() && !Path::new("s.png").exists());
}

/// A torus shift moves no power and no wrap-around discrepancy: of a pattern there are as many
/// different ones as patterns, of a grid there is one, without an error.
#[test]
fn a_torus_shift_is_no_other_set_where_it_changes_nothing() {
    for (sampler, different) in [("poisson", 4), ("grid", 1), ("jittered+torus-shift", 30)] {
        let spectrum = json(&format!("spectrum --samplers {sampler} -n 16 --trials 30 --cutoff 4"));
        assert_eq!(spectrum["samplers"][0]["trials"], different, "{sampler}");
        let found = json(&format!(
            "discrepancy --samplers {sampler} --counts 16 --trials 30 --measure wrap-around,centred"
        ));
        let row = |curve: usize| &found["curves"][curve]["rows"][0];
        assert_eq!((&row(0)["trials"], &row(1)["trials"]), (&different.into(), &30.into()));
        assert_eq!(row(0)["std_error"].is_null(), different == 1, "{sampler}");
    }
}
