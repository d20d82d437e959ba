//! `study.toml`

use crate::plan::default_counts;
use anyhow::{Context, Result, bail, ensure};
use serde::Deserialize;
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use stratcore::counts::parse_counts;
use stratcore::input::{self, MAX_DOCUMENT};
use stratcore::map::Region;
use stratcore::sampler::{CountPolicy, Scramble};
use stratcore::scene::Channel;
use stratcore::scene::library::SCENES;
use stratcore::study::{SamplerChoice, StudyPlan};
use stratcore::trace::Tracer;

/// The file as written; every key but the scenes and samplers has a default.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Keys {
    scenes: Vec<String>,
    samplers: Vec<String>,
    #[serde(default)]
    scrambles: Vec<String>,
    counts: Option<Counts>,
    #[serde(default = "paper_trials")]
    trials: u32,
    #[serde(default)]
    n_policy: CountPolicy,
    #[serde(default)]
    channel: Channel,
    #[serde(default)]
    tracer: Tracer,
    #[serde(default)]
    exact: bool,
    #[serde(default)]
    points: bool,
    #[serde(default)]
    regions: BTreeMap<String, [u32; 4]>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Counts {
    Text(String),
    List(Vec<u64>),
}

fn paper_trials() -> u32 {
    50
}

/// A study of many scenes.
pub struct StudyFile {
    path: PathBuf,
    keys: Keys,
    samplers: Vec<SamplerChoice>,
    scenes: Vec<SceneEntry>,
    pub channel: Channel,
    pub tracer: Tracer,
    pub exact: bool,
    pub points: bool,
}

/// A scene of a study.
pub struct SceneEntry {
    /// What it is loaded by: a built-in name, or a path.
    pub spec: String,
    /// What its files are called.
    pub name: String,
    /// Which part of its picture; all of it where none is given.
    pub region: Option<Region>,
}

impl StudyFile {
    /// Reads and checks the file. Paths of scenes are relative to it.
    pub fn read(path: &Path) -> Result<Self> {
        let text = input::read_text(path, MAX_DOCUMENT).with_context(|| {
            format!("cannot read {}; give the path of a study's .toml", path.display())
        })?;
        Self::parse(path, &text)
    }

    /// The same of the text of the file at `path`.
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let shown = path.display();
        let keys: Keys = toml::from_str(text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start);
            let line = 1 + text.bytes().take(start).filter(|b| *b == b'\n').count();
            anyhow::anyhow!("{shown}, line {line}: {}", error.message())
        })?;
        let samplers = samplers(&keys).with_context(|| shown.to_string())?;
        let scenes = scenes(&keys, path).with_context(|| shown.to_string())?;
        let Keys { channel, tracer, exact, points, .. } = keys;
        Ok(Self { path: path.to_owned(), keys, samplers, scenes, channel, tracer, exact, points })
    }

    /// Its path, for messages.
    pub fn shown(&self) -> String {
        self.path.display().to_string()
    }

    /// The scenes, in order.
    pub fn scenes(&self) -> &[SceneEntry] {
        &self.scenes
    }

    /// How a pixel of `dim` dimensions is studied.
    pub fn plan(&self, dim: usize, seed: u64) -> Result<StudyPlan> {
        let counts = match &self.keys.counts {
            Some(Counts::Text(text)) => parse_counts(text).context("counts")?,
            Some(Counts::List(list)) => {
                let list: Vec<_> = list.iter().map(u64::to_string).collect();
                parse_counts(&list.join(",")).context("counts")?
            }
            None => default_counts(dim)?,
        };
        Ok(StudyPlan {
            samplers: self.samplers.clone(),
            counts,
            count_policy: self.keys.n_policy,
            n_trials: self.keys.trials,
            seed,
        })
    }
}

/// Every sampler under every listed scramble that it takes and that makes it random; one that
/// takes none of them, or is written with its own, as it is.
fn samplers(keys: &Keys) -> Result<Vec<SamplerChoice>> {
    ensure!(
        !keys.samplers.is_empty(),
        "samplers is empty; name at least one, such as \"jittered\""
    );
    let scrambles = keys
        .scrambles
        .iter()
        .map(|name| name.parse::<Scramble>())
        .collect::<Result<Vec<_>, _>>()
        .context("scrambles")?;
    let mut chosen: Vec<SamplerChoice> = Vec::new();
    for name in &keys.samplers {
        let choice = SamplerChoice::named(name.trim()).context("samplers")?;
        let takes = |scramble: &&Scramble| {
            choice.sampler.scrambles().contains(scramble)
                && choice.sampler.is_randomised(**scramble)
        };
        let mut variants: Vec<_> = scrambles
            .iter()
            .filter(takes)
            .map(|scramble| SamplerChoice { scramble: *scramble, ..choice })
            .collect();
        if name.contains('+') || variants.is_empty() {
            variants = vec![choice];
        }
        chosen.extend(variants);
    }
    let mut seen = HashSet::new();
    for choice in &chosen {
        let (name, scramble) = (choice.sampler.name(), choice.scramble);
        ensure!(
            seen.insert((name, scramble)),
            "samplers: {name} with scramble {scramble} stands there twice; name it once"
        );
    }
    Ok(chosen)
}

fn scenes(keys: &Keys, path: &Path) -> Result<Vec<SceneEntry>> {
    ensure!(!keys.scenes.is_empty(), "scenes is empty; name at least one, such as \"classic\"");
    let mut entries: Vec<SceneEntry> = Vec::new();
    for text in &keys.scenes {
        let is_builtin = SCENES.iter().any(|scene| scene.name == text);
        let spec = if is_builtin {
            text.clone()
        } else {
            path.with_file_name(text).to_string_lossy().into_owned()
        };
        let stem = Path::new(text).file_stem().unwrap_or_default();
        let name = stem.to_string_lossy().into_owned();
        ensure!(
            !name.trim_matches('.').is_empty(),
            "scenes: \"{text}\" has no name to call its files by; give the path of a scene file"
        );
        ensure!(
            !["summary", "report"].contains(&name.to_lowercase().as_str()),
            "scenes: \"{text}\" would be written where the study's own {name} is; rename it"
        );
        if entries.iter().any(|entry| entry.name == name) {
            bail!("scenes: two are called \"{name}\", and so would be their files; rename one");
        }
        let region = keys.regions.get(&name).copied().map(Region::from);
        entries.push(SceneEntry { spec, name, region });
    }
    for name in keys.regions.keys() {
        ensure!(
            entries.iter().any(|entry| &entry.name == name),
            "regions.{name}: no scene is called so; name one of the scenes"
        );
    }
    Ok(entries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read(text: &str) -> Result<StudyFile> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("study.toml");
        fs::write(&path, text).unwrap();
        StudyFile::read(&path)
    }

    #[test]
    fn scrambles_go_to_the_samplers_that_take_them() {
        let study = read(
            "scenes = [\"classic\"]\nsamplers = [\"random\", \"sobol\", \"sobol+xor-shift\"]\n\
             scrambles = [\"owen\", \"owen-hash\"]\ncounts = [1, 4]\ntrials = 3\n",
        )
        .unwrap();
        let plan = study.plan(2, 7).unwrap();
        let labels: Vec<_> =
            plan.samplers.iter().map(|c| format!("{}+{}", c.sampler.name(), c.scramble)).collect();
        assert_eq!(labels, ["random+none", "sobol+owen", "sobol+owen-hash", "sobol+xor-shift"]);
        assert_eq!((plan.counts, plan.n_trials, plan.seed), (vec![1, 4], 3, 7));
    }

    #[test]
    fn each_fault_names_its_key_and_the_way_out() {
        let good = "scenes = [\"classic\"]\nsamplers = [\"jittered\"]\n";
        for (text, words) in [
            ("samplers = [\"jittered\"]\n".to_owned(), ["scenes", "missing"]),
            ("scenes = [\"classic\"]\nsamplers = []\n".to_owned(), ["samplers", "at least one"]),
            ("scenes = []\nsamplers = [\"random\"]\n".to_owned(), ["scenes", "at least one"]),
            (good.replace("jittered", "jitter"), ["samplers", "jittered"]),
            (good.replace("\"classic\"", "\"classic\", \"classic\""), ["scenes", "rename"]),
            (good.replace("classic", "...toml"), ["scenes", "no name"]),
            (good.replace("classic", "a/.."), ["scenes", "no name"]),
            (good.replace("\"jittered\"", "\"jittered\", \"jittered\""), ["samplers", "once"]),
            (good.to_owned() + "scrambles = [\"ovens\"]\n", ["scrambles", "owen"]),
            (good.to_owned() + "sampler = 3\n", ["sampler", "line 3"]),
            (good.to_owned() + "trials = \"many\"\n", ["line 3", "u32"]),
            (good.to_owned() + "[regions]\ngrass = [0, 0, 1, 1]\n", ["regions.grass", "name one"]),
        ] {
            let error = format!("{:#}", read(&text).err().unwrap());
            assert!(error.contains("study.toml"), "{error}");
            assert!(words.iter().all(|word| error.contains(word)), "{text}: {error}");
        }
        let counts = read(&(good.to_owned() + "counts = \"1..x\"\n")).unwrap().plan(2, 1);
        assert!(format!("{:#}", counts.err().unwrap()).contains("counts"));
    }
}
