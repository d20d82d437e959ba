//! The study of one pixel or integrand, trial by trial.

use super::{Job, RightOfWay, Wake};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stratcore::dimensions::{MOST_DIMENSIONS, lacks_predictions, needs_of_pixel, predict_from};
use stratcore::integrand::{self, Integrand, Regularity};
use stratcore::scene::Channel;
use stratcore::study::{Control, Row, StudyPlan, StudyResult, Tightness, study_live, study_until};
use stratcore::trace::TracedScene;

/// What is studied.
#[derive(Clone)]
pub enum Subject {
    /// A pixel of a scene.
    Pixel {
        /// The scene.
        traced: Arc<TracedScene>,
        /// The pixel.
        pixel: [u32; 2],
        /// The number.
        channel: Channel,
    },
    /// An integrand of the catalogue.
    Integrand {
        /// Its name.
        name: String,
        /// Its dimension.
        dim: usize,
        /// Its parameters.
        params: Vec<(String, f64)>,
    },
}

/// A result so far.
#[derive(Debug, Clone)]
pub struct StudySoFar {
    /// With the trials so far.
    pub result: StudyResult,
    /// 95 % intervals of its variances, by sampler and row: a frame has no time to compute them.
    pub intervals: Vec<Vec<[f64; 2]>>,
    /// How long it took from the start.
    pub time: Duration,
}

/// A result so far, or what is wrong.
pub type StudyUpdate = Result<StudySoFar, String>;

/// Sends results with ever more trials, or what is wrong with the plan.
pub type StudyJob = Job<StudyUpdate>;

/// Starts a study that ends when the 95 % interval of every exponent is within ± `until`, as
/// `stratcli` takes `--until`, or with the plan's last trial; 0 makes them all. `plan_in` makes
/// the plan for a subject of so many dimensions.
pub fn study_job(
    subject: Subject,
    plan_in: impl Fn(usize) -> Result<StudyPlan, String> + Send + 'static,
    until: f64,
    way: &RightOfWay,
    wake: Wake,
) -> StudyJob {
    let mut urgent = way.take();
    let start = Instant::now();
    Job::spawn("study", wake, move |reporter| {
        let mut each = |result: StudyResult| {
            let rows = result.samplers.iter().map(|sampler| &sampler.rows);
            let intervals = rows.map(|rows| rows.iter().map(Row::ci95).collect()).collect();
            reporter.send(Ok(StudySoFar { result, intervals, time: start.elapsed() }));
            urgent.answered();
        };
        let mut run = |integrand: &dyn Integrand, pixel| {
            let plan = plan_in(integrand.dim())?;
            let control = Control { cancel: reporter.cancel(), ..Control::unwatched() };
            let may_need =
                integrand.regularity() == Regularity::Unknown && integrand.dim() <= MOST_DIMENSIONS;
            let mut needs = None;
            let mut each = |mut result: StudyResult| {
                // The first curve does not wait for what theory says of it.
                if may_need && needs.is_none() && lacks_predictions(&result) {
                    each(result.clone());
                    needs = needs_of_pixel(integrand, pixel, result.seed, control).ok();
                }
                if let Some(needs) = &needs {
                    predict_from(needs, &mut result);
                }
                each(result);
            };
            let ended = if until > 0.0 {
                let until = Tightness::Exponent(until);
                let mut so_far = |result: &StudyResult| each(result.clone());
                study_until(integrand, pixel, &plan, until, control, &mut so_far).map(|_| ())
            } else {
                study_live(integrand, pixel, &plan, control, &mut |result| {
                    each(result);
                    ControlFlow::Continue(())
                })
            };
            ended.map_err(|error| error.to_string())
        };
        let ended = match &subject {
            Subject::Pixel { traced, pixel, channel } => {
                run(&traced.pixel(*pixel, *channel), *pixel)
            }
            Subject::Integrand { name, dim, params } => {
                integrand::by_name(name, Some(*dim), params)
                    .map_err(|error| error.to_string())
                    .and_then(|integrand| run(&*integrand, [0, 0]))
            }
        };
        if let Err(fault) = ended
            && !reporter.is_cancelled()
        {
            reporter.send(Err(fault));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::super::Standing;
    use super::*;
    use std::sync::mpsc;
    use stratcore::integrand::by_name;

    fn run(subject: Subject, until: f64) -> (Vec<StudyUpdate>, Standing) {
        let (sender, rung) = mpsc::channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let plan = StudyPlan { n_trials: 400, ..StudyPlan::paper() };
        let mut job =
            study_job(subject, move |_| Ok(plan.clone()), until, &RightOfWay::default(), wake);
        let mut updates = Vec::new();
        while job.standing() == Standing::Running {
            rung.recv().unwrap();
            updates.extend(job.poll());
        }
        (updates, job.standing())
    }

    fn integrand(name: &str) -> Subject {
        Subject::Integrand { name: name.to_owned(), dim: 2, params: Vec::new() }
    }

    #[test]
    fn it_stops_where_the_command_line_does() {
        let (updates, standing) = run(integrand("disk"), 0.06);
        assert_eq!(standing, Standing::Done);
        let last = updates.last().unwrap().as_ref().unwrap();
        let disk = by_name("disk", Some(2), &[]).unwrap();
        let plan = StudyPlan { n_trials: 400, ..StudyPlan::paper() };
        let until = Tightness::Exponent(0.06);
        let control = Control::unwatched();
        let (batch, stop) =
            study_until(&*disk, [0, 0], &plan, until, control, &mut |_| {}).unwrap();
        assert_eq!(last.result, batch);
        let shown = last.intervals[1][3];
        assert_eq!(shown, batch.samplers[1].rows[3].ci95());
        assert_eq!(stop.reason, stratcore::study::StopReason::Sure);
    }

    #[test]
    fn all_trials_are_made_where_no_width_is_asked_for() {
        for name in ["disk", "constant"] {
            let (updates, _) = run(integrand(name), 0.0);
            assert_eq!(updates.last().unwrap().as_ref().unwrap().result.trials, 400);
        }
    }

    #[test]
    fn a_fault_is_told_in_words() {
        let (updates, standing) = run(integrand("dusk"), 0.1);
        assert_eq!(standing, Standing::Done);
        assert!(updates[0].as_ref().unwrap_err().contains("no integrand is called \"dusk\""));
    }
}
