//! Points per second of every sampler on the shelf, in two dimensions.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::fmt;
use stratcore::rng::StreamKey;
use stratcore::sampler::{PointSet, SHELF, Sampler};

const COUNTS: [u64; 2] = [256, 65_536];

fn main() {
    divan::main();
}

struct Case {
    sampler: &'static dyn Sampler,
    n: u64,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.sampler.name(), self.n)
    }
}

/// Each sampler with each count that it admits.
fn cases() -> impl Iterator<Item = Case> {
    let both = |&sampler| COUNTS.map(|n| Case { sampler, n });
    SHELF.iter().flat_map(both).filter(|case| case.sampler.admits(case.n, 2, false))
}

/// Another trial's set each time, made and filled: what a study pays. What a sampler keeps from
/// one set to the next (tables, patterns) is made before the clock starts.
#[divan::bench(args = cases(), sample_count = 100, max_time = 0.5)]
fn fill(bencher: Bencher, case: &Case) {
    /// More than the patterns that any sampler keeps.
    const TRIALS: u32 = 8;
    let Case { sampler, n } = *case;
    let key = StreamKey {
        seed: 1996,
        pixel: [0, 0],
        sampler: sampler.stream_id(),
        n_samples: n,
        trial: 0,
    };
    let scramble = sampler.scrambles()[0];
    let set =
        |trial| PointSet { key: StreamKey { trial, ..key }, dim: 2, scramble, rectangular: false };
    let mut points = vec![0.0; 2 * n as usize];
    for trial in 0..TRIALS {
        sampler.points(&set(trial)).fill(0, &mut points);
    }
    let mut trial = 0;
    bencher.counter(ItemsCount::new(n)).bench_local(|| {
        trial = (trial + 1) % TRIALS;
        sampler.points(&set(trial)).fill(0, &mut points);
        black_box(&mut points);
    });
}

/// The rival: a plain loop over rand's `SmallRng`, which on 64-bit machines is
/// Xoshiro256PlusPlus.
#[divan::bench(args = COUNTS, sample_count = 100, max_time = 0.5)]
fn jittered_by_small_rng(bencher: Bencher, n: u64) {
    let per_axis = n.isqrt();
    let mut points = vec![0.0; 2 * n as usize];
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1996);
    bencher.counter(ItemsCount::new(n)).bench_local(|| {
        let width = 1.0 / per_axis as f64;
        let strata = (0..per_axis).flat_map(|y| (0..per_axis).map(move |x| [x, y]));
        for (point, stratum) in points.chunks_exact_mut(2).zip(strata) {
            point[0] = (stratum[0] as f64 + rng.random::<f64>()) * width;
            point[1] = (stratum[1] as f64 + rng.random::<f64>()) * width;
        }
        black_box(&mut points);
    });
}
