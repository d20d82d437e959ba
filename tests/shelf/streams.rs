//! Which numbers a set is made of: the same on every machine and in every version, and random
//! in all their digits.

use crate::{Set, every_random_set, every_set};
use stratcore::sampler::{CountPolicy, SHELF, Scramble, count_used};
use stratcore::simd::Isa;

/// A number that changes with any bit of any coordinate.
fn checksum(points: &[f64]) -> u64 {
    points.iter().fold(0xcbf2_9ce4_8422_2325, |sum, x: &f64| {
        (sum ^ x.to_bits()).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23)
    })
}

/// Whether its points are sought by a rule that takes seconds for many.
fn is_sought(set: Set) -> bool {
    ["annealed", "best-candidate", "poisson"].contains(&set.sampler.name())
}

/// Sets of every sampler and scramble, small and large, and the runs of them that are summed.
fn summed_runs() -> Vec<(Set, u64, usize)> {
    let mut runs = Vec::new();
    for sampler in SHELF {
        for &scramble in sampler.scrambles() {
            for (n, dim) in
                [(1, 2), (13, 1), (64, 2), (64, 5), (256, 2), (1000, 3), (70_000, 2), (1 << 32, 2)]
            {
                let Ok(n) = count_used(*sampler, n, dim, CountPolicy::Snap) else { continue };
                let set = Set { trial: 3, ..Set::new(*sampler, scramble, n, dim) };
                if is_sought(set) && n > 64 {
                    continue;
                }
                let len = n.min(1000);
                runs.push((set, n - len, len as usize));
            }
        }
    }
    runs
}

/// The streams' published definition: point sets are those of the first version, bit for bit. A
/// change is a new definition, for the changelog; `print_the_sums` makes the file.
#[test]
fn point_sets_are_those_of_the_first_version() {
    let mut known = include_str!("streams.csv").lines().skip(1);
    for (set, first, len) in summed_runs() {
        let sum = checksum(&set.fill(first, len));
        assert_eq!(Some(row(set, first, len, sum).as_str()), known.next());
    }
    assert_eq!(known.next(), None);
}

fn row(set: Set, first: u64, len: usize, sum: u64) -> String {
    let (sampler, scramble) = (set.sampler.name(), set.scramble);
    format!("{sampler},{scramble},{},{},{first},{len},{sum:016x}", set.n, set.dim)
}

/// `cargo test -p stratcli --test shelf -- --ignored --nocapture print_the_sums`
#[test]
#[ignore = "writes the expectations of another test"]
fn print_the_sums() {
    eprintln!("sampler,scramble,n,dim,first,len,checksum");
    for (set, first, len) in summed_runs() {
        eprintln!("{}", row(set, first, len, checksum(&set.fill(first, len))));
    }
}

/// Lengths and offsets around those of vectors and blocks.
#[test]
fn every_instruction_set_makes_the_same_bits() {
    for dim in [1, 2, 3, 4, 7] {
        for n in [1, 7, 65, 150, 1024] {
            for set in every_set(n, dim) {
                if is_sought(set) && n > 150 {
                    continue;
                }
                for first in [0, 1, 13, 63, 64, 100] {
                    for len in [1, 2, 15, 17, 64, 129] {
                        if first >= set.n {
                            continue;
                        }
                        let len = len.min(set.n - first) as usize;
                        let plain = set.fill_with(Isa::BASELINE, first, len);
                        for isa in Isa::available() {
                            let points = set.fill_with(isa, first, len);
                            let equal =
                                plain.iter().zip(&points).all(|(a, b)| a.to_bits() == b.to_bits());
                            assert!(equal, "{set}, {first} + {len}: {}", isa.name());
                        }
                    }
                }
            }
        }
    }
}

/// Draws change streams where the index outgrows 32 bits, wherever a block begins.
#[test]
fn indices_beyond_32_bits_are_no_seam() {
    let random = Set::named("random", Scramble::None, (1 << 32) + 500, 2);
    let jittered = Set::named("jittered", Scramble::None, 65_541 * 65_541, 2);
    for set in [random, jittered] {
        let first = (1 << 32) - 200;
        let whole = set.fill(first, 400);
        for i in 0..400 {
            assert_eq!(set.fill(first + i, 1), whole[2 * i as usize..][..2], "{set} {i}");
        }
    }
}

/// Every binary digit of a coordinate is fair, from the first to the 48th, in small sets and in
/// the largest: no grid of rounding, no tail of zeros. Hashed points have 32 digits, nested ones
/// 32 beside those that tell them apart. Of M = 800 points, one from each trial, a digit's ones scatter by √M / 2; at
/// 5.7 of that, 17,000 digits raise a false alarm once in 5,000 times.
#[test]
fn every_digit_is_random() {
    const TRIALS: u32 = 800;
    for n in [16, (1 << 32) - 1] {
        for set in every_random_set(n, 2) {
            if is_sought(set) && set.n > 64 {
                continue;
            }
            let digits = match (set.sampler.name(), set.scramble) {
                (_, Scramble::OwenHash) => 32,
                ("sobol" | "padded", Scramble::Owen) | ("pmj02", Scramble::None) => {
                    48.min(set.n.next_power_of_two().ilog2() as usize + 32)
                }
                _ => 48,
            };
            let mut ones = [[0u32; 2]; 48];
            for trial in 0..TRIALS {
                // Any index: some axes lie in the order of the points.
                let index = (u64::from(trial).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 31) % set.n;
                let point = Set { trial, ..set }.fill(index, 1);
                for (axis, x) in point.iter().enumerate() {
                    let bits = (x * 2f64.powi(48)) as u64;
                    for (digit, ones) in ones.iter_mut().enumerate() {
                        ones[axis] += (bits >> (47 - digit)) as u32 & 1;
                    }
                }
            }
            for (digit, ones) in ones[..digits].iter().enumerate() {
                for ones in ones {
                    let off = (f64::from(*ones) - 400.0) / (0.5 * f64::from(TRIALS).sqrt());
                    assert!(off.abs() < 5.7, "{set}: digit {} off by {off}", digit + 1);
                }
            }
        }
    }
}
