//! Figures 3 and 5: one pixel's curve, and the insides of three.

use super::output::Report;
use super::tally::Tally;
use crate::report::chart;
use crate::report::picture::{self, CloseUpDrawing};
use crate::report::raster::{Raster, stretched};
use crate::report::summary::{CloseUp, paper};
use anyhow::Result;
use stratcore::integrand::Integrand as _;
use stratcore::scene::{Channel, Rgb};
use stratcore::study::{Control, StudyPlan, study};
use stratcore::theory::Class;
use stratcore::trace::TracedScene;

/// Samples along each side of a magnified pixel.
const INSIDE: u32 = 128;

/// Chooses the pixels by rule, studies them once more (the same numbers, now with their rows)
/// and draws them.
pub fn draw(
    report: &mut Report,
    scene: &TracedScene,
    photo: &Raster,
    tally: &Tally,
    plan: &StudyPlan,
) -> Result<()> {
    let mut studies = Vec::new();
    for (class, paper) in paper::CLOSE_UPS {
        let Some((record, fits, candidates)) = tally.close_up(class, paper) else { continue };
        let pixel = record.pixel;
        let integrand = scene.pixel(pixel, Channel::Luminance);
        studies.push(study(&integrand, pixel, plan, Control::unwatched())?.with_paper_fits());
        report.summary.close_ups.push(CloseUp {
            class,
            pixel,
            paper,
            exponent: fits.jittered[0],
            std_error: fits.jittered[1],
            random: fits.random[0],
            random_std_error: fits.random[1],
            contrast: fits.contrast,
            candidates,
        });
    }
    let close_ups = report.summary.close_ups.clone();
    if let Some(i) = close_ups.iter().position(|c| c.class == Class::Edge) {
        let [x, y] = close_ups[i].pixel;
        let title = format!("Variance of the mean of pixel {x}, {y}");
        let caption = format!(
            "Figure 3. Variance of the mean against N in one pixel, {x}, {y}: M = {} trials per \
             point, bars are 95 % intervals, lines the least-square fits. Dashed: slopes −1, \
             −3/2 and −2.",
            plan.n_trials
        );
        report.figure("fig3-one-pixel", caption, &chart::convergence(&title, &studies[i]))?;
    }
    if !close_ups.is_empty() {
        let drawings = close_ups.iter().zip(&studies).map(|(close_up, study)| CloseUpDrawing {
            close_up,
            inside: inside(scene, close_up.pixel),
            study,
        });
        let caption = format!(
            "Figure 5. The inside of three pixels, {INSIDE} × {INSIDE} rays each, stretched to its \
             own range of brightness, with its place in the picture and its convergence. The \
             rule: among the pixels that are clearly of the class, the tenth with most contrast; of those, the one whose p is nearest to the paper's example."
        );
        let title = "A smooth, an edge and a complex pixel";
        let svg = picture::close_ups(title, photo, drawings.collect());
        report.figure("fig5-close-ups", caption, &svg)?;
    }
    report.write()
}

/// The inside of a pixel, its luminance stretched from nearly black to nearly white, its hues
/// kept.
fn inside(scene: &TracedScene, pixel: [u32; 2]) -> Raster {
    let channels = [Channel::R, Channel::G, Channel::B].map(|c| scene.pixel(pixel, c));
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(INSIDE);
    let linear: Vec<Rgb> = (0..INSIDE)
        .flat_map(|y| (0..INSIDE).map(move |x| [at(x), at(y)]))
        .map(|point| channels.each_ref().map(|channel| channel.eval(&point)))
        .collect();
    Raster::from_linear([INSIDE; 2], &stretched(&linear))
}
