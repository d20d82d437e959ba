//! One row of the table, and the rule that judges it.

use serde::{Serialize, Serializer};

/// What follows from a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// The error is within its limit.
    Pass,
    /// It is not, or is no number.
    Fail,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Pass => "pass",
            Self::Fail => "fail",
        })
    }
}

/// One extreme, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Short name: "mean of 1e30".
    pub name: &'static str,
    /// What was tried.
    pub tried: String,
    /// What the numbers are: "relative error of the mean".
    pub quantity: &'static str,
    /// Of f32: the beam's where a pixel is traced, else plain arithmetic's. None where f32 has
    /// no part; infinity or NaN where it has no number.
    pub f32: Option<f64>,
    /// Of f64: rays' where a pixel is traced, else plain arithmetic's.
    pub f64: Option<f64>,
    /// Of the way that this program goes; what is judged.
    pub error: f64,
    /// The most that `error` may be. It follows from the arithmetic, and the note says how.
    pub limit: f64,
    /// The least that the result's own format allows, where there is such.
    pub floor: Option<f64>,
    /// What happens and why.
    pub note: String,
}

impl Row {
    /// A row without numbers yet: fails.
    pub(super) fn new(name: &'static str, quantity: &'static str, limit: f64) -> Self {
        Self {
            name,
            tried: String::new(),
            quantity,
            f32: None,
            f64: None,
            error: f64::NAN,
            limit,
            floor: None,
            note: String::new(),
        }
    }

    pub(super) fn tried(self, tried: impl Into<String>) -> Self {
        Self { tried: tried.into(), ..self }
    }

    pub(super) fn f32(self, error: f64) -> Self {
        Self { f32: Some(error), ..self }
    }

    pub(super) fn f64(self, error: f64) -> Self {
        Self { f64: Some(error), ..self }
    }

    pub(super) fn error(self, error: f64) -> Self {
        Self { error, ..self }
    }

    pub(super) fn floor(self, floor: f64) -> Self {
        Self { floor: Some(floor), ..self }
    }

    pub(super) fn note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// Pass where the error is within the limit.
    pub fn verdict(&self) -> Verdict {
        if self.error <= self.limit { Verdict::Pass } else { Verdict::Fail }
    }
}

/// With the verdict worked out.
impl Serialize for Row {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Document<'a> {
            name: &'a str,
            tried: &'a str,
            quantity: &'a str,
            f32: Option<f64>,
            f64: Option<f64>,
            error: f64,
            limit: f64,
            floor: Option<f64>,
            verdict: Verdict,
            note: &'a str,
        }
        Document {
            name: self.name,
            tried: &self.tried,
            quantity: self.quantity,
            f32: self.f32,
            f64: self.f64,
            error: self.error,
            limit: self.limit,
            floor: self.floor,
            verdict: self.verdict(),
            note: &self.note,
        }
        .serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_number_within_the_limit_passes() {
        let row = |error| Row::new("", "", 1e-9).error(error).verdict();
        assert_eq!([row(0.0), row(1e-9)], [Verdict::Pass; 2]);
        assert_eq!([row(1.1e-9), row(f64::NAN), row(f64::INFINITY)], [Verdict::Fail; 3]);
        assert_eq!(Row::new("", "", 0.0).verdict(), Verdict::Fail);
    }
}
