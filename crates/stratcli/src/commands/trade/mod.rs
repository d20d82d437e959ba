//! `trade`: what error costs how much time.

mod needed;
mod pin;

use super::Outcome;
use super::reproduce::link_from_report;
use crate::cli::{Common, TradeArgs};
use crate::output::{self, AtomicFile};
use crate::plan;
use crate::progress::Progress;
use crate::report::PlotFile;
use crate::report::page;
use crate::report::trade::{self as figures, csv, words};
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::time::Instant;
use stratcore::integrand::{self, CATALOGUE, Integrand};
use stratcore::scene::{Channel, SceneError};
use stratcore::trace::TracedScene;
use stratcore::trade::{Subject, TradeResult, trade};

/// A trade as JSON.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    about: &'a About,
    #[serde(flatten)]
    result: &'a TradeResult,
    /// The core that times were measured on; none where the thread was free to move.
    timed_on_core: Option<usize>,
    recommendations: &'a [String],
}

/// What was measured.
#[derive(Serialize)]
struct About {
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    integrand: Option<String>,
    pixels: Option<[u32; 4]>,
    #[serde(skip)]
    title: String,
}

pub fn run(args: &TradeArgs, common: &Common) -> Result<Outcome> {
    if CATALOGUE.iter().any(|info| info.name == args.subject) {
        ensure!(
            args.at.is_none() && args.region.is_none() && args.needed.is_none(),
            "{}: an integrand has no pixels; leave out --at, --region and --needed",
            args.subject
        );
        return of_integrand(args, common);
    }
    ensure!(
        args.dim.is_none() && args.set.is_empty(),
        "{}: not an integrand, and --dim and --set are of integrands only (see `stratcli list \
         integrands`)",
        args.subject
    );
    let scene = super::load(&args.subject, common).map_err(|error| match error.downcast_ref() {
        Some(SceneError::UnknownScene { .. }) => error.context(format!(
            "{}: not an integrand (see `stratcli list integrands`)",
            args.subject
        )),
        _ => error,
    })?;
    if let Some(path) = &args.needed {
        return needed::run(scene, path, args, common);
    }
    of_scene(scene, args, common)
}

fn of_integrand(args: &TradeArgs, common: &Common) -> Result<Outcome> {
    let set: Vec<_> = args.set.iter().map(|text| plan::parameter(text)).collect::<Result<_>>()?;
    let integrand = integrand::by_name(&args.subject, args.dim, &set)?;
    let params: Vec<_> = set.iter().map(|(name, value)| format!(", {name} = {value}")).collect();
    let title = format!("{}{}", args.subject, params.concat());
    let about = About { scene: None, integrand: Some(title.clone()), pixels: None, title };
    let subjects = [Subject { pixel: [0, 0], integrand: &*integrand }];
    measure(&about, &subjects, args, common)
}

fn of_scene(scene: stratcore::scene::Scene, args: &TradeArgs, common: &Common) -> Result<Outcome> {
    let (region, pixels) = plan::trade_pixels(args, &scene)?;
    let name = scene.name.clone();
    let title = match &args.at {
        Some(_) => format!("{name}, pixel {},{}", region[0], region[1]),
        None => format!("{name}, {} pixels", pixels.len()),
    };
    let traced = TracedScene::new(scene);
    let integrands: Vec<_> =
        pixels.iter().map(|&pixel| traced.pixel(pixel, Channel::Luminance)).collect();
    let subjects: Vec<_> = pixels
        .iter()
        .zip(&integrands)
        .map(|(&pixel, integrand)| Subject { pixel, integrand: integrand as &dyn Integrand })
        .collect();
    let about = About { scene: Some(name), integrand: None, pixels: Some(region), title };
    measure(&about, &subjects, args, common)
}

fn measure(
    about: &About,
    subjects: &[Subject<'_>],
    args: &TradeArgs,
    common: &Common,
) -> Result<Outcome> {
    let dim = subjects.first().context("there are no pixels")?.integrand.dim();
    let plan = plan::trade_plan(args, common, dim)?;
    let csv_file = args.csv.as_deref().map(AtomicFile::create).transpose()?;
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let html_file = match &args.report {
        Some(folder) => {
            output::make_folder(folder, "--report")?;
            let path = folder.join(figures::PAGE);
            Some((AtomicFile::create(&path)?, path, folder))
        }
        None => None,
    };
    let progress =
        Progress::new("measuring", plan::trade_samples(&plan.study, dim, subjects.len())?, common);
    let start = Instant::now();
    let pinned = pin::to_one_core();
    let core = pinned.core;
    let result = trade(subjects, &plan, &|| start.elapsed(), progress.control())?;
    drop((pinned, progress));

    let recommendations: Vec<_> =
        result.choices.iter().map(|choice| words::recommendation(choice, &result)).collect();
    let chart = figures::chart(&about.title, &result);
    if let Some(file) = csv_file {
        let rows = csv::rows(about.scene.as_deref(), about.integrand.as_deref(), &result);
        file.commit(rows.as_bytes())?;
    }
    if let Some(file) = plot {
        file.commit(&chart)?;
    }
    let written = match html_file {
        Some((file, path, folder)) => {
            let tables = words::tables(&result);
            let html = figures::render(
                &about.title,
                &chart,
                &recommendations,
                &words::method(&result, core),
                &tables,
                folder.join(page::NAME).exists(),
            );
            file.commit(html.as_bytes())?;
            link_from_report(folder, figures::PAGE, figures::TITLE)?;
            format!("\n{}\n", path.display())
        }
        None => String::new(),
    };
    if common.json {
        let recommendations = &recommendations;
        output::print_json(Document {
            about,
            result: &result,
            timed_on_core: core,
            recommendations,
        })?;
    } else {
        let text = words::text(&about.title, &result, core, &recommendations);
        output::print(&(text + &written))?;
    }
    Ok(Outcome::Done)
}
