//! The discrepancies by name.

use super::{centred_sq, edge, edge_l2_sq, l2_star_sq, mixture_sq, star, wrap_around_sq};
use crate::error::StudyError;

/// A discrepancy that can be asked for by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measure {
    /// [`edge`]: the largest over all half-planes.
    Edge,
    /// The root of [`edge_l2_sq`]: the mean square over all half-planes.
    EdgeL2,
    /// [`star`]: the largest over all boxes at the origin.
    Star,
    /// The root of [`l2_star_sq`].
    L2Star,
    /// The root of [`centred_sq`].
    Centred,
    /// The root of [`wrap_around_sq`].
    WrapAround,
    /// The root of [`mixture_sq`].
    Mixture,
}

impl Measure {
    /// All there are.
    pub const ALL: [Self; 7] = [
        Self::Edge,
        Self::EdgeL2,
        Self::Star,
        Self::L2Star,
        Self::Centred,
        Self::WrapAround,
        Self::Mixture,
    ];

    /// As typed on the command line and printed in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Edge => "edge",
            Self::EdgeL2 => "edge-l2",
            Self::Star => "star",
            Self::L2Star => "l2-star",
            Self::Centred => "centred",
            Self::WrapAround => "wrap-around",
            Self::Mixture => "mixture",
        }
    }

    /// One line of help.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Edge => "largest error of the area on one side of any straight edge",
            Self::EdgeL2 => "root mean square error of the area beside a straight edge",
            Self::Star => "largest error of the area of any box at the origin",
            Self::L2Star => "root mean square error of the area of a box at the origin",
            Self::Centred => "the same for boxes at the nearest corner, and projections",
            Self::WrapAround => "the same for boxes on the torus",
            Self::Mixture => "a mean of centred and wrap-around",
        }
    }

    /// The one dimension it is defined for; none where it is any.
    pub fn only_dim(self) -> Option<usize> {
        matches!(self, Self::Edge | Self::EdgeL2 | Self::Star).then_some(2)
    }

    /// Whether it is the root of a mean square, rather than a maximum.
    pub fn is_l2(self) -> bool {
        !matches!(self, Self::Edge | Self::Star)
    }

    /// Whether it measures straight edges of any angle, rather than boxes along the axes.
    pub fn is_of_edges(self) -> bool {
        matches!(self, Self::Edge | Self::EdgeL2)
    }

    /// Whether a torus shift of the points leaves it as it was.
    pub fn ignores_shifts(self) -> bool {
        self == Self::WrapAround
    }

    /// The discrepancy of points, row-major `[N, dim]`; NaN for no points or in a dimension
    /// that [`Measure::only_dim`] excludes.
    pub fn of(self, points: &[f64], dim: usize) -> f64 {
        if self.only_dim().is_some_and(|only| only != dim) {
            return f64::NAN;
        }
        // Rounding can leave the square of next to nothing below zero; NaN stays NaN.
        let root = |square: f64| if square < 0.0 { 0.0 } else { square.sqrt() };
        match self {
            Self::Edge => edge(points),
            Self::EdgeL2 => root(edge_l2_sq(points)),
            Self::Star => star(points),
            Self::L2Star => root(l2_star_sq(points, dim)),
            Self::Centred => root(centred_sq(points, dim)),
            Self::WrapAround => root(wrap_around_sq(points, dim)),
            Self::Mixture => root(mixture_sq(points, dim)),
        }
    }

    /// Refuses a dimension that the measure is not defined for.
    ///
    /// # Errors
    /// [`StudyError::MeasureNeedsDim`].
    pub fn check(self, dim: usize) -> Result<(), StudyError> {
        match self.only_dim() {
            Some(needs) if needs != dim => {
                Err(StudyError::MeasureNeedsDim { measure: self.name(), needs, dim })
            }
            _ => Ok(()),
        }
    }
}

impl std::str::FromStr for Measure {
    type Err = StudyError;

    /// # Errors
    /// [`StudyError::UnknownMeasure`] lists the names that exist.
    fn from_str(name: &str) -> Result<Self, StudyError> {
        Self::ALL.into_iter().find(|m| m.name() == name).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            StudyError::UnknownMeasure { name: name.to_owned(), known }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for measure in Measure::ALL {
            assert_eq!(measure.name().parse(), Ok(measure));
        }
        let error = "stars".parse::<Measure>().unwrap_err().to_string();
        assert!(error.contains("\"stars\"") && error.contains("wrap-around"), "{error}");
    }

    #[test]
    fn a_measure_knows_its_dimensions() {
        let points = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        for measure in Measure::ALL {
            let value = measure.of(&points, 3);
            assert_eq!(measure.check(3).is_err(), value.is_nan(), "{measure:?}");
            assert!(measure.check(2).is_ok() && measure.of(&points, 2) > 0.0);
        }
    }
}
