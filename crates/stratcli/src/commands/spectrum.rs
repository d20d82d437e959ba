//! `spectrum`: the power of point sets, or of a picture's error, over frequencies.

use super::Outcome;
use crate::cli::{Common, SpectrumArgs};
use crate::output::{self, AtomicFile, csv_line};
use crate::picture::Format;
use crate::plan;
use crate::progress::Progress;
use crate::report::PlotFile;
use crate::report::spectrum::{self as figure, SamplerSpectrum, Spectra};
use crate::table;
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;
use stratcore::integrand::Integrand as _;
use stratcore::rng::StreamKey;
use stratcore::sampler::{
    CountPolicy, PointFile, PointSet, Sampler, Scramble, check_scramble, count_used,
};
use stratcore::scene::Channel;
use stratcore::scene::library::SCENES;
use stratcore::study::{ErrorPlan, SamplerChoice, error_spectra, point_spectrum};
use stratcore::trace::TracedScene;

pub fn run(args: &SpectrumArgs, common: &Common) -> Result<Outcome> {
    let format = args.output.as_deref().map(Format::of).transpose()?;
    let points = point_file(args)?;
    let choices = choices(points, args)?;
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
        Some(scene) if is_scene(scene) => of_pictures(scene, &choices, args, common)?,
        _ => of_points(points, &choices, args, common)?,
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
        csv.commit(rings_as_csv(&spectra).as_bytes())?;
    }
    if common.json {
        output::print_json(&spectra)?;
    } else {
        output::print(&table::spectra(&spectra))?;
    }
    Ok(Outcome::Done)
}

fn choices(file: Option<&'static PointFile>, args: &SpectrumArgs) -> Result<Vec<SamplerChoice>> {
    let SpectrumArgs { samplers, scramble, .. } = args;
    if let Some(file) = file {
        ensure!(
            samplers.is_empty() && scramble.is_none(),
            "{}: a file's sets are seen as they are, without --samplers or --scramble; name it \
             among --samplers as file:PATH",
            file.name()
        );
        return Ok(vec![SamplerChoice { sampler: file, scramble: Scramble::None }]);
    }
    let default = || ["random", "jittered"].map(str::to_owned).to_vec();
    let names = if samplers.is_empty() { default() } else { samplers.clone() };
    plan::samplers(&names, scramble.as_deref())
}

fn is_scene(subject: &str) -> bool {
    let ending = Path::new(subject).extension().map(|e| e.to_ascii_lowercase());
    let is_file = ending.is_some_and(|e| e == "toml" || e == "obj");
    is_file || SCENES.iter().any(|scene| scene.name == subject)
}

fn point_file(args: &SpectrumArgs) -> Result<Option<&'static PointFile>> {
    match &args.subject {
        Some(path) if !is_scene(path) => {
            let file = PointFile::load(path).with_context(|| {
                format!("{path} is no scene: no built-in one has this name, no .toml or .obj")
            })?;
            Ok(Some(file))
        }
        _ => Ok(None),
    }
}

fn of_points(
    file: Option<&PointFile>,
    choices: &[SamplerChoice],
    args: &SpectrumArgs,
    common: &Common,
) -> Result<Spectra> {
    for (flag, given) in [("--spp", args.spp), ("--reference-spp", args.reference_spp)] {
        if given.is_some() {
            bail!("{flag} is for pictures of a scene; point sets take -n");
        }
    }
    let n = args.n.or(file.and_then(|file| file.counts().first().copied())).unwrap_or(256);
    let dim = args.dim.or(file.map(|file| file.facts().max_dim)).unwrap_or(2);
    ensure!(n >= 1, "-n {n}: a set has at least 1 point");
    let axes = plan::axes(args.axes.as_deref().unwrap_or("0,1"), dim)?;
    let policy = args.n_policy.map_or(CountPolicy::Error, CountPolicy::from);
    // Of a file all sets.
    let sets = file.map(|file| file.most_trials(n, Scramble::None));
    let trials = args.trials.or(sets).unwrap_or(50);
    let cutoff =
        args.cutoff.unwrap_or_else(|| (4.0 * (n as f64).sqrt()).ceil().clamp(16.0, 256.0) as u32);
    let counts_used: Vec<_> = choices
        .iter()
        .map(|choice| {
            check_scramble(choice.sampler, choice.scramble)?;
            count_used(choice.sampler, n, dim, policy)
        })
        .collect::<Result<_, _>>()?;
    let total = counts_used.iter().fold(0u64, |sum, n| sum.saturating_add(*n));
    let progress = Progress::new("transforming", total.saturating_mul(trials.into()), common);
    let mut samplers = Vec::new();
    for (&SamplerChoice { sampler, scramble }, n_used) in choices.iter().zip(counts_used) {
        let (seed, stream) = (common.seed, sampler.stream_id());
        let key = StreamKey { seed, pixel: [0, 0], sampler: stream, n_samples: n_used, trial: 0 };
        let set = PointSet { key, dim, scramble, rectangular: policy == CountPolicy::Rect };
        let spectrum = point_spectrum(sampler, &set, axes, cutoff, trials, progress.control())?;
        samplers.push(SamplerSpectrum {
            name: sampler.name(),
            scramble,
            n_used,
            trials: spectrum.periodograms(),
            mse: None,
            rings: spectrum.radial(),
            spectrum,
        });
    }
    Ok(Spectra {
        title: format!("Power of point sets, N = {n}"),
        unit: "cycles per side",
        scene: None,
        n,
        dim,
        axes: Some(axes),
        reference_spp: None,
        seed: common.seed,
        samplers,
    })
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

fn rings_as_csv(spectra: &Spectra) -> String {
    let mut text = "scene,sampler,scramble,dim,n_requested,n_used,trials,seed,frequency,power,\
                    std_error,anisotropy_db,frequencies\n"
        .to_owned();
    for sampler in &spectra.samplers {
        for ring in &sampler.rings {
            text += &csv_line(&[
                spectra.scene.clone().unwrap_or_default(),
                sampler.name.to_owned(),
                sampler.scramble.to_string(),
                spectra.dim.to_string(),
                spectra.n.to_string(),
                sampler.n_used.to_string(),
                sampler.trials.to_string(),
                spectra.seed.to_string(),
                ring.frequency.to_string(),
                ring.power.to_string(),
                ring.std_error.to_string(),
                if ring.anisotropy_db.is_finite() {
                    ring.anisotropy_db.to_string()
                } else {
                    String::new()
                },
                ring.frequencies.to_string(),
            ]);
        }
    }
    text
}
