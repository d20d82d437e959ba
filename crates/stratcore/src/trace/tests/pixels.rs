//! Whole pixels against their rays, an exact variance and the classes promised.

use super::*;
use crate::integrand::Integrand;
use crate::sampler::{Jittered, PointSet, Scramble};
use crate::scene::library::icosphere;
use crate::scene::{Channel, load};
use crate::study::{Control, SamplerChoice, StudyPlan, study};
use crate::theory::Class;
use std::sync::atomic::AtomicBool;

#[test]
fn a_pixel_is_its_rays() {
    let scene = TracedScene::new(scene_of(icosphere(3), dvec3(0.0, 0.5, 3.0), Light::Headlight));
    let pixel = scene.pixel([30, 25], Channel::Luminance);
    assert_eq!((pixel.dim(), pixel.axes()), (2, vec!["pixel_x".to_owned(), "pixel_y".to_owned()]));
    let frame = scene.scene().camera.pixel([30, 25]);
    let [r, g, b] = scene.radiance(scene.scene().camera.eye, frame.direction(0.25, 0.75));
    assert_eq!(pixel.eval(&[0.25, 0.75]), 0.2126 * r + 0.7152 * g + 0.0722 * b);
    assert_eq!(scene.pixel([30, 25], Channel::G).eval(&[0.25, 0.75]), g);
}

/// Pixel (88, 20) of `edges` is cut upright at 0.3: with q = frac(0.3 k) the k strata that are
/// cut are Bernoulli trials, and the variance of the mean is q(1-q) k / N² times the step's
/// square. (M-1) s²/σ² has a standard deviation of sqrt(2/(M-1)) for a normal mean; few cut
/// strata have less kurtosis. The bound of 6 of them is one false alarm in 10^8.
#[test]
fn an_upright_edge_of_the_target_has_its_exact_variance() {
    const TRIALS: u32 = 4000;
    let scene = TracedScene::new(load("edges").unwrap());
    let pixel = scene.pixel([88, 20], Channel::Luminance);
    for k in [3u64, 5, 8] {
        let n = k * k;
        let mut means = vec![0.0; TRIALS as usize];
        let key = crate::rng::StreamKey {
            seed: 1996,
            pixel: [88, 20],
            sampler: 1,
            n_samples: n,
            trial: 0,
        };
        let set = PointSet { key, dim: 2, scramble: Scramble::None, rectangular: false };
        crate::trial::trial_means(&pixel, &Jittered, &set, 0, &mut means, &AtomicBool::new(false));
        let variance = crate::variance::Moments::of(&means).variance;
        let q = (0.3 * k as f64).fract();
        let exact = q * (1.0 - q) * k as f64 / (n * n) as f64 * (0.8 - 0.1f64).powi(2);
        let ratio = variance / exact;
        let bound = 6.0 * (2.0 / f64::from(TRIALS - 1)).sqrt();
        assert!((ratio - 1.0).abs() < bound, "k = {k}: {ratio}");
    }
}

/// The classes that `assets/README.md` promises. With 200 trials the fitted exponent has a
/// standard error of 0.015; a bound of 0.08 is five of them, one false alarm in 10^6.
#[test]
fn pixels_of_the_target_have_the_classes_promised() {
    let scene = TracedScene::new(load("edges").unwrap());
    let plan = StudyPlan {
        n_trials: 200,
        samplers: vec![SamplerChoice::named("jittered").unwrap()],
        ..StudyPlan::paper()
    };
    let studied = |pixel| {
        let integrand = scene.pixel(pixel, Channel::Luminance);
        study(&integrand, pixel, &plan, Control::unwatched()).unwrap().samplers.remove(0)
    };
    for constant in [[10, 10], [68, 10], [10, 96], [96, 96]] {
        assert_eq!(studied(constant).class, Some(Class::Exact), "{constant:?}");
    }
    for (pixel, expected) in [([100, 150], 2.0), ([128, 220], 2.0), ([216, 24], 1.5)] {
        let fit = studied(pixel).fit.unwrap();
        assert!((fit.exponent - expected).abs() < 0.08, "{pixel:?}: {}", fit.exponent);
    }
    let fine = studied([230, 100]);
    assert_eq!((fine.class, fine.class_is_sure), (Some(Class::Complex), true));
    // The edge at one half: nothing varies at even k.
    for row in studied([72, 10]).rows {
        assert_eq!(row.variance_of_mean == 0.0, row.n_used.isqrt() % 2 == 0, "N = {}", row.n);
    }
}
