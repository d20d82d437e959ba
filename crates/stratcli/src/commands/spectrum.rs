//! `spectrum`: the power of point sets, or of a picture's error, over frequencies.

use super::Outcome;
use crate::cli::{Common, SpectrumArgs};
use crate::output::{self, AtomicFile};
use crate::picture::Format;
use crate::plan;
use crate::progress::Progress;
use crate::report::PlotFile;
use crate::report::spectrum::{self as figure, SamplerSpectrum, Spectra};
use crate::table;
use anyhow::{Result, ensure};
use stratcore::integrand::Integrand as _;
use stratcore::scene::Channel;
use stratcore::study::{ErrorPlan, SamplerChoice, error_spectra};
use stratcore::trace::TracedScene;

pub fn run(args: &SpectrumArgs, common: &Common) -> Result<Outcome> {
    let format = args.output.as_deref().map(Format::of).transpose()?;
    let choices = plan::spectrum_samplers(plan::point_file(args)?, args)?;
    ensure!(
        format.is_none() || choices.len() == 1,
        "--output holds one spectrum, not {}; name one sampler with --samplers, or draw them all \
         with --plot",
        choices.len()
    );
    let file = args.output.as_deref().map(AtomicFile::create).transpose()?;
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let csv = args.csv.as_deref().map(AtomicFile::create).transpose()?;
    let spectra = match &args.subject {
        Some(scene) if plan::is_scene(scene) => of_pictures(scene, &choices, args, common)?,
        _ => of_points(args, common)?,
    };
    if let Some(plot) = plot {
        plot.commit(&figure::chart(&spectra))?;
    }
    if let Some((file, format)) = file.zip(format) {
        let spectrum = &spectra.samplers[0].spectrum;
        let [width, height] = spectrum.size().map(|side| side as u32);
        let comments = serde_json::to_string(&spectra)?;
        let grey: Vec<_> = spectrum.power().iter().map(|power| [*power; 3]).collect();
        let bytes = match format {
            Format::Exr => format.encode([width, height], &grey, &comments)?,
            Format::Png => figure::power_map(spectrum).png(),
        };
        file.commit(&bytes)?;
    }
    if let Some(csv) = csv {
        csv.commit(figure::csv(&spectra).as_bytes())?;
    }
    if common.json {
        output::print_json(&spectra)?;
    } else {
        output::print(&table::spectra(&spectra))?;
    }
    Ok(Outcome::Done)
}

fn of_points(args: &SpectrumArgs, common: &Common) -> Result<Spectra> {
    let plan = plan::point_spectra(args, common)?;
    let progress = Progress::new("transforming", plan.total_points(), common);
    let control = progress.control();
    let samplers = (0..plan.len())
        .map(|i| plan.measure(i, control, &mut |_| {}))
        .collect::<Result<Vec<SamplerSpectrum>, _>>()?;
    drop(progress);
    Ok(plan.report(samplers))
}

fn of_pictures(
    scene: &str,
    choices: &[SamplerChoice],
    args: &SpectrumArgs,
    common: &Common,
) -> Result<Spectra> {
    for (flag, given) in [
        ("-n", args.n.is_some()),
        ("--dim", args.dim.is_some()),
        ("--axes", args.axes.is_some()),
        ("--cutoff", args.cutoff.is_some()),
        ("--n-policy", args.n_policy.is_some()),
    ] {
        ensure!(!given, "{flag} is for point sets; pictures of a scene take --spp");
    }
    let error_plan = ErrorPlan {
        spp: args.spp.unwrap_or(4),
        reference_spp: args.reference_spp.unwrap_or(4096),
        n_trials: args.trials.unwrap_or(4),
        seed: common.seed,
    };
    ensure!(
        error_plan.spp >= 1,
        "--spp {}: a picture needs at least 1 sample per pixel",
        error_plan.spp
    );
    ensure!(
        error_plan.reference_spp > error_plan.spp,
        "--reference-spp {}: a reference needs more samples than the pictures, {}",
        error_plan.reference_spp,
        error_plan.spp
    );
    let scene = super::load(scene, common)?;
    let name = scene.name.clone();
    let pixels = scene.camera.resolution.map(u64::from).iter().product::<u64>();
    let per_pixel =
        error_plan.spp.saturating_mul(u64::from(error_plan.n_trials) * choices.len() as u64);
    let total = pixels.saturating_mul(per_pixel.saturating_add(error_plan.reference_spp));
    let traced = TracedScene::new(scene);
    let dim = traced.pixel([0, 0], Channel::Luminance).dim();
    let progress = Progress::new("sampling", total, common);
    let found = error_spectra(&traced, choices, &error_plan, progress.control())
        .map_err(plan::about_spp)?;
    drop(progress);
    let samplers = choices.iter().zip(found).map(|(choice, error)| SamplerSpectrum {
        name: choice.sampler.name(),
        scramble: choice.scramble,
        n_used: error_plan.spp,
        trials: error_plan.n_trials,
        mse: Some(error.mse),
        rings: error.spectrum.radial(),
        spectrum: error.spectrum,
    });
    Ok(Spectra {
        title: format!("Power of the error of {name} at {} spp", error_plan.spp),
        unit: "cycles per pixel",
        scene: Some(name),
        n: error_plan.spp,
        dim,
        axes: None,
        reference_spp: Some(error_plan.reference_spp),
        seed: common.seed,
        samplers: samplers.collect(),
    })
}
