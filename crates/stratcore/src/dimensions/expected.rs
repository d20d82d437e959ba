//! Variances of stratified estimates without trials: from differences of f within strata.
//!
//! One uniform point in each of N cells has the variance (1/N) ½ E (f(X) - f(Y))², X and Y in
//! one random cell: METHOD (10), estimated with as many pairs at N = 10^12 as at N = 16.

use super::draw::{Draws, Estimate, Purpose};
use super::needs::{Groups, Needs, mask, pairs, singles};
use crate::error::StudyError;
use serde::Serialize;

/// Which axes a sampler places in cells together; it joins these sets at random.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grouping {
    /// None, there are no cells: `random`.
    None,
    /// All axes: `jittered`.
    Together,
    /// Two by two: `jittered-padded`.
    Pairs,
    /// Each by itself: `lhs`.
    Axes,
}

/// The variance that N points should have, and how well that is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Expected {
    /// N
    pub n: u64,
    /// Variance of the mean.
    pub variance: f64,
    /// Its standard error, with what random joining leaves open at small N.
    pub std_error: f64,
}

impl Grouping {
    fn groups(self, dim: usize) -> Groups {
        match self {
            Self::None => Vec::new(),
            Self::Together => vec![(0..dim).collect()],
            Self::Pairs => pairs(dim),
            Self::Axes => singles(dim),
        }
    }

    /// The part of the variance that these cells leave as it is.
    fn beyond(self, needs: &Needs) -> Estimate {
        match self {
            Self::None => needs.variance,
            Self::Together => Estimate { value: 0.0, std_error: 0.0 },
            Self::Pairs => needs.beyond_pairs,
            Self::Axes => needs.beyond_axes,
        }
    }

    /// The variance of the mean of N points, N filling the cells: the part beyond the groups
    /// over N, and for each group the differences of its own function within cells.
    ///
    /// Two sets joined at random keep some of the part beyond, at most 1/(N - 1) of it, too
    /// much: half of that is added, and counted as uncertain.
    pub(super) fn expected(
        self,
        draws: Draws<'_>,
        needs: &Needs,
        n: u64,
        pairs: u32,
    ) -> Result<Expected, StudyError> {
        let dim = draws.integrand.dim();
        let beyond = self.beyond(needs);
        let joined = match self {
            Self::Pairs | Self::Axes if n > 1 => beyond.value.max(0.0) / (n - 1) as f64,
            _ => 0.0,
        };
        let mut variance = beyond.value + 0.5 * joined;
        let mut squares = beyond.std_error.powi(2) + joined * joined / 12.0;
        for group in self.groups(dim) {
            let strata = (n as f64).powf(1.0 / group.len() as f64).round();
            let within = within_cells(draws, &group, strata, pairs)?;
            variance += within.value;
            squares += within.std_error.powi(2);
        }
        let n_f = n as f64;
        Ok(Expected { n, variance: variance / n_f, std_error: squares.sqrt() / n_f })
    }
}

/// N times the variance of `jittered` with so many strata along each axis.
pub(super) fn within_cube(
    draws: Draws<'_>,
    strata: f64,
    pairs: u32,
) -> Result<Estimate, StudyError> {
    let all: Vec<usize> = (0..draws.integrand.dim()).collect();
    within_cells(draws, &all, strata, pairs)
}

/// Half the mean square, within cells of so many strata along each of these axes, of the
/// differences of the mean of f over all other axes.
///
/// The square is a product of differences at two independent choices of the other axes, so that
/// their own spread does not enter.
fn within_cells(
    draws: Draws<'_>,
    axes: &[usize],
    strata: f64,
    n: u32,
) -> Result<Estimate, StudyError> {
    let dim = draws.integrand.dim();
    let all = axes.len() == dim;
    let purpose = Purpose::Within { axes: mask(axes), strata: strata as u64 };
    let coordinates = axes.len() + dim + if all { 0 } else { dim };
    let [found] = draws.means(purpose, n, coordinates, |uniform, scratch| {
        let (moved, choices) = uniform.split_at(axes.len());
        scratch.points.clear();
        for rest in choices.chunks_exact(dim) {
            for moves in [false, true] {
                let from = scratch.points.len();
                scratch.points.extend_from_slice(rest);
                for (axis, u) in axes.iter().zip(moved) {
                    // The pair is the same for both choices of the rest.
                    let x = choices[*axis];
                    let y = if moves { ((x * strata).floor() + u) / strata } else { x };
                    scratch.points[from + axis] = y;
                }
            }
        }
        scratch.eval(draws.integrand);
        let differences = scratch.values.chunks_exact(2).map(|pair| pair[1] - pair[0]);
        let product: f64 = match all {
            true => differences.map(|d| d * d).sum(),
            false => differences.product(),
        };
        [0.5 * product]
    })?;
    Ok(found)
}
