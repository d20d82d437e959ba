//! `trade --needed`: how many samples each pixel needs, and the proof.

use super::Outcome;
use crate::cli::{Common, TradeArgs};
use crate::output::{self, AtomicFile};
use crate::picture;
use crate::plan;
use crate::progress::Progress;
use crate::report::chart::label;
use crate::report::needed as figures;
use crate::table::number;
use anyhow::{Result, bail, ensure};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::Path;
use stratcore::integrand::Integrand;
use stratcore::sampler::Scramble;
use stratcore::scene::{Channel, Scene};
use stratcore::trace::TracedScene;
use stratcore::trade::needed::{Flatness, Need, NeedMap, Needed, NeededPlan, PixelNeed, needed};

/// No pixel is given more: the proof makes 192 estimates of as many samples.
const MOST: u64 = 1 << 14;

#[derive(Serialize)]
struct Document<'a> {
    scene: &'a str,
    trials: u32,
    seed: u64,
    output: &'a Path,
    picture: &'a Path,
    #[serde(flatten)]
    needed: &'a Needed,
}

pub fn run(scene: Scene, path: &Path, args: &TradeArgs, common: &Common) -> Result<Outcome> {
    ensure!(
        path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr")),
        "--needed {}: name a file that ends in .exr",
        path.display()
    );
    let targets = plan::targets(&args.targets)?;
    let [target] = targets[..] else {
        bail!(
            "--targets {}: --needed makes its map for one error; name one, such as 1%",
            args.targets.join(",")
        )
    };
    let name = scene.name.clone();
    let [width, height] = scene.camera.resolution;
    let traced = TracedScene::new(scene);
    let dim = traced.pixel([0, 0], Channel::Luminance).dim();
    let mut study = plan::study_plan(&args.protocol, common, dim)?;
    // Random points need no map to be beaten: they are mapped where they are asked for alone.
    if study.samplers.iter().any(|choice| choice.sampler.name() != "random") {
        study.samplers.retain(|choice| choice.sampler.name() != "random");
    }
    study.counts_used(dim)?;
    let plan = NeededPlan { target, study, most: MOST };
    let png = path.with_extension("png");
    let (exr_file, png_file) = (AtomicFile::create(path)?, AtomicFile::create(&png)?);

    let steps = 2 * u64::from(width) * u64::from(height) * plan.study.samplers.len() as u64;
    let progress = Progress::new("pixels", steps, common);
    let found = needed(&traced, Channel::Luminance, &plan, progress.control())?;
    drop(progress);

    let (trials, seed) = (plan.study.n_trials, plan.study.seed);
    let document =
        Document { scene: &name, trials, seed, output: path, picture: &png, needed: &found };
    let comments = serde_json::to_string(&document)?;
    exr_file.commit(&picture::exr::encode(found.size, channels(&found), &comments)?)?;
    let drawing = figures::draw(&format!("{name}: samples needed"), &found);
    let png_bytes = drawing.to_png(crate::report::PNG_SCALE).map_err(anyhow::Error::msg)?;
    png_file.commit(&png_bytes)?;

    if common.json {
        output::print_json(&document)?;
    } else {
        output::print(&text(&name, &plan, &found))?;
        output::print(&format!("{}\n{}\n", path.display(), png.display()))?;
    }
    Ok(Outcome::Done)
}

/// R, G and B show the first sampler's N in false colour; names of several samplers' channels
/// begin as those of a map do.
fn channels(found: &Needed) -> Vec<(String, Vec<f32>)> {
    let mut channels = found.maps.first().map(figures::false_colour).unwrap_or_default();
    for map in &found.maps {
        let prefix = match (found.maps.len(), map.scramble) {
            (1, _) => String::new(),
            (_, Scramble::None) => format!("{}.", map.sampler.replace(['.', '/', '\\'], "_")),
            (_, scramble) => format!("{}+{scramble}.", map.sampler.replace(['.', '/', '\\'], "_")),
        };
        let mut add = |name: &str, of: fn(&PixelNeed) -> f64| {
            let values = map.pixels.iter().map(|pixel| of(pixel) as f32).collect();
            channels.push((format!("{prefix}Needed.{name}"), values));
        };
        add("N", |pixel| pixel.n as f64);
        add("rmse", |pixel| pixel.rmse);
        add("rmse_uniform", |pixel| pixel.rmse_uniform);
    }
    channels
}

fn text(name: &str, plan: &NeededPlan, found: &Needed) -> String {
    let [width, height] = found.size;
    let (trials, seed) = (plan.study.n_trials, plan.study.seed);
    let mut text = format!(
        "{name}, {width} × {height} pixels, M = {trials} trials, seed {seed}\n\
         target: an RMS error of {} in every pixel, {} of the mean radiance {}\n\
         proof: {} estimates of each pixel with fresh randomness (seed {})\n",
        number(found.error, 4),
        number(found.error / found.mean_radiance, 3),
        number(found.mean_radiance, 4),
        found.proof_trials,
        found.proof_seed,
    );
    for map in &found.maps {
        let _ = write!(text, "\n{}", sampler_text(map, f64::from(width) * f64::from(height)));
    }
    text
}

fn sampler_text(map: &NeedMap, pixels: f64) -> String {
    let kinds = map.kinds.iter().map(|(need, count)| {
        let words = match need {
            Need::Measured => "within the measured N",
            Need::Extrapolated => "beyond them, by the fit",
            Need::Capped => "capped at the most samples allowed",
            Need::Exact => "exact",
            Need::Rare => "where single samples saw nothing vary",
        };
        format!("{count} {words}")
    });
    let spread = |flat: &Flatness| {
        if flat.rms.is_nan() {
            return "no pixel varies".to_owned();
        }
        let [lo, middle, hi] = flat.percentiles.map(|p| number(p, 3));
        format!(
            "RMS {} of the target; 5, 50, 95 % of pixels below {lo}, {middle}, {hi}; {} % above it",
            number(flat.rms, 3),
            number(100.0 * flat.above, 3)
        )
    };
    format!(
        "{}\n\
         samples needed: {}, {} a pixel in the mean; uniform spp that give every pixel enough: \
         {}\n\
         pixels: {}; an exact one may hide a feature of up to {} of its area (95 %)\n  \
         with the map:     {}\n  uniform, {} spp: {}\n\
         of the pixels with more than one sample:\n  \
         with the map:     {}\n  uniform, {} spp: {}\n",
        label(map.sampler, map.scramble),
        map.total,
        number(map.total as f64 / pixels, 4),
        map.uniform_spp_for_all,
        kinds.collect::<Vec<_>>().join(", "),
        number(map.unseen_share, 2),
        spread(&map.adaptive),
        map.uniform_spp,
        spread(&map.uniform),
        spread(&map.adaptive_above_one),
        map.uniform_spp,
        spread(&map.uniform_above_one),
    )
}
