//! Samplers: where the N points of one estimate lie in the unit cube.
//!
//! A sampler makes *point sets*. A [`PointSet`] names one: its size, dimension, scramble and
//! the key of its randomness; [`Sampler::points`] makes it ready, and [`Points::fill`] writes
//! any run of its points. Adding a sampler is one file and one line in [`SHELF`].

mod admissible;
mod annealed;
mod best_candidate;
mod cmj;
mod digital;
mod file;
mod grid;
mod halton;
mod hammersley;
mod hash;
mod jittered;
mod jittered_padded;
mod lhs;
mod memo;
mod nested;
mod oa;
mod owen;
mod padded;
mod patterns;
mod permutation;
mod pmj02;
mod poisson;
mod radical;
mod random;
mod rank1;
mod rd;
mod scramble;
mod sobol;
mod target;
mod zero_two;
mod zsobol;

pub use admissible::Admissible;
pub use annealed::ANNEALED;
pub use best_candidate::BEST_CANDIDATE;
pub use cmj::CorrelatedMultiJittered;
pub use file::{PointFile, PointFileError, PointFileFault};
pub use grid::Grid;
pub use halton::Halton;
pub use hammersley::Hammersley;
pub use jittered::{Jittered, strata_per_axis};
pub use jittered_padded::JitteredPadded;
pub use lhs::LatinHypercube;
pub use oa::OrthogonalArray;
pub use padded::Padded;
pub use patterns::Pattern;
pub use pmj02::Pmj02;
pub use poisson::POISSON;
pub use random::Random;
pub use rank1::RankOne;
pub use rd::Rd;
pub use scramble::Scramble;
pub use sobol::Sobol;
pub use zsobol::ZSobol;

use crate::error::StudyError;
use crate::rng::{Stream, StreamKey};
use crate::simd::{self, BLOCK, Isa, Loop};
use scramble::Shifted;
use target::centred;

/// Every sampler there is, in the order in which they are listed.
pub const SHELF: &[&dyn Sampler] = &[
    &Random,
    &Jittered,
    &JitteredPadded,
    &Grid,
    &LatinHypercube,
    &CorrelatedMultiJittered,
    &OrthogonalArray,
    &Hammersley,
    &Halton,
    &Sobol,
    &Padded,
    &Pmj02,
    &ZSobol,
    &RankOne,
    &Rd,
    &POISSON,
    &BEST_CANDIDATE,
    &ANNEALED,
];

/// The sampler of this name; `file:PATH` is the [`PointFile`] there.
///
/// # Errors
/// [`StudyError::UnknownSampler`] lists the names that exist; [`StudyError::PointFile`].
pub fn by_name(name: &str) -> Result<&'static dyn Sampler, StudyError> {
    if let Some(path) = name.strip_prefix("file:") {
        return Ok(PointFile::load(path)?);
    }
    SHELF.iter().copied().find(|s| s.name() == name).ok_or_else(|| {
        let known = SHELF.iter().map(|s| s.name()).collect::<Vec<_>>().join(", ");
        let known = format!("{known}, file:PATH");
        StudyError::UnknownSampler { name: name.to_owned(), known }
    })
}

/// Whether a prefix of the points may serve as a smaller set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Made for one N; a prefix has no promised property.
    Set,
    /// Any prefix is usable.
    Sequence,
}

/// What to do with an N that a sampler cannot make.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CountPolicy {
    /// An error that names the neighbours.
    #[default]
    Error,
    /// The nearest N that exists; the row records it as `n_used`.
    Snap,
    /// Unequal strata per axis where the sampler has them: N is the product of the kᵢ.
    Rect,
}

/// Names one point set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSet {
    /// The randomness; `key.n_samples` is the number of points.
    pub key: StreamKey,
    /// Dimensions, at least 1.
    pub dim: usize,
    /// How the set is scrambled.
    pub scramble: Scramble,
    /// Whether unequal numbers of strata per axis are allowed ([`CountPolicy::Rect`]).
    pub rectangular: bool,
}

/// What is true of all sets of a sampler.
#[derive(Debug, Clone, Copy)]
pub struct Facts {
    /// As typed on the command line and printed in reports.
    pub name: &'static str,
    /// One line of help.
    pub summary: &'static str,
    /// Where it was published.
    pub source: &'static str,
    /// Number of its random streams; unique on the shelf and never reused.
    pub stream_id: u8,
    /// Set or sequence.
    pub kind: Kind,
    /// Largest dimension it is defined for; [`usize::MAX`] for any, up to [`MAX_DIM`].
    pub max_dim: usize,
    /// The N it has.
    pub counts: Admissible,
    /// Scrambles it takes; the first is its default.
    pub scrambles: &'static [Scramble],
    /// Whether its construction is random: repeats differ without a scramble.
    pub is_random: bool,
}

/// How the unscrambled points of a set follow from its stream, two dimensions to a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placement {
    /// Point i is pair i of the set's stream.
    Independent,
    /// Point i is pair i of the set's stream, within cell i of [`Sampler::strata`].
    Strata,
    /// In a way of its own.
    Other,
}

/// A rule that places N points in [0, 1)^d.
pub trait Sampler: Send + Sync {
    /// What is true of all its sets.
    fn facts(&self) -> Facts;
    /// As typed on the command line and printed in reports.
    fn name(&self) -> &'static str {
        self.facts().name
    }
    /// Number of its random streams.
    fn stream_id(&self) -> u8 {
        self.facts().stream_id
    }
    /// Scrambles it takes; the first is its default.
    fn scrambles(&self) -> &'static [Scramble] {
        self.facts().scrambles
    }
    /// Whether repeats differ under this scramble. A deterministic set has no variance.
    fn is_randomised(&self, scramble: Scramble) -> bool {
        self.facts().is_random || scramble != Scramble::None
    }
    /// Trials of `n` points that differ from one another: sets that are read, not made, run out.
    fn most_trials(&self, _n: u64, scramble: Scramble) -> u32 {
        if self.is_randomised(scramble) { u32::MAX } else { 1 }
    }
    /// Whether exactly `n` points exist in `dim` dimensions.
    fn admits(&self, n: u64, dim: usize, rectangular: bool) -> bool {
        self.facts().counts.admits(n, dim, rectangular)
    }
    /// The nearest admissible counts below and above an `n` that is not admissible.
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        self.facts().counts.neighbours(n, dim)
    }
    /// Strata along each of the `dim` axes for an admissible `n`; none for a sampler without a
    /// grid of strata.
    fn strata(&self, n: u64, dim: usize) -> Option<Vec<u64>> {
        (self.facts().counts == Admissible::Cells).then(|| strata_per_axis(n, dim))
    }
    /// How its unscrambled points in `dim` dimensions lie, for integrands that make the same
    /// points themselves.
    fn placement(&self, _dim: usize) -> Placement {
        Placement::Other
    }
    /// Makes the points of its own construction and of those scrambles that work on it.
    /// [`Sampler::points`] calls it with [`Scramble::None`] for those that work on any points.
    fn construct(&self, set: &PointSet) -> Box<dyn Points>;
    /// Makes the set ready. `set` has passed [`check`] and its N is admissible.
    fn points(&self, set: &PointSet) -> Box<dyn Points> {
        match set.scramble {
            Scramble::TorusShift | Scramble::Tent => {
                let constructed = self.construct(&PointSet { scramble: Scramble::None, ..*set });
                Box::new(Shifted::new(constructed, set, !self.facts().is_random))
            }
            _ => self.construct(set),
        }
    }
}

/// The most dimensions of any set.
pub const MAX_DIM: usize = 1 << 16;

/// The largest f64 below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A point set that is ready to be read from any index on.
pub trait Points {
    /// Overwrites `points`, row-major `[len, dim]`, with points `first .. first + len` of the
    /// set; every coordinate is in [0, 1).
    fn fill(&self, first: u64, points: &mut [f64]) {
        self.fill_with(Isa::detect(), first, points);
    }
    /// The same by an instruction set of choice: it changes no bit.
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]);
    /// The same points of a set in two dimensions as the beam takes them: each coordinate less
    /// 1/2, rounded to f32, in an array of its own for each axis.
    fn fill_centred(&self, isa: Isa, first: u64, [s, t]: [&mut [f32]; 2]) {
        let mut rows = [[0.0; 2]; BLOCK];
        let runs = s.chunks_mut(rows.len()).zip(t.chunks_mut(rows.len()));
        for (first, (s, t)) in (first..).step_by(rows.len()).zip(runs) {
            let rows = &mut rows[..s.len()];
            self.fill_with(isa, first, rows.as_flattened_mut());
            simd::run(isa, CentreLoop { rows, columns: [s, t] });
        }
    }
    /// Becomes the set of another stream, of a key that differs in the trial alone, in the room
    /// that it has. False, and nothing has changed, where it cannot.
    fn renew(&mut self, _stream: &Stream) -> bool {
        false
    }
}

struct CentreLoop<'a> {
    rows: &'a [[f64; 2]],
    columns: [&'a mut [f32]; 2],
}

impl Loop for CentreLoop<'_> {
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let [s, t] = self.columns;
        for (row, (s, t)) in self.rows.iter().zip(s.iter_mut().zip(t)) {
            [*s, *t] = row.map(centred);
        }
    }
}

/// The count a sampler uses when asked for `n` points under a policy.
///
/// # Errors
/// [`StudyError::CountNotAdmitted`] names the neighbours; [`StudyError::TooManyDimensions`],
/// [`StudyError::NoSets`].
pub fn count_used(
    sampler: &dyn Sampler,
    n: u64,
    dim: usize,
    policy: CountPolicy,
) -> Result<u64, StudyError> {
    let max_dim = sampler.facts().max_dim.min(MAX_DIM);
    if dim > max_dim {
        return Err(StudyError::TooManyDimensions { sampler: sampler.name(), dim, max_dim });
    }
    if sampler.admits(n, dim, policy == CountPolicy::Rect) {
        return Ok(n);
    }
    let (below, above) = sampler.neighbours(n, dim);
    if policy == CountPolicy::Snap {
        let nearest = match (below, above) {
            (Some(b), Some(a)) => Some(if n.abs_diff(b) <= n.abs_diff(a) { b } else { a }),
            (one, other) => one.or(other),
        };
        if let Some(nearest) = nearest {
            return Ok(nearest);
        }
    }
    let neighbours = match (below, above) {
        (Some(b), Some(a)) => format!("its neighbours are {b} and {a}"),
        (Some(one), None) | (None, Some(one)) => format!("the nearest is {one}"),
        (None, None) => return Err(StudyError::NoSets { sampler: sampler.name(), dim }),
    };
    Err(StudyError::CountNotAdmitted { sampler: sampler.name(), dim, n, neighbours })
}

/// Refuses a scramble that the sampler does not take.
///
/// # Errors
/// [`StudyError::ScrambleNotSupported`].
pub fn check_scramble(sampler: &dyn Sampler, scramble: Scramble) -> Result<(), StudyError> {
    if sampler.scrambles().contains(&scramble) {
        return Ok(());
    }
    let choices = names(sampler.scrambles().iter());
    Err(StudyError::ScrambleNotSupported { sampler: sampler.name(), scramble, choices })
}

/// Refuses a scramble that the sampler does not take, and a set whose repeats are identical.
///
/// # Errors
/// [`StudyError::ScrambleNotSupported`], [`StudyError::Deterministic`].
pub fn check(sampler: &dyn Sampler, scramble: Scramble) -> Result<(), StudyError> {
    check_scramble(sampler, scramble)?;
    if sampler.is_randomised(scramble) {
        return Ok(());
    }
    let choices = names(sampler.scrambles().iter().filter(|s| sampler.is_randomised(**s)));
    Err(StudyError::Deterministic { sampler: sampler.name(), choices })
}

fn names<'a>(scrambles: impl Iterator<Item = &'a Scramble>) -> String {
    scrambles.map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Refuses more trials of `n` points than there are different sets.
///
/// # Errors
/// [`StudyError::TooFewSets`].
pub fn check_trials(
    sampler: &dyn Sampler,
    scramble: Scramble,
    n: u64,
    trials: u32,
) -> Result<(), StudyError> {
    let sets = sampler.most_trials(n, scramble);
    if trials > sets {
        return Err(StudyError::TooFewSets { sampler: sampler.name(), n, sets, trials });
    }
    Ok(())
}

/// Trials of `n` points that differ by more than a torus shift, for what no such shift changes.
pub fn most_trials_but_for_shifts(sampler: &dyn Sampler, n: u64, scramble: Scramble) -> u32 {
    let moved = scramble == Scramble::TorusShift;
    sampler.most_trials(n, if moved { Scramble::None } else { scramble })
}

/// Most coordinates of a set that is held whole: two gibibytes.
pub const MAX_COORDINATES: u64 = 1 << 28;

/// Every point of a set, row-major `[N, dim]`. `set` has passed [`check_scramble`] and its N is
/// admissible.
///
/// # Errors
/// [`StudyError::TooManyCoordinates`], [`StudyError::Unaddressable`].
pub fn whole_set(sampler: &dyn Sampler, set: &PointSet) -> Result<Vec<f64>, StudyError> {
    let (n, dim) = (set.key.n_samples, set.dim);
    let coordinates = n.saturating_mul(dim as u64);
    if coordinates > MAX_COORDINATES {
        return Err(StudyError::TooManyCoordinates { n, dim, limit: MAX_COORDINATES });
    }
    set.key.check()?;
    let mut points = vec![0.0; coordinates as usize];
    sampler.points(set).fill(0, &mut points);
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn names_and_streams_are_unique() {
        let names: HashSet<_> = SHELF.iter().map(|s| s.name()).collect();
        let streams: HashSet<_> = SHELF.iter().map(|s| s.stream_id()).collect();
        assert_eq!(names.len(), SHELF.len());
        assert_eq!(streams.len(), SHELF.len());
    }

    /// What the beam is given are the points, whatever the way they are made in.
    #[test]
    fn centred_points_are_the_points() {
        for sampler in SHELF {
            let is_sought = ["annealed", "best-candidate", "poisson"].contains(&sampler.name());
            for &scramble in sampler.scrambles() {
                for asked in [1, 4, 13, 64, 200, 70_000] {
                    let Ok(n) = count_used(*sampler, asked, 2, CountPolicy::Snap) else { continue };
                    if is_sought && n > 64 {
                        continue;
                    }
                    let (pixel, stream) = ([7, 5], sampler.stream_id());
                    let key = StreamKey { seed: 3, pixel, sampler: stream, n_samples: n, trial: 2 };
                    let set = PointSet { key, dim: 2, scramble, rectangular: false };
                    let points = sampler.points(&set);
                    for first in [0, 1, 63, 64, n - 1] {
                        if first < n {
                            let len = (n - first).min(300) as usize;
                            same_when_centred(&*points, first, len, &format!("{set:?}"));
                        }
                    }
                }
            }
        }
    }

    /// A set of another trial made in its room has the same points as one made anew.
    #[test]
    fn renewed_sets_are_those_made_anew() {
        for sampler in SHELF {
            for &scramble in sampler.scrambles() {
                for (asked, dim) in [(1, 2), (13, 3), (64, 5), (200, 2), (70_000, 2)] {
                    let Ok(n) = count_used(*sampler, asked, dim, CountPolicy::Snap) else {
                        continue;
                    };
                    let (pixel, stream) = ([7, 5], sampler.stream_id());
                    let key = StreamKey { seed: 3, pixel, sampler: stream, n_samples: n, trial: 2 };
                    let set = PointSet { key, dim, scramble, rectangular: false };
                    let next = PointSet { key: StreamKey { trial: 300, ..key }, ..set };
                    if ["annealed", "best-candidate", "poisson"].contains(&sampler.name()) {
                        continue;
                    }
                    let mut points = sampler.points(&set);
                    if !points.renew(&next.key.stream()) {
                        continue;
                    }
                    let len = n.min(300) as usize;
                    let [mut renewed, mut anew] = [(); 2].map(|()| vec![f64::NAN; len * dim]);
                    points.fill(n - len as u64, &mut renewed);
                    sampler.points(&next).fill(n - len as u64, &mut anew);
                    assert_eq!(renewed, anew, "{set:?}");
                }
            }
        }
    }

    fn same_when_centred(points: &dyn Points, first: u64, len: usize, name: &str) {
        let mut rows = vec![[f64::NAN; 2]; len];
        points.fill_with(Isa::BASELINE, first, rows.as_flattened_mut());
        for isa in Isa::available() {
            let mut columns = [(); 2].map(|()| vec![f32::NAN; len]);
            let [s, t] = &mut columns;
            points.fill_centred(isa, first, [s, t]);
            for (axis, column) in columns.iter().enumerate() {
                for (at, x) in column.iter().enumerate() {
                    let expected = (rows[at][axis] - 0.5) as f32;
                    assert_eq!(x.to_bits(), expected.to_bits(), "{name}: {first} + {at}");
                }
            }
        }
    }

    #[test]
    fn an_impossible_count_names_its_neighbours() {
        let error = count_used(&Jittered, 5, 2, CountPolicy::Error).unwrap_err();
        assert!(error.to_string().contains("its neighbours are 4 and 9"), "{error}");
        assert_eq!(count_used(&Jittered, 5, 2, CountPolicy::Snap), Ok(4));
        assert_eq!(count_used(&Jittered, 5, 2, CountPolicy::Rect), Ok(5));
    }
}
