//! What is remembered from one session to the next: words and numbers as a user sets them, no
//! results.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
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
    /// The page on the right.
    pub page: Page,
    /// Dark or light.
    pub dark: bool,
}

/// The pages on the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Page {
    /// Curves of the studied pixels, and the inside of the first.
    #[default]
    Pixel,
    /// Integrands with known answers.
    Theory,
    /// Error against time in the first pixel.
    Trade,
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
            page: Page::default(),
            dark: true,
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

impl State {
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
}
