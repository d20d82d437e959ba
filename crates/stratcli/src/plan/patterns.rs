//! Point sets by themselves: what `points`, `spectrum` and `discrepancy` ask for.

use super::{axes as axes_of, sampler, samplers};
use crate::cli::{Common, DiscrepancyArgs, PointsArgs, SpectrumArgs};
use crate::report::spectrum::{SamplerSpectrum, Spectra};
use anyhow::{Context, Result, bail, ensure};
use std::ops::Range;
use std::path::Path;
use stratcore::StudyError;
use stratcore::counts::parse_counts;
use stratcore::discrepancy::Measure;
use stratcore::rng::StreamKey;
use stratcore::sampler::{
    CountPolicy, PointFile, PointSet, Sampler, Scramble, check_scramble, check_trials, count_used,
    whole_set,
};
use stratcore::scene::library::SCENES;
use stratcore::spectrum::Spectrum;
use stratcore::study::{Control, SamplerChoice, StudyPlan, point_spectrum};

/// Some sets of one sampler.
#[derive(Clone)]
pub struct PointsPlan {
    /// The sampler with its scramble.
    pub choice: SamplerChoice,
    /// N as asked for.
    pub n: u64,
    /// The first set; its N is the one that is used.
    pub set: PointSet,
    /// Trials whose sets are wanted.
    pub trials: Range<u32>,
    /// The two dimensions that are drawn, where they are.
    pub axes: Option<[usize; 2]>,
}

/// What `points` asks for. Axes count only where something is drawn.
///
/// # Errors
/// What the sampler refuses, in the words of the flags.
pub fn points(args: &PointsArgs, common: &Common, is_drawn: bool) -> Result<PointsPlan> {
    /// Coordinates as text: some two gibibytes.
    const MOST: u64 = 1 << 26;
    /// Dots in one drawing.
    const MOST_DRAWN: u64 = 1 << 16;
    let choice = sampler("--sampler", &args.sampler, args.scramble.as_deref())?;
    let SamplerChoice { sampler, scramble } = choice;
    let PointsArgs { n, dim, trial, sets, .. } = *args;
    ensure!(n >= 1, "-n {n}: a set has at least 1 point");
    ensure!(dim >= 1, "--dim {dim}: points have at least 1 dimension");
    check_scramble(sampler, scramble).context("--scramble")?;
    let policy = CountPolicy::from(args.n_policy);
    let n_used = count_used(sampler, n, dim, policy)?;
    let trials = trial.checked_add(sets).context("--trial and --sets: their sum is beyond 2^32")?;
    check_trials(sampler, scramble, n_used, trials)?;
    let coordinates = n_used.saturating_mul(dim as u64).saturating_mul(sets.into());
    ensure!(
        coordinates <= MOST,
        "{sets} × {n_used} points in {dim} dimensions are more coordinates than fit in one text, \
         {MOST}; ask for fewer sets or points"
    );
    let axes = is_drawn.then(|| axes_of(&args.axes, dim)).transpose()?;
    // The explorer draws without being told to.
    let flag = if args.plot.is_some() { "--plot: " } else { "" };
    ensure!(
        !is_drawn || n_used <= MOST_DRAWN,
        "{flag}{n_used} points are more than a drawing shows, {MOST_DRAWN}; ask for fewer"
    );
    let set = point_set(choice, dim, n_used, policy, common.seed);
    let set = PointSet { key: StreamKey { trial, ..set.key }, ..set };
    Ok(PointsPlan { choice, n, set, trials: trial..trials, axes })
}

impl PointsPlan {
    /// The coordinates of one trial's set, point by point.
    ///
    /// # Errors
    /// As [`whole_set`].
    pub fn draw(&self, trial: u32) -> Result<Vec<f64>, StudyError> {
        let key = StreamKey { trial, ..self.set.key };
        whole_set(self.choice.sampler, &PointSet { key, ..self.set })
    }

    /// Strata along each dimension, where the points keep to them.
    pub fn strata(&self) -> Option<Vec<u64>> {
        let SamplerChoice { sampler, scramble } = self.choice;
        let is_plain = scramble == Scramble::None;
        is_plain.then(|| sampler.strata(self.set.key.n_samples, self.set.dim)).flatten()
    }
}

/// Spectra of the point sets of some samplers.
pub struct PointSpectra {
    choices: Vec<SamplerChoice>,
    sets: Vec<PointSet>,
    n: u64,
    axes: [usize; 2],
    cutoff: u32,
    trials: u32,
}

/// What `spectrum` asks for when it is asked about point sets.
///
/// # Errors
/// What a sampler refuses; flags that are for pictures.
pub fn point_spectra(args: &SpectrumArgs, common: &Common) -> Result<PointSpectra> {
    let file = point_file(args)?;
    let choices = spectrum_samplers(file, args)?;
    for (flag, given) in [("--spp", args.spp), ("--reference-spp", args.reference_spp)] {
        if given.is_some() {
            bail!("{flag} is for pictures of a scene; point sets take -n");
        }
    }
    let n = args.n.or(file.and_then(|file| file.counts().first().copied())).unwrap_or(256);
    let dim = args.dim.or(file.map(|file| file.facts().max_dim)).unwrap_or(2);
    ensure!(n >= 1, "-n {n}: a set has at least 1 point");
    let axes = axes_of(args.axes.as_deref().unwrap_or("0,1"), dim)?;
    let policy = args.n_policy.map_or(CountPolicy::Error, CountPolicy::from);
    // Of a file all sets.
    let sets = file.map(|file| file.most_trials(n, Scramble::None));
    let trials = args.trials.or(sets).unwrap_or(50);
    let cutoff =
        args.cutoff.unwrap_or_else(|| (4.0 * (n as f64).sqrt()).ceil().clamp(16.0, 256.0) as u32);
    let set = |choice: &SamplerChoice| {
        check_scramble(choice.sampler, choice.scramble)?;
        let n_used = count_used(choice.sampler, n, dim, policy)?;
        Ok(point_set(*choice, dim, n_used, policy, common.seed))
    };
    let sets = choices.iter().map(set).collect::<Result<_>>()?;
    Ok(PointSpectra { choices, sets, n, axes, cutoff, trials })
}

impl PointSpectra {
    /// Points that all periodograms together are made of.
    pub fn total_points(&self) -> u64 {
        let total = self.sets.iter().fold(0u64, |sum, set| sum.saturating_add(set.key.n_samples));
        total.saturating_mul(self.trials.into())
    }

    /// Samplers.
    pub fn len(&self) -> usize {
        self.choices.len()
    }

    /// Whether there is no sampler.
    pub fn is_empty(&self) -> bool {
        self.choices.is_empty()
    }

    /// The spectrum of the `i`-th sampler; `each` is handed it with the trials so far.
    ///
    /// # Errors
    /// As [`point_spectrum`].
    pub fn measure(
        &self,
        i: usize,
        control: Control<'_>,
        each: &mut dyn FnMut(SamplerSpectrum),
    ) -> Result<SamplerSpectrum, StudyError> {
        let (choice, set) = (self.choices[i], &self.sets[i]);
        let of = |spectrum: &Spectrum| SamplerSpectrum {
            name: choice.sampler.name(),
            scramble: choice.scramble,
            n_used: set.key.n_samples,
            trials: spectrum.periodograms(),
            mse: None,
            rings: spectrum.radial(),
            spectrum: spectrum.clone(),
        };
        let mut so_far = |spectrum: &Spectrum| each(of(spectrum));
        let PointSpectra { axes, cutoff, trials, .. } = *self;
        let spectrum =
            point_spectrum(choice.sampler, set, axes, cutoff, trials, control, &mut so_far)?;
        Ok(of(&spectrum))
    }

    /// The spectra of all samplers as they are reported.
    pub fn report(&self, samplers: Vec<SamplerSpectrum>) -> Spectra {
        Spectra {
            title: format!("Power of point sets, N = {}", self.n),
            unit: "cycles per side",
            scene: None,
            n: self.n,
            dim: self.sets.first().map_or(2, |set| set.dim),
            axes: Some(self.axes),
            reference_spp: None,
            seed: self.sets.first().map_or(0, |set| set.key.seed),
            samplers,
        }
    }
}

/// The samplers of `spectrum`, or the file that it names in place of them.
///
/// # Errors
/// Samplers beside a file; names that are none.
pub fn spectrum_samplers(
    file: Option<&'static PointFile>,
    args: &SpectrumArgs,
) -> Result<Vec<SamplerChoice>> {
    let SpectrumArgs { samplers: names, scramble, .. } = args;
    if let Some(file) = file {
        ensure!(
            names.is_empty() && scramble.is_none(),
            "{}: a file's sets are seen as they are, without --samplers or --scramble; name it \
             among --samplers as file:PATH",
            file.name()
        );
        return Ok(vec![SamplerChoice { sampler: file, scramble: Scramble::None }]);
    }
    let default = || ["random", "jittered"].map(str::to_owned).to_vec();
    let names = if names.is_empty() { default() } else { names.clone() };
    samplers(&names, scramble.as_deref())
}

/// Whether the subject of `spectrum` is a scene, rather than a file of points.
pub fn is_scene(subject: &str) -> bool {
    let ending = Path::new(subject).extension().map(|e| e.to_ascii_lowercase());
    let is_file = ending.is_some_and(|e| e == "toml" || e == "obj");
    is_file || SCENES.iter().any(|scene| scene.name == subject)
}

/// The file of points that `spectrum` is about, if it is.
///
/// # Errors
/// A file that cannot be read.
pub fn point_file(args: &SpectrumArgs) -> Result<Option<&'static PointFile>> {
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

/// What `discrepancy` asks for: sets, their dimensions, and what is measured of them.
///
/// # Errors
/// Names, counts and discrepancies that are none.
pub fn discrepancy(
    args: &DiscrepancyArgs,
    common: &Common,
) -> Result<(StudyPlan, usize, Vec<Measure>)> {
    let (plan, dim) = match &args.file {
        Some(path) => sets_of_file(path, args, common)?,
        None => sets_of_samplers(args, common)?,
    };
    let measures = measures(&args.measure, dim)?;
    Ok((plan, dim, measures))
}

/// Pairs of points that [`discrepancies`](stratcore::study::discrepancies) goes through.
pub fn total_pairs(plan: &StudyPlan) -> u64 {
    let pairs = plan.counts.iter().fold(0u64, |sum, n| sum.saturating_add(n.saturating_mul(*n)));
    let sets = u64::from(plan.n_trials).saturating_mul(plan.samplers.len() as u64);
    pairs.saturating_mul(sets)
}

fn sets_of_samplers(args: &DiscrepancyArgs, common: &Common) -> Result<(StudyPlan, usize)> {
    let plan = StudyPlan {
        samplers: samplers(&args.samplers, args.scramble.as_deref())?,
        counts: parse_counts(&args.counts).context("--counts")?,
        count_policy: args.n_policy.into(),
        n_trials: args.trials.unwrap_or(50),
        seed: common.seed,
    };
    Ok((plan, args.dim.unwrap_or(2)))
}

/// Every set of a file, as it is.
fn sets_of_file(path: &str, args: &DiscrepancyArgs, common: &Common) -> Result<(StudyPlan, usize)> {
    let file = PointFile::load(path)?;
    let counts = file.counts();
    let plan = StudyPlan {
        samplers: vec![SamplerChoice { sampler: file, scramble: Scramble::None }],
        counts,
        count_policy: CountPolicy::Error,
        n_trials: args.trials.or(u32::try_from(file.sets().count()).ok()).unwrap_or(u32::MAX),
        seed: common.seed,
    };
    Ok((plan, args.dim.unwrap_or(file.facts().max_dim)))
}

fn measures(names: &[String], dim: usize) -> Result<Vec<Measure>> {
    if names.is_empty() {
        return Ok(vec![if dim == 2 { Measure::Edge } else { Measure::Centred }]);
    }
    let measures: Vec<Measure> = names
        .iter()
        .map(|name| name.trim().parse())
        .collect::<Result<_, _>>()
        .context("--measure")?;
    let twice = measures.iter().enumerate().find(|(i, measure)| measures[..*i].contains(measure));
    ensure!(
        twice.is_none(),
        "--measure {}: the same discrepancy twice; name each once",
        names.join(",")
    );
    Ok(measures)
}

/// The first set of a sampler, as patterns are made: in the picture's first pixel.
fn point_set(
    choice: SamplerChoice,
    dim: usize,
    n_used: u64,
    policy: CountPolicy,
    seed: u64,
) -> PointSet {
    let sampler = choice.sampler.stream_id();
    let key = StreamKey { seed, pixel: [0, 0], sampler, n_samples: n_used, trial: 0 };
    let rectangular = policy == CountPolicy::Rect;
    PointSet { key, dim, scramble: choice.scramble, rectangular }
}
