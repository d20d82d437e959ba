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
use stratcore::integrand::Integrand;
use stratcore::sampler::CountPolicy;
use stratcore::study::{Control, Stop, StopReason, Tightness, study, study_until};
use stratcore::{StudyError, StudyPlan, StudyResult};

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

/// A result, and how it was stopped where that was asked for.
pub type Measured = Result<(StudyResult, Option<Stop>), StudyError>;

/// By a fixed number of trials, or by as many as it takes.
pub fn by_trials(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    until: Option<Tightness>,
    control: Control<'_>,
) -> Measured {
    let Some(until) = until else {
        return Ok((study(integrand, pixel, plan, control)?, None));
    };
    let (result, stop) = study_until(integrand, pixel, plan, until, control, &mut |_| {})?;
    Ok((result, Some(stop)))
}

/// Studies an integrand of `dim` dimensions by `measure`. `subject` names it in JSON and `title`
/// in text.
pub fn run(
    subject: impl Serialize,
    title: &str,
    dim: usize,
    measure: &dyn Fn(&StudyPlan, Option<Tightness>, Control<'_>) -> Measured,
    args: &StudyArgs,
    common: &Common,
) -> Result<Outcome> {
    let expectation = args.expect.as_deref().map(str::parse::<Expectation>).transpose()?;
    if let Some(expectation) = &expectation {
        expectation.check(&args.protocol.samplers)?;
    }
    let until = args.until.as_deref().map(plan::until).transpose()?;
    let fixed = plan::study_plan(&args.protocol, common, dim)?;
    let n_trials = if until.is_some() { args.max_trials } else { fixed.n_trials };
    let plan = StudyPlan { n_trials, ..fixed };
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let per_trial: u64 =
        plan.counts_used(dim)?.iter().flatten().fold(0, |sum, n| sum.saturating_add(*n));
    let progress =
        Progress::new("sampling", per_trial.saturating_mul(plan.n_trials.into()), common);
    let start = Instant::now();
    let clock = || start.elapsed();
    let control =
        Control { clock: if args.timing { Some(&clock) } else { None }, ..progress.control() };
    let (result, stop) = measure(&plan, until, control)?;
    drop(progress);

    if let Some(plot) = plot {
        plot.commit(&chart::convergence(title, &result))?;
    }
    let verdict = match expectation {
        Some(expectation) if result.complete => expectation.judge(&args.protocol.samplers, &result),
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
