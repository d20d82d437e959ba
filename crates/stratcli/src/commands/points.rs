//! `points`: a sampler's sets, to read and to draw.

use super::Outcome;
use crate::cli::{Common, PointFormat, PointsArgs};
use crate::output::{self, AtomicFile};
use crate::plan;
use crate::report::{PlotFile, points as figure};
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::fmt::Write;
use stratcore::rng::StreamKey;
use stratcore::sampler::{
    CountPolicy, PointSet, Scramble, check_scramble, check_trials, count_used, whole_set,
};

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
    /// Coordinates as text: some two gibibytes.
    const MOST: u64 = 1 << 26;
    /// Dots in one drawing.
    const MOST_DRAWN: u64 = 1 << 16;
    let choice = plan::sampler("--sampler", &args.sampler, args.scramble.as_deref())?;
    let (sampler, scramble) = (choice.sampler, choice.scramble);
    let PointsArgs { n, dim, trial, sets, .. } = *args;
    ensure!(n >= 1, "-n {n}: a set has at least 1 point");
    ensure!(dim >= 1, "--dim {dim}: points have at least 1 dimension");
    check_scramble(sampler, scramble).context("--scramble")?;
    let policy = CountPolicy::from(args.n_policy);
    let n_used = count_used(sampler, n, dim, policy)?;
    let trials = trial.checked_add(sets).context("--trial and --sets: their sum is beyond 2^32")?;
    check_trials(sampler, scramble, n_used, trials)?;
    let coordinates = n_used.saturating_mul(dim as u64).saturating_mul(sets.into());
    ensure!(
        coordinates <= MOST,
        "{sets} × {n_used} points in {dim} dimensions are more coordinates than fit in one text, \
         {MOST}; ask for fewer sets or points"
    );
    let axes = args.plot.as_ref().map(|_| plan::axes(&args.axes, dim)).transpose()?;
    ensure!(
        args.plot.is_none() || n_used <= MOST_DRAWN,
        "--plot: {n_used} points are more than a drawing shows, {MOST_DRAWN}"
    );
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

    let strata = (scramble == Scramble::None).then(|| sampler.strata(n_used, dim)).flatten();
    let (seed, stream) = (common.seed, sampler.stream_id());
    let drawn: Vec<Vec<f64>> = (trial..trials)
        .map(|trial| {
            let key = StreamKey { seed, pixel: [0, 0], sampler: stream, n_samples: n_used, trial };
            let rectangular = policy == CountPolicy::Rect;
            whole_set(sampler, &PointSet { key, dim, scramble, rectangular })
        })
        .collect::<Result<_, _>>()?;

    if let Some((plot, axes)) = plot.zip(axes) {
        let label = crate::report::chart::label(sampler.name(), scramble);
        let title = format!("{label}, N = {n_used}, d = {dim}, trial {trial}");
        plot.commit(&figure::draw(&title, &drawn[0], dim, axes, strata.as_deref()))?;
    }
    let text = match format {
        PointFormat::Csv => as_text(&drawn, dim, ","),
        PointFormat::Utk => as_text(&drawn, dim, " "),
        PointFormat::Json => output::json(PointsDocument {
            sampler: sampler.name(),
            scramble,
            dim,
            n,
            n_used,
            strata: strata.as_deref(),
            seed,
            trial,
            sets: drawn.iter().map(|set| set.chunks_exact(dim).collect()).collect(),
        })?,
    };
    match file {
        Some(file) => file.commit(text.as_bytes())?,
        None => output::print(&text)?,
    }
    if !common.quiet && n_used != n {
        output::note(&format!("note: {} has no {n} points; these are {n_used}", sampler.name()));
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
