//! `integrand`: the same study of a function whose mean is known.

use super::{Outcome, measure};
use crate::cli::{Common, IntegrandArgs};
use crate::plan;
use anyhow::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use stratcore::integrand::{self, CATALOGUE};
use stratcore::study::Control;

#[derive(Serialize)]
struct Subject<'a> {
    integrand: &'a str,
    params: BTreeMap<String, f64>,
}

pub fn run(args: &IntegrandArgs, common: &Common) -> Result<Outcome> {
    let mut set: Vec<_> =
        args.set.iter().map(|text| plan::parameter(text)).collect::<Result<_>>()?;
    set.extend(args.occluder.map(|side| ("occluder".to_owned(), side)));
    let integrand = integrand::by_name(&args.name, args.dim, &set)?;

    let defaults = CATALOGUE.iter().filter(|info| info.name == args.name).flat_map(|i| i.params);
    let mut params: BTreeMap<_, _> =
        defaults.map(|param| (param.name.to_owned(), param.default)).collect();
    params.extend(set);
    let shown: Vec<_> = params.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let title = if shown.is_empty() {
        args.name.clone()
    } else {
        format!("{}, {}", args.name, shown.join(", "))
    };
    let subject = Subject { integrand: &args.name, params };
    let by = |plan: &_, until, control: Control<'_>| {
        measure::by_trials(&*integrand, [0, 0], plan, until, control)
    };
    measure::run(subject, &title, integrand.dim(), &by, &args.study, common)
}
