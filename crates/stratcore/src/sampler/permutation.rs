//! Random permutations with random access.

use super::hash::{below, splitmix, whole};

/// A random permutation of 0 .. n.
///
/// Up to [`Permutation::SHUFFLED`] numbers it is a table, shuffled by Durstenfeld's version of
/// Fisher and Yates: uniform over all n! permutations. Above, it is a Feistel network on the
/// pair (i mod a, i div a) of residues, with cycle walking (Black & Rogaway, *Ciphers with
/// Arbitrary Finite Domains*, CT-RSA 2002): no memory, any order of reading.
pub(super) enum Permutation {
    Shuffled(Vec<u32>),
    Feistel { n: u64, a: u64, rounds: [u64; 4] },
}

impl Permutation {
    /// Numbers that are shuffled in memory: a quarter of a megabyte.
    const SHUFFLED: u64 = 1 << 16;

    /// The permutation of 0 .. `n` named by `key`; `n` is at most 2^44.
    pub(super) fn new(n: u64, key: u64) -> Self {
        if n <= Self::SHUFFLED {
            let mut made = Self::Shuffled(vec![0; n as usize]);
            made.renew(key);
            made
        } else {
            // a^2 >= n, so that both residues run over 0 .. a.
            let mut a = (n as f64).sqrt() as u64;
            a += u64::from(a * a < n);
            a += u64::from(a * a < n);
            Self::Feistel { n, a, rounds: std::array::from_fn(|r| splitmix(key, r as u64)) }
        }
    }

    /// Becomes the one named by another key.
    pub(super) fn renew(&mut self, key: u64) {
        match self {
            Self::Shuffled(table) => {
                for (i, entry) in (0..).zip(table.iter_mut()) {
                    *entry = i;
                }
                for i in (1..table.len()).rev() {
                    let j = below(i as u64 + 1, splitmix(key, i as u64));
                    table.swap(i, j as usize);
                }
            }
            Self::Feistel { rounds, .. } => {
                *rounds = std::array::from_fn(|r| splitmix(key, r as u64));
            }
        }
    }

    /// Where `i` goes, for `i` below n.
    #[inline(always)]
    pub(super) fn get(&self, i: u64) -> u64 {
        match self {
            Self::Shuffled(table) => u64::from(table[i as usize]),
            Self::Feistel { n, a, rounds } => walk(i, *n, *a, rounds),
        }
    }

    /// Overwrites `images` with where `first` and the numbers after it go.
    #[inline(always)]
    pub(super) fn list(&self, first: u64, images: &mut [f64]) {
        match self {
            Self::Shuffled(table) => {
                for (image, entry) in images.iter_mut().zip(&table[first as usize..]) {
                    *image = (*entry).into();
                }
            }
            Self::Feistel { .. } => {
                for (i, image) in (first..).zip(images) {
                    *image = whole(self.get(i));
                }
            }
        }
    }
}

/// Follows the cycle of the network over a^2 numbers until it is back below n: at most one
/// step in sqrt(n) leaves.
fn walk(mut i: u64, n: u64, a: u64, rounds: &[u64; 4]) -> u64 {
    loop {
        let (mut left, mut right) = (i % a, i / a);
        for key in rounds {
            let sum = left + below(a, splitmix(*key, right));
            (left, right) = (right, if sum >= a { sum - a } else { sum });
        }
        i = left + a * right;
        if i < n {
            return i;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_met_once() {
        for n in [1, 2, 3, 100, (1 << 16), (1 << 16) + 1, 70_000, 300_007] {
            let permutation = Permutation::new(n, 42);
            let mut seen = vec![false; n as usize];
            for i in 0..n {
                let image = permutation.get(i) as usize;
                assert!(!std::mem::replace(&mut seen[image], true), "{n}: {i}");
            }
        }
    }

    #[test]
    fn the_largest_counts_are_permuted() {
        for n in [(1u64 << 32) - 1, 1 << 32, (1 << 44) - 1] {
            let permutation = Permutation::new(n, 7);
            let mut images: Vec<_> =
                (0..1000).chain(n - 1000..n).map(|i| permutation.get(i)).collect();
            assert!(images.iter().all(|i| *i < n));
            images.sort_unstable();
            images.dedup();
            assert_eq!(images.len(), 2000);
        }
    }

    /// Chi-square over the 24 permutations of four: 23 degrees of freedom, mean 23, standard
    /// deviation 6.8. P(> 70) is 10^-6.
    #[test]
    fn small_permutations_are_equally_likely() {
        let mut counts = std::collections::HashMap::new();
        for key in 0..24_000 {
            let permutation = Permutation::new(4, splitmix(1996, key));
            *counts.entry([0, 1, 2, 3].map(|i| permutation.get(i))).or_insert(0.0) += 1.0;
        }
        assert_eq!(counts.len(), 24);
        let chi: f64 = counts.values().map(|c: &f64| (c - 1000.0).powi(2) / 1000.0).sum();
        assert!(chi < 70.0, "{chi}");
    }

    /// Above the table, too, images are uncorrelated with their arguments and neighbours:
    /// correlations of k pairs have standard deviation 1 / sqrt(k); the bound is five.
    #[test]
    fn large_permutations_are_uncorrelated() {
        let n = 1_000_003u64;
        let k = 100_000u64;
        let uniform = |i: u64| i as f64 / n as f64 - 0.5;
        let mut sums = [0.0; 3];
        for i in 0..k {
            let permutation = Permutation::new(n, splitmix(5, i / 1000));
            let at = (i * 7919) % (n - 1);
            let [x, y] = [at, at + 1].map(|j| uniform(permutation.get(j)));
            let z = uniform(at);
            sums[0] += 12.0 * x * z;
            sums[1] += 12.0 * x * y;
            sums[2] += (12.0 * x * x - 1.0) / 0.8f64.sqrt();
        }
        for sum in sums {
            assert!(sum.abs() < 5.0 * (k as f64).sqrt(), "{sums:?}");
        }
    }
}
