//! One pixel under every family of samplers, beside what its needs predict.

use super::choose::{Kind, features};
use super::combination::Combination;
use super::draw::{Draws, Estimate};
use super::expected::{Expected, Grouping, within_cube};
use super::needs::Needs;
use super::predict::{Bound, Limit, limit};
use crate::error::StudyError;
use crate::fit::{Fit, exponent_of};
use crate::literature::{Check, Curve, Effort, Figure, Finding, Relation, Slope};
use crate::sampler::{CountPolicy, Sampler, Scramble, count_used};
use crate::study::{Row, SamplerChoice, SamplerResult, StudyPlan, study};
use serde::Serialize;

/// The families: full grid, sets padded two by two, points of all dimensions. With each, the
/// axes that share cells, from which its variance follows without trials, where it has such.
pub const FAMILIES: &[(&str, Option<Grouping>)] = &[
    ("random", Some(Grouping::None)),
    ("jittered", Some(Grouping::Together)),
    ("jittered-padded", Some(Grouping::Pairs)),
    ("padded", None),
    ("lhs", Some(Grouping::Axes)),
    ("oa", None),
    ("sobol", None),
];

/// A pixel, what it needs, and how each family converges there.
#[derive(Debug, Clone, Serialize)]
pub struct PixelTable {
    /// The scene.
    pub scene: &'static str,
    /// What its pixels integrate over.
    pub features: &'static str,
    /// Dimensions d.
    pub dim: usize,
    /// What the pixel was chosen for.
    pub kind: Kind,
    /// The pixel.
    pub pixel: [u32; 2],
    /// Repeats M.
    pub trials: u32,
    /// What it needs of its axes.
    pub needs: Needs,
    /// Dimension k of what it jumps across; null without jumps.
    pub discontinuity_dim: Option<usize>,
    /// One row per family.
    pub samplers: Vec<SamplerRow>,
    /// `jittered` with more points than trials can have.
    pub far: Option<Far>,
    /// Variance against N.
    pub figure: Figure,
}

/// One family on one pixel.
#[derive(Debug, Clone, Serialize)]
pub struct SamplerRow {
    /// Sampler's name.
    pub name: &'static str,
    /// Its scramble.
    pub scramble: Scramble,
    /// What was measured at each N.
    pub rows: Vec<Row>,
    /// The weighted fit through it.
    pub fit: Option<Fit>,
    /// What theory says for large N.
    pub limit: Option<Limit>,
    /// What the variances should be, found without trials; empty where only trials tell.
    pub expected: Vec<Expected>,
    /// The exponent that those fit to at these N.
    pub at_these_n: Option<f64>,
    /// Measured against predicted; null where theory says nothing that these N could show.
    pub test: Option<Finding>,
}

/// The exponent of `jittered` beyond the reach of trials.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Far {
    /// Strata along each axis, fewer and more: N is their d-th power.
    pub strata: [u64; 2],
    /// p between the two.
    pub exponent: Estimate,
}

/// Strata along each axis.
const FAR: [u64; 2] = [64, 256];

/// How much is spent on a pixel.
pub(super) struct Size {
    most: u64,
    trials: u32,
    /// Values for the needs.
    pub evaluations: u32,
    /// Differences within strata at each N.
    pairs: u32,
}

impl Size {
    pub fn of(effort: Effort) -> Self {
        match effort {
            Effort::Quick => {
                Self { most: 1 << 12, trials: 64, evaluations: 1 << 18, pairs: 1 << 13 }
            }
            Effort::Full => {
                Self { most: 1 << 14, trials: 100, evaluations: 1 << 20, pairs: 1 << 15 }
            }
        }
    }

    /// N = 16, 64, 256, … as near as the sampler comes, at least three.
    fn counts(&self, sampler: &'static dyn Sampler, dim: usize) -> Result<Vec<u64>, StudyError> {
        let wanted = (2..).map(|m| 1 << (2 * m)).take_while(|n| *n <= self.most);
        let used = |n| count_used(sampler, n, dim, CountPolicy::Snap);
        let mut counts = wanted.map(used).collect::<Result<Vec<_>, _>>()?;
        // One point is stratified by nothing.
        counts.retain(|n| *n > 1);
        counts.dedup();
        while counts.len() < 3 {
            let beyond = counts.last().map_or(1, |n| n + 1);
            counts.extend(sampler.neighbours(beyond, dim).1);
        }
        Ok(counts)
    }
}

pub(super) fn measure(
    combination: &Combination,
    kind: Kind,
    draws: Draws<'_>,
    needs: Needs,
    size: &Size,
) -> Result<PixelTable, StudyError> {
    let Draws { integrand, seed, pixel, control } = draws;
    let dim = needs.dim();
    let mut samplers = Vec::with_capacity(FAMILIES.len());
    for (name, grouping) in FAMILIES {
        let choice = SamplerChoice::named(name)?;
        let counts = size.counts(choice.sampler, dim)?;
        let plan = StudyPlan {
            samplers: vec![choice],
            counts: counts.clone(),
            n_trials: size.trials,
            seed,
            ..StudyPlan::paper()
        };
        let result = study(integrand, pixel, &plan, control)?.samplers.remove(0);
        // Slabs leave little within: a few differences tell.
        let pairs = if *grouping == Some(Grouping::Axes) { size.pairs / 8 } else { size.pairs };
        let expected = |n: &u64| grouping.map(|g| g.expected(draws, &needs, *n, pairs)).transpose();
        let expected: Vec<Expected> =
            counts.iter().filter_map(|n| expected(n).transpose()).collect::<Result<_, _>>()?;
        samplers.push(sampler_row(name, result, limit(name, choice.scramble, &needs), expected));
    }
    let far = far(draws, size.pairs)?;
    let figure = figure(combination, kind, pixel, &needs, &samplers);
    let discontinuity_dim = needs.discontinuity_dim();
    let Combination { scene, features, .. } = *combination;
    let trials = size.trials;
    Ok(PixelTable {
        scene,
        features,
        dim,
        kind,
        pixel,
        trials,
        needs,
        discontinuity_dim,
        samplers,
        far,
        figure,
    })
}

fn sampler_row(
    name: &'static str,
    result: SamplerResult,
    limit: Option<Limit>,
    expected: Vec<Expected>,
) -> SamplerRow {
    let compared = compare(name, &result, &expected);
    let at_these_n = compared.as_ref().map(|(at_these_n, _)| *at_these_n);
    let test = match compared {
        Some((_, finding)) => Some(finding),
        None => limit.and_then(|limit| bounded(name, &result, limit)),
    };
    let SamplerResult { scramble, rows, fit, .. } = result;
    SamplerRow { name, scramble, rows, fit, limit, expected, at_these_n, test }
}

/// The exponent that variances found without trials fit to, and p and every variance against
/// them; none where there are none, or where one that was measured is 0.
pub(super) fn compare(
    name: &str,
    result: &SamplerResult,
    expected: &[Expected],
) -> Option<(f64, Finding)> {
    let (fit, weighted) = (result.fit?, result.weighted_rows());
    let variances: Vec<f64> = expected.iter().map(|e| e.variance).collect();
    let comparable = weighted.len() == variances.len() && variances.iter().all(|v| *v > 0.0);
    let at_these_n = comparable.then(|| exponent_of(&weighted, &variances)).flatten()?;
    let check = |(row, expected): (&Row, &Expected)| {
        let ratio = row.variance_of_mean / expected.variance;
        let unsure = row.var_ln() + (expected.std_error / expected.variance).powi(2);
        Check { at: format!("N = {}", row.n_used), ratio, std_error: unsure.sqrt() }
    };
    let checks = result.rows.iter().zip(expected).map(check).collect();
    let case = format!("{name}, N = {} to {}", fit.n_min, fit.n_max);
    let finding = Finding::new(case, "p", at_these_n).measured(fit.exponent, fit.std_error);
    Some((at_these_n, Finding { checks, ..finding }))
}

/// Where theory gives a floor, the last variance against that; where it gives a bound, p.
fn bounded(name: &str, result: &SamplerResult, limit: Limit) -> Option<Finding> {
    let fit = result.fit?;
    let case = format!("{name}, N = {} to {}", fit.n_min, fit.n_max);
    if let (Some(floor), Some(last)) = (limit.floor, result.rows.last()) {
        let ratio = last.variance_of_mean * last.n_used as f64 / floor;
        let finding = Finding::new(case, "variance · N over its floor, at the largest N", 1.0);
        let std_error = ratio * last.var_ln().sqrt();
        return Some(finding.measured(ratio, std_error).being(Relation::AtLeast));
    }
    (limit.bound == Bound::AtLeast).then(|| {
        let finding = Finding::new(case, "p", limit.exponent);
        finding.measured(fit.exponent, fit.std_error).being(Relation::AtLeast)
    })
}

/// p of `jittered` from differences within strata alone.
fn far(draws: Draws<'_>, pairs: u32) -> Result<Option<Far>, StudyError> {
    let dim = draws.integrand.dim() as f64;
    let within = |strata: u64| within_cube(draws, strata as f64, pairs);
    let [few, many] = [within(FAR[0])?, within(FAR[1])?];
    if few.value <= 0.0 || many.value <= 0.0 {
        return Ok(None);
    }
    let span = dim * (FAR[1] as f64 / FAR[0] as f64).ln();
    let value = 1.0 + (few.value / many.value).ln() / span;
    let noise = |e: Estimate| (e.std_error / e.value).powi(2);
    let std_error = (noise(few) + noise(many)).sqrt() / span;
    Ok(Some(Far { strata: FAR, exponent: Estimate { value, std_error } }))
}

fn figure(
    combination: &Combination,
    kind: Kind,
    [x, y]: [u32; 2],
    needs: &Needs,
    samplers: &[SamplerRow],
) -> Figure {
    let curve = |row: &SamplerRow| {
        let point = |row: &Row| {
            let [lo, hi] = row.ci95();
            [row.n_used as f64, row.variance_of_mean, lo, hi]
        };
        let p = row
            .fit
            .map_or(String::new(), |f| format!(" p = {:.2} ± {:.2}", f.exponent, f.std_error));
        let points = row.rows.iter().filter(|row| row.variance_of_mean > 0.0).map(point);
        Curve { name: format!("{}{p}", row.name), points: points.collect() }
    };
    let jumps = needs.discontinuity_dim().is_some();
    let power = |name: &str| samplers.iter().find(|row| row.name == name)?.limit;
    let factor = needs.variance.value;
    let mut slopes = vec![Slope { name: "N^{-1}", factor, power: -1.0 }];
    if let Some(limit) = power("jittered") {
        let name = law_name(needs.dim(), jumps);
        slopes.push(Slope { name, factor, power: -limit.exponent });
    }
    let [edge, smooth] = combination.figures;
    let axes: Vec<String> = needs.axes.iter().map(|axis| axis.name.clone()).collect();
    let words = match (kind, features(&axes).len()) {
        (Kind::Smooth, _) => "a pixel without edges".to_owned(),
        (Kind::Edge, 1) => "a pixel with an edge".to_owned(),
        (Kind::Edge, all) => format!("a pixel with an edge that needs its {all} features"),
    };
    Figure {
        name: if kind == Kind::Edge { edge } else { smooth },
        title: combination.features,
        caption: format!(
            "{}, pixel {x},{y}: d = {} ({}), {words}. Dashed are the laws of random points and of \
             jittered ones.",
            combination.scene,
            needs.dim(),
            combination.features
        ),
        axes: ["N", "variance of the mean"],
        log_x: true,
        curves: samplers.iter().map(curve).collect(),
        slopes,
    }
}

fn law_name(dim: usize, jumps: bool) -> &'static str {
    const EDGE: [&str; 6] =
        ["N^{-3/2}", "N^{-4/3}", "N^{-5/4}", "N^{-6/5}", "N^{-7/6}", "N^{-8/7}"];
    const SMOOTH: [&str; 6] =
        ["N^{-2}", "N^{-5/3}", "N^{-3/2}", "N^{-7/5}", "N^{-4/3}", "N^{-9/7}"];
    let names = if jumps { EDGE } else { SMOOTH };
    names.get(dim - 2).copied().unwrap_or("")
}
