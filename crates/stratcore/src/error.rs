//! What can go wrong in a study, each with its way out.

use crate::sampler::{PointFileError, Scramble};

/// A study that could not be set up or finished.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A sampler has no set of exactly this many points.
    #[error("{sampler} in {dim} dimensions cannot make N = {n}: {neighbours} (or --n-policy snap)")]
    CountNotAdmitted {
        /// Sampler's name.
        sampler: &'static str,
        /// Dimensions asked for.
        dim: usize,
        /// Points asked for.
        n: u64,
        /// Words naming the nearest counts that exist.
        neighbours: String,
    },
    /// A sampler has no set in so few dimensions.
    #[error("{sampler} has no sets in {dim} dimensions, whatever N")]
    NoSets {
        /// Sampler's name.
        sampler: &'static str,
        /// Dimensions asked for.
        dim: usize,
    },
    /// More dimensions than the sampler is defined for.
    #[error("{sampler} is defined up to {max_dim} dimensions, not for {dim}")]
    TooManyDimensions {
        /// Sampler's name.
        sampler: &'static str,
        /// Dimensions asked for.
        dim: usize,
        /// Dimensions it has.
        max_dim: usize,
    },
    /// A scramble that does not exist for this sampler.
    #[error("{sampler} cannot be scrambled by {scramble}; it takes {choices}")]
    ScrambleNotSupported {
        /// Sampler's name.
        sampler: &'static str,
        /// The scramble asked for.
        scramble: Scramble,
        /// Words naming those that exist.
        choices: String,
    },
    /// Repeating a deterministic point set gives the same estimate each time: it has no variance.
    #[error(
        "{sampler} without a scramble is deterministic: its trials are identical and have no \
         variance; choose a scramble ({choices})"
    )]
    Deterministic {
        /// Sampler's name.
        sampler: &'static str,
        /// Words naming the scrambles that exist.
        choices: String,
    },
    /// Fewer than two trials have no variance.
    #[error("a variance needs at least 2 trials, not {0} (--trials)")]
    TooFewTrials(u32),
    /// More trials than are held in memory.
    #[error("{0} trials are too many; a study keeps the means of at most {1} (--trials)")]
    TooManyTrials(u32, u32),
    /// No sample counts, or no samplers.
    #[error("the plan lists no {0}")]
    EmptyPlan(&'static str),
    /// The same sampler under the same scramble twice: one result would stand for both.
    #[error("the plan lists {sampler} with the scramble {scramble} twice; name it once")]
    SamplerTwice {
        /// Sampler's name.
        sampler: &'static str,
        /// Its scramble.
        scramble: Scramble,
    },
    /// A sampler's name that is not on the shelf.
    #[error("no sampler is called \"{name}\"; there are {known}")]
    UnknownSampler {
        /// The name as typed.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A file of point sets that cannot be used.
    #[error(transparent)]
    PointFile(#[from] PointFileError),
    /// More trials than there are different sets.
    #[error(
        "{sampler} has {sets} different sets of {n} points, {trials} trials need as many; ask for \
         fewer trials or scramble by torus-shift"
    )]
    TooFewSets {
        /// Sampler's name.
        sampler: &'static str,
        /// Points in a set.
        n: u64,
        /// Sets there are.
        sets: u32,
        /// Trials asked for.
        trials: u32,
    },
    /// A scramble's name that does not exist.
    #[error("no scramble is called \"{name}\"; there are {known}")]
    UnknownScramble {
        /// The name as typed.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A sample or a mean that is not a finite number.
    #[error(
        "pixel {},{}: {sampler}, N = {n}, trial {trial} has the mean {mean}, which is not finite; \
         look for infinite emission or coordinates in the scene",
        pixel[0], pixel[1]
    )]
    NonFinite {
        /// Pixel under study.
        pixel: [u32; 2],
        /// Sampler's name.
        sampler: &'static str,
        /// Points in the trial.
        n: u64,
        /// Trial's index.
        trial: u32,
        /// The mean as computed.
        mean: f64,
    },
    /// Trial means that differ, but whose variance is beyond the range of f64.
    #[error(
        "pixel {},{}: {sampler}, N = {n}: the variance of the mean, {variance:e}, is beyond the \
         range of f64 (about 1e-308 to 1e308); scale the integrand or the scene's radiance",
        pixel[0], pixel[1]
    )]
    VarianceOutOfRange {
        /// Pixel under study.
        pixel: [u32; 2],
        /// Sampler's name.
        sampler: &'static str,
        /// Points in a trial.
        n: u64,
        /// The variance as far as it can be written down.
        variance: f64,
    },
    /// Something outside the range that random streams can address.
    #[error("{what} is {value}, beyond the {limit} that random streams can address")]
    Unaddressable {
        /// Which part of the address.
        what: &'static str,
        /// Its value.
        value: u64,
        /// The largest value allowed.
        limit: u64,
    },
    /// A discrepancy's name that does not exist.
    #[error("no discrepancy is called \"{name}\"; there are {known}")]
    UnknownMeasure {
        /// The name as typed.
        name: String,
        /// Names that exist.
        known: String,
    },
    /// A discrepancy that is defined in another dimension.
    #[error("the {measure} discrepancy is that of points in {needs} dimensions, not {dim}")]
    MeasureNeedsDim {
        /// Name of the discrepancy.
        measure: &'static str,
        /// Dimensions it is defined for.
        needs: usize,
        /// Dimensions asked for.
        dim: usize,
    },
    /// A point set that does not fit in memory.
    #[error("{n} points in {dim} dimensions are too many to hold at once, {limit} coordinates")]
    TooManyCoordinates {
        /// Points asked for.
        n: u64,
        /// Dimensions asked for.
        dim: usize,
        /// The most coordinates.
        limit: u64,
    },
    /// A picture that has to be held whole and does not fit in memory.
    #[error(
        "{copies} times {width} × {height} pixels are too many to hold at once, {limit}; lower \
         the camera's resolution, or name fewer samplers or trials"
    )]
    PictureTooLarge {
        /// Its pixels across.
        width: u32,
        /// Its pixels down.
        height: u32,
        /// Numbers to be held of each.
        copies: u64,
        /// The most of them.
        limit: u64,
    },
    /// More axes than can be told apart at a bearable cost.
    #[error("what {dim} axes are needed for is not worked out beyond {limit} of them")]
    TooManyAxes {
        /// Dimensions of the integrand.
        dim: usize,
        /// The most.
        limit: usize,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
