//! The exponent of every pixel, coarse to fine.

use super::{Job, PACE, RightOfWay, Wake};
use std::sync::Arc;
use std::time::Instant;
use stratcore::fit::samples_needed;
use stratcore::integrand::Integrand as _;
use stratcore::scene::Channel;
use stratcore::study::{Control, StudyPlan, study_pixels};
use stratcore::theory::Class;
use stratcore::trace::TracedScene;

/// What a map keeps of one pixel's study under `jittered`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Studied {
    /// Every estimate is exact.
    Exact,
    /// A fitted line.
    Fitted {
        /// p
        exponent: f64,
        /// Its standard error.
        std_error: f64,
        /// log₁₀ C
        log10_constant: f64,
        /// The kind of pixel.
        class: Class,
    },
    /// Too few variances above zero for a line.
    Unfitted,
}

impl Studied {
    /// Samples that bring the standard error of an estimate down to `error`, by the fitted line.
    pub fn samples_needed(&self, error: f64) -> Option<f64> {
        match *self {
            Self::Exact => Some(1.0),
            Self::Fitted { exponent, log10_constant, .. } => {
                samples_needed(exponent, log10_constant, error)
            }
            Self::Unfitted => None,
        }
    }
}

/// Some pixels of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapUpdate {
    /// Each pixel stands for the square of `step` pixels right of and below it until finer ones
    /// come.
    pub pixels: Vec<([u32; 2], Studied)>,
    /// Side of that square.
    pub step: u32,
}

/// Sends parts of the map, or what is wrong with the plan.
pub type MapJob = Job<Result<MapUpdate, String>>;

/// Studies every pixel of the picture under `jittered`, first every 16th of a row and column,
/// then those between. `plan_in` makes the plan for pixels of so many dimensions. Steps aside
/// for whoever has the right of way.
pub fn map(
    traced: &Arc<TracedScene>,
    channel: Channel,
    plan_in: impl FnOnce(usize) -> Result<StudyPlan, String> + Send + 'static,
    way: RightOfWay,
    wake: Wake,
) -> MapJob {
    /// Pixels at a time: some milliseconds of work, as long as a click may have to wait.
    const BATCH: usize = 8;
    let traced = traced.clone();
    Job::spawn("map", wake, move |reporter| {
        let plan = match plan_in(traced.pixel([0, 0], channel).dim()) {
            Ok(plan) => plan,
            Err(fault) => return reporter.send(Err(fault)),
        };
        let resolution = traced.scene().camera.resolution;
        let total = resolution.map(u64::from).iter().product();
        let mut done = 0;
        for step in [16, 8, 4, 2, 1] {
            let lattice: Vec<_> = lattice(resolution, step).collect();
            let mut studied = Vec::new();
            let mut last = Instant::now();
            let mut batches = lattice.chunks(BATCH).peekable();
            while let Some(pixels) = batches.next() {
                way.give(reporter);
                let control = Control { cancel: reporter.cancel(), ..Control::unwatched() };
                let integrand_of = |pixel| traced.pixel(pixel, channel);
                let ended =
                    study_pixels(&integrand_of, pixels.iter().copied(), &plan, control, &mut |r| {
                        studied.push((r.pixel, studied_of(&r)));
                    });
                if reporter.is_cancelled() {
                    return;
                }
                if let Err(error) = ended {
                    return reporter.send(Err(error.to_string()));
                }
                done += pixels.len() as u64;
                reporter.progress(done, total);
                if batches.peek().is_none() || last.elapsed() >= PACE {
                    let pixels = std::mem::take(&mut studied);
                    reporter.send(Ok(MapUpdate { pixels, step }));
                    last = Instant::now();
                }
            }
        }
    })
}

fn studied_of(result: &stratcore::StudyResult) -> Studied {
    let Some(sampler) = result.samplers.first() else { return Studied::Unfitted };
    match (&sampler.fit, sampler.class) {
        _ if sampler.exact => Studied::Exact,
        (Some(fit), Some(class)) => Studied::Fitted {
            exponent: fit.exponent,
            std_error: fit.std_error,
            log10_constant: fit.log10_constant,
            class,
        },
        _ => Studied::Unfitted,
    }
}

/// The pixels of the lattice of this step that the lattice of twice the step does not have.
fn lattice([width, height]: [u32; 2], step: u32) -> impl Iterator<Item = [u32; 2]> {
    const COARSEST: u32 = 16;
    let coarser = 2 * step;
    (0..height)
        .step_by(step as usize)
        .flat_map(move |y| (0..width).step_by(step as usize).map(move |x| [x, y]))
        .filter(move |[x, y]| step == COARSEST || x % coarser != 0 || y % coarser != 0)
}

#[cfg(test)]
mod tests {
    use super::super::Standing;
    use super::*;
    use std::sync::mpsc;
    use stratcore::study::{SamplerChoice, study};

    #[test]
    fn lattices_cover_the_picture_once() {
        let mut all: Vec<_> =
            [16, 8, 4, 2, 1].into_iter().flat_map(|step| lattice([37, 21], step)).collect();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 37 * 21);
        assert_eq!(
            [16, 8, 4, 2, 1].map(|s| lattice([37, 21], s).count()).iter().sum::<usize>(),
            37 * 21
        );
    }

    #[test]
    fn the_map_holds_what_a_study_of_the_pixel_gives() {
        let mut scene = stratcore::scene::load("edges").unwrap();
        scene.camera.resolution = [12, 12];
        let traced = Arc::new(TracedScene::new(scene));
        let samplers = vec![SamplerChoice::named("jittered").unwrap()];
        let plan =
            StudyPlan { samplers, counts: vec![1, 4, 16], n_trials: 10, ..StudyPlan::paper() };
        let (sender, rung) = mpsc::channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let channel = Channel::Luminance;
        let plan_in = {
            let plan = plan.clone();
            move |dim| (dim == 2).then_some(plan).ok_or_else(|| format!("d = {dim}"))
        };
        let mut job = map(&traced, channel, plan_in, RightOfWay::default(), wake);
        let mut updates = Vec::new();
        while job.standing() == Standing::Running {
            rung.recv().unwrap();
            updates.extend(job.poll().into_iter().map(Result::unwrap));
        }
        assert_eq!(job.share(), 1.0);
        let pixels: Vec<_> = updates.into_iter().flat_map(|update| update.pixels).collect();
        assert_eq!(pixels.len(), 144);
        for (pixel, studied) in pixels.into_iter().step_by(29) {
            let result =
                study(&traced.pixel(pixel, channel), pixel, &plan, Control::unwatched()).unwrap();
            assert_eq!(studied, studied_of(&result), "{pixel:?}");
        }
    }
}
