//! `list`: the names that can be typed.

use super::Outcome;
use crate::cli::{Common, ListArgs, Listed};
use crate::output;
use crate::table::{Align, columns};
use anyhow::Result;
use serde::Serialize;
use stratcore::sampler::{SHELF, Scramble};
use stratcore::scene::library::SCENES;

#[derive(Serialize)]
struct SamplerEntry {
    name: &'static str,
    summary: &'static str,
    source: &'static str,
    scrambles: &'static [Scramble],
}

#[derive(Serialize)]
struct SceneEntry {
    name: &'static str,
    summary: &'static str,
}

#[derive(Serialize)]
struct Listing {
    #[serde(skip_serializing_if = "Option::is_none")]
    samplers: Option<Vec<SamplerEntry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scenes: Option<Vec<SceneEntry>>,
}

pub fn run(args: &ListArgs, common: &Common) -> Result<Outcome> {
    let wanted = |what| args.what.is_none_or(|only| only == what);
    let samplers = || {
        let entry = |s: &&dyn stratcore::sampler::Sampler| SamplerEntry {
            name: s.name(),
            summary: s.summary(),
            source: s.source(),
            scrambles: s.scrambles(),
        };
        SHELF.iter().map(entry).collect()
    };
    let scenes =
        || SCENES.iter().map(|s| SceneEntry { name: s.name, summary: s.summary }).collect();
    let listing = Listing {
        samplers: wanted(Listed::Samplers).then(samplers),
        scenes: wanted(Listed::Scenes).then(scenes),
    };
    if common.json {
        output::print_json(listing)?;
    } else {
        output::print(&text(&listing))?;
    }
    Ok(Outcome::Done)
}

fn text(listing: &Listing) -> String {
    let named = |name: &str, summary: &str| vec![name.to_owned(), summary.to_owned()];
    let samplers = listing.samplers.iter().flatten().map(|s| named(s.name, s.summary)).collect();
    let scenes = listing.scenes.iter().flatten().map(|s| named(s.name, s.summary)).collect();
    let sections: [(&str, Vec<_>); 2] = [("samplers", samplers), ("scenes", scenes)];
    let filled = sections.iter().filter(|(_, rows)| !rows.is_empty());
    let sections = filled.map(|(title, rows)| format!("{title}\n{}", columns(Align::Left, rows)));
    sections.collect::<Vec<_>>().join("\n")
}
