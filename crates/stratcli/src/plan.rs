//! From words as typed to the objects that a study works with.

use crate::cli::{Common, NPolicy, StudiedChannel, StudyArgs, TradeArgs};
use anyhow::{Context, Result, bail, ensure};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;
use stratcore::StudyResult;
use stratcore::counts::parse_counts;
use stratcore::sampler::CountPolicy;
use stratcore::scene::Channel;
use stratcore::study::{SamplerChoice, StudyPlan, Tightness};
use stratcore::trade::Target;

/// The plan of a study of an integrand with `dim` dimensions.
pub fn study_plan(args: &StudyArgs, common: &Common, dim: usize) -> Result<StudyPlan> {
    Ok(StudyPlan {
        samplers: samplers(&args.samplers)?,
        counts: counts(args.counts.as_deref(), dim)?,
        count_policy: count_policy(args.n_policy),
        n_trials: if args.until.is_some() { args.max_trials } else { args.trials },
        seed: common.seed,
    })
}

/// The plan by which a trade measures errors.
pub fn trade_study_plan(args: &TradeArgs, common: &Common, dim: usize) -> Result<StudyPlan> {
    Ok(StudyPlan {
        samplers: samplers(&args.samplers)?,
        counts: counts(args.counts.as_deref(), dim)?,
        count_policy: count_policy(args.n_policy),
        n_trials: args.trials,
        seed: common.seed,
    })
}

fn samplers(names: &[String]) -> Result<Vec<SamplerChoice>> {
    let named = |name: &String| SamplerChoice::named(name.trim());
    names.iter().map(named).collect::<Result<_, _>>().context("--samplers")
}

fn counts(text: Option<&str>, dim: usize) -> Result<Vec<u64>> {
    match text {
        Some(text) => parse_counts(text).context("--counts"),
        None => default_counts(dim),
    }
}

fn count_policy(policy: NPolicy) -> CountPolicy {
    match policy {
        NPolicy::Error => CountPolicy::Error,
        NPolicy::Snap => CountPolicy::Snap,
        NPolicy::Rect => CountPolicy::Rect,
    }
}

/// `--until p:W` or `--until var:SHARE`
pub fn until(text: &str) -> Result<Tightness> {
    let (of, width) = text.split_once(':').unwrap_or((text, ""));
    let width = share(width).filter(|w| w.is_finite() && *w > 0.0);
    match (of.trim(), width) {
        ("p", Some(width)) => Ok(Tightness::Exponent(width)),
        ("var", Some(width)) => Ok(Tightness::Variance(width)),
        _ => bail!("--until {text}: not a width; write p:W or var:SHARE, such as p:0.02 or var:5%"),
    }
}

/// A number, or one in percent.
fn share(text: &str) -> Option<f64> {
    match text.trim().strip_suffix('%') {
        Some(percent) => Some(percent.trim().parse::<f64>().ok()? / 100.0),
        None => text.trim().parse().ok(),
    }
}

/// `--targets 1%,0.004`
pub fn targets(texts: &[String]) -> Result<Vec<Target>> {
    let target = |text: &String| match share(text).filter(|e| e.is_finite() && *e > 0.0) {
        Some(share) if text.contains('%') => Ok(Target::Relative(share)),
        Some(error) => Ok(Target::Absolute(error)),
        None => bail!(
            "--targets {text}: not an error; write shares of the mean such as 1%, or errors in \
             the integrand's unit such as 0.004"
        ),
    };
    texts.iter().map(target).collect()
}

/// `--eval-cost 1us`, in nanoseconds
pub fn duration_ns(text: &str) -> Result<f64> {
    let units = [("ns", 1.0), ("us", 1e3), ("µs", 1e3), ("ms", 1e6), ("s", 1e9)];
    let read = units.iter().find_map(|(unit, ns)| {
        let value: f64 = text.trim().strip_suffix(unit)?.trim().parse().ok()?;
        (value.is_finite() && value >= 0.0).then_some(value * ns)
    });
    read.with_context(|| format!("--eval-cost {text}: not a time; write 40ns, 1us, 2ms or 1s"))
}

/// `--region X0,Y0,X1,Y1`, held against the picture's size
pub fn region(text: &str, [width, height]: [u32; 2]) -> Result<[u32; 4]> {
    let numbers: Vec<u32> = text.split(',').filter_map(|word| word.trim().parse().ok()).collect();
    let [x0, y0, x1, y1] = numbers[..] else {
        bail!("--region {text}: not a region; write four whole numbers X0,Y0,X1,Y1");
    };
    ensure!(
        x0 < x1 && x1 <= width && y0 < y1 && y1 <= height,
        "--region {text}: not within the picture, {width} × {height}; X0 < X1 and Y0 < Y1, and \
         X1,Y1 is outside the region"
    );
    Ok([x0, y0, x1, y1])
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

/// `--expect [SAMPLER:]P:TOL`: the exponent a study should find.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    /// None for `jittered`, or the last sampler without it.
    sampler: Option<String>,
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
    /// Its standard error.
    pub std_error: Option<f64>,
    /// Whether it was as expected.
    pub holds: bool,
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { sampler, exponent, tolerance, .. } = self;
        write!(f, "expected p = {exponent} ± {tolerance} under {sampler}, found ")?;
        match self.found.zip(self.std_error) {
            Some((p, error)) => write!(f, "p = {p:.4} ± {error:.4}"),
            None => f.write_str("no exponent"),
        }
    }
}

impl FromStr for Expectation {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts: Vec<_> = text.rsplitn(3, ':').collect();
        let number = |i: usize| parts.get(i)?.trim().parse::<f64>().ok();
        let (Some(tolerance), Some(exponent)) = (number(0), number(1)) else {
            bail!(
                "--expect {text}: not an expectation; write P:TOL or SAMPLER:P:TOL, such as 1.5:0.1 \
                 or random:1:0.1"
            );
        };
        let sampler = parts.get(2).map(|name| name.trim().to_owned());
        ensure!(
            exponent.is_finite() && tolerance.is_finite() && tolerance >= 0.0,
            "--expect {text}: P and TOL must be finite and TOL not negative, such as 1.5:0.1"
        );
        Ok(Self { sampler, exponent, tolerance })
    }
}

impl Expectation {
    /// Refuses a sampler that the study does not have.
    pub fn check(&self, samplers: &[String]) -> Result<()> {
        let Some(name) = &self.sampler else { return Ok(()) };
        ensure!(
            samplers.iter().any(|typed| typed.trim() == name),
            "--expect: {name} is not among the samplers of this study, {}",
            samplers.join(", ")
        );
        Ok(())
    }

    /// Holds the expectation against the sampler it names, else against `jittered`, else
    /// against the last one.
    pub fn judge(&self, samplers: &[String], result: &StudyResult) -> Option<Verdict> {
        let Self { exponent, tolerance, .. } = *self;
        let sampler = match &self.sampler {
            // Results stand in the order of the plan.
            Some(name) => {
                let typed = samplers.iter().position(|typed| typed.trim() == name)?;
                result.samplers.get(typed)?
            }
            None => {
                let jittered = result.samplers.iter().find(|s| s.name == "jittered");
                jittered.or(result.samplers.last())?
            }
        };
        let found = sampler.fit.map(|fit| fit.exponent);
        let std_error = sampler.fit.map(|fit| fit.std_error);
        let holds = found.is_some_and(|p| (p - exponent).abs() <= tolerance);
        Some(Verdict { sampler: sampler.name, exponent, tolerance, found, std_error, holds })
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
        assert_eq!(expectation, Expectation { sampler: None, exponent: 1.5, tolerance: 0.1 });
        let named: Expectation = "file:a.csv:1.5:0.1".parse().unwrap();
        assert_eq!(named.sampler.as_deref(), Some("file:a.csv"));
        for text in ["", "1.5", "1.5:-0.1", "nan:1", "1.5:inf", "1.5±0.1"] {
            let error = text.parse::<Expectation>().unwrap_err().to_string();
            assert!(error.contains("1.5:0.1"), "{text}");
        }
    }
}
