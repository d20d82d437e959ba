//! A line of `stratcli`, pasted: what it shows.

use super::shell::lines;
use super::{in_words, parse};
use crate::state::{Page, PatternWords, State, StudyWords, TheoryWords, TradeWords};
use clap::ValueEnum as _;
use stratcli::cli::{
    Command, Common, DiscrepancyArgs, PointsArgs, ProtocolArgs, SpectrumArgs, StudiedChannel,
    StudyArgs, TradeArgs,
};
use stratcli::plan;
use stratcore::discrepancy::Measure;
use stratcore::integrand::CATALOGUE;
use stratcore::sampler::CountPolicy;
use stratcore::study::Tightness;
use stratcore::trade::Target;

/// The commands whose lines are opened.
pub const OPENED: &str =
    "pixel, integrand, trade, points, spectrum, discrepancy, render and inspect";

/// What pasted lines open: the session changed to them. Pixels of several lines are compared.
///
/// # Errors
/// In words, when a line is not one that can be shown.
pub fn open(text: &str, state: &State) -> Result<State, String> {
    let mut state = state.clone();
    for (i, words) in lines(text)?.into_iter().enumerate() {
        let before = if i > 0 { std::mem::take(&mut state.pixels) } else { Vec::new() };
        let scene = state.scene.clone();
        state = open_words(&words, state)?;
        if i > 0 && state.scene == scene {
            let new = std::mem::replace(&mut state.pixels, before);
            let unknown: Vec<_> = new.into_iter().filter(|p| !state.pixels.contains(p)).collect();
            state.pixels.extend(unknown);
        }
    }
    Ok(state)
}

fn open_words(words: &[String], mut state: State) -> Result<State, String> {
    let cli = parse(words)?;
    state.study.seed = cli.common.seed;
    let channel_of = |channel: StudiedChannel| {
        channel.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    };
    match &cli.command {
        Command::Pixel(args) => {
            let pixel = plan::pixel(&args.at).map_err(in_words)?;
            state.scene = args.scene.clone();
            state.pixels = vec![pixel];
            state.study.channel = channel_of(args.channel);
            read_study(&mut state.study, &args.study)?;
            state.page = Page::Pixel;
        }
        Command::Integrand(args) => {
            let dim = CATALOGUE.iter().find(|info| info.name == args.name);
            let set = args.set.iter().map(|text| plan::parameter(text));
            let occluder = args.occluder.map(|side| ("occluder".to_owned(), side));
            let params = set.collect::<anyhow::Result<Vec<_>>>();
            state.theory = TheoryWords {
                name: args.name.clone(),
                dim: args.dim.or(dim.map(|info| info.default_dim())).unwrap_or(2),
                params: params.map_err(in_words)?.into_iter().chain(occluder).collect(),
            };
            read_study(&mut state.study, &args.study)?;
            state.page = Page::Theory;
        }
        Command::Trade(args) => open_trade(&mut state, args)?,
        Command::Points(args) => open_points(&mut state, args, &cli.common)?,
        Command::Spectrum(args) => open_spectrum(&mut state, args)?,
        Command::Discrepancy(args) => open_discrepancy(&mut state, args)?,
        Command::Render(args) => {
            state.scene = args.scene.clone();
            state.picture.spp = args.spp;
            state.picture.exposure = args.exposure;
        }
        Command::Inspect(args) => state.scene = args.scene.clone(),
        _ => {
            return Err(format!("the explorer opens lines of stratcli {OPENED}"));
        }
    }
    Ok(state)
}

/// A line names its trials, and all of them are run, or how sure it wants to be.
fn read_study(study: &mut StudyWords, args: &StudyArgs) -> Result<(), String> {
    let ProtocolArgs { samplers, counts, n_policy, trials } = &args.protocol;
    study.samplers = trimmed(samplers);
    study.counts = counts.clone().unwrap_or_default();
    study.n_policy = CountPolicy::from(*n_policy);
    (study.trials, study.until) = match args.until.as_deref().map(plan::until).transpose() {
        Ok(None) => (*trials, 0.0),
        Ok(Some(Tightness::Exponent(width))) => (args.max_trials, width),
        Ok(Some(Tightness::Variance(_))) => {
            return Err("the explorer stops by the width of p; write --until p:W".to_owned());
        }
        Err(error) => return Err(in_words(error)),
    };
    Ok(())
}

fn open_trade(state: &mut State, args: &TradeArgs) -> Result<(), String> {
    if CATALOGUE.iter().any(|info| info.name == args.subject) {
        return Err("the explorer trades in scenes; an integrand is for stratcli".to_owned());
    }
    if args.region.is_some() || args.needed.is_some() {
        let fault = "the explorer trades in one pixel or the whole picture, without --region and \
                     --needed";
        return Err(fault.to_owned());
    }
    let error = match plan::targets(&args.targets).map_err(in_words)?[..] {
        [Target::Absolute(error)] => error,
        _ => {
            let fault = "the explorer trades for one error in radiance, such as --targets 0.004";
            return Err(fault.to_owned());
        }
    };
    if let Some(at) = &args.at {
        state.pixels = vec![plan::pixel(at).map_err(in_words)?];
    }
    state.scene.clone_from(&args.subject);
    state.trade = TradeWords { whole: args.at.is_none(), lattice: args.lattice };
    state.study.error = error;
    state.study.samplers = trimmed(&args.protocol.samplers);
    state.study.counts = args.protocol.counts.clone().unwrap_or_default();
    state.study.n_policy = CountPolicy::from(args.protocol.n_policy);
    state.page = Page::Trade;
    Ok(())
}

fn open_points(state: &mut State, args: &PointsArgs, common: &Common) -> Result<(), String> {
    let points = plan::points(args, common, true).map_err(in_words)?;
    let scramble = args.scramble.as_ref().map(|scramble| format!("+{scramble}"));
    let sampler = args.sampler.trim().to_owned() + &scramble.unwrap_or_default();
    if !state.study.samplers.contains(&sampler) {
        state.study.samplers.push(sampler.clone());
    }
    let axes = points.axes.unwrap_or([0, 1]);
    let (n, dim, trial) = (args.n, args.dim, args.trial);
    show_patterns(state, PatternWords { sampler, n, trial, ..state.patterns.clone() }, dim, axes);
    state.study.n_policy = CountPolicy::from(args.n_policy);
    Ok(())
}

fn open_spectrum(state: &mut State, args: &SpectrumArgs) -> Result<(), String> {
    if let Some(subject) = &args.subject {
        return Err(format!(
            "{subject}: the explorer shows spectra of samplers; a file of points goes among \
             --samplers as file:PATH, and pictures are for stratcli"
        ));
    }
    state.study.samplers = scrambled(&args.samplers, args.scramble.as_deref())?;
    let dim = args.dim.unwrap_or(2);
    let axes = plan::axes(args.axes.as_deref().unwrap_or("0,1"), dim).map_err(in_words)?;
    let (n, sets) = (args.n.unwrap_or(256), args.trials.unwrap_or(50));
    show_patterns(state, PatternWords { n, sets, ..state.patterns.clone() }, dim, axes);
    state.study.n_policy = args.n_policy.map_or(CountPolicy::Error, CountPolicy::from);
    Ok(())
}

fn open_discrepancy(state: &mut State, args: &DiscrepancyArgs) -> Result<(), String> {
    if let Some(file) = &args.file {
        return Err(format!(
            "{file}: the explorer measures samplers; a file of points goes among --samplers as \
             file:PATH"
        ));
    }
    state.study.samplers = scrambled(&args.samplers, args.scramble.as_deref())?;
    let dim = args.dim.unwrap_or(2);
    let measure = match &args.measure[..] {
        [] if dim == 2 => Measure::Edge.name().to_owned(),
        [] => Measure::Centred.name().to_owned(),
        [one] => one.trim().to_owned(),
        _ => return Err("the explorer measures one discrepancy at a time".to_owned()),
    };
    let (sets, counts) = (args.trials.unwrap_or(50), args.counts.clone());
    let words = PatternWords { sets, measure, counts, ..state.patterns.clone() };
    let axes = words.axes;
    show_patterns(state, words, dim, axes);
    state.study.n_policy = CountPolicy::from(args.n_policy);
    Ok(())
}

/// Shows patterns in `dim` dimensions, with a discrepancy that is defined there.
fn show_patterns(state: &mut State, words: PatternWords, dim: usize, axes: [usize; 2]) {
    state.patterns = PatternWords { axes, ..words }.in_dim(dim);
    state.page = Page::Patterns;
}

fn trimmed(names: &[String]) -> Vec<String> {
    names.iter().map(|name| name.trim().to_owned()).collect()
}

/// Names with the scramble that `--scramble` gives to those without one.
fn scrambled(names: &[String], scramble: Option<&str>) -> Result<Vec<String>, String> {
    let default = ["random", "jittered"].map(str::to_owned);
    let names = if names.is_empty() { &default[..] } else { names };
    let choices = plan::samplers(names, scramble).map_err(in_words)?;
    let named = names.iter().zip(choices).map(|(name, choice)| match scramble {
        Some(_) => format!("{}+{}", choice.sampler.name(), choice.scramble),
        None => name.trim().to_owned(),
    });
    Ok(named.collect())
}

#[cfg(test)]
mod tests {
    use super::super::{discrepancy, integrand, line, pixel, points, spectrum, trade};
    use super::*;

    #[test]
    fn what_is_copied_opens_as_it_was() {
        let mut state = State { pixels: vec![[21, 3]], ..State::default() };
        state.scene = "my scenes/a'b.toml".to_owned();
        state.study = StudyWords {
            samplers: vec!["jittered".to_owned(), "sobol+owen-hash".to_owned()],
            counts: "1..8^2".to_owned(),
            channel: "g".to_owned(),
            trials: 77,
            until: 0.0,
            ..state.study
        };
        let copied = line(&pixel(&state, [21, 3], 77));
        assert!(
            copied.starts_with(r"stratcli pixel 'my scenes/a'\''b.toml' --at 21,3"),
            "{copied}"
        );
        let mut blank = State::default();
        blank.study.seed = 3;
        let opened = open(&copied, &blank).unwrap();
        assert_eq!(opened, state);

        let theory = TheoryWords {
            name: "step".to_owned(),
            dim: 3,
            params: [("edge".to_owned(), 0.25)].into(),
        };
        let copied = line(&integrand(&theory, &state.study, 9));
        assert_eq!(open(&copied, &State::default()).unwrap().theory, theory);
    }

    #[test]
    fn lines_are_read_as_people_have_them() {
        let pixels = |text| open(text, &State::default()).map(|state| state.pixels);
        assert_eq!(pixels("$ cargo run --release -- pixel classic --at 1,2"), Ok(vec![[1, 2]]));
        assert_eq!(
            pixels("./target/release/stratcli pixel classic \\\n --at 3,4"),
            Ok(vec![[3, 4]])
        );
        let two = "stratcli pixel classic --at 1,2\n\nstratcli pixel classic --at 3,4 --trials 9\n";
        assert_eq!(pixels(two), Ok(vec![[1, 2], [3, 4]]));
        assert_eq!(pixels("stratcli render classic -o a.png"), Ok(vec![]));
        for (text, hint) in [
            ("", "begins with stratcli"),
            ("hello", "begins with stratcli"),
            ("stratcli pixel 'classic", "close it"),
            ("stratcli list", "the explorer opens"),
            ("stratcli pixel classic", "--at"),
            ("stratcli pixel classic --at 1", "X,Y"),
        ] {
            let fault = pixels(text).unwrap_err();
            assert!(fault.contains(hint), "{text}: {fault}");
        }
    }

    #[test]
    fn patterns_and_trades_open_as_they_were() {
        let mut state = State { pixels: vec![[3, 4]], ..State::default() };
        state.study.samplers = ["random", "sobol+owen"].map(str::to_owned).to_vec();
        state.study.n_policy = CountPolicy::Error;
        state.patterns = PatternWords {
            sampler: "sobol+owen".to_owned(),
            n: 64,
            dim: 3,
            axes: [2, 1],
            all_pairs: false,
            trial: 7,
            sets: 9,
            measure: "mixture".to_owned(),
            counts: "2^1..2^5".to_owned(),
        };
        state.page = Page::Patterns;
        let blank = || State { pixels: vec![[3, 4]], ..State::default() };
        // A line of points names one sampler, and not how many sets are measured.
        let opened = open(&line(&points(&state)), &blank()).unwrap();
        assert_eq!(opened.study.samplers.last().unwrap(), "sobol+owen");
        assert_eq!(points(&opened), points(&state));
        let opened = open(&line(&spectrum(&state)), &blank()).unwrap();
        assert_eq!(spectrum(&opened), spectrum(&state));
        let opened = open(&line(&discrepancy(&state)), &blank()).unwrap();
        assert_eq!(discrepancy(&opened), discrepancy(&state));
        let all = [points(&state), spectrum(&state), discrepancy(&state)].map(|words| line(&words));
        let opened = open(&all.join("\n"), &blank()).unwrap();
        assert_eq!((&opened.patterns, &opened.study), (&state.patterns, &state.study));
        for whole in [false, true] {
            state.trade = TradeWords { whole, lattice: 5 };
            let opened = open(&line(&trade(&state).unwrap()), &blank()).unwrap();
            assert_eq!((opened.page, trade(&opened)), (Page::Trade, trade(&state)));
        }
    }

    #[test]
    fn a_width_of_p_is_taken_over() {
        let state = State::default();
        let opened = open("stratcli pixel edges --at 1,2 --until p:0.03", &state).unwrap();
        assert_eq!((opened.study.until, opened.study.trials), (0.03, 100_000));
        let fault = open("stratcli pixel edges --at 1,2 --until var:5%", &state).unwrap_err();
        assert!(fault.contains("--until p:W"), "{fault}");
    }

    #[test]
    fn what_the_explorer_does_not_show_is_said() {
        for (line, hint) in [
            ("stratcli spectrum classic", "pictures are for stratcli"),
            ("stratcli discrepancy a.csv", "file:PATH"),
            ("stratcli discrepancy --measure edge,star", "one discrepancy"),
            ("stratcli points --sampler oa -n 7", "7"),
            ("stratcli trade disk", "an integrand is for stratcli"),
            ("stratcli trade classic --region 0,0,9,9 --targets 0.1", "--region"),
            ("stratcli trade classic --targets 1%", "--targets 0.004"),
        ] {
            let fault = open(line, &State::default()).unwrap_err();
            assert!(fault.contains(hint), "{line}: {fault}");
        }
    }
}
