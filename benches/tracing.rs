//! The steps of one pixel's study: rays, the beam's set-up, one row, the whole protocol.
//! One thread.

mod common;

use common::{lattice, n_samples, protocol};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::fmt;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use stratcore::beam::PixelBeam;
use stratcore::rng::StreamKey;
use stratcore::sampler::{Jittered, PointSet, Random, Sampler, Scramble};
use stratcore::scene::{Channel, Scene, load};
use stratcore::study::{Control, SamplerChoice, study, with_threads};
use stratcore::theory::Class;
use stratcore::trace::{TracedScene, Tracer};
use stratcore::trial::trial_means;

fn main() {
    // The pool that runs the benches also runs what they call: one thread for all.
    with_threads(Some(1), divan::main);
}

/// Pixels per axis that a bench of a whole picture visits.
const SIDE: u32 = 16;

/// A scene by both tracers, and its pixels of note.
struct Subject {
    beam: TracedScene,
    bvh: TracedScene,
    lattice: Vec<[u32; 2]>,
    /// A pixel of each class.
    pixels: Vec<(Class, [u32; 2])>,
}

impl Subject {
    fn new(name: &str) -> Self {
        let scene: Scene = load(name).expect("a built-in scene");
        let lattice = lattice(&scene.camera, SIDE);
        let bvh = TracedScene::new(scene.clone()).with_tracer(Tracer::Bvh);
        let beam = TracedScene::new(scene);
        let pixels = [Class::Smooth, Class::Edge, Class::Complex]
            .into_iter()
            .filter_map(|class| Some((class, first_of_class(&beam, &lattice, class)?)))
            .collect();
        Self { beam, bvh, lattice, pixels }
    }

    fn traced(&self, tracer: Tracer) -> &TracedScene {
        match tracer {
            Tracer::Beam => &self.beam,
            Tracer::Bvh => &self.bvh,
        }
    }
}

static CLASSIC: LazyLock<Subject> = LazyLock::new(|| Subject::new("classic"));
static GRASS: LazyLock<Subject> = LazyLock::new(|| Subject::new("grass"));

fn subject(scene: &str) -> &'static Subject {
    if scene == "classic" { &CLASSIC } else { &GRASS }
}

const SCENES: [&str; 2] = ["classic", "grass"];

fn jittered() -> SamplerChoice {
    SamplerChoice { sampler: &Jittered, scramble: Scramble::None }
}

/// The first pixel that jittered sampling puts into this class beyond doubt.
fn first_of_class(scene: &TracedScene, lattice: &[[u32; 2]], class: Class) -> Option<[u32; 2]> {
    let plan = protocol(jittered());
    lattice.iter().copied().find(|&pixel| {
        let integrand = scene.pixel(pixel, Channel::Luminance);
        study(&integrand, pixel, &plan, Control::unwatched()).is_ok_and(|result| {
            let found = &result.samplers[0];
            found.class == Some(class) && found.class_is_sure
        })
    })
}

/// One ray through the middle of each pixel of the lattice.
#[divan::bench(args = SCENES, sample_count = 50, max_time = 1)]
fn closest_hit(bencher: Bencher, scene: &str) {
    let Subject { bvh, lattice, .. } = subject(scene);
    let camera = bvh.scene().camera;
    let directions: Vec<_> = lattice.iter().map(|p| camera.pixel(*p).direction(0.5, 0.5)).collect();
    bencher.counter(ItemsCount::new(lattice.len())).bench_local(|| {
        for direction in &directions {
            black_box(bvh.closest_hit(camera.eye, *direction));
        }
    });
}

/// Gather and set-up of each pixel of the lattice.
#[divan::bench(args = SCENES, sample_count = 50, max_time = 2)]
fn beam_setup(bencher: Bencher, scene: &str) {
    let Subject { beam, lattice, .. } = subject(scene);
    bencher.counter(ItemsCount::new(lattice.len())).bench_local(|| {
        for pixel in lattice {
            let accel = beam.accel();
            black_box(PixelBeam::new(beam.scene(), accel, *pixel, Channel::Luminance));
        }
    });
}

/// A pixel of some class, studied by some tracer.
#[derive(Clone, Copy)]
struct Case {
    scene: &'static str,
    class: Class,
    pixel: [u32; 2],
    tracer: Tracer,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { scene, class, pixel: [x, y], tracer } = self;
        write!(f, "{scene} {class:?} {x},{y} {tracer:?}")
    }
}

fn cases() -> impl Iterator<Item = Case> {
    SCENES.into_iter().flat_map(|scene| {
        subject(scene).pixels.iter().flat_map(move |&(class, pixel)| {
            [Tracer::Beam, Tracer::Bvh].map(|tracer| Case { scene, class, pixel, tracer })
        })
    })
}

/// One row of a study: M = 50, N = 256, of a pixel that is set up.
fn row(bencher: Bencher, case: &Case, sampler: &dyn Sampler) {
    let Case { scene, pixel, tracer, .. } = *case;
    let integrand = subject(scene).traced(tracer).pixel(pixel, Channel::Luminance);
    let sampler_id = sampler.stream_id();
    let key = StreamKey { seed: 1996, pixel, sampler: sampler_id, n_samples: 256, trial: 0 };
    let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
    let mut means = [0.0; 50];
    bencher.counter(ItemsCount::new(256 * means.len())).bench_local(|| {
        trial_means(&integrand, sampler, &set, 0, &mut means, &AtomicBool::new(false));
        black_box(&mut means);
    });
}

#[divan::bench(args = cases(), sample_count = 50, max_time = 0.5)]
fn row_jittered(bencher: Bencher, case: &Case) {
    row(bencher, case, &Jittered);
}

#[divan::bench(args = cases(), sample_count = 50, max_time = 0.5)]
fn row_random(bencher: Bencher, case: &Case) {
    row(bencher, case, &Random);
}

/// The paper's protocol by jittered sampling, from the pixel's address to the fit.
#[divan::bench(args = cases(), sample_count = 20, max_time = 1)]
fn whole_pixel(bencher: Bencher, case: &Case) {
    let Case { scene, pixel, tracer, .. } = *case;
    let scene = subject(scene).traced(tracer);
    let plan = protocol(jittered());
    bencher.counter(ItemsCount::new(n_samples(&plan))).bench_local(|| {
        let integrand = scene.pixel(pixel, Channel::Luminance);
        black_box(study(&integrand, pixel, &plan, Control::unwatched()))
    });
}
