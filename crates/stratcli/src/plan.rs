//! From words as typed to the objects that a study works with.

mod patterns;
mod trade;

pub use patterns::{
    PointSpectra, PointsPlan, discrepancy, is_scene, point_file, point_spectra, points,
    spectrum_samplers, total_pairs,
};
pub use trade::{trade_pixels, trade_plan, trade_samples};

use crate::cli::{Common, NPolicy, ProtocolArgs, StudiedChannel, TracerChoice};
use anyhow::{Context, Result, anyhow, bail, ensure};
use serde::Serialize;
use std::fmt;
use std::str::FromStr;
use stratcore::counts::parse_counts;
use stratcore::sampler::{CountPolicy, Scramble, count_used};
use stratcore::scene::Channel;
use stratcore::study::{SamplerChoice, StudyPlan, Tightness};
use stratcore::trace::Tracer;
use stratcore::trade::Target;
use stratcore::{StudyError, StudyResult};

/// The plan of a study of an integrand with `dim` dimensions.
pub fn study_plan(args: &ProtocolArgs, common: &Common, dim: usize) -> Result<StudyPlan> {
    let samplers = samplers(&args.samplers, None)?;
    let count_policy = args.n_policy.into();
    Ok(StudyPlan {
        counts: counts(args.counts.as_deref(), &samplers, dim, count_policy)?,
        samplers,
        count_policy,
        n_trials: args.trials,
        seed: common.seed,
    })
}

fn counts(
    text: Option<&str>,
    samplers: &[SamplerChoice],
    dim: usize,
    policy: CountPolicy,
) -> Result<Vec<u64>> {
    match text {
        Some(text) => parse_counts(text).context("--counts"),
        None => common_counts(default_counts(dim)?, samplers, dim, policy),
    }
}

impl From<NPolicy> for CountPolicy {
    fn from(policy: NPolicy) -> Self {
        match policy {
            NPolicy::Error => Self::Error,
            NPolicy::Snap => Self::Snap,
            NPolicy::Rect => Self::Rect,
        }
    }
}

/// `--samplers A,B+owen`, and a scramble for those that name none.
pub fn samplers(names: &[String], scramble: Option<&str>) -> Result<Vec<SamplerChoice>> {
    names.iter().map(|name| sampler("--samplers", name, scramble)).collect()
}

/// `--sampler A+owen`, or what the flag is called, and a scramble if it names none.
pub fn sampler(flag: &'static str, name: &str, scramble: Option<&str>) -> Result<SamplerChoice> {
    let scramble = scramble.map(str::parse::<Scramble>).transpose().context("--scramble")?;
    let name = name.trim();
    let named = name.rsplit_once('+').is_some_and(|(_, s)| s.parse::<Scramble>().is_ok());
    let choice = SamplerChoice::named(name).context(flag)?;
    Ok(SamplerChoice { scramble: scramble.filter(|_| !named).unwrap_or(choice.scramble), ..choice })
}

/// A fault of the sampler about `--spp`, which knows no policy.
pub fn about_spp(error: StudyError) -> anyhow::Error {
    match error {
        StudyError::CountNotAdmitted { sampler, n, neighbours, .. } => {
            anyhow!("--spp {n}: {sampler} has no set of {n} points; {neighbours}")
        }
        other => other.into(),
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
        Some(value * ns).filter(|ns| ns.is_finite() && *ns >= 0.0)
    });
    read.with_context(|| format!("--eval-cost {text}: not a time; write 40ns, 1us, 2ms or 1s"))
}

/// The paper's counts in two dimensions (1, 4, …, 256) and in four (1, 16, …, 10,000). In any
/// other number of dimensions above two, N = k^d up to the same 10,000, but two counts at
/// the least: below that there is no slope.
pub fn default_counts(dim: usize) -> Result<Vec<u64>> {
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

/// Those of the default counts that every sampler has: nobody asked for the others.
fn common_counts(
    defaults: Vec<u64>,
    samplers: &[SamplerChoice],
    dim: usize,
    policy: CountPolicy,
) -> Result<Vec<u64>> {
    let has = |choice: &SamplerChoice, n| count_used(choice.sampler, n, dim, policy).is_ok();
    let mut counts = defaults;
    // One that has none at all is refused by its own name.
    let choosy = samplers.iter().filter(|choice| counts.iter().any(|&n| has(choice, n)));
    let choosy: Vec<_> = choosy.collect();
    counts.retain(|&n| choosy.iter().all(|choice| has(choice, n)));
    ensure!(
        counts.len() >= 2,
        "the samplers {} have no two of the default counts in common; say which N are meant with \
         --counts, and --n-policy snap takes the nearest that each has",
        samplers.iter().map(|c| c.sampler.name()).collect::<Vec<_>>().join(", ")
    );
    Ok(counts)
}

/// `--channel`, and its name.
pub fn channel(choice: StudiedChannel) -> (Channel, &'static str) {
    match choice {
        StudiedChannel::Luminance => (Channel::Luminance, "luminance"),
        StudiedChannel::R => (Channel::R, "r"),
        StudiedChannel::G => (Channel::G, "g"),
        StudiedChannel::B => (Channel::B, "b"),
    }
}

/// `--tracer`
pub fn tracer(choice: TracerChoice) -> Tracer {
    match choice {
        TracerChoice::Beam => Tracer::Beam,
        TracerChoice::Bvh => Tracer::Bvh,
    }
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

/// `--axes I,J`: two different dimensions of `dim`.
pub fn axes(text: &str, dim: usize) -> Result<[usize; 2]> {
    let axes = pair::<usize>(text, ',').filter(|[i, j]| i != j && *i < dim && *j < dim);
    axes.with_context(|| {
        format!(
            "--axes {text}: not two different dimensions of points in {dim}; write I,J, each from \
             0 to {}",
            dim.saturating_sub(1)
        )
    })
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
    fn default_counts_are_those_that_every_sampler_has() {
        let counts = |names: &[&str], dim, policy| {
            let names: Vec<_> = names.iter().map(|name| (*name).to_owned()).collect();
            let samplers = samplers(&names, None).unwrap();
            common_counts(default_counts(dim).unwrap(), &samplers, dim, policy)
        };
        let error = CountPolicy::Error;
        assert_eq!(counts(&["random", "jittered"], 2, error).unwrap(), StudyPlan::paper().counts);
        assert_eq!(counts(&["random", "oa"], 2, error).unwrap(), [4, 9, 25, 49, 121, 169]);
        assert_eq!(counts(&["jittered", "zsobol"], 2, error).unwrap(), [1, 4, 16, 64, 256]);
        assert_eq!(counts(&["oa"], 2, CountPolicy::Snap).unwrap(), StudyPlan::paper().counts);
        // Defined in two dimensions alone: the study says so.
        assert_eq!(counts(&["random", "cmj"], 4, error).unwrap(), default_counts(4).unwrap());
        let error = counts(&["oa", "zsobol"], 2, error).unwrap_err().to_string();
        assert!(error.contains("oa, zsobol") && error.contains("--counts"), "{error}");
    }

    #[test]
    fn a_scramble_is_for_those_that_name_none() {
        let names = ["sobol".to_owned(), "sobol+owen".to_owned(), " halton".to_owned()];
        let scrambles = |scramble| -> Vec<_> {
            samplers(&names, scramble).unwrap().iter().map(|c| c.scramble.name()).collect()
        };
        let default = scrambles(None)[0];
        assert_eq!(scrambles(Some("none")), ["none", "owen", "none"]);
        assert_eq!(scrambles(None)[..2], [default, "owen"]);
        let error = |names: &[&str], scramble| {
            let names: Vec<_> = names.iter().map(|name| (*name).to_owned()).collect();
            format!("{:#}", samplers(&names, scramble).err().unwrap())
        };
        assert!(error(&["random"], Some("ovens")).contains("--scramble"));
        assert!(error(&["sobel"], None).contains("--samplers"));
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
        assert_eq!(axes("2, 0", 3).unwrap(), [2, 0]);
        for text in ["", "0", "0,0", "0,3", "-1,0", "0,1,2"] {
            assert!(axes(text, 3).unwrap_err().to_string().contains("from 0 to 2"), "{text}");
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
