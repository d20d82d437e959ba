//! What `pixel` and `integrand` share: run the plan, show the result, judge the expectation.

use super::Outcome;
use crate::cli::{Common, StudyArgs};
use crate::output;
use crate::plan::{self, Expectation, Verdict};
use crate::progress::Progress;
use crate::report::{PlotFile, chart};
use crate::table;
use anyhow::Result;
use serde::Serialize;
use std::time::Instant;
use stratcore::StudyResult;
use stratcore::integrand::Integrand;
use stratcore::sampler::CountPolicy;
use stratcore::study::{Control, Stop, StopReason, study, study_until};

/// A study as JSON.
#[derive(Serialize)]
struct StudyDocument<'a, S> {
    #[serde(flatten)]
    subject: S,
    n_policy: CountPolicy,
    #[serde(flatten)]
    result: &'a StudyResult,
    expect: Option<&'a Verdict>,
    #[serde(skip_serializing_if = "Option::is_none")]
    stop: Option<&'a Stop>,
}

/// Studies an integrand. `subject` names it in JSON and `title` in text.
pub fn run(
    subject: impl Serialize,
    title: &str,
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    args: &StudyArgs,
    common: &Common,
) -> Result<Outcome> {
    let expectation = args.expect.as_deref().map(str::parse::<Expectation>).transpose()?;
    if let Some(expectation) = &expectation {
        expectation.check(&args.samplers)?;
    }
    let plan = plan::study_plan(args, common, integrand.dim())?;
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let per_trial: u64 = plan
        .counts_used(integrand.dim())?
        .iter()
        .flatten()
        .fold(0, |sum, n| sum.saturating_add(*n));
    let progress =
        Progress::new("sampling", per_trial.saturating_mul(plan.n_trials.into()), common);
    let start = Instant::now();
    let clock = || start.elapsed();
    let control =
        Control { clock: if args.timing { Some(&clock) } else { None }, ..progress.control() };
    let (result, stop) = match args.until.as_deref().map(plan::until).transpose()? {
        Some(until) => {
            let (result, stop) = study_until(integrand, pixel, &plan, until, control, &mut |_| {})?;
            (result, Some(stop))
        }
        None => (study(integrand, pixel, &plan, control)?, None),
    };
    drop(progress);

    if let Some(plot) = plot {
        plot.commit(&chart::convergence(title, &result))?;
    }
    let verdict = match expectation {
        Some(expectation) if result.complete => expectation.judge(&args.samplers, &result),
        _ => None,
    };
    if common.json {
        output::print_json(StudyDocument {
            subject,
            n_policy: plan.count_policy,
            result: &result,
            expect: verdict.as_ref(),
            stop: stop.as_ref(),
        })?;
    } else {
        let stopped = stop.as_ref().map_or(String::new(), |stop| table::stop(stop, &result));
        output::print(&(table::study(title, &result) + &stopped))?;
    }
    if stop.is_some_and(|stop| stop.reason == StopReason::Cancelled) {
        output::note(&format!("interrupted: {} trials were finished and kept", result.trials));
        return Ok(Outcome::Interrupted);
    }
    if !result.complete {
        let (kept, planned) = (result.samplers.len(), plan.samplers.len());
        output::note(&format!("interrupted: {kept} of {planned} samplers were finished and kept"));
        return Ok(Outcome::Interrupted);
    }
    match verdict {
        Some(verdict) if !verdict.holds => {
            output::note(&verdict.to_string());
            Ok(Outcome::ExpectationFailed)
        }
        _ => Ok(Outcome::Done),
    }
}
