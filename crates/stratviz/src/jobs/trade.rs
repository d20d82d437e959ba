//! Error against time, in one pixel or over the picture.

use super::{Job, RightOfWay, Wake};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use stratcli::plan::trade_samples;
use stratcore::integrand::Integrand;
use stratcore::scene::Channel;
use stratcore::study::{Control, StudyPlan};
use stratcore::trace::TracedScene;
use stratcore::trade::{Subject, TradePlan, TradeResult, trade};

/// A trade, with the plan of its errors.
#[derive(Clone)]
pub struct Traded {
    /// What was measured: luminance of these pixels.
    pub pixels: Vec<[u32; 2]>,
    /// How errors were measured.
    pub study: StudyPlan,
    /// What was found.
    pub result: TradeResult,
}

/// Sends the trade, or what is wrong with the plan.
pub type TradeJob = Job<Result<Traded, String>>;

/// Measures which sampler reaches an error in the least time, in pixels that `pixels_of` picks.
/// `plan_in` makes the plan for pixels of so many dimensions.
pub fn trade_job(
    traced: &Arc<TracedScene>,
    pixels_of: impl FnOnce(&TracedScene) -> Result<Vec<[u32; 2]>, String> + Send + 'static,
    plan_in: impl FnOnce(usize) -> Result<TradePlan, String> + Send + 'static,
    way: &RightOfWay,
    wake: Wake,
) -> TradeJob {
    let urgent = way.take();
    let traced = traced.clone();
    Job::spawn("trade", wake, move |reporter| {
        let start = Instant::now();
        let measured = pixels_of(&traced).and_then(|pixels| {
            let of_pixel = |&pixel| (pixel, traced.pixel(pixel, Channel::Luminance));
            let integrands: Vec<_> = pixels.iter().map(of_pixel).collect();
            let subjects = integrands.iter().map(|(pixel, integrand)| {
                let integrand: &dyn Integrand = integrand;
                Subject { pixel: *pixel, integrand }
            });
            let subjects: Vec<_> = subjects.collect();
            let dim = subjects.first().map_or(2, |subject| subject.integrand.dim());
            let plan = plan_in(dim)?;
            let total = trade_samples(&plan.study, dim, subjects.len());
            let total = total.map_err(|error| format!("{error:#}"))?;
            let done = AtomicU64::new(0);
            let progress = |samples| {
                reporter.progress(done.fetch_add(samples, Ordering::Relaxed) + samples, total);
            };
            let control = Control { cancel: reporter.cancel(), progress: &progress, clock: None };
            let result = trade(&subjects, &plan, &|| start.elapsed(), control);
            let result = result.map_err(|error| error.to_string())?;
            Ok(Traded { pixels, study: plan.study, result })
        });
        drop(urgent);
        if !reporter.is_cancelled() {
            reporter.send(measured);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::Standing;
    use super::*;
    use std::sync::mpsc;
    use stratcore::trade::Target;

    #[test]
    fn every_sampler_has_its_way_to_the_error() {
        let traced = Arc::new(TracedScene::new(stratcore::scene::load("edges").unwrap()));
        let (sender, rung) = mpsc::channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let study = StudyPlan { counts: vec![1, 4, 16], n_trials: 20, ..StudyPlan::paper() };
        let targets = vec![Target::Absolute(0.1)];
        let plan = TradePlan { study, targets, eval_cost: None };
        let pixels = vec![[216, 24], [100, 150]];
        let asked = pixels.clone();
        let way = RightOfWay::default();
        let mut job = trade_job(&traced, |_| Ok(asked), |_| Ok(plan), &way, wake);
        let mut found = Vec::new();
        while job.standing() == Standing::Running {
            rung.recv().unwrap();
            found.extend(job.poll());
        }
        let trade = found.pop().unwrap().unwrap();
        assert_eq!((trade.pixels, trade.result.subjects), (pixels, 2));
        assert_eq!(trade.result.choices[0].reach.len(), 2);
        assert_eq!(trade.result.choices[0].error, 0.1);
    }
}
