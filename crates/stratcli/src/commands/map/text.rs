//! A finished map in words.

use super::finish::Found;
use crate::table::{Align, columns, number};
use std::fmt::Write;
use stratcore::map::{Comparison, Identity, SamplerIdentity, SamplerSummary, Summary};

/// What was written, the shares of the classes, p under each sampler, and samplers compared.
pub fn report(found: &Found) -> String {
    let plan = &found.header.plan;
    let [width, height] = plan.region.size();
    let mut text = format!(
        "{}, {width} × {height} pixels from {},{}\nd = {}, {}, plan {}\n",
        plan.scene,
        plan.region.x0,
        plan.region.y0,
        plan.dim,
        trials(plan, found.summary.as_ref()),
        found.header.hash
    );
    if let Some(summary) = &found.summary {
        text += &numbers(summary);
        if plan.exact {
            let pixels = summary.pixels - summary.missing;
            for (sampler, found) in plan.samplers.iter().zip(&summary.samplers) {
                text += &computed(sampler, found, pixels);
            }
        }
    }
    for file in &found.files {
        let _ = writeln!(text, "{}", file.display()); // cannot fail
    }
    text
}

/// M and the seed, unless everything was computed.
pub fn trials(plan: &Identity, summary: Option<&Summary>) -> String {
    let is_computed = |summary: &Summary| {
        summary.missing == 0 && summary.samplers.iter().all(|s| s.computed == summary.pixels)
    };
    if plan.exact && summary.is_some_and(is_computed) {
        "no random numbers".to_owned()
    } else {
        format!("M = {} trials, seed {}", plan.trials, plan.seed)
    }
}

/// How many pixels an exact map has without trials, and where to ask why others have them.
fn computed(sampler: &SamplerIdentity, found: &SamplerSummary, pixels: u64) -> String {
    let why = match found.first_measured {
        None => String::new(),
        Some(_) if !["random", "jittered"].iter().any(|name| sampler.is_plain(name)) => {
            "; only random and jittered without a scramble are".to_owned()
        }
        Some([x, y]) => format!(
            "; `stratcli pixel` with --at {x},{y} --exact and this map's counts, channel and \
             tracer says why not all"
        ),
    };
    format!(
        "{}: {} of {pixels} pixels computed without trials{why}\n",
        found.sampler, found.computed
    )
}

fn numbers(summary: &Summary) -> String {
    let head = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let mut text = String::new();
    if summary.missing > 0 {
        let _ = writeln!(
            text,
            "{} pixels are missing: some estimate was not finite; look for infinite emission or \
             coordinates in the scene",
            summary.missing
        );
    }
    if !summary.classes.is_empty() {
        let mut rows = vec![head(&["class", "pixels", "share", "of them surely"])];
        rows.extend(summary.classes.iter().map(|c| {
            vec![c.class.to_string(), c.pixels.to_string(), percent(c.share), c.sure.to_string()]
        }));
        text = text + "\n" + &columns(Align::Right, &rows);
    }
    let mut rows =
        vec![head(&["sampler", "fitted", "exact", "no fit", "mean p", "sd", "quartiles of p"])];
    let optional = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.3}"));
    rows.extend(summary.samplers.iter().map(|s| {
        let quartiles =
            s.quartiles.map_or("-".to_owned(), |q| q.map(|x| format!("{x:.2}")).join(" "));
        vec![
            s.sampler.clone(),
            s.fitted.to_string(),
            s.exact.to_string(),
            s.unfitted.to_string(),
            optional(s.mean),
            optional(s.std_deviation),
            quartiles,
        ]
    }));
    text = text + "\n" + &columns(Align::Right, &rows);
    if !summary.comparisons.is_empty() {
        let head = head(&["variance of", "over that of", "class", "N", "pixels", "median ratio"]);
        let rows = std::iter::once(head).chain(summary.comparisons.iter().filter_map(comparison));
        text = text + "\n" + &columns(Align::Right, &rows.collect::<Vec<_>>());
    }
    text
}

/// A comparison at its largest N.
fn comparison(found: &Comparison) -> Option<Vec<String>> {
    let gain = found.gains.last()?;
    let ratio = gain.quartiles.map_or("-".to_owned(), |q| number(q[1], 3));
    Some(vec![
        found.sampler.clone(),
        found.baseline.clone(),
        found.class.map_or("all".to_owned(), |class| class.to_string()),
        gain.n.to_string(),
        gain.pixels.to_string(),
        ratio,
    ])
}
