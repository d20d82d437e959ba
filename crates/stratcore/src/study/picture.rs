//! Pictures of a scene.

use super::Control;
use crate::error::StudyError;
use crate::rng::StreamKey;
use crate::sampler::{Jittered, PointSet, Sampler, Scramble};
use crate::scene::Rgb;
use crate::trace::TracedScene;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

/// Linear RGB, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` colours.
    pub pixels: Vec<Rgb>,
}

/// The picture of a scene: the mean radiance of each pixel over `spp` jittered points, in a
/// grid as nearly square as `spp` allows. Progress is counted in samples.
///
/// # Errors
/// [`StudyError::EmptyPlan`] for no samples; [`StudyError::Unaddressable`] for too many;
/// [`StudyError::Cancelled`].
pub fn render(
    scene: &TracedScene,
    spp: u64,
    seed: u64,
    control: Control<'_>,
) -> Result<Image, StudyError> {
    let [width, height] = scene.scene().camera.resolution;
    check(scene, spp, seed)?;
    let rows: Vec<Vec<Rgb>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let pixel = |x| mean_radiance(scene, key(seed, [x, y], spp), control);
            (0..width).map(pixel).collect()
        })
        .collect();
    if control.cancel.load(Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    Ok(Image { width, height, pixels: rows.concat() })
}

/// Some pixels of the picture that [`render`] makes, in the order asked for.
///
/// # Errors
/// As [`render`].
pub fn render_pixels(
    scene: &TracedScene,
    pixels: &[[u32; 2]],
    spp: u64,
    seed: u64,
    control: Control<'_>,
) -> Result<Vec<Rgb>, StudyError> {
    check(scene, spp, seed)?;
    let radiance = |&pixel: &[u32; 2]| mean_radiance(scene, key(seed, pixel, spp), control);
    let colours = pixels.par_iter().map(radiance).collect();
    if control.cancel.load(Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    Ok(colours)
}

fn key(seed: u64, pixel: [u32; 2], spp: u64) -> StreamKey {
    StreamKey { seed, pixel, sampler: Jittered.stream_id(), n_samples: spp, trial: 0 }
}

fn check(scene: &TracedScene, spp: u64, seed: u64) -> Result<(), StudyError> {
    if spp == 0 {
        return Err(StudyError::EmptyPlan("samples"));
    }
    let last = scene.scene().camera.resolution.map(|side| side.saturating_sub(1));
    key(seed, last, spp).check()
}

/// Whatever is there when cancelled.
fn mean_radiance(scene: &TracedScene, key: StreamKey, control: Control<'_>) -> Rgb {
    /// Points at a time.
    const BLOCK: u64 = 512;
    let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: true };
    let source = Jittered.points(&set);
    let camera = &scene.scene().camera;
    let frame = camera.pixel(key.pixel);
    let n = key.n_samples;
    let mut points = [0.0; 2 * BLOCK as usize];
    let mut sum = [0.0; 3];
    for first in (0..n).step_by(BLOCK as usize) {
        if control.cancel.load(Ordering::Relaxed) {
            break;
        }
        let len = BLOCK.min(n - first);
        let points = &mut points[..2 * len as usize];
        source.fill(first, points);
        for point in points.chunks_exact(2) {
            let radiance = scene.radiance(camera.eye, frame.direction(point[0], point[1]));
            sum = std::array::from_fn(|i| sum[i] + radiance[i]);
        }
        (control.progress)(len);
    }
    sum.map(|channel| channel / n as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::with_threads;
    use std::sync::atomic::{AtomicBool, AtomicU64};

    fn small() -> TracedScene {
        let mut scene = crate::scene::load("classic").unwrap();
        scene.camera.resolution = [24, 16];
        TracedScene::new(scene)
    }

    #[test]
    fn threads_change_no_bit() {
        let scene = small();
        let picture = |threads| {
            with_threads(Some(threads), || render(&scene, 5, 7, Control::unwatched()).unwrap())
        };
        let one = picture(1);
        assert_eq!((one.width, one.height, one.pixels.len()), (24, 16, 24 * 16));
        assert_eq!(one, picture(2));
        assert_ne!(one, render(&scene, 5, 8, Control::unwatched()).unwrap());
        let some = [[23, 15], [3, 2]];
        let pixels = render_pixels(&scene, &some, 5, 7, Control::unwatched()).unwrap();
        assert_eq!(pixels, some.map(|[x, y]| one.pixels[(y * 24 + x) as usize]));
    }

    #[test]
    fn progress_counts_samples_and_a_cancelled_picture_is_an_error() {
        let scene = small();
        let count = AtomicU64::new(0);
        let cancel = AtomicBool::new(false);
        let progress = |n| {
            count.fetch_add(n, Ordering::Relaxed);
        };
        let control = Control { cancel: &cancel, progress: &progress, clock: None };
        render(&scene, 600, 1, control).unwrap();
        assert_eq!(count.load(Ordering::Relaxed), 600 * 24 * 16);
        cancel.store(true, Ordering::Relaxed);
        assert_eq!(render(&scene, 600, 1, control), Err(StudyError::Cancelled));
    }

    #[test]
    fn sample_counts_out_of_range_are_refused() {
        let scene = small();
        for spp in [0, 1 << 44] {
            assert!(render(&scene, spp, 1, Control::unwatched()).is_err());
        }
    }
}
