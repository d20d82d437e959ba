//! One row of the acceptance table, and the rule that judges it.

use serde::{Serialize, Serializer};
use statrs::distribution::{ContinuousCDF, Normal};

/// Standard errors that a measured number may be away from the expected one: a true row of
/// normal noise is beyond them once in 2,150 times, so that a table of 200 true rows shows a
/// false failure for one seed in ten.
pub const BOUND: f64 = 3.5;

/// How the measured number should lie to the expected one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Relation {
    /// The same.
    Equals,
    /// No larger.
    AtMost,
    /// No smaller.
    AtLeast,
}

/// What follows from a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// As expected, within the noise and the stated allowance.
    Holds,
    /// Not so.
    Fails,
    /// The expectation is quoted from memory, or there is none: no verdict, whatever the
    /// measured value.
    Recalled,
    /// Nothing was measured; the note says why.
    NotMeasured,
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::Fails => "fails",
            Self::Recalled => "recalled",
            Self::NotMeasured => "not measured",
        })
    }
}

/// One comparison among several that a row makes: at one N, one frequency, one angle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Where: "N = 64".
    pub at: String,
    /// Measured over expected.
    pub ratio: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// One row: an expected number beside the measured one.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What was tried: sampler, integrand, range of N.
    pub case: String,
    /// What the numbers are: "p", "variance / exact".
    pub quantity: &'static str,
    /// How measured should lie to expected.
    pub relation: Relation,
    /// What the claim says; none where it gives no number.
    pub expected: Option<f64>,
    /// What was found.
    pub measured: Option<f64>,
    /// Standard error of what was found.
    pub std_error: Option<f64>,
    /// How far the truth at these N may be from `expected`, a limit; 0 for exact claims.
    pub allowance: f64,
    /// Where the allowance is from, or what else there is to say.
    pub note: String,
    /// The expectation is quoted from memory.
    pub recalled: bool,
    /// The comparisons behind the row: all of them have to hold too.
    pub checks: Vec<Check>,
}

impl Finding {
    /// A row that is expected to equal a number.
    pub fn new(case: impl Into<String>, quantity: &'static str, expected: f64) -> Self {
        Self {
            case: case.into(),
            quantity,
            relation: Relation::Equals,
            expected: Some(expected),
            measured: None,
            std_error: None,
            allowance: 0.0,
            note: String::new(),
            recalled: false,
            checks: Vec::new(),
        }
    }

    /// A row that says why there is nothing to show.
    pub fn not_measured(case: impl Into<String>, why: impl Into<String>) -> Self {
        Self { expected: None, note: why.into(), ..Self::new(case, "", 0.0) }
    }

    /// With what was found.
    #[must_use]
    pub fn measured(self, value: f64, std_error: f64) -> Self {
        Self { measured: Some(value), std_error: Some(std_error), ..self }
    }

    /// With a distance that a limit may have at finite N, and its reason.
    #[must_use]
    pub fn allowing(self, allowance: f64, why: impl Into<String>) -> Self {
        Self { allowance, note: why.into(), ..self }
    }

    /// With a remark.
    #[must_use]
    pub fn noting(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    /// With another relation than equality.
    #[must_use]
    pub fn being(self, relation: Relation) -> Self {
        Self { relation, ..self }
    }

    /// Without a verdict: the number is quoted from memory.
    #[must_use]
    pub fn recalled(self) -> Self {
        Self { recalled: true, ..self }
    }

    /// Standard errors between measured and expected beyond the allowance; positive where it
    /// is on the wrong side.
    pub fn z(&self) -> Option<f64> {
        let off = self.measured? - self.expected?;
        let off = match self.relation {
            Relation::Equals => off.abs(),
            Relation::AtMost => off,
            Relation::AtLeast => -off,
        };
        Some(standardised(off - self.allowance, self.std_error?))
    }

    /// Judges the row: measured and expected agree within [`BOUND`] standard errors beyond the
    /// allowance, and each of the checks does so at a bound that keeps the chance of a false
    /// failure among all of them the same.
    pub fn verdict(&self) -> Verdict {
        if self.measured.is_none() {
            return Verdict::NotMeasured;
        }
        let Some(z) = self.z().filter(|_| !self.recalled) else { return Verdict::Recalled };
        let bound = shared_bound(self.checks.len());
        let sound = |check: &Check| {
            let off = match self.relation {
                Relation::Equals => (check.ratio - 1.0).abs(),
                Relation::AtMost => check.ratio - 1.0,
                Relation::AtLeast => 1.0 - check.ratio,
            };
            standardised(off, check.std_error) <= bound
        };
        if z <= BOUND && self.checks.iter().all(sound) { Verdict::Holds } else { Verdict::Fails }
    }
}

/// A number that is 0 without noise is 0; anything else without noise is infinitely far.
fn standardised(off: f64, std_error: f64) -> f64 {
    if off <= 0.0 && std_error == 0.0 { 0.0 } else { off / std_error }
}

/// [`BOUND`] for each of several comparisons, so that together they fail as rarely as one.
fn shared_bound(comparisons: usize) -> f64 {
    let normal = Normal::standard();
    let level = normal.cdf(-BOUND) / comparisons.max(1) as f64;
    -normal.inverse_cdf(level)
}

/// With the verdict worked out.
impl Serialize for Finding {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Document<'a> {
            case: &'a str,
            quantity: &'a str,
            relation: Relation,
            expected: Option<f64>,
            measured: Option<f64>,
            std_error: Option<f64>,
            allowance: f64,
            z: Option<f64>,
            verdict: Verdict,
            note: &'a str,
            checks: &'a [Check],
        }
        Document {
            case: &self.case,
            quantity: self.quantity,
            relation: self.relation,
            expected: self.expected,
            measured: self.measured,
            std_error: self.std_error,
            allowance: self.allowance,
            z: self.z(),
            verdict: self.verdict(),
            note: &self.note,
            checks: &self.checks,
        }
        .serialize(serializer)
    }
}

/// Curves on log axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// Name of its file, without ending.
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// Words below it.
    pub caption: String,
    /// Names of the axes.
    pub axes: [&'static str; 2],
    /// Whether x is on a log axis; y always is.
    pub log_x: bool,
    /// What was measured.
    pub curves: Vec<Curve>,
    /// Laws to compare with.
    pub slopes: Vec<Slope>,
}

/// One series of a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    /// Its name in the legend.
    pub name: String,
    /// x, y and the ends of the 95 % interval of y.
    pub points: Vec<[f64; 4]>,
}

/// A line y = factor · x^power.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Slope {
    /// What is printed beside it.
    pub name: &'static str,
    /// y at x = 1.
    pub factor: f64,
    /// The slope.
    pub power: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_is_noise_beyond_the_allowance() {
        let row = |measured| Finding::new("", "p", 1.5).measured(measured, 0.01);
        assert_eq!(row(1.534).verdict(), Verdict::Holds);
        assert_eq!(row(1.536).verdict(), Verdict::Fails);
        assert_eq!(row(1.464).verdict(), Verdict::Fails);
        assert_eq!(row(1.45).allowing(0.05, "finite N").verdict(), Verdict::Holds);
        assert_eq!(row(1.0).being(Relation::AtMost).verdict(), Verdict::Holds);
        assert_eq!(row(1.0).being(Relation::AtLeast).verdict(), Verdict::Fails);
        assert_eq!(row(9.0).recalled().verdict(), Verdict::Recalled);
        assert_eq!(row(f64::NAN).verdict(), Verdict::Fails);
        assert_eq!(Finding::not_measured("", "no light").verdict(), Verdict::NotMeasured);
    }

    #[test]
    fn a_row_holds_only_where_all_its_checks_do() {
        let check = |ratio| Check { at: String::new(), ratio, std_error: 0.01 };
        let row = |checks| Finding { checks, ..Finding::new("", "ratio", 1.0).measured(1.0, 0.01) };
        // 3.5 standard errors for one check, 4.2 for twenty.
        assert_eq!(row(vec![check(1.036)]).verdict(), Verdict::Fails);
        let mut many = vec![check(1.0); 19];
        many.push(check(1.036));
        assert_eq!(row(many.clone()).verdict(), Verdict::Holds);
        many.push(check(0.95));
        assert_eq!(row(many).verdict(), Verdict::Fails);
    }

    #[test]
    fn numbers_without_noise_are_compared_as_they_are() {
        assert_eq!(Finding::new("", "", 0.0).measured(0.0, 0.0).verdict(), Verdict::Holds);
        assert_eq!(Finding::new("", "", 0.0).measured(1e-9, 0.0).verdict(), Verdict::Fails);
    }
}
