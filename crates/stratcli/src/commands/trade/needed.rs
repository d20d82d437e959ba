//! `trade --needed`: how many samples each pixel needs, and the proof.

use super::Outcome;
use crate::cli::{Common, TradeArgs};
use crate::output::{self, AtomicFile};
use crate::picture;
use crate::plan;
use crate::progress::Progress;
use crate::report::needed as figures;
use crate::table::number;
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::path::Path;
use stratcore::scene::{Channel, Scene};
use stratcore::trace::TracedScene;
use stratcore::trade::needed::{Flatness, Need, Needed, NeededPlan, needed};

/// No pixel is given more: the proof makes 192 estimates of as many samples.
const MOST: u64 = 1 << 14;

#[derive(Serialize)]
struct Document<'a> {
    scene: &'a str,
    sampler: &'static str,
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
    let mut study = plan::trade_study_plan(args, common, 2)?;
    // Random points need no map of their own kind to be beaten: the first other sampler is meant.
    study.samplers.sort_by_key(|choice| choice.sampler.name() == "random");
    study.counts_used(2)?;
    let target = *plan::targets(&args.targets)?.first().context("--targets is empty")?;
    let plan = NeededPlan { sampler: study.samplers[0], target, study, most: MOST };
    let png = path.with_extension("png");
    let (exr_file, png_file) = (AtomicFile::create(path)?, AtomicFile::create(&png)?);

    let name = scene.name.clone();
    let [width, height] = scene.camera.resolution;
    let traced = TracedScene::new(scene);
    let pixels = u64::from(width) * u64::from(height);
    let per_pixel = plan.study.counts.iter().sum::<u64>() * u64::from(plan.study.n_trials);
    let progress = Progress::new("pixels", pixels.saturating_mul(per_pixel), common);
    let found = needed(&traced, Channel::Luminance, &plan, progress.control())?;
    drop(progress);

    let sampler = plan.sampler.sampler.name();
    let (trials, seed) = (plan.study.n_trials, plan.study.seed);
    let document = Document {
        scene: &name,
        sampler,
        trials,
        seed,
        output: path,
        picture: &png,
        needed: &found,
    };
    let comments = serde_json::to_string(&document)?;
    let column = |of: fn(&stratcore::trade::needed::PixelNeed) -> f64| -> Vec<f32> {
        found.pixels.iter().map(|pixel| of(pixel) as f32).collect()
    };
    let mut channels = figures::false_colour(&found);
    channels.extend([
        ("Needed.N".to_owned(), column(|p| p.n as f64)),
        ("Needed.rmse".to_owned(), column(|p| p.rmse)),
        ("Needed.rmse_uniform".to_owned(), column(|p| p.rmse_uniform)),
    ]);
    exr_file.commit(&picture::exr::encode(found.size, channels, &comments)?)?;
    let drawing = figures::draw(&format!("{name}: samples needed, {sampler}"), &found);
    let png_bytes = drawing.to_png(crate::report::PNG_SCALE).map_err(anyhow::Error::msg)?;
    png_file.commit(&png_bytes)?;

    if common.json {
        output::print_json(&document)?;
    } else {
        output::print(&text(&name, sampler, &plan, &found))?;
        output::print(&format!("{}\n{}\n", path.display(), png.display()))?;
    }
    Ok(Outcome::Done)
}

fn text(name: &str, sampler: &str, plan: &NeededPlan, found: &Needed) -> String {
    let [width, height] = found.size;
    let pixels = f64::from(width) * f64::from(height);
    let kinds = found.kinds.iter().map(|(need, count)| {
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
        let [lo, middle, hi] = flat.percentiles.map(|p| number(p, 3));
        format!(
            "RMS {} of the target; 5, 50, 95 % of pixels below {lo}, {middle}, {hi}; {} % above it",
            number(flat.rms, 3),
            number(100.0 * flat.above, 3)
        )
    };
    format!(
        "{name}, {width} × {height} pixels, {sampler}, M = {} trials, seed {}\n\
         RMS error {} in each pixel: {} of the mean radiance {}\n\
         {} samples, {} a pixel in the mean; a uniform picture that gives every pixel enough has {} \
         a pixel\n  pixels: {}\n  an exact pixel may hide a feature of up to {} of its area \
         (95 %)\n\
         fresh randomness (seed {}, {} estimates of each pixel that varies):\n  \
         with the map:     {}\n  uniform, {} spp: {}\n",
        plan.study.n_trials,
        plan.study.seed,
        number(found.error, 4),
        number(found.error / found.mean_radiance, 3),
        number(found.mean_radiance, 4),
        found.total,
        number(found.total as f64 / pixels, 4),
        found.uniform_spp_for_all,
        kinds.collect::<Vec<_>>().join(", "),
        number(found.unseen_share, 2),
        found.proof_seed,
        found.proof_trials,
        spread(&found.adaptive),
        found.uniform_spp,
        spread(&found.uniform),
    )
}
