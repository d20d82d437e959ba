//! What the benches of traced scenes share.
#![allow(dead_code, reason = "each bench uses a part of it")]

pub mod clock;

use stratcore::scene::Camera;
use stratcore::study::{SamplerChoice, StudyPlan};

/// Centres of `side` x `side` equal fields of the picture.
pub fn lattice(camera: &Camera, side: u32) -> Vec<[u32; 2]> {
    let [width, height] = camera.resolution;
    let at = |i: u32, size: u32| {
        ((2 * u64::from(i) + 1) * u64::from(size) / (2 * u64::from(side))) as u32
    };
    (0..side * side).map(|i| [at(i % side, width), at(i / side, height)]).collect()
}

/// The paper's protocol with one sampler: N = 1, 4, …, 256, M = 50.
pub fn protocol(sampler: SamplerChoice) -> StudyPlan {
    StudyPlan { samplers: vec![sampler], ..StudyPlan::paper() }
}

/// Samples that a plan takes in one pixel.
pub fn n_samples(plan: &StudyPlan) -> u64 {
    u64::from(plan.n_trials) * plan.counts.iter().sum::<u64>()
}
