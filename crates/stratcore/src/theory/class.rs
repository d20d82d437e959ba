//! The paper's three kinds of pixel.
//!
//! Source: Mitchell 1996, "Theoretical analysis".

use serde::{Deserialize, Serialize};

/// The paper's three kinds of pixel, by what jittered sampling makes of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Class {
    /// Constant: every estimate is exact.
    Exact,
    /// Lipschitz: p = 1 + 2/d.
    Smooth,
    /// Smooth areas delimited by edges of dimension d - 1: p = 1 + 1/d.
    Edge,
    /// Detail finer than the strata: p = 1.
    Complex,
}

impl Class {
    /// The class whose predicted exponent for jittered sampling in `dim` dimensions is nearest.
    pub fn of_exponent(exponent: f64, dim: usize) -> Self {
        let [complex_edge, edge_smooth] = Self::thresholds(dim);
        if exponent < complex_edge {
            Self::Complex
        } else if exponent < edge_smooth {
            Self::Edge
        } else {
            Self::Smooth
        }
    }

    /// Half-way marks between the predicted exponents: complex | edge, edge | smooth.
    pub fn thresholds(dim: usize) -> [f64; 2] {
        let step = 1.0 / dim as f64;
        [1.0 + 0.5 * step, 1.0 + 1.5 * step]
    }

    /// The exponent that jittered sampling in `dim` dimensions is predicted to reach; none for
    /// an exact pixel.
    pub fn predicted_exponent(self, dim: usize) -> Option<f64> {
        let d = dim as f64;
        match self {
            Self::Exact => None,
            Self::Smooth => Some(1.0 + 2.0 / d),
            Self::Edge => Some(1.0 + 1.0 / d),
            Self::Complex => Some(1.0),
        }
    }
}

impl std::fmt::Display for Class {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Smooth => "smooth",
            Self::Edge => "edge",
            Self::Complex => "complex",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_predicted_exponent_is_of_its_class() {
        for class in [Class::Smooth, Class::Edge, Class::Complex] {
            for dim in 1..8 {
                let p = class.predicted_exponent(dim).unwrap();
                assert_eq!(Class::of_exponent(p, dim), class);
            }
        }
    }
}
