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
    mix(state(key, index))
}

/// The generator's numbers from some number on, one after the other.
pub(super) struct SplitMix(u64);

impl SplitMix {
    /// From number `first` on.
    #[inline(always)]
    pub(super) fn new(key: u64, first: u64) -> Self {
        Self(state(key, first))
    }

    #[inline(always)]
    pub(super) fn draw(&mut self) -> u64 {
        let number = mix(self.0);
        self.0 = self.0.wrapping_add(GAMMA);
        number
    }
}

#[inline(always)]
fn state(key: u64, index: u64) -> u64 {
    key.wrapping_add(index.wrapping_add(1).wrapping_mul(GAMMA))
}

#[inline(always)]
fn mix(mut z: u64) -> u64 {
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
    /// 2^-53
    const LAST: u64 = (1023 - 53) << 52;
    // Not by conversion, for which AVX2 has no instruction: the first 52 bits are those of a
    // number in [1, 2).
    let first = f64::from_bits(0x3ff << 52 | bits >> 12) - 1.0;
    first + f64::from_bits(0u64.wrapping_sub(bits >> 11 & 1) & LAST)
}

/// A whole number below 2^52, likewise.
#[inline(always)]
pub(super) fn whole(number: u64) -> f64 {
    f64::from_bits(0x433 << 52 | number) - (1u64 << 52) as f64
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
                let next = sequential.next_u64();
                assert_eq!(splitmix(seed, index), next);
                let mut run = SplitMix::new(seed, index.wrapping_sub(1));
                run.draw();
                assert_eq!(run.draw(), next);
            }
        }
    }

    #[test]
    fn numbers_are_those_of_conversions() {
        let words = (0..100_000).map(|i| splitmix(5, i) >> (i % 64));
        for bits in words.chain((0..64).flat_map(|i| [1 << i, u64::MAX >> i, u64::MAX << i])) {
            assert_eq!(unit(bits), (bits >> 11) as f64 * 2f64.powi(-53), "{bits:x}");
            assert_eq!(whole(bits >> 12), (bits >> 12) as f64, "{bits:x}");
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
