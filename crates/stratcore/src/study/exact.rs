//! A study without trials, where a pixel allows it.

use super::{
    Control, Method, Row, SamplerChoice, SamplerResult, StudyPlan, StudyResult, study_sampler,
    summarise,
};
use crate::error::StudyError;
use crate::exact::{ExactCurve, Grids, Unresolved};
use crate::integrand::{Integrand, Reference};
use crate::noise::Noise;
use crate::sampler::{CountPolicy, Scramble};
use crate::trace::PixelIntegrand;
use std::sync::atomic::Ordering;

/// A plan for pixels whose exact curves are wanted: what all pixels share is made once.
pub struct ExactStudy<'a> {
    plan: &'a StudyPlan,
    counts_used: Vec<Vec<u64>>,
    /// Of the N that `jittered` uses.
    grids: Result<Grids, Unresolved>,
    tolerance: f64,
}

impl<'a> ExactStudy<'a> {
    /// Dimensions of a pixel that has an exact curve.
    const DIM: usize = 2;

    /// Makes ready for pixels. `tolerance` is what variances may be off, as a share of
    /// themselves; [`exact::TOLERANCE`](crate::exact::TOLERANCE) is a good one.
    ///
    /// # Errors
    /// What [`StudyPlan::counts_used`] refuses.
    pub fn new(plan: &'a StudyPlan, tolerance: f64) -> Result<Self, StudyError> {
        let counts_used = plan.counts_used(Self::DIM)?;
        let jittered = plan.samplers.iter().position(|c| is_plain(*c, "jittered"));
        let grids = Grids::new(jittered.map_or(&[], |at| &counts_used[at][..]));
        Ok(Self { plan, counts_used, grids, tolerance })
    }

    /// Studies one pixel. `random` and `jittered` without a scramble are exact where the pixel
    /// can be resolved; everything else is measured by trials, as by [`study`](super::study),
    /// and tells why in [`SamplerResult::unresolved`]. The pixel's mean is the reference.
    ///
    /// # Errors
    /// Those of [`study`](super::study).
    pub fn pixel(
        &self,
        integrand: &PixelIntegrand<'_>,
        pixel: [u32; 2],
        control: Control<'_>,
    ) -> Result<StudyResult, StudyError> {
        let plan = self.plan;
        let curve = match integrand {
            PixelIntegrand::Rays(_) => Err(Unresolved::Rays),
            PixelIntegrand::AreaBeam(_) | PixelIntegrand::Filtered(_) => Err(Unresolved::Weighted),
            PixelIntegrand::Beam(beam) => {
                let grids = self.grids.as_ref().map_err(Clone::clone);
                grids.and_then(|grids| grids.curve(beam, self.tolerance))
            }
        };
        let mut samplers = Vec::with_capacity(plan.samplers.len());
        for (choice, used) in plan.samplers.iter().zip(&self.counts_used) {
            if control.cancel.load(Ordering::Relaxed) {
                break;
            }
            let rows = curve.as_ref().map_err(Clone::clone).and_then(|curve| {
                exact_rows(plan, *choice, used, curve).ok_or(Unresolved::Sampler)
            });
            let result = match rows {
                Ok(rows) => {
                    let samples = rows.iter().fold(0u64, |sum, row| sum.saturating_add(row.n_used));
                    (control.progress)(samples.saturating_mul(plan.n_trials.into()));
                    let measured = summarise(integrand, *choice, rows, 0);
                    SamplerResult { method: Method::Exact, ..measured }
                }
                Err(reason) => {
                    match study_sampler(integrand, pixel, plan, *choice, used, control) {
                        Ok(result) => SamplerResult { unresolved: Some(reason), ..result },
                        Err(StudyError::Cancelled) => break,
                        Err(error) => return Err(error),
                    }
                }
            };
            samplers.push(result);
        }
        if samplers.is_empty() {
            return Err(StudyError::Cancelled);
        }
        Ok(StudyResult {
            pixel,
            dim: integrand.dim(),
            axes: integrand.axes(),
            seed: plan.seed,
            trials: plan.n_trials,
            reference: curve.ok().map(|curve| Reference { mean: curve.mean, std_error: 0.0 }),
            complete: samplers.len() == plan.samplers.len(),
            samplers,
        })
    }
}

fn is_plain(choice: SamplerChoice, name: &str) -> bool {
    choice.sampler.name() == name && choice.scramble == Scramble::None
}

/// None for a sampler whose variances the curve does not hold.
fn exact_rows(
    plan: &StudyPlan,
    choice: SamplerChoice,
    counts_used: &[u64],
    curve: &ExactCurve,
) -> Option<Vec<Row>> {
    let variances: Vec<f64> = if is_plain(choice, "random") {
        counts_used.iter().map(|&n| curve.variance / n as f64).collect()
    } else if is_plain(choice, "jittered") {
        curve.jittered.clone()
    } else {
        return None;
    };
    let rectangular = plan.count_policy == CountPolicy::Rect;
    let rows = plan.counts.iter().zip(counts_used).zip(variances);
    let row = |((&n, &n_used), variance_of_mean)| Row {
        n,
        n_used,
        grand_mean: curve.mean,
        variance_of_mean,
        skewness: 0.0,
        kurtosis: 0.0,
        noise: Noise::None,
        exact_variance: None,
        strata: rectangular.then(|| choice.sampler.strata(n_used, ExactStudy::DIM)).flatten(),
        ns_per_sample: None,
    };
    Some(rows.map(row).collect())
}
