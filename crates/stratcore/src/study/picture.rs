//! Pictures of a scene.

use super::{Control, SamplerChoice};
use crate::error::StudyError;
use crate::rng::StreamKey;
use crate::sampler::{self, CountPolicy, PointSet};
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

/// The picture of a scene: the mean radiance of each pixel over `spp` points of a sampler, in as
/// many dimensions as the scene has. Jittered points fill a grid as nearly square as `spp` allows. Progress is counted in samples.
///
/// # Errors
/// [`StudyError::EmptyPlan`] for no samples; [`StudyError::Unaddressable`] for too many;
/// [`StudyError::CountNotAdmitted`], [`StudyError::ScrambleNotSupported`];
/// [`StudyError::Cancelled`].
pub fn render(
    scene: &TracedScene,
    choice: SamplerChoice,
    spp: u64,
    seed: u64,
    control: Control<'_>,
) -> Result<Image, StudyError> {
    let set = check(scene, choice, spp, seed)?;
    let [width, height] = scene.scene().camera.resolution;
    let rows: Vec<Vec<Rgb>> = (0..height)
        .into_par_iter()
        .map(|y| {
            let pixel = |x| mean_radiance(scene, choice, &at(set, [x, y]), control);
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
    choice: SamplerChoice,
    spp: u64,
    seed: u64,
    control: Control<'_>,
) -> Result<Vec<Rgb>, StudyError> {
    let set = check(scene, choice, spp, seed)?;
    let radiance = |&pixel: &[u32; 2]| mean_radiance(scene, choice, &at(set, pixel), control);
    let colours = pixels.par_iter().map(radiance).collect();
    if control.cancel.load(Ordering::Relaxed) {
        return Err(StudyError::Cancelled);
    }
    Ok(colours)
}

/// The point set of the last pixel, which has the largest address.
fn check(
    scene: &TracedScene,
    choice: SamplerChoice,
    spp: u64,
    seed: u64,
) -> Result<PointSet, StudyError> {
    let dim = scene.scene().distribution.dim();
    if spp == 0 {
        return Err(StudyError::EmptyPlan("samples"));
    }
    sampler::check_scramble(choice.sampler, choice.scramble)?;
    sampler::count_used(choice.sampler, spp, dim, CountPolicy::Rect)?;
    let pixel = scene.scene().camera.resolution.map(|side| side.saturating_sub(1));
    let sampler = choice.sampler.stream_id();
    let key = StreamKey { seed, pixel, sampler, n_samples: spp, trial: 0 };
    key.check()?;
    Ok(PointSet { key, dim, scramble: choice.scramble, rectangular: true })
}

/// The same set in another pixel.
fn at(set: PointSet, pixel: [u32; 2]) -> PointSet {
    PointSet { key: StreamKey { pixel, ..set.key }, ..set }
}

/// Whatever is there when cancelled.
fn mean_radiance(
    scene: &TracedScene,
    choice: SamplerChoice,
    set: &PointSet,
    control: Control<'_>,
) -> Rgb {
    /// Points at a time.
    const BLOCK: u64 = 512;
    let source = choice.sampler.points(set);
    let pixel = scene.colour(set.key.pixel);
    let n = set.key.n_samples;
    let mut points = vec![0.0; set.dim * BLOCK as usize];
    let mut weights = [1.0; BLOCK as usize];
    let (mut sum, mut weight) = ([0.0; 3], 0.0);
    for first in (0..n).step_by(BLOCK as usize) {
        if control.cancel.load(Ordering::Relaxed) {
            break;
        }
        let len = BLOCK.min(n - first);
        let points = &mut points[..set.dim * len as usize];
        source.fill(first, points);
        for point in points.chunks_exact(set.dim) {
            let radiance = pixel.radiance(point);
            sum = std::array::from_fn(|i| sum[i] + radiance[i]);
        }
        let weights = &mut weights[..len as usize];
        if pixel.is_weighted() {
            pixel.weigh_block(points, weights);
        }
        weight += weights.iter().sum::<f64>();
        (control.progress)(len);
    }
    sum.map(|channel| channel / weight)
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
            with_threads(Some(threads), || {
                render(&scene, SamplerChoice::JITTERED, 5, 7, Control::unwatched()).unwrap()
            })
        };
        let one = picture(1);
        assert_eq!((one.width, one.height, one.pixels.len()), (24, 16, 24 * 16));
        assert_eq!(one, picture(2));
        assert_ne!(
            one,
            render(&scene, SamplerChoice::JITTERED, 5, 8, Control::unwatched()).unwrap()
        );
        let some = [[23, 15], [3, 2]];
        let pixels =
            render_pixels(&scene, &some, SamplerChoice::JITTERED, 5, 7, Control::unwatched());
        assert_eq!(pixels.unwrap(), some.map(|[x, y]| one.pixels[(y * 24 + x) as usize]));
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
        render(&scene, SamplerChoice::JITTERED, 600, 1, control).unwrap();
        assert_eq!(count.load(Ordering::Relaxed), 600 * 24 * 16);
        cancel.store(true, Ordering::Relaxed);
        assert_eq!(
            render(&scene, SamplerChoice::JITTERED, 600, 1, control),
            Err(StudyError::Cancelled)
        );
    }

    #[test]
    fn sample_counts_out_of_range_are_refused() {
        let scene = small();
        let refused = |choice, spp| {
            assert!(render(&scene, choice, spp, 1, Control::unwatched()).is_err(), "{spp}");
        };
        for spp in [0, 1 << 44] {
            refused(SamplerChoice::JITTERED, spp);
        }
        refused(SamplerChoice::named("zsobol").unwrap(), 6);
        refused(SamplerChoice::named("jittered+owen").unwrap(), 4);
    }
}
