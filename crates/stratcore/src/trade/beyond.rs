//! Beyond the plan's N: a promise on a line is measured before it is made.

use super::choice::{Choice, Reach, next_admitted};
use super::error_curve::error_at;
use super::{SamplerTrade, Subject, means_of, measured_reference};
use crate::error::StudyError;
use crate::integrand::Reference;
use crate::sampler::CountPolicy;
use crate::study::{Control, SamplerChoice, StudyPlan};
use rayon::prelude::*;

/// Samples that one look may take; an N that needs more stays on its line.
const MOST_SAMPLES: u64 = 1 << 26;

/// Looks at growing N.
const MOST_LOOKS: usize = 8;

/// Measures the error at each N that lies beyond the plan's, with the plan's trials, and at a
/// larger one until the whole interval lies below the target. The line through noisy rows may
/// be off by a factor of three in N, and no pixel need keep the slope that it had before.
///
/// References whose own error would show at such an N are measured anew.
pub(super) fn secure(
    choice: &mut Choice,
    curves: &[SamplerTrade],
    subjects: &[Subject<'_>],
    references: &mut [Reference],
    plan: &StudyPlan,
    control: Control<'_>,
) -> Result<(), StudyError> {
    let error = choice.error;
    let ways = choice.reach.iter_mut().zip(&plan.samplers).zip(curves);
    for ((reach, &sampler), curve) in ways.filter(|((reach, _), _)| reach.extrapolated) {
        let Some(first) = reach.n_safe else { continue };
        let found = look(first, error, sampler, subjects, references, plan, control)?;
        let Some(n) = found else { continue };
        *reach = Reach { n_safe: Some(n), extrapolated: false, ..reach.clone() }.timed(curve);
    }
    choice.choose_fastest();
    Ok(())
}

/// The first N, from `n` on, whose error is seen to be small enough; none within the bounds.
fn look(
    mut n: u64,
    error: f64,
    sampler: SamplerChoice,
    subjects: &[Subject<'_>],
    references: &mut [Reference],
    plan: &StudyPlan,
    control: Control<'_>,
) -> Result<Option<u64>, StudyError> {
    let rectangular = plan.count_policy == CountPolicy::Rect;
    let Some(dim) = subjects.first().map(|subject| subject.integrand.dim()) else {
        return Ok(None);
    };
    for _ in 0..MOST_LOOKS {
        let samples = n.saturating_mul(plan.n_trials.into()).saturating_mul(subjects.len() as u64);
        let most = sampler.sampler.most_trials(n, sampler.scramble);
        if samples > MOST_SAMPLES || plan.n_trials > most {
            return Ok(None);
        }
        sharpen(subjects, references, error, n, plan, control)?;
        let means: Vec<Vec<f64>> = subjects
            .par_iter()
            .map(|subject| means_of(subject, sampler, plan, n, control))
            .collect::<Result<_, _>>()?;
        let seen = error_at(n, &means, references);
        if seen.error95_hi <= error {
            return Ok(Some(n));
        }
        // The RMS error of an edge falls as N^-3/4.
        let over = (seen.error95_hi / error).clamp(1.05, 4.0).powf(4.0 / 3.0);
        let next = (n as f64 * over).ceil() as u64;
        match next_admitted(sampler.sampler, next.max(n + 1), dim, rectangular) {
            Some(next) => n = next,
            None => return Ok(None),
        }
    }
    Ok(None)
}

/// Measures the references anew, by estimates of four times N, where their errors are more than
/// a thirtieth of the target.
fn sharpen(
    subjects: &[Subject<'_>],
    references: &mut [Reference],
    error: f64,
    n: u64,
    plan: &StudyPlan,
    control: Control<'_>,
) -> Result<(), StudyError> {
    const SHARE: f64 = 1.0 / 30.0;
    let squares: f64 = references.iter().map(|r| r.std_error.powi(2)).sum();
    if (squares / references.len() as f64).sqrt() <= SHARE * error {
        return Ok(());
    }
    let measured = subjects.par_iter().zip(&mut *references).map(|(subject, reference)| {
        if subject.integrand.reference().is_none() {
            *reference = measured_reference(subject, n.saturating_mul(4), plan.seed, control)?;
        }
        Ok(())
    });
    measured.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::by_name;
    use crate::trade::{Target, TradePlan, trade};
    use std::sync::atomic::{AtomicU64, Ordering};
    use std::time::Duration;

    /// A ramp's variance is known at every N: |a|²/(12 N²) under jittered points. M = 50 knows
    /// an error to 10 %, so the whole interval lies below the target at 1.2 times the error's
    /// own N, and seldom before it; the line, from two rows here, may lead well beyond.
    #[test]
    fn an_n_beyond_the_rows_is_measured_and_one_too_far_is_marked() {
        let ramp = by_name("ramp", None, &[]).unwrap();
        let error95 = |n: u64| 1.96 * ramp.exact_variance("jittered", n).unwrap().sqrt();
        let target = error95(1600);
        let plan = TradePlan {
            study: StudyPlan { counts: vec![1, 4, 9, 16], n_trials: 50, ..StudyPlan::paper() },
            targets: vec![Target::Absolute(target)],
            eval_cost: Some(1000.0),
        };
        // Ever longer steps: one trial is enough of a warm-up.
        let readings = AtomicU64::new(0);
        let clock = || Duration::from_nanos(readings.fetch_add(1, Ordering::Relaxed).pow(3));
        let subjects = [Subject { pixel: [0, 0], integrand: &*ramp }];
        let found = trade(&subjects, &plan, &clock, Control::unwatched()).unwrap();
        let [random, jittered] = &found.choices[0].reach[..] else { unreachable!() };
        let n = jittered.n_safe.unwrap();
        assert!(!jittered.extrapolated && (0.2..1.02).contains(&(error95(n) / target)), "{n}");
        // Random points need 1600² samples in each of 50 trials.
        assert!(random.extrapolated && random.n_safe.unwrap() > 1_000_000);
        assert_eq!(found.choices[0].best, Some(1));
    }
}
