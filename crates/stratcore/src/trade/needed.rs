//! How many samples each pixel needs for one error everywhere, and whether they do it.
//!
//! The question of adaptive sampling (Lee, Redner & Uselton 1985; Purgathofer 1987; Painter &
//! Sloan 1989), answered here from measured curves and not from a single pass: each pixel's
//! variance against N is measured, and N is read off where it meets the target.

use super::{Subject, Target, mean_square_error, means_of, measured_reference};
use crate::error::StudyError;
use crate::sampler::CountPolicy;
use crate::scene::Channel;
use crate::study::{Control, SamplerChoice, SamplerResult, StudyPlan, study};
use crate::trace::TracedScene;
use crate::variance::{Moments, neumaier_sum};
use rayon::prelude::*;
use serde::Serialize;

/// What the map is made of.
#[derive(Clone)]
pub struct NeededPlan {
    /// The sampler whose N is wanted.
    pub sampler: SamplerChoice,
    /// RMS error that each pixel is to have.
    pub target: Target,
    /// Counts, trials and seed of the measurement.
    pub study: StudyPlan,
    /// No pixel is given more samples than this.
    pub most: u64,
}

/// What is known of one pixel's need.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Need {
    /// Read off its curve, within the N that were measured.
    Measured,
    /// Read off its fit, beyond them.
    Extrapolated,
    /// The target asks for more samples than the plan allows; it has the most.
    Capped,
    /// No trial at any N differed from another. It is given one sample; a feature that all the
    /// samples of the measurement missed is not known of.
    Exact,
    /// The smallest N saw nothing vary, larger ones did: a feature smaller than single samples
    /// find. Its N is not taken below the smallest that saw it.
    Rare,
}

/// The map, and the proof of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Needed {
    /// Pixels in a row, and rows.
    pub size: [u32; 2],
    /// Mean radiance over the picture.
    pub mean_radiance: f64,
    /// RMS error that each pixel is to have, in radiance.
    pub error: f64,
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
    /// The most samples that a feature can have hidden from in an exact pixel, as a share of
    /// its area, at 95 %: 3 over the samples of the measurement.
    pub unseen_share: f64,
    /// Seed of the proof's randomness.
    pub proof_seed: u64,
    /// Estimates of each pixel in the proof.
    pub proof_trials: u32,
    /// Errors with the map's N.
    pub adaptive: Flatness,
    /// Errors with the uniform N.
    pub uniform: Flatness,
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

/// How errors spread over the pixels that are not exact, in units of the target.
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

/// Measures every pixel's need, then renders with that map and with uniform spp, and measures
/// the errors of both.
///
/// # Errors
/// As [`study`].
pub fn needed(
    scene: &TracedScene,
    channel: Channel,
    plan: &NeededPlan,
    control: Control<'_>,
) -> Result<Needed, StudyError> {
    let [width, height] = scene.scene().camera.resolution;
    let pixels: Vec<[u32; 2]> = (0..height).flat_map(|y| (0..width).map(move |x| [x, y])).collect();
    let of_one = StudyPlan { samplers: vec![plan.sampler], ..plan.study.clone() };
    let dim = 2;
    let curves: Vec<SamplerResult> = pixels
        .par_iter()
        .map(|&pixel| {
            let integrand = scene.pixel(pixel, channel);
            Ok(study(&integrand, pixel, &of_one, control)?.samplers.remove(0))
        })
        .collect::<Result<_, StudyError>>()?;
    let largest_row = |curve: &SamplerResult| curve.rows.last().map_or(0.0, |r| r.grand_mean);
    let mean_radiance = neumaier_sum(curves.iter().map(largest_row)) / pixels.len() as f64;
    let error = plan.target.absolute(mean_radiance);
    let admitted = |n: u64| {
        let rectangular = plan.study.count_policy == CountPolicy::Rect;
        let sampler = plan.sampler.sampler;
        if sampler.admits(n, dim, rectangular) {
            n
        } else {
            sampler.neighbours(n, dim).1.unwrap_or(n)
        }
    };
    let needs: Vec<(u64, Need)> =
        curves.iter().map(|curve| need(curve, error, plan.most, &admitted)).collect();
    let total: u64 = needs.iter().map(|(n, _)| n).sum();
    let uniform_spp = nearest_admitted(plan, total as f64 / pixels.len() as f64, dim);
    let proof_seed = plan.study.seed.wrapping_add(1);
    let proof = StudyPlan { seed: proof_seed, n_trials: PROOF_TRIALS, ..of_one };
    let measured: Vec<PixelNeed> = pixels
        .par_iter()
        .zip(&needs)
        .map(|(&pixel, &(n, need))| {
            let integrand = scene.pixel(pixel, channel);
            let subject = Subject { pixel, integrand: &integrand };
            // 64 estimates as good as those that are judged: an error of 1/8 of theirs, which is
            // taken off again.
            let wanted = n.max(uniform_spp);
            let seed = proof_seed.wrapping_add(1);
            let reference = measured_reference(&subject, wanted, seed, control)?;
            let rmse = |n| {
                let means = means_of(&subject, plan.sampler, &proof, n, control)?;
                Ok::<_, StudyError>(mean_square_error(&Moments::of(&means), &reference).sqrt())
            };
            Ok(PixelNeed { n, need, rmse: rmse(n)?, rmse_uniform: rmse(uniform_spp)? })
        })
        .collect::<Result<_, StudyError>>()?;
    let kinds = [Need::Measured, Need::Extrapolated, Need::Capped, Need::Exact, Need::Rare]
        .map(|kind| (kind, needs.iter().filter(|(_, need)| *need == kind).count() as u64));
    let per_pixel: u64 = plan.study.counts.iter().sum::<u64>() * u64::from(plan.study.n_trials);
    Ok(Needed {
        size: [width, height],
        mean_radiance,
        error,
        total,
        uniform_spp,
        uniform_spp_for_all: needs.iter().map(|(n, _)| *n).max().unwrap_or(1),
        kinds: kinds.to_vec(),
        unseen_share: 3.0 / per_pixel as f64,
        proof_seed,
        proof_trials: PROOF_TRIALS,
        adaptive: Flatness::of(&measured, error, |pixel| pixel.rmse),
        uniform: Flatness::of(&measured, error, |pixel| pixel.rmse_uniform),
        pixels: measured,
    })
}

/// N of one pixel. Its fit is used where one slope describes the rows, two terms where they do
/// better, and the rows themselves, joined in log space, where neither does.
fn need(
    curve: &SamplerResult,
    error: f64,
    most: u64,
    admitted: &dyn Fn(u64) -> u64,
) -> (u64, Need) {
    const LEVEL: f64 = 0.01;
    if curve.exact {
        return (admitted(1), Need::Exact);
    }
    let rows = curve.weighted_rows();
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return (admitted(1), Need::Exact);
    };
    let wanted = error * error;
    let straight = curve.misfit_p_value.is_none_or(|p| p >= LEVEL);
    let on_curve = |variance_at: &dyn Fn(f64) -> f64| {
        // The curve falls: bisect ln N.
        let (mut lo, mut hi) = (0.0, (most as f64).ln() + 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (lo + hi);
            if variance_at(f64::exp(middle)) > wanted { lo = middle } else { hi = middle }
        }
        if variance_at(1.0) <= wanted { 1.0 } else { hi.exp() }
    };
    let n = match (&curve.fit, &curve.two_terms) {
        (_, Some(two)) => on_curve(&|n| two.variance_at(n)),
        (Some(fit), None) if straight => on_curve(&|n| fit.variance_at(n)),
        (Some(fit), None) => {
            let above = rows.iter().rposition(|row| row.variance > wanted);
            match above {
                None => first.n as f64,
                Some(i) if i + 1 < rows.len() => {
                    let (a, b) = (rows[i], rows[i + 1]);
                    let share = (a.variance / wanted).ln() / (a.variance / b.variance).ln();
                    (a.n as f64).powf(1.0 - share) * (b.n as f64).powf(share)
                }
                Some(_) => {
                    let (n, over) = (last.n as f64, last.variance / wanted);
                    n * over.powf(1.0 / fit.exponent.max(0.5))
                }
            }
        }
        (None, None) => last.n as f64 * (last.variance / wanted).max(1.0),
    };
    let saw_nothing = curve.rows.iter().take_while(|row| row.variance_of_mean == 0.0).count();
    let rare = saw_nothing > 0;
    let n = if rare { n.max(first.n as f64) } else { n };
    if n > most as f64 {
        return (most, Need::Capped);
    }
    let need = match () {
        () if rare => Need::Rare,
        () if n > last.n as f64 => Need::Extrapolated,
        () => Need::Measured,
    };
    (admitted(n.ceil().max(1.0) as u64).min(most), need)
}

/// The N that exists nearest to a mean that may not.
fn nearest_admitted(plan: &NeededPlan, mean: f64, dim: usize) -> u64 {
    let n = mean.round().max(1.0) as u64;
    crate::sampler::count_used(plan.sampler.sampler, n, dim, CountPolicy::Snap).unwrap_or(n)
}

impl Flatness {
    fn of(pixels: &[PixelNeed], error: f64, rmse: impl Fn(&PixelNeed) -> f64) -> Self {
        let varying = pixels.iter().filter(|pixel| pixel.need != Need::Exact);
        let mut errors: Vec<f64> = varying.map(|pixel| rmse(pixel) / error).collect();
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

#[cfg(test)]
mod tests {
    use super::*;

    fn square(n: u64) -> u64 {
        let mut k = 1;
        while k * k < n {
            k += 1;
        }
        k * k
    }

    fn curve_of(name: &str, params: &[(String, f64)]) -> SamplerResult {
        let f = crate::integrand::by_name(name, None, params).unwrap();
        let jittered = SamplerChoice::named("jittered").unwrap();
        let plan = StudyPlan { samplers: vec![jittered], n_trials: 2000, ..StudyPlan::paper() };
        study(&*f, [0, 0], &plan, Control::unwatched()).unwrap().samplers.remove(0)
    }

    /// A ramp's variance is |a|²/(12 N²) exactly, so N for an error is known; M = 2000 knows a
    /// variance to 3 % and the fit better, and N is rounded up to a square.
    #[test]
    fn a_ramp_is_given_what_its_closed_form_asks_for() {
        let ramp = curve_of("ramp", &[]);
        let variance = ramp.rows[0].exact_variance.unwrap();
        for k in [3.5f64, 10.5, 40.5] {
            let error = variance.sqrt() / (k * k);
            let (n, need) = need(&ramp, error, 1 << 20, &square);
            assert_eq!(n, ((k + 0.5) * (k + 0.5)) as u64, "{need:?}");
            assert_eq!(need == Need::Extrapolated, k > 16.0);
        }
        assert_eq!(need(&ramp, 1e-9, 10_000, &square), (10_000, Need::Capped));
    }

    #[test]
    fn exact_and_rare_pixels_are_told_apart() {
        assert_eq!(need(&curve_of("constant", &[]), 0.1, 1 << 20, &square), (1, Need::Exact));
        // 3 in a million of the area: trials of few samples see nothing.
        let speck = curve_of("disk", &[("radius".to_owned(), 0.001)]);
        assert_eq!(speck.rows[0].variance_of_mean, 0.0);
        let (n, kind) = need(&speck, 1.0, 1 << 20, &square);
        assert!(kind == Need::Rare && n > 1, "{n} {kind:?}");
    }
}
