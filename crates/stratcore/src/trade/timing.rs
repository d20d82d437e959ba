//! Time per sample, on one thread, by the caller's clock.

use super::{Subject, point_set};
use crate::error::StudyError;
use crate::sampler::PointSet;
use crate::study::{Control, SamplerChoice, StudyPlan};
use crate::trial::trial_means;
use serde::Serialize;
use std::hint::black_box;
use std::sync::atomic::Ordering;
use std::time::Duration;

/// Median and quartiles of repeated measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quartiles {
    /// A quarter of the measurements lie below.
    pub lower: f64,
    /// Half of them.
    pub median: f64,
    /// Three quarters.
    pub upper: f64,
}

impl Quartiles {
    fn of(values: &mut [f64]) -> Self {
        values.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let i = share * (values.len() - 1) as f64;
            let (low, high) = (i.floor() as usize, i.ceil() as usize);
            values[low] + (values[high] - values[low]) * (i - low as f64)
        };
        Self { lower: at(0.25), median: at(0.5), upper: at(0.75) }
    }

    /// The same function of each.
    #[must_use]
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self { lower: f(self.lower), median: f(self.median), upper: f(self.upper) }
    }
}

/// Nanoseconds per sample of one sampler at one N.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RowTime {
    /// Generation and evaluation as a study runs them.
    pub ns_per_sample: Quartiles,
    /// Making the same points and nothing else.
    pub generation_ns: Quartiles,
    /// The integrand draws its own points as it goes; what generation costs there is part of
    /// `ns_per_sample`, and `generation_ns` is what other integrands would pay.
    pub fused: bool,
}

/// Measurements of each row; the rows are measured by turns, so that what else the machine
/// does meets all of them.
const ROUNDS: usize = 15;

/// A measurement lasts at least this long, and 100 steps of the clock.
const AT_LEAST: Duration = Duration::from_micros(200);

/// Subjects that time is measured on, evenly chosen.
const SUBJECTS: usize = 16;

/// How times were measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Timing {
    /// The smallest step that the clock was seen to make, in nanoseconds.
    pub clock_step: f64,
    /// A row is warmed up until one measurement of it lasts so many nanoseconds, or is of 65,536
    /// trials.
    pub at_least: f64,
    /// Measurements of each row after that.
    pub rounds: usize,
}

/// One thing to be timed.
struct Job {
    choice: SamplerChoice,
    sets: Vec<PointSet>,
    /// Trials of each set in one measurement.
    trials: u32,
    whole: Vec<f64>,
    generation: Vec<f64>,
    fused: bool,
}

type Clock<'a> = &'a (dyn Fn() -> Duration + Sync);

/// Times per sampler and count, and how they were measured.
pub(super) fn measure(
    subjects: &[Subject<'_>],
    plan: &StudyPlan,
    counts: &[Vec<u64>],
    clock: Clock<'_>,
    control: Control<'_>,
) -> Result<(Vec<Vec<RowTime>>, Timing), StudyError> {
    let every = subjects.len().div_ceil(SUBJECTS);
    let subjects: Vec<_> = subjects.iter().step_by(every).copied().collect();
    let step = clock_step(clock);
    let enough = AT_LEAST.max(step * 100);
    let mut jobs: Vec<Vec<Job>> = Vec::new();
    for (&choice, counts) in plan.samplers.iter().zip(counts) {
        let job = |&n: &u64| {
            let sets = subjects
                .iter()
                .map(|subject| point_set(subject, choice, plan, n))
                .collect::<Result<Vec<_>, _>>()?;
            Ok(Job::warm(choice, sets, &subjects, clock, enough, control))
        };
        jobs.push(counts.iter().map(job).collect::<Result<_, StudyError>>()?);
    }
    for _ in 0..ROUNDS {
        for job in jobs.iter_mut().flatten() {
            if control.cancel.load(Ordering::Relaxed) {
                return Err(StudyError::Cancelled);
            }
            job.measure(&subjects, clock, control);
        }
    }
    let times = |mut job: Job| RowTime {
        ns_per_sample: Quartiles::of(&mut job.whole),
        generation_ns: Quartiles::of(&mut job.generation),
        fused: job.fused,
    };
    let per_sampler = |jobs: Vec<Job>| jobs.into_iter().map(times).collect();
    let [clock_step, at_least] = [step, enough].map(|time| time.as_nanos() as f64);
    let timing = Timing { clock_step, at_least, rounds: ROUNDS };
    Ok((jobs.into_iter().map(per_sampler).collect(), timing))
}

/// The smallest difference above zero between readings one after the other.
fn clock_step(clock: Clock<'_>) -> Duration {
    const READINGS: usize = 10_000;
    let mut last = clock();
    let mut smallest = Duration::from_secs(1);
    for _ in 0..READINGS {
        let now = clock();
        if now > last {
            smallest = smallest.min(now - last);
        }
        last = now;
    }
    smallest
}

impl Job {
    /// Runs until a measurement is long enough; caches and lists are then warm.
    fn warm(
        choice: SamplerChoice,
        sets: Vec<PointSet>,
        subjects: &[Subject<'_>],
        clock: Clock<'_>,
        enough: Duration,
        control: Control<'_>,
    ) -> Self {
        const MOST_TRIALS: u32 = 1 << 16;
        let fused = subjects.iter().zip(&sets).all(|(subject, set)| {
            subject.integrand.trial_means(choice.sampler, set, 0, &mut [0.0], control.cancel)
        });
        let (whole, generation) = Default::default();
        let mut job = Self { choice, sets, trials: 1, whole, generation, fused };
        loop {
            let start = clock();
            job.run(subjects, control);
            if clock() - start >= enough || job.trials >= MOST_TRIALS {
                return job;
            }
            job.trials *= 2;
        }
    }

    fn samples(&self) -> f64 {
        let n: u64 = self.sets.iter().map(|set| set.key.n_samples).sum();
        n as f64 * f64::from(self.trials)
    }

    fn run(&self, subjects: &[Subject<'_>], control: Control<'_>) {
        let mut means = vec![0.0; self.trials as usize];
        for (subject, set) in subjects.iter().zip(&self.sets) {
            let sampler = self.choice.sampler;
            trial_means(subject.integrand, sampler, set, 0, &mut means, control.cancel);
            black_box(&mut means);
        }
    }

    fn generate(&self) {
        const BLOCK: u64 = 512;
        let dim = self.sets[0].dim;
        let mut points = vec![0.0; BLOCK as usize * dim];
        for set in &self.sets {
            for trial in 0..self.trials {
                let mut set = *set;
                set.key.trial = trial;
                let source = self.choice.sampler.points(&set);
                let n = set.key.n_samples;
                for first in (0..n).step_by(BLOCK as usize) {
                    let len = BLOCK.min(n - first) as usize;
                    source.fill(first, &mut points[..len * dim]);
                    black_box(&mut points);
                }
            }
        }
    }

    fn measure(&mut self, subjects: &[Subject<'_>], clock: Clock<'_>, control: Control<'_>) {
        let start = clock();
        self.run(subjects, control);
        let between = clock();
        self.generate();
        let end = clock();
        let per_sample = |time: Duration| time.as_nanos() as f64 / self.samples();
        let (whole, generation) = (per_sample(between - start), per_sample(end - between));
        self.whole.push(whole);
        self.generation.push(generation);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::by_name;
    use std::sync::atomic::AtomicU64;

    #[test]
    fn quartiles_are_order_statistics() {
        let found = Quartiles::of(&mut [5.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!(found, Quartiles { lower: 2.0, median: 3.0, upper: 4.0 });
    }

    /// A clock that ticks 50 µs at every reading: each measurement takes one tick, whatever it
    /// did, so the warm-up must go on to 100 ticks, which no measurement reaches, and stops at
    /// its bound.
    #[test]
    fn time_is_the_clocks_and_its_step_is_found() {
        let ticks = AtomicU64::new(0);
        let clock = || Duration::from_micros(50 * ticks.fetch_add(1, Ordering::Relaxed));
        let f = by_name("ramp", None, &[]).unwrap();
        let subjects = [Subject { pixel: [0, 0], integrand: &*f }];
        let plan = StudyPlan { counts: vec![1, 4], ..StudyPlan::paper() };
        let counts = plan.counts_used(2).unwrap();
        let control = Control::unwatched();
        let (times, timing) = measure(&subjects, &plan, &counts, &clock, control).unwrap();
        assert_eq!(timing, Timing { clock_step: 5e4, at_least: 5e6, rounds: 15 });
        let expected = 50_000.0 / 65_536.0 / 4.0;
        assert!((times[1][1].ns_per_sample.median - expected).abs() < 1e-9 * expected);
        assert!(!times[0][0].fused);
    }
}
