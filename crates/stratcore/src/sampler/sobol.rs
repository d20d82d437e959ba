//! Sobol' points with the direction numbers of Joe & Kuo.

use super::digital::{Columns, DigitalPoints};
use super::{Admissible, Facts, Kind, PointSet, Points, Sampler, Scramble};
use std::sync::OnceLock;

/// Sobol' sequence in up to 1,024 dimensions, from its first point on.
#[derive(Debug, Clone, Copy)]
pub struct Sobol;

impl Sampler for Sobol {
    fn facts(&self) -> Facts {
        Facts {
            name: "sobol",
            summary: "Sobol' sequence (Joe-Kuo directions); best at N = 2^m",
            source: "Sobol' 1967; Joe & Kuo 2008; scrambles: Owen 1995, Matousek 1998, Burley 2020",
            stream_id: 8,
            kind: Kind::Sequence,
            max_dim: DIMENSIONS,
            counts: Admissible::UpTo(MOST_POINTS),
            scrambles: &[
                Scramble::Owen,
                Scramble::OwenHash,
                Scramble::LmsShift,
                Scramble::XorShift,
                Scramble::TorusShift,
                Scramble::None,
            ],
            is_random: false,
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        Box::new(DigitalPoints::new(&sobol_matrices()[..set.dim], set))
    }
}

/// Points of a digital sequence: 2^32, the number of its columns.
pub(super) const MOST_POINTS: u64 = 1 << 32;

/// Dimensions that have direction numbers.
const DIMENSIONS: usize = 1024;

/// Generator matrices of all dimensions.
pub(super) fn sobol_matrices() -> &'static [Columns] {
    static MATRICES: OnceLock<Vec<Columns>> = OnceLock::new();
    MATRICES.get_or_init(|| {
        // The first dimension is the van der Corput sequence.
        let mut matrices = vec![std::array::from_fn(|c| 1 << c)];
        let table = include_str!("data/new-joe-kuo-6.1024.txt");
        let rows = table.lines().filter(|line| !line.starts_with('#'));
        matrices.extend(rows.map(|row| joe_kuo_row(row).map(u32::reverse_bits)));
        matrices
    })
}

/// Direction numbers of the row "d s a m_1 … m_s" as fractions of 32 bits: degree s and interior
/// coefficients a of the primitive polynomial, initial m (Joe & Kuo 2008, section 2).
fn joe_kuo_row(row: &str) -> [u32; 32] {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_matrix_is_invertible_at_every_size() {
        assert_eq!(sobol_matrices().len(), DIMENSIONS);
        for (dim, columns) in sobol_matrices().iter().enumerate() {
            // Upper triangular with a unit diagonal: the first 2^m points lie in 2^m cells.
            for (c, column) in columns.iter().enumerate() {
                assert_eq!(column.leading_zeros() as usize, 31 - c, "dimension {dim}");
            }
        }
    }
}
