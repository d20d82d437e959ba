//! Time of one discrepancy, and of one periodogram, of jittered points. One thread.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use stratcore::discrepancy::Measure;
use stratcore::rng::StreamKey;
use stratcore::sampler::{PointSet, whole_set};
use stratcore::spectrum::of_points;
use stratcore::study::SamplerChoice;

fn main() {
    divan::main();
}

fn jittered(n: u64) -> Vec<f64> {
    let SamplerChoice { sampler, scramble } = SamplerChoice::JITTERED;
    let stream = sampler.stream_id();
    let key = StreamKey { seed: 1996, pixel: [0, 0], sampler: stream, n_samples: n, trial: 0 };
    whole_set(sampler, &PointSet { key, dim: 2, scramble, rectangular: true }).unwrap_or_default()
}

/// Items are points.
fn measure(bencher: Bencher, measure: Measure, n: u64) {
    let points = jittered(n);
    bencher.counter(ItemsCount::new(n)).bench_local(|| measure.of(black_box(&points), 2));
}

#[divan::bench(args = [256, 1024, 4096], sample_count = 5)]
fn edge(bencher: Bencher, n: u64) {
    measure(bencher, Measure::Edge, n);
}

#[divan::bench(args = [256, 1024, 4096], sample_count = 5)]
fn edge_l2(bencher: Bencher, n: u64) {
    measure(bencher, Measure::EdgeL2, n);
}

#[divan::bench(args = [256, 1024, 4096], sample_count = 5)]
fn star(bencher: Bencher, n: u64) {
    measure(bencher, Measure::Star, n);
}

#[divan::bench(args = [256, 1024, 4096], sample_count = 5)]
fn mixture(bencher: Bencher, n: u64) {
    measure(bencher, Measure::Mixture, n);
}

/// At frequencies up to 4√N along each axis. Items are points.
#[divan::bench(args = [256, 1024], sample_count = 5)]
fn periodogram(bencher: Bencher, n: u64) {
    let points = jittered(n);
    let cutoff = 4 * n.isqrt() as u32;
    bencher
        .counter(ItemsCount::new(n))
        .bench_local(|| of_points(black_box(&points), 2, [0, 1], cutoff));
}
