//! The picture, coarse to fine.

use super::{Job, PACE, RightOfWay, Wake};
use std::sync::Arc;
use std::time::Instant;
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
        let samples = |&(step, spp): &(u32, u64)| lattice_len(resolution, step) * spp;
        let total = passes.iter().map(samples).sum();
        let mut done = 0;
        for (step, spp) in passes {
            let empty = || Patch { pixels: Vec::new(), colours: Vec::new(), step, spp };
            let mut patch = empty();
            let mut last = Instant::now();
            let mut blocks = blocks(resolution, step, spp).peekable();
            while let Some(pixels) = blocks.next() {
                way.give(reporter);
                let control = Control { cancel: reporter.cancel(), ..Control::unwatched() };
                let rendered =
                    render_pixels(&traced, &pixels, SamplerChoice::JITTERED, spp, seed, control);
                if reporter.is_cancelled() {
                    return;
                }
                match rendered {
                    Ok(colours) => patch.colours.extend(colours),
                    Err(error) => return reporter.send(Err(error.to_string())),
                }
                done += pixels.len() as u64 * spp;
                patch.pixels.extend(pixels);
                reporter.progress(done, total);
                if blocks.peek().is_none() || last.elapsed() >= PACE {
                    reporter.send(Ok(std::mem::replace(&mut patch, empty())));
                    last = Instant::now();
                }
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

/// Pixels that are `step` apart.
fn lattice_len(resolution: [u32; 2], step: u32) -> u64 {
    resolution.iter().map(|side| u64::from(side.div_ceil(step))).product()
}

/// The lattice of this step, row by row, in blocks of a few milliseconds' work: as long a click
/// may have to wait.
fn blocks([width, height]: [u32; 2], step: u32, spp: u64) -> impl Iterator<Item = Vec<[u32; 2]>> {
    const SAMPLES: u64 = 4096;
    let len = (SAMPLES / spp).clamp(16, SAMPLES) as usize;
    let mut pixels = (0..height)
        .step_by(step as usize)
        .flat_map(move |y| (0..width).step_by(step as usize).map(move |x| [x, y]));
    std::iter::from_fn(move || {
        let block: Vec<_> = pixels.by_ref().take(len).collect();
        (!block.is_empty()).then_some(block)
    })
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
        for (step, spp) in [(1, 16), (2, 1), (8, 1 << 20)] {
            let mut pixels: Vec<_> = blocks([101, 67], step, spp).flatten().collect();
            pixels.sort_unstable();
            let unique = pixels.windows(2).all(|pair| pair[0] != pair[1]);
            assert!(unique && pixels.len() as u64 == lattice_len([101, 67], step));
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
        let last = patches.iter().flatten().filter(|patch| (patch.spp, patch.step) == (4, 1));
        let colours: Vec<_> = last.flat_map(|patch| patch.colours.clone()).collect();
        assert_eq!(colours, whole.pixels);
        assert_eq!(job.share(), 1.0);
    }
}
