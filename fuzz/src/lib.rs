//! What has to survive any bytes: one function for each kind of input.
//!
//! A function takes bytes as they come. It panics where strat breaks its word: a parser that
//! panics, an error that is more than one line, a number that cannot be, two instruction sets
//! that differ. `tests/hostile` runs these on the corpus and its mutations; cargo-fuzz looks for
//! more, guided by coverage (README.md).

mod points;
mod result;
mod scene;
pub mod seeds;
mod simd;
mod tiles;
mod words;

/// An input that strat reads, by the name of its corpus, and what has to survive it.
pub type Target = (&'static str, fn(&[u8]));

/// Every input that strat reads.
pub const TARGETS: &[Target] = &[
    ("scene", scene::toml),
    ("obj", scene::obj),
    ("points", points::file),
    ("words", words::words),
    ("arguments", words::arguments),
    ("study", words::study_file),
    ("tiles", tiles::raw),
    ("frames", tiles::frames),
    ("result", result::summary),
    ("simd", simd::points_and_beams),
];

/// Between the parts of an input that is several files.
const NEXT_FILE: &[u8] = b"\n===\n";

/// The files of an input; those that are missing are empty.
fn files<const N: usize>(data: &[u8]) -> [&[u8]; N] {
    let mut rest = data;
    std::array::from_fn(|_| {
        let end = rest.windows(NEXT_FILE.len()).position(|part| part == NEXT_FILE);
        let (file, after) = match end {
            Some(end) => (&rest[..end], &rest[end + NEXT_FILE.len()..]),
            None => (rest, &rest[rest.len()..]),
        };
        rest = after;
        file
    })
}

/// Every error is a line that says something.
fn says_one_line(error: &str) {
    assert!(!error.trim().is_empty() && !error.contains('\n'), "{error:?}");
}
