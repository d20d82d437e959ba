//! Maps: the same bytes however, when and where the tiles were made; and every way in which files
//! of tiles can be wrong.

use exr::prelude::{ReadChannels, ReadLayers};
use serde_json::Value;
use std::collections::HashMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A region of an easy scene: 16 tiles and some clipped ones, a tenth of a second.
const MAP: [&str; 9] =
    ["map", "edges", "--region", "3,5,140,110", "--counts", "1..4^2", "--trials", "8", "--quiet"];

/// The files of a finished map.
const ENDINGS: [&str; 5] = ["exr", "png", "fits.csv", "points.csv", "json"];

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stratcli"));
        command.current_dir(self.0.path()).args(arguments);
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs what must succeed.
    fn done(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {stderr}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs what must be refused in one line with these words.
    fn refused(&self, arguments: &[&str], words: &[&str]) {
        let output = self.run(arguments);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(output.stdout.is_empty() && stderr.lines().count() == 1, "{stderr}");
        for word in words {
            assert!(stderr.contains(word), "{word} is not in: {stderr}");
        }
    }

    /// The bytes of a map's files, with its own name taken out of the summary.
    fn files(&self, stem: &str) -> HashMap<&'static str, Vec<u8>> {
        let read = |ending| {
            let bytes = fs::read(self.path(&format!("{stem}.{ending}"))).unwrap();
            let text = (ending == "json").then(|| String::from_utf8(bytes.clone()).unwrap());
            (
                ending,
                text.map_or(bytes, |text| {
                    text.replace(&format!("\"{stem}."), "\"MAP.").into_bytes()
                }),
            )
        };
        ENDINGS.into_iter().map(read).collect()
    }

    #[track_caller]
    fn same_files(&self, one: &str, other: &str) {
        let (one, other) = (self.files(one), self.files(other));
        for ending in ENDINGS {
            assert!(one[ending] == other[ending], "{ending} differs");
        }
    }

    /// Names in the folder.
    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// `MAP` with an output and more.
fn map<'a>(output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&MAP[..], &["-o", output], more].concat()
}

/// The channels of a picture: values by row, and the size.
fn channels(path: &Path) -> (HashMap<String, Vec<f32>>, [usize; 2], Value) {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .unwrap();
    let layer = image.layer_data;
    let comments = layer.attributes.comments.unwrap().to_string();
    let values = layer.channel_data.list.into_iter();
    let values = values.map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect()));
    (values.collect(), [layer.size.0, layer.size.1], serde_json::from_str(&comments).unwrap())
}

#[test]
fn a_map_has_the_promised_layers_and_says_where_it_is_from() {
    let folder = Folder::new();
    let found: Value = serde_json::from_str(&folder.done(&map("out.exr", &["--json"]))).unwrap();
    let (layers, size, comments) = channels(&folder.path("out.exr"));
    assert_eq!(size, [137, 105]);
    for name in ["R", "G", "B", "Rate.p", "Rate.p_lo", "Rate.p_hi", "Class.id"] {
        assert!(layers.contains_key(name), "{name}");
    }
    for n in ["00001", "00004", "00009", "00016"] {
        assert!(layers.contains_key(&format!("VarianceOfMean.N{n}")), "{n}");
    }
    assert_eq!(layers.len(), 11);
    assert_eq!(comments["hash"], found["hash"]);
    assert_eq!((&comments["plan"]["seed"], &comments["plan"]["trials"]), (&1996.into(), &8.into()));
    assert_eq!(comments["plan"]["samplers"][0]["name"], "jittered");
    // Missing is NaN: an exact pixel has no exponent, but a class and a mean.
    let exact = layers["Class.id"].iter().filter(|class| **class == 0.0).count() as u64;
    assert!(exact > 0);
    for (p, class) in layers["Rate.p"].iter().zip(&layers["Class.id"]) {
        assert_eq!(p.is_nan(), *class == 0.0 || class.is_nan());
    }
    assert!(layers["R"].iter().all(|mean| mean.is_finite()));
    let classes = found["classes"].as_array().unwrap();
    assert_eq!((&classes[0]["class"], &classes[0]["pixels"]), (&"exact".into(), &exact.into()));
    let counted: u64 = classes.iter().map(|class| class["pixels"].as_u64().unwrap()).sum();
    let rest = [&found["missing"], &found["samplers"][0]["unfitted"]];
    assert_eq!(counted + rest.map(|n| n.as_u64().unwrap()).iter().sum::<u64>(), 137 * 105);
    assert_eq!(folder.names(), ["out.exr", "out.fits.csv", "out.json", "out.png"]);

    let several = map("two.exr", &["--samplers", "random,jittered"]);
    folder.done(&several);
    let (layers, ..) = channels(&folder.path("two.exr"));
    assert!(layers.contains_key("random.Rate.p") && layers.contains_key("jittered.Rate.p"));
}

/// A pixel of a map is the pixel that `pixel` studies.
#[test]
fn a_map_agrees_with_the_study_of_one_pixel() {
    let folder = Folder::new();
    folder.done(&map("out.exr", &["--points", "--samplers", "random,jittered"]));
    let pixel =
        ["pixel", "edges", "--at", "60,40", "--counts", "1..4^2", "--trials", "8", "--json"];
    let study: Value = serde_json::from_str(&folder.done(&pixel)).unwrap();
    let text = fs::read_to_string(folder.path("out.points.csv")).unwrap();
    let of_pixel: Vec<Vec<&str>> = text
        .lines()
        .map(|line| line.split(',').collect())
        .filter(|fields: &Vec<&str>| fields[1..3] == ["60", "40"])
        .collect();
    assert_eq!(of_pixel.len(), 8);
    let rows = study["samplers"].as_array().unwrap().iter().flat_map(|sampler| {
        let name = sampler["name"].as_str().unwrap();
        sampler["rows"].as_array().unwrap().iter().map(move |row| (name, row))
    });
    for (fields, (name, row)) in of_pixel.iter().zip(rows) {
        assert_eq!(fields[4], name);
        assert_eq!(fields[9], row["n"].to_string());
        for (at, key) in [(11, "grand_mean"), (12, "variance_of_mean"), (13, "lo"), (14, "hi")] {
            assert_eq!(fields[at].parse::<f64>().ok(), row[key].as_f64(), "{key}");
        }
    }
}

#[test]
fn threads_change_no_byte_and_a_region_is_cut_from_the_whole() {
    let folder = Folder::new();
    folder.done(&map("one.exr", &["--points", "--threads", "1"]));
    for threads in ["2", "7"] {
        folder.done(&map("more.exr", &["--points", "--threads", threads]));
        folder.same_files("one", "more");
    }

    let mut crop = map("crop.exr", &["--points"]);
    crop[3] = "50,17,91,60";
    folder.done(&crop);
    for ending in ["fits.csv", "points.csv"] {
        let read =
            |stem: &str| fs::read_to_string(folder.path(&format!("{stem}.{ending}"))).unwrap();
        let (whole, crop) = (read("one"), read("crop"));
        let whole: std::collections::HashSet<_> = whole.lines().collect();
        assert!(crop.lines().count() > 41 * 43);
        assert!(crop.lines().all(|line| whole.contains(line)), "{ending}");
    }
    let (whole, [width, _], _) = channels(&folder.path("one.exr"));
    let (crop, [crop_width, crop_height], _) = channels(&folder.path("crop.exr"));
    assert_eq!([crop_width, crop_height], [41, 43]);
    for (name, values) in crop {
        let line = |y: usize| {
            let start = (y + 17 - 5) * width + 50 - 3;
            whole[&name][start..start + crop_width].iter().map(|v| v.to_bits())
        };
        let cut: Vec<u32> = (0..crop_height).flat_map(line).collect();
        assert_eq!(values.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), cut, "{name}");
    }
}

#[test]
fn shards_merge_to_the_map_of_one_run() {
    let folder = Folder::new();
    folder.done(&map("whole.exr", &["--points"]));
    for shard in ["1/3", "2/3", "3/3"] {
        let output = format!("{}.tiles", &shard[..1]);
        folder.done(&map(&output, &["--shard", shard]));
    }
    folder.done(&["merge", "3.tiles", "1.tiles", "2.tiles", "-o", "merged.exr", "--points"]);
    folder.same_files("whole", "merged");
    folder.done(&["merge", "2.tiles", "1.tiles", "3.tiles", "-o", "all.tiles"]);
    folder.done(&map("whole.tiles", &[]));
    assert!(
        fs::read(folder.path("all.tiles")).unwrap()
            == fs::read(folder.path("whole.tiles")).unwrap()
    );
    folder.done(&["merge", "all.tiles", "-o", "again.exr", "--points"]);
    folder.same_files("whole", "again");

    folder.refused(
        &["merge", "1.tiles", "3.tiles", "-o", "x.exr"],
        &["1.tiles", "lack", "of 20 tiles", "shards 2/3"],
    );
    folder.refused(
        &["merge", "1.tiles", "2.tiles", "1.tiles", "-o", "x.exr"],
        &["1.tiles", "also in", "once"],
    );
    folder.done(&map("foreign.tiles", &["--shard", "2/3", "--seed", "7"]));
    folder.refused(
        &["merge", "1.tiles", "foreign.tiles", "3.tiles", "-o", "x.exr"],
        &["foreign.tiles", "another plan", "seed is 7, not 1996", "same scene and options"],
    );
    let bytes = fs::read(folder.path("2.tiles")).unwrap();
    fs::write(folder.path("cut.tiles"), &bytes[..bytes.len() - 100]).unwrap();
    folder.refused(
        &["merge", "1.tiles", "cut.tiles", "3.tiles", "-o", "x.exr"],
        &["cut.tiles", "damaged or unfinished", "2/3", "--resume"],
    );
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 4;
    fs::write(folder.path("flipped.tiles"), flipped).unwrap();
    folder.refused(&["merge", "flipped.tiles", "-o", "x.exr"], &["flipped.tiles", "damaged"]);
    folder.refused(&["merge", "whole.exr", "-o", "x.exr"], &["whole.exr", "no tiles", ".tiles"]);
    folder.refused(&["merge", "no.tiles", "-o", "x.exr"], &["no.tiles"]);
    assert!(!folder.names().iter().any(|name| name.starts_with("x.") || name.contains("tmp")));
}

#[test]
fn a_resumed_run_drops_a_torn_tile_and_ends_as_if_never_stopped() {
    let folder = Folder::new();
    folder.done(&map("whole.exr", &["--points"]));
    folder.done(&map("whole.tiles", &[]));
    let bytes = fs::read(folder.path("whole.tiles")).unwrap();
    // Cut within the header, within the first tile, half-way, and before the results.
    for len in [7, 5000, bytes.len() / 2, bytes.len()] {
        fs::write(folder.path("out.exr.part"), &bytes[..len]).unwrap();
        folder.done(&map("out.exr", &["--points", "--resume"]));
        folder.same_files("whole", "out");
        assert!(!folder.path("out.exr.part").exists());
    }
    // A tile that was damaged on the disk, and those behind it, are made again.
    let mut damaged = bytes.clone();
    // Three numbers in a row, so that some result shows it wherever it is.
    damaged[bytes.len() / 2..][..24].iter_mut().for_each(|byte| *byte ^= 0x55);
    fs::write(folder.path("out.exr.part"), damaged).unwrap();
    folder.done(&map("out.exr", &["--points", "--resume"]));
    folder.same_files("whole", "out");

    fs::write(folder.path("out.exr.part"), &bytes[..bytes.len() / 2]).unwrap();
    folder.refused(
        &map("out.exr", &["--points"]),
        &["out.exr.part", "unfinished", "of 20 tiles", "--resume", "delete"],
    );
    folder.refused(
        &map("out.exr", &["--points", "--resume", "--seed", "7"]),
        &["out.exr.part", "another plan", "seed is 1996, not 7", "another output", "delete"],
    );
    fs::write(folder.path("out.exr.part"), "something else\n").unwrap();
    folder.refused(&map("out.exr", &["--resume"]), &["out.exr.part", "no tiles"]);
}

#[test]
fn a_finished_map_is_not_made_again() {
    let folder = Folder::new();
    folder.done(&map("out.exr", &[]));
    let time = || fs::metadata(folder.path("out.exr")).unwrap().modified().unwrap();
    let before = time();
    let found = folder.done(&map("out.exr", &["--resume", "--json"]));
    assert_eq!(serde_json::from_str::<Value>(&found).unwrap()["pixels"], 137 * 105);
    assert_eq!(time(), before);
    folder.done(&map("out.exr", &["--resume", "--seed", "7"]));
    assert_ne!(time(), before);
}

/// Random points have p = 1 without any scatter, and a map says which pixels had no trials.
#[test]
fn an_exact_map_has_no_scatter() {
    let folder = Folder::new();
    let more = ["--exact", "--samplers", "random,jittered", "--json"];
    let found: Value = serde_json::from_str(&folder.done(&map("out.exr", &more))).unwrap();
    let random = &found["samplers"][0];
    assert_eq!(random["computed"], 137 * 105);
    assert!(random["first_measured"].is_null(), "{random}");
    let table = fs::read_to_string(folder.path("out.fits.csv")).unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let computed = |row: &&Vec<&str>| row[4] == "random" && row[21].contains("computed");
    let fitted: Vec<_> = rows.iter().filter(computed).filter(|row| !row[10].is_empty()).collect();
    assert!(fitted.len() > 100);
    for row in fitted {
        let p: f64 = row[10].parse().unwrap();
        assert!((p - 1.0).abs() < 1e-9, "{row:?}");
    }
}

/// And it names the first pixel that could not be computed, as `pixel` and the table know it.
#[test]
fn an_exact_map_says_where_it_had_to_measure() {
    let folder = Folder::new();
    let region = ["--region", "20,79,24,82", "--counts", "1,4", "--trials", "5"];
    let map = [&["map", "classic", "--exact", "-o", "out.exr"][..], &region].concat();
    let text = folder.done(&map);
    assert!(text.contains("M = 5 trials") && text.contains("of 12 pixels"), "{text}");
    let table = fs::read_to_string(folder.path("out.fits.csv")).unwrap();
    let row = table.lines().skip(1).find(|row| !row.contains("computed")).unwrap();
    let at = row.split(',').skip(1).take(2).collect::<Vec<_>>().join(",");
    assert!(text.contains(&format!("--at {at} --exact and this map's counts")), "{at}: {text}");
    let pixel = ["pixel", "classic", "--at", &at, "--exact", "--counts", "1,4", "--trials", "5"];
    let pixel = folder.done(&pixel);
    assert!(pixel.contains("jittered (scramble: none), by trials: "), "{pixel}");
}

/// Missing pixels were tried; other samplers and pixels by rays are never computed.
#[test]
fn an_exact_map_speaks_of_trials_where_there_were_some() {
    let folder = Folder::new();
    let scene = "[camera]\neye = [0.0, 0.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\nup = [0.0, 1.0, 0.0]\n\
                 fov_y = 40.0\nresolution = [4, 4]\n[[mesh]]\npath = \"bright.obj\"\n";
    let triangle = "mtllib bright.mtl\nv -1.1 -1 0\nv 1.2 -1 0\nv 0 1.3 0\nusemtl b\nf 1 2 3\n";
    let material = "newmtl b\nKe 1e308 1e308 1e308\n";
    for (name, text) in [("bright.toml", scene), ("bright.obj", triangle), ("bright.mtl", material)]
    {
        fs::write(folder.path(name), text).unwrap();
    }
    let map = |scene: &str, more: &[&str]| {
        let typed = ["map", scene, "--exact", "--counts", "1,4", "--trials", "3", "-o", "out.exr"];
        folder.done(&[&typed[..], more].concat())
    };
    let text = map("bright.toml", &[]);
    assert!(text.contains("M = 3 trials") && text.contains("pixels are missing"), "{text}");
    let few = ["--region", "70,60,72,61", "--samplers", "jittered,halton"];
    let text = map("classic", &few);
    assert!(text.contains("M = 3 trials") && text.contains("halton+owen: 0 of 2 pixels"), "{text}");
    assert!(text.contains("; only random and jittered without a scramble are"), "{text}");
    let text = map("classic", &[&few[..2], &["--tracer", "bvh"]].concat());
    assert!(text.contains("jittered: 0 of 2 pixels computed without trials; `stratcli"), "{text}");
}

/// Waits until a run has written something to its file of tiles.
fn wait_for_tiles(child: &mut Child, part: &Path) {
    while child.try_wait().unwrap().is_none()
        && fs::metadata(part).map_or(true, |file| file.len() < 10_000)
    {
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Many more trials than are ever made.
fn slow_map<'a>(output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = map(output, more);
    arguments[7] = "4000";
    arguments
}

#[test]
fn two_runs_on_one_output_are_refused_and_a_killed_one_leaves_no_lock() {
    let folder = Folder::new();
    let mut first = folder.command(&slow_map("out.exr", &[])).spawn().unwrap();
    wait_for_tiles(&mut first, &folder.path("out.exr.part"));
    assert!(first.try_wait().unwrap().is_none(), "the run ended before it could be doubled");
    folder.refused(&slow_map("out.exr", &["--resume"]), &["out.exr.part", "another run"]);
    first.kill().unwrap();
    first.wait().unwrap();
    folder.refused(&slow_map("out.exr", &[]), &["out.exr.part", "unfinished", "--resume"]);
}

/// Kills runs at random moments until one comes through, and compares it with a run that was
/// left alone.
fn killed(kills: u32) {
    let folder = Folder::new();
    // Half a second of work in 20 tiles.
    let arguments = |output, more: &[&'static str]| {
        let mut arguments = map(output, more);
        arguments[7] = "100";
        arguments
    };
    let start = Instant::now();
    folder.done(&arguments("whole.exr", &["--points"]));
    let whole = start.elapsed();
    let mut random = 12345u64;
    let (mut done, mut in_results) = (0, 0);
    while done < kills {
        // One that an earlier kill left tells nothing of the next.
        let _ = fs::remove_file(folder.path(".out.exr.tmp"));
        let mut child =
            folder.command(&arguments("out.exr", &["--points", "--resume"])).spawn().unwrap();
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        std::thread::sleep(whole.mul_f64((random >> 40) as f64 / f64::from(1 << 24)));
        child.kill().unwrap();
        if child.wait().unwrap().code() == Some(0) {
            // It came through before the signal: begin again.
            folder.same_files("whole", "out");
            for ending in ENDINGS {
                fs::remove_file(folder.path(&format!("out.{ending}"))).unwrap();
            }
        } else {
            done += 1;
            in_results += u32::from(folder.path(".out.exr.tmp").exists());
        }
    }
    eprintln!("{kills} kills, {in_results} of them while results were written");
    folder.done(&arguments("out.exr", &["--points", "--resume"]));
    folder.same_files("whole", "out");
    assert!(!folder.names().iter().any(|name| name.contains("tmp") || name.contains("part")));
}

#[test]
fn kills_at_random_moments_leave_no_mark() {
    killed(4);
}

/// `cargo test -p stratcli --test map -- --ignored --nocapture two_hundred`
#[test]
#[ignore = "a minute or more"]
fn two_hundred_kills_leave_no_mark() {
    killed(200);
}

#[test]
fn what_cannot_be_is_refused_in_one_clear_line() {
    let folder = Folder::new();
    let replaced = |output, at: usize, with: &'static str| {
        let mut arguments = map(output, &[]);
        arguments[at] = with;
        arguments
    };
    folder.refused(&map("out.png", &[]), &["out.png", ".exr", ".tiles"]);
    folder.refused(&map("absent/out.exr", &[]), &["absent/out.exr", "folder that exists"]);
    folder.refused(&map("out.exr", &["--shard", "1/2"]), &["out.exr", ".tiles", "merge"]);
    folder.refused(&map("out.tiles", &["--shard", "3/2"]), &["--shard", "3/2", "I/N"]);
    folder.refused(&map("out.tiles", &["--shard", "slurm"]), &["SLURM_ARRAY_TASK_ID", "I/N"]);
    folder.refused(&map("out.tiles", &["--points"]), &["--points", "merged"]);
    folder.refused(&replaced("out.exr", 3, "0,0,0,5"), &["--region", "no pixels", "X0 < X1"]);
    folder.refused(&replaced("out.exr", 3, "0,0,9999,5"), &["--region", "leaves the picture"]);
    folder.refused(&replaced("out.exr", 3, "1,2,3"), &["--region", "X0,Y0,X1,Y1"]);
    folder.refused(&replaced("out.exr", 5, "5"), &["N = 5", "4 and 9"]);
    folder.refused(&map("out.exr", &["--samplers", "jitter"]), &["--samplers", "jittered"]);
    folder.refused(&map("out.exr", &["--dry-run", "--resume"]), &["--dry-run", "--resume"]);
    assert_eq!(folder.names(), Vec::<String>::new());
}

/// A limit on the size of files stands for a full disk.
#[cfg(unix)]
#[test]
fn a_full_disk_is_one_clear_line_and_room_lets_it_go_on() {
    let folder = Folder::new();
    folder.done(&map("whole.exr", &["--points"]));
    let limited = "trap '' XFSZ; ulimit -f 200; exec \"$0\" \"$@\"";
    let output = Command::new("sh")
        .current_dir(folder.0.path())
        .args(["-c", limited, env!("CARGO_BIN_EXE_stratcli")])
        .args(map("out.exr", &["--points"]))
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    for word in ["out.exr.part", "cannot write", "room", "--resume"] {
        assert!(stderr.contains(word), "{stderr}");
    }
    folder.done(&map("out.exr", &["--points", "--resume"]));
    folder.same_files("whole", "out");
}

#[test]
fn a_dry_run_says_what_it_takes_and_is_judged_by_the_run() {
    let folder = Folder::new();
    let estimate: Value =
        serde_json::from_str(&folder.done(&map("out.exr", &["--dry-run", "--json"]))).unwrap();
    // M = 8 times 1 + 4 + 9 + 16.
    assert_eq!(estimate["pixels"], 137 * 105);
    assert_eq!(estimate["samples"], 137 * 105 * 8 * 30);
    for key in ["seconds", "std_error", "memory_bytes", "disk_bytes"] {
        assert!(estimate[key].as_f64().is_some_and(|x| x > 0.0), "{key}: {estimate}");
    }
    assert_eq!(estimate["past_errors"].as_array().unwrap().len(), 0);
    assert_eq!(folder.names(), ["estimates.csv"]);
    folder.done(&map("out.exr", &[]));
    let again: Value =
        serde_json::from_str(&folder.done(&map("out.exr", &["--dry-run", "--json"]))).unwrap();
    assert_eq!(again["past_errors"].as_array().unwrap().len(), 1, "{again}");
    let disk: u64 = folder
        .names()
        .iter()
        .filter(|name| name.starts_with("out."))
        .map(|name| fs::metadata(folder.path(name)).unwrap().len())
        .sum();
    assert!(disk < estimate["disk_bytes"].as_u64().unwrap());
}

#[test]
fn a_study_maps_every_scene_and_compares_the_samplers() {
    let folder = Folder::new();
    fs::write(
        folder.path("night.toml"),
        "scenes = [\"edges\", \"classic\"]\nsamplers = [\"random\", \"jittered\", \"sobol\"]\n\
         counts = [1, 4, 16]\ntrials = 6\n\
         [regions]\nedges = [200, 10, 240, 50]\nclassic = [100, 100, 140, 120]\n",
    )
    .unwrap();
    let study = ["study", "night.toml", "-o", "out", "--json"];
    let summary: Value = serde_json::from_str(&folder.done(&study)).unwrap();
    assert_eq!(summary["maps"].as_array().unwrap().len(), 2);
    let page = fs::read_to_string(folder.path("out/report.html")).unwrap();
    for words in ["edges", "classic", "sobol", "data:image/png;base64,", "Which sampler wins"] {
        assert!(page.contains(words), "{words}");
    }
    assert!(!page.contains("src=\"out"), "the page carries its pictures");
    let time = || fs::metadata(folder.path("out/classic.exr")).unwrap().modified().unwrap();
    let before = time();
    let text = folder.done(&study[..4]);
    assert_eq!(time(), before);
    assert!(text.contains("edges") && text.contains("all pixels"), "{text}");
    assert_eq!(fs::read_to_string(folder.path("out/report.html")).unwrap(), page);

    fs::write(folder.path("bad.toml"), "scenes = [\"edges\"]\nsamplers = [\"jitter\"]\n").unwrap();
    folder.refused(&["study", "bad.toml", "-o", "bad"], &["bad.toml", "samplers", "jittered"]);
    folder.refused(&["study", "no.toml", "-o", "bad"], &["no.toml", "path"]);
    fs::write(
        folder.path("wide.toml"),
        "scenes = [\"edges\"]\nsamplers = [\"random\"]\n[regions]\nedges = [0, 0, 9999, 9]\n",
    )
    .unwrap();
    folder.refused(&["study", "wide.toml", "-o", "bad"], &["wide.toml", "edges", "regions"]);
    File::create(folder.path("file")).unwrap();
    folder.refused(&["study", "night.toml", "-o", "file"], &["file", "--output"]);
}
