//! The picture, coarse to fine.

use super::{Job, RightOfWay, Wake};
use std::sync::Arc;
use stratcore::scene::Rgb;
use stratcore::study::{Control, SamplerChoice, render_pixels};
use stratcore::trace::TracedScene;

/// A part of the picture in a quality.
#[derive(Debug, Clone, PartialEq)]
pub struct Patch {
    /// Pixels that were rendered: each stands for the square of `step` pixels right of and below
    /// it.
    pub pixels: Vec<[u32; 2]>,
    /// Their colours.
    pub colours: Vec<Rgb>,
    /// Side of the square that each pixel stands for.
    pub step: u32,
    /// Samples per pixel.
    pub spp: u64,
    /// Share of the whole work that is done, 0 to 1.
    pub progress: f32,
}

/// Sends patches, or what is wrong.
pub type PictureJob = Job<Result<Patch, String>>;

/// Renders the picture: every 8th pixel of a row and column, every 2nd, every one, then with
/// more samples up to `spp`. The last pass is what `render` of the library gives.
pub fn render(
    traced: &Arc<TracedScene>,
    spp: u64,
    seed: u64,
    way: RightOfWay,
    wake: Wake,
) -> PictureJob {
    let traced = traced.clone();
    Job::spawn("picture", wake, move |reporter| {
        let resolution = traced.scene().camera.resolution;
        let passes = passes(spp);
        let cost = |&(step, spp): &(u32, u64)| spp as f32 / (step * step) as f32;
        let total: f32 = passes.iter().map(cost).sum();
        let mut done = 0.0;
        for pass in passes {
            let (step, spp) = pass;
            let blocks = blocks(resolution, step);
            let share = cost(&pass) / total / blocks.len() as f32;
            for pixels in blocks {
                way.give(reporter);
                let control = Control { cancel: reporter.cancel(), ..Control::unwatched() };
                let rendered =
                    render_pixels(&traced, &pixels, SamplerChoice::JITTERED, spp, seed, control);
                if reporter.is_cancelled() {
                    return;
                }
                done += share;
                let patch = |colours| Patch { pixels, colours, step, spp, progress: done };
                reporter.send(rendered.map(patch).map_err(|error| error.to_string()));
            }
        }
    })
}

/// (step, samples per pixel), coarse to fine.
fn passes(spp: u64) -> Vec<(u32, u64)> {
    let mut passes = vec![(8, 1), (2, 1), (1, 1)];
    passes.extend([4, 16].into_iter().filter(|n| *n < spp).map(|n| (1, n)));
    if spp > 1 {
        passes.push((1, spp));
    }
    passes
}

/// The lattice of this step in blocks of rows, about as many pixels in each.
fn blocks([width, height]: [u32; 2], step: u32) -> Vec<Vec<[u32; 2]>> {
    const PIXELS: usize = 4096;
    let across: Vec<u32> = (0..width).step_by(step as usize).collect();
    let rows: Vec<u32> = (0..height).step_by(step as usize).collect();
    let rows_per_block = (PIXELS / across.len().max(1)).max(1);
    rows.chunks(rows_per_block)
        .map(|rows| rows.iter().flat_map(|&y| across.iter().map(move |&x| [x, y])).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::Standing;
    use super::*;
    use std::sync::mpsc;
    use stratcore::study;

    #[test]
    fn passes_end_with_the_samples_asked_for() {
        assert_eq!(passes(1).last(), Some(&(1, 1)));
        assert_eq!(passes(16), [(8, 1), (2, 1), (1, 1), (1, 4), (1, 16)]);
        assert_eq!(passes(64).last(), Some(&(1, 64)));
    }

    #[test]
    fn blocks_cover_each_lattice_once() {
        for step in [1, 2, 8] {
            let mut pixels = blocks([101, 67], step).concat();
            pixels.sort_unstable();
            let unique = pixels.windows(2).all(|pair| pair[0] != pair[1]);
            let expected = 101u32.div_ceil(step) * 67u32.div_ceil(step);
            assert!(unique && pixels.len() == expected as usize);
        }
    }

    #[test]
    fn the_last_pass_is_the_librarys_picture() {
        let mut scene = stratcore::scene::load("edges").unwrap();
        scene.camera.resolution = [24, 16];
        let traced = Arc::new(TracedScene::new(scene));
        let (sender, rung) = mpsc::channel();
        let wake: Wake = Arc::new(move || sender.send(()).unwrap_or_default());
        let mut job = render(&traced, 4, 7, RightOfWay::default(), wake);
        let mut patches = Vec::new();
        while job.standing() == Standing::Running {
            rung.recv().unwrap();
            patches.extend(job.poll());
        }
        let whole =
            study::render(&traced, SamplerChoice::JITTERED, 4, 7, Control::unwatched()).unwrap();
        let last = patches.pop().unwrap().unwrap();
        assert_eq!((last.spp, last.step), (4, 1));
        assert_eq!(last.colours, whole.pixels);
        assert!((last.progress - 1.0).abs() < 1e-4);
    }
}
