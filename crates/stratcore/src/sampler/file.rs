//! Point sets from a file: bring your own.

use super::patterns::StoredPoints;
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::input;
use std::path::Path;
use std::sync::Arc;

/// The point sets of a file, one for each trial: trial t takes set t of those that have N
/// points. Under a torus shift, which each trial draws anew, sets may serve more than once.
///
/// Read are CSV and text, one point a line, numbers separated by commas, semicolons or blanks,
/// sets by lines that begin with `#` (as UTK writes them), a line of words at the top ignored;
/// and UTK's binary files.
#[derive(Debug)]
pub struct PointFile {
    name: &'static str,
    dim: usize,
    sets: Vec<Arc<[f64]>>,
}

/// A point file that cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("cannot use the point file {path}: {fault}")]
pub struct PointFileError {
    /// The file as named.
    pub path: String,
    /// What is wrong with it.
    pub fault: PointFileFault,
}

/// What is wrong with a point file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PointFileFault {
    /// The system cannot read it.
    #[error("{0}")]
    Unreadable(String),
    /// It has no point.
    #[error("it has no points")]
    Empty,
    /// A line is not all numbers.
    #[error("line {line}: \"{text}\" is not a number")]
    NotANumber {
        /// Line, from 1.
        line: usize,
        /// The word.
        text: String,
    },
    /// A line has more or fewer numbers than those before.
    #[error("line {line} has {found} coordinates, the lines before have {expected}")]
    Ragged {
        /// Line, from 1.
        line: usize,
        /// Coordinates there.
        found: usize,
        /// Coordinates before.
        expected: usize,
    },
    /// A coordinate outside the unit interval.
    #[error("set {set}, point {point} has the coordinate {value}, outside [0, 1)")]
    Outside {
        /// Set, from 1.
        set: usize,
        /// Point, from 1.
        point: usize,
        /// The coordinate.
        value: f64,
    },
    /// A binary file whose size does not fit its head.
    #[error("its head promises {promised} bytes, it has {found}; it may be cut off")]
    WrongSize {
        /// Bytes by the head.
        promised: u128,
        /// Bytes there are.
        found: usize,
    },
    /// A binary file of integers or of an unknown type.
    #[error("its data type is number {0}; only 4 (float) and 5 (double) are coordinates")]
    WrongType(u8),
    /// Two sets are the same: as trials they would be one.
    #[error(
        "sets {first} and {second} are identical, so their trials would be; some versions of \
         UTK write the first set over and over: write the sets as text"
    )]
    SameSet {
        /// Set, from 1.
        first: usize,
        /// Set, from 1.
        second: usize,
    },
}

impl PointFile {
    /// Reads a file. It is kept for the life of the process, as every sampler is: a study names
    /// few files, and plans and results hold samplers and their names by plain reference.
    ///
    /// # Errors
    /// [`PointFileError`].
    pub fn load(path: &str) -> Result<&'static Self, PointFileError> {
        let unreadable = |error: std::io::Error| PointFileError {
            path: path.to_owned(),
            fault: PointFileFault::Unreadable(error.to_string()),
        };
        let bytes = input::read(Path::new(path), input::MAX_DATA).map_err(unreadable)?;
        Ok(Box::leak(Box::new(Self::parse(path, &bytes)?)))
    }

    /// Reads the content of the file named `path`; only its name, `file:path`, is kept for the
    /// life of the process.
    ///
    /// # Errors
    /// [`PointFileError`].
    pub fn parse(path: &str, bytes: &[u8]) -> Result<Self, PointFileError> {
        let sets = if bytes.starts_with(UTK_MAGIC) { read_utk(bytes) } else { read_text(bytes) };
        let checked = sets.and_then(|(dim, sets)| check(dim, &sets).map(|()| (dim, sets)));
        match checked {
            Ok((dim, sets)) => {
                let sets = sets.into_iter().map(Arc::from).collect();
                Ok(Self { name: format!("file:{path}").leak(), dim, sets })
            }
            Err(fault) => Err(PointFileError { path: path.to_owned(), fault }),
        }
    }

    /// All sets, each row-major `[N, dim]`; dim is [`Facts::max_dim`](super::Facts::max_dim).
    pub fn sets(&self) -> impl Iterator<Item = &[f64]> {
        self.sets.iter().map(AsRef::as_ref)
    }

    fn sets_of(&self, n: u64) -> impl Iterator<Item = &Arc<[f64]>> {
        self.sets.iter().filter(move |set| (set.len() / self.dim) as u64 == n)
    }

    /// The different N of its sets, in ascending order.
    pub fn counts(&self) -> Vec<u64> {
        let mut counts: Vec<_> =
            self.sets.iter().map(|set| (set.len() / self.dim) as u64).collect();
        counts.sort_unstable();
        counts.dedup();
        counts
    }
}

type Sets = (usize, Vec<Vec<f64>>);

fn check(dim: usize, sets: &[Vec<f64>]) -> Result<(), PointFileFault> {
    if sets.is_empty() {
        return Err(PointFileFault::Empty);
    }
    for (set, points) in (1..).zip(sets) {
        if let Some(at) = points.iter().position(|x| !(0.0..1.0).contains(x)) {
            return Err(PointFileFault::Outside { set, point: at / dim + 1, value: points[at] });
        }
    }
    let mut order: Vec<_> = (0..sets.len()).collect();
    // Coordinates are finite by now: the order is total.
    order.sort_by(|a, b| sets[*a].partial_cmp(&sets[*b]).unwrap_or(std::cmp::Ordering::Equal));
    match order.windows(2).find(|pair| sets[pair[0]] == sets[pair[1]]) {
        Some(pair) => Err(PointFileFault::SameSet { first: pair[0] + 1, second: pair[1] + 1 }),
        None => Ok(()),
    }
}

fn read_text(bytes: &[u8]) -> Result<Sets, PointFileFault> {
    let text = String::from_utf8_lossy(bytes);
    let mut dim = 0;
    let mut sets = vec![Vec::new()];
    let mut at_top = true;
    for (line, row) in (1..).zip(text.lines()) {
        let row = row.trim_matches(['\u{feff}', ' ', '\t']);
        if row.starts_with('#') {
            sets.push(Vec::new());
            continue;
        }
        let words: Vec<_> = row
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|word| !word.is_empty())
            .collect();
        let numbers: Vec<Option<f64>> = words.iter().map(|word| word.parse().ok()).collect();
        if words.is_empty() || at_top && numbers.iter().all(Option::is_none) {
            at_top &= words.is_empty();
            continue;
        }
        at_top = false;
        if let Some(at) = numbers.iter().position(Option::is_none) {
            return Err(PointFileFault::NotANumber { line, text: words[at].to_owned() });
        }
        if dim == 0 {
            dim = numbers.len();
        }
        if numbers.len() != dim {
            return Err(PointFileFault::Ragged { line, found: numbers.len(), expected: dim });
        }
        if let Some(set) = sets.last_mut() {
            set.extend(numbers.into_iter().flatten());
        }
    }
    sets.retain(|set| !set.is_empty());
    Ok((dim, sets))
}

/// "UTK!", type and three reserved bytes, then the numbers of sets, points and dimensions, all
/// little-endian.
const UTK_MAGIC: &[u8] = b"UTK!";

fn read_utk(bytes: &[u8]) -> Result<Sets, PointFileFault> {
    const HEAD: usize = 20;
    let wrong_size = |promised| PointFileFault::WrongSize { promised, found: bytes.len() };
    let Some((head, data)) = bytes.split_at_checked(HEAD) else {
        return Err(wrong_size(HEAD as u128));
    };
    let word = |at: usize| u32::from_le_bytes(std::array::from_fn(|i| head[at + i])) as usize;
    let (sets, points, dim) = (word(8), word(12), word(16));
    let width = match head[4] {
        4 => 4,
        5 => 8,
        other => return Err(PointFileFault::WrongType(other)),
    };
    let promised = [sets, points, dim, width].iter().map(|x| *x as u128).product::<u128>();
    if promised != data.len() as u128 {
        return Err(wrong_size(HEAD as u128 + promised));
    }
    if promised == 0 {
        return Err(PointFileFault::Empty);
    }
    let single = |b: &[u8]| f64::from(f32::from_le_bytes(std::array::from_fn(|i| b[i])));
    let double = |b: &[u8]| f64::from_le_bytes(std::array::from_fn(|i| b[i]));
    let coordinates: Vec<f64> = match width {
        4 => data.chunks_exact(4).map(single).collect(),
        _ => data.chunks_exact(8).map(double).collect(),
    };
    Ok((dim, coordinates.chunks_exact(points * dim).map(<[f64]>::to_vec).collect()))
}

impl Sampler for PointFile {
    fn facts(&self) -> Facts {
        Facts {
            name: self.name,
            summary: "point sets of a file: CSV, or UTK text and binary",
            source: "the file",
            stream_id: 17,
            kind: Kind::Set,
            max_dim: self.dim,
            counts: Admissible::Rule("those of its sets"),
            scrambles: match self.sets.len() {
                1 => &[Scramble::TorusShift, Scramble::None],
                _ => &[Scramble::None, Scramble::TorusShift],
            },
            is_random: self.sets.len() > 1,
        }
    }
    fn most_trials(&self, n: u64, scramble: Scramble) -> u32 {
        match scramble {
            Scramble::None => u32::try_from(self.sets_of(n).count()).unwrap_or(u32::MAX),
            _ => u32::MAX,
        }
    }
    fn admits(&self, n: u64, _dim: usize, _rectangular: bool) -> bool {
        self.counts().contains(&n)
    }
    fn neighbours(&self, n: u64, _dim: usize) -> (Option<u64>, Option<u64>) {
        let counts = self.counts();
        let below = counts.iter().rfind(|count| **count < n);
        (below.copied(), counts.iter().find(|count| **count > n).copied())
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        let n = set.key.n_samples;
        let turn = set.key.trial as usize % self.sets_of(n).count().max(1);
        let stored = self.sets_of(n).nth(turn).map_or_else(|| Arc::from([]), Arc::clone);
        let points = match set.dim {
            all if all == self.dim => stored,
            // The first coordinates of points in more dimensions.
            few => stored.chunks_exact(self.dim).flat_map(|p| &p[..few]).copied().collect(),
        };
        Box::new(StoredPoints { points, dim: set.dim })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::StreamKey;

    fn utk(kind: u8, sets: u32, points: u32, dim: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"UTK!".to_vec();
        bytes.extend([kind, 0, 0, 0]);
        for word in [sets, points, dim] {
            bytes.extend(word.to_le_bytes());
        }
        bytes.extend(data);
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Vec<Vec<f64>>, String> {
        PointFile::parse("p", bytes)
            .map(|file| file.sets().map(<[f64]>::to_vec).collect())
            .map_err(|error| error.to_string())
    }

    #[test]
    fn every_text_form_is_read() {
        let two = vec![vec![0.25, 0.5, 0.75, 0.0], vec![0.125, 1e-3]];
        for text in [
            "0.25 0.5\n0.75 0\n#\n0.125 1e-3\n",
            "0.25,0.5\n0.75,0\n# set 2\n0.125,0.001",
            "# a comment\nx,y\n0.25; 0.5\n\n.75; 0.\r\n#\n0.125\t0.001\n#\n",
        ] {
            assert_eq!(read(text.as_bytes()), Ok(two.clone()), "{text}");
        }
    }

    #[test]
    fn binary_sets_keep_their_order() {
        let values = [0.0, 0.5, 0.25, 0.75, 0.125, 0.625];
        let doubles: Vec<u8> = values.iter().flat_map(|x: &f64| x.to_le_bytes()).collect();
        let singles: Vec<u8> = values.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
        let sets: Vec<_> = values.chunks(2).map(<[f64]>::to_vec).collect();
        assert_eq!(read(&utk(5, 3, 1, 2, &doubles)), Ok(sets.clone()));
        assert_eq!(read(&utk(4, 3, 1, 2, &singles)), Ok(sets));
    }

    #[test]
    fn faults_are_named() {
        let data = 0.5f64.to_le_bytes();
        for (bytes, words) in [
            (b"".to_vec(), "no points"),
            (b"x y\n".to_vec(), "no points"),
            (b"0.5 0.5\n0.5 y\n".to_vec(), "line 2: \"y\""),
            (b"0.5 y\n".to_vec(), "line 1: \"y\""),
            (b"0.5 0.5\n0.5\n".to_vec(), "line 2 has 1 coordinates"),
            (b"0.5\n1.0\n".to_vec(), "set 1, point 2 has the coordinate 1"),
            (b"0.5\n#\nNaN\n".to_vec(), "set 2, point 1 has the coordinate NaN"),
            (b"0.5 0.2\n0.5 -0.1\n".to_vec(), "coordinate -0.1"),
            (b"\xff\xfe\n0.5\n\xff\n".to_vec(), "line 3"),
            (b"UTK!".to_vec(), "promises 20 bytes, it has 4"),
            (utk(5, 1, 2, 1, &data), "promises 36 bytes, it has 28"),
            (utk(5, u32::MAX, u32::MAX, u32::MAX, &data), "cut off"),
            (utk(5, 0, 1, 1, &[]), "no points"),
            (utk(0, 1, 1, 1, &data), "data type is number 0"),
            (utk(5, 2, 1, 1, &[data, data].concat()), "sets 1 and 2 are identical"),
        ] {
            let error = read(&bytes).unwrap_err();
            assert!(error.contains("point file p") && error.contains(words), "{error}");
        }
        let error = PointFile::load("/no/such/file").unwrap_err().to_string();
        assert!(error.contains("/no/such/file"), "{error}");
    }

    #[test]
    fn trial_t_takes_set_t() {
        let text = "0.1 0.2\n#\n0.3 0.4\n#\n0.5 0.6\n0.7 0.8\n#\n0.9 0.95\n";
        let file = PointFile::parse("p", text.as_bytes()).unwrap();
        assert_eq!(
            (file.most_trials(1, Scramble::None), file.most_trials(2, Scramble::None)),
            (3, 1)
        );
        assert!(file.admits(2, 2, false) && !file.admits(3, 2, false));
        assert_eq!(file.neighbours(5, 2), (Some(2), None));
        assert_eq!(file.counts(), [1, 2]);
        for (trial, expected) in
            [(0, [0.1, 0.2]), (1, [0.3, 0.4]), (2, [0.9, 0.95]), (3, [0.1, 0.2])]
        {
            let key = StreamKey { seed: 1, pixel: [0, 0], sampler: 17, n_samples: 1, trial };
            for dim in [1, 2] {
                let set = PointSet { key, dim, scramble: Scramble::None, rectangular: false };
                let mut point = vec![0.0; dim];
                file.points(&set).fill(0, &mut point);
                assert_eq!(point, expected[..dim]);
            }
        }
    }
}
