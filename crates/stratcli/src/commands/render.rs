//! `render`: the picture of a scene.

use super::Outcome;
use crate::cli::{Common, RenderArgs};
use crate::output::{self, AtomicFile};
use crate::picture::Format;
use crate::plan;
use crate::progress::Progress;
use crate::report::chart::label;
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::ops::Range;
use std::path::Path;
use stratcore::sampler::Scramble;
use stratcore::scene::Rgb;
use stratcore::study::{Control, SamplerChoice, render_pixels};
use stratcore::trace::TracedScene;

/// How a picture was made; an EXR carries it with it.
#[derive(Serialize)]
struct Provenance<'a> {
    scene: &'a str,
    width: u32,
    height: u32,
    sampler: &'static str,
    scramble: Scramble,
    spp: u64,
    exposure: f64,
    seed: u64,
}

#[derive(Serialize)]
struct Rendered<'a> {
    output: &'a Path,
    #[serde(flatten)]
    provenance: Provenance<'a>,
}

pub fn run(args: &RenderArgs, common: &Common) -> Result<Outcome> {
    const MOST_STOPS: f64 = 100.0;
    let RenderArgs { spp, exposure, ref output, .. } = *args;
    let format = Format::of(output)?;
    ensure!(spp >= 1, "--spp {spp}: a picture needs at least 1 sample per pixel");
    ensure!(
        (-MOST_STOPS..=MOST_STOPS).contains(&exposure),
        "--exposure {exposure}: not a finite number of stops from -{MOST_STOPS} to {MOST_STOPS}"
    );
    let choice = SamplerChoice::named(&args.sampler).context("--sampler")?;
    let scene = super::load(&args.scene, common)?;
    let [width, height] = scene.camera.resolution;
    let file = AtomicFile::create(output)?;
    let name = scene.name.clone();
    let samples = spp.saturating_mul(u64::from(width) * u64::from(height));
    let traced = TracedScene::new(scene);
    // What cannot be rendered is refused before the first line.
    render_pixels(&traced, &[], choice, spp, common.seed, Control::unwatched())
        .map_err(plan::about_spp)?;
    let progress = Progress::new("rendering", samples, common);
    let seed = common.seed;
    let (sampler, scramble) = (choice.sampler.name(), choice.scramble);
    let provenance =
        Provenance { scene: &name, width, height, sampler, scramble, spp, exposure, seed };
    let comments = serde_json::to_string(&provenance)?;
    let gain = exposure.exp2();
    let lines = |rows: Range<u32>| -> Result<Vec<Rgb>> {
        let pixels: Vec<_> = rows.flat_map(|y| (0..width).map(move |x| [x, y])).collect();
        let control = progress.control();
        let mut colours = render_pixels(&traced, &pixels, choice, spp, seed, control)?;
        colours.as_flattened_mut().iter_mut().for_each(|value| *value *= gain);
        Ok(colours)
    };
    format
        .write(file.file(), [width, height], &comments, lines)
        .with_context(|| output::unwritten(output))?;
    file.commit_written()?;
    drop(progress);
    if common.json {
        output::print_json(Rendered { output, provenance })?;
    } else {
        output::print(&format!(
            "{}: {name}, {width} × {height} pixels, {} at {spp} spp, seed {seed}\n",
            output.display(),
            label(sampler, scramble),
        ))?;
    }
    Ok(Outcome::Done)
}
