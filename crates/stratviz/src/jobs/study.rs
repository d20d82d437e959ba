//! The study of one pixel or integrand, trial by trial.

use super::{Job, RightOfWay, Wake};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};
use stratcore::integrand::{self, Integrand};
use stratcore::scene::Channel;
use stratcore::study::{Control, StudyPlan, StudyResult, study_live};
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

/// A result so far, and how long it took from the start.
pub type StudyUpdate = Result<(StudyResult, Duration), String>;

/// Sends results with ever more trials, or what is wrong with the plan.
pub type StudyJob = Job<StudyUpdate>;

/// Starts a study that ends when the 95 % interval of every exponent is within ± `until`, or
/// with the plan's last trial. `plan_in` makes the plan for a subject of so many dimensions.
pub fn study_job(
    subject: Subject,
    plan_in: impl Fn(usize) -> Result<StudyPlan, String> + Send + 'static,
    until: f64,
    way: &RightOfWay,
    wake: Wake,
) -> StudyJob {
    let urgent = way.take();
    let start = Instant::now();
    Job::spawn("study", wake, move |reporter| {
        let run = |integrand: &dyn Integrand, pixel| {
            let plan = plan_in(integrand.dim())?;
            let control = Control { cancel: reporter.cancel(), ..Control::unwatched() };
            study_live(integrand, pixel, &plan, control, &mut |result| {
                let enough = is_tight(&result, until);
                reporter.send(Ok((result, start.elapsed())));
                if enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            })
            .map_err(|error| error.to_string())
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
        drop(urgent);
        if let Err(fault) = ended
            && !reporter.is_cancelled()
        {
            reporter.send(Err(fault));
        }
    })
}

/// Whether every exponent is known to ± `until`. A curve without an exponent so far is judged
/// after the paper's 50 trials: what is exact then is taken for exact.
pub fn is_tight(result: &StudyResult, until: f64) -> bool {
    const ENOUGH: u32 = 50;
    result.samplers.iter().all(|sampler| match sampler.fit {
        Some(fit) => fit.ci95[1] - fit.ci95[0] <= 2.0 * until,
        None => result.trials >= ENOUGH,
    })
}

#[cfg(test)]
mod tests {
    use super::super::Standing;
    use super::*;
    use std::sync::mpsc;

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
    fn it_stops_at_the_first_block_whose_interval_is_tight() {
        let (updates, standing) = run(integrand("disk"), 0.06);
        assert_eq!(standing, Standing::Done);
        let results: Vec<_> = updates.into_iter().map(|u| u.unwrap().0).collect();
        let (last, before) = results.split_last().unwrap();
        assert!(is_tight(last, 0.06) && last.trials < 400);
        assert!(!before.is_empty() && before.iter().all(|result| !is_tight(result, 0.06)));
    }

    #[test]
    fn a_constant_is_believed_after_fifty_trials() {
        let (updates, _) = run(integrand("constant"), 0.01);
        assert_eq!(updates.last().unwrap().as_ref().unwrap().0.trials, 50);
    }

    #[test]
    fn a_fault_is_told_in_words() {
        let (updates, standing) = run(integrand("dusk"), 0.1);
        assert_eq!(standing, Standing::Done);
        assert!(updates[0].as_ref().unwrap_err().contains("no integrand is called \"dusk\""));
    }
}
