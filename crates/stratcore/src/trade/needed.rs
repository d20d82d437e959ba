//! How many samples each pixel needs for one error everywhere, and whether they do it.
//!
//! The question of adaptive sampling (Lee, Redner & Uselton 1985; Purgathofer 1987; Painter &
//! Sloan 1989), answered here from measured curves and not from a single pass: each pixel's
//! variance against N is measured, and N is read off where it meets the target.

mod reading;

pub use reading::Need;

use super::choice::next_admitted;
use super::{Subject, Target, mean_square_error, means_of, measured_reference};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::sampler::{CountPolicy, Scramble, count_used};
use crate::scene::Channel;
use crate::study::{Control, SamplerChoice, StudyPlan, study};
use crate::trace::TracedScene;
use crate::variance::{Moments, neumaier_sum};
use rayon::prelude::*;
use reading::need;
use serde::Serialize;

/// What the maps are made of.
#[derive(Clone)]
pub struct NeededPlan {
    /// RMS error that each pixel is to have.
    pub target: Target,
    /// Samplers whose N is wanted; counts, trials and seed of the measurement.
    pub study: StudyPlan,
    /// No pixel is given more samples than this.
    pub most: u64,
}

/// One map per sampler, each with its proof.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Needed {
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// Mean radiance over the picture.
    pub mean_radiance: f64,
    /// RMS error that each pixel is to have, in radiance.
    pub error: f64,
    /// Seed of the proof's randomness.
    pub proof_seed: u64,
    /// Estimates of each pixel in the proof.
    pub proof_trials: u32,
    /// In the order of the plan's samplers.
    pub maps: Vec<NeedMap>,
}

/// The samples that pixels need under one sampler, and whether they do it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NeedMap {
    /// Sampler's name.
    pub sampler: &'static str,
    /// Its scramble.
    pub scramble: Scramble,
    /// Per pixel, row by row.
    #[serde(skip)]
    pub pixels: Vec<PixelNeed>,
    /// Samples of the whole picture.
    pub total: u64,
    /// Samples per pixel of a uniform picture of about as many: the nearest that exists.
    pub uniform_spp: u64,
    /// The smallest uniform spp that gives every pixel what it needs: the largest of the map.
    pub uniform_spp_for_all: u64,
    /// How many pixels are of each kind.
    pub kinds: Vec<(Need, u64)>,
    /// The largest share of its area that a feature can have that an exact pixel hides from all
    /// samples of the measurement, at 95 %: 3 over their number.
    pub unseen_share: f64,
    /// Errors with the map's N, of the pixels that are not exact.
    pub adaptive: Flatness,
    /// Errors with the uniform N.
    pub uniform: Flatness,
    /// Errors with the map's N of the pixels that it gives more than one sample. The others
    /// cannot be given less, however far below the target they are.
    pub adaptive_above_one: Flatness,
    /// Errors of the same pixels with the uniform N.
    pub uniform_above_one: Flatness,
}

/// One pixel's need and the proof's measurements.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelNeed {
    /// N it is given.
    pub n: u64,
    /// How that is known.
    pub need: Need,
    /// RMS error with N samples, from fresh randomness against the pixel's own reference.
    pub rmse: f64,
    /// The same with the uniform N.
    pub rmse_uniform: f64,
}

/// How errors spread over pixels, in units of the target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Flatness {
    /// Root of the mean square error over those pixels.
    pub rms: f64,
    /// 5th, 50th and 95th percentile.
    pub percentiles: [f64; 3],
    /// Share of those pixels whose error is above the target by more than the proof's own noise
    /// (three standard errors of an RMS over its trials).
    pub above: f64,
}

/// Fresh estimates of each pixel: an RMS error is then known to 9 %.
const PROOF_TRIALS: u32 = 64;

/// Most pixels over all maps: with the picture that shows them 200 MB.
const MAX_PIXELS: u64 = 1 << 21;

/// Measures every pixel's need under each sampler, then renders with that map and with uniform
/// spp, and measures the errors of both. `control.progress` is told of each pixel twice for each
/// sampler: measured, and proved.
///
/// # Errors
/// As [`study`]; [`StudyError::EmptyPlan`] where there is nothing to be measured;
/// [`StudyError::PictureTooLarge`] beyond 2^21 pixels over all samplers.
pub fn needed(
    scene: &TracedScene,
    channel: Channel,
    plan: &NeededPlan,
    control: Control<'_>,
) -> Result<Needed, StudyError> {
    let [width, height] = scene.scene().camera.resolution;
    let copies = plan.study.samplers.len() as u64;
    if (u64::from(width) * u64::from(height)).saturating_mul(copies) > MAX_PIXELS {
        return Err(StudyError::PictureTooLarge { width, height, copies, limit: MAX_PIXELS });
    }
    let pixels: Vec<[u32; 2]> = (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).collect();
    let largest = *plan.study.counts.iter().max().ok_or(StudyError::EmptyPlan("counts"))?;
    let silent = Control { progress: &|_| (), ..control };
    let means: Vec<f64> = pixels
        .par_iter()
        .map(|&pixel| {
            let integrand = scene.pixel(pixel, channel);
            let subject = Subject { pixel, integrand: &integrand };
            Ok(measured_reference(&subject, largest, plan.study.seed, silent)?.mean)
        })
        .collect::<Result<_, StudyError>>()?;
    let mean_radiance = neumaier_sum(means) / pixels.len() as f64;
    let error = plan.target.absolute(mean_radiance);
    let proof_seed = plan.study.seed.wrapping_add(1);
    let map = |&sampler: &SamplerChoice| {
        let study = StudyPlan { samplers: vec![sampler], ..plan.study.clone() };
        let job = Job { scene, channel, pixels: &pixels, error, most: plan.most, study };
        job.map(
            StudyPlan { seed: proof_seed, n_trials: PROOF_TRIALS, ..job.study.clone() },
            control,
        )
    };
    Ok(Needed {
        size: [width, height],
        mean_radiance,
        error,
        proof_seed,
        proof_trials: PROOF_TRIALS,
        maps: plan.study.samplers.iter().map(map).collect::<Result<_, _>>()?,
    })
}

/// One sampler's map to be made.
struct Job<'a> {
    scene: &'a TracedScene,
    channel: Channel,
    pixels: &'a [[u32; 2]],
    error: f64,
    most: u64,
    /// Of one sampler.
    study: StudyPlan,
}

impl Job<'_> {
    fn sampler(&self) -> SamplerChoice {
        self.study.samplers[0]
    }

    /// `proof` is the plan of the fresh estimates.
    fn map(&self, proof: StudyPlan, control: Control<'_>) -> Result<NeedMap, StudyError> {
        let Some(&first) = self.pixels.first() else { return Err(StudyError::EmptyPlan("pixels")) };
        let dim = self.scene.pixel(first, self.channel).dim();
        let (counts, choice) = (self.study.counts_used(dim)?, self.sampler());
        let rectangular = self.study.count_policy == CountPolicy::Rect;
        let admitted = |n: u64| next_admitted(choice.sampler, n, dim, rectangular).unwrap_or(n);
        let most = match choice.sampler.admits(self.most, dim, rectangular) {
            true => self.most,
            false => choice.sampler.neighbours(self.most, dim).0.unwrap_or(self.most),
        };
        let silent = Control { progress: &|_| (), ..control };
        let needs: Vec<(u64, Need)> = self
            .pixels
            .par_iter()
            .map(|&pixel| {
                let integrand = self.scene.pixel(pixel, self.channel);
                let curve = study(&integrand, pixel, &self.study, silent)?.samplers.remove(0);
                (control.progress)(1);
                Ok(need(&curve, self.error, most, &admitted))
            })
            .collect::<Result<_, StudyError>>()?;
        let total: u64 = needs.iter().map(|(n, _)| n).sum();
        let mean_n = (total as f64 / self.pixels.len() as f64).round().max(1.0) as u64;
        let uniform_spp =
            count_used(choice.sampler, mean_n, dim, CountPolicy::Snap).unwrap_or(mean_n);
        let pixels: Vec<PixelNeed> = self
            .pixels
            .par_iter()
            .zip(&needs)
            .map(|(&pixel, &(n, need))| {
                let integrand = self.scene.pixel(pixel, self.channel);
                let subject = Subject { pixel, integrand: &integrand };
                // 64 estimates as good as those that are judged: an error of 1/8 of theirs, which
                // is taken off again.
                let wanted = n.max(uniform_spp);
                let seed = proof.seed.wrapping_add(1);
                let reference = measured_reference(&subject, wanted, seed, silent)?;
                let rmse = |n| {
                    let means = means_of(&subject, choice, &proof, n, silent)?;
                    Ok::<_, StudyError>(mean_square_error(&Moments::of(&means), &reference).sqrt())
                };
                let measured =
                    PixelNeed { n, need, rmse: rmse(n)?, rmse_uniform: rmse(uniform_spp)? };
                (control.progress)(1);
                Ok(measured)
            })
            .collect::<Result<_, StudyError>>()?;
        let kinds = [Need::Measured, Need::Extrapolated, Need::Capped, Need::Exact, Need::Rare]
            .map(|kind| (kind, needs.iter().filter(|(_, need)| *need == kind).count() as u64));
        let per_pixel = counts[0].iter().sum::<u64>() * u64::from(self.study.n_trials);
        let all = |pixel: &PixelNeed| pixel.need != Need::Exact;
        let above_one = |pixel: &PixelNeed| all(pixel) && pixel.n > 1;
        let flatness = |of: &dyn Fn(&PixelNeed) -> bool, rmse: fn(&PixelNeed) -> f64| {
            Flatness::of(pixels.iter().filter(|pixel| of(pixel)).map(rmse), self.error)
        };
        let (adaptive, uniform) = (|pixel: &PixelNeed| pixel.rmse, |p: &PixelNeed| p.rmse_uniform);
        Ok(NeedMap {
            sampler: choice.sampler.name(),
            scramble: choice.scramble,
            total,
            uniform_spp,
            uniform_spp_for_all: needs.iter().map(|(n, _)| *n).max().unwrap_or(1),
            kinds: kinds.to_vec(),
            unseen_share: 3.0 / per_pixel as f64,
            adaptive: flatness(&all, adaptive),
            uniform: flatness(&all, uniform),
            adaptive_above_one: flatness(&above_one, adaptive),
            uniform_above_one: flatness(&above_one, uniform),
            pixels,
        })
    }
}

impl Flatness {
    fn of(rmse: impl Iterator<Item = f64>, error: f64) -> Self {
        let mut errors: Vec<f64> = rmse.map(|rmse| rmse / error).collect();
        errors.sort_by(f64::total_cmp);
        let count = errors.len() as f64;
        let squares: f64 = errors.iter().map(|e| e * e).sum();
        let percentile = |share: f64| {
            let last = errors.len().saturating_sub(1) as f64;
            errors.get((share * last).round() as usize).copied().unwrap_or(f64::NAN)
        };
        // An RMS of normal errors over m trials is known to 1/√(2m).
        let noise = 3.0 / (2.0 * f64::from(PROOF_TRIALS)).sqrt();
        let above = errors.iter().filter(|e| **e > 1.0 + noise).count() as f64;
        Self {
            rms: (squares / count).sqrt(),
            percentiles: [0.05, 0.5, 0.95].map(percentile),
            above: above / count,
        }
    }
}
