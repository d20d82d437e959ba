//! The experiment in four dimensions, repeated with many seeds.

use super::tally::{mean_and_deviation, named};
use crate::report::summary::{FormFactor, FormFactorCase};
use anyhow::{Context, Result};
use stratcore::StudyResult;
use stratcore::fit::paper_fit;
use stratcore::integrand::{self, Integrand};
use stratcore::study::{Control, SamplerChoice, StudyPlan, study};
use stratcore::variance::Spread;

/// Sides of the half-way occluder. The paper does not give its side; 1 blocks every ray.
pub const SIDES: [f64; 8] = [0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];

/// The side whose curves are drawn and whose exponents stand beside the paper's.
pub const SIDE: f64 = 0.5;

/// The paper's protocol: N = 1⁴, 2⁴, …, 10⁴, M = 50.
pub fn plan(seed: u64) -> Result<StudyPlan> {
    Ok(StudyPlan {
        samplers: vec![SamplerChoice::named("jittered")?],
        counts: (1..=10u64).map(|k| k.pow(4)).collect(),
        seed,
        ..StudyPlan::paper()
    })
}

/// The integrand without (`None`) or with an occluder.
pub fn geometry(occluder: Option<f64>) -> Result<Box<dyn Integrand>> {
    let params: Vec<_> = occluder.map(|side| ("occluder".to_owned(), side)).into_iter().collect();
    Ok(integrand::by_name("form-factor", None, &params)?)
}

/// Samples that [`measure`] will evaluate.
pub fn samples(repeats: u32) -> Result<u64> {
    let plan = plan(0)?;
    let each = plan.counts.iter().sum::<u64>() * u64::from(plan.n_trials);
    Ok(each * u64::from(repeats) * (1 + SIDES.len() as u64))
}

/// Repeats every geometry with the seeds `seed`, `seed + 1`, ….
pub fn measure(seed: u64, repeats: u32, control: Control<'_>) -> Result<FormFactor> {
    let mut estimates = Vec::new();
    let mut cases = Vec::new();
    for occluder in std::iter::once(None).chain(SIDES.map(Some)) {
        let integrand = geometry(occluder)?;
        let mut exponents = [Vec::new(), Vec::new()];
        let mut predicted = None;
        for repeat in 0..repeats {
            let plan = plan(seed.wrapping_add(repeat.into()))?;
            let result = study(&*integrand, [0, 0], &plan, control)?;
            let jittered = named(&result, "jittered").context("the plan has no jittered")?;
            predicted = jittered.predicted;
            let fits = [jittered.paper_fit, jittered.paper_fit_without_first];
            for (list, fit) in exponents.iter_mut().zip(fits) {
                list.extend(fit.map(|fit| fit.exponent));
            }
            if occluder.is_none() {
                estimates.extend(jittered.rows.last().map(|row| row.grand_mean));
            }
        }
        let statistic = |of: fn(&[f64]) -> f64| {
            [0, 1].map(|i| Some(of(&exponents[i])).filter(|v| v.is_finite()))
        };
        cases.push(FormFactorCase {
            occluder,
            predicted: predicted.filter(|_| !exponents[0].is_empty()),
            exact: [0, 1].map(|skip| exact_exponent(&*integrand, &plan(seed).ok()?.counts, skip)),
            mean: statistic(|p| mean_and_deviation(p)[0]),
            std_error: statistic(|p| mean_and_deviation(p)[1] / (p.len() as f64).sqrt()),
            scatter: statistic(|p| mean_and_deviation(p)[1]),
            one_run: statistic(|p| p.first().copied().unwrap_or(f64::NAN)),
        });
    }
    let [estimate, deviation] = mean_and_deviation(&estimates);
    let std_error = deviation / (estimates.len() as f64).sqrt();
    let analytic = geometry(None)?.reference().context("the form factor has no closed form")?.mean;
    Ok(FormFactor {
        counts: plan(seed)?.counts,
        repeats,
        estimate,
        std_error,
        analytic,
        z: (estimate - analytic) / std_error,
        cases,
    })
}

/// The exponent that the exact variances of `jittered` fit to: what the mean over infinitely
/// many repeats would be, but for the curvature of the logarithm, which is equal at every N.
fn exact_exponent(integrand: &dyn Integrand, counts: &[u64], skip: usize) -> Option<f64> {
    let rows: Vec<_> = counts
        .iter()
        .skip(skip)
        .map(|&n| {
            let variance_of_mean = integrand.exact_variance("jittered", n)?;
            Some((n, Spread { grand_mean: 0.0, variance_of_mean, var_ln: 1.0 }))
        })
        .collect::<Option<_>>()?;
    Some(paper_fit(rows.iter().map(|(n, spread)| (*n, spread)))?.exponent)
}

/// One run of both samplers, for a chart.
pub fn one_run(seed: u64, occluder: Option<f64>, control: Control<'_>) -> Result<StudyResult> {
    let samplers = StudyPlan::paper().samplers;
    let plan = StudyPlan { samplers, ..plan(seed)? };
    Ok(study(&*geometry(occluder)?, [0, 0], &plan, control)?.with_paper_fits())
}
