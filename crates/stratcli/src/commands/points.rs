//! `points`: a sampler's sets, to read and to draw.

use super::Outcome;
use crate::cli::{Common, PointFormat, PointsArgs};
use crate::output::{self, AtomicFile};
use crate::plan;
use crate::report::{PlotFile, points as figure};
use anyhow::{Result, ensure};
use serde::Serialize;
use std::fmt::Write;
use stratcore::sampler::Scramble;

#[derive(Serialize)]
struct PointsDocument<'a> {
    sampler: &'static str,
    scramble: Scramble,
    dim: usize,
    n: u64,
    n_used: u64,
    strata: Option<&'a [u64]>,
    seed: u64,
    /// Trial of the first set.
    trial: u32,
    /// Coordinates, by set and point.
    sets: Vec<Vec<&'a [f64]>>,
}

pub fn run(args: &PointsArgs, common: &Common) -> Result<Outcome> {
    let plan = plan::points(args, common, args.plot.is_some())?;
    let (sampler, scramble) = (plan.choice.sampler, plan.choice.scramble);
    let (n_used, dim) = (plan.set.key.n_samples, plan.set.dim);
    let format = match (args.format, common.json) {
        (None, true) => PointFormat::Json,
        (None, false) => PointFormat::Csv,
        (Some(format), false) => format,
        (Some(format), true) => {
            ensure!(format == PointFormat::Json, "--json and --format: name one of them");
            format
        }
    };
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let file = args.output.as_deref().map(AtomicFile::create).transpose()?;

    let strata = plan.strata();
    let drawn: Vec<Vec<f64>> =
        plan.trials.clone().map(|trial| plan.draw(trial)).collect::<Result<_, _>>()?;

    if let Some((plot, axes)) = plot.zip(plan.axes) {
        let label = crate::report::chart::label(sampler.name(), scramble);
        let title = format!("{label}, N = {n_used}, d = {dim}, trial {}", args.trial);
        plot.commit(&figure::draw(&title, &drawn[0], dim, axes, strata.as_deref()))?;
    }
    let text = match format {
        PointFormat::Csv => as_text(&drawn, dim, ","),
        PointFormat::Utk => as_text(&drawn, dim, " "),
        PointFormat::Json => output::json(PointsDocument {
            sampler: sampler.name(),
            scramble,
            dim,
            n: plan.n,
            n_used,
            strata: strata.as_deref(),
            seed: common.seed,
            trial: args.trial,
            sets: drawn.iter().map(|set| set.chunks_exact(dim).collect()).collect(),
        })?,
    };
    match file {
        Some(file) => file.commit(text.as_bytes())?,
        None => output::print(&text)?,
    }
    if !common.quiet && n_used != plan.n {
        output::note(&format!(
            "note: {} has no {} points; these are {n_used}",
            sampler.name(),
            plan.n
        ));
    }
    Ok(Outcome::Done)
}

/// One point a line, `#` between sets; with commas, a line of names at the top. Every coordinate
/// is the shortest text that reads back as the same number.
fn as_text(sets: &[Vec<f64>], dim: usize, separator: &str) -> String {
    let mut text = String::new();
    if separator == "," {
        let names: Vec<_> = (0..dim).map(|axis| format!("x{axis}")).collect();
        text += &(names.join(separator) + "\n");
    }
    for (i, set) in sets.iter().enumerate() {
        if i > 0 {
            text += "#\n";
        }
        for point in set.chunks_exact(dim) {
            for (axis, x) in point.iter().enumerate() {
                // Writing to a String cannot fail.
                let _ = write!(text, "{}{x}", if axis > 0 { separator } else { "" });
            }
            text.push('\n');
        }
    }
    text
}
