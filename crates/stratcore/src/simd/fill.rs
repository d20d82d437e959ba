//! Plain loops, compiled once for each instruction set: samplers', set-up, sums.
//!
//! They are written once, on plain arrays; here the compiler makes vectors of them, under the
//! target features that the machine has. There is no other version: every operation is an
//! integer's or a single IEEE one, so all instruction sets give the same bits.

use super::{Isa, Kind};

/// Lanes of a block: samplers make so many points at a time. A multiple of every vector's
/// length, and small enough for the first-level cache.
pub(crate) const BLOCK: usize = 64;

/// A loop to be compiled for each instruction set.
pub(crate) trait Loop {
    /// The loop. It and what it calls must be `inline(always)`, or they are compiled without
    /// the instruction set. `FMA`: [`f64::mul_add`] is one instruction.
    fn run<const FMA: bool>(self);
}

/// Runs a loop in the form compiled for an instruction set.
pub(crate) fn run(isa: Isa, body: impl Loop) {
    match isa.0 {
        Kind::Baseline => body.run::<false>(),
        #[cfg(test)]
        Kind::Wide => body.run::<false>(),
        // SAFETY: `Kind::Avx2` is made by `Isa::available` alone, which saw the features.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => unsafe { run_avx2(body) },
        // SAFETY: `Kind::Avx512` likewise.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 => unsafe { run_avx512(body) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2(body: impl Loop) {
    body.run::<true>();
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,avx2,fma")]
fn run_avx512(body: impl Loop) {
    body.run::<true>();
}

/// Division by a whole number below 2^51, rounded as `/` rounds it, without the divider where
/// there is a fused multiply-add.
///
/// With y = 1/k rounded, q = a·y is within two units in the last place of a/k; r = a - q·k is
/// exact, and q + r·y rounded once is the quotient: a/k is no midpoint of two numbers and at
/// least 1/2k units away from the nearest one, a million times the error left in r·y (Markstein,
/// *Computation of Elementary Functions on the IBM RISC System/6000*, 1990).
#[derive(Clone, Copy)]
pub(crate) struct Divisor {
    k: f64,
    reciprocal: f64,
}

impl Divisor {
    pub(crate) fn new(k: u64) -> Self {
        debug_assert!(k < 1 << 51);
        Self { k: k as f64, reciprocal: 1.0 / k as f64 }
    }

    /// `a / k` for a ≥ 0 that is zero or at least 2^-900.
    #[inline(always)]
    pub(crate) fn divide<const FMA: bool>(self, a: f64) -> f64 {
        if FMA {
            let q = a * self.reciprocal;
            let r = (-q).mul_add(self.k, a);
            r.mul_add(self.reciprocal, q)
        } else {
            a / self.k
        }
    }

    /// Quotient and remainder of a whole number `index` < 2^50.
    #[inline(always)]
    pub(crate) fn div_rem<const FMA: bool>(self, index: f64) -> [f64; 2] {
        /// Added and taken away again, it rounds to a whole number.
        const ROUND: f64 = (3u64 << 51) as f64;
        // (index + 1/2)/k - 1/2 is at least 1/2k away from where rounding changes.
        let offset = 0.5 * self.reciprocal - 0.5;
        let centred = if FMA {
            index.mul_add(self.reciprocal, offset)
        } else {
            index * self.reciprocal + offset
        };
        let quotient = centred + ROUND - ROUND;
        [quotient, index - quotient * self.k]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Numerators of every size, and those nearest whole multiples, where rounding is closest.
    #[test]
    fn quotients_are_those_of_the_divider() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1996);
        for i in 0..200_000u64 {
            let k = (1u64 << (i % 50)) + rng.random_range(0..1u64 << (i % 50));
            let divisor = Divisor::new(k);
            let whole = k as f64 * rng.random_range(0..1u64 << 20) as f64;
            let spread = rng.random::<f64>() * 2f64.powi(-rng.random_range(0..60));
            for a in [whole + spread, whole.next_up(), whole.next_down().abs(), whole, spread] {
                let quotient = divisor.divide::<true>(a);
                assert_eq!(quotient.to_bits(), (a / k as f64).to_bits(), "{a} / {k}");
                assert_eq!(divisor.divide::<false>(a), quotient);
            }
        }
    }

    #[test]
    fn remainders_are_those_of_whole_numbers() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
        for i in 0..100_000u64 {
            let k = 1 + rng.random_range(0..1u64 << (i % 45));
            let divisor = Divisor::new(k);
            let index = rng.random_range(0..1u64 << (1 + i % 49));
            for index in [index, index / k * k, (index / k * k + k - 1).min((1 << 50) - 1)] {
                let expected = [index / k, index % k].map(|x| x as f64);
                assert_eq!(divisor.div_rem::<true>(index as f64), expected, "{index} / {k}");
                assert_eq!(divisor.div_rem::<false>(index as f64), expected, "{index} / {k}");
            }
        }
    }
}
