//! Error against N.

use super::mean_square_error;
use crate::fit::Z95;
use crate::integrand::Reference;
use crate::noise::pooled_noise;
use crate::study::{Row, StudyResult};
use crate::variance::Moments;
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The error of estimates of N samples by one sampler.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorRow {
    /// N as used.
    pub n: u64,
    /// Mean square error against the reference, over trials and subjects.
    pub mse: f64,
    /// Its 95 % interval. An upper end without bound says that trials were all alike and off
    /// the reference: they missed what they should have met.
    pub mse_ci95: [f64; 2],
    /// √MSE
    pub rmse: f64,
    /// The error that 95 of 100 single runs stay below: one estimate's deviation, or the RMSE
    /// over a picture's pixels.
    pub error95: f64,
    /// [`error95`](Self::error95) at the upper end of the interval.
    pub error95_hi: f64,
    /// [`error95`](Self::error95) at the lower end.
    pub error95_lo: f64,
    /// How many subjects of equal error would scatter as these do: (Σ MSE)²/Σ MSE².
    pub effective_subjects: f64,
}

/// One curve per sampler. `references` stand in the order of `studies`.
pub(super) fn error_curves(
    studies: &[StudyResult],
    references: &[Reference],
) -> Vec<Vec<ErrorRow>> {
    let Some(first) = studies.first() else { return Vec::new() };
    let curve = |sampler: usize| {
        let rows = 0..first.samplers[sampler].rows.len();
        rows.map(|row| {
            let of = |study: &StudyResult, reference: &Reference| {
                Error::of(&study.samplers[sampler].rows[row], study.trials, reference)
            };
            let errors: Vec<_> = studies.iter().zip(references).map(|(s, r)| of(s, r)).collect();
            together(first.samplers[sampler].rows[row].n_used, &errors)
        })
        .collect()
    };
    (0..first.samplers.len()).map(curve).collect()
}

/// The error at one N alone, from the trial means of each subject.
pub(super) fn error_at(n: u64, means: &[Vec<f64>], references: &[Reference]) -> ErrorRow {
    let of = |(means, reference): (&Vec<f64>, &Reference)| {
        let moments = Moments::of(means);
        let noise = pooled_noise(&[(n, moments)])[0];
        Error::new(&moments, noise.ci95(moments.variance), reference)
    };
    together(n, &means.iter().zip(references).map(of).collect::<Vec<_>>())
}

/// The error of one subject.
struct Error {
    mse: f64,
    ci95: [f64; 2],
}

impl Error {
    fn of(row: &Row, trials: u32, reference: &Reference) -> Self {
        Self::new(&row.moments(trials), row.ci95(), reference)
    }

    /// `ci95` is that of the variance.
    fn new(moments: &Moments, ci95: [f64; 2], reference: &Reference) -> Self {
        let mse = mean_square_error(moments, reference);
        let ci95 = if moments.variance > 0.0 {
            ci95.map(|end| end / moments.variance * mse)
        } else if mse > 0.0 {
            [mse, f64::INFINITY]
        } else {
            [0.0; 2]
        };
        Self { mse, ci95 }
    }
}

/// The mean over subjects. Its interval is that of the one subject, or for many lognormal
/// with the standard error of the mean over them: it holds the trials' noise and, since the
/// subjects are a sample of the picture's pixels, theirs.
fn together(n: u64, errors: &[Error]) -> ErrorRow {
    let count = errors.len() as f64;
    let mse = errors.iter().map(|e| e.mse).sum::<f64>() / count;
    let squares: f64 = errors.iter().map(|e| e.mse * e.mse).sum();
    let effective_subjects = if squares > 0.0 { (mse * count).powi(2) / squares } else { count };
    let mse_ci95 = match errors {
        [one] => one.ci95,
        _ if mse == 0.0 => [0.0; 2],
        _ => {
            let deviations: f64 = errors.iter().map(|e| (e.mse - mse).powi(2)).sum();
            let std_error = (deviations / (count - 1.0) / count).sqrt();
            let factor = (Z95 * std_error / mse).exp();
            [mse / factor, mse * factor]
        }
    };
    let factor = factor95(effective_subjects);
    ErrorRow {
        n,
        mse,
        mse_ci95,
        rmse: mse.sqrt(),
        error95: factor * mse.sqrt(),
        error95_lo: factor * mse_ci95[0].sqrt(),
        error95_hi: factor * mse_ci95[1].sqrt(),
        effective_subjects,
    }
}

/// What 95 of 100 runs stay below, in RMSE: the square root of the 95th percentile of a
/// chi-square over its degrees of freedom, for normal errors. 1.96 for one subject, towards 1
/// for many.
fn factor95(subjects: f64) -> f64 {
    let subjects = subjects.max(1.0);
    ChiSquared::new(subjects).map_or(f64::NAN, |law| (law.inverse_cdf(0.95) / subjects).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_estimate_needs_two_sigma_and_a_picture_hardly_more_than_one() {
        assert!((factor95(1.0) - 1.96).abs() < 1e-3);
        assert!((1.0..1.06).contains(&factor95(1000.0)));
    }

    #[test]
    fn subjects_are_averaged_and_counted() {
        let error = |mse| Error { mse, ci95: [mse, mse] };
        let even = together(4, &[error(1.0), error(1.0), error(1.0), error(1.0)]);
        assert_eq!((even.mse, even.effective_subjects), (1.0, 4.0));
        let uneven = together(4, &[error(4.0), error(0.0), error(0.0), error(0.0)]);
        assert_eq!((uneven.mse, uneven.effective_subjects), (1.0, 1.0));
        assert!(uneven.mse_ci95[1] > 2.0 * even.mse_ci95[1]);
        let none = together(1, &[error(0.0), error(0.0)]);
        assert_eq!((none.error95_hi, none.mse_ci95), (0.0, [0.0; 2]));
    }
}
