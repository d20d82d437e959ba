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
use stratcore::study::{Control, study};

/// A study as JSON.
#[derive(Serialize)]
struct StudyDocument<'a, S> {
    #[serde(flatten)]
    subject: S,
    n_policy: CountPolicy,
    #[serde(flatten)]
    result: &'a StudyResult,
    expect: Option<&'a Verdict>,
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
    let result = study(integrand, pixel, &plan, control)?;
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
        })?;
    } else {
        output::print(&table::study(title, &result))?;
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
