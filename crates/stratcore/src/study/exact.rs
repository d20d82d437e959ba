//! A study without trials, where a pixel allows it.

use super::{
    Control, Method, Row, SamplerChoice, SamplerResult, StudyPlan, StudyResult, sampler_rows,
    summarise,
};
use crate::error::StudyError;
use crate::exact::{ExactCurve, Grids, Unresolved};
use crate::integrand::{Integrand, Reference};
use crate::noise::Noise;
use crate::sampler::{CountPolicy, Scramble};
use crate::trace::PixelIntegrand;
use crate::variance::Moments;
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
        let curve = self.curve(integrand);
        let mut samplers = Vec::with_capacity(plan.samplers.len());
        for (at, &choice) in plan.samplers.iter().enumerate() {
            let result = match self.rows(at, integrand, pixel, &curve, control) {
                Ok((rows, None)) => {
                    let computed = summarise(integrand, choice, rows, 0);
                    SamplerResult { method: Method::Exact, ..computed }
                }
                Ok((rows, unresolved)) => {
                    let measured = summarise(integrand, choice, rows, plan.n_trials);
                    SamplerResult { unresolved, ..measured }
                }
                Err(StudyError::Cancelled) => break,
                Err(error) => return Err(error),
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

    /// The rows of [`pixel`](Self::pixel) without what is read from them: each sampler's moments
    /// after those of the one before, of no trials where they were computed.
    ///
    /// # Errors
    /// As [`pixel`](Self::pixel); `Cancelled` where any sampler was not finished.
    pub(crate) fn measure(
        &self,
        integrand: &PixelIntegrand<'_>,
        pixel: [u32; 2],
        control: Control<'_>,
    ) -> Result<Vec<Moments>, StudyError> {
        let plan = self.plan;
        let curve = self.curve(integrand);
        let mut moments = Vec::with_capacity(plan.samplers.len() * plan.counts.len());
        for at in 0..plan.samplers.len() {
            let (rows, unresolved) = self.rows(at, integrand, pixel, &curve, control)?;
            let trials = if unresolved.is_some() { plan.n_trials } else { 0 };
            moments.extend(rows.iter().map(|row| row.moments(trials)));
        }
        Ok(moments)
    }

    fn curve(&self, integrand: &PixelIntegrand<'_>) -> Result<ExactCurve, Unresolved> {
        match integrand {
            PixelIntegrand::Rays(_) => Err(Unresolved::Rays),
            PixelIntegrand::AreaBeam(_) | PixelIntegrand::Filtered(_) => Err(Unresolved::Weighted),
            PixelIntegrand::Beam(beam) => {
                let grids = self.grids.as_ref().map_err(Clone::clone);
                grids.and_then(|grids| grids.curve(beam, self.tolerance))
            }
        }
    }

    /// The rows of the plan's sampler at this place, and why they had to be measured.
    fn rows(
        &self,
        at: usize,
        integrand: &PixelIntegrand<'_>,
        pixel: [u32; 2],
        curve: &Result<ExactCurve, Unresolved>,
        control: Control<'_>,
    ) -> Result<(Vec<Row>, Option<Unresolved>), StudyError> {
        if control.cancel.load(Ordering::Relaxed) {
            return Err(StudyError::Cancelled);
        }
        let (plan, choice, used) = (self.plan, self.plan.samplers[at], &self.counts_used[at]);
        let computed = curve
            .as_ref()
            .map_err(Clone::clone)
            .and_then(|curve| exact_rows(plan, choice, used, curve).ok_or(Unresolved::Sampler));
        match computed {
            Ok(rows) => {
                let samples = rows.iter().fold(0u64, |sum, row| sum.saturating_add(row.n_used));
                (control.progress)(samples.saturating_mul(plan.n_trials.into()));
                Ok((rows, None))
            }
            Err(reason) => {
                let rows = sampler_rows(integrand, pixel, plan, choice, used, control)?;
                Ok((rows, Some(reason)))
            }
        }
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
