//! The sampler shelf, held against its properties: strata, nets, means, variances,
//! independence, other implementations, and the traps of other tools.

mod estimates;
mod reference;
mod strata;
mod streams;
mod traps;

use stratcore::rng::StreamKey;
use stratcore::sampler::{CountPolicy, PointSet, SHELF, Sampler, Scramble, by_name, count_used};
use stratcore::simd::Isa;

/// Names one set, with defaults that tests change.
#[derive(Clone, Copy)]
struct Set {
    sampler: &'static dyn Sampler,
    scramble: Scramble,
    n: u64,
    dim: usize,
    seed: u64,
    pixel: [u32; 2],
    trial: u32,
}

impl Set {
    fn new(sampler: &'static dyn Sampler, scramble: Scramble, n: u64, dim: usize) -> Self {
        Self { sampler, scramble, n, dim, seed: 1996, pixel: [5, 9], trial: 0 }
    }

    fn named(sampler: &str, scramble: Scramble, n: u64, dim: usize) -> Self {
        Self::new(by_name(sampler).unwrap(), scramble, n, dim)
    }

    fn fill(self, first: u64, len: usize) -> Vec<f64> {
        self.fill_with(Isa::detect(), first, len)
    }

    fn fill_with(self, isa: Isa, first: u64, len: usize) -> Vec<f64> {
        let key = StreamKey {
            seed: self.seed,
            pixel: self.pixel,
            sampler: self.sampler.stream_id(),
            n_samples: self.n,
            trial: self.trial,
        };
        let set = PointSet { key, dim: self.dim, scramble: self.scramble, rectangular: true };
        let mut points = vec![0.0; len * self.dim];
        self.sampler.points(&set).fill_with(isa, first, &mut points);
        points
    }

    fn points(self) -> Vec<f64> {
        self.fill(0, self.n as usize)
    }

    /// The mean of f over the set.
    fn estimate(self, f: impl Fn(&[f64]) -> f64) -> f64 {
        self.points().chunks(self.dim).map(f).sum::<f64>() / self.n as f64
    }

    /// The estimates of trials 0 .. `trials`.
    fn estimates(self, trials: u32, f: impl Fn(&[f64]) -> f64) -> Vec<f64> {
        (0..trials).map(|trial| Self { trial, ..self }.estimate(&f)).collect()
    }
}

/// Every sampler in every scramble, at the count nearest `n` that it has, where it has one in
/// `dim` dimensions.
fn every_set(n: u64, dim: usize) -> Vec<Set> {
    let sets = SHELF.iter().flat_map(|sampler| {
        let used = count_used(*sampler, n, dim, CountPolicy::Snap).ok();
        used.into_iter().flat_map(move |n| {
            sampler.scrambles().iter().map(move |s| Set::new(*sampler, *s, n, dim))
        })
    });
    sets.collect()
}

/// Those whose repeats differ.
fn every_random_set(n: u64, dim: usize) -> Vec<Set> {
    let mut sets = every_set(n, dim);
    sets.retain(|set| set.sampler.is_randomised(set.scramble));
    sets
}

impl std::fmt::Display for Set {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} N = {} d = {}", self.sampler.name(), self.scramble, self.n, self.dim)
    }
}

/// Mean and variance (divisor M - 1).
fn moments(values: &[f64]) -> (f64, f64) {
    let m = values.len() as f64;
    let mean = values.iter().sum::<f64>() / m;
    (mean, values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (m - 1.0))
}

fn variance(values: &[f64]) -> f64 {
    moments(values).1
}
