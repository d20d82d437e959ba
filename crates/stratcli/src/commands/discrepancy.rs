//! `discrepancy`: how badly point sets misjudge areas, against N.

use super::Outcome;
use crate::cli::{Common, DiscrepancyArgs};
use crate::output::{self, AtomicFile, csv_line};
use crate::plan;
use crate::progress::Progress;
use crate::report::{PlotFile, discrepancy as figure};
use crate::table;
use anyhow::{Context, Result, ensure};
use serde::Serialize;
use stratcore::counts::parse_counts;
use stratcore::discrepancy::Measure;
use stratcore::sampler::{CountPolicy, PointFile, Sampler, Scramble};
use stratcore::study::{Discrepancies, SamplerChoice, StudyPlan, discrepancies};

#[derive(Serialize)]
struct DiscrepancyDocument<'a> {
    n_policy: CountPolicy,
    #[serde(flatten)]
    result: &'a Discrepancies,
}

pub fn run(args: &DiscrepancyArgs, common: &Common) -> Result<Outcome> {
    let (plan, dim) = match &args.file {
        Some(path) => of_file(path, args, common)?,
        None => of_samplers(args, common)?,
    };
    let measures = measures(&args.measure, dim)?;
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let csv = args.csv.as_deref().map(AtomicFile::create).transpose()?;
    let pairs = plan.counts.iter().fold(0u64, |sum, n| sum.saturating_add(n.saturating_mul(*n)));
    let sets = u64::from(plan.n_trials).saturating_mul(plan.samplers.len() as u64);
    let progress = Progress::new("measuring", pairs.saturating_mul(sets), common);
    let result = discrepancies(&plan, dim, &measures, progress.control())?;
    drop(progress);

    if let Some(plot) = plot {
        plot.commit(&figure::chart(&result))?;
    }
    if let Some(csv) = csv {
        csv.commit(rows_as_csv(&result).as_bytes())?;
    }
    if common.json {
        let n_policy = plan.count_policy;
        output::print_json(DiscrepancyDocument { n_policy, result: &result })?;
    } else {
        output::print(&table::discrepancies(&result))?;
    }
    if result.complete {
        return Ok(Outcome::Done);
    }
    output::note("interrupted: the samplers that were finished are kept");
    Ok(Outcome::Interrupted)
}

fn of_samplers(args: &DiscrepancyArgs, common: &Common) -> Result<(StudyPlan, usize)> {
    let plan = StudyPlan {
        samplers: plan::samplers(&args.samplers, args.scramble.as_deref())?,
        counts: parse_counts(&args.counts).context("--counts")?,
        count_policy: args.n_policy.into(),
        n_trials: args.trials.unwrap_or(50),
        seed: common.seed,
    };
    Ok((plan, args.dim.unwrap_or(2)))
}

/// Every set of a file, as it is.
fn of_file(path: &str, args: &DiscrepancyArgs, common: &Common) -> Result<(StudyPlan, usize)> {
    let file = PointFile::load(path)?;
    let counts = file.counts();
    let plan = StudyPlan {
        samplers: vec![SamplerChoice { sampler: file, scramble: Scramble::None }],
        counts,
        count_policy: CountPolicy::Error,
        n_trials: args.trials.or(u32::try_from(file.sets().count()).ok()).unwrap_or(u32::MAX),
        seed: common.seed,
    };
    Ok((plan, args.dim.unwrap_or(file.facts().max_dim)))
}

fn measures(names: &[String], dim: usize) -> Result<Vec<Measure>> {
    if names.is_empty() {
        return Ok(vec![if dim == 2 { Measure::Edge } else { Measure::Centred }]);
    }
    let measures: Vec<Measure> = names
        .iter()
        .map(|name| name.trim().parse())
        .collect::<Result<_, _>>()
        .context("--measure")?;
    let twice = measures.iter().enumerate().find(|(i, measure)| measures[..*i].contains(measure));
    ensure!(
        twice.is_none(),
        "--measure {}: the same discrepancy twice; name each once",
        names.join(",")
    );
    Ok(measures)
}

fn rows_as_csv(result: &Discrepancies) -> String {
    let mut text = "sampler,scramble,dim,n_requested,n_used,trials,seed,measure,mean,std_error,\
                    mean_sq,std_error_sq\n"
        .to_owned();
    let optional = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for curve in &result.curves {
        for row in &curve.rows {
            text += &csv_line(&[
                curve.sampler.to_owned(),
                curve.scramble.to_string(),
                result.dim.to_string(),
                row.n.to_string(),
                row.n_used.to_string(),
                row.trials.to_string(),
                result.seed.to_string(),
                curve.measure.name().to_owned(),
                row.mean.to_string(),
                optional(row.std_error),
                optional(row.mean_sq),
                optional(row.std_error_sq),
            ]);
        }
    }
    text
}
