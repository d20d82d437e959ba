//! Stop when sure: trials are added until an interval is as narrow as asked for.

use super::{Control, SamplerResult, StudyPlan, StudyResult, study_live};
use crate::error::StudyError;
use crate::fit::{Fit, Z95};
use crate::integrand::Integrand;
use crate::sampler::Scramble;
use serde::Serialize;
use std::ops::ControlFlow;

/// How narrow the 95 % intervals of every sampler are to become.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "of", content = "half_width")]
pub enum Tightness {
    /// Half the width of the interval of p.
    Exponent(f64),
    /// Half the width of the widest row's interval, as a share of the row's variance.
    Variance(f64),
}

/// Why a study stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StopReason {
    /// Every interval is as narrow as asked for.
    Sure,
    /// The plan's trials were used up.
    MaxTrials,
    /// The caller cancelled.
    Cancelled,
}

/// How a study stopped, beside its result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stop {
    /// What was asked for.
    pub until: Tightness,
    /// Why it stopped.
    pub reason: StopReason,
    /// The widest half-width in the end; none where no sampler has an interval.
    pub half_width: Option<f64>,
    /// What each sampler's fit would have been after the paper's 50 trials; empty where there
    /// were fewer.
    pub after_50_trials: Vec<EarlyFit>,
}

/// A sampler's fit before the study went on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EarlyFit {
    /// Sampler's name.
    pub name: &'static str,
    /// Its scramble.
    pub scramble: Scramble,
    /// The weighted fit; none for an exact integrand.
    pub fit: Option<Fit>,
    /// The half-width that was to become narrow; none where there is no interval.
    pub half_width: Option<f64>,
}

/// Fewer trials never stop a study: the kurtosis that intervals rest on is not known before.
const MIN_TRIALS: u32 = 50;

/// Studies one integrand until its intervals are as narrow as `until` asks, or until
/// `plan.n_trials`. The result is, bit for bit, that of [`study`](super::study) with as many
/// trials as it says.
///
/// Stopping where an interval looks narrow favours trials that happen to look calm. Three
/// things keep the intervals honest: no study stops before 50 trials, it stops only where two
/// looks in a row, a quarter more trials apart, find the intervals narrow enough, and what is looked
/// at is the width of an interval, never where it lies. `tests/coverage.rs` holds the coverage
/// of what comes out.
///
/// When cancelled it returns what the finished blocks of trials say, or `Cancelled` if there is
/// none. `each` is handed every intermediate result.
///
/// # Errors
/// As [`study`](super::study).
pub fn study_until(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    until: Tightness,
    control: Control<'_>,
    each: &mut dyn FnMut(&StudyResult),
) -> Result<(StudyResult, Stop), StudyError> {
    let mut last = None;
    let mut after_50_trials = Vec::new();
    let mut narrow_before = false;
    let mut sure = false;
    let ended = study_live(integrand, pixel, plan, control, &mut |so_far| {
        each(&so_far);
        if so_far.trials == MIN_TRIALS {
            after_50_trials = so_far.samplers.iter().map(|s| EarlyFit::of(s, until)).collect();
        }
        let narrow = so_far.trials >= MIN_TRIALS && until.holds(&so_far);
        sure = narrow && narrow_before;
        narrow_before = narrow;
        last = Some(so_far);
        if sure { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let reason = match ended {
        Ok(()) if sure => StopReason::Sure,
        Ok(()) => StopReason::MaxTrials,
        Err(StudyError::Cancelled) => StopReason::Cancelled,
        Err(error) => return Err(error),
    };
    let result = last.ok_or(StudyError::Cancelled)?;
    let half_width = until.widest(&result);
    Ok((result, Stop { until, reason, half_width, after_50_trials }))
}

impl EarlyFit {
    fn of(sampler: &SamplerResult, until: Tightness) -> Self {
        let SamplerResult { name, scramble, fit, .. } = *sampler;
        Self { name, scramble, fit, half_width: until.half_width(sampler) }
    }
}

impl Tightness {
    /// The widest half-width of a sampler's intervals; none where it has no interval at all.
    fn half_width(self, sampler: &SamplerResult) -> Option<f64> {
        match self {
            Self::Exponent(_) => sampler.fit.map(|fit| Z95 * fit.std_error),
            Self::Variance(_) => {
                let varying = sampler.rows.iter().filter(|row| row.variance_of_mean > 0.0);
                let widths = varying.map(|row| {
                    let [lo, hi] = row.ci95();
                    0.5 * (hi - lo) / row.variance_of_mean
                });
                widths.max_by(f64::total_cmp)
            }
        }
    }

    /// The widest half-width of all samplers.
    fn widest(self, result: &StudyResult) -> Option<f64> {
        let widths = result.samplers.iter().filter_map(|sampler| self.half_width(sampler));
        widths.max_by(f64::total_cmp)
    }

    fn holds(self, result: &StudyResult) -> bool {
        let (Self::Exponent(wanted) | Self::Variance(wanted)) = self;
        self.widest(result).is_none_or(|width| width <= wanted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::by_name;
    use crate::study::study;

    fn plan(n_trials: u32) -> StudyPlan {
        StudyPlan { counts: vec![1, 4, 9, 16, 25, 36], n_trials, ..StudyPlan::paper() }
    }

    fn run(name: &str, n_trials: u32, until: Tightness) -> (StudyResult, Stop) {
        let f = by_name(name, None, &[]).unwrap();
        let control = Control::unwatched();
        study_until(&*f, [0, 0], &plan(n_trials), until, control, &mut |_| {}).unwrap()
    }

    #[test]
    fn it_stops_when_sure_and_equals_a_fixed_study() {
        let (result, stop) = run("gaussian", 100_000, Tightness::Exponent(0.04));
        assert_eq!(stop.reason, StopReason::Sure);
        assert!(stop.half_width.unwrap() <= 0.04 && result.trials > 50 && result.trials < 5000);
        let f = by_name("gaussian", None, &[]).unwrap();
        let fixed = study(&*f, [0, 0], &plan(result.trials), Control::unwatched()).unwrap();
        assert_eq!(result, fixed);
        let at_50 = study(&*f, [0, 0], &plan(50), Control::unwatched()).unwrap();
        let fits: Vec<_> = stop.after_50_trials.iter().map(|early| early.fit).collect();
        assert_eq!(fits, at_50.samplers.iter().map(|s| s.fit).collect::<Vec<_>>());
        for early in &stop.after_50_trials {
            assert_eq!(early.half_width, early.fit.map(|fit| Z95 * fit.std_error));
        }
    }

    #[test]
    fn the_bound_holds_and_the_width_is_told() {
        let (result, stop) = run("gaussian", 60, Tightness::Variance(0.01));
        assert_eq!((result.trials, stop.reason), (60, StopReason::MaxTrials));
        assert!(stop.half_width.unwrap() > 0.2);
    }

    #[test]
    fn an_exact_integrand_is_sure_at_once() {
        let (result, stop) = run("constant", 1000, Tightness::Exponent(0.01));
        assert_eq!((stop.reason, stop.half_width), (StopReason::Sure, None));
        assert!(result.trials < 100);
    }
}
