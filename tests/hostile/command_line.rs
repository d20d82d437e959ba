//! The program under mutated command lines: it ends in a known exit code, and a fault is one
//! line.

use super::{corpus, mutate::Mutator};
use std::fs;
use std::process::Command;

#[cfg(unix)]
#[test]
fn every_command_line_ends_in_a_known_exit_code() {
    /// What a shell makes of a process that used up its seconds: it was at work.
    const OUT_OF_TIME: [i32; 2] = [128 + 9, 128 + 24];
    let corpus = corpus("arguments");
    let mut mutator = Mutator::new(&corpus, 300, 1);
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mesh.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    let mut codes = std::collections::BTreeMap::new();
    let mutations = (0..300).map(|_| mutator.next());
    for line in corpus.iter().cloned().chain(mutations) {
        let line = String::from_utf8_lossy(&line).replace(['\0', '/'], "");
        let line = line.replace("classic", "mesh.obj").replace("reproduce", "list");
        // Not by `exec`, nor as the last command: the shell tells of a signal by its own code.
        let output = Command::new("sh")
            .args(["-c", "ulimit -v 1500000; ulimit -t 2; \"$@\"; exit $?", "sh"])
            .args([env!("CARGO_BIN_EXE_stratcli"), "--threads=1", "--quiet"])
            .args(line.split('\n'))
            .current_dir(folder.path())
            .output()
            .unwrap();
        let code = output.status.code().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        if !OUT_OF_TIME.contains(&code) {
            assert!([0, 1, 2, 130].contains(&code), "{line:?}: {code}, {stderr}");
            assert!(code != 2 || stderr.lines().count() == 1, "{line:?}: {stderr}");
        }
        *codes.entry(code).or_insert(0) += 1;
    }
    // Some do what they say, and some are refused.
    assert!(codes[&0] > 10 && codes[&2] > 20, "{codes:?}");
}
