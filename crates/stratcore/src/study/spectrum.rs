//! Mean spectra of point sets, and of the error of pictures.

use super::{Control, SamplerChoice};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{self, CountPolicy, PointSet, most_trials_but_for_shifts, whole_set};
use crate::scene::Channel;
use crate::spectrum::{Spectrum, of_picture, of_points};
use crate::trace::TracedScene;
use crate::trial::trial_means;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// Trials whose periodograms are held at once.
const BATCH: u32 = 16;

/// The mean periodogram of trials 0 .. M of a point set: at most as many as there are different
/// ones, and a torus shift changes none. `axes` are two of the set's dimensions. `set` is as a
/// sampler's [`points`](sampler::Sampler::points) takes it; its trial is ignored. Progress is
/// counted in points. `each` is handed the mean so far, which is that of as many trials.
///
/// # Errors
/// [`StudyError::EmptyPlan`] for no trials; those of [`whole_set`]; [`StudyError::Cancelled`].
pub fn point_spectrum(
    sampler: &dyn sampler::Sampler,
    set: &PointSet,
    axes: [usize; 2],
    cutoff: u32,
    n_trials: u32,
    control: Control<'_>,
    each: &mut dyn FnMut(&Spectrum),
) -> Result<Spectrum, StudyError> {
    let different = most_trials_but_for_shifts(sampler, set.key.n_samples, set.scramble);
    let n_trials = n_trials.min(different);
    let periodogram = |trial| {
        if control.cancel.load(Ordering::Relaxed) {
            return Err(StudyError::Cancelled);
        }
        let set = PointSet { key: StreamKey { trial, ..set.key }, ..*set };
        let spectrum = of_points(&whole_set(sampler, &set)?, set.dim, axes, cutoff);
        (control.progress)(set.key.n_samples);
        Ok(spectrum)
    };
    let mut mean = None;
    for first in (0..n_trials).step_by(BATCH as usize) {
        let batch = first..n_trials.min(first.saturating_add(BATCH));
        let spectra: Vec<_> = batch.into_par_iter().map(periodogram).collect::<Result<_, _>>()?;
        mean = Spectrum::mean(mean.into_iter().chain(spectra));
        if let Some(so_far) = &mean {
            each(so_far);
        }
    }
    mean.ok_or(StudyError::EmptyPlan("trials"))
}

/// The error of one sampler's pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorSpectrum {
    /// Mean periodogram of the error pictures; 1 for independent pixels.
    pub spectrum: Spectrum,
    /// Mean square error of a pixel's luminance.
    pub mse: f64,
}

/// What the error of pictures is measured on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ErrorPlan {
    /// Samples per pixel.
    pub spp: u64,
    /// Samples per pixel of the reference, which is jittered; the nearest N that is.
    pub reference_spp: u64,
    /// Pictures of each sampler, each with its own points.
    pub n_trials: u32,
    /// Seed of all randomness.
    pub seed: u64,
}

/// Most pixels of a sampler's pictures: with their spectra and transforms 200 MB.
const MAX_PIXELS: u64 = 1 << 23;

/// For each sampler, how the error of its pictures of a scene is spread over frequencies:
/// luminance under the sampler, less that of a reference, M pictures of each. All samplers share
/// the reference, whose own error is part of what is found. Progress is counted in samples.
///
/// # Errors
/// [`StudyError::EmptyPlan`] for no samplers, trials or samples; what a sampler refuses;
/// [`StudyError::PictureTooLarge`] beyond 2^23 pixels in the M pictures of a sampler;
/// [`StudyError::Cancelled`].
pub fn error_spectra(
    scene: &TracedScene,
    choices: &[SamplerChoice],
    plan: &ErrorPlan,
    control: Control<'_>,
) -> Result<Vec<ErrorSpectrum>, StudyError> {
    for (what, is_empty) in [
        ("samplers", choices.is_empty()),
        ("trials", plan.n_trials == 0),
        ("samples", plan.spp == 0 || plan.reference_spp == 0),
    ] {
        if is_empty {
            return Err(StudyError::EmptyPlan(what));
        }
    }
    let [width, height] = scene.scene().camera.resolution;
    let pixels = u64::from(width) * u64::from(height);
    let copies = u64::from(plan.n_trials);
    if pixels.saturating_mul(copies) > MAX_PIXELS {
        return Err(StudyError::PictureTooLarge { width, height, copies, limit: MAX_PIXELS });
    }
    let dim = scene.pixel([0, 0], Channel::Luminance).dim();
    for choice in choices {
        sampler::check_scramble(choice.sampler, choice.scramble)?;
        sampler::count_used(choice.sampler, plan.spp, dim, CountPolicy::Rect)?;
        sampler::check_trials(choice.sampler, choice.scramble, plan.spp, plan.n_trials)?;
    }
    let reference = SamplerChoice::JITTERED;
    let reference_spp =
        sampler::count_used(reference.sampler, plan.reference_spp, dim, CountPolicy::Snap)?;
    // Overwrites `means`, as many as there are trials.
    let estimate = |choice: SamplerChoice, index: usize, n_samples, means: &mut [f64]| {
        let pixel = [(index % width as usize) as u32, (index / width as usize) as u32];
        let integrand = scene.pixel(pixel, Channel::Luminance);
        let (seed, sampler) = (plan.seed, choice.sampler.stream_id());
        let key = StreamKey { seed, pixel, sampler, n_samples, trial: 0 };
        let set = PointSet { key, dim, scramble: choice.scramble, rectangular: true };
        set.key.check()?;
        trial_means(&integrand, choice.sampler, &set, 0, means, control.cancel);
        (control.progress)(n_samples * means.len() as u64);
        Ok::<_, StudyError>(())
    };
    // Estimates of each pixel side by side.
    let pictures = |choice: SamplerChoice, spp, n_trials: usize| {
        let mut means = vec![0.0; pixels as usize * n_trials];
        let of_pixels = means.par_chunks_mut(n_trials).enumerate();
        of_pixels.try_for_each(|(index, means)| estimate(choice, index, spp, means))?;
        if control.cancel.load(Ordering::Relaxed) {
            return Err(StudyError::Cancelled);
        }
        Ok(means)
    };
    let truth = pictures(reference, reference_spp, 1)?;
    let n_trials = plan.n_trials as usize;
    let of_choice = |choice: &SamplerChoice| {
        let means = pictures(*choice, plan.spp, n_trials)?;
        let periodogram = |trial: usize| {
            let estimates = means[trial..].iter().step_by(n_trials);
            let picture: Vec<_> = estimates.zip(&truth).map(|(mean, truth)| mean - truth).collect();
            let mse = picture.iter().map(|error| error * error).sum::<f64>() / pixels as f64;
            (of_picture(&picture, width as usize), mse)
        };
        let (spectra, mses): (Vec<_>, Vec<_>) =
            (0..n_trials).into_par_iter().map(periodogram).unzip();
        let mse = mses.iter().sum::<f64>() / n_trials as f64;
        let spectrum = Spectrum::mean(spectra).ok_or(StudyError::EmptyPlan("trials"))?;
        Ok(ErrorSpectrum { spectrum, mse })
    };
    choices.iter().map(of_choice).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::with_threads;

    /// A wall seen from near by: the headlight's cosine makes every pixel a slope, much like its
    /// neighbours.
    fn wall(side: u32) -> TracedScene {
        let folder = tempfile::tempdir().unwrap();
        let wall = "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3\nf 1 3 4\n";
        std::fs::write(folder.path().join("wall.obj"), wall).unwrap();
        let scene = format!(
            "[camera]\neye = [0.4, 0.3, 1.0]\nlook_at = [0.0, 0.0, 0.0]\nfov_y = 80.0\n\
             resolution = [{side}, {side}]\n[[mesh]]\npath = \"wall.obj\"\n"
        );
        let path = folder.path().join("wall.toml");
        std::fs::write(&path, scene).unwrap();
        TracedScene::new(crate::scene::load(path.to_str().unwrap()).unwrap())
    }

    fn spectra(side: u32, names: &[&str], n_trials: u32) -> Vec<ErrorSpectrum> {
        let choices: Vec<_> =
            names.iter().map(|name| SamplerChoice::named(name).unwrap()).collect();
        let plan = ErrorPlan { spp: 4, reference_spp: 1024, n_trials, seed: 1996 };
        error_spectra(&wall(side), &choices, &plan, Control::unwatched()).unwrap()
    }

    #[test]
    fn threads_change_no_bit() {
        let run = |threads| with_threads(Some(threads), || spectra(12, &["random", "zsobol"], 2));
        // NaN at frequency zero is not equal to itself.
        let bits = |found: Vec<ErrorSpectrum>| -> Vec<u64> {
            let power = |e: &ErrorSpectrum| e.spectrum.power().to_vec();
            found.iter().flat_map(power).map(f64::to_bits).collect()
        };
        assert_eq!(bits(run(1)), bits(run(3)));
        let set = PointSet {
            key: StreamKey { seed: 1, pixel: [0, 0], sampler: 0, n_samples: 9, trial: 0 },
            dim: 3,
            scramble: sampler::Scramble::None,
            rectangular: false,
        };
        let points = |threads| {
            let mut trials = Vec::new();
            let spectrum = with_threads(Some(threads), || {
                let mut each = |so_far: &Spectrum| trials.push(so_far.periodograms());
                let control = Control::unwatched();
                point_spectrum(&sampler::Random, &set, [2, 1], 5, 37, control, &mut each)
            });
            assert_eq!(trials, [16, 32, 37]);
            spectrum.unwrap()
        };
        let bits = |s: Spectrum| s.power().iter().map(|p| p.to_bits()).collect::<Vec<_>>();
        assert_eq!(points(1).periodograms(), 37);
        assert_eq!(bits(points(1)), bits(points(3)));
    }

    /// The paper's closing remark: error pushed to high frequency. Pixels under `jittered` err
    /// independently: their spectrum is flat. The mean of the 34 or so lowest frequencies of two
    /// pictures is 1 ± 0.12; five of these are the bound. Under `zsobol` neighbours err in
    /// opposite directions where they look alike.
    #[test]
    fn zsobol_pushes_error_to_high_frequency() {
        let found = spectra(64, &["jittered", "zsobol"], 2);
        let band = |e: &ErrorSpectrum, lo: f64, hi: f64| {
            let rings = e.spectrum.radial();
            let inside = rings.iter().filter(|r| (lo..=hi).contains(&r.frequency));
            let (sum, n) = inside.fold((0.0, 0.0), |(sum, n), ring| {
                let weight = f64::from(ring.frequencies);
                (sum + weight * ring.power, n + weight)
            });
            sum / n
        };
        let [jittered, zsobol] = [&found[0], &found[1]].map(|e| band(e, 0.0, 4.5 / 64.0));
        assert!((jittered - 1.0).abs() < 0.6, "{jittered}");
        assert!(zsobol < 0.25, "{zsobol}");
        assert!(band(&found[1], 0.4, 0.5) > 1.0);
        assert!(found[1].mse < found[0].mse);
    }
}
