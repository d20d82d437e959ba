//! `discrepancy`: how badly point sets misjudge areas, against N.

use super::Outcome;
use crate::cli::{Common, DiscrepancyArgs};
use crate::output::{self, AtomicFile};
use crate::plan;
use crate::progress::Progress;
use crate::report::{PlotFile, discrepancy as figure};
use crate::table;
use anyhow::Result;
use serde::Serialize;
use stratcore::sampler::CountPolicy;
use stratcore::study::{Discrepancies, discrepancies};

#[derive(Serialize)]
struct DiscrepancyDocument<'a> {
    n_policy: CountPolicy,
    #[serde(flatten)]
    result: &'a Discrepancies,
}

pub fn run(args: &DiscrepancyArgs, common: &Common) -> Result<Outcome> {
    let (plan, dim, measures) = plan::discrepancy(args, common)?;
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let csv = args.csv.as_deref().map(AtomicFile::create).transpose()?;
    let progress = Progress::new("measuring", plan::total_pairs(&plan), common);
    let result = discrepancies(&plan, dim, &measures, progress.control())?;
    drop(progress);

    if let Some(plot) = plot {
        plot.commit(&figure::chart(&result))?;
    }
    if let Some(csv) = csv {
        csv.commit(figure::csv(&result).as_bytes())?;
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
