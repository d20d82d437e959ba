//! What is typed: single words, whole command lines, study files.

use super::says_one_line;
use clap::Parser as _;
use std::fmt::Display;
use std::path::Path;
use stratcli::cli::{Cli, Command, Common, StudyArgs};
use stratcli::plan::{self, Expectation};
use stratcli::study_file::StudyFile;
use stratcli::{output, table};
use stratcore::counts::parse_counts;
use stratcore::discrepancy::Measure;
use stratcore::integrand;
use stratcore::map::{Region, Shard};
use stratcore::study::{Control, SamplerChoice, StudyPlan, study, study_until};

/// A word of every kind.
pub fn words(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let text = text.trim();
    if text.starts_with("file:") {
        return; // What is in a file is another target's.
    }
    fn sound<T, E: Display>(read: Result<T, E>) -> Option<T> {
        read.map_err(|error| says_one_line(&output::on_one_line(&format!("{error:#}")))).ok()
    }
    if let Some(counts) = sound(parse_counts(text)) {
        assert!(counts.iter().all(|n| (1..=1 << 43).contains(n)) && counts.len() <= 1000);
    }
    if let Some(choice) = sound(SamplerChoice::named(text)) {
        for n in [1, 16, 1 << 43] {
            let plan = StudyPlan { samplers: vec![choice], counts: vec![n], ..StudyPlan::paper() };
            sound(plan.counts_used(2));
        }
    }
    sound(plan::samplers(&text.split(',').map(str::to_owned).collect::<Vec<_>>(), Some(text)));
    sound(plan::until(text));
    sound(plan::targets(&[text.to_owned()]));
    if let Some(ns) = sound(plan::duration_ns(text)) {
        assert!(ns.is_finite() && ns >= 0.0);
    }
    sound(plan::pixel(text));
    sound(plan::parameter(text));
    sound(text.parse::<Expectation>());
    if let Some([i, j]) = sound(plan::axes(text, 3)) {
        assert!(i != j && i < 3 && j < 3);
    }
    if let Some(region) = sound(text.parse::<Region>())
        && region.check([1 << 20; 2]).is_ok()
    {
        assert!(region.n_pixels() > 0);
    }
    if let Some(shard) = sound(text.parse::<Shard>()) {
        assert!(shard.tiles(&[3, 1, 4, 1, 5]).len() <= 5);
    }
    sound(text.parse::<Measure>());
}

/// A command line, an argument a line. What it asks for is planned; a small study is made, too.
pub fn arguments(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    if text.contains("file:") {
        return;
    }
    let cli = match Cli::try_parse_from(std::iter::once("stratcli").chain(text.split('\n'))) {
        Ok(cli) => cli,
        Err(error) => return says_one_line(&output::on_one_line(&error.to_string())),
    };
    let done = match &cli.command {
        Command::Integrand(args) => integrand(args, &cli.common),
        Command::Pixel(args) => {
            let _ = plan::pixel(&args.at);
            planned(&args.study, &cli.common, 2).map(|_| ())
        }
        Command::Trade(args) => plan::trade_plan(args, &cli.common, 2)
            .and_then(|plan| Ok(plan.study.counts_used(2).map(|_| ())?)),
        Command::Map(args) => plan::study_plan(&args.protocol, &cli.common, 2)
            .and_then(|plan| Ok(plan.counts_used(2).map(|_| ())?)),
        Command::Points(args) => {
            plan::samplers(std::slice::from_ref(&args.sampler), args.scramble.as_deref())
                .map(|_| ())
        }
        Command::Discrepancy(args) => {
            plan::samplers(&args.samplers, args.scramble.as_deref()).map(|_| ())
        }
        _ => Ok(()),
    };
    if let Err(error) = done {
        says_one_line(&output::on_one_line(&format!("{error:#}")));
    }
}

fn planned(args: &StudyArgs, common: &Common, dim: usize) -> anyhow::Result<StudyPlan> {
    let fixed = plan::study_plan(&args.protocol, common, dim)?;
    let n_trials = if args.until.is_some() { args.max_trials } else { fixed.n_trials };
    let plan = StudyPlan { n_trials, ..fixed };
    plan.counts_used(dim)?;
    Ok(plan)
}

/// What `integrand` does, where it is done in a moment.
fn integrand(args: &stratcli::cli::IntegrandArgs, common: &Common) -> anyhow::Result<()> {
    const MOST_SAMPLES: u64 = 20_000;
    let set =
        args.set.iter().map(|text| plan::parameter(text)).collect::<anyhow::Result<Vec<_>>>()?;
    let integrand = integrand::by_name(&args.name, args.dim, &set)?;
    let expectation = args.study.expect.as_deref().map(str::parse::<Expectation>).transpose()?;
    let until = args.study.until.as_deref().map(plan::until).transpose()?;
    let plan = planned(&args.study, common, integrand.dim())?;
    let used = plan.counts_used(integrand.dim())?;
    let per_trial = used.iter().flatten().fold(0u64, |sum, n| sum.saturating_add(*n));
    let values = per_trial.saturating_mul(plan.n_trials.into());
    if values.saturating_mul(integrand.dim() as u64) > MOST_SAMPLES {
        return Ok(());
    }
    let control = Control::unwatched();
    let result = match until {
        Some(until) => study_until(&*integrand, [0, 0], &plan, until, control, &mut |_| {})?.0,
        None => study(&*integrand, [0, 0], &plan, control)?,
    };
    if let Some(expectation) = expectation {
        expectation.judge(&args.study.protocol.samplers, &result);
    }
    assert!(!table::study("title", &result).is_empty());
    let json = output::json(&result)?;
    assert!(serde_json::from_str::<serde_json::Value>(&json).is_ok(), "{json}");
    Ok(())
}

/// `study.toml`
pub fn study_file(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    if text.contains("file:") {
        return;
    }
    let sound = |error: anyhow::Error| says_one_line(&output::on_one_line(&format!("{error:#}")));
    match StudyFile::parse(Path::new("folder/study.toml"), &text) {
        Ok(study) => {
            for entry in study.scenes() {
                // What is written is called by its scene, in the folder of results.
                assert!(!entry.name.contains(['/', '\\']) && entry.name != "..", "{}", entry.name);
            }
            for dim in [2, 5] {
                match study.plan(dim, 1) {
                    Ok(plan) => drop(plan.counts_used(dim)),
                    Err(error) => sound(error),
                }
            }
        }
        Err(error) => sound(error),
    }
}
