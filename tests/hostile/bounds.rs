//! Memory follows what a file holds, not what it claims; and what may never end is refused.
//!
//! Each input is given to the program itself, with 768 MiB of address space and a minute of the
//! processor: what asks for more dies, and the test with it.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

const CAMERA: &str = "[camera]\neye = [0.0, 0.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\nfov_y = 45.0\n\
                      resolution = [8, 6]\n";
const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path(name), bytes).unwrap();
    }

    /// A file of a size that it takes from no disk.
    fn hole(&self, name: &str, start: &[u8], size: u64) {
        let mut file = File::create(self.path(name)).unwrap();
        file.write_all(start).unwrap();
        file.set_len(size).unwrap();
    }

    fn run(&self, arguments: &[&str]) -> (Option<i32>, String) {
        let limited = "ulimit -v 786432; ulimit -t 60; exec \"$@\"";
        let output = Command::new("sh")
            .args(["-c", limited, "sh", env!("CARGO_BIN_EXE_stratcli"), "--threads", "1"])
            .args(arguments)
            .current_dir(self.0.path())
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    }

    /// Refused in one line that has these words.
    #[track_caller]
    fn refuses(&self, arguments: &[&str], words: &[&str]) {
        let (code, stderr) = self.run(arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        for word in words {
            assert!(stderr.contains(word), "{arguments:?}: {word} is not in: {stderr}");
        }
    }
}

#[test]
fn files_that_claim_much_take_little() {
    let folder = Folder::new();
    const GIB: u64 = 1 << 30;
    folder.hole("line.obj", TRIANGLE.as_bytes(), GIB);
    folder.refuses(&["inspect", "line.obj"], &["line.obj, line 5", "longer than"]);
    folder.hole("big.toml", CAMERA.as_bytes(), GIB);
    folder.refuses(&["inspect", "big.toml"], &["big.toml", "larger than 16777216"]);
    folder.refuses(&["study", "big.toml", "-o", "out"], &["big.toml", "larger than 16777216"]);
    folder.hole("big.csv", b"0.5 0.5\n", 1 << 40);
    folder.refuses(&["discrepancy", "big.csv"], &["big.csv", "larger than 1073741824"]);
    let mut head = b"UTK!\x05\0\0\0".to_vec();
    head.extend([0xff; 12]);
    folder.write("head.utk", &head);
    folder.refuses(&["discrepancy", "head.utk"], &["head.utk", "cut off"]);
    folder.write("range.obj", TRIANGLE.replace("f 1 2 3", "f 1 2 4294967295"));
    folder.refuses(&["inspect", "range.obj"], &["line 4", "4294967295", "3 vertices"]);
    folder.write("mtl.obj", "mtllib mtl.mtl\n".to_owned() + TRIANGLE);
    folder.hole("mtl.mtl", b"newmtl a\n", GIB);
    folder.refuses(&["inspect", "mtl.obj"], &["mtl.mtl, line 2", "longer than"]);
    folder.hole("tiles.tiles", b"strat tiles 1\n{\"hash\":\"", GIB);
    folder.refuses(&["merge", "tiles.tiles", "-o", "m.exr"], &["tiles.tiles", "no tiles"]);
}

/// A hundred thousand lines that name one library, or as many meshes as a file may list.
#[test]
fn files_that_repeat_themselves_are_read_once() {
    let folder = Folder::new();
    folder.write("grey.mtl", "newmtl grey\nKd 0.5 0.5 0.5\n".repeat(1000));
    folder.write("again.obj", "mtllib grey.mtl\n".repeat(100_000) + TRIANGLE);
    let (code, stderr) = folder.run(&["inspect", "again.obj"]);
    assert_eq!(code, Some(0), "{stderr}");
    let many: String = (0..1001).map(|i| format!("mtllib {i}.mtl\n")).collect();
    folder.write("many.obj", many + TRIANGLE);
    folder.refuses(&["inspect", "many.obj"], &["line 1001", "material libraries"]);
    let scene = |name: &str, more: &str| folder.write(name, CAMERA.to_owned() + more);
    scene("twice.toml", &"[[mesh]]\nbuiltin = \"grass\"\n".repeat(200));
    folder.refuses(&["inspect", "twice.toml"], &["grass", "twice"]);
    let meshes: String = (0..1001).map(|i| format!("[[mesh]]\npath = \"{i}.obj\"\n")).collect();
    scene("meshes.toml", &meshes);
    folder.refuses(&["inspect", "meshes.toml"], &["1001 meshes", "at most 1000"]);
    let light = "[[light]]\nkind = \"area\"\nshape = \"sphere\"\ncentre = [0, 9, 0]\n\
                 radius = 1.0\nradiance = [1, 1, 1]\n";
    scene("lights.toml", &("[[mesh]]\nbuiltin = \"room\"\n".to_owned() + &light.repeat(2000)));
    folder.refuses(&["inspect", "lights.toml"], &["256 area lights"]);
    scene("itself.toml", "[[mesh]]\npath = \"itself.toml\"\n");
    folder.refuses(&["inspect", "itself.toml"], &["itself.toml", "no faces"]);
    scene("nested.toml", &format!("x = {}", "[".repeat(1_000_000)));
    folder.refuses(&["inspect", "nested.toml"], &["nested.toml, line 6"]);
}

#[test]
fn numbers_that_ask_for_much_are_refused() {
    let folder = Folder::new();
    let wide = |size: &str| {
        let camera = CAMERA.replace("[8, 6]", size);
        folder.write("wide.toml", camera + "[[mesh]]\nbuiltin = \"room-ball\"\n");
    };
    wide("[2147483648, 2147483648]");
    folder.refuses(&["inspect", "wide.toml"], &["resolution", "2^20"]);
    // A picture of 2^40 pixels may be looked at, but not be held.
    wide("[1048576, 1048576]");
    for command in [&["spectrum", "wide.toml"][..], &["trade", "wide.toml", "--needed", "n.exr"]] {
        folder.refuses(command, &["1048576 × 1048576", "resolution"]);
    }
    folder.refuses(
        &["integrand", "ramp", "--samplers", "random", "--counts", "1..1000000000^2"],
        &["--counts", "too many counts"],
    );
    folder.refuses(&["integrand", "ramp", "--trials", "1099511627776"], &["--trials"]);
    folder.refuses(&["integrand", "ramp", "--trials", "4000000000"], &["too many", "10000000"]);
    folder.refuses(&["points", "--sampler", "random", "-n", "8796093022208"], &["fewer"]);
    folder.refuses(
        &["points", "--sampler", "random", "-n", "1", "-d", "1000000000"],
        &["65536 dimensions"],
    );
    folder.refuses(
        &["discrepancy", "--samplers", "lhs", "--counts", "1", "-d", "4000000000"],
        &["65536 dimensions"],
    );
    folder.refuses(
        &["discrepancy", "--samplers", "random", "--counts", "4503599627370496"],
        &["--counts", "2^43"],
    );
}

/// Of four thousand million shards no list is made.
#[test]
fn shards_that_cannot_be_are_refused() {
    let folder = Folder::new();
    let map = ["map", "room", "-o", "a.tiles", "--region", "70,60,72,61", "--counts", "1,16"];
    let (code, stderr) = folder.run(&[&map[..], &["--trials", "2", "--quiet"]].concat());
    assert_eq!(code, Some(0), "{stderr}");
    let bytes = fs::read(folder.path("a.tiles")).unwrap();
    let head: Vec<_> = bytes.split_inclusive(|byte| *byte == b'\n').take(2).collect();
    let head = String::from_utf8(head.concat()).unwrap();
    assert!(head.contains("\"shard\":[1,1]"), "{head}");
    folder.write("b.tiles", head.replace("\"shard\":[1,1]", "\"shard\":[1,4294967295]"));
    folder.refuses(&["merge", "b.tiles", "-o", "b.exr"], &["b.tiles", "no tiles"]);
}

/// A pipe has no writer, a device no end: neither is opened.
#[test]
fn what_may_never_end_is_refused() {
    let folder = Folder::new();
    let made = Command::new("mkfifo").arg(folder.path("pipe.obj")).status().unwrap();
    assert!(made.success());
    for name in ["pipe.toml", "pipe.tiles", "pipe.csv", "out.exr.part", "out.json"] {
        fs::hard_link(folder.path("pipe.obj"), folder.path(name)).unwrap();
    }
    let zero = |name: &str| std::os::unix::fs::symlink("/dev/zero", folder.path(name)).unwrap();
    ["zero.obj", "zero.toml", "zero.mtl", "zero.tiles"].into_iter().for_each(zero);
    folder.write("zero-mtl.obj", "mtllib zero.mtl\n".to_owned() + TRIANGLE);
    let mesh = |path: &str| CAMERA.to_owned() + &format!("[[mesh]]\npath = \"{path}\"\n");
    folder.write("device.toml", mesh("/dev/zero"));
    folder.write("pipes.toml", mesh("pipe.obj"));
    let study = |scene: &str| format!("scenes = [\"{scene}\"]\nsamplers = [\"jittered\"]\n");
    folder.write("study.toml", study("pipe.toml"));
    let no_file = &["no regular file"][..];
    for name in ["pipe.obj", "pipe.toml", "zero.obj", "zero.toml", "zero-mtl.obj", "device.toml"] {
        folder.refuses(&["inspect", name], no_file);
    }
    folder.refuses(&["pixel", "pipes.toml", "--at", "0,0"], no_file);
    folder.refuses(&["discrepancy", "pipe.csv"], no_file);
    folder.refuses(&["points", "--sampler", "file:/dev/zero", "-n", "4"], no_file);
    folder.refuses(&["study", "pipe.toml", "-o", "out"], no_file);
    folder.refuses(&["study", "study.toml", "-o", "out"], no_file);
    folder.refuses(&["merge", "pipe.tiles", "-o", "merged.exr"], no_file);
    folder.refuses(&["merge", "zero.tiles", "-o", "merged.exr"], no_file);
    folder.refuses(&["map", "room", "-o", "out.exr", "--region", "0,0,1,1"], no_file);
    let folder_itself = folder.0.path().to_str().unwrap();
    folder.refuses(&["discrepancy", folder_itself], &["folder"]);
}

/// Scenes and studies say what to read, never where to write.
#[test]
fn nothing_is_written_outside_the_output_folder() {
    let folder = Folder::new();
    fs::create_dir(folder.path("in")).unwrap();
    fs::create_dir(folder.path("out")).unwrap();
    folder.write("up.toml", CAMERA.to_owned() + "[[mesh]]\nbuiltin = \"room-ball\"\n");
    let study = |scenes: &str| {
        folder.write(
            "in/study.toml",
            format!(
                "scenes = [{scenes}]\nsamplers = [\"jittered\"]\ncounts = [1, 4]\ntrials = 3\n"
            ),
        );
    };
    study("\"../up.toml\"");
    let (code, stderr) = folder.run(&["study", "in/study.toml", "-o", "out", "--quiet"]);
    assert_eq!(code, Some(0), "{stderr}");
    let names = |folder: &Path| {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(names(folder.0.path()), ["in", "out", "up.toml"]);
    assert_eq!(names(&folder.path("in")), ["study.toml"]);
    assert!(names(&folder.path("out")).contains(&"up.exr".to_owned()));
    for scene in ["\"..\"", "\"../..\"", "\"summary.toml\"", "\"REPORT.obj\""] {
        study(scene);
        folder.refuses(&["study", "in/study.toml", "-o", "out"], &["study.toml"]);
    }
}

/// What a scene reads is told.
#[test]
fn files_that_were_read_are_reported() {
    let folder = Folder::new();
    folder.write("grey.mtl", "newmtl grey\nKd 0.5 0.5 0.5\n");
    folder.write("mesh.obj", "mtllib grey.mtl\n".to_owned() + TRIANGLE);
    folder.write("scene.toml", CAMERA.to_owned() + "[[mesh]]\npath = \"mesh.obj\"\n");
    let output = Command::new(env!("CARGO_BIN_EXE_stratcli"))
        .args(["inspect", "scene.toml", "--json"])
        .current_dir(folder.0.path())
        .output()
        .unwrap();
    let facts: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(facts["files"], serde_json::json!(["scene.toml", "mesh.obj", "grey.mtl"]));
}
