//! Points per second of every sampler on the shelf under every scramble it takes, in two
//! dimensions, beside two rivals.

#[path = "common/covered.rs"]
mod covered;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use std::fmt;
use std::sync::atomic::AtomicBool;
use stratcore::rng::StreamKey;
use stratcore::sampler::{CountPolicy, Jittered, PointSet, SHELF, Sampler, Scramble, count_used};
use stratcore::scene::{self, Channel};
use stratcore::trace::TracedScene;
use stratcore::trial::trial_means;

const COUNTS: [u64; 2] = [256, 65_536];

fn main() {
    divan::main();
}

struct Case {
    sampler: &'static dyn Sampler,
    scramble: Scramble,
    n: u64,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}+{} {}", self.sampler.name(), self.scramble, self.n)
    }
}

/// Each sampler under each scramble, with the counts nearest the two where it has some within a
/// quarter of them.
fn cases() -> impl Iterator<Item = Case> {
    let nearest = |sampler: &&'static dyn Sampler, n: u64| {
        let used = count_used(*sampler, n, 2, CountPolicy::Snap).ok()?;
        (used.abs_diff(n) <= n / 4).then_some(used)
    };
    SHELF.iter().flat_map(move |sampler| {
        let counts = COUNTS.into_iter().filter_map(move |n| nearest(sampler, n));
        counts.flat_map(move |n| {
            sampler.scrambles().iter().map(move |&scramble| Case { sampler: *sampler, scramble, n })
        })
    })
}

/// Another trial's set each time, made and filled: what a study pays. What a sampler keeps from
/// one set to the next (tables, patterns) is made before the clock starts.
#[divan::bench(args = cases(), sample_count = 100, max_time = 0.3)]
fn fill(bencher: Bencher, case: &Case) {
    /// More than the patterns that any sampler keeps.
    const TRIALS: u32 = 8;
    let Case { sampler, scramble, n } = *case;
    let key = StreamKey {
        seed: 1996,
        pixel: [0, 0],
        sampler: sampler.stream_id(),
        n_samples: n,
        trial: 0,
    };
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

/// Jittered points where the beam consumes them: drawn in vectors of f32 and shaded before they
/// reach memory. A row of 50 trials before one triangle that fills the pixel, shading and sums
/// included.
#[divan::bench(args = COUNTS, sample_count = 100, max_time = 0.5)]
fn jittered_in_the_beam(bencher: Bencher, n: u64) {
    let scene = match scene::load("classic") {
        Ok(scene) => TracedScene::new(covered::covered_by_one_triangle(scene)),
        Err(error) => panic!("{error}"),
    };
    let pixel = [100, 100];
    let integrand = scene.pixel(pixel, Channel::Luminance);
    let sampler = Jittered.stream_id();
    let key = StreamKey { seed: 1996, pixel, sampler, n_samples: n, trial: 0 };
    let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
    let mut means = [0.0; 50];
    bencher.counter(ItemsCount::new(n * means.len() as u64)).bench_local(|| {
        trial_means(&integrand, &Jittered, &set, 0, &mut means, &AtomicBool::new(false));
        black_box(&mut means);
    });
}

/// A rival: jittered points by a plain loop over rand's `SmallRng`.
#[divan::bench(args = COUNTS, sample_count = 100, max_time = 0.5)]
fn jittered_by_small_rng(bencher: Bencher, n: u64) {
    let per_axis = n.isqrt();
    let mut points = vec![0.0; 2 * n as usize];
    let mut rng = SmallRng::seed_from_u64(1996);
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

/// A rival: hashed Owen points of the `sobol_burley` crate, f32, four coordinates a call. An
/// item is two coordinates, a point of ours.
#[divan::bench(args = COUNTS, sample_count = 100, max_time = 0.5)]
fn sobol_by_burley(bencher: Bencher, n: u64) {
    let mut points = vec![[0f32; 4]; n as usize];
    let mut seed = 0;
    bencher.counter(ItemsCount::new(2 * n)).bench_local(|| {
        seed += 1;
        for (index, point) in (0..).zip(&mut points) {
            *point = sobol_burley::sample_4d(index, 0, seed);
        }
        black_box(&mut points);
    });
}
