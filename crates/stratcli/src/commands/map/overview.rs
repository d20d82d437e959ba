//! A map at a glance: a picture of bounded size, whatever the size of the map.

use super::csv::best_mean;
use super::text;
use crate::picture::srgb_byte;
use crate::report::panels::{self, Key, Panel, class_colour, exponent_colour, sampler_colour};
use crate::report::raster::Raster;
use crate::report::svg::Svg;
use stratcore::map::{Identity, PixelReading, Summary};

/// Cells along the longer side at most: beyond it, one pixel in a square stands for all.
const MOST: u32 = 1024;

/// The panels, while pixels come in.
pub struct Overview {
    origin: [u32; 2],
    /// Pixels along the side of the square that one cell stands for.
    stride: u32,
    mean: Raster,
    /// One per sampler.
    exponents: Vec<Raster>,
    /// The unscrambled `jittered`, and its panel.
    classes: Option<(usize, Raster)>,
    /// Where there is something to compare.
    best: Option<Raster>,
}

impl Overview {
    /// Empty panels for a plan.
    pub fn new(plan: &Identity) -> Self {
        let size = plan.region.size();
        let stride = size[0].max(size[1]).div_ceil(MOST);
        let blank = || Raster::filled(size.map(|side| side.div_ceil(stride)), [0; 3]);
        Self {
            origin: [plan.region.x0, plan.region.y0],
            stride,
            mean: blank(),
            exponents: plan.samplers.iter().map(|_| blank()).collect(),
            classes: plan
                .samplers
                .iter()
                .position(|s| s.is_plain("jittered"))
                .map(|at| (at, blank())),
            best: (plan.samplers.len() > 1).then(blank),
        }
    }

    /// Draws a pixel, if it stands for its cell.
    pub fn add(&mut self, plan: &Identity, pixel: [u32; 2], readings: &[PixelReading]) {
        let offset = [pixel[0] - self.origin[0], pixel[1] - self.origin[1]];
        if offset.iter().any(|o| !o.is_multiple_of(self.stride)) {
            return;
        }
        let cell = offset.map(|o| o / self.stride);
        let at = cell[1] as usize * self.mean.size[0] as usize + cell[0] as usize;
        let level = srgb_byte(readings.first().map_or(f64::NAN, |r| best_mean(plan, r)));
        self.mean.rgb[at] = [level; 3];
        for (panel, pixel) in self.exponents.iter_mut().zip(readings) {
            let p = pixel.reading.fit.map(|fit| fit.exponent);
            panel.rgb[at] = exponent_colour(cell, p, pixel.reading.exact);
        }
        if let Some((sampler, panel)) = &mut self.classes {
            panel.rgb[at] = class_colour(cell, readings[*sampler].reading.class);
        }
        if let Some(panel) = &mut self.best {
            let exact = readings.iter().all(|pixel| pixel.reading.exact);
            let unknown = exponent_colour(cell, None, exact);
            panel.rgb[at] = best_sampler(readings).map_or(unknown, sampler_colour);
        }
    }

    /// The figure.
    pub fn draw(self, plan: &Identity, summary: &Summary) -> Svg {
        let labels: Vec<String> = plan.samplers.iter().map(|s| s.label()).collect();
        let mut all = vec![Panel { caption: "mean".to_owned(), raster: self.mean, key: Key::None }];
        for ((label, raster), found) in labels.iter().zip(self.exponents).zip(&summary.samplers) {
            let median = found.quartiles.map_or(String::new(), |q| format!(", median {:.2}", q[1]));
            let caption = format!("p under {label}{median}");
            all.push(Panel { caption, raster, key: Key::Exponent });
        }
        if let Some((_, raster)) = self.classes {
            let shares = summary.classes.iter().filter(|share| share.pixels > 0);
            let shares = shares.map(|s| format!("{:.0} % {}", 100.0 * s.share, s.class));
            let caption = format!("class: {}", shares.collect::<Vec<_>>().join(", "));
            all.push(Panel { caption, raster, key: Key::Classes });
        }
        if let Some(raster) = self.best {
            let n = plan.counts.iter().max().copied().unwrap_or(0);
            let caption = format!("least variance at N = {n}, by the fitted line");
            all.push(Panel { caption, raster, key: Key::Samplers(labels) });
        }
        let title = format!("{}: how fast its pixels converge", plan.scene);
        let [width, height] = plan.region.size();
        let shown = match self.stride {
            1 => String::new(),
            stride => format!(", one pixel in {stride} × {stride} shown"),
        };
        let subtitle = format!(
            "{width} × {height} pixels from {},{}{shown}; {}",
            plan.region.x0,
            plan.region.y0,
            text::trials(plan, Some(summary))
        );
        panels::draw(&title, &subtitle, all)
    }
}

/// The sampler whose fitted line is lowest at the largest N that all fits reach; none where some
/// sampler has no fit.
fn best_sampler(readings: &[PixelReading]) -> Option<usize> {
    let fits: Option<Vec<_>> = readings.iter().map(|pixel| pixel.reading.fit).collect();
    let fits = fits?;
    let n = fits.iter().map(|fit| fit.n_max).min()? as f64;
    let at = |i: &usize| fits[*i].variance_at(n);
    (0..fits.len()).min_by(|a, b| at(a).total_cmp(&at(b)))
}
