//! What is to be measured.

use crate::error::StudyError;
use crate::sampler::{self, CountPolicy, Jittered, Sampler, Scramble};

/// A study in words: samplers × sample counts × trials.
#[derive(Debug, Clone)]
pub struct StudyPlan {
    /// The samplers compared, each with its scramble.
    pub samplers: Vec<SamplerChoice>,
    /// Sample counts N as asked for.
    pub counts: Vec<u64>,
    /// What to do where a sampler has no set of N points.
    pub count_policy: CountPolicy,
    /// Independent repeats M, at least 2.
    pub n_trials: u32,
    /// Seed of all randomness.
    pub seed: u64,
}

/// A sampler with its scramble.
#[derive(Clone, Copy)]
pub struct SamplerChoice {
    /// The sampler.
    pub sampler: &'static dyn Sampler,
    /// Its scramble.
    pub scramble: Scramble,
}

/// As typed: `sobol+owen`.
impl std::fmt::Debug for SamplerChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}+{}", self.sampler.name(), self.scramble)
    }
}

impl SamplerChoice {
    /// The paper's stratified sampling.
    pub const JITTERED: Self = Self { sampler: &Jittered, scramble: Scramble::None };

    /// A sampler by name, with its default scramble (`sobol`) or a named one
    /// (`sobol+owen-hash`).
    ///
    /// # Errors
    /// Those of [`sampler::by_name`]; [`StudyError::UnknownScramble`]. Whether the sampler takes
    /// the scramble is checked by [`StudyPlan::counts_used`].
    pub fn named(text: &str) -> Result<Self, StudyError> {
        let split = text.rsplit_once('+').map(|(name, scramble)| (name, scramble.parse()));
        match split {
            // A plus sign may be part of a file's name.
            Some((_, Err(error))) if !text.starts_with("file:") => Err(error),
            Some((name, Ok(scramble))) => Ok(Self { sampler: sampler::by_name(name)?, scramble }),
            _ => {
                let sampler = sampler::by_name(text)?;
                Ok(Self { sampler, scramble: sampler.scrambles()[0] })
            }
        }
    }
}

impl StudyPlan {
    /// The most trials: their means are held in memory.
    pub const MAX_TRIALS: u32 = 10_000_000;

    /// The paper's protocol: random and jittered, N = 1, 4, 9, …, 256, M = 50, seed 1996.
    pub fn paper() -> Self {
        Self {
            samplers: sampler::SHELF[..2]
                .iter()
                .map(|s| SamplerChoice { sampler: *s, scramble: s.scrambles()[0] })
                .collect(),
            counts: (1..=16).map(|k| k * k).collect(),
            count_policy: CountPolicy::Error,
            n_trials: 50,
            seed: 1996,
        }
    }

    /// The counts that each sampler uses for `counts` in `dim` dimensions, after every check
    /// that can be made before the first sample.
    ///
    /// # Errors
    /// Any [`StudyError`] but `NonFinite` and `Cancelled`.
    pub fn counts_used(&self, dim: usize) -> Result<Vec<Vec<u64>>, StudyError> {
        if self.samplers.is_empty() {
            return Err(StudyError::EmptyPlan("samplers"));
        }
        for (i, SamplerChoice { sampler, scramble }) in self.samplers.iter().enumerate() {
            let (sampler, scramble) = (sampler.name(), *scramble);
            let before = &self.samplers[..i];
            if before.iter().any(|c| c.sampler.name() == sampler && c.scramble == scramble) {
                return Err(StudyError::SamplerTwice { sampler, scramble });
            }
        }
        if self.counts.is_empty() {
            return Err(StudyError::EmptyPlan("sample counts"));
        }
        if self.n_trials < 2 {
            return Err(StudyError::TooFewTrials(self.n_trials));
        }
        if self.n_trials > Self::MAX_TRIALS {
            return Err(StudyError::TooManyTrials(self.n_trials, Self::MAX_TRIALS));
        }
        self.samplers
            .iter()
            .map(|choice| {
                sampler::check(choice.sampler, choice.scramble)?;
                let used = |&n| {
                    let n = sampler::count_used(choice.sampler, n, dim, self.count_policy)?;
                    sampler::check_trials(choice.sampler, choice.scramble, n, self.n_trials)?;
                    Ok(n)
                };
                self.counts.iter().map(used).collect()
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scramble_is_named_beside_its_sampler() {
        let name = |text| SamplerChoice::named(text).map(|c| (c.sampler.name(), c.scramble));
        assert_eq!(name("jittered"), Ok(("jittered", Scramble::None)));
        assert_eq!(name("sobol+owen-hash"), Ok(("sobol", Scramble::OwenHash)));
        assert!(matches!(name("sobol+ovens"), Err(StudyError::UnknownScramble { .. })));
        assert!(matches!(name("sobel+owen"), Err(StudyError::UnknownSampler { .. })));
        assert!(matches!(name("file:a+b.csv"), Err(StudyError::PointFile(_))));
    }

    #[test]
    fn a_sampler_is_listed_once() {
        let plan = |names: [&str; 2]| StudyPlan {
            samplers: names.map(|name| SamplerChoice::named(name).unwrap()).to_vec(),
            counts: vec![4],
            ..StudyPlan::paper()
        };
        let error = plan(["sobol", "sobol+owen"]).counts_used(2).unwrap_err();
        assert!(error.to_string().contains("sobol with the scramble owen twice"), "{error}");
        assert!(plan(["sobol", "sobol+owen-hash"]).counts_used(2).is_ok());
    }

    #[test]
    fn more_trials_than_memory_holds_are_refused() {
        let plan = StudyPlan { n_trials: u32::MAX, ..StudyPlan::paper() };
        assert!(matches!(plan.counts_used(2), Err(StudyError::TooManyTrials(..))));
    }
}
