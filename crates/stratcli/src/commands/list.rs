//! `list`: the names that can be typed.

use super::Outcome;
use crate::cli::{Common, ListArgs, Listed};
use crate::output;
use crate::table::{Align, columns};
use anyhow::Result;
use serde::Serialize;
use stratcore::sampler::{SHELF, Scramble};

#[derive(Serialize)]
struct SamplerEntry {
    name: &'static str,
    summary: &'static str,
    source: &'static str,
    scrambles: &'static [Scramble],
}

#[derive(Serialize)]
struct Listing {
    #[serde(skip_serializing_if = "Option::is_none")]
    samplers: Option<Vec<SamplerEntry>>,
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
    let listing = Listing { samplers: wanted(Listed::Samplers).then(samplers) };
    if common.json {
        output::print_json(listing)?;
    } else {
        output::print(&text(&listing))?;
    }
    Ok(Outcome::Done)
}

fn text(listing: &Listing) -> String {
    let mut text = String::new();
    if let Some(samplers) = &listing.samplers {
        let rows: Vec<_> =
            samplers.iter().map(|s| vec![s.name.to_owned(), s.summary.to_owned()]).collect();
        text += &format!("samplers\n{}", columns(Align::Left, &rows));
    }
    text
}
