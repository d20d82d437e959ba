//! The command line that does what is on screen, and back. A study is planned from the very
//! words that are copied, so its numbers are those of `stratcli`.

mod open;
mod shell;

pub use open::{OPENED, open};
pub use shell::line;

use crate::jobs::DiscrepancyPlan;
use crate::state::{PatternWords, State, StudyWords, TheoryWords};
use clap::{Parser, ValueEnum};
use stratcli::cli::{Cli, Command, Common, StudiedChannel, TradeArgs};
use stratcli::plan::{PointSpectra, PointsPlan};
use stratcli::{output, plan};
use stratcore::sampler::CountPolicy;
use stratcore::scene::{Channel, Scene};
use stratcore::study::StudyPlan;
use stratcore::trade::TradePlan;

/// The words of a pixel's study with this many trials.
pub fn pixel(state: &State, [x, y]: [u32; 2], trials: u32) -> Vec<String> {
    let mut words = vec!["pixel".to_owned(), state.scene.clone()];
    option(&mut words, "--at", format!("{x},{y}"));
    option(&mut words, "--channel", state.study.channel.clone());
    study(&mut words, &state.study, trials);
    words
}

/// The words of the study that a map makes of every pixel: `jittered`, with the paper's trials.
pub fn map_pixel(state: &State) -> Vec<String> {
    const TRIALS: u32 = 50;
    let samplers = vec!["jittered".to_owned()];
    let study = StudyWords { samplers, ..state.study.clone() };
    pixel(&State { study, ..state.clone() }, [0, 0], TRIALS)
}

/// The words of an integrand's study with this many trials.
pub fn integrand(theory: &TheoryWords, study_words: &StudyWords, trials: u32) -> Vec<String> {
    let mut words = vec!["integrand".to_owned(), theory.name.clone()];
    option(&mut words, "--dim", theory.dim.to_string());
    for (name, value) in &theory.params {
        option(&mut words, "--set", format!("{name}={value}"));
    }
    study(&mut words, study_words, trials);
    words
}

/// The words that trade error for time in the first pixel or over the picture, with the trials
/// that `trade` makes; none where a pixel is wanted and there is none.
pub fn trade(state: &State) -> Option<Vec<String>> {
    const TRIALS: u32 = 100;
    let mut words = vec!["trade".to_owned(), state.scene.clone()];
    if state.trade.whole {
        option(&mut words, "--lattice", state.trade.lattice.to_string());
    } else {
        let [x, y] = state.pixels.first()?;
        option(&mut words, "--at", format!("{x},{y}"));
    }
    option(&mut words, "--targets", state.study.error.to_string());
    study(&mut words, &state.study, TRIALS);
    Some(words)
}

/// Whether two trades measure the same, whatever error they are asked about.
pub fn same_trade(a: &[String], b: &[String]) -> bool {
    without(a, &["--targets"]) == without(b, &["--targets"])
}

/// The words without these options and their values.
pub fn without<'a>(words: &'a [String], options: &[&str]) -> Vec<&'a str> {
    let mut kept = Vec::new();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        if options.contains(&word.as_str()) {
            words.next();
        } else {
            kept.push(word.as_str());
        }
    }
    kept
}

/// The words that draw the set of the patterns page.
pub fn points(state: &State) -> Vec<String> {
    let mut words = vec!["points".to_owned()];
    option(&mut words, "--sampler", state.pattern_sampler().to_owned());
    sets(&mut words, state);
    option(&mut words, "--trial", state.patterns.trial.to_string());
    finish(&mut words, &state.study);
    words
}

/// The words that transform the sets of the patterns page.
pub fn spectrum(state: &State) -> Vec<String> {
    let mut words = vec!["spectrum".to_owned()];
    option(&mut words, "--samplers", state.study.samplers.join(","));
    sets(&mut words, state);
    option(&mut words, "--trials", state.patterns.sets.to_string());
    finish(&mut words, &state.study);
    words
}

/// The words that measure the discrepancies of the patterns page.
pub fn discrepancy(state: &State) -> Vec<String> {
    let PatternWords { dim, sets, measure, counts, .. } = &state.patterns;
    let mut words = vec!["discrepancy".to_owned()];
    option(&mut words, "--samplers", state.study.samplers.join(","));
    option(&mut words, "--dim", dim.to_string());
    option(&mut words, "--measure", measure.clone());
    option(&mut words, "--trials", sets.to_string());
    if !counts.trim().is_empty() {
        option(&mut words, "--counts", counts.trim().to_owned());
    }
    finish(&mut words, &state.study);
    words
}

fn sets(words: &mut Vec<String>, state: &State) {
    let PatternWords { n, dim, axes: [i, j], .. } = &state.patterns;
    option(words, "-n", n.to_string());
    option(words, "--dim", dim.to_string());
    option(words, "--axes", format!("{i},{j}"));
}

/// The words that render the picture as it is shown, to a file named after the scene.
pub fn render(state: &State) -> Vec<String> {
    let mut words = vec!["render".to_owned(), state.scene.clone()];
    option(&mut words, "--spp", state.picture.spp.to_string());
    option(&mut words, "--exposure", state.picture.exposure.to_string());
    option(&mut words, "--seed", state.study.seed.to_string());
    option(&mut words, "-o", format!("{}.png", stem(state)));
    words
}

/// The scene's name without its folder and ending.
pub fn stem(state: &State) -> String {
    let path = std::path::Path::new(&state.scene);
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    stem.unwrap_or_else(|| "picture".to_owned())
}

fn study(words: &mut Vec<String>, study: &StudyWords, trials: u32) {
    option(words, "--samplers", study.samplers.join(","));
    option(words, "--trials", trials.to_string());
    if !study.counts.trim().is_empty() {
        option(words, "--counts", study.counts.trim().to_owned());
    }
    finish(words, study);
}

/// What every study and every point set has: a policy of counts, and a seed.
fn finish(words: &mut Vec<String>, study: &StudyWords) {
    let policy = match study.n_policy {
        CountPolicy::Error => "error",
        CountPolicy::Snap => "snap",
        CountPolicy::Rect => "rect",
    };
    option(words, "--n-policy", policy.to_owned());
    option(words, "--seed", study.seed.to_string());
}

fn option(words: &mut Vec<String>, name: &str, value: String) {
    words.push(name.to_owned());
    words.push(value);
}

/// What `stratcli` makes of the words.
fn parse(words: &[String]) -> Result<Cli, String> {
    let words = std::iter::once("stratcli").chain(words.iter().map(String::as_str));
    Cli::try_parse_from(words).map_err(|error| output::on_one_line(&error.to_string()))
}

/// The plan that the words of a study ask for in `dim` dimensions.
pub fn study_plan(words: &[String], dim: usize) -> Result<StudyPlan, String> {
    let cli = parse(words)?;
    let plan = match &cli.command {
        Command::Pixel(args) => plan::study_plan(&args.study.protocol, &cli.common, dim),
        Command::Integrand(args) => plan::study_plan(&args.study.protocol, &cli.common, dim),
        _ => return Err("these words are no study".to_owned()),
    };
    plan.map_err(in_words)
}

/// The plan that the words of a trade ask for in `dim` dimensions.
pub fn trade_plan(words: &[String], dim: usize) -> Result<TradePlan, String> {
    let (cli, args) = trade_args(words)?;
    plan::trade_plan(&args, &cli, dim).map_err(in_words)
}

/// The pixels that the words of a trade ask for.
pub fn trade_pixels(words: &[String], scene: &Scene) -> Result<Vec<[u32; 2]>, String> {
    let (_, args) = trade_args(words)?;
    plan::trade_pixels(&args, scene).map(|(_, pixels)| pixels).map_err(in_words)
}

fn trade_args(words: &[String]) -> Result<(Common, TradeArgs), String> {
    match parse(words)? {
        Cli { command: Command::Trade(args), common } => Ok((common, args)),
        _ => Err("these words are no trade".to_owned()),
    }
}

/// The set that the words of `points` ask for, as it is drawn.
pub fn points_plan(words: &[String]) -> Result<PointsPlan, String> {
    match parse(words)? {
        Cli { command: Command::Points(args), common } => {
            plan::points(&args, &common, true).map_err(in_words)
        }
        _ => Err("these words draw no points".to_owned()),
    }
}

/// The sets that the words of `spectrum` ask for.
pub fn spectra_plan(words: &[String]) -> Result<PointSpectra, String> {
    match parse(words)? {
        Cli { command: Command::Spectrum(args), common } => {
            plan::point_spectra(&args, &common).map_err(in_words)
        }
        _ => Err("these words ask for no spectrum".to_owned()),
    }
}

/// The plan that the words of `discrepancy` ask for.
pub fn discrepancy_plan(words: &[String]) -> Result<DiscrepancyPlan, String> {
    match parse(words)? {
        Cli { command: Command::Discrepancy(args), common } => {
            plan::discrepancy(&args, &common).map_err(in_words)
        }
        _ => Err("these words ask for no discrepancy".to_owned()),
    }
}

fn in_words(error: anyhow::Error) -> String {
    format!("{error:#}")
}

/// The channel of this name; luminance for a name that is none.
pub fn channel(name: &str) -> Channel {
    plan::channel(StudiedChannel::from_str(name, true).unwrap_or(StudiedChannel::Luminance)).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_is_the_one_of_the_words() {
        let state = State::default();
        let plan = study_plan(&pixel(&state, [0, 0], 50), 2).unwrap();
        assert_eq!((plan.n_trials, plan.seed, plan.counts.len()), (50, 1996, 16));
        let mut wrong = state.clone();
        wrong.study.counts = "1..x".to_owned();
        assert!(study_plan(&pixel(&wrong, [0, 0], 50), 2).err().unwrap().contains("--counts"));
        wrong.study.counts.clear();
        wrong.study.samplers = vec!["jitered".to_owned()];
        assert!(study_plan(&pixel(&wrong, [0, 0], 50), 2).err().unwrap().contains("jitered"));
    }
}
