//! Point sets by themselves: one of them, its power spectrum, radial means, discrepancies.

use super::bars::Bars;
use super::colours;
use super::plot::{log_log, marker_of, slope};
use super::study::CountsField;
use crate::command::Command;
use crate::jobs::Drawn;
use crate::model::{Model, Piece, Progress};
use crate::state::{PatternWords, State};
use eframe::egui::{
    self, Align, Color32, ColorImage, ComboBox, DragValue, Label, Layout, Rangef, Rect, RichText,
    Sense, Stroke, StrokeKind, TextureHandle, TextureOptions, Ui, UiBuilder, WidgetInfo, pos2,
    vec2,
};
use egui_plot::{AxisHints, HLine, Line, LineStyle, MarkerShape, Plot, Points};
use stratcli::report::chart::label;
use stratcli::report::discrepancy::{interval, rates};
use stratcli::report::spectrum::{SamplerSpectrum, power_map};
use stratcli::table::with_error;
use stratcore::discrepancy::Measure;
use stratcore::sampler::{CountPolicy, count_used};
use stratcore::study::{DiscrepancyCurve, SamplerChoice};

/// Between the four fields, in points.
const GAP: f32 = 10.0;

/// Holds the power of one sampler on the GPU, and the counts while they are typed.
#[derive(Default)]
pub struct PatternsPanel {
    counts: CountsField,
    power: Option<(PowerKey, TextureHandle)>,
}

/// What the power on the GPU is of: the words, the sampler, the trials.
type PowerKey = (Vec<String>, usize, u32);

impl PatternsPanel {
    /// Draws the patterns page.
    pub fn ui(&mut self, ui: &mut Ui, state: &State, model: &Model) -> Option<Command> {
        let mut words = state.patterns.clone();
        ui.horizontal_wrapped(|ui| self.controls(ui, state, &mut words));
        legend(ui, model);
        let area = ui.available_rect_before_wrap();
        let size = (area.size() - vec2(GAP, GAP)) / 2.0;
        let cell = |column: f32, row: f32| {
            Rect::from_min_size(area.min + (size + vec2(GAP, GAP)) * vec2(column, row), size)
        };
        let place = state.pattern_place();
        field(ui, cell(0.0, 0.0), |ui| points(ui, model));
        field(ui, cell(1.0, 0.0), |ui| self.power(ui, place, &model.spectra));
        field(ui, cell(0.0, 1.0), |ui| radial(ui, &model.spectra));
        field(ui, cell(1.0, 1.0), |ui| discrepancy(ui, &state.patterns, &model.discrepancy));
        ui.allocate_rect(area, Sense::hover());
        (words != state.patterns).then_some(Command::SetPatterns(words))
    }

    fn controls(&mut self, ui: &mut Ui, state: &State, words: &mut PatternWords) {
        let sampler = state.pattern_sampler().to_owned();
        let shown = ComboBox::from_id_salt("pattern sampler").selected_text(&sampler);
        let shown = shown.show_ui(ui, |ui| {
            for name in &state.study.samplers {
                ui.selectable_value(&mut words.sampler, name.clone(), name);
            }
        });
        shown.response.on_hover_text("whose points and power are seen (S, up and down)");
        let label = ui.label("N");
        let n = DragValue::new(&mut words.n).range(1..=MOST_POINTS).speed(1.0);
        ui.add(n).labelled_by(label.id).on_hover_text("points in a set (N, left and right)");
        let label = ui.label("d");
        let mut dim = words.dim;
        let slider = DragValue::new(&mut dim).range(2..=16).speed(0.05);
        ui.add(slider).labelled_by(label.id).on_hover_text("dimensions of the points");
        if dim != words.dim {
            *words = words.clone().in_dim(dim);
        }
        if words.dim > 2 {
            let label = ui.label("axes");
            let before = words.axes;
            for i in 0..2 {
                let axis = DragValue::new(&mut words.axes[i]).range(0..=words.dim - 1).speed(0.05);
                ui.add(axis).labelled_by(label.id).on_hover_text("the two dimensions seen, from 0");
            }
            if words.axes[0] == words.axes[1] {
                words.axes = before;
            }
        }
        let label = ui.label("trial");
        ui.add(DragValue::new(&mut words.trial)).labelled_by(label.id).on_hover_text("T");
        let label = ui.label("sets");
        let sets = DragValue::new(&mut words.sets).range(1..=10_000);
        let hint = "how many sets spectra and discrepancies are the means of";
        ui.add(sets).labelled_by(label.id).on_hover_text(hint);
        let shown = ComboBox::from_id_salt("measure").selected_text(&words.measure);
        let shown = shown.show_ui(ui, |ui| {
            for measure in Measure::ALL.iter().filter(|m| m.check(words.dim).is_ok()) {
                let name = measure.name().to_owned();
                let value = ui.selectable_value(&mut words.measure, name, measure.name());
                value.on_hover_text(measure.summary());
            }
        });
        shown.response.on_hover_text("the discrepancy that is measured");
        self.counts.ui(ui, "at N", "2..16^2", &mut words.counts);
    }

    /// Power over both frequencies.
    fn power(&mut self, ui: &mut Ui, place: usize, spectra: &Piece<Vec<SamplerSpectrum>>) {
        let found = spectra.result.iter().flatten().nth(place);
        let (title, about) = match found {
            Some(spectrum) => (
                format!("Power of {}", label(spectrum.name, spectrum.scramble)),
                format!("mean of {}", spectrum.trials),
            ),
            None => ("Power".to_owned(), String::new()),
        };
        caption(ui, &title, &about, &spectra.progress);
        let Some(spectrum) = found else { return };
        let key = (spectra.planned.clone(), place, spectrum.trials);
        if self.power.as_ref().is_none_or(|(known, _)| *known != key) {
            let map = power_map(&spectrum.spectrum);
            let pixels = map.rgb.iter().map(|[r, g, b]| Color32::from_rgb(*r, *g, *b)).collect();
            let image = ColorImage::new(map.size.map(|side| side as usize), pixels);
            let texture = ui.ctx().load_texture("power", image, TextureOptions::NEAREST);
            self.power = Some((key, texture));
        }
        let Some((_, texture)) = &self.power else { return };
        let area = square(ui, "Power spectrum");
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture.id(), area, uv, Color32::WHITE);
        scale(ui, area, spectrum);
    }
}

/// Dots in one picture, at the most.
pub const MOST_POINTS: u64 = 1 << 14;

/// The next larger or smaller N that a sampler has.
pub fn step_admitted(sampler: &str, n: u64, dim: usize, up: bool) -> u64 {
    let Ok(SamplerChoice { sampler, .. }) = SamplerChoice::named(sampler) else { return n };
    let used = |n| count_used(sampler, n, dim, CountPolicy::Snap).ok();
    let Some(now) = used(n) else { return n };
    let is_next = |m: &u64| if up { *m > now } else { *m < now };
    let next = if up {
        (n + 1..=MOST_POINTS).filter_map(used).find(is_next)
    } else {
        (1..n).rev().filter_map(used).find(is_next)
    };
    next.unwrap_or(now)
}

/// A part of the page, clipped to its place.
fn field(ui: &mut Ui, place: Rect, draw: impl FnOnce(&mut Ui)) {
    ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
        ui.set_clip_rect(place.expand(2.0).intersect(ui.clip_rect()));
        draw(ui);
    });
}

/// What a field shows, and how far it is.
fn caption(ui: &mut Ui, title: &str, about: &str, progress: &Progress) {
    ui.horizontal(|ui| {
        ui.strong(title);
        ui.weak(about);
        match progress {
            Progress::Running(share) => {
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    ui.spinner();
                    ui.weak(format!("{:.0} %", 100.0 * share));
                });
            }
            Progress::Stopped(share) => drop(ui.weak(format!("stopped at {:.0} %", 100.0 * share))),
            Progress::Idle | Progress::Done | Progress::Failed(_) => {}
        }
    });
    if let Progress::Failed(fault) = progress {
        ui.colored_label(ui.visuals().error_fg_color, fault);
    }
}

/// The largest square that there is room for, in the middle.
fn square(ui: &mut Ui, name: &str) -> Rect {
    let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, name));
    let side = area.size().min_elem() - 2.0;
    Rect::from_center_size(area.center(), vec2(side, side))
}

/// Key to the samplers: their colours, and the exponents of their discrepancies.
fn legend(ui: &mut Ui, model: &Model) {
    let dark = ui.visuals().dark_mode;
    let curves = model.discrepancy.result.iter().flatten();
    let spectra = model.spectra.result.iter().flatten();
    let known: Vec<_> = curves.map(|c| (c.sampler, c.scramble, c.fit)).collect();
    let others = spectra.map(|s| (s.name, s.scramble, None)).skip(known.len());
    ui.horizontal_wrapped(|ui| {
        for (name, scramble, fit) in known.iter().copied().chain(others) {
            let colour = colours::sampler(name, dark);
            // One label each: what does not fit goes to the next row as a whole.
            let mut text = label(name, scramble);
            if let Some(fit) = fit {
                text += &format!("  p = {}", with_error(fit.exponent, fit.std_error));
            }
            let text = Label::new(RichText::new(text).color(colour)).extend();
            ui.add(text).on_hover_text("discrepancy falls as N^-p");
            ui.add_space(6.0);
        }
    });
}

fn points(ui: &mut Ui, model: &Model) {
    let drawn = model.drawn.result.as_ref();
    let (title, about) = match drawn {
        Some(drawn) if drawn.n_used != drawn.n => (
            label(drawn.name, drawn.scramble),
            format!("has no set of {}; these are {}", drawn.n, drawn.n_used),
        ),
        Some(drawn) => (label(drawn.name, drawn.scramble), format!("N = {}", drawn.n_used)),
        None => ("Points".to_owned(), String::new()),
    };
    caption(ui, &title, &about, &model.drawn.progress);
    if let Some(drawn) = drawn {
        let area = square(ui, "Points");
        paint_points(ui, area, drawn);
    }
}

/// The set as `points --plot` draws it: the first axis to the right, the second upwards.
fn paint_points(ui: &Ui, area: Rect, drawn: &Drawn) {
    /// More lines than this are a grey area.
    const MOST_LINES: u64 = 64;
    let painter = ui.painter();
    painter.rect_filled(area, 0.0, ui.visuals().extreme_bg_color);
    let faint = Stroke::new(1.0, ui.visuals().weak_text_color().gamma_multiply(0.35));
    let along = |axis: usize| {
        let strata = drawn.strata.as_ref().and_then(|strata| strata.get(drawn.axes[axis]));
        strata.copied().filter(|k| *k <= MOST_LINES).unwrap_or(1)
    };
    let share = |i: u64, k: u64| i as f32 / k as f32;
    for i in 1..along(0) {
        painter.vline(area.left() + share(i, along(0)) * area.width(), area.y_range(), faint);
    }
    for i in 1..along(1) {
        painter.hline(area.x_range(), area.bottom() - share(i, along(1)) * area.height(), faint);
    }
    painter.rect_stroke(area, 0.0, faint, StrokeKind::Outside);
    let radius = (0.16 * area.width() / (drawn.n_used as f32).sqrt()).clamp(0.8, 3.5);
    let colour = colours::sampler(drawn.name, ui.visuals().dark_mode);
    for point in drawn.points.chunks_exact(drawn.dim) {
        let [u, v] = drawn.axes.map(|axis| point[axis] as f32);
        let at = pos2(area.left() + u * area.width(), area.bottom() - v * area.height());
        painter.circle_filled(at, radius, colour);
    }
}

/// The colours of power, and how far frequencies reach.
fn scale(ui: &Ui, area: Rect, spectrum: &SamplerSpectrum) {
    const STEPS: u8 = 40;
    let painter = ui.painter();
    let bar = Rect::from_min_size(pos2(area.right() + 6.0, area.top()), vec2(8.0, area.height()));
    if bar.right() + 20.0 > ui.clip_rect().right() {
        return;
    }
    let ink = ui.visuals().weak_text_color();
    let step = bar.height() / f32::from(STEPS);
    for i in 0..STEPS {
        let share = f64::from(i) / f64::from(STEPS - 1);
        let [r, g, b] = stratcli::report::raster::viridis(share);
        let at = pos2(bar.left(), bar.bottom() - step * (f32::from(i) + 1.0));
        let cell = Rect::from_min_size(at, vec2(bar.width(), step + 0.5));
        painter.rect_filled(cell, 0.0, Color32::from_rgb(r, g, b));
    }
    for (share, words) in [(0.0, "0"), (0.5, "1"), (1.0, "2+")] {
        let y = bar.bottom() - share * bar.height() + 6.0 * (share - 0.5);
        let font = egui::FontId::proportional(11.0);
        painter.text(pos2(bar.right() + 4.0, y), egui::Align2::LEFT_CENTER, words, font, ink);
    }
    let reach = (spectrum.spectrum.size()[0] / 2).to_string();
    let font = egui::FontId::proportional(11.0);
    let corner = area.left_bottom() + vec2(-4.0, 0.0);
    let words = format!("\u{b1}{reach}");
    painter.text(corner, egui::Align2::RIGHT_BOTTOM, words, font, ink);
}

fn radial(ui: &mut Ui, spectra: &Piece<Vec<SamplerSpectrum>>) {
    /// Peaks beyond this would flatten everything else.
    const MOST: f64 = 4.0;
    let dark = ui.visuals().dark_mode;
    let muted = ui.visuals().weak_text_color();
    let found = spectra.result.as_deref().unwrap_or_default();
    let is_cut = found.iter().flat_map(|s| &s.rings).any(|ring| ring.power > MOST);
    let about = if is_cut { "1 is white noise; cut at 4" } else { "1 is white noise" };
    caption(ui, "Radial mean of power", about, &Progress::Done);
    Plot::new("radial")
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .custom_x_axes(vec![axis(AxisHints::new_x().label("frequency, cycles per side"))])
        .custom_y_axes(vec![axis(AxisHints::new_y().label("mean power"))])
        .include_y(0.0)
        .include_x(0.0)
        .show(ui, |plot| {
            let white = HLine::new("white noise", 1.0).color(muted);
            plot.hline(white.style(LineStyle::dashed_dense()).allow_hover(false));
            for spectrum in found {
                let place =
                    |ring: &stratcore::spectrum::Ring| [ring.frequency, ring.power.min(MOST)];
                let points: Vec<_> = spectrum.rings.iter().map(place).collect();
                let colour = colours::sampler(spectrum.name, dark);
                plot.line(Line::new(spectrum.name, points).color(colour).width(1.5));
            }
        });
}

/// Names its marks where there is little room, too.
fn axis(hints: AxisHints<'_>) -> AxisHints<'_> {
    hints.label_spacing(Rangef::new(16.0, 30.0))
}

fn discrepancy(ui: &mut Ui, words: &PatternWords, found: &Piece<Vec<DiscrepancyCurve>>) {
    let dark = ui.visuals().dark_mode;
    let muted = ui.visuals().weak_text_color();
    let measure = words.measure.parse::<Measure>().ok();
    let title = format!("Discrepancy: {}", words.measure);
    caption(ui, &title, &format!("mean of {}", words.sets), &found.progress);
    let curves = found.result.as_deref().unwrap_or_default();
    log_log("discrepancy", "points, N", "mean discrepancy").show(ui, |plot| {
        let rows = || curves.iter().flat_map(|curve| &curve.rows).filter(|row| row.mean > 0.0);
        let lowest = rows().map(|row| row.mean.log10()).fold(f64::INFINITY, f64::min);
        let last = rows().map(|row| row.n_used).max().unwrap_or(1) as f64;
        let start = curves
            .iter()
            .rev()
            .find_map(|curve| curve.rows.iter().find(|row| row.n_used > 1 && row.mean > 0.0));
        if let (Some(row), Some(measure)) = (start, measure) {
            let from = [(row.n_used as f64).log10(), row.mean.log10()];
            for (name, p) in rates(measure) {
                slope(plot, from, [last.log10(), lowest], (p, name), muted);
            }
        }
        for curve in curves {
            let colour = colours::sampler(curve.sampler, dark);
            let rows = || curve.rows.iter().filter(|row| row.mean > 0.0);
            let place = |n: u64, value: f64| [(n as f64).log10(), value.log10()];
            if let Some(fit) = &curve.fit {
                let ends = [fit.n_min, fit.n_max].map(|n| place(n, fit.variance_at(n as f64)));
                let line = Line::new(curve.sampler, ends.to_vec()).color(colour).width(1.5);
                plot.line(line.allow_hover(false));
            }
            let bars = rows().filter(|row| row.std_error.is_some()).map(|row| {
                let [low, high] = interval(row.mean, row.std_error).map(f64::log10);
                [(row.n_used as f64).log10(), low, high]
            });
            plot.add(Bars::upright(curve.sampler, colour, bars));
            let points: Vec<_> = rows().map(|row| place(row.n_used, row.mean)).collect();
            let shape = marker_of(curve.sampler);
            let dots = Points::new(curve.sampler, points).shape(shape).radius(3.0);
            plot.points(dots.color(colour).filled(shape != MarkerShape::Circle));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_steps_through_what_the_sampler_has() {
        let up = |name, n| step_admitted(name, n, 2, true);
        let down = |name, n| step_admitted(name, n, 2, false);
        assert_eq!((up("jittered", 256), down("jittered", 256)), (289, 225));
        assert_eq!((up("random", 256), down("random", 1)), (257, 1));
        assert_eq!((up("oa", 25), down("oa", 49)), (49, 25));
        // From an N that is snapped, to the neighbours of what is shown.
        assert_eq!(up("jittered", 250), 289);
        assert_eq!(up("jittered", MOST_POINTS), MOST_POINTS);
    }
}
