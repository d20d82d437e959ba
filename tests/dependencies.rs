//! What is built into strat obeys `deny.toml`: where crates come from, under which licences, and
//! which of them there may be one version of. No network is needed: what is asked is `Cargo.lock`,
//! for every platform, and for licences the manifests of the crates built here.

use serde::Deserialize;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(Deserialize)]
struct Policy {
    licenses: Licenses,
    bans: Bans,
    sources: Sources,
}

#[derive(Deserialize)]
struct Licenses {
    allow: HashSet<String>,
}

#[derive(Deserialize)]
struct Bans {
    deny: Vec<Ban>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Ban {
    #[serde(rename = "crate")]
    name: String,
    #[serde(default)]
    deny_multiple_versions: bool,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Sources {
    allow_registry: Vec<String>,
    allow_git: Vec<String>,
}

#[derive(Deserialize)]
struct Lock {
    package: Vec<Locked>,
}

#[derive(Deserialize)]
struct Locked {
    name: String,
    version: String,
    source: Option<String>,
    checksum: Option<String>,
}

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
    resolve: Resolve,
}

#[derive(Deserialize)]
struct Resolve {
    nodes: Vec<Node>,
}

#[derive(Deserialize)]
struct Node {
    id: String,
}

#[derive(Deserialize)]
struct Package {
    id: String,
    name: String,
    license: Option<String>,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read<T: for<'de> Deserialize<'de>>(name: &str) -> T {
    let text = std::fs::read_to_string(root().join(name)).unwrap();
    toml::from_str(&text).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Whether an SPDX expression can be met by these licences. Old manifests write / for OR.
fn is_met(expression: &str, allowed: &HashSet<String>) -> bool {
    let spaced = expression.replace('(', " ( ").replace(')', " ) ").replace('/', " OR ");
    let words: Vec<_> = spaced.split_whitespace().collect();
    let mut at = 0;
    let met = any(&words, &mut at, allowed);
    met && at == words.len()
}

fn any(words: &[&str], at: &mut usize, allowed: &HashSet<String>) -> bool {
    let mut met = all(words, at, allowed);
    while words.get(*at) == Some(&"OR") {
        *at += 1;
        met |= all(words, at, allowed);
    }
    met
}

fn all(words: &[&str], at: &mut usize, allowed: &HashSet<String>) -> bool {
    let mut met = one(words, at, allowed);
    while words.get(*at) == Some(&"AND") {
        *at += 1;
        met &= one(words, at, allowed);
    }
    met
}

fn one(words: &[&str], at: &mut usize, allowed: &HashSet<String>) -> bool {
    let Some(word) = words.get(*at) else { return false };
    *at += 1;
    if *word == "(" {
        let met = any(words, at, allowed);
        *at += 1;
        return met && words.get(*at - 1) == Some(&")");
    }
    let mut name = (*word).to_owned();
    if let Some(["WITH", exception]) = words.get(*at..*at + 2) {
        *at += 2;
        name += &format!(" WITH {exception}");
    }
    allowed.contains(&name)
}

#[test]
fn expressions_of_licences_are_read() {
    let allowed = ["MIT", "Zlib", "Apache-2.0 WITH LLVM-exception"].map(str::to_owned).into();
    for (expression, met) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("GPL-3.0 OR MIT", true),
        ("GPL-3.0/MIT", true),
        ("MIT AND GPL-3.0", false),
        ("(MIT OR GPL-3.0) AND Zlib", true),
        ("(MIT OR Zlib) AND GPL-3.0", false),
        ("MIT OR Zlib AND GPL-3.0", true),
        ("Apache-2.0 WITH LLVM-exception", true),
        ("Apache-2.0", false),
        ("(MIT", false),
        ("", false),
    ] {
        assert_eq!(is_met(expression, &allowed), met, "{expression}");
    }
}

/// Of every platform.
#[test]
fn crates_come_from_where_they_may_and_once() {
    let policy: Policy = read("deny.toml");
    assert!(policy.sources.allow_git.is_empty());
    for lock in ["Cargo.lock", "fuzz/Cargo.lock"] {
        let packages = read::<Lock>(lock).package;
        let mut versions: HashMap<&str, Vec<&str>> = HashMap::new();
        for Locked { name, version, source, checksum } in &packages {
            versions.entry(name).or_default().push(version);
            // Our own crates have no source.
            let Some(source) = source else {
                assert!(name.starts_with("strat"), "{lock}: {name} comes from a folder");
                continue;
            };
            let registry = source.strip_prefix("registry+").unwrap_or("no registry");
            let known = policy.sources.allow_registry.iter().any(|allowed| allowed == registry);
            assert!(known, "{lock}: {name} comes from {source}");
            assert!(checksum.is_some(), "{lock}: {name} has no checksum");
        }
        for Ban { name, deny_multiple_versions } in &policy.bans.deny {
            let found = versions.get(name.as_str()).map_or(&[][..], Vec::as_slice);
            let most = usize::from(*deny_multiple_versions);
            assert!(found.len() <= most, "{lock}: {name} {}", found.join(", "));
        }
    }
}

/// Of this platform, with what tests and builds need: the manifests of others are not there.
#[test]
fn licences_are_allowed() {
    let policy: Policy = read("deny.toml");
    let output = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()))
        .args(["metadata", "--locked", "--format-version", "1", "--filter-platform"])
        .arg(host())
        .current_dir(root())
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{stderr}");
    let Metadata { packages, resolve } = serde_json::from_slice(&output.stdout).unwrap();
    let used: HashSet<_> = resolve.nodes.iter().map(|node| &node.id).collect();
    let mut n = 0;
    for Package { name, license, .. } in packages.iter().filter(|p| used.contains(&p.id)) {
        let expression = license.as_deref().unwrap_or("none");
        assert!(is_met(expression, &policy.licenses.allow), "{name}: {expression}");
        n += 1;
    }
    assert!(n > 100, "{n} crates");
}

fn host() -> String {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc).arg("-vV").output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("host: "));
    line.expect("rustc names its host").to_owned()
}
