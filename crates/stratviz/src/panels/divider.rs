//! The lines between parts of the window, which can be dragged.

use eframe::egui::{CursorIcon, Rect, Response, Sense, Stroke, Ui, pos2, vec2};

/// How far from the line it can be grabbed, in points.
const GRAB: f32 = 5.0;
/// The least share of a part.
const LEAST: f32 = 0.15;

/// An upright line that leaves `share` of the width to its left.
pub fn upright(ui: &mut Ui, whole: Rect, share: &mut f32) {
    let x = whole.left() + *share * whole.width();
    let handle = Rect::from_center_size(pos2(x, whole.center().y), vec2(GRAB, whole.height()));
    let response = grab(ui, "upright divider", handle, CursorIcon::ResizeHorizontal);
    if response.hovered() || response.dragged() {
        ui.painter().vline(x, whole.y_range(), stroke(ui, &response));
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        *share = ((at.x - whole.left()) / whole.width()).clamp(LEAST, 1.0 - LEAST);
    }
}

/// A level line that leaves `share` of the height above it.
pub fn level(ui: &mut Ui, whole: Rect, share: &mut f32) {
    let y = whole.top() + *share * whole.height();
    let handle = Rect::from_center_size(pos2(whole.center().x, y), vec2(whole.width(), GRAB));
    let response = grab(ui, "level divider", handle, CursorIcon::ResizeVertical);
    if response.hovered() || response.dragged() {
        ui.painter().hline(whole.x_range(), y, stroke(ui, &response));
    }
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        *share = ((at.y - whole.top()) / whole.height()).clamp(LEAST, 1.0 - LEAST);
    }
}

fn grab(ui: &Ui, name: &str, handle: Rect, cursor: CursorIcon) -> Response {
    ui.interact(handle, ui.scope_id().with(name), Sense::drag()).on_hover_and_drag_cursor(cursor)
}

fn stroke(ui: &Ui, response: &Response) -> Stroke {
    let width = if response.dragged() { 2.0 } else { 1.0 };
    Stroke::new(width, ui.visuals().widgets.hovered.fg_stroke.color)
}
