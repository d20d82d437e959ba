//! `study`: maps of many scenes under many samplers, and a report that compares them.

use super::Outcome;
use super::map::finish::{self, Found, Kind, Output};
use super::map::{Job, Made};
use crate::cli::{Common, StudyFileArgs};
use crate::output::{self, AtomicFile};
use crate::report::comparison::{self, Scene};
use crate::report::raster::data_uri;
use crate::study_file::{SceneEntry, StudyFile};
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::Path;
use stratcore::input::{self, MAX_DATA};
use stratcore::integrand::Integrand as _;
use stratcore::map::{MapPlan, Region};
use stratcore::trace::TracedScene;

/// The numbers of a study.
#[derive(Serialize)]
struct StudySummary<'a> {
    study: &'a Path,
    seed: u64,
    maps: Vec<Found>,
}

pub fn run(args: &StudyFileArgs, common: &Common) -> Result<Outcome> {
    let study = StudyFile::read(&args.file)?;
    output::make_folder(&args.output, "--output")?;
    // Every fault of the file is found before the first map is made.
    let jobs = study
        .scenes()
        .iter()
        .map(|entry| job(&study, entry, &args.output, common))
        .collect::<Result<Vec<_>>>()?;
    let (mut maps, mut scenes) = (Vec::new(), Vec::new());
    for job in &jobs {
        let name = &job.identity.scene;
        let made = job.run(common).with_context(|| format!("scene {name}"))?;
        let words = match made {
            Made::Written(_) => "done",
            Made::Earlier => "was done already",
            Made::Interrupted => return Ok(Outcome::Interrupted),
        };
        if !common.quiet {
            output::note(&format!("{name}: {words}"));
        }
        let (found, scene) = read(&job.output)?;
        maps.push(found);
        scenes.push(scene);
    }
    let page = comparison::render(&title(&args.file), &scenes);
    let report = args.output.join("report.html");
    AtomicFile::create(&report)?.commit(page.as_bytes())?;
    let summary = StudySummary { study: &args.file, seed: common.seed, maps };
    let json = output::json(&summary)?;
    AtomicFile::create(&args.output.join("summary.json"))?.commit(json.as_bytes())?;
    if common.json {
        output::print(&json)?;
    } else {
        output::print(&(comparison::text(&scenes) + &format!("\n{}\n", report.display())))?;
    }
    Ok(Outcome::Done)
}

fn title(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned())
}

fn job(study: &StudyFile, entry: &SceneEntry, folder: &Path, common: &Common) -> Result<Job> {
    let scene = super::load(&entry.spec, common)
        .with_context(|| format!("{}: scene {}", study.shown(), entry.name))?;
    let traced = TracedScene::new(scene).with_tracer(study.tracer);
    let path = folder.join(format!("{}.exr", entry.name));
    let output = Output { path, kind: Kind::Picture { points: study.points } };
    let size = traced.scene().camera.resolution;
    let region = entry.region.unwrap_or(Region::whole(size));
    let dim = traced.pixel([0, 0], study.channel).dim();
    let new = || -> Result<Job> {
        region.check(size).context("regions")?;
        let StudyFile { channel, exact, .. } = *study;
        let plan = MapPlan { study: study.plan(dim, common.seed)?, region, channel, exact };
        Ok(Job { resume: true, ..Job::new(traced, plan, output)? })
    };
    new().with_context(|| format!("{}: scene {}", study.shown(), entry.name))
}

/// A finished map from its files, whenever it was made.
fn read(output: &Output) -> Result<(Found, Scene)> {
    let found = finish::read(output)?;
    let shown = output.path.display();
    let summary = found.summary.clone();
    let summary = summary.with_context(|| format!("{shown} has no summary; delete it"))?;
    let png = output.beside("png");
    let png = input::read(&png, MAX_DATA).with_context(|| {
        format!("cannot read {}; delete {shown} to make it again", png.display())
    })?;
    let header = found.header.clone();
    Ok((found, Scene { header, summary, picture: data_uri(&png) }))
}
