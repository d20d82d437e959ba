//! `render`: the picture of a scene.

use super::Outcome;
use crate::cli::{Common, RenderArgs};
use crate::output::{self, AtomicFile};
use crate::picture::Format;
use crate::progress::Progress;
use crate::report::chart::label;
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::path::Path;
use stratcore::sampler::Scramble;
use stratcore::study::{SamplerChoice, render};
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
    /// 24 bytes each, twice.
    const MOST_PIXELS: u64 = 1 << 28;
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
    ensure!(
        u64::from(width) * u64::from(height) <= MOST_PIXELS,
        "{}: {width} × {height} pixels are more than a picture in memory may have, {MOST_PIXELS}; \
         lower the camera's resolution",
        args.scene,
    );
    let file = AtomicFile::create(output)?;

    let name = scene.name.clone();
    let samples = spp.saturating_mul(u64::from(width) * u64::from(height));
    let traced = TracedScene::new(scene);
    let progress = Progress::new("rendering", samples, common);
    let mut picture = render(&traced, choice, spp, common.seed, progress.control())?;
    drop(progress);

    let gain = exposure.exp2();
    for value in picture.pixels.as_flattened_mut() {
        *value *= gain;
    }
    let seed = common.seed;
    let (sampler, scramble) = (choice.sampler.name(), choice.scramble);
    let provenance =
        Provenance { scene: &name, width, height, sampler, scramble, spp, exposure, seed };
    let comments = serde_json::to_string(&provenance)?;
    file.commit(&format.encode([width, height], &picture.pixels, &comments)?)?;
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
