//! The (0,2)-sequence of the first two Sobol' dimensions, point by point.

use super::Scramble;
use super::hash::{splitmix, unit};
use super::owen::{NestedUniform, cell_centre, hash_reversed};

/// Both coordinates of a point, as 32 digits with the leading one lowest.
///
/// The first matrix mirrors the index. The second is Pascal's triangle modulo 2: digit i is
/// the sum of index bits j with C(j, i) odd, which are the j whose bits contain those of i
/// (Lucas). Five steps add up all supersets. For bits j ≥ 32 of the index the first 32 digits
/// are those of bit j - 32.
#[inline(always)]
fn mirrored_point(index: u64) -> [u32; 2] {
    let mut sums = index as u32 ^ (index >> 32) as u32;
    sums ^= sums >> 1 & 0x5555_5555;
    sums ^= sums >> 2 & 0x3333_3333;
    sums ^= sums >> 4 & 0x0f0f_0f0f;
    sums ^= sums >> 8 & 0x00ff_00ff;
    sums ^= sums >> 16 & 0x0000_ffff;
    [index as u32, sums]
}

/// A scrambled (0,2)-sequence.
pub(super) enum ZeroTwo {
    /// XORed with two words; none for zeros.
    Xor([u64; 2]),
    /// Truly scrambled in as many digits as `levels` says; `own` is the key of the points' own
    /// bits.
    Nested { axes: [NestedUniform; 2], levels: u32, own: u64 },
    /// Hashed.
    Hashed([u32; 2]),
}

impl ZeroTwo {
    /// The sequence scrambled by `key`, for `n` points of a set in `dim` dimensions. True
    /// scrambling works on `levels` digits, which must tell the points apart.
    pub(super) fn new(scramble: Scramble, key: u64, levels: u32, n: u64, dim: usize) -> Self {
        let keys = [splitmix(key, 0), splitmix(key, 1)];
        match scramble {
            Scramble::Owen => Self::Nested {
                axes: keys.map(|key| NestedUniform::new(key, levels, n, dim)),
                levels,
                own: splitmix(key, 2),
            },
            Scramble::OwenHash => Self::Hashed(keys.map(|key| key as u32)),
            Scramble::XorShift => Self::Xor(keys),
            _ => Self::Xor([0, 0]),
        }
    }

    /// The point of this index.
    #[inline(always)]
    pub(super) fn point(&self, index: u64) -> [f64; 2] {
        let [x, y] = mirrored_point(index);
        match self {
            Self::Xor([a, b]) => [(x, a), (y, b)]
                .map(|(digits, shift)| unit(u64::from(digits.reverse_bits()) << 32 ^ shift)),
            Self::Nested { axes: [a, b], levels, own } => {
                let own = splitmix(*own, index);
                [(x, a, own as u32), (y, b, (own >> 32) as u32)].map(|(digits, scramble, own)| {
                    unit(scramble.fraction(digits.reverse_bits() >> (32 - levels), own))
                })
            }
            Self::Hashed([a, b]) => [(x, a), (y, b)]
                .map(|(digits, seed)| cell_centre(hash_reversed(digits, *seed).reverse_bits())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sobol::sobol_columns;
    use super::*;

    #[test]
    fn points_are_those_of_the_direction_numbers() {
        for i in 0..1000 {
            let index = splitmix(1, i) as u32;
            let by_columns = [0, 1].map(|dim| {
                (0..32)
                    .filter(|bit| index >> bit & 1 == 1)
                    .fold(0, |x, bit| x ^ sobol_columns()[dim][bit])
            });
            assert_eq!(mirrored_point(index.into()).map(u32::reverse_bits), by_columns);
        }
    }
}
