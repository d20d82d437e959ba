//! `list`: the names that can be typed.

use super::Outcome;
use crate::cli::{Common, ListArgs, Listed};
use crate::output;
use crate::table::{Align, columns, short};
use anyhow::Result;
use serde::Serialize;
use stratcore::discrepancy::Measure;
use stratcore::integrand::{CATALOGUE, IntegrandInfo, ParamInfo};
use stratcore::sampler::{Facts, Kind, SHELF, Sampler, Scramble};
use stratcore::scene::library::SCENES;
use stratcore::stability::FAMILIES;

#[derive(Serialize)]
struct SamplerEntry {
    name: &'static str,
    summary: &'static str,
    source: &'static str,
    kind: Kind,
    /// None where there is no limit.
    max_dim: Option<usize>,
    /// The N it has, in words.
    counts: String,
    scrambles: &'static [Scramble],
}

#[derive(Serialize)]
struct IntegrandEntry {
    name: &'static str,
    summary: &'static str,
    min_dim: usize,
    max_dim: usize,
    params: Vec<ParamEntry>,
}

#[derive(Serialize)]
struct ParamEntry {
    name: &'static str,
    default: f64,
    min: f64,
    max: f64,
    meaning: &'static str,
}

/// What has a name and one line of help.
#[derive(Serialize)]
struct NamedEntry {
    name: &'static str,
    summary: &'static str,
}

#[derive(Serialize)]
struct DiscrepancyEntry {
    name: &'static str,
    summary: &'static str,
    /// The one dimension it is defined for.
    only_dim: Option<usize>,
}

#[derive(Serialize)]
struct Listing {
    #[serde(skip_serializing_if = "Option::is_none")]
    samplers: Option<Vec<SamplerEntry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    integrands: Option<Vec<IntegrandEntry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    scenes: Option<Vec<NamedEntry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    discrepancies: Option<Vec<DiscrepancyEntry>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extremes: Option<Vec<NamedEntry>>,
}

pub fn run(args: &ListArgs, common: &Common) -> Result<Outcome> {
    let wanted = |what| args.what.is_none_or(|only| only == what);
    let listing = Listing {
        samplers: wanted(Listed::Samplers).then(samplers),
        integrands: wanted(Listed::Integrands).then(integrands),
        scenes: wanted(Listed::Scenes).then(scenes),
        discrepancies: wanted(Listed::Discrepancies).then(discrepancies),
        extremes: wanted(Listed::Extremes).then(extremes),
    };
    if common.json {
        output::print_json(listing)?;
    } else {
        output::print(&text(&listing))?;
    }
    Ok(Outcome::Done)
}

fn samplers() -> Vec<SamplerEntry> {
    let entry = |s: &&dyn Sampler| {
        let Facts { name, summary, source, kind, max_dim, counts, scrambles, .. } = s.facts();
        let max_dim = (max_dim < usize::MAX).then_some(max_dim);
        let counts = counts.to_string();
        SamplerEntry { name, summary, source, kind, max_dim, counts, scrambles }
    };
    SHELF.iter().map(entry).collect()
}

fn integrands() -> Vec<IntegrandEntry> {
    let param = |p: &ParamInfo| {
        let ParamInfo { name, default, min, max, meaning } = *p;
        ParamEntry { name, default, min, max, meaning }
    };
    let entry = |info: &IntegrandInfo| IntegrandEntry {
        name: info.name,
        summary: info.summary,
        min_dim: info.min_dim,
        max_dim: info.max_dim,
        params: info.params.iter().map(param).collect(),
    };
    CATALOGUE.iter().map(entry).collect()
}

fn scenes() -> Vec<NamedEntry> {
    SCENES.iter().map(|s| NamedEntry { name: s.name, summary: s.summary }).collect()
}

fn discrepancies() -> Vec<DiscrepancyEntry> {
    let entry = |m: Measure| DiscrepancyEntry {
        name: m.name(),
        summary: m.summary(),
        only_dim: m.only_dim(),
    };
    Measure::ALL.map(entry).into()
}

fn extremes() -> Vec<NamedEntry> {
    FAMILIES.iter().map(|f| NamedEntry { name: f.name, summary: f.title }).collect()
}

fn text(listing: &Listing) -> String {
    let named = |name: &str, summary: &str| vec![name.to_owned(), summary.to_owned()];
    let mut sections = Vec::new();
    if let Some(samplers) = &listing.samplers {
        let mut rows = Vec::new();
        for sampler in samplers {
            rows.push(named(sampler.name, sampler.summary));
            let kind = match sampler.kind {
                Kind::Set => "set",
                Kind::Sequence => "sequence",
            };
            let dims = sampler.max_dim.map_or("any d".to_owned(), |most| format!("d <= {most}"));
            rows.push(named("", &format!("{kind}, {dims}, N = {}", sampler.counts)));
            if let [default, others @ ..] = sampler.scrambles
                && !others.is_empty()
            {
                let others: Vec<_> = others.iter().map(|s| format!("+{s}")).collect();
                rows.push(named("", &format!("scramble {default}; or {}", others.join(", "))));
            }
            rows.push(named("", sampler.source));
        }
        rows.push(named("file:PATH", "your own point sets: CSV, or UTK text or binary"));
        sections.push(("samplers", rows));
    }
    if let Some(integrands) = &listing.integrands {
        let mut rows = Vec::new();
        for integrand in integrands {
            rows.push(named(integrand.name, integrand.summary));
            rows.extend(integrand.params.iter().map(|p| {
                named("", &format!("--set {}={}: {}", p.name, short(p.default, 4), p.meaning))
            }));
        }
        sections.push(("integrands", rows));
    }
    if let Some(scenes) = &listing.scenes {
        sections.push(("scenes", scenes.iter().map(|s| named(s.name, s.summary)).collect()));
    }
    if let Some(measures) = &listing.discrepancies {
        let row = |m: &DiscrepancyEntry| named(m.name, m.summary);
        sections.push(("discrepancies", measures.iter().map(row).collect()));
    }
    if let Some(families) = &listing.extremes {
        sections.push(("extremes", families.iter().map(|f| named(f.name, f.summary)).collect()));
    }
    let section =
        |(title, rows): (&str, Vec<_>)| format!("{title}\n{}", columns(Align::Left, &rows));
    sections.into_iter().map(section).collect::<Vec<_>>().join("\n")
}
