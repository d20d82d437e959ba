//! Power over frequencies: maps, radial means and anisotropy.

use super::axis::{self, Axis, INK, MUTED, SMALL, centred, plain};
use super::chart::{Style, label, styles};
use super::raster::{Raster, viridis};
use super::svg::{Rect, Stroke, Svg};
use crate::output::csv_line;
use serde::Serialize;
use stratcore::sampler::Scramble;
use stratcore::spectrum::{Ring, Spectrum};

/// What was measured, and how.
#[derive(Debug, Serialize)]
pub struct Spectra {
    /// What the spectra are of, in words.
    pub title: String,
    /// Name of the unit of frequency.
    pub unit: &'static str,
    /// The scene whose pictures err; none for point sets.
    pub scene: Option<String>,
    /// Points in a set, or samples per pixel.
    pub n: u64,
    /// Dimensions of the points.
    pub dim: usize,
    /// Dimensions that are seen, for point sets.
    pub axes: Option<[usize; 2]>,
    /// Samples per pixel of the reference, for pictures.
    pub reference_spp: Option<u64>,
    /// Seed of all randomness.
    pub seed: u64,
    /// One for each sampler.
    pub samplers: Vec<SamplerSpectrum>,
}

/// The spectrum under one sampler.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SamplerSpectrum {
    /// Sampler's name.
    pub name: &'static str,
    /// How its sets were scrambled.
    pub scramble: Scramble,
    /// N as used.
    pub n_used: u64,
    /// Periodograms averaged.
    pub trials: u32,
    /// Mean square error of a pixel, for pictures.
    pub mse: Option<f64>,
    /// Radial mean, from the lowest frequency.
    pub rings: Vec<Ring>,
    /// The power itself.
    #[serde(skip)]
    pub spectrum: Spectrum,
}

/// Power at each frequency, in false colour from 0 to 2, frequency zero in the middle and grey.
pub fn power_map(spectrum: &Spectrum) -> Raster {
    const NO_POWER: [u8; 3] = [0x99; 3];
    let colour = |power: &f64| if power.is_nan() { NO_POWER } else { viridis(0.5 * power) };
    let size = spectrum.size().map(|side| side as u32);
    Raster { size, rgb: spectrum.power().iter().map(colour).collect() }
}

/// The map of each sampler; below, the radial means of all, and their anisotropy.
pub fn chart(spectra: &Spectra) -> Svg {
    const MAP: f64 = 186.0;
    const STEP: f64 = MAP + 20.0;
    const LEFT: f64 = 78.0;
    const PER_ROW: usize = 4;
    const LEGEND_ROW: f64 = 19.0;
    let samplers = &spectra.samplers;
    let columns = samplers.len().clamp(2, PER_ROW);
    let rows = samplers.len().div_ceil(PER_ROW);
    let plot_width = (STEP * columns as f64).max(430.0);
    let maps_bottom = 48.0 + rows as f64 * (MAP + 30.0);
    let legend_top = maps_bottom + 44.0;
    let power_top = legend_top + LEGEND_ROW * samplers.len() as f64 + 8.0;
    let power_area = Rect { x: LEFT, y: power_top, w: plot_width, h: 240.0 };
    let anisotropy_area = Rect { y: power_top + 240.0 + 64.0, h: 130.0, ..power_area };
    let (width, height) = (LEFT + plot_width + 24.0, anisotropy_area.y + 130.0 + 56.0);

    let mut svg = Svg::new(width, height, &spectra.title);
    svg.text([28.0, 30.0], plain(16.0, INK), &spectra.title);
    for (i, sampler) in samplers.iter().enumerate() {
        let [x, y] = [(i % PER_ROW) as f64, (i / PER_ROW) as f64];
        let frame = Rect { x: LEFT + STEP * x, y: 68.0 + (MAP + 30.0) * y, w: MAP, h: MAP };
        svg.text([frame.x, frame.y - 7.0], plain(SMALL, INK), &sampler.label());
        svg.image(frame, power_map(&sampler.spectrum));
        svg.outline(frame, Stroke::solid("#bbbbbb", 1.0));
    }
    colour_bar(&mut svg, [LEFT, maps_bottom + 10.0]);

    let names: Vec<_> = samplers.iter().map(|sampler| sampler.name).collect();
    let styles = styles(&names);
    for (i, (sampler, style)) in samplers.iter().zip(&styles).enumerate() {
        let y = legend_top + 8.0 + LEGEND_ROW * i as f64;
        svg.line([LEFT, y], [LEFT + 34.0, y], style.stroke(1.8));
        svg.marker([LEFT + 17.0, y], style.marker, style.colour);
        svg.text([LEFT + 44.0, y + 4.5], plain(13.0, INK), &sampler.legend());
    }
    let reach = samplers.iter().filter_map(|s| s.rings.last()).map(|ring| ring.frequency);
    let x = [0.0, reach.fold(f64::MIN_POSITIVE, f64::max) * 1.02];
    let x_name = format!("distance from frequency zero, {}", spectra.unit);
    power_panel(&mut svg, power_area, x, &x_name, samplers, &styles);
    anisotropy_panel(&mut svg, anisotropy_area, x, &x_name, samplers, &styles);
    svg
}

fn colour_bar(svg: &mut Svg, [x, y]: [f64; 2]) {
    const STEPS: u32 = 96;
    let bar = Rect { x, y, w: 160.0, h: 10.0 };
    let ramp = (0..STEPS).map(|i| viridis(f64::from(i) / f64::from(STEPS - 1))).collect();
    svg.image(bar, Raster { size: [STEPS, 1], rgb: ramp });
    svg.outline(bar, Stroke::solid("#bbbbbb", 1.0));
    for (at, words) in [(0.0, "0"), (0.5, "1"), (1.0, "2 and more")] {
        svg.text([x + at * bar.w, y + 22.0], centred(SMALL, INK), words);
    }
    svg.text([x + bar.w + 44.0, y + 9.5], plain(SMALL, MUTED), "power; 1 is white noise");
}

fn power_panel(
    svg: &mut Svg,
    area: Rect,
    x: [f64; 2],
    x_name: &str,
    samplers: &[SamplerSpectrum],
    styles: &[Style],
) {
    /// Peaks beyond this would flatten everything else.
    const MOST: f64 = 4.0;
    let powers = samplers.iter().flat_map(|s| &s.rings).map(|ring| ring.power);
    let highest = powers.fold(1.5, f64::max);
    let top = if highest > MOST { MOST } else { highest * 1.06 };
    let y = Axis::linear([0.0, top], [area.y + area.h, area.y]);
    let name = if highest > MOST { "mean power, cut at 4" } else { "mean power" };
    let x = Axis::linear(x, [area.x, area.x + area.w]);
    axis::draw(svg, area, &x, &y, [x_name, name]);
    let white = [[area.x, y.at(1.0)], [area.x + area.w, y.at(1.0)]];
    svg.path(&white, Stroke { colour: "#8a8a8a", width: 0.9, dash: "4 4" });
    for (sampler, style) in samplers.iter().zip(styles) {
        curve(svg, sampler, style, |ring| [x.at(ring.frequency), y.at(ring.power.min(top))]);
    }
}

fn anisotropy_panel(
    svg: &mut Svg,
    area: Rect,
    x: [f64; 2],
    x_name: &str,
    samplers: &[SamplerSpectrum],
    styles: &[Style],
) {
    let rings = || samplers.iter().flat_map(|s| &s.rings);
    let known = || rings().map(|ring| ring.anisotropy_db).filter(|db| db.is_finite());
    let floor = |s: &SamplerSpectrum| -10.0 * f64::from(s.trials).log10();
    let floors = || samplers.iter().map(floor);
    let low = known().chain(floors()).fold(0.0, f64::min) - 2.0;
    let high = known().fold(4.0, f64::max) + 2.0;
    let y = Axis::linear([low, high], [area.y + area.h, area.y]);
    let x = Axis::linear(x, [area.x, area.x + area.w]);
    axis::draw(svg, area, &x, &y, [x_name, "anisotropy, dB"]);
    for floor in floors() {
        let line = [[area.x, y.at(floor)], [area.x + area.w, y.at(floor)]];
        svg.path(&line, Stroke { colour: "#8a8a8a", width: 0.9, dash: "4 4" });
    }
    for (sampler, style) in samplers.iter().zip(styles) {
        curve(svg, sampler, style, |ring| [x.at(ring.frequency), y.at(ring.anisotropy_db)]);
    }
}

/// A line through the rings that have a place, and about a dozen markers on it.
fn curve(
    svg: &mut Svg,
    sampler: &SamplerSpectrum,
    style: &Style,
    place: impl Fn(&Ring) -> [f64; 2],
) {
    let points: Vec<_> = sampler.rings.iter().map(place).filter(|p| p[1].is_finite()).collect();
    svg.path(&points, style.stroke(1.5));
    let every = points.len().div_ceil(12).max(1);
    for point in points.iter().step_by(every) {
        svg.marker(*point, style.marker, style.colour);
    }
}

impl SamplerSpectrum {
    fn label(&self) -> String {
        label(self.name, self.scramble)
    }

    fn legend(&self) -> String {
        let mut text = format!("{}, {} periodograms", self.label(), self.trials);
        if let Some(mse) = self.mse {
            let scientific = format!("{mse:.2e}").replace('-', "\u{2212}");
            text += &match scientific.split_once('e') {
                Some((digits, power)) => format!(", mean square error {digits} · 10^{{{power}}}"),
                None => format!(", mean square error {scientific}"),
            };
        }
        text
    }
}

/// A line per sampler and ring. What is missing is empty.
pub fn csv(spectra: &Spectra) -> String {
    let mut text = "scene,sampler,scramble,dim,n_requested,n_used,trials,seed,frequency,power,\
                    std_error,anisotropy_db,frequencies\n"
        .to_owned();
    for sampler in &spectra.samplers {
        for ring in &sampler.rings {
            text += &csv_line(&[
                spectra.scene.clone().unwrap_or_default(),
                sampler.name.to_owned(),
                sampler.scramble.to_string(),
                spectra.dim.to_string(),
                spectra.n.to_string(),
                sampler.n_used.to_string(),
                sampler.trials.to_string(),
                spectra.seed.to_string(),
                ring.frequency.to_string(),
                ring.power.to_string(),
                ring.std_error.to_string(),
                if ring.anisotropy_db.is_finite() {
                    ring.anisotropy_db.to_string()
                } else {
                    String::new()
                },
                ring.frequencies.to_string(),
            ]);
        }
    }
    text
}
