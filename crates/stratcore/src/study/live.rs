//! A study that grows: trials are added to every row by turns, so that all points of all curves
//! tighten together.

use super::{Control, SamplerChoice, StudyPlan, StudyResult, point_set, row, row_means, summarise};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::sampler::PointSet;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Trials of the first block: enough for an interval, few enough to be there at once.
const FIRST: u32 = 10;

/// Later blocks add this share of the trials so far: the work of summing up stays in proportion.
const GROWTH: u32 = 4;

struct GrowingRow {
    choice: SamplerChoice,
    n: u64,
    set: PointSet,
    means: Vec<f64>,
}

/// Studies one integrand in growing blocks of trials, up to `plan.n_trials`, and hands the
/// result so far to `each` until that breaks off. The result after M trials is, bit for bit,
/// what [`study`](super::study) gives for M trials; its `trials` says how many they are.
///
/// `control.clock` is not read: rows of one block run side by side.
///
/// # Errors
/// As [`study`](super::study); `Cancelled` discards the block under way.
pub fn study_live(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    control: Control<'_>,
    each: &mut dyn FnMut(StudyResult) -> ControlFlow<()>,
) -> Result<(), StudyError> {
    let counts_used = plan.counts_used(integrand.dim())?;
    let control = Control { clock: None, ..control };
    let mut rows = Vec::new();
    for (&choice, used) in plan.samplers.iter().zip(&counts_used) {
        for (&n, &n_used) in plan.counts.iter().zip(used) {
            let set = point_set(integrand, pixel, plan, choice, n_used)?;
            rows.push(GrowingRow { choice, n, set, means: Vec::new() });
        }
    }
    let mut done = 0;
    while done < plan.n_trials {
        let block = FIRST.max(done / GROWTH).min(plan.n_trials - done);
        rows.par_iter_mut().try_for_each(|row| {
            row.means.resize((done + block) as usize, 0.0);
            let means = &mut row.means[done as usize..];
            row_means(integrand, row.choice, &row.set, done, means, control).map(|_| ())
        })?;
        done += block;
        if each(result(integrand, pixel, plan, &rows, done)?).is_break() {
            break;
        }
    }
    Ok(())
}

fn result(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    plan: &StudyPlan,
    rows: &[GrowingRow],
    trials: u32,
) -> Result<StudyResult, StudyError> {
    let summed: Vec<_> = rows
        .par_iter()
        .map(|r| row(integrand, r.choice, &r.set, r.n, &r.means))
        .collect::<Result<_, _>>()?;
    let per_sampler = summed.chunks(plan.counts.len()).zip(&plan.samplers);
    Ok(StudyResult {
        pixel,
        dim: integrand.dim(),
        axes: integrand.axes(),
        seed: plan.seed,
        trials,
        reference: integrand.reference(),
        samplers: per_sampler
            .map(|(rows, choice)| summarise(integrand, *choice, rows.to_vec(), trials))
            .collect(),
        complete: true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn the_result_so_far_is_that_of_a_study_of_so_many_trials() {
        let integrand = crate::integrand::by_name("disk", None, &[]).unwrap();
        let named = |name| SamplerChoice::named(name).unwrap();
        let samplers = vec![named("random"), named("jittered"), named("sobol+owen")];
        let plan = StudyPlan { samplers, n_trials: 63, ..StudyPlan::paper() };
        let mut seen = Vec::new();
        study_live(&*integrand, [3, 4], &plan, Control::unwatched(), &mut |so_far| {
            let plan = StudyPlan { n_trials: so_far.trials, ..plan.clone() };
            assert_eq!(so_far, study(&*integrand, [3, 4], &plan, Control::unwatched()).unwrap());
            seen.push(so_far.trials);
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(seen, [10, 20, 30, 40, 50, 62, 63]);
    }

    #[test]
    fn it_ends_when_told_and_when_cancelled() {
        let integrand = crate::integrand::by_name("disk", None, &[]).unwrap();
        let cancel = AtomicBool::new(false);
        let control = Control { cancel: &cancel, ..Control::unwatched() };
        let plan = StudyPlan { n_trials: 1000, ..StudyPlan::paper() };
        let mut blocks = 0;
        let ended = study_live(&*integrand, [0, 0], &plan, control, &mut |_| {
            blocks += 1;
            if blocks == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!((ended, blocks), (Ok(()), 3));
        let ended = study_live(&*integrand, [0, 0], &plan, control, &mut |_| {
            cancel.store(true, Ordering::Relaxed);
            ControlFlow::Continue(())
        });
        assert_eq!(ended, Err(StudyError::Cancelled));
    }
}
