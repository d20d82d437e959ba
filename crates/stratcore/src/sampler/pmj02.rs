//! Progressive multi-jittered (0,2)-sequences.

use super::digital::{Columns, DigitalPoints};
use super::sobol::MOST_POINTS;
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};

/// Progressive multi-jittered (0,2) points: every prefix of 2^m points is stratified in all
/// elementary intervals.
///
/// Christensen, Kensler & Kilpatrick draw them by search. Helmer, Christensen & Kensler
/// (*Stochastic Generation of (t,s) Sample Sequences*, 2021, and its supplement) found that
/// they are the Owen scramblings of one digital sequence, whose matrices are the Stirling
/// numbers of the first kind modulo 2; so they are drawn here.
#[derive(Debug, Clone, Copy)]
pub struct Pmj02;

impl Sampler for Pmj02 {
    fn facts(&self) -> Facts {
        Facts {
            name: "pmj02",
            summary: "progressive multi-jittered (0,2)-sequence; best at N = 2^m",
            source: "Christensen, Kensler & Kilpatrick 2018; Helmer, Christensen & Kensler 2021",
            stream_id: 10,
            kind: Kind::Sequence,
            max_dim: 2,
            counts: Admissible::UpTo(MOST_POINTS),
            scrambles: &[Scramble::None, Scramble::TorusShift],
            is_random: true,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        // The scrambling is the construction itself.
        let scrambled = PointSet { scramble: Scramble::Owen, ..*set };
        Box::new(DigitalPoints::new(&MATRICES[..set.dim], &scrambled))
    }
}

static MATRICES: [Columns; 2] = [stirling_columns(0), stirling_columns(1)];

/// Column c has s(c + offset, k + offset) modulo 2 as digit k.
const fn stirling_columns(offset: usize) -> Columns {
    let mut columns = [0; 32];
    // Bit k is s(n, k) modulo 2; s(n + 1, k) = s(n, k - 1) + n s(n, k).
    let mut row = 1u64;
    let mut n = 0;
    while n < 32 + offset {
        if n >= offset {
            columns[n - offset] = (row >> offset) as u32;
        }
        row = row << 1 ^ if n % 2 == 1 { row } else { 0 };
        n += 1;
    }
    columns
}
