//! What is remembered from one session to the next: words and numbers as a user sets them, no
//! results.

mod patterns;

pub use patterns::PatternWords;

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use stratcore::integrand::IntegrandInfo;
use stratcore::sampler::CountPolicy;

/// Everything a session is made of.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// The scene: a path or a built-in name.
    pub scene: String,
    /// Scenes opened before, the latest first.
    pub recent: Vec<String>,
    /// Studied pixels; the first is the one that the inside shows.
    pub pixels: Vec<[u32; 2]>,
    /// How pixels and integrands are studied.
    pub study: StudyWords,
    /// How the picture is shown.
    pub picture: PictureWords,
    /// What is shown inside the pixel.
    pub inside: InsideWords,
    /// The integrand of the theory page.
    pub theory: TheoryWords,
    /// What the trade page measures.
    pub trade: TradeWords,
    /// The point sets of the patterns page.
    pub patterns: PatternWords,
    /// The page on the right.
    pub page: Page,
    /// Whether the grids of strata are drawn.
    pub strata: bool,
    /// Dark or light.
    pub dark: bool,
    /// How the window is shared out.
    pub layout: Layout,
}

/// Shares of the window, which it keeps when it grows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// The picture's share of the width, 0 to 1.
    pub picture: f32,
    /// The share that all but the inside has of the height beside the picture, 0 to 1.
    pub inside: f32,
}

impl Layout {
    /// Points that a part keeps, however small its share.
    const SMALLEST: f32 = 120.0;

    /// Width of the picture in a window of so many points.
    pub fn picture_width(&self, window: f32) -> f32 {
        Self::part(self.picture, window)
    }

    /// Height of the inside in so many points.
    pub fn inside_height(&self, all: f32) -> f32 {
        Self::part(1.0 - self.inside, all)
    }

    fn part(share: f32, all: f32) -> f32 {
        (share * all).min(all - Self::SMALLEST).max(Self::SMALLEST).round()
    }
}

/// The pages on the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Page {
    /// Curves of the studied pixels, and the inside of the first.
    #[default]
    Pixel,
    /// Integrands with known answers.
    Theory,
    /// Error against time, in the first pixel or over the picture.
    Trade,
    /// Point sets by themselves.
    Patterns,
}

impl Page {
    /// In the order in which they are offered, each with its name.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Pixel, "Pixel"),
        (Self::Theory, "Theory"),
        (Self::Trade, "Trade"),
        (Self::Patterns, "Patterns"),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(page, _)| *page == self).map_or("", |(_, name)| name)
    }
}

/// How a study is made, in the words of the command line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StudyWords {
    /// Samplers, each with its scramble after a plus sign.
    pub samplers: Vec<String>,
    /// Sample counts; empty for the default of the dimension.
    pub counts: String,
    /// What to do with an N that a sampler cannot make.
    pub n_policy: CountPolicy,
    /// The most trials M.
    pub trials: u32,
    /// A study stops when the 95 % interval of every p is within ± this; 0 to use all trials.
    pub until: f64,
    /// Seed of all randomness.
    pub seed: u64,
    /// `luminance`, `r`, `g` or `b`.
    pub channel: String,
    /// The error that "samples needed" means: a standard error, in radiance.
    pub error: f64,
}

/// How the picture is shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PictureWords {
    /// Samples per pixel when it is finished.
    pub spp: u64,
    /// Brightened by this many stops.
    pub exposure: f64,
    /// What lies over it.
    pub overlay: Overlay,
    /// How much the overlay covers, 0 to 1.
    pub opacity: f32,
}

/// What can lie over the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Overlay {
    /// Nothing.
    #[default]
    Off,
    /// p under jittered, 1 to 2.
    Exponent,
    /// Smooth, edge, complex or exact.
    Class,
    /// Jittered samples that reach the wanted error.
    Samples,
}

impl Overlay {
    /// In the order in which they are offered.
    pub const ALL: [Self; 4] = [Self::Off, Self::Exponent, Self::Class, Self::Samples];

    /// The one after it, the first after the last.
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|overlay| *overlay == self).unwrap_or(0);
        Self::ALL[(at + 1) % Self::ALL.len()]
    }

    /// As it is offered.
    pub fn label(self) -> &'static str {
        match self {
            Self::Off => "no overlay",
            Self::Exponent => "map of p",
            Self::Class => "map of classes",
            Self::Samples => "samples needed",
        }
    }
}

/// The trial shown inside the pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct InsideWords {
    /// Sampler, with its scramble after a plus sign.
    pub sampler: String,
    /// N
    pub n: u64,
    /// Which of the trials.
    pub trial: u32,
}

/// The integrand of the theory page.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TheoryWords {
    /// Its name in the catalogue.
    pub name: String,
    /// Dimensions d.
    pub dim: usize,
    /// Parameters that differ from their defaults.
    pub params: BTreeMap<String, f64>,
}

/// What error is traded for time in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TradeWords {
    /// The whole picture, rather than the first pixel.
    pub whole: bool,
    /// Pixels along each side of the lattice that stands for the picture.
    pub lattice: u32,
}

impl Default for State {
    fn default() -> Self {
        Self {
            scene: "classic".to_owned(),
            recent: Vec::new(),
            pixels: Vec::new(),
            study: StudyWords::default(),
            picture: PictureWords::default(),
            inside: InsideWords::default(),
            theory: TheoryWords::default(),
            trade: TradeWords::default(),
            patterns: PatternWords::default(),
            page: Page::default(),
            strata: true,
            dark: true,
            layout: Layout::default(),
        }
    }
}

impl Default for StudyWords {
    fn default() -> Self {
        Self {
            samplers: ["random", "jittered", "sobol", "halton"].map(str::to_owned).to_vec(),
            counts: String::new(),
            n_policy: CountPolicy::Snap,
            trials: 4000,
            until: 0.02,
            seed: 1996,
            channel: "luminance".to_owned(),
            error: 0.01,
        }
    }
}

impl Default for PictureWords {
    fn default() -> Self {
        Self { spp: 16, exposure: 0.0, overlay: Overlay::Off, opacity: 0.8 }
    }
}

impl Default for InsideWords {
    fn default() -> Self {
        Self { sampler: "jittered".to_owned(), n: 64, trial: 0 }
    }
}

impl Default for TheoryWords {
    fn default() -> Self {
        Self { name: "form-factor".to_owned(), dim: 4, params: BTreeMap::new() }
    }
}

impl Default for Layout {
    fn default() -> Self {
        Self { picture: 0.44, inside: 0.64 }
    }
}

impl Default for TradeWords {
    fn default() -> Self {
        Self { whole: false, lattice: 16 }
    }
}

impl StudyWords {
    /// The same with a sampler of the shelf added, or removed if it was there; none where it is
    /// the last one.
    pub fn with_sampler_switched(&self, name: &str) -> Option<Self> {
        let mut words = self.clone();
        match self.place_of(name) {
            Some(_) if words.samplers.len() == 1 => return None,
            Some(place) => drop(words.samplers.remove(place)),
            None => words.samplers.push(name.to_owned()),
        }
        Some(words)
    }

    /// Where a sampler stands, under whatever scramble.
    pub fn place_of(&self, name: &str) -> Option<usize> {
        self.samplers.iter().position(|word| word.split('+').next() == Some(name))
    }
}

impl TheoryWords {
    /// The fewest and the most dimensions that are offered of an integrand.
    pub fn dimensions(info: &IntegrandInfo) -> [usize; 2] {
        [info.min_dim, info.max_dim.min(16)]
    }
}

impl State {
    /// The place of the sampler whose point set is seen among those of the studies.
    pub fn pattern_place(&self) -> usize {
        let names = &self.study.samplers;
        names.iter().position(|name| *name == self.patterns.sampler).unwrap_or(0)
    }

    /// The sampler whose point set is seen.
    pub fn pattern_sampler(&self) -> &str {
        self.study.samplers.get(self.pattern_place()).map_or("jittered", String::as_str)
    }

    /// Scenes remembered in the menu.
    const MOST_RECENT: usize = 8;

    /// Puts a scene first in the list of recent ones.
    pub fn remember(&mut self, spec: &str) {
        self.recent.retain(|known| known != spec);
        self.recent.insert(0, spec.to_owned());
        self.recent.truncate(Self::MOST_RECENT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_scenes_are_few_and_different() {
        let mut state = State::default();
        for i in 0..20 {
            state.remember(&format!("{}.toml", i % 10));
        }
        assert_eq!(state.recent.len(), State::MOST_RECENT);
        assert_eq!(state.recent[0], "9.toml");
        state.remember("5.toml");
        assert_eq!((state.recent[0].as_str(), state.recent.len()), ("5.toml", 8));
    }

    #[test]
    fn one_sampler_always_remains() {
        let study = StudyWords { samplers: vec!["sobol+owen".to_owned()], ..StudyWords::default() };
        assert_eq!(study.with_sampler_switched("sobol"), None);
        let two = study.with_sampler_switched("lhs").unwrap();
        assert_eq!(two.samplers, ["sobol+owen", "lhs"]);
        assert_eq!(two.with_sampler_switched("sobol").unwrap().samplers, ["lhs"]);
    }
}
