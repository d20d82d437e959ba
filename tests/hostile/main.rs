//! Bad input survived: parsers under mutated files, plans at random, memory that follows what a
//! file holds, and a command line that ends in one line and a known exit code.
//!
//! METHOD.md, *Reliability*, states the limits that are held here.

#[cfg(target_os = "linux")]
mod bounds;
mod command_line;
mod mutate;
mod plans;
#[path = "../../fuzz/src/lib.rs"]
mod targets;

use mutate::Mutator;
use std::fs;
use std::path::{Path, PathBuf};
use targets::TARGETS;

fn corpus_folder(target: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(target)
}

/// The committed inputs of a target, by name, and those made by today's code.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let entries = fs::read_dir(corpus_folder(target)).into_iter().flatten();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let committed = paths.iter().map(|path| fs::read(path).unwrap());
    committed.chain(targets::seeds::of(target)).collect()
}

/// Runs a target on data; where it panics, says on which.
fn survive(name: &str, target: fn(&[u8]), data: &[u8]) {
    if let Err(panic) = std::panic::catch_unwind(|| target(data)) {
        let path = std::env::temp_dir().join(format!("strat-{name}-{:x}", hash(data)));
        fs::write(&path, data).unwrap();
        eprintln!("{name} does not survive {}: {}", path.display(), data.escape_ascii());
        std::panic::resume_unwind(panic);
    }
}

/// FNV-1a, to name a file after its bytes.
fn hash(data: &[u8]) -> u64 {
    data.iter().fold(0xcbf2_9ce4_8422_2325, |h: u64, byte| {
        (h ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

fn mutations(seed: u64, times: usize) {
    std::thread::scope(|scope| {
        for (name, target) in TARGETS {
            let run = move || {
                let corpus = corpus(name);
                let mut mutator = Mutator::new(&corpus, seed, 5);
                (0..times).for_each(|_| survive(name, *target, &mutator.next()));
            };
            scope.spawn(run);
        }
    });
}

/// Every input that ever broke something is among them.
#[test]
fn the_corpus_is_survived() {
    for (name, target) in TARGETS {
        let inputs = corpus(name);
        assert!(!inputs.is_empty());
        let size: usize = inputs.iter().map(Vec::len).sum();
        assert!(size < 64 << 10, "{name}: keep the corpus small, {size} bytes");
        inputs.iter().for_each(|input| survive(name, *target, input));
    }
}

#[test]
fn mutations_of_the_corpus_are_survived() {
    mutations(1996, 2_000);
}

/// After a change of a format: `fuzz/run.sh` starts from these files.
#[test]
#[ignore = "writes to fuzz/corpus"]
fn renew_the_corpus() {
    for (name, _) in TARGETS {
        for (i, seed) in targets::seeds::of(name).into_iter().enumerate() {
            fs::create_dir_all(corpus_folder(name)).unwrap();
            fs::write(corpus_folder(name).join(format!("seed-{i}")), seed).unwrap();
        }
    }
}

/// Ten million executions. METHOD.md, *Bad input*, says what of it was run.
#[test]
#[ignore = "many minutes; `cargo test --test hostile -- --ignored ten_million`"]
fn ten_million_mutations_are_survived() {
    mutations(6, 10_000_000 / TARGETS.len());
}
