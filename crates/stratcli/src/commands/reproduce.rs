//! `reproduce`: the paper's figures and numbers, on ray-traced scenes, as one page.
//!
//! The parts follow one another, and the folder is written anew after each: what is finished
//! is kept when the rest is not.

mod close_up;
mod dimensions;
mod form_factor;
mod literature;
pub(super) mod output;
mod pixels;
mod tally;
mod verdicts;

use super::Outcome;
use crate::cli::{Common, ReproduceArgs};
use crate::output::{note, print, print_json};
use crate::progress::Progress;
use crate::report::raster::Raster;
use crate::report::summary::{Protocol, Summary};
use crate::report::{chart, picture, sides};
use crate::table::{Align, columns};
use anyhow::Result;
use form_factor::SIDE;
use output::Report;
pub use output::link_from_report;
use stratcore::StudyError;
use stratcore::integrand::Integrand as _;
use stratcore::scene::Channel;
use stratcore::study::{SamplerChoice, StudyPlan, render};
use stratcore::trace::TracedScene;

/// Pixels per axis of the lattice that `--quick` studies.
const QUICK_LATTICE: u32 = 64;
/// Repeats of the form factor with a lattice, unless told.
const QUICK_REPEATS: u32 = 20;
/// Repeats of the form factor without, unless told.
const REPEATS: u32 = 150;
/// Samples per pixel of Figure 1.
const PICTURE_SPP: u64 = 16;

pub fn run(args: &ReproduceArgs, common: &Common) -> Result<Outcome> {
    if args.literature {
        return literature::run(args, common);
    }
    if args.dimensions {
        return dimensions::run(args, common);
    }
    let scene = TracedScene::new(super::load(&args.scene, common)?);
    let plan = StudyPlan { seed: common.seed, ..StudyPlan::paper() };
    plan.counts_used(scene.pixel([0, 0], Channel::Luminance).dim())?;
    let mut report = Report::create(&args.out, blank_summary(args, &scene, &plan))?;
    let outcome = match parts(&mut report, &scene, &plan, common) {
        Ok(()) => Outcome::Done,
        Err(error) if matches!(error.downcast_ref(), Some(StudyError::Cancelled)) => {
            note("interrupted: the parts that were finished are kept");
            Outcome::Interrupted
        }
        Err(error) => return Err(error),
    };
    report.summary.complete = outcome == Outcome::Done;
    report.write()?;
    if common.json {
        print_json(&report.summary)?;
    } else {
        print(&text(&report))?;
    }
    Ok(outcome)
}

fn blank_summary(args: &ReproduceArgs, scene: &TracedScene, plan: &StudyPlan) -> Summary {
    let lattice = args.lattice.or(args.quick.then_some(QUICK_LATTICE));
    let resolution = scene.scene().camera.resolution;
    let mut command = "stratcli reproduce".to_owned();
    if args.quick {
        command += " --quick";
    }
    if let Some(side) = args.lattice {
        command += &format!(" --lattice {side}");
    }
    if let Some(repeats) = args.repeats {
        command += &format!(" --repeats {repeats}");
    }
    command += &format!(" --scene {} --seed {}", args.scene, plan.seed);
    let ln_n: Vec<_> = plan.counts.iter().map(|n| (*n as f64).ln()).collect();
    let mean = ln_n.iter().sum::<f64>() / ln_n.len() as f64;
    let sxx: f64 = ln_n.iter().map(|x| (x - mean).powi(2)).sum();
    Summary {
        command,
        complete: false,
        protocol: Protocol {
            scene: scene.scene().name.clone(),
            triangles: scene.scene().mesh.triangles.len(),
            resolution,
            picture_spp: PICTURE_SPP,
            lattice,
            pixels: pixels::chosen(resolution, lattice).len(),
            samplers: plan.samplers.iter().map(|s| s.sampler.name().to_owned()).collect(),
            counts: plan.counts.clone(),
            trials: plan.n_trials,
            seed: plan.seed,
            repeats: args.repeats.unwrap_or(if lattice.is_some() {
                QUICK_REPEATS
            } else {
                REPEATS
            }),
            noise_of_p: (2.0 / f64::from(plan.n_trials - 1)).sqrt() / sxx.sqrt(),
        },
        pixels: None,
        claims: None,
        close_ups: Vec::new(),
        form_factor: None,
        verdicts: Vec::new(),
        figures: Vec::new(),
    }
}

fn parts(
    report: &mut Report,
    scene: &TracedScene,
    plan: &StudyPlan,
    common: &Common,
) -> Result<()> {
    let photo = picture(report, scene, plan.seed, common)?;
    form_factor(report, plan.seed, common)?;
    let tally = pixels::study_all(report, scene, &photo, plan, common)?;
    pixels::measure_suspects_again(report, scene, &tally, plan, common)?;
    close_up::draw(report, scene, &photo, &tally, plan)
}

fn picture(report: &mut Report, scene: &TracedScene, seed: u64, common: &Common) -> Result<Raster> {
    let size = scene.scene().camera.resolution;
    let samples = u64::from(size[0]) * u64::from(size[1]) * PICTURE_SPP;
    let progress = Progress::new("picture", samples, common);
    let image = render(scene, SamplerChoice::JITTERED, PICTURE_SPP, seed, progress.control())?;
    let photo = Raster::from_linear(size, &image.pixels);
    let title = format!("The picture: {}", scene.scene().name);
    let caption = format!(
        "Figure 1. The ray-traced picture whose pixels are studied: {} triangles, {} × {} \
         pixels, here with {PICTURE_SPP} jittered samples in each.",
        scene.scene().mesh.triangles.len(),
        size[0],
        size[1]
    );
    report.figure("fig1-picture", caption, &picture::picture(&title, photo.clone()))?;
    report.write()?;
    Ok(photo)
}

fn form_factor(report: &mut Report, seed: u64, common: &Common) -> Result<()> {
    let repeats = report.summary.protocol.repeats;
    let progress = Progress::new("form factor", form_factor::samples(repeats)?, common);
    let found = form_factor::measure(seed, repeats, progress.control())?;
    for (name, occluder, words) in [
        ("form-factor", None, "Form factor of parallel unit squares".to_owned()),
        ("form-factor-occluded", Some(SIDE), format!("The same with an occluder of side {SIDE}")),
    ] {
        let run = form_factor::one_run(seed, occluder, progress.control())?;
        let caption = format!(
            "{words}, two units apart, in four dimensions: one run, M = 50. Dashed are the \
             slopes of complex, edge and smooth integrands in four dimensions."
        );
        report.figure(name, caption, &chart::convergence(&words, &run))?;
    }
    let caption = format!(
        "Exponent against the side of the half-way occluder, {repeats} runs each. The paper \
         does not give its side; theory says 5/4 for any. At side 1 no ray passes and there is \
         no exponent."
    );
    report.figure("form-factor-sides", caption, &sides::draw(&found.cases))?;
    report.summary.form_factor = Some(found);
    report.write()
}

fn text(report: &Report) -> String {
    let summary = &report.summary;
    let mut rows = vec![["", "paper", "ours", "verdict"].map(str::to_owned).to_vec()];
    for v in &summary.verdicts {
        rows.push([&v.what, &v.paper, &v.ours, &v.verdict].map(Clone::clone).to_vec());
    }
    format!("{}\n{}", columns(Align::Left, &rows), report.page().display()) + "\n"
}
