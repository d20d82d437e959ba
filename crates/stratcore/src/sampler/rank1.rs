//! Rank-1 lattices.

use super::memo::Memo;
use super::{Admissible, BELOW_ONE, Facts, Kind, PointSet, Points, Sampler, Scramble};
use crate::rng::Stream;
use crate::simd::Isa;
use std::f64::consts::PI;
use std::sync::Arc;

/// Multiples i/N of an integer vector z modulo 1.
///
/// In two dimensions z = (1, a) with the a nearest N/φ that has no factor in common with N: the
/// Fibonacci lattice where N is a Fibonacci number. Above, Korobov's z = (1, a, a², …) modulo
/// N; a is the best, in the worst-case error P₂ of smooth periodic integrands, of all residues
/// or of as many as are tried within 2^24 kernel evaluations. It is sought once for each N and
/// dimension.
#[derive(Debug, Clone, Copy)]
pub struct RankOne;

/// The largest N in more than two dimensions, where z has to be sought.
const MOST_SOUGHT: u64 = 1 << 20;
/// The largest N at all: products of residues fit 64 bits.
const MOST: u64 = 1 << 32;

impl Sampler for RankOne {
    fn facts(&self) -> Facts {
        Facts {
            name: "rank1",
            summary: "rank-1 lattice: Fibonacci in 2-D, Korobov above",
            source: "Korobov 1959; Sloan & Joe 1994; tent: Hickernell 2002",
            stream_id: 11,
            kind: Kind::Set,
            max_dim: 64,
            counts: Admissible::Rule("1 to 2^32; in more than two dimensions 1 to 2^20"),
            scrambles: &[Scramble::TorusShift, Scramble::Tent, Scramble::None],
            is_random: false,
        }
    }
    fn admits(&self, n: u64, dim: usize, _rectangular: bool) -> bool {
        (1..=if dim <= 2 { MOST } else { MOST_SOUGHT }).contains(&n)
    }
    fn neighbours(&self, n: u64, dim: usize) -> (Option<u64>, Option<u64>) {
        match n {
            0 => (None, Some(1)),
            _ => (Some(if dim <= 2 { MOST } else { MOST_SOUGHT }), None),
        }
    }
    fn construct(&self, set: &PointSet) -> Box<dyn Points> {
        static SOUGHT: Memo<(u64, usize), u64> = Memo::new();
        let n = set.key.n_samples;
        let generator = match set.dim {
            1 => [1 % n].into(),
            2 => [1 % n, golden_residue(n)].into(),
            dim => SOUGHT.get((n, dim), || best_korobov(n, dim)),
        };
        Box::new(LatticePoints { n, generator })
    }
}

fn coprime(a: u64, b: u64) -> bool {
    let (mut a, mut b) = (a, b);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a == 1
}

/// The residue nearest N/φ that has no factor in common with N.
fn golden_residue(n: u64) -> u64 {
    let nearest = (n as f64 * 0.618_033_988_749_894_9).round() as u64;
    let candidates = (0..n).flat_map(|step| [nearest.saturating_sub(step), nearest + step]);
    candidates.into_iter().find(|a| *a < n && coprime(*a, n)).unwrap_or(0)
}

fn korobov(a: u64, n: u64, dim: usize) -> Vec<u64> {
    std::iter::successors(Some(1 % n), |z| Some(z * a % n)).take(dim).collect()
}

fn best_korobov(n: u64, dim: usize) -> Vec<u64> {
    /// Kernel evaluations spent.
    const BUDGET: u64 = 1 << 24;
    // a and n - a make mirror images.
    let all = n / 2;
    let count = (BUDGET / (n * dim as u64)).clamp(8, all.max(8));
    let kernel: Vec<f64> = (0..n)
        .map(|i| {
            let x = i as f64 / n as f64;
            // 1 + 2π² B₂(x), of P₂ (Sloan & Joe 1994, section 4).
            1.0 + 2.0 * PI * PI * (x * x - x + 1.0 / 6.0)
        })
        .collect();
    let worst_case = |z: &[u64]| -> f64 {
        let mut residues = vec![0; z.len()];
        (0..n)
            .map(|_| {
                let product = residues.iter().map(|r| kernel[*r as usize]).product::<f64>();
                for (residue, z) in residues.iter_mut().zip(z) {
                    *residue += z;
                    *residue -= if *residue >= n { n } else { 0 };
                }
                product
            })
            .sum()
    };
    let candidates = (1..=count)
        .map(|i| if count >= all { i } else { (i as f64 * all as f64 / count as f64) as u64 })
        .filter(|a| coprime(*a, n));
    let scored = candidates.map(|a| korobov(a, n, dim)).map(|z| (worst_case(&z), z));
    let best = scored.min_by(|(a, _), (b, _)| a.total_cmp(b));
    best.map_or_else(|| korobov(1, n, dim), |(_, z)| z)
}

struct LatticePoints {
    n: u64,
    generator: Arc<[u64]>,
}

impl Points for LatticePoints {
    fn fill_with(&self, _isa: Isa, first: u64, points: &mut [f64]) {
        let dim = self.generator.len();
        for (axis, z) in self.generator.iter().enumerate() {
            let mut residue = first % self.n * z % self.n;
            for point in points.chunks_exact_mut(dim) {
                point[axis] = (residue as f64 / self.n as f64).min(BELOW_ONE);
                residue += z;
                residue -= if residue >= self.n { self.n } else { 0 };
            }
        }
    }
    fn renew(&mut self, _stream: &Stream) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fibonacci_numbers_make_fibonacci_lattices() {
        let (mut a, mut b) = (1, 1);
        while b < 1 << 32 {
            assert_eq!(golden_residue(b) % b, a % b);
            (a, b) = (b, a + b);
            if b == 2 {
                a = 1;
            }
        }
        assert!((1..2000).all(|n| coprime(golden_residue(n), n) || n == 1));
    }

    #[test]
    fn korobov_vectors_beat_the_average_one() {
        // The mean over all vectors of P₂ is at least that of independent points, C/N; the
        // best must be far below.
        let z = best_korobov(257, 4);
        assert_eq!(z.len(), 4);
        assert!(coprime(z[1], 257));
        assert_eq!(best_korobov(1, 3), [0, 0, 0]);
        assert_eq!(best_korobov(2, 3), [1, 1, 1]);
    }
}
