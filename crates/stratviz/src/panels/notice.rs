//! What was done last, or why it could not be: over the foot of the picture, so that nothing
//! moves when it comes and goes.

use crate::actions::{DISMISS, Now};
use crate::command::Command;
use eframe::egui::{Align2, Area, Context, Frame, Id, Label, Order, RichText};

/// Draws it, if there is anything to say.
pub fn ui(ctx: &Context, now: &Now<'_>) -> Option<Command> {
    /// Points from the corner: clear of what is under the pointer.
    const CORNER: [f32; 2] = [8.0, -32.0];
    const WIDTH: f32 = 520.0;
    let scene = now.model.scene_fault.as_ref().map(|fault| (format!("cannot open: {fault}"), true));
    let last = now.model.notice.as_ref().map(|notice| (notice.text.clone(), notice.is_fault));
    if scene.is_none() && last.is_none() {
        return None;
    }
    let area = Area::new(Id::unique("notice")).order(Order::Foreground);
    let shown = area.anchor(Align2::LEFT_BOTTOM, CORNER).show(ctx, |ui| {
        let frame = Frame::popup(ui.style());
        let shown = frame.show(ui, |ui| {
            ui.set_max_width(WIDTH.min(ctx.content_rect().width() - 40.0));
            for (text, is_fault) in scene.into_iter().chain(last) {
                let visuals = ui.visuals();
                let ink = if is_fault { visuals.error_fg_color } else { visuals.text_color() };
                ui.add(Label::new(RichText::new(text).color(ink)).wrap());
            }
            DISMISS.button(ui, now)
        });
        shown.inner
    });
    shown.inner
}
