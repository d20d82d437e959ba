//! Figures 2 and 4: the exponent of every chosen pixel, and the closing claims.

use super::output::Report;
use super::tally::{LEVEL, Tally, named};
use crate::cli::Common;
use crate::progress::Progress;
use crate::report::chart::Style;
use crate::report::gain;
use crate::report::histogram::{self, Look};
use crate::report::picture::{self, Cell};
use crate::report::raster::Raster;
use crate::report::summary::{Claims, Pixels, Suspect};
use anyhow::{Context, Result};
use stratcore::scene::Channel;
use stratcore::study::{StudyPlan, study, study_pixels};
use stratcore::theory::Class;
use stratcore::trace::TracedScene;

/// Trials when a conspicuous pixel is measured again.
const AGAIN_TRIALS: u32 = 2000;

/// The pixels that are studied, row by row: every one, or the middles of a lattice's cells.
pub fn chosen([width, height]: [u32; 2], lattice: Option<u32>) -> Vec<[u32; 2]> {
    let along = |length: u32| -> Vec<u32> {
        let cells = lattice.map_or(length, |side| side.min(length));
        let middle = |i: u32| (2 * u64::from(i) + 1) * u64::from(length) / (2 * u64::from(cells));
        (0..cells).map(|i| middle(i) as u32).collect()
    };
    let columns = along(width);
    along(height).into_iter().flat_map(|y| columns.iter().map(move |&x| [x, y])).collect()
}

/// Studies the pixels and draws what they show; on Ctrl-C, of those that were finished.
pub fn study_all(
    report: &mut Report,
    scene: &TracedScene,
    photo: &Raster,
    plan: &StudyPlan,
    common: &Common,
) -> Result<Tally> {
    let protocol = &report.summary.protocol;
    let pixels = chosen(protocol.resolution, protocol.lattice);
    let per_pixel = plan.counts.iter().sum::<u64>() * u64::from(plan.n_trials);
    let samples = per_pixel * plan.samplers.len() as u64 * pixels.len() as u64;
    let progress = Progress::new("pixels", samples, common);
    let mut tally = Tally::new(&plan.counts);
    let outcome = study_pixels(
        &|pixel| scene.pixel(pixel, Channel::Luminance),
        pixels.iter().copied(),
        plan,
        progress.control(),
        &mut |study| tally.add(&study),
    );
    if !tally.records().is_empty() {
        let (rows, beyond_one) = tally.comparisons();
        report.summary.pixels = Some(tally.pixels());
        let gains = tally.gains();
        report.summary.claims =
            Some(Claims { level: LEVEL, rows, beyond_one, suspects: Vec::new(), gains });
        figures(report, photo, &tally, &pixels)?;
        report.write()?;
    }
    outcome?;
    Ok(tally)
}

fn figures(report: &mut Report, photo: &Raster, tally: &Tally, chosen: &[[u32; 2]]) -> Result<()> {
    let found = report.summary.pixels.clone().context("the pixels were not studied")?;
    let noise = report.summary.protocol.noise_of_p;
    let Pixels { random, jittered, exact, partly_exact, .. } = &found;
    let marks = [Class::Complex, Class::Edge, Class::Smooth].map(|class| {
        let name = match class {
            Class::Complex => "complex, 1",
            Class::Edge => "edge, 3/2",
            _ => "smooth, 2",
        };
        (class.predicted_exponent(2).unwrap_or(f64::NAN), name)
    });
    let looks = [
        ("fig2-random", "2", random, "random", &[(1.0, "theory, 1")][..], true),
        ("fig4-jittered", "4", jittered, "jittered", &marks[..], false),
    ];
    for (name, number, exponents, sampler, marks, expected_curve) in looks {
        let title = format!("Exponents under {sampler} sampling");
        let look = Look {
            title: &title,
            colour: Style::of_sampler(sampler).colour,
            marks,
            noise,
            expected_curve,
        };
        let caption = format!(
            "Figure {number}. Histogram of p under {sampler} sampling, {} pixels: mean {:.3}, \
             standard deviation {:.3}. Grey bands: what noise alone does to one fit, ± {noise:.3}. \
             Apart are {exact} pixels of one colour, exact at every N, and {partly_exact} \
             with zero variance at some N.{}",
            exponents.pixels,
            exponents.mean,
            exponents.std_deviation,
            match exponents.histogram.outside {
                0 => String::new(),
                n => format!(" Beyond either end: {n}."),
            }
        );
        report.figure(name, caption, &histogram::draw(&exponents.histogram, &look))?;
    }
    let (size, cells) = cells(tally, chosen);
    let caption = "Figure 4, over the picture. The exponent p under jittered sampling in false \
                   colour, 1 (dark) to 2 (bright).";
    let map = picture::map("The exponent over the picture", photo.clone(), size, &cells);
    report.figure("fig4-map", caption.to_owned(), &map)?;
    let gains = report.summary.claims.as_ref().map(|claims| gain::draw(&claims.gains));
    let caption = "The closing claims. Variance of random over variance of jittered against N: \
                   median and quartiles over the pixels that are clearly of a class. Dashed: the \
                   factors 1, √N and N that the paper states.";
    match gains {
        Some(svg) => report.figure("claims-gain", caption.to_owned(), &svg),
        None => Ok(()),
    }
}

/// The map's cells: as many columns as different x were chosen, as many rows as y.
fn cells(tally: &Tally, chosen: &[[u32; 2]]) -> ([u32; 2], Vec<Cell>) {
    let columns = chosen.iter().take_while(|pixel| pixel[1] == chosen[0][1]).count();
    let mut cells = vec![Cell::Missing; chosen.len()];
    // Records come in the order in which the pixels were chosen.
    for (cell, record) in cells.iter_mut().zip(tally.records()) {
        *cell = match (record.class, record.fits) {
            (Class::Exact, _) => Cell::Exact,
            (_, Some(fits)) => Cell::Exponent(fits.jittered[0]),
            (_, None) => Cell::Missing,
        };
    }
    ([columns as u32, (chosen.len() / columns.max(1)) as u32], cells)
}

/// Measures the pixels where `jittered` looked worst once more, with another seed and so many
/// trials that chance cannot hide what is there.
pub fn measure_suspects_again(
    report: &mut Report,
    scene: &TracedScene,
    tally: &Tally,
    plan: &StudyPlan,
    common: &Common,
) -> Result<()> {
    let samples = tally.suspects().iter().map(|s| 2 * s.n * u64::from(AGAIN_TRIALS)).sum();
    let progress = Progress::new("conspicuous pixels again", samples, common);
    let mut again = Vec::new();
    for suspect in tally.suspects() {
        let plan = StudyPlan {
            counts: vec![suspect.n],
            n_trials: AGAIN_TRIALS,
            seed: plan.seed.wrapping_add(1),
            ..plan.clone()
        };
        let integrand = scene.pixel(suspect.pixel, Channel::Luminance);
        let study = study(&integrand, suspect.pixel, &plan, progress.control())?;
        let row = |name| named(&study, name).and_then(|s| s.rows.first());
        let (Some(random), Some(jittered)) = (row("random"), row("jittered")) else { continue };
        let ln_ratio = (jittered.variance_of_mean / random.variance_of_mean).ln();
        let error = (jittered.var_ln() + random.var_ln()).sqrt();
        again.push(Suspect {
            pixel: suspect.pixel,
            n: suspect.n,
            ratio: suspect.ratio,
            z: suspect.z,
            again_trials: AGAIN_TRIALS,
            again_ratio: ln_ratio.exp(),
            again_interval: [-3.0, 3.0].map(|k| (ln_ratio + k * error).exp()),
        });
    }
    if let Some(claims) = &mut report.summary.claims {
        claims.suspects = again;
    }
    report.write()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_is_even_and_inside_and_every_pixel_is_every_pixel() {
        assert_eq!(chosen([3, 2], None), [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]);
        let lattice = chosen([256, 128], Some(4));
        assert_eq!(lattice.len(), 16);
        assert_eq!([lattice[0], lattice[15]], [[32, 16], [224, 112]]);
        assert_eq!(chosen([3, 2], Some(100)), chosen([3, 2], None));
    }
}
