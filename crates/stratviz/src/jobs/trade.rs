//! Error against time, in one pixel.

use super::{Job, RightOfWay, Wake};
use std::sync::Arc;
use std::time::Instant;
use stratcore::integrand::Integrand as _;
use stratcore::scene::Channel;
use stratcore::study::{Control, StudyPlan};
use stratcore::trace::TracedScene;
use stratcore::trade::{Subject, Target, TradePlan, TradeResult, trade};

/// Sends the trade, or what is wrong with the plan.
pub type TradeJob = Job<Result<TradeResult, String>>;

/// Measures which sampler reaches an error of `error` in a pixel in the least time. `plan_in`
/// makes the plan for a pixel of so many dimensions.
pub fn trade_job(
    traced: &Arc<TracedScene>,
    (pixel, channel): ([u32; 2], Channel),
    plan_in: impl Fn(usize) -> Result<StudyPlan, String> + Send + 'static,
    error: f64,
    way: &RightOfWay,
    wake: Wake,
) -> TradeJob {
    let urgent = way.take();
    let traced = traced.clone();
    Job::spawn("trade", wake, move |reporter| {
        let integrand = traced.pixel(pixel, channel);
        let start = Instant::now();
        let measured = plan_in(integrand.dim()).and_then(|study| {
            let plan = TradePlan { study, targets: vec![Target::Absolute(error)], eval_cost: None };
            let subject = Subject { pixel, integrand: &integrand };
            let control = Control { cancel: reporter.cancel(), ..Control::unwatched() };
            trade(&[subject], &plan, &|| start.elapsed(), control).map_err(|e| e.to_string())
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

    #[test]
    fn every_sampler_has_its_way_to_the_error() {
        let traced = Arc::new(TracedScene::new(stratcore::scene::load("edges").unwrap()));
        let (sender, rung) = mpsc::channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let plan = StudyPlan { counts: vec![1, 4, 16], n_trials: 20, ..StudyPlan::paper() };
        let subject = ([216, 24], Channel::Luminance);
        let way = RightOfWay::default();
        let mut job = trade_job(&traced, subject, move |_| Ok(plan.clone()), 0.1, &way, wake);
        let mut found = Vec::new();
        while job.standing() == Standing::Running {
            rung.recv().unwrap();
            found.extend(job.poll());
        }
        let trade = found.pop().unwrap().unwrap();
        assert_eq!(trade.choices[0].reach.len(), 2);
        assert_eq!(trade.choices[0].error, 0.1);
    }
}
