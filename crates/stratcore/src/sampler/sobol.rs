//! Sobol' points with the direction numbers of Joe & Kuo, and digital sequences in general.

use super::hash::{splitmix, unit};
use super::owen::{NestedUniform, cell_centre, hash_reversed, levels};
use super::{Kind, PointSet, Points, Sampler, Scramble};
use std::sync::OnceLock;

/// Sobol' sequence in up to 1,024 dimensions, from its first point on.
#[derive(Debug, Clone, Copy)]
pub struct Sobol;

impl Sampler for Sobol {
    fn name(&self) -> &'static str {
        "sobol"
    }
    fn summary(&self) -> &'static str {
        "Sobol' sequence (Joe-Kuo directions); best at N = 2^m"
    }
    fn source(&self) -> &'static str {
        "Sobol' 1967; Joe & Kuo 2008; scrambles: Owen 1995, Matousek 1998, Burley 2020"
    }
    fn stream_id(&self) -> u8 {
        8
    }
    fn kind(&self) -> Kind {
        Kind::Sequence
    }
    fn max_dim(&self) -> usize {
        DIMENSIONS
    }
    fn scrambles(&self) -> &'static [Scramble] {
        &[
            Scramble::Owen,
            Scramble::OwenHash,
            Scramble::LmsShift,
            Scramble::XorShift,
            Scramble::TorusShift,
            Scramble::None,
        ]
    }
    fn is_randomised(&self, scramble: Scramble) -> bool {
        scramble != Scramble::None
    }
    fn admits(&self, n: u64, _dim: usize, _rectangular: bool) -> bool {
        (1..=MOST_POINTS).contains(&n)
    }
    fn neighbours(&self, n: u64, _dim: usize) -> (Option<u64>, Option<u64>) {
        digital_neighbours(n)
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        Box::new(DigitalPoints::new(&sobol_columns()[..set.dim], set))
    }
}

/// Points of a digital sequence: 2^32, the number of its columns.
pub(super) const MOST_POINTS: u64 = 1 << 32;

/// Neighbours of a count outside 1 ..= 2^32.
pub(super) fn digital_neighbours(n: u64) -> (Option<u64>, Option<u64>) {
    if n == 0 { (None, Some(1)) } else { (Some(MOST_POINTS), None) }
}

/// Generator matrix of one coordinate: column c is XORed into the coordinate, a fraction of 32
/// bits, where bit c of the index is set.
pub(super) type Columns = [u32; 32];

/// Dimensions that have direction numbers.
const DIMENSIONS: usize = 1024;

/// Generator matrices of all dimensions.
pub(super) fn sobol_columns() -> &'static [Columns] {
    static COLUMNS: OnceLock<Vec<Columns>> = OnceLock::new();
    COLUMNS.get_or_init(|| {
        // The first dimension is the van der Corput sequence.
        let mut columns = vec![std::array::from_fn(|c| 1 << (31 - c))];
        let table = include_str!("data/new-joe-kuo-6.1024.txt");
        columns.extend(table.lines().filter(|line| !line.starts_with('#')).map(joe_kuo_row));
        columns
    })
}

/// Columns of the row "d s a m_1 … m_s": degree s and interior coefficients a of the primitive
/// polynomial, initial m (Joe & Kuo 2008, section 2).
fn joe_kuo_row(row: &str) -> Columns {
    let mut numbers = row.split_ascii_whitespace().skip(1).map_while(|word| word.parse().ok());
    let degree = numbers.next().unwrap_or(0) as usize;
    let interior: u32 = numbers.next().unwrap_or(0);
    let mut columns = [0; 32];
    for (c, m) in numbers.take(degree).enumerate() {
        columns[c] = m << (31 - c);
    }
    for c in degree..32 {
        let oldest = columns[c - degree];
        columns[c] = oldest ^ oldest >> degree;
        for k in 1..degree {
            columns[c] ^= (interior >> (degree - 1 - k) & 1) * columns[c - k];
        }
    }
    columns
}

/// A digital sequence in base 2 under any of its scrambles.
pub(super) struct DigitalPoints {
    axes: Vec<Axis>,
    /// Key of the bits that truly scrambled points have of their own.
    own: u64,
}

/// One coordinate: how to make a block of values and what to do with each.
enum Axis {
    /// 64-bit columns and a shift: no scramble, XOR shift, linear scramble.
    Linear { columns: [u64; 32], shift: u64 },
    /// True Owen scrambling of the leading digits.
    Nested { columns: Columns, scramble: NestedUniform },
    /// Hashed Owen scrambling; the columns have their bits reversed.
    Hashed { columns: Columns, seed: u32 },
}

/// Points that share the high bits of their index are made together.
const BLOCK_BITS: u32 = 6;
const BLOCK: usize = 1 << BLOCK_BITS;

impl DigitalPoints {
    pub(super) fn new(matrices: &[Columns], set: &PointSet) -> Self {
        let bits = set.key.stream().scramble_bits();
        let n = set.key.n_samples;
        let levels = levels(n);
        let axis = |(axis, columns): (u64, &Columns)| {
            let key = splitmix(bits, axis);
            let wide = || columns.map(|c| u64::from(c) << 32);
            match set.scramble {
                Scramble::Owen => Axis::Nested {
                    columns: columns.map(|c| c >> (32 - levels)),
                    scramble: NestedUniform::new(key, levels, n, set.dim),
                },
                Scramble::OwenHash => {
                    Axis::Hashed { columns: columns.map(u32::reverse_bits), seed: key as u32 }
                }
                Scramble::LmsShift => {
                    Axis::Linear { columns: linear_scramble(columns, levels, key), shift: key }
                }
                Scramble::XorShift => Axis::Linear { columns: wide(), shift: key },
                _ => Axis::Linear { columns: wide(), shift: 0 },
            }
        };
        Self { axes: (0..).zip(matrices).map(axis).collect(), own: splitmix(bits, u64::MAX - 1) }
    }
}

/// The first `levels` columns times a random lower triangular matrix with a unit diagonal and
/// 64 rows (Matoušek 1998). Column c of that matrix, a word that begins with c zeros and a
/// one, takes the place of digit c.
fn linear_scramble(columns: &Columns, levels: u32, key: u64) -> [u64; 32] {
    let key = splitmix(key, 0);
    let lower: [u64; 32] = std::array::from_fn(|c| (splitmix(key, c as u64) | 1 << 63) >> c);
    let mut scrambled = [0; 32];
    for (scrambled, &column) in scrambled.iter_mut().zip(columns).take(levels as usize) {
        let mut digits = column;
        while digits != 0 {
            let row = digits.leading_zeros();
            *scrambled ^= lower[row as usize];
            digits ^= 1 << (31 - row);
        }
    }
    scrambled
}

/// Overwrites `values[..len]` with the XORs of the columns that the indices `first .. first +
/// len` select; `first` is a multiple of [`BLOCK`], `len` a power of two up to it.
#[inline(always)]
fn block<T>(values: &mut [T; BLOCK], len: usize, first: u64, origin: T, columns: &[T; 32])
where
    T: Copy + std::ops::BitXor<Output = T>,
{
    let mut value = origin;
    let mut high = first >> BLOCK_BITS;
    for &column in &columns[BLOCK_BITS as usize..] {
        if high == 0 {
            break;
        }
        if high & 1 == 1 {
            value = value ^ column;
        }
        high >>= 1;
    }
    values[0] = value;
    let mut made = 1;
    for &column in columns {
        if made == len {
            break;
        }
        let (old, new) = values.split_at_mut(made);
        for (new, old) in new.iter_mut().zip(old) {
            *new = *old ^ column;
        }
        made *= 2;
    }
}

/// Stages of one loop each, over whole blocks: the compiler makes vectors of them.
impl Axis {
    /// Coordinates of the block that starts at index `first`; `own` are the points' own bits.
    fn fill_block(&self, first: u64, len: usize, own: impl Fn(usize) -> u32) -> [f64; BLOCK] {
        match self {
            Self::Linear { columns, shift } => {
                let mut values = [0; BLOCK];
                block(&mut values, len, first, *shift, columns);
                values.map(unit)
            }
            Self::Nested { columns, scramble } => {
                let mut cells = [0; BLOCK];
                block(&mut cells, len, first, 0, columns);
                let mut coordinates = [0.0; BLOCK];
                for (i, x) in coordinates.iter_mut().enumerate().take(len) {
                    *x = unit(scramble.fraction(cells[i], own(i)));
                }
                coordinates
            }
            Self::Hashed { columns, seed } => {
                let mut values = [0; BLOCK];
                block(&mut values, len, first, 0, columns);
                for value in &mut values {
                    *value = hash_reversed(*value, *seed);
                }
                for value in &mut values {
                    *value = value.reverse_bits();
                }
                values.map(cell_centre)
            }
        }
    }
}

impl Points for DigitalPoints {
    fn fill(&self, first: u64, points: &mut [f64]) {
        let dim = self.axes.len();
        let end = first + (points.len() / dim) as u64;
        let mut block_start = first & !(BLOCK as u64 - 1);
        while block_start < end {
            let skipped = first.saturating_sub(block_start) as usize;
            let wanted = BLOCK.min((end - block_start) as usize);
            let len = wanted.next_power_of_two();
            let at = (block_start + skipped as u64 - first) as usize * dim;
            let run = &mut points[at..at + (wanted - skipped) * dim];
            for (pair, axes) in (0..).zip(self.axes.chunks(2)) {
                // One number has the own bits of two coordinates.
                let mut own = [0; BLOCK];
                if let Axis::Nested { .. } = axes[0] {
                    let key = splitmix(self.own, pair as u64);
                    for (index, own) in (block_start..).zip(&mut own[..len]) {
                        *own = splitmix(key, index);
                    }
                }
                for (half, axis) in axes.iter().enumerate() {
                    let own = |i: usize| (own[i] >> (32 * half)) as u32;
                    let coordinates = axis.fill_block(block_start, len, own);
                    for (point, x) in run.chunks_exact_mut(dim).zip(&coordinates[skipped..]) {
                        point[2 * pair + half] = *x;
                    }
                }
            }
            block_start += BLOCK as u64;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_matrix_is_invertible_at_every_size() {
        assert_eq!(sobol_columns().len(), DIMENSIONS);
        for (dim, columns) in sobol_columns().iter().enumerate() {
            // Upper triangular with a unit diagonal: the first 2^m points lie in 2^m cells.
            for (c, column) in columns.iter().enumerate() {
                assert_eq!(column.trailing_zeros() as usize, 31 - c, "dimension {dim}");
            }
        }
    }

    #[test]
    fn a_linear_scramble_keeps_the_leading_digit() {
        for (c, column) in linear_scramble(&sobol_columns()[5], 32, 9).iter().enumerate() {
            assert_eq!(column.leading_zeros(), sobol_columns()[5][c].leading_zeros(), "column {c}");
        }
    }
}
