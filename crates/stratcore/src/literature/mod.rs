//! What the literature says of samplers, as rows that are measured: the acceptance table.
//!
//! A [`Claim`] states something with its source; measuring it gives [`Finding`]s, each an
//! expected value beside a measured one with its standard error, judged by one rule
//! ([`Finding::verdict`]). Nothing here is fitted to make a row pass: where theory is a limit
//! and N is finite, the row carries an allowance and says where it is from.

mod bounds;
mod constants;
mod finding;
mod lab;
mod lights;
mod mitchell;
mod nets;
mod noise;
mod patterns;
mod samplers;
mod screen;
mod shapes;

pub use finding::{BOUND, Check, Curve, Figure, Finding, Relation, Slope, Verdict};
pub use lab::Effort;

use crate::error::StudyError;
use crate::integrand::IntegrandError;
use crate::study::Control;
use lab::Lab;
use serde::Serialize;

/// How well a claim is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Standing {
    /// A theorem, or elementary.
    Sure,
    /// Derived for this program.
    Derived,
    /// Seen in an earlier measurement.
    Measured,
    /// Read in a paper's abstract or figure.
    Abstract,
    /// Quoted from memory: to be checked against the paper before it is relied on.
    Recalled,
}

/// One statement of the literature.
pub struct Claim {
    /// Short name of the row, such as `K4`.
    pub id: &'static str,
    /// What is claimed.
    pub statement: &'static str,
    /// Who says so.
    pub source: &'static str,
    /// How well it is known.
    pub standing: Standing,
    measure: fn(&mut Lab<'_>) -> Result<(), LiteratureError>,
}

/// A claim that was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// The claim's id.
    pub id: &'static str,
    /// What is claimed.
    pub statement: &'static str,
    /// Who says so.
    pub source: &'static str,
    /// How well it is known.
    pub standing: Standing,
    /// Rows of the acceptance table, at least one.
    pub findings: Vec<Finding>,
    /// Curves worth seeing.
    pub figures: Vec<Figure>,
}

/// A claim that could not be measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LiteratureError {
    /// No claim has this id.
    #[error("no claim is called \"{id}\"; there are {known}")]
    UnknownClaim {
        /// The id as typed.
        id: String,
        /// Ids that exist.
        known: String,
    },
    /// A study could not be made, or was cancelled.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// An integrand could not be made.
    #[error(transparent)]
    Integrand(#[from] IntegrandError),
}

/// Every claim, in the order of the table.
pub fn claims() -> impl Iterator<Item = &'static Claim> {
    [constants::CLAIMS, mitchell::CLAIMS, patterns::CLAIMS, nets::CLAIMS].into_iter().flatten()
}

/// The claim of this id, in either case of letters.
///
/// # Errors
/// [`LiteratureError::UnknownClaim`] lists the ids that exist.
pub fn by_id(id: &str) -> Result<&'static Claim, LiteratureError> {
    claims().find(|claim| claim.id.eq_ignore_ascii_case(id)).ok_or_else(|| {
        let known = claims().map(|claim| claim.id).collect::<Vec<_>>().join(", ");
        LiteratureError::UnknownClaim { id: id.to_owned(), known }
    })
}

impl Claim {
    /// Measures the claim. The result depends on the seed and the effort alone; other claims
    /// draw other points.
    ///
    /// # Errors
    /// [`StudyError::Cancelled`] within [`LiteratureError::Study`] when cancelled.
    pub fn measure(
        &self,
        seed: u64,
        effort: Effort,
        control: Control<'_>,
    ) -> Result<Measured, LiteratureError> {
        let number = claims().position(|claim| claim.id == self.id).unwrap_or(0);
        let mut lab = Lab::new(number, seed, effort, control);
        (self.measure)(&mut lab)?;
        let (findings, figures) = lab.into_parts();
        let Self { id, statement, source, standing, .. } = *self;
        Ok(Measured { id, statement, source, standing, findings, figures })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn claims_have_names_of_their_own_and_sources() {
        let ids: HashSet<_> = claims().map(|claim| claim.id).collect();
        assert_eq!(ids.len(), claims().count());
        assert!(claims().all(|claim| !claim.statement.is_empty() && !claim.source.is_empty()));
        assert!(by_id("k4").is_ok());
        let error = by_id("K99").err().map(|e| e.to_string()).unwrap_or_default();
        assert!(error.contains("\"K99\"") && error.contains("K1, K2"), "{error}");
    }
}
