//! Keys and hashes for scrambles: SplitMix64, addressed.
//!
//! A stream has 64 bits for scrambles ([`Stream::scramble_bits`](crate::rng::Stream)). They
//! seed a tree of keys, one for each dimension, digit or table, and each key is a SplitMix64
//! generator whose numbers are read in any order.
//!
//! Source: Steele, Lea & Flood, *Fast Splittable Pseudorandom Number Generators*, OOPSLA 2014.

/// The generator's step, the odd integer nearest 2^64 / φ.
const GAMMA: u64 = 0x9E37_79B9_7F4A_7C15;

/// Number `index` of the SplitMix64 generator seeded by `key`.
#[inline(always)]
pub(super) fn splitmix(key: u64, index: u64) -> u64 {
    let mut z = key.wrapping_add(index.wrapping_add(1).wrapping_mul(GAMMA));
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A whole number below `n` from 64 random bits: off from uniform by at most n / 2^64.
#[inline(always)]
pub(super) fn below(n: u64, bits: u64) -> u64 {
    ((u128::from(bits) * u128::from(n)) >> 64) as u64
}

/// The fraction bits / 2^64 cut to 53 bits: never rounds up to 1.
#[inline(always)]
pub(super) fn unit(bits: u64) -> f64 {
    (bits >> 11) as f64 * 2f64.powi(-53)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_xoshiro::SplitMix64;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    #[test]
    fn numbers_are_those_of_the_sequential_generator() {
        for seed in [0, 1996, u64::MAX] {
            let mut sequential = SplitMix64::from_seed(seed.to_le_bytes());
            for index in 0..100 {
                assert_eq!(splitmix(seed, index), sequential.next_u64());
            }
        }
    }

    #[test]
    fn extremes_stay_in_range() {
        assert_eq!(unit(u64::MAX), 1.0 - f64::EPSILON / 2.0);
        assert_eq!(unit(0), 0.0);
        assert_eq!(below(7, u64::MAX), 6);
        assert_eq!(below(7, 0), 0);
    }
}
