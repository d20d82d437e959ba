//! The exponent, and where there is one the constant, that theory predicts for a sampler on an
//! integrand of known shape.

use crate::integrand::{Alignment, Integrand, Regularity};
use crate::sampler::Scramble;
use serde::Serialize;

/// What a predicted exponent was derived from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Basis {
    /// What is known of the integrand; for `random`, that it has a variance.
    Integrand,
    /// What a pixel needs of its axes, found from points of their own
    /// ([`dimensions`](crate::dimensions)).
    Axes,
}

/// A law `variance_of_mean ~ C N^-p`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Prediction {
    /// p; logarithms of N are left out.
    pub exponent: f64,
    /// C, where theory gives it for this integrand.
    pub constant: Option<f64>,
    /// Where it is from.
    pub source: &'static str,
}

/// What theory wants to know of an integrand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Subject {
    /// Dimensions d.
    pub dim: usize,
    /// Its smoothness on the cube.
    pub regularity: Regularity,
    /// Its smoothness where opposite faces of the cube are joined.
    pub on_torus: Regularity,
    /// How it lies to the axes.
    pub alignment: Alignment,
    /// Variance of f at one uniform point.
    pub variance: Option<f64>,
    /// ∫|∇f|².
    pub mean_square_gradient: Option<f64>,
}

impl Subject {
    /// What an integrand says of itself.
    pub fn of(integrand: &dyn Integrand) -> Self {
        let dim = integrand.dim();
        Self {
            dim,
            regularity: integrand.regularity(),
            on_torus: integrand.regularity_on_torus(),
            // With one coordinate there is nothing to be oblique to.
            alignment: if dim == 1 { Alignment::Additive } else { integrand.alignment() },
            variance: integrand.exact_variance("random", 1),
            mean_square_gradient: integrand.mean_square_gradient(),
        }
    }
}

/// What theory predicts for a sampler under a scramble; none where it says nothing, and for a
/// constant integrand, which has no exponent.
///
/// Laws for nets hold at N = 2^m, those for strata at the N that fill them.
pub fn predict(sampler: &str, scramble: Scramble, subject: &Subject) -> Option<Prediction> {
    let Subject { dim, on_torus, mean_square_gradient, .. } = *subject;
    if subject.regularity == Regularity::Constant {
        return None;
    }
    let law = |exponent, source| Some(Prediction { exponent, constant: None, source });
    if sampler == "random" {
        let constant = subject.variance;
        return Some(Prediction { exponent: 1.0, constant, source: "central limit theorem" });
    }
    // A torus shift tears strata apart at the faces: they fill the torus.
    let shifted = scramble == Scramble::TorusShift;
    let regularity = if shifted { on_torus } else { subject.regularity };
    let smooth_constant = mean_square_gradient.map(|g| g / 12.0);
    let additive = subject.alignment == Alignment::Additive;
    let d = dim as f64;
    // One point in each of N strata of every axis.
    let along_axes = |source| match regularity {
        Regularity::Smooth => Some(Prediction { exponent: 3.0, constant: smooth_constant, source }),
        Regularity::Discontinuous { .. } => law(2.0, source),
        Regularity::Constant | Regularity::Unknown => None,
    };
    // The same, and one in each of N cells whose rows and columns share their offsets: where f
    // is not periodic, rows move as one.
    let correlated = |source| match (regularity, on_torus) {
        (Regularity::Smooth, Regularity::Discontinuous { .. }) if dim == 2 => law(1.5, source),
        (Regularity::Discontinuous { discontinuity_dim }, _) => {
            law(2.0 - discontinuity_dim / d, source)
        }
        _ => None,
    };
    // One point in each of N cells.
    let in_cells = |source| match regularity {
        Regularity::Smooth => {
            Some(Prediction { exponent: 1.0 + 2.0 / d, constant: smooth_constant, source })
        }
        Regularity::Discontinuous { discontinuity_dim } => {
            law((1.0 + 2.0 / d).min(2.0 - discontinuity_dim / d), source)
        }
        Regularity::Constant | Regularity::Unknown => None,
    };
    let known = regularity != Regularity::Unknown;
    let plain = matches!(scramble, Scramble::None | Scramble::TorusShift);
    let owen = matches!(scramble, Scramble::Owen | Scramble::OwenHash | Scramble::LmsShift)
        || sampler == "pmj02" && scramble == Scramble::None;
    match sampler {
        "jittered" if plain => in_cells("Mitchell 1996, Theoretical analysis"),
        "jittered-padded" if plain && dim <= 2 => in_cells("Mitchell 1996, Theoretical analysis"),
        // Each function of one coordinate meets the plane's cells.
        "jittered-padded" if plain && additive => match regularity {
            Regularity::Smooth => law(2.0, "derived: Mitchell 1996 in each pair"),
            Regularity::Discontinuous { .. } => law(1.5, "derived: Mitchell 1996 in each pair"),
            Regularity::Constant | Regularity::Unknown => None,
        },
        "jittered-padded" if plain && known => law(1.0, "Stein 1987, for pairs of axes"),
        "grid" if shifted && (additive || subject.regularity == Regularity::Smooth) => {
            // On the torus a smooth f that is not periodic has steps along the axes, which all
            // points of a row meet together.
            matches!(on_torus, Regularity::Discontinuous { .. }).then_some(())?;
            law(2.0 / d, "derived: one shift decides for whole rows of the grid")
        }
        "lhs" if plain && additive => along_axes("Stein 1987"),
        "lhs" if plain && known => law(1.0, "Stein 1987; Owen 1997"),
        "cmj" if plain && additive => along_axes("Singh & Jarosz 2017"),
        "cmj" if plain => correlated("derived here; edges: Singh & Jarosz 2017"),
        "oa" if plain && additive => along_axes("Jarosz et al. 2019"),
        "oa" if plain && dim == 2 => correlated("derived here; edges: Jarosz et al. 2019"),
        "oa" if plain && known => law(1.0, "Jarosz et al. 2019"),
        "sobol" | "padded" | "zsobol" | "pmj02" if owen && additive => along_axes("Owen 1997"),
        "padded" | "zsobol" if owen && dim > 2 && known => law(1.0, "Jarosz et al. 2019"),
        "sobol" | "padded" | "zsobol" | "pmj02" if owen => match regularity {
            Regularity::Smooth => law(3.0, "Owen 1997"),
            Regularity::Discontinuous { discontinuity_dim }
                if dim == 2 && discontinuity_dim == 1.0 =>
            {
                law(1.5, "He & Wang 2015")
            }
            _ => None,
        },
        "sobol" | "padded" if scramble == Scramble::XorShift && dim <= 2 => {
            (regularity == Regularity::Smooth).then_some(())?;
            law(2.0, "L'Ecuyer & Lemieux 2002")
        }
        "poisson" | "best-candidate" if shifted => law(1.0, "Pilleboue et al. 2015"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrand::by_name;
    use crate::sampler::SHELF;

    /// Not periodic, if it is smooth.
    fn subject(dim: usize, regularity: Regularity) -> Subject {
        let jumps = Regularity::Discontinuous { discontinuity_dim: dim as f64 - 1.0 };
        Subject {
            dim,
            regularity,
            on_torus: if regularity == Regularity::Smooth { jumps } else { regularity },
            alignment: Alignment::General,
            variance: None,
            mean_square_gradient: None,
        }
    }

    fn exponent(sampler: &str, scramble: Scramble, subject: &Subject) -> Option<f64> {
        predict(sampler, scramble, subject).map(|p| p.exponent)
    }

    const EDGE: Regularity = Regularity::Discontinuous { discontinuity_dim: 1.0 };

    #[test]
    fn the_papers_predictions() {
        let jittered =
            |dim, regularity| exponent("jittered", Scramble::None, &subject(dim, regularity));
        let edge = |dim, k| jittered(dim, Regularity::Discontinuous { discontinuity_dim: k });
        assert_eq!(jittered(2, Regularity::Smooth), Some(2.0));
        assert_eq!(jittered(1, Regularity::Smooth), Some(3.0));
        assert_eq!(jittered(4, Regularity::Smooth), Some(1.5));
        assert_eq!(edge(2, 1.0), Some(1.5));
        assert_eq!(edge(4, 3.0), Some(1.25));
        assert_eq!(edge(2, 4f64.ln() / 3f64.ln()), Some(2.0 - 2f64.ln() / 3f64.ln()));
        let random = subject(7, Regularity::Smooth);
        assert_eq!(exponent("random", Scramble::None, &random), Some(1.0));
    }

    #[test]
    fn alignment_decides_for_samplers_that_know_the_axes() {
        use Scramble::{None, OwenHash, XorShift};
        let (smooth, edge) = (subject(2, Regularity::Smooth), subject(2, EDGE));
        let aligned = |s: Subject| Subject { alignment: Alignment::Additive, ..s };
        for (sampler, scramble, expected) in [
            ("lhs", None, [1.0, 1.0, 3.0, 2.0]),
            ("cmj", None, [1.5, 1.5, 3.0, 2.0]),
            ("oa", None, [1.5, 1.5, 3.0, 2.0]),
            ("pmj02", None, [3.0, 1.5, 3.0, 2.0]),
            ("sobol", OwenHash, [3.0, 1.5, 3.0, 2.0]),
        ] {
            let found = [smooth, edge, aligned(smooth), aligned(edge)]
                .map(|s| exponent(sampler, scramble, &s).unwrap());
            assert_eq!(found, expected, "{sampler}");
        }
        assert_eq!(exponent("sobol", XorShift, &smooth), Some(2.0));
        assert_eq!(exponent("sobol", XorShift, &edge), Option::None);
        assert_eq!(exponent("halton", Scramble::Owen, &smooth), Option::None);
        let four = subject(4, Regularity::Smooth);
        assert_eq!(exponent("padded", OwenHash, &four), Some(1.0));
        assert_eq!(exponent("sobol", OwenHash, &four), Some(3.0));
    }

    #[test]
    fn a_shift_makes_a_smooth_integrand_jump() {
        let ramp = Subject::of(&*by_name("ramp", Some(2), &[]).unwrap());
        let shift = Scramble::TorusShift;
        assert_eq!(exponent("jittered", Scramble::None, &ramp), Some(2.0));
        assert_eq!(exponent("jittered", shift, &ramp), Some(1.5));
        assert_eq!(exponent("grid", shift, &ramp), Some(1.0));
        let whole = [("frequency".to_owned(), 1.0)];
        let periodic = Subject::of(&*by_name("cosines", Some(2), &whole).unwrap());
        assert_eq!(exponent("jittered", shift, &periodic), Some(2.0));
        assert_eq!(exponent("grid", shift, &periodic), None);
    }

    #[test]
    fn constants_are_those_of_the_integrand() {
        for (name, sampler, n) in [("gaussian", "jittered", 250u64.pow(2)), ("disk", "random", 9)] {
            let f = by_name(name, Some(2), &[]).unwrap();
            let law = predict(sampler, Scramble::None, &Subject::of(&*f)).unwrap();
            let predicted = law.constant.unwrap() * (n as f64).powf(-law.exponent);
            let exact = f.exact_variance(sampler, n).unwrap();
            assert!((predicted / exact - 1.0).abs() < 1e-3, "{name}: {predicted} {exact}");
        }
    }

    #[test]
    fn nothing_is_said_of_what_is_not_known() {
        for sampler in SHELF {
            for &scramble in sampler.scrambles() {
                let unknown = predict(sampler.name(), scramble, &subject(2, Regularity::Unknown));
                let any = ["random", "poisson", "best-candidate"].contains(&sampler.name());
                assert!(any || unknown.is_none(), "{} {scramble}", sampler.name());
                let constant = subject(2, Regularity::Constant);
                assert_eq!(predict(sampler.name(), scramble, &constant), None);
            }
        }
    }
}
