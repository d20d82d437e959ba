//! `trade`: what error costs how much time.

mod csv;
mod needed;
mod words;

use super::Outcome;
use crate::cli::{Common, TradeArgs};
use crate::output::{self, AtomicFile};
use crate::plan;
use crate::progress::Progress;
use crate::report::PlotFile;
use crate::report::trade as figures;
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use std::time::Instant;
use stratcore::integrand::{self, CATALOGUE, Integrand};
use stratcore::map::Region;
use stratcore::scene::Channel;
use stratcore::study::StudyPlan;
use stratcore::trace::TracedScene;
use stratcore::trade::{Subject, TradePlan, TradeResult, trade};

/// A trade as JSON.
#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    about: &'a About,
    #[serde(flatten)]
    result: &'a TradeResult,
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
    let scene = super::load(&args.subject, common)?;
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
    let [width, height] = scene.camera.resolution;
    let region = match (&args.at, &args.region) {
        (Some(at), _) => {
            let [x, y] = plan::pixel(at)?;
            ensure!(
                x < width && y < height,
                "--at {at}: outside the picture of {}, which is {width} × {height}",
                scene.name
            );
            [x, y, x + 1, y + 1]
        }
        (None, Some(text)) => {
            let region: Region = text.parse().context("--region")?;
            region.check([width, height]).context("--region")?;
            region.into()
        }
        (None, None) => [0, 0, width, height],
    };
    let pixels = lattice(region, args.lattice);
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

/// At most `side` × `side` pixels, evenly over a region.
fn lattice([x0, y0, x1, y1]: [u32; 4], side: u32) -> Vec<[u32; 2]> {
    let along = |from: u32, to: u32| -> Vec<u32> {
        let (length, cells) = (to - from, side.min(to - from));
        let middle = |i: u32| (2 * u64::from(i) + 1) * u64::from(length) / (2 * u64::from(cells));
        (0..cells).map(|i| from + middle(i) as u32).collect()
    };
    let columns = along(x0, x1);
    along(y0, y1).into_iter().flat_map(|y| columns.iter().map(move |&x| [x, y])).collect()
}

/// Samples that measuring the errors takes.
fn samples(plan: &StudyPlan, dim: usize, subjects: usize) -> Result<u64> {
    let per_trial = plan.counts_used(dim)?.iter().flatten().fold(0u64, |s, n| s.saturating_add(*n));
    Ok(per_trial.saturating_mul(plan.n_trials.into()).saturating_mul(subjects as u64))
}

fn measure(
    about: &About,
    subjects: &[Subject<'_>],
    args: &TradeArgs,
    common: &Common,
) -> Result<Outcome> {
    let dim = subjects.first().context("there are no pixels")?.integrand.dim();
    let plan = TradePlan {
        study: plan::trade_study_plan(args, common, dim)?,
        targets: plan::targets(&args.targets)?,
        eval_cost: args.eval_cost.as_deref().map(plan::duration_ns).transpose()?,
    };
    let csv = args.csv.as_deref().map(AtomicFile::create).transpose()?;
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let page = match &args.report {
        Some(folder) => {
            output::make_folder(folder, "--report")?;
            let path = folder.join("trade.html");
            Some((AtomicFile::create(&path)?, path))
        }
        None => None,
    };
    let progress = Progress::new("measuring", samples(&plan.study, dim, subjects.len())?, common);
    let start = Instant::now();
    let result = trade(subjects, &plan, &|| start.elapsed(), progress.control())?;
    drop(progress);

    let recommendations: Vec<_> =
        result.choices.iter().map(|choice| words::recommendation(choice, &result)).collect();
    let chart = figures::chart(&about.title, &result);
    if let Some(file) = csv {
        file.commit(csv::rows(about, &result).as_bytes())?;
    }
    if let Some(file) = plot {
        file.commit(&chart)?;
    }
    let written = match page {
        Some((file, path)) => {
            let tables = words::tables(&result);
            let html = figures::page(
                &about.title,
                &chart,
                &recommendations,
                &words::method(&result),
                &tables,
            );
            file.commit(html.as_bytes())?;
            format!("\n{}\n", path.display())
        }
        None => String::new(),
    };
    if common.json {
        let recommendations = &recommendations;
        output::print_json(Document { about, result: &result, recommendations })?;
    } else {
        let text = words::text(&about.title, &result, &recommendations);
        output::print(&(text + &written))?;
    }
    Ok(Outcome::Done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_lies_evenly_in_its_region() {
        assert_eq!(lattice([3, 4, 4, 5], 16), [[3, 4]]);
        assert_eq!(lattice([0, 0, 3, 1], 16), [[0, 0], [1, 0], [2, 0]]);
        let cells = lattice([10, 20, 110, 220], 4);
        assert_eq!((cells.len(), cells[0], cells[15]), (16, [22, 45], [97, 195]));
    }
}
