//! The inside of the first pixel: what it sees, the strata, and the points of one trial.

use crate::actions::{FEWER, MORE, NEXT_SAMPLER, NEXT_TRIAL, Now, STRATA};
use crate::command::Command;
use crate::jobs::Seen;
use crate::state::InsideWords;
use eframe::egui::{
    self, Color32, ColorImage, DragValue, Painter, Rect, Sense, Slider, Stroke, TextureHandle,
    TextureOptions, Ui, WidgetInfo, pos2, vec2,
};
use std::sync::Arc;
use stratcli::report::raster::stretched;
use stratcore::study::Inside;

/// Holds the magnified pixel on the GPU.
#[derive(Default)]
pub struct InsidePanel {
    texture: Option<(Arc<Inside>, TextureHandle)>,
}

/// Counts that the slider of N steps through: what a stratified sampler can make, and more.
fn counts() -> impl Iterator<Item = u64> {
    (1..=64u64).map(|k| k * k)
}

impl InsidePanel {
    /// Draws the inside and its controls.
    pub fn ui(&mut self, ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
        let Now { state, model, .. } = *now;
        let mut words = state.inside.clone();
        let mut command = None;
        let side = (ui.available_height() - 6.0).min(ui.available_width() * 0.5);
        ui.add_space(4.0);
        ui.horizontal_top(|ui| {
            let (response, painter) = ui.allocate_painter(vec2(side, side), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, "Inside"));
            painter.rect_filled(response.rect, 0.0, ui.visuals().extreme_bg_color);
            if let Some(seen) = &model.seen {
                self.paint(ui, &painter, response.rect.shrink(1.0), seen, state.strata);
            }
            ui.vertical(|ui| {
                command = controls(ui, now, &mut words);
                if let Some(fault) = &model.inside_fault {
                    ui.colored_label(ui.visuals().error_fg_color, fault);
                }
                if let Some(seen) = &model.seen {
                    for line in sentences(seen) {
                        ui.label(line);
                    }
                }
            });
        });
        if words != state.inside { Some(Command::SetInside(words)) } else { command }
    }

    fn paint(&mut self, ui: &Ui, painter: &Painter, area: Rect, seen: &Seen, strata: bool) {
        let is_known =
            self.texture.as_ref().is_some_and(|(known, _)| Arc::ptr_eq(known, &seen.inside));
        if !is_known {
            let image = shown(&seen.inside);
            let texture = ui.ctx().load_texture("inside", image, TextureOptions::NEAREST);
            self.texture = Some((seen.inside.clone(), texture));
        }
        let Some((_, texture)) = &self.texture else { return };
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture.id(), area, uv, Color32::WHITE);
        if let Some(strata) = seen.strata.filter(|_| strata) {
            paint_strata(painter, area, strata, &seen.shares);
        }
        let radius = (area.width() / (seen.n_used as f32).sqrt() * 0.12).clamp(1.2, 4.0);
        for [u, v] in &seen.points {
            let at = area.min + vec2(*u as f32, *v as f32) * area.size();
            painter.circle(at, radius, Color32::WHITE, Stroke::new(1.0, Color32::BLACK));
        }
    }
}

/// Strata that carry variance are red, the more the stronger; the others have a grid only.
fn paint_strata(painter: &Painter, area: Rect, [across, down]: [u64; 2], shares: &[f64]) {
    let cell = vec2(area.width() / across as f32, area.height() / down as f32);
    let largest = shares.iter().copied().fold(0.0, f64::max);
    for (i, share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
        let (x, y) = (i as u64 % across, i as u64 / across);
        let at = area.min + vec2(x as f32, y as f32) * cell;
        // The eye judges areas: the square root keeps small shares visible.
        let strength = 0.1 + 0.4 * (share / largest).sqrt() as f32;
        let red = Color32::from_rgb(0xff, 0x20, 0x20).gamma_multiply(strength);
        painter.rect_filled(Rect::from_min_size(at, cell), 0.0, red);
    }
    if cell.min_elem() >= 3.0 {
        let stroke = Stroke::new(1.0, Color32::from_rgba_unmultiplied(255, 220, 0, 130));
        for i in 0..=across {
            painter.vline(area.left() + i as f32 * cell.x, area.y_range(), stroke);
        }
        for i in 0..=down {
            painter.hline(area.x_range(), area.top() + i as f32 * cell.y, stroke);
        }
    }
}

fn controls(ui: &mut Ui, now: &Now<'_>, words: &mut InsideWords) -> Option<Command> {
    let page = now.state.page;
    let mut command = None;
    ui.heading("Inside the pixel");
    ui.horizontal_wrapped(|ui| {
        let shown = egui::ComboBox::from_id_salt("inside sampler").selected_text(&words.sampler);
        let shown = shown.show_ui(ui, |ui| {
            for name in &now.state.study.samplers {
                ui.selectable_value(&mut words.sampler, name.clone(), name);
            }
        });
        shown.response.on_hover_text(NEXT_SAMPLER.hint(page));
        let label = ui.label("trial");
        ui.add(DragValue::new(&mut words.trial)).labelled_by(label.id);
        for action in [NEXT_TRIAL, STRATA] {
            command = command.take().or(action.button(ui, now));
        }
    });
    let steps: Vec<_> = counts().collect();
    let mut at = steps.partition_point(|n| *n < words.n).min(steps.len() - 1);
    let label = ui.label(format!("N = {}", words.n));
    let slider = Slider::new(&mut at, 0..=steps.len() - 1).show_value(false);
    let slider = ui.add(slider).labelled_by(label.id);
    if slider.on_hover_text([MORE, FEWER].map(|action| action.hint(page)).join("\n")).changed() {
        words.n = steps[at];
    }
    command
}

/// The next larger or smaller count of the slider.
pub fn step_count(n: u64, up: bool) -> u64 {
    let next = if up { counts().find(|m| *m > n) } else { counts().take_while(|m| *m < n).last() };
    next.unwrap_or(n)
}

/// What the picture says, in words.
fn sentences(seen: &Seen) -> Vec<String> {
    let mut lines = Vec::new();
    if seen.n_used != seen.asked.n {
        lines.push(format!(
            "{} has no set of {} points; {} are shown.",
            seen.asked.sampler, seen.asked.n, seen.n_used
        ));
    }
    match seen.strata {
        Some([across, down]) => {
            let cut = seen.shares.iter().filter(|share| **share > 0.0).count();
            let all = across * down;
            if cut == 0 {
                lines.push(format!("No variance is seen within any of {all} strata."));
            } else {
                let most = carriers(&seen.shares, 0.9);
                lines.push(format!(
                    "{cut} of {all} strata see more than one value (red) and carry all the \
                     variance; {most} carry 90 % of it."
                ));
            }
        }
        None => lines.push(format!("{} has no grid of strata.", seen.asked.sampler)),
    }
    lines
}

/// How many of the largest shares make up this part of the whole.
fn carriers(shares: &[f64], part: f64) -> usize {
    let mut sorted = shares.to_vec();
    sorted.sort_by(|a, b| b.total_cmp(a));
    let mut sum = 0.0;
    sorted.iter().take_while(|share| (sum < part, sum += **share).0).count()
}

/// The inside as it is shown.
fn shown(inside: &Inside) -> ColorImage {
    let colours = stretched(&inside.rgb);
    let pixels = colours.iter().map(|rgb| super::colours::screen(rgb, 1.0)).collect();
    ColorImage::new([inside.side as usize; 2], pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slider_steps_through_squares() {
        assert_eq!((step_count(64, true), step_count(64, false)), (81, 49));
        assert_eq!((step_count(1, false), step_count(4096, true)), (1, 4096));
    }

    #[test]
    fn carriers_are_counted_from_the_largest() {
        assert_eq!(carriers(&[0.1, 0.5, 0.0, 0.4], 0.9), 2);
        assert_eq!(carriers(&[0.25; 4], 1.0), 4);
        assert_eq!(carriers(&[0.0; 4], 0.9), 4);
    }
}
