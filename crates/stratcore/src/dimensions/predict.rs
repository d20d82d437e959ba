//! The exponent that each sampler is predicted to have on an integrand whose needs are known.

use super::needs::{MOST_DIMENSIONS, Needs};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::sampler::Scramble;
use crate::study::{Control, SamplerChoice, StudyResult};
use crate::theory::Basis;
use serde::Serialize;

/// How an exponent should lie to the predicted one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    /// The limit for large N.
    Equals,
    /// No smaller in the limit.
    AtLeast,
}

/// A predicted exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// p in the limit of large N.
    pub exponent: f64,
    /// How it binds.
    pub bound: Bound,
    /// The variance is at least this over N, where that is why p falls to 1.
    pub floor: Option<f64>,
    /// Where it is from.
    pub source: &'static str,
}

/// Values that one pixel is taken apart by: as many again tell how it behaves along its axes.
const EVALUATIONS: u32 = 1 << 18;

/// What a pixel needs, found in the one way in which predictions are printed: `inspect --at` and
/// `pixel` say the same. It takes half a million values of `integrand`.
///
/// # Errors
/// As [`Needs::of`].
pub fn needs_of_pixel(
    integrand: &dyn Integrand,
    pixel: [u32; 2],
    seed: u64,
    control: Control<'_>,
) -> Result<Needs, StudyError> {
    // It is no part of the work that the caller counts.
    let control = Control { progress: &|_| {}, clock: None, ..control };
    Needs::of(integrand, pixel, seed, EVALUATIONS, control)
}

/// Gives the samplers of a pixel's study the exponents that its needs predict, where theory says
/// nothing without them. The needs are found from points of their own: nothing that was measured
/// enters. Beyond [`MOST_DIMENSIONS`] nothing is predicted.
///
/// # Errors
/// [`StudyError::Cancelled`].
pub fn predict_pixel(
    result: &mut StudyResult,
    integrand: &dyn Integrand,
    control: Control<'_>,
) -> Result<(), StudyError> {
    if lacks_predictions(result) && integrand.dim() <= MOST_DIMENSIONS {
        let needs = needs_of_pixel(integrand, result.pixel, result.seed, control)?;
        predict_from(&needs, result);
    }
    Ok(())
}

/// Whether a sampler that is not exact has no predicted exponent.
pub fn lacks_predictions(result: &StudyResult) -> bool {
    result.samplers.iter().any(|sampler| sampler.predicted.is_none() && !sampler.exact)
}

/// Fills in the exponents that these needs predict, where there are none.
pub fn predict_from(needs: &Needs, result: &mut StudyResult) {
    for sampler in result.samplers.iter_mut().filter(|s| s.predicted.is_none() && !s.exact) {
        if let Some(limit) = limit(sampler.name, sampler.scramble, needs) {
            sampler.predicted = Some(limit.exponent);
            sampler.predicted_bound = Some(limit.bound);
            sampler.predicted_from = Some(Basis::Axes);
            sampler.predicted_source = Some(limit.source);
        }
    }
}

/// What theory says of a sampler in its default scramble; none where it says nothing, where f
/// does not vary, or where noise leaves open whether f jumps and that decides.
///
/// Exponents are of f as its needs were found. A part that is lost in their noise is taken as
/// absent.
pub fn limit(sampler: &str, scramble: Scramble, needs: &Needs) -> Option<Limit> {
    let default = SamplerChoice::named(sampler).ok()?.scramble;
    if scramble != default || !needs.variance.is_there() {
        return None;
    }
    let equals =
        |exponent, source| Some(Limit { exponent, bound: Bound::Equals, floor: None, source });
    let in_cells = |axes: usize, source| {
        let d = axes as f64;
        let (exponent, source) = match needs.discontinuity_dim() {
            _ if needs.has_detail() => (1.0, "Mitchell 1996; detail finer than 1/128 of an axis"),
            Some(_) => (1.0 + 1.0 / d, source),
            None => (1.0 + 2.0 / d, source),
        };
        if needs.is_sure() { equals(exponent, source) } else { None }
    };
    let in_nets = |jumping_axes| {
        let known = needs.is_sure() && !needs.has_detail();
        known.then(|| nets(jumping_axes))
    };
    // What no stratum reaches is as random.
    let unless = |part: super::Estimate, source, otherwise: Option<Limit>| {
        if part.is_there() {
            let floor = Some(part.value);
            return Some(Limit { exponent: 1.0, bound: Bound::Equals, floor, source });
        }
        otherwise
    };
    match sampler {
        "random" => equals(1.0, "central limit theorem"),
        "jittered" => in_cells(needs.dim(), "Mitchell 1996, Theoretical analysis"),
        "jittered-padded" => unless(
            needs.beyond_pairs,
            "Cook 1986; Stein 1987 for pairs of axes",
            in_cells(needs.dim().min(2), "Mitchell 1996, in each pair"),
        ),
        "padded" => unless(
            needs.beyond_pairs,
            "Kollig & Keller 2002; Jarosz et al. 2019",
            in_nets(needs.jumping_axes().min(2)),
        ),
        "lhs" => unless(needs.beyond_axes, "Stein 1987", None),
        "oa" => unless(needs.beyond_two, "Owen 1992", None),
        "sobol" => in_nets(needs.jumping_axes()),
        _ => None,
    }
}

/// Scrambled nets on f that jumps across a set that depends on so many axes: He and Wang's
/// irregular dimension.
fn nets(jumping_axes: usize) -> Limit {
    let (exponent, bound, source) = match jumping_axes {
        0 => (3.0, Bound::Equals, "Owen 1997"),
        axes => (1.0 + 1.0 / (2 * axes - 1) as f64, Bound::AtLeast, "He & Wang 2015"),
    };
    Limit { exponent, bound, floor: None, source }
}
