//! Point sets by themselves: one of them, the spectra of all, their discrepancies.

use super::{Job, PACE, RightOfWay, Wake};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use stratcli::plan::{PointSpectra, PointsPlan, total_pairs};
use stratcli::report::spectrum::SamplerSpectrum;
use stratcore::discrepancy::Measure;
use stratcore::sampler::Scramble;
use stratcore::study::{Control, DiscrepancyCurve, StudyPlan, discrepancies};

/// Sends what was found, or what is wrong.
pub type PatternJob<T> = Job<Result<T, String>>;

/// One set.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    /// Sampler's name.
    pub name: &'static str,
    /// How the set was scrambled.
    pub scramble: Scramble,
    /// N as asked for.
    pub n: u64,
    /// N as used.
    pub n_used: u64,
    /// Coordinates, point by point.
    pub points: Vec<f64>,
    /// Dimensions of a point.
    pub dim: usize,
    /// The two that are seen: to the right, and upwards.
    pub axes: [usize; 2],
    /// Strata along each dimension, where the points keep to them.
    pub strata: Option<Vec<u64>>,
}

/// The spectrum of one sampler with the trials so far.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumSoFar {
    /// Which of the samplers.
    pub at: usize,
    /// What is known of it.
    pub spectrum: SamplerSpectrum,
}

/// Draws one set.
pub fn draw(
    plan: impl FnOnce() -> Result<PointsPlan, String> + Send + 'static,
    wake: Wake,
) -> PatternJob<Drawn> {
    Job::spawn("points", wake, move |reporter| {
        let drawn = plan().and_then(|plan| {
            let points = plan.draw(plan.trials.start).map_err(|error| error.to_string())?;
            Ok(Drawn {
                name: plan.choice.sampler.name(),
                scramble: plan.choice.scramble,
                n: plan.n,
                n_used: plan.set.key.n_samples,
                points,
                dim: plan.set.dim,
                axes: plan.axes.unwrap_or([0, 1]),
                strata: plan.strata(),
            })
        });
        reporter.send(drawn);
    })
}

/// Transforms the sets of every sampler, one sampler after the other, each with ever more trials.
pub fn spectra(
    plan: impl FnOnce() -> Result<PointSpectra, String> + Send + 'static,
    way: RightOfWay,
    wake: Wake,
) -> PatternJob<SpectrumSoFar> {
    Job::spawn("spectra", wake, move |reporter| {
        let found = plan().and_then(|plan| {
            let (done, total) = (AtomicU64::new(0), plan.total_points());
            let progress = |points| {
                reporter.progress(done.fetch_add(points, Ordering::Relaxed) + points, total);
            };
            let control = Control { cancel: reporter.cancel(), progress: &progress, clock: None };
            for at in 0..plan.len() {
                way.give_first(reporter);
                let mut last = None::<Instant>;
                let mut each = |spectrum| {
                    if last.is_none_or(|last| last.elapsed() >= PACE) {
                        reporter.send(Ok(SpectrumSoFar { at, spectrum }));
                        last = Some(Instant::now());
                    }
                };
                let spectrum =
                    plan.measure(at, control, &mut each).map_err(|error| error.to_string())?;
                reporter.send(Ok(SpectrumSoFar { at, spectrum }));
            }
            Ok(())
        });
        if let Err(fault) = found
            && !reporter.is_cancelled()
        {
            reporter.send(Err(fault));
        }
    })
}

/// What is asked of discrepancies: the sets, their dimensions, what is measured of them.
pub type DiscrepancyPlan = (StudyPlan, usize, Vec<Measure>);

/// Measures the sets of one sampler after the other.
pub fn discrepancy(
    plan: impl FnOnce() -> Result<DiscrepancyPlan, String> + Send + 'static,
    way: RightOfWay,
    wake: Wake,
) -> PatternJob<Vec<DiscrepancyCurve>> {
    Job::spawn("discrepancy", wake, move |reporter| {
        let found = plan().and_then(|(plan, dim, measures)| {
            let (done, total) = (AtomicU64::new(0), total_pairs(&plan));
            let progress = |pairs| {
                reporter.progress(done.fetch_add(pairs, Ordering::Relaxed) + pairs, total);
            };
            let control = Control { cancel: reporter.cancel(), progress: &progress, clock: None };
            for &choice in &plan.samplers {
                way.give_first(reporter);
                let plan = StudyPlan { samplers: vec![choice], ..plan.clone() };
                let found = discrepancies(&plan, dim, &measures, control);
                reporter.send(Ok(found.map_err(|error| error.to_string())?.curves));
            }
            Ok(())
        });
        if let Err(fault) = found
            && !reporter.is_cancelled()
        {
            reporter.send(Err(fault));
        }
    })
}
