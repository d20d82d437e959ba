//! Which sampler, how many samples, how long.

use super::{Quartiles, SamplerTrade, Subject, Target, means_of};
use crate::error::StudyError;
use crate::integrand::Reference;
use crate::sampler::{CountPolicy, Sampler, Scramble};
use crate::study::{Control, StudyPlan};
use rayon::prelude::*;
use serde::Serialize;

/// The ways to one target.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Choice {
    /// The target as asked for.
    pub target: Target,
    /// The same in the unit of the integrand.
    pub error: f64,
    /// What each sampler needs, in the order of the plan.
    pub reach: Vec<Reach>,
    /// The fastest way: an index into `reach`; none where no sampler reaches the target.
    pub best: Option<usize>,
    /// The fastest sampler by the cost of an evaluation, where points are made apart from it
    /// and cost what [`Reach::generation_ns`] says; from a cost of 0 upwards.
    pub by_eval_cost: Vec<Fastest>,
    /// The best way tried with fresh randomness.
    pub confirmation: Option<Confirmation>,
}

/// What one sampler needs for a target: that 95 of 100 runs are off by no more.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reach {
    /// Sampler's name.
    pub name: &'static str,
    /// Its scramble.
    pub scramble: Scramble,
    /// N, interpolated between those that were measured.
    pub n: Option<f64>,
    /// Its 95 % interval, from those of the errors; an end beyond the measured N is missing.
    pub n_ci95: [Option<f64>; 2],
    /// The smallest N of the plan from which on the error's whole interval lies below the
    /// target. Beyond the plan's N the first that was seen to do so.
    pub n_safe: Option<u64>,
    /// `n_safe` was not measured, for it asks for too many samples: it lies on a line through
    /// the last half of the rows.
    pub extrapolated: bool,
    /// Nanoseconds of one estimate of `n_safe` samples.
    pub ns: Option<Quartiles>,
    /// Nanoseconds of making one of its points.
    pub generation_ns: Option<f64>,
}

/// A sampler that is the fastest way from some cost of an evaluation on, up to the next one's:
/// the dearer evaluations are, the fewer samples it needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fastest {
    /// Nanoseconds of one evaluation.
    pub from_ns: f64,
    /// Its index in `reach`.
    pub sampler: usize,
}

/// A choice tried again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Confirmation {
    /// Seed of the fresh runs.
    pub seed: u64,
    /// Runs.
    pub runs: u32,
    /// Share of them whose error was no more than the target.
    pub reached: f64,
}

/// Marks the rows that no other row beats in both time and error.
pub(super) fn mark_pareto(samplers: &mut [SamplerTrade]) {
    let points: Vec<[f64; 2]> = samplers
        .iter()
        .flat_map(|s| s.rows.iter().map(|row| [row.ns_per_estimate.median, row.error.mse]))
        .collect();
    for row in samplers.iter_mut().flat_map(|s| &mut s.rows) {
        let own = [row.ns_per_estimate.median, row.error.mse];
        row.pareto = !points
            .iter()
            .any(|p| p[0] <= own[0] && p[1] <= own[1] && (p[0] < own[0] || p[1] < own[1]));
    }
}

/// What each sampler needs for an error, and the fastest of them.
pub(super) fn choose(
    target: Target,
    error: f64,
    samplers: &[SamplerTrade],
    plan: &StudyPlan,
    dim: usize,
) -> Choice {
    let reach: Vec<_> = samplers
        .iter()
        .zip(&plan.samplers)
        .map(|(curve, choice)| {
            let rectangular = plan.count_policy == CountPolicy::Rect;
            reach(curve, error, &|n| next_admitted(choice.sampler, n, dim, rectangular))
        })
        .collect();
    let (best, by_eval_cost, confirmation) = Default::default();
    let mut choice = Choice { target, error, reach, best, by_eval_cost, confirmation };
    choice.choose_fastest();
    choice
}

impl Choice {
    /// The best of the ways as they stand.
    pub(super) fn choose_fastest(&mut self) {
        let time = |i: &usize| self.reach[*i].ns.map_or(f64::INFINITY, |ns| ns.median);
        let ways = (0..self.reach.len()).filter(|i| time(i).is_finite());
        self.best = ways.min_by(|a, b| time(a).total_cmp(&time(b)));
        self.by_eval_cost = by_eval_cost(&self.reach);
    }
}

impl Reach {
    /// With the times of `n_safe`, which are those of the curve's row at N or of the last before.
    pub(super) fn timed(mut self, curve: &SamplerTrade) -> Self {
        let at = |n: u64| curve.rows.iter().rev().find(|row| row.error.n <= n);
        if let Some((n, row)) = self.n_safe.and_then(|n| Some((n, at(n)?))) {
            let scale = n as f64 / row.error.n as f64;
            self.ns = Some(row.ns_per_estimate.map(|ns| ns * scale));
            self.generation_ns = Some(row.time.generation_ns.median);
        }
        self
    }
}

fn reach(curve: &SamplerTrade, error: f64, admitted: &dyn Fn(u64) -> Option<u64>) -> Reach {
    let points = |end: fn(&super::ErrorRow) -> f64| -> Vec<(u64, f64)> {
        curve.rows.iter().map(|row| (row.error.n, end(&row.error))).collect()
    };
    let n = crossing(&points(|e| e.error95), error);
    // Beyond the rows the line's own uncertainty outweighs theirs: no interval is claimed.
    let within =
        |points: &[(u64, f64)]| first_below(points, error).and_then(|_| crossing(points, error));
    let n_lo = within(&points(|e| e.error95_lo));
    let upper = points(|e| e.error95_hi);
    let n_hi = crossing(&upper, error);
    let (n_safe, extrapolated) = match first_below(&upper, error) {
        Some(i) => (Some(upper[i].0), false),
        None => (n_hi.and_then(|n| admitted(n.ceil() as u64)), true),
    };
    let reach = Reach {
        name: curve.name,
        scramble: curve.scramble,
        n,
        n_ci95: [n_lo, within(&upper)],
        n_safe,
        extrapolated: extrapolated && n_safe.is_some(),
        ns: None,
        generation_ns: None,
    };
    reach.timed(curve)
}

/// The first row from which on all errors are within the target: an edge along the axes has
/// lucky N before.
fn first_below(points: &[(u64, f64)], error: f64) -> Option<usize> {
    let above = points.iter().rposition(|(_, e)| *e > error || e.is_nan());
    let first = above.map_or(0, |i| i + 1);
    (first < points.len()).then_some(first)
}

/// N at which a falling curve of errors passes the target: between rows on a line in log space,
/// beyond them on the line through the last half. None for a curve that does not fall.
fn crossing(points: &[(u64, f64)], error: f64) -> Option<f64> {
    const BEYOND: f64 = (1u64 << 43) as f64;
    let ln = |(n, e): (u64, f64)| ((n as f64).ln(), e.ln());
    let solve = |(x0, y0): (f64, f64), slope: f64| {
        let n = (x0 + (error.ln() - y0) / slope).exp();
        (slope < -0.05 && n <= BEYOND).then_some(n)
    };
    match first_below(points, error) {
        Some(0) => Some(points[0].0 as f64),
        Some(i) => {
            let (before, after) = (ln(points[i - 1]), ln(points[i]));
            if !before.1.is_finite() || !after.1.is_finite() {
                return Some(points[i].0 as f64);
            }
            solve(before, (after.1 - before.1) / (after.0 - before.0))
        }
        None => {
            let last: Vec<_> = points[points.len() / 2..].iter().map(|p| ln(*p)).collect();
            let finite: Vec<_> = last.into_iter().filter(|p| p.1.is_finite()).collect();
            let (x0, x1) = (finite.first()?.0, finite.last()?.0);
            let count = finite.len() as f64;
            let x_mean = finite.iter().map(|p| p.0).sum::<f64>() / count;
            let y_mean = finite.iter().map(|p| p.1).sum::<f64>() / count;
            let sxx: f64 = finite.iter().map(|p| (p.0 - x_mean).powi(2)).sum();
            let sxy: f64 = finite.iter().map(|p| (p.0 - x_mean) * (p.1 - y_mean)).sum();
            (x1 > x0).then(|| solve((x_mean, y_mean), sxy / sxx))?
        }
    }
}

/// The smallest count at or above `n` that the sampler can make.
pub(super) fn next_admitted(
    sampler: &dyn Sampler,
    n: u64,
    dim: usize,
    rectangular: bool,
) -> Option<u64> {
    if sampler.admits(n, dim, rectangular) { Some(n) } else { sampler.neighbours(n, dim).1 }
}

/// The lower envelope of the times N (g + c) over the cost c of an evaluation, g that of
/// generation.
fn by_eval_cost(reach: &[Reach]) -> Vec<Fastest> {
    let ways: Vec<_> = reach
        .iter()
        .enumerate()
        .filter_map(|(i, r)| Some((i, r.n_safe? as f64, r.generation_ns?)))
        .collect();
    let time = |way: &(usize, f64, f64), cost: f64| way.1 * (way.2 + cost);
    let by_n = |a: &&(usize, f64, f64), b: &&(usize, f64, f64)| a.1.total_cmp(&b.1);
    let first = ways.iter().min_by(|a, b| time(a, 0.0).total_cmp(&time(b, 0.0)).then(by_n(a, b)));
    let mut envelope = Vec::new();
    let mut next = first.map(|way| (0.0, way));
    while let Some((from_ns, now)) = next {
        envelope.push(Fastest { from_ns, sampler: now.0 });
        let fewer = ways.iter().filter(|way| way.1 < now.1);
        // Where the two lines cross.
        let crossing =
            |way: &(usize, f64, f64)| (time(way, 0.0) - time(now, 0.0)) / (now.1 - way.1);
        next = fewer
            .map(|way| (crossing(way).max(from_ns), way))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(by_n(&a.1, &b.1)));
    }
    envelope
}

/// Runs the best way with another seed, up to a thousand times, and counts the runs that
/// reached the target.
pub(super) fn confirm(
    choice: &mut Choice,
    subjects: &[Subject<'_>],
    references: &[Reference],
    plan: &StudyPlan,
    control: Control<'_>,
) -> Result<(), StudyError> {
    const MOST_SAMPLES: u64 = 1 << 28;
    const MOST_RUNS: u64 = 1000;
    const FEWEST_RUNS: u64 = 20;
    let Some(best) = choice.best else { return Ok(()) };
    let Some(n) = choice.reach[best].n_safe else { return Ok(()) };
    let runs = MOST_SAMPLES / n.saturating_mul(subjects.len() as u64).max(1);
    let runs = runs.clamp(FEWEST_RUNS, MOST_RUNS);
    let sampler = plan.samplers[best];
    let runs = runs.min(sampler.sampler.most_trials(n, sampler.scramble).into()) as u32;
    let fresh = StudyPlan { seed: plan.seed.wrapping_add(1), n_trials: runs, ..plan.clone() };
    let means: Vec<Vec<f64>> = subjects
        .par_iter()
        .map(|subject| means_of(subject, sampler, &fresh, n, control))
        .collect::<Result<_, _>>()?;
    let reached = (0..runs as usize).filter(|&run| {
        let squares = means.iter().zip(references).map(|(m, r)| (m[run] - r.mean).powi(2));
        (squares.sum::<f64>() / subjects.len() as f64).sqrt() <= choice.error
    });
    let reached = reached.count() as f64 / f64::from(runs);
    choice.confirmation = Some(Confirmation { seed: fresh.seed, runs, reached });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn falling(constant: f64, exponent: f64) -> Vec<(u64, f64)> {
        (1..=16u64).map(|k| (k * k, constant * ((k * k) as f64).powf(-exponent))).collect()
    }

    #[test]
    fn crossings_lie_on_the_curve_within_and_beyond_the_rows() {
        // 2 N^-0.75 = 0.1 at N = 20^(4/3) = 54.3, and 0.001 at 2000^(4/3) = 25198.
        let curve = falling(2.0, 0.75);
        assert!((crossing(&curve, 0.1).unwrap() - 20f64.powf(4.0 / 3.0)).abs() < 1e-9);
        assert!((crossing(&curve, 0.001).unwrap() / 2000f64.powf(4.0 / 3.0) - 1.0).abs() < 1e-9);
        assert_eq!(crossing(&curve, 5.0), Some(1.0));
        assert_eq!(crossing(&[(1, 1.0), (4, 1.0), (9, 1.0)], 0.1), None);
        assert_eq!(first_below(&curve, 0.001), None);
    }

    #[test]
    fn a_lucky_row_is_not_a_promise() {
        let curve = [(1, 1.0), (4, 0.0), (9, 0.5), (16, 0.1), (25, 0.05)];
        assert_eq!(first_below(&curve, 0.2), Some(3));
        assert_eq!(first_below(&curve, 0.01), None);
        assert_eq!(first_below(&[(1, 0.0)], 0.1), Some(0));
    }

    #[test]
    fn dear_evaluations_favour_fewer_samples() {
        let way = |name, n, generation| Reach {
            name,
            scramble: Scramble::None,
            n: None,
            n_ci95: [None; 2],
            n_safe: Some(n),
            extrapolated: false,
            ns: None,
            generation_ns: Some(generation),
        };
        // 100 (2 + c) = 10 (110 + c) at c = 10; the third is never the fastest.
        let ways = [way("cheap", 100, 2.0), way("dear", 10, 110.0), way("middling", 50, 90.0)];
        let found = by_eval_cost(&ways);
        let order: Vec<_> = found.iter().map(|f| (f.sampler, f.from_ns)).collect();
        assert_eq!(order, [(0, 0.0), (1, 10.0)]);
        let found = by_eval_cost(&[way("worse", 100, 2.0), way("better", 10, 2.0)]);
        assert_eq!(found, [Fastest { from_ns: 0.0, sampler: 1 }]);
        assert!(by_eval_cost(&[]).is_empty());
    }
}
