//! From words as typed to the objects that a study works with.

use crate::cli::{Common, NPolicy, StudiedChannel, StudyArgs};
use anyhow::{Context, Result, bail, ensure};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;
use stratcore::StudyResult;
use stratcore::counts::parse_counts;
use stratcore::sampler::CountPolicy;
use stratcore::scene::Channel;
use stratcore::study::{SamplerChoice, StudyPlan};

/// The plan of a study of an integrand with `dim` dimensions.
pub fn study_plan(args: &StudyArgs, common: &Common, dim: usize) -> Result<StudyPlan> {
    Ok(StudyPlan {
        samplers: args
            .samplers
            .iter()
            .map(|name| SamplerChoice::named(name.trim()))
            .collect::<Result<_, _>>()
            .context("--samplers")?,
        counts: match &args.counts {
            Some(text) => parse_counts(text).context("--counts")?,
            None => default_counts(dim)?,
        },
        count_policy: match args.n_policy {
            NPolicy::Error => CountPolicy::Error,
            NPolicy::Snap => CountPolicy::Snap,
            NPolicy::Rect => CountPolicy::Rect,
        },
        n_trials: args.trials,
        seed: common.seed,
    })
}

/// The paper's counts in two dimensions (1, 4, …, 256) and in four (1, 16, …, 10,000). In any
/// other number of dimensions above two, N = k^d up to the same 10,000, but two counts at
/// the least: below that there is no slope.
fn default_counts(dim: usize) -> Result<Vec<u64>> {
    const LARGEST: u64 = 10_000;
    const MOST_DIMS: usize = 16;
    ensure!(
        dim <= MOST_DIMS,
        "in {dim} dimensions even two strata per axis are 2^{dim} points; say which N are meant, \
         such as --counts 2^0..2^12 with --samplers random"
    );
    let exponent = dim.max(2) as u32;
    Ok((1..=16u64)
        .map(|k| k.pow(exponent))
        .take_while(|n| *n <= LARGEST || *n == 1 << dim)
        .collect())
}

/// Two values with `separator` between them.
fn pair<T: FromStr>(text: &str, separator: char) -> Option<[T; 2]> {
    let (a, b) = text.split_once(separator)?;
    Some([a.trim().parse().ok()?, b.trim().parse().ok()?])
}

/// `--at X,Y`
pub fn pixel(text: &str) -> Result<[u32; 2]> {
    pair(text, ',').with_context(|| {
        format!("--at {text}: not a pixel; write two whole numbers X,Y, counted from 0,0 at the top-left")
    })
}

/// `--channel`
pub fn channel(word: StudiedChannel) -> Channel {
    match word {
        StudiedChannel::Luminance => Channel::Luminance,
        StudiedChannel::R => Channel::R,
        StudiedChannel::G => Channel::G,
        StudiedChannel::B => Channel::B,
    }
}

/// `--set name=value`
pub fn parameter(text: &str) -> Result<(String, f64)> {
    let Some((name, value)) = text.split_once('=') else {
        bail!("--set {text}: not a parameter; write name=value");
    };
    match value.trim().parse() {
        Ok(value) => Ok((name.trim().to_owned(), value)),
        Err(_) => bail!("--set {text}: the value is not a number; write name=value"),
    }
}

/// `--expect P:TOL`: the exponent a study should find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expectation {
    exponent: f64,
    tolerance: f64,
}

/// What became of an [`Expectation`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The sampler whose exponent was meant.
    pub sampler: &'static str,
    /// The exponent expected.
    pub exponent: f64,
    /// How far it may be off.
    pub tolerance: f64,
    /// The exponent found; none where the variance is zero.
    pub found: Option<f64>,
    /// Whether it was as expected.
    pub holds: bool,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sampler, exponent, tolerance, .. } = self;
        write!(f, "expected p = {exponent} ± {tolerance} under {sampler}, found ")?;
        match self.found {
            Some(p) => write!(f, "p = {p:.4}"),
            None => f.write_str("no exponent"),
        }
    }
}

impl FromStr for Expectation {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let [exponent, tolerance] = pair::<f64>(text, ':').with_context(|| {
            format!("--expect {text}: not an expectation; write P:TOL, such as 1.5:0.1")
        })?;
        ensure!(
            exponent.is_finite() && tolerance.is_finite() && tolerance >= 0.0,
            "--expect {text}: P and TOL must be finite and TOL not negative, such as 1.5:0.1"
        );
        Ok(Self { exponent, tolerance })
    }
}

impl Expectation {
    /// Holds the expectation against `jittered`, or against the last sampler without it.
    pub fn judge(self, result: &StudyResult) -> Option<Verdict> {
        let Self { exponent, tolerance } = self;
        let jittered = result.samplers.iter().find(|s| s.name == "jittered");
        let sampler = jittered.or(result.samplers.last())?;
        let found = sampler.fit.map(|fit| fit.exponent);
        let holds = found.is_some_and(|p| (p - exponent).abs() <= tolerance);
        Some(Verdict { sampler: sampler.name, exponent, tolerance, found, holds })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn default_counts_are_the_papers_and_never_too_many() {
        let counts = |dim| default_counts(dim).unwrap();
        assert_eq!(counts(2), StudyPlan::paper().counts);
        assert_eq!(counts(4), parse_counts("1..10^4").unwrap());
        assert_eq!(counts(1), counts(2));
        assert_eq!(counts(3).last(), Some(&4096));
        assert_eq!(counts(16), [1, 65536]);
        for dim in 3..=16 {
            assert!(counts(dim).len() >= 2 && counts(dim)[2..].iter().all(|n| *n <= 10_000));
        }
        assert!(default_counts(17).unwrap_err().to_string().contains("--counts"));
    }

    #[test]
    fn words_are_read_or_refused_with_the_way_out() {
        assert_eq!(pixel("12, 34").unwrap(), [12, 34]);
        for text in ["", "12", "-1,2", "1,2,3", "a,b", "1.5,2", "4294967296,0"] {
            assert!(pixel(text).unwrap_err().to_string().contains("X,Y"), "{text}");
        }
        assert_eq!(parameter("c=0.5").unwrap(), ("c".to_owned(), 0.5));
        for text in ["", "c", "c=", "c=x"] {
            assert!(parameter(text).unwrap_err().to_string().contains("name=value"), "{text}");
        }
        let expectation: Expectation = "1.5:0.1".parse().unwrap();
        assert_eq!(expectation, Expectation { exponent: 1.5, tolerance: 0.1 });
        for text in ["", "1.5", "1.5:-0.1", "nan:1", "1.5:inf", "1.5±0.1"] {
            let error = text.parse::<Expectation>().unwrap_err().to_string();
            assert!(error.contains("1.5:0.1"), "{text}");
        }
    }
}
