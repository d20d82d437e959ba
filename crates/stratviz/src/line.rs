//! The command line that does what is on screen, and back. A study is planned from the very
//! words that are copied, so its numbers are those of `stratcli`.

use crate::state::{State, StudyWords, TheoryWords};
use clap::{Parser, ValueEnum};
use stratcli::cli::{Cli, Command, NPolicy, StudiedChannel, StudyArgs};
use stratcli::{output, plan};
use stratcore::sampler::CountPolicy;
use stratcore::scene::Channel;
use stratcore::study::StudyPlan;

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

/// The words that trade error for time in a pixel, with the trials that `trade` makes.
pub fn trade(state: &State, [x, y]: [u32; 2]) -> Vec<String> {
    const TRIALS: u32 = 100;
    let mut words = vec!["trade".to_owned(), state.scene.clone()];
    option(&mut words, "--at", format!("{x},{y}"));
    option(&mut words, "--targets", state.study.error.to_string());
    study(&mut words, &state.study, TRIALS);
    words
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

/// Words as one line for a shell.
pub fn line(words: &[String]) -> String {
    let quoted = |word: &String| {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+^@%".contains(c);
        if !word.is_empty() && word.chars().all(is_plain) {
            word.clone()
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    let words: Vec<_> = words.iter().map(quoted).collect();
    format!("stratcli {}", words.join(" "))
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
        Command::Trade(args) => plan::study_plan(&args.protocol, &cli.common, dim),
        _ => return Err("these words are no study".to_owned()),
    };
    plan.map_err(|error| format!("{error:#}"))
}

/// The channel of this name; luminance for a name that is none.
pub fn channel(name: &str) -> Channel {
    plan::channel(StudiedChannel::from_str(name, true).unwrap_or(StudiedChannel::Luminance)).0
}

/// What a pasted line opens: the session changed to it.
///
/// # Errors
/// In words, when the line is not one that can be shown.
pub fn open(text: &str, state: &State) -> Result<State, String> {
    let words = words(text)?;
    let cli = parse(&words)?;
    let mut state = state.clone();
    state.study.seed = cli.common.seed;
    let channel_of = |channel: StudiedChannel| {
        channel.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    };
    match &cli.command {
        Command::Pixel(args) => {
            let pixel = plan::pixel(&args.at).map_err(|error| format!("{error:#}"))?;
            state.scene = args.scene.clone();
            state.pixels = vec![pixel];
            state.study.channel = channel_of(args.channel);
            read_study(&mut state.study, &args.study);
            state.page = crate::state::Page::Pixel;
        }
        Command::Integrand(args) => {
            let dim = stratcore::integrand::CATALOGUE.iter().find(|info| info.name == args.name);
            let set = args.set.iter().map(|text| plan::parameter(text));
            let occluder = args.occluder.map(|side| ("occluder".to_owned(), side));
            let params = set.collect::<anyhow::Result<Vec<_>>>();
            state.theory = TheoryWords {
                name: args.name.clone(),
                dim: args.dim.or(dim.map(|info| info.default_dim())).unwrap_or(2),
                params: params
                    .map_err(|error| format!("{error:#}"))?
                    .into_iter()
                    .chain(occluder)
                    .collect(),
            };
            read_study(&mut state.study, &args.study);
            state.page = crate::state::Page::Theory;
        }
        Command::Render(args) => {
            state.scene = args.scene.clone();
            state.picture.spp = args.spp;
            state.picture.exposure = args.exposure;
        }
        Command::Inspect(args) => state.scene = args.scene.clone(),
        _ => {
            let fault = "the explorer opens lines of stratcli pixel, integrand, render and inspect";
            return Err(fault.to_owned());
        }
    }
    Ok(state)
}

/// A line names its trials, and all of them are run.
fn read_study(study: &mut StudyWords, args: &StudyArgs) {
    study.samplers = args.protocol.samplers.iter().map(|name| name.trim().to_owned()).collect();
    study.counts = args.protocol.counts.clone().unwrap_or_default();
    study.trials = args.protocol.trials;
    study.until = 0.0;
    study.n_policy = match args.protocol.n_policy {
        NPolicy::Error => CountPolicy::Error,
        NPolicy::Snap => CountPolicy::Snap,
        NPolicy::Rect => CountPolicy::Rect,
    };
}

/// Splits a line as a shell does, and drops what stands before the command: a prompt,
/// `stratcli`, a path to it, or `cargo run --release --`.
fn words(text: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut quote = None;
    let mut chars = text.trim().chars();
    while let Some(c) = chars.next() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => word.get_or_insert_default().push(c),
            None if c == '\'' || c == '"' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            // A backslash before a line's end joins lines; before anything else it quotes.
            None if c == '\\' => {
                if let Some(next) = chars.next().filter(|next| *next != '\n') {
                    word.get_or_insert_default().push(next);
                }
            }
            None if c.is_whitespace() => words.extend(word.take()),
            None => word.get_or_insert_default().push(c),
        }
    }
    if quote.is_some() {
        return Err("the line ends within a quotation; close it".to_owned());
    }
    words.extend(word);
    let is_program = |word: &String| {
        word == "--" || word.rsplit('/').next().is_some_and(|name| name == "stratcli")
    };
    match words.iter().position(is_program) {
        Some(at) => Ok(words.split_off(at + 1)),
        None => Err("paste a line that begins with stratcli, such as: stratcli pixel classic \
                     --at 77,156"
            .to_owned()),
    }
}

#[cfg(test)]
mod tests {
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
        for (text, hint) in [
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
