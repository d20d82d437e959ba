//! The N that one pixel needs, read off its curve.

use crate::study::SamplerResult;
use serde::Serialize;

/// What is known of one pixel's need.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Need {
    /// Read off its curve, within the N that were measured.
    Measured,
    /// Read off its fit, beyond them.
    Extrapolated,
    /// The target asks for more samples than the plan allows; it has the most.
    Capped,
    /// No trial at any N differed from another. It is given one sample; a feature that all the
    /// samples of the measurement missed is not known of.
    Exact,
    /// The smallest N saw nothing vary, larger ones did: a feature smaller than single samples
    /// find. Its N is not taken below the smallest that saw it.
    Rare,
}

/// N of one pixel. Its fit is used where one slope describes the rows, two terms where they do
/// better, and the rows themselves, joined in log space, where neither does.
pub(super) fn need(
    curve: &SamplerResult,
    error: f64,
    most: u64,
    admitted: &dyn Fn(u64) -> u64,
) -> (u64, Need) {
    const LEVEL: f64 = 0.01;
    if curve.exact {
        return (admitted(1), Need::Exact);
    }
    let rows = curve.weighted_rows();
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else {
        return (admitted(1), Need::Exact);
    };
    let wanted = error * error;
    let straight = curve.misfit_p_value.is_none_or(|p| p >= LEVEL);
    let on_curve = |variance_at: &dyn Fn(f64) -> f64| {
        // The curve falls: bisect ln N.
        let (mut lo, mut hi) = (0.0, (most as f64).ln() + 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (lo + hi);
            if variance_at(f64::exp(middle)) > wanted { lo = middle } else { hi = middle }
        }
        if variance_at(1.0) <= wanted { 1.0 } else { hi.exp() }
    };
    let n = match (&curve.fit, &curve.two_terms) {
        (_, Some(two)) => on_curve(&|n| two.variance_at(n)),
        (Some(fit), None) if straight => on_curve(&|n| fit.variance_at(n)),
        (Some(fit), None) => {
            let above = rows.iter().rposition(|row| row.variance > wanted);
            match above {
                None => first.n as f64,
                Some(i) if i + 1 < rows.len() => {
                    let (a, b) = (rows[i], rows[i + 1]);
                    let share = (a.variance / wanted).ln() / (a.variance / b.variance).ln();
                    (a.n as f64).powf(1.0 - share) * (b.n as f64).powf(share)
                }
                Some(_) => {
                    let (n, over) = (last.n as f64, last.variance / wanted);
                    n * over.powf(1.0 / fit.exponent.max(0.5))
                }
            }
        }
        (None, None) => last.n as f64 * (last.variance / wanted).max(1.0),
    };
    let saw_nothing = curve.rows.iter().take_while(|row| row.variance_of_mean == 0.0).count();
    let rare = saw_nothing > 0;
    let n = if rare { n.max(first.n as f64) } else { n };
    if n > most as f64 {
        return (most, Need::Capped);
    }
    let need = match () {
        () if rare => Need::Rare,
        () if n > last.n as f64 => Need::Extrapolated,
        () => Need::Measured,
    };
    (admitted(n.ceil().max(1.0) as u64).min(most), need)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Control, SamplerChoice, StudyPlan, study};

    fn square(n: u64) -> u64 {
        let mut k = 1;
        while k * k < n {
            k += 1;
        }
        k * k
    }

    fn curve_of(name: &str, params: &[(String, f64)]) -> SamplerResult {
        let f = crate::integrand::by_name(name, None, params).unwrap();
        let jittered = SamplerChoice::named("jittered").unwrap();
        let plan = StudyPlan { samplers: vec![jittered], n_trials: 2000, ..StudyPlan::paper() };
        study(&*f, [0, 0], &plan, Control::unwatched()).unwrap().samplers.remove(0)
    }

    /// A ramp's variance is |a|²/(12 N²) exactly, so N for an error is known; M = 2000 knows a
    /// variance to 3 % and the fit better, and N is rounded up to a square.
    #[test]
    fn a_ramp_is_given_what_its_closed_form_asks_for() {
        let ramp = curve_of("ramp", &[]);
        let variance = ramp.rows[0].exact_variance.unwrap();
        for k in [3.5f64, 10.5, 40.5] {
            let error = variance.sqrt() / (k * k);
            let (n, need) = need(&ramp, error, 1 << 20, &square);
            assert_eq!(n, ((k + 0.5) * (k + 0.5)) as u64, "{need:?}");
            assert_eq!(need == Need::Extrapolated, k > 16.0);
        }
        assert_eq!(need(&ramp, 1e-9, 10_000, &square), (10_000, Need::Capped));
    }

    #[test]
    fn exact_and_rare_pixels_are_told_apart() {
        assert_eq!(need(&curve_of("constant", &[]), 0.1, 1 << 20, &square), (1, Need::Exact));
        // 3 in a million of the area: trials of few samples see nothing.
        let speck = curve_of("disk", &[("radius".to_owned(), 0.001)]);
        assert_eq!(speck.rows[0].variance_of_mean, 0.0);
        let (n, kind) = need(&speck, 1.0, 1 << 20, &square);
        assert!(kind == Need::Rare && n > 1, "{n} {kind:?}");
    }
}
