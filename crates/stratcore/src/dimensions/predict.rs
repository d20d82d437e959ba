//! The exponent that each sampler is predicted to have on an integrand whose needs are known.

use super::needs::Needs;
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

/// What theory says of a sampler in its default scramble; none where it says nothing, or where
/// f does not vary.
///
/// Exponents are of f as its needs were found. A part that is lost in their noise is taken as
/// absent.
pub fn limit(sampler: &str, needs: &Needs) -> Option<Limit> {
    if !needs.variance.is_there() {
        return None;
    }
    let d = needs.dim() as f64;
    let equals =
        |exponent, source| Some(Limit { exponent, bound: Bound::Equals, floor: None, source });
    let jumps = needs.jumping_axes();
    let in_cells = |d: f64| if jumps > 0 { 1.0 + 1.0 / d } else { 1.0 + 2.0 / d };
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
        "jittered" => equals(in_cells(d), "Mitchell 1996, Theoretical analysis"),
        "jittered-padded" => unless(
            needs.beyond_pairs,
            "Cook 1986; Stein 1987 for pairs of axes",
            equals(in_cells(d.min(2.0)), "Mitchell 1996, in each pair"),
        ),
        "padded" => unless(
            needs.beyond_pairs,
            "Kollig & Keller 2002; Jarosz et al. 2019",
            nets(jumps.min(2)),
        ),
        "lhs" => unless(needs.beyond_axes, "Stein 1987", None),
        "oa" => unless(needs.beyond_two, "Owen 1992", None),
        "sobol" => nets(jumps),
        _ => None,
    }
}

/// Scrambled nets on f that jumps across a set that depends on so many axes: He and Wang's
/// irregular dimension.
fn nets(jumping_axes: usize) -> Option<Limit> {
    let (exponent, bound, source) = match jumping_axes {
        0 => (3.0, Bound::Equals, "Owen 1997"),
        axes => (1.0 + 1.0 / (2 * axes - 1) as f64, Bound::AtLeast, "He & Wang 2015"),
    };
    Some(Limit { exponent, bound, floor: None, source })
}
