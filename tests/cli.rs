//! The command line as a user meets it: every fault in one line, JSON and nothing else, exit
//! codes, closed pipes and Ctrl-C.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const STRATCLI: &str = env!("CARGO_BIN_EXE_stratcli");

struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn stratcli(arguments: &[&str]) -> Run {
    let output = Command::new(STRATCLI).args(arguments).output().unwrap();
    Run {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

fn json(arguments: &[&str]) -> Value {
    let run = stratcli(&[arguments, &["--json"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{arguments:?}");
    serde_json::from_str(&run.stdout).expect("one JSON document and nothing else")
}

fn keys(object: &Value) -> Vec<&str> {
    object.as_object().unwrap().keys().map(String::as_str).collect()
}

/// A folder with a scene that is good and ones that are not.
struct Scenes(tempfile::TempDir);

impl Scenes {
    const QUAD: &str = "mtllib grey.mtl\nv -1 -1 0\nv 0.3 -1 0\nv 0.3 1 0\nv -1 1 0\n\
                        usemtl grey\nf 1 2 3\nf 1 3 4\n";
    const CAMERA: &str = "[camera]\neye = [0.0, 0.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\n\
                          fov_y = 45.0\nresolution = [8, 6]\n";

    fn new() -> Self {
        let scenes = Self(tempfile::tempdir().unwrap());
        let mesh = |path: &str| format!("[[mesh]]\npath = \"{path}\"\n");
        let camera = |from: &str, to: &str| Self::CAMERA.replace(from, to) + &mesh("quad.obj");
        scenes.write("grey.mtl", "newmtl grey\nKd 0.5 0.5 0.5\n");
        scenes.write("quad.obj", Self::QUAD);
        scenes.write("quad.toml", &(Self::CAMERA.to_owned() + &mesh("quad.obj")));
        scenes.write("empty.obj", "# nothing\n");
        scenes.write("nan.obj", &Self::QUAD.replace("0.3 1 0", "nan 1 0"));
        scenes.write("range.obj", &Self::QUAD.replace("1 3 4", "1 3 5"));
        scenes.write("no-mesh.toml", &(Self::CAMERA.to_owned() + &mesh("absent.obj")));
        scenes.write("no-pixels.toml", &camera("[8, 6]", "[8, 0]"));
        scenes.write("no-angle.toml", &camera("fov_y = 45.0", "fov_y = 0.0"));
        scenes.write(
            "no-view.toml",
            &camera("look_at = [0.0, 0.0, 0.0]", "look_at = [0.0, 0.0, 4.0]"),
        );
        scenes.write("not.toml", "[camera\n");
        scenes
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn spec(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_owned()
    }
}

/// Every fault that a user can type or supply is one line that names the input, the fault and
/// the way out; nothing on standard output; exit 2.
#[test]
fn each_bad_input_is_one_clear_line() {
    let scenes = Scenes::new();
    let quad = scenes.spec("quad.toml");
    let blocked = scenes.spec("absent/folder/out.png");
    let folder = scenes.0.path().to_str().unwrap().to_owned();
    let study = |extra: &[&str]| [&["pixel", &quad, "--at", "4,3"], extra].concat().join("\n");
    let pixel = |name: &str| format!("pixel\n{}\n--at\n0,0", scenes.spec(name));
    // Arguments, one per line; words that the line must contain.
    let table: Vec<(String, &[&str])> = vec![
        (pixel("absent.toml"), &["absent.toml", "path"]),
        (pixel("absent.obj"), &["absent.obj", "path"]),
        (pixel("picture.jpg"), &["picture.jpg", ".toml", ".obj"]),
        (pixel("no-mesh.toml"), &["absent.obj", "path"]),
        (pixel("empty.obj"), &["empty.obj", "no faces", "at least one triangle"]),
        (pixel("nan.obj"), &["nan.obj", "line 4", "NaN", "1e15"]),
        (pixel("range.obj"), &["range.obj", "5", "4 vertices"]),
        (pixel("no-pixels.toml"), &["no-pixels.toml", "resolution", "1"]),
        (pixel("no-angle.toml"), &["no-angle.toml", "fov_y", "180"]),
        (pixel("no-view.toml"), &["no-view.toml", "eye", "look_at"]),
        (pixel("not.toml"), &["not.toml", "line 1"]),
        ("pixel\nabsent\n--at\n0,0".to_owned(), &["absent", "classic", ".toml"]),
        (format!("pixel\n{quad}\n--at\n8,0"), &["8,0", "8 × 6", "X runs from 0 to 7"]),
        (format!("pixel\n{quad}\n--at\n-1,0"), &["--at -1,0", "X,Y"]),
        (format!("pixel\n{quad}\n--at\n4"), &["--at 4", "X,Y"]),
        (format!("pixel\n{quad}"), &["--at <X,Y>", "--help"]),
        (study(&["--counts", "5"]), &["jittered", "N = 5", "4 and 9", "--n-policy snap"]),
        (study(&["--counts", "1..x"]), &["--counts", "1..x", "1..16^2"]),
        (study(&["--counts", "0,1"]), &["--counts", "0,1", "from 1"]),
        (study(&["--trials", "1"]), &["at least 2 trials", "1"]),
        (study(&["--trials", "-3"]), &["--trials", "-3"]),
        (study(&["--samplers", "random,jitter"]), &["--samplers", "jitter", "random, jittered"]),
        (study(&["--samplers", ""]), &["--samplers", "random, jittered"]),
        (study(&["--expect", "1.5"]), &["--expect", "P:TOL"]),
        (study(&["--expect", "halton:1.5:0.1"]), &["--expect", "random, jittered"]),
        (study(&["--threads", "0"]), &["--threads", "1"]),
        (study(&["--frobnicate"]), &["--frobnicate", "--help"]),
        (study(&["--seed", "-1"]), &["-1"]),
        (
            format!("render\n{quad}\n-o\n{blocked}"),
            &["absent/folder/out.png", "folder that exists"],
        ),
        (format!("render\n{quad}\n-o\n{folder}/out.jpg"), &["out.jpg", ".png or .exr"]),
        (format!("render\n{quad}\n-o\n{folder}/.png"), &[".png or .exr"]),
        (format!("render\n{quad}\n-o\n{folder}/out.png\n--spp\n0"), &["--spp", "1"]),
        (
            format!("render\n{quad}\n-o\n{folder}/out.png\n--exposure\nnan"),
            &["--exposure", "finite"],
        ),
        (
            format!("inspect\n{}", scenes.spec("empty.obj")),
            &["empty.obj", "no faces", "at least one triangle"],
        ),
        (format!("inspect\n{quad}\n--at\n0,6"), &["0,6", "8 × 6", "Y from 0 to 5"]),
        ("reproduce\n--dimensions\n--lattice\n4".to_owned(), &["--dimensions", "--lattice"]),
        ("reproduce\n--dimensions\n--literature".to_owned(), &["--dimensions", "--literature"]),
        ("integrand\nramps".to_owned(), &["ramps", "ramp", "koch"]),
        ("integrand\nkoch\n--dim\n3".to_owned(), &["koch", "d = 3", "d = 2"]),
        ("integrand\nstep\n--set\nedges=1".to_owned(), &["step", "edges", "takes"]),
        ("integrand\nstep\n--set\nedge".to_owned(), &["--set edge", "name=value"]),
        ("integrand\nramp\n--occluder\n0.5".to_owned(), &["ramp", "occluder"]),
        ("integrand\nramp\n--dim\n4\n--counts\n1,4".to_owned(), &["N = 4", "1 and 16"]),
        ("completions\nksh".to_owned(), &["ksh", "bash"]),
        ("list\nscenery".to_owned(), &["scenery", "scenes"]),
    ];
    let mut faults = Vec::new();
    for (arguments, words) in table {
        let run = stratcli(&arguments.split('\n').collect::<Vec<_>>());
        let one_line = run.stdout.is_empty() && run.stderr.lines().count() == 1;
        let unsaid: Vec<_> = words.iter().filter(|word| !run.stderr.contains(**word)).collect();
        if run.code != Some(2) || !one_line || !unsaid.is_empty() {
            let Run { code, stdout, stderr } = run;
            faults.push(format!("{arguments:?} {code:?}, unsaid {unsaid:?}:\n{stdout}{stderr}"));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(!Path::new(&format!("{folder}/out.png")).exists());
}

#[test]
fn a_pixel_study_keeps_the_promised_json() {
    let scenes = Scenes::new();
    let quad = scenes.spec("quad.toml");
    let study = json(&["pixel", &quad, "--at", "4,3", "--trials", "400", "--counts", "1..4^2"]);
    assert_eq!(study["schema"], 1);
    assert_eq!(study["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(study["scene"], "quad");
    assert_eq!(study["pixel"], serde_json::json!([4, 3]));
    assert_eq!(study["dim"], 2);
    assert_eq!(study["axes"], serde_json::json!(["pixel_x", "pixel_y"]));
    assert_eq!(study["seed"], 1996);
    assert_eq!(study["trials"], 400);
    assert_eq!(study["complete"], true);
    assert!(study["reference"].is_null());
    let samplers = study["samplers"].as_array().unwrap();
    let names: Vec<_> = samplers.iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["random", "jittered"]);
    for sampler in samplers {
        assert_eq!(sampler["scramble"], "none");
        assert_eq!(sampler["rows"].as_array().unwrap().len(), 4);
        let row = &sampler["rows"][3];
        assert_eq!((&row["n"], &row["n_used"]), (&16.into(), &16.into()));
        for key in ["grand_mean", "variance_of_mean", "lo", "hi"] {
            assert!(row[key].is_f64(), "{key}: {row}");
        }
        assert!(row["ns_per_sample"].is_null());
        let fit = &sampler["fit"];
        let promised =
            ["exponent", "std_error", "ci95", "log10_constant", "n_min", "n_max", "points", "chi2"];
        for key in promised {
            assert!(keys(fit).contains(&key), "{key}: {fit}");
        }
        assert_eq!(
            (&fit["n_min"], &fit["n_max"], &fit["points"]),
            (&1.into(), &16.into(), &4.into())
        );
        assert_eq!(sampler["exact"], false);
    }
    assert!(samplers[1]["class"].is_string());
    let prediction = |s: &Value| serde_json::json!([s["predicted"], s["predicted_from"]]);
    assert_eq!(prediction(&samplers[0]), serde_json::json!([1.0, "integrand"]));
    // From points of the pixel's own: the same with next to no trials, and as inspect says.
    let axes = serde_json::json!([1.5, "axes"]);
    assert_eq!(prediction(&samplers[1]), axes);
    assert_eq!(samplers[1]["predicted_bound"], "equals");
    let study = json(&["pixel", &quad, "--at", "4,3", "--trials", "2", "--counts", "1,4"]);
    assert_eq!(study["samplers"][1]["class_is_sure"], false);
    assert_eq!(prediction(&study["samplers"][1]), axes);
    let facts = json(&["inspect", &quad, "--at", "4,3"]);
    let limits = facts["pixel"]["predicted"].as_array().unwrap();
    let jittered = limits.iter().find(|p| p["sampler"] == "jittered").unwrap();
    assert_eq!(jittered["limit"]["exponent"], 1.5);
}

/// The quad's right side cuts the pixel: both samplers are known, halton has to be measured.
#[test]
fn an_exact_study_says_how_each_sampler_was_obtained() {
    let scenes = Scenes::new();
    let quad = scenes.spec("quad.toml");
    let samplers = "random,jittered,halton";
    let arguments = ["pixel", &quad, "--at", "4,3", "--exact", "--samplers", samplers];
    let study = json(&[&arguments[..], &["--counts", "1..4^2", "--trials", "5"]].concat());
    for sampler in &study["samplers"].as_array().unwrap()[..2] {
        assert_eq!(sampler["method"], "exact");
        assert!(sampler.get("unresolved").is_none());
        for row in sampler["rows"].as_array().unwrap() {
            let value = &row["variance_of_mean"];
            assert!(value.as_f64().unwrap() > 0.0);
            assert_eq!((&row["lo"], &row["hi"], &row["var_ln"]), (value, value, &0.0.into()));
            assert_eq!(row["grand_mean"], study["reference"]["mean"]);
        }
        assert_eq!(sampler["fit"]["std_error"], 0.0);
        assert!(sampler["fit"]["chi2"].is_null());
    }
    let halton = &study["samplers"][2];
    assert_eq!(halton["method"], "trials");
    assert!(halton["unresolved"].as_str().unwrap().contains("random and jittered"));

    let text = stratcli(&["pixel", &quad, "--at", "4,3", "--exact"]).stdout;
    assert!(text.contains("no random numbers") && !text.contains("95 %"), "{text}");
    assert!(text.contains("(from the visible polygons)"), "{text}");
    let even = stratcli(&["pixel", &quad, "--at", "0,0", "--exact"]).stdout;
    assert!(even.contains("zero variance at every N") && !even.contains("trial "), "{even}");
    let measured = ["pixel", &quad, "--at", "4,3", "--exact", "--samplers", "halton"];
    let text = stratcli(&[&measured[..], &["--trials", "3"]].concat()).stdout;
    assert!(text.contains("(from the visible polygons)") && text.contains("M = 3"), "{text}");
    let by_rays = ["pixel", &quad, "--at", "4,3", "--exact", "--tracer", "bvh", "--trials", "3"];
    let text = stratcli(&by_rays).stdout;
    assert!(text.contains("by trials: the pixel is traced by rays"), "{text}");
    assert!(text.contains("without --tracer bvh, `stratcli inspect` with --at says why"), "{text}");
}

#[test]
fn an_integrand_brings_its_exact_numbers() {
    let study = json(&["integrand", "ramp", "--dim", "3", "--trials", "10", "--counts", "1..3^3"]);
    assert_eq!(study["integrand"], "ramp");
    assert_eq!(study["dim"], 3);
    assert!(study["reference"]["mean"].is_f64());
    for sampler in study["samplers"].as_array().unwrap() {
        for row in sampler["rows"].as_array().unwrap() {
            assert!(row["exact_variance"].is_f64(), "{row}");
        }
    }
}

#[test]
fn zero_variance_is_said_and_not_fitted() {
    let arguments = ["integrand", "constant", "--trials", "5", "--counts", "1,4,9"];
    let study = json(&arguments);
    for sampler in study["samplers"].as_array().unwrap() {
        assert!(sampler["fit"].is_null() && sampler["exact"] == true, "{sampler}");
    }
    let text = stratcli(&arguments);
    assert_eq!(text.code, Some(0));
    assert_eq!(text.stdout.matches("zero variance").count(), 2, "{}", text.stdout);
    assert!(!text.stdout.contains("p ="), "{}", text.stdout);
}

/// An edge through the middle lies on the grid of every even k.
#[test]
fn an_edge_on_the_grid_is_exact_there_and_fitted_elsewhere() {
    let arguments = ["integrand", "step", "--set", "edge=0.5", "--counts", "1..6^2"];
    let study = json(&arguments);
    let jittered = &study["samplers"][1];
    for (k, row) in (1..=6).zip(jittered["rows"].as_array().unwrap()) {
        assert_eq!(row["variance_of_mean"] == 0.0, k % 2 == 0, "{row}");
    }
    assert_eq!(jittered["fit"]["points"], 3);
    assert_eq!(jittered["exact"], false);
    let text = stratcli(&arguments).stdout;
    assert!(text.contains("zero variance at N = 4, 16, 36"), "{text}");
}

#[test]
fn the_count_used_is_reported() {
    let snap = ["integrand", "ramp", "--counts", "5,12", "--n-policy", "snap"];
    let rows = json(&snap)["samplers"][1]["rows"].clone();
    assert_eq!((&rows[0]["n"], &rows[0]["n_used"]), (&5.into(), &4.into()));
    assert!(stratcli(&snap).stdout.contains("N used"));

    let rect = ["integrand", "ramp", "--counts", "5,12", "--n-policy", "rect"];
    let rows = json(&rect)["samplers"][1]["rows"].clone();
    assert_eq!((&rows[1]["n_used"], &rows[1]["strata"]), (&12.into(), &serde_json::json!([4, 3])));
    assert!(stratcli(&rect).stdout.contains("4 × 3"));
}

#[test]
fn timing_is_measured_only_when_asked_for() {
    let study = json(&["integrand", "ramp", "--counts", "1,4", "--trials", "4", "--timing"]);
    let ns = &study["samplers"][0]["rows"][1]["ns_per_sample"];
    assert!(ns.as_f64().is_some_and(|ns| ns > 0.0), "{ns}");
}

/// The exponent of a ramp is 2 within five standard errors of 0.033, and 1 it is not.
#[test]
fn an_expectation_decides_the_exit_code() {
    let run = |expect: &'static str| stratcli(&["integrand", "ramp", "--expect", expect]);
    let held = run("2:0.17");
    assert_eq!((held.code, held.stderr.as_str()), (Some(0), ""));
    let failed = run("1:0.17");
    assert_eq!(failed.code, Some(1));
    assert!(failed.stdout.contains("jittered"), "{}", failed.stdout);
    assert_eq!(failed.stderr.lines().count(), 1);
    assert!(failed.stderr.contains("expected p = 1 ± 0.17 under jittered"), "{}", failed.stderr);
    let random = stratcli(&["integrand", "ramp", "--samplers", "random", "--expect", "1:0.17"]);
    assert_eq!(random.code, Some(0));
    assert_eq!(run("random:1:0.2").code, Some(0));
    let failed = run("random:2:0.17");
    assert_eq!(failed.code, Some(1));
    assert!(failed.stderr.contains("under random, found p = 1.0"), "{}", failed.stderr);
    assert!(failed.stderr.contains(" ± 0.0"), "{}", failed.stderr);
    let exact = stratcli(&["integrand", "constant", "--expect", "2:0.17"]);
    assert_eq!(exact.code, Some(1));
    assert!(exact.stderr.contains("no exponent"), "{}", exact.stderr);
}

#[test]
fn every_command_speaks_json_alone() {
    let scenes = Scenes::new();
    let quad = scenes.spec("quad.toml");
    let picture = scenes.spec("out.png");
    for arguments in [
        &["inspect", &quad][..],
        &["render", &quad, "--spp", "1", "-o", &picture],
        &["list"],
        &["list", "integrands"],
        &["completions", "zsh"],
    ] {
        assert_eq!(json(arguments)["schema"], 1, "{arguments:?}");
    }
}

#[test]
fn an_inspection_counts_what_is_there() {
    let scenes = Scenes::new();
    let facts = json(&["inspect", &scenes.spec("quad.toml")]);
    assert_eq!((&facts["triangles"], &facts["dim"]), (&2.into(), &2.into()));
    assert_eq!(facts["bounds"], serde_json::json!([[-1.0, -1.0, 0.0], [0.3, 1.0, 0.0]]));
    let predicted: Vec<_> =
        facts["predicted"].as_array().unwrap().iter().map(|p| p["exponent"].clone()).collect();
    assert_eq!(predicted, [2.0, 1.5, 1.0]);
    let text = stratcli(&["inspect", &scenes.spec("quad.toml")]).stdout;
    assert!(text.contains("pixel_x, pixel_y") && text.contains("8 × 6"), "{text}");
}

/// What an inspection says of a scene with all features, and of one of its pixels.
#[test]
fn an_inspection_names_axes_paths_and_needs() {
    let facts = json(&["inspect", "room-all", "--at", "200,184"]);
    let features = &facts["features"];
    assert_eq!(features["area_lights"][0]["shape"], "mesh");
    assert!(features["lens"]["radius"] == 0.09 && features["filter"].is_null(), "{features}");
    let k = |class: &str| {
        let all = facts["predicted"].as_array().unwrap();
        let found = all.iter().find(|p| p["class"] == class).unwrap();
        (found["discontinuity_dim"].clone(), found["exponent"].as_f64().unwrap())
    };
    assert_eq!(k("smooth"), (Value::Null, 1.0 + 2.0 / 7.0));
    assert_eq!(k("edge"), (6.into(), 1.0 + 1.0 / 7.0));
    assert_eq!(k("complex"), (7.into(), 1.0));
    let paths = facts["paths"].as_array().unwrap();
    assert!(paths.iter().all(|p| p["path"] == "rays"), "{paths:?}");
    assert_eq!(paths.iter().map(|p| p["pixels"].as_u64().unwrap()).sum::<u64>(), 64);
    // A pixel that the rolling ball's rim crosses.
    let pixel = &facts["pixel"];
    let needs = pixel["needs"]["axes"].as_array().unwrap();
    assert_eq!(needs.len(), 7);
    let time = needs.iter().find(|axis| axis["name"] == "time").unwrap();
    assert!(time["behaviour"] == "jumps" && time["share"]["value"].as_f64() > Some(0.1), "{time}");
    let limit = |sampler: &str| {
        let all = pixel["predicted"].as_array().unwrap();
        let found = all.iter().find(|p| p["sampler"] == sampler).unwrap();
        found["limit"]["exponent"].as_f64().unwrap()
    };
    assert_eq!((limit("jittered"), limit("jittered-padded")), (1.0 + 1.0 / 7.0, 1.0));
    let text = stratcli(&["inspect", "room", "--at", "150,190"]).stdout;
    for words in ["mesh, radiance 9 8.4 7.2", "beam and shafts in f64", "k = 3", "light_u"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn a_picture_is_written_in_both_formats() {
    let scenes = Scenes::new();
    let quad = scenes.spec("quad.toml");
    for (name, magic) in [("out.png", &b"\x89PNG"[..]), ("out.exr", &[0x76, 0x2f, 0x31, 0x01])] {
        let run = stratcli(&["render", &quad, "--spp", "4", "-o", &scenes.spec(name)]);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
        assert!(run.stdout.contains("seed 1996"), "{}", run.stdout);
        assert!(fs::read(scenes.path(name)).unwrap().starts_with(magic));
    }
    let leftovers = fs::read_dir(scenes.0.path()).unwrap().filter(|entry| {
        entry.as_ref().unwrap().path().extension().is_some_and(|extension| extension == "tmp")
    });
    assert_eq!(leftovers.count(), 0);
}

#[test]
fn help_and_version_are_no_faults() {
    for arguments in [&["--help"][..], &["--version"], &["pixel", "--help"], &["help", "render"]] {
        let run = stratcli(arguments);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{arguments:?}");
        assert!(!run.stdout.is_empty());
    }
    let bare = stratcli(&[]);
    assert_eq!((bare.code, bare.stdout.as_str()), (Some(2), ""));
    assert!(bare.stderr.contains("Usage"));
}

/// `stratcli … | head`: the reader is gone before the first byte.
#[test]
fn a_closed_pipe_is_success_and_silence() {
    for arguments in [&["list"][..], &["completions", "bash"], &["--help"], &["list", "--json"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(STRATCLI)
            .args(arguments)
            .stdout(writer)
            .stderr(Stdio::piped())
            .output()
            .unwrap();
        assert_eq!(output.stderr, b"", "{arguments:?}");
        assert!(output.status.success(), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_one_clear_line() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = Command::new(STRATCLI).arg("list").stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(stderr.lines().count(), 1);
    assert!(stderr.contains("standard output"), "{stderr}");
}

#[cfg(unix)]
mod interrupted {
    use super::*;
    use std::time::Duration;

    /// Runs until interrupted after `delay`.
    fn interrupt(arguments: &[&str], delay: Duration) -> Run {
        let child = Command::new(STRATCLI)
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        std::thread::sleep(delay);
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        let output = child.wait_with_output().unwrap();
        Run {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// The same with growing delays, until the signal came late enough: a busy machine may take
    /// its time to start the process.
    fn interrupt_when(arguments: &[&str], late_enough: fn(&Run) -> bool) -> Run {
        let mut delay = Duration::from_millis(300);
        loop {
            let run = interrupt(arguments, delay);
            if late_enough(&run) || delay > Duration::from_secs(20) {
                return run;
            }
            delay *= 3;
        }
    }

    // In 20 dimensions jittered snaps 500,000 points to one, and is done at once; random takes
    // them all, which is hours of work.
    const FAST_THEN_SLOW: [&str; 13] = [
        "integrand",
        "constant",
        "--dim",
        "20",
        "--samplers",
        "jittered,random",
        "--counts",
        "500000",
        "--n-policy",
        "snap",
        "--trials",
        "100000",
        "--json",
    ];

    #[test]
    fn what_was_finished_is_kept() {
        let run = interrupt_when(&FAST_THEN_SLOW, |run| !run.stdout.is_empty());
        assert_eq!(run.code, Some(130), "{}", run.stderr);
        let study: Value = serde_json::from_str(&run.stdout).unwrap();
        assert_eq!(study["complete"], false);
        let samplers = study["samplers"].as_array().unwrap();
        assert_eq!(samplers.len(), 1);
        assert_eq!(samplers[0]["name"], "jittered");
        assert!(run.stderr.contains("1 of 2 samplers"), "{}", run.stderr);
        assert_eq!(run.stderr.lines().count(), 1);
    }

    #[test]
    fn nothing_finished_is_said() {
        let mut arguments = FAST_THEN_SLOW;
        arguments[5] = "random,jittered";
        let run = interrupt_when(&arguments, |run| run.code.is_some());
        assert_eq!((run.code, run.stdout.as_str()), (Some(130), ""));
        assert!(run.stderr.contains("interrupted before anything was finished"), "{}", run.stderr);
    }
}
