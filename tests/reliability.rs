//! Files under stress: killed processes, full disks, folders that cannot be written to, memory,
//! and what a scene or a study may name.

#![cfg(target_os = "linux")]

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

const STRATCLI: &str = env!("CARGO_BIN_EXE_stratcli");

/// Commands that write, the words `OUT` and `DIR` standing for a file's stem and a folder, and
/// the files that they leave.
const WRITERS: &[(&str, &[&str])] = &[
    ("render quad.toml --spp 1 -o OUT.png", &["OUT.png"]),
    ("render quad.toml --spp 1 -o OUT.exr", &["OUT.exr"]),
    ("pixel quad.toml --at 4,3 --trials 5 --plot OUT.svg", &["OUT.svg"]),
    ("integrand ramp --trials 5 --plot OUT.png", &["OUT.png"]),
    ("points --sampler random -n 4096 -o OUT.csv", &["OUT.csv"]),
    ("points --sampler random -n 64 --plot OUT.svg", &["OUT.svg"]),
    ("discrepancy --samplers random --counts 4,16 --trials 5 --plot OUT.svg", &["OUT.svg"]),
    ("discrepancy --samplers random,jittered --trials 5 --csv OUT.csv", &["OUT.csv"]),
    ("spectrum --samplers random -n 16 --trials 5 --plot OUT.svg", &["OUT.svg"]),
    ("spectrum --samplers random -n 16 --trials 5 --csv OUT.csv", &["OUT.csv"]),
    ("spectrum --samplers random -n 16 --trials 5 -o OUT.exr", &["OUT.exr"]),
    ("trade ramp --trials 10 --counts 1,4,9,16 --csv OUT.csv", &["OUT.csv"]),
    ("trade ramp --trials 10 --counts 1,4,9,16 --plot OUT.svg", &["OUT.svg"]),
    ("trade ramp --trials 10 --counts 1,4,9,16 --report DIR", &["DIR/trade.html"]),
    ("trade quad.toml --trials 10 --counts 1,4,9,16 --needed OUT.exr", &["OUT.exr", "OUT.png"]),
    (
        "map quad.toml --trials 5 --counts 1,4 --points -o OUT.exr",
        &["OUT.exr", "OUT.png", "OUT.fits.csv", "OUT.points.csv", "OUT.json"],
    ),
    ("map quad.toml --trials 5 --counts 1,4 -o OUT.tiles", &["OUT.tiles"]),
    ("merge all.tiles -o OUT.exr", &["OUT.exr", "OUT.png", "OUT.fits.csv", "OUT.json"]),
    ("study study.toml -o DIR", &["DIR/quad.exr", "DIR/report.html", "DIR/summary.json"]),
];

/// A folder with a scene, a study and a finished file of tiles.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("quad.obj", "v -1 -1 0\nv 0.3 -1 0\nv 0.3 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n");
        folder.write("quad.toml", &quad([64, 48]));
        folder.write(
            "study.toml",
            "scenes = [\"quad.toml\"]\nsamplers = [\"jittered\"]\ntrials = 5\ncounts = [1, 4]\n",
        );
        let output = folder.run("map quad.toml --trials 5 --counts 1,4 -o all.tiles");
        assert!(output.status.success());
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn command(&self, words: &str) -> Command {
        let mut command = Command::new(STRATCLI);
        command.current_dir(self.0.path()).args(words.split(' ')).arg("--quiet");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, words: &str) -> Output {
        self.command(words).output().unwrap()
    }

    /// Every file below the folder, and its bytes.
    fn files(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let (mut files, mut folders) = (BTreeMap::new(), vec![self.0.path().to_owned()]);
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
                if entry.is_dir() {
                    folders.push(entry);
                } else {
                    let bytes = fs::read(&entry).unwrap();
                    files.insert(entry.strip_prefix(self.0.path()).unwrap().to_owned(), bytes);
                }
            }
        }
        files
    }
}

fn quad([width, height]: [u32; 2]) -> String {
    format!(
        "[camera]\neye = [0.0, 0.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\nfov_y = 45.0\n\
         resolution = [{width}, {height}]\n[[mesh]]\npath = \"quad.obj\"\n"
    )
}

/// One line that says what is wrong with which file.
#[track_caller]
fn refused(words: &str, output: &Output, file: &str) {
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{words}: {stderr}");
    assert_eq!(stderr.lines().count(), 1, "{words}: {stderr}");
    assert!(stderr.contains("cannot write") && stderr.contains(file), "{words}: {stderr}");
}

/// A limit on the size of files stands for a full disk: what cannot be written whole is not
/// there at all, and an older file of that name is untouched.
#[test]
fn a_full_disk_leaves_older_files_whole_and_no_halves() {
    let folder = Folder::new();
    for (words, files) in WRITERS {
        let named = |text: &str| text.replace("OUT", "out").replace("DIR", "dir");
        let (words, names) = (named(words), files.iter().map(|f| named(f)).collect::<Vec<_>>());
        fs::create_dir_all(folder.path("dir")).unwrap();
        names.iter().for_each(|name| folder.write(name, "older"));
        let before = folder.files();
        let limited = "trap '' XFSZ; ulimit -f 1; exec \"$0\" \"$@\"";
        let output = Command::new("sh")
            .current_dir(folder.0.path())
            .args(["-c", limited, STRATCLI])
            .args(words.split(' '))
            .arg("--quiet")
            .output()
            .unwrap();
        refused(&words, &output, names[0].split('.').next().unwrap());
        let mut after = folder.files();
        // Finished tiles are kept, to be gone on with.
        after.retain(|path, _| path.extension().is_none_or(|ending| ending != "part"));
        let changed: Vec<_> =
            after.iter().filter(|(path, b)| before.get(*path) != Some(b)).collect();
        assert!(changed.is_empty() && after.len() == before.len(), "{words}: {changed:?}");
        // With room it goes on.
        let resume = if words.starts_with("map") { " --resume" } else { "" };
        let output = folder.run(&(words.clone() + resume));
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        for name in &names {
            assert_ne!(fs::read(folder.path(name)).unwrap(), b"older", "{words}: {name}");
            fs::remove_file(folder.path(name)).unwrap();
        }
        let _ = fs::remove_dir_all(folder.path("dir"));
        folder.files().into_keys().for_each(|path| {
            let name = path.to_string_lossy();
            assert!(!name.contains("tmp") && !name.contains("part"), "{words}: {name}");
            if name.starts_with("out.") {
                fs::remove_file(folder.path(&name)).unwrap();
            }
        });
    }
}

/// Whoever may write everywhere is tried as a user who may not.
#[test]
fn a_folder_that_cannot_be_written_to_is_named_before_any_work() {
    let folder = Folder::new();
    fs::create_dir(folder.path("locked")).unwrap();
    let allow = |mode| fs::set_permissions(folder.path("locked"), PermissionsExt::from_mode(mode));
    allow(0o555).unwrap();
    fs::set_permissions(folder.0.path(), PermissionsExt::from_mode(0o755)).unwrap();
    let is_root = fs::write(folder.path("locked/probe"), "").is_ok();
    let open = |path: &Path| fs::metadata(path).is_ok_and(|m| m.permissions().mode() & 1 == 1);
    let reachable = |path: &Path| path.ancestors().all(open);
    if is_root && !(reachable(STRATCLI.as_ref()) && reachable(folder.0.path())) {
        eprintln!("not tried: nobody else can run {STRATCLI} in {}", folder.0.path().display());
        return;
    }
    for (words, files) in WRITERS {
        let named = |text: &str| text.replace("OUT", "locked/out").replace("DIR", "locked/dir");
        let words = named(words);
        let mut command = folder.command(&words);
        if is_root {
            command.uid(65534).gid(65534);
        }
        let output = command.output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words}: {stderr}");
        assert!(output.stdout.is_empty() && stderr.lines().count() == 1, "{words}: {stderr}");
        let name = named(files[0]);
        let stem = name.split('.').next().unwrap();
        let stem = stem.strip_suffix("/trade").or(stem.strip_suffix("/quad")).unwrap_or(stem);
        assert!(stderr.contains(stem) && stderr.contains("choose"), "{words}: {stderr}");
    }
    allow(0o755).unwrap();
}

/// Neither a scene nor a study can name a place to write to: results go where the command line
/// says, whatever files are called, and a scene's files are listed.
#[test]
fn what_files_are_called_decides_nothing_but_what_is_read() {
    let folder = Folder::new();
    fs::create_dir_all(folder.path("work/deep")).unwrap();
    fs::create_dir(folder.path("away")).unwrap();
    let mesh = "mtllib ../away/far.mtl\nmtllib $(touch pwned).mtl\n\
                v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    folder.write("away/far.obj", mesh);
    folder.write("away/far.mtl", "newmtl m\nKd 1 1 1\nmap_Kd |touch pwned\nmap_Bump /etc/x\n");
    let far = folder.path("away/far.obj");
    for (name, path) in [("up", "../../away/far.obj"), ("root", far.to_str().unwrap())] {
        let scene = quad([32, 32]).replace("quad.obj", path);
        folder.write(&format!("work/deep/{name}.toml"), &scene);
    }
    folder.write("away/other.toml", &quad([32, 32]).replace("quad.obj", "far.obj"));
    let absolute = folder.path("work/deep/root.toml");
    let study = format!(
        "scenes = [\"deep/up.toml\", \"../away/other.toml\", {absolute:?}]\n\
         samplers = [\"jittered\"]\ntrials = 5\ncounts = [1, 4]\n"
    );
    folder.write("work/study.toml", &study);
    let before = folder.files();
    let output = folder.run("study work/study.toml -o results");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let new: Vec<_> =
        folder.files().into_keys().filter(|path| !before.contains_key(path)).collect();
    assert!(new.iter().all(|path| path.starts_with("results")), "{new:?}");
    for stem in ["up", "other", "root"] {
        assert!(new.contains(&PathBuf::from(format!("results/{stem}.exr"))), "{new:?}");
    }

    let output = folder.run("inspect work/deep/up.toml --json");
    let facts: Value = serde_json::from_slice(&output.stdout).unwrap();
    let files: Vec<_> =
        facts["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
    let meant = [
        "work/deep/up.toml",
        "work/deep/../../away/far.obj",
        "work/deep/../../away/../away/far.mtl",
    ];
    assert_eq!(files, meant);
    let notes = facts["notes"].to_string();
    assert!(notes.contains("2 textures are not read") && notes.contains("is missing"), "{notes}");
    let text = String::from_utf8(folder.run("inspect work/deep/up.toml").stdout).unwrap();
    assert!(meant.iter().all(|file| text.contains(file)), "{text}");
}

/// Peak of a process's resident memory, and whether it succeeded.
fn peak_bytes(mut command: Command) -> u64 {
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    loop {
        // Gone, or a zombie without the line, once it has ended.
        let text = fs::read_to_string(&status).unwrap_or_default();
        if let Some(line) = text.lines().find(|line| line.starts_with("VmHWM:")) {
            let kilobytes: u64 = line.split_whitespace().nth(1).unwrap().parse().unwrap();
            peak = peak.max(1024 * kilobytes);
        }
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "{command:?}");
            return peak;
        }
        std::thread::sleep(Duration::from_millis(3));
    }
}

/// What the scene itself takes, by `inspect`.
fn scene_bytes(folder: &Folder, scene: &str) -> u64 {
    let facts: Value =
        serde_json::from_slice(&folder.run(&format!("inspect {scene} --json")).stdout).unwrap();
    let memory = &facts["memory_bytes"];
    memory["scene"].as_u64().unwrap() + memory["bvh"].as_u64().unwrap()
}

#[track_caller]
fn fits(folder: &Folder, scene: &str, words: &str) {
    /// What a command may take besides its scene.
    const ROOM: u64 = 256 << 20;
    let peak = peak_bytes(folder.command(words));
    let allowed = scene_bytes(folder, scene) + ROOM;
    eprintln!("{words}: {} MB of {} MB", peak / 1_000_000, allowed / 1_000_000);
    assert!(peak > 0 && peak < allowed, "{words}: {peak} bytes");
}

#[test]
fn a_million_trials_and_wide_pictures_fit_in_memory() {
    let folder = Folder::new();
    folder.write("wide.toml", &quad([16384, 64]));
    for words in [
        "pixel classic --at 176,163 --trials 1000000 --counts 1,4",
        "map classic --region 100,140,116,142 --trials 1000000 --counts 1 -o m.exr",
    ] {
        fits(&folder, "classic", words);
    }
    for words in [
        "render wide.toml --spp 1 -o r.exr",
        "render wide.toml --spp 1 -o r.png",
        "map wide.toml --region 0,0,16384,32 --trials 2 --counts 1,4 -o m2.exr",
    ] {
        fits(&folder, "wide.toml", words);
    }
}

/// `cargo test -p stratcli --test reliability -- --ignored --nocapture sixteen`
#[test]
#[ignore = "some minutes, and 4 GB of disk"]
fn sixteen_thousand_pixels_square_fit_in_memory() {
    let folder = Folder::new();
    folder.write("whole.toml", &quad([16384, 16384]));
    for words in [
        "render whole.toml --spp 1 -o r.exr",
        "render whole.toml --spp 1 -o r.png",
        "map whole.toml --region 0,6000,16384,7024 --trials 2 --counts 1,4 -o m.exr",
    ] {
        fits(&folder, "whole.toml", words);
        folder
            .files()
            .into_keys()
            .filter(|path| path.starts_with("r") || path.starts_with("m"))
            .for_each(|path| {
                fs::remove_file(folder.path(&path.to_string_lossy())).unwrap();
            });
    }
}
