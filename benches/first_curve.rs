//! How soon after a click the explorer has a first curve: four samplers, N = 1, 4, …, 256, ten
//! trials each, with the pixel's set-up and the statistics, on all cores.

use divan::Bencher;
use std::ops::ControlFlow;
use std::sync::LazyLock;
use stratcore::sampler::CountPolicy;
use stratcore::scene::{Channel, load};
use stratcore::study::{Control, SamplerChoice, StudyPlan, study_live};
use stratcore::trace::{TracedScene, Tracer};

fn main() {
    divan::main();
}

/// Scene and pixel: smooth, edge, complex, and one full of blades.
const PIXELS: [(&str, [u32; 2]); 4] =
    [("edges", [100, 150]), ("edges", [216, 24]), ("edges", [230, 100]), ("grass", [128, 180])];

static EDGES: LazyLock<[TracedScene; 2]> = LazyLock::new(|| both("edges"));
static GRASS: LazyLock<[TracedScene; 2]> = LazyLock::new(|| both("grass"));

/// The scene by beam and by rays.
fn both(name: &str) -> [TracedScene; 2] {
    let scene = load(name).expect("a built-in scene loads");
    let beam = TracedScene::new(scene.clone());
    [beam, TracedScene::new(scene).with_tracer(Tracer::Bvh)]
}

#[divan::bench(args = PIXELS)]
fn by_beam(bencher: Bencher<'_, '_>, pixel: (&str, [u32; 2])) {
    first_curve(bencher, 0, pixel);
}

#[divan::bench(args = PIXELS, sample_count = 10)]
fn by_rays(bencher: Bencher<'_, '_>, pixel: (&str, [u32; 2])) {
    first_curve(bencher, 1, pixel);
}

fn first_curve(bencher: Bencher<'_, '_>, tracer: usize, (scene, pixel): (&str, [u32; 2])) {
    let scenes = if scene == "grass" { &GRASS } else { &EDGES };
    let traced = &scenes[tracer];
    let samplers = ["random", "jittered", "sobol", "halton"];
    let samplers: Vec<_> =
        samplers.iter().filter_map(|name| SamplerChoice::named(name).ok()).collect();
    let plan = StudyPlan { samplers, count_policy: CountPolicy::Snap, ..StudyPlan::paper() };
    bencher.bench_local(|| {
        let integrand = traced.pixel(pixel, Channel::Luminance);
        let mut first = None;
        let ended = study_live(&integrand, pixel, &plan, Control::unwatched(), &mut |result| {
            first = Some(result);
            ControlFlow::Break(())
        });
        (ended, first)
    });
}
