//! The keyboard, and files that are dropped.

use crate::actions::{ALL, Now, Trigger};
use crate::command::Command;
use eframe::egui::{Context, Event};

/// The events of this frame that may ask for something.
pub fn pressed(ctx: &Context) -> Vec<Event> {
    ctx.input(|input| input.events.iter().filter(|e| Trigger::of(e).is_some()).cloned().collect())
}

/// What one of them asks for. A field that is typed into keeps its keys, a control that was
/// reached by Tab the arrows, Space and Enter.
pub fn command(ctx: &Context, event: &Event, now: &Now<'_>) -> Option<Command> {
    let pressed = Trigger::of(event)?;
    let is_theirs = if ctx.text_edit_focused() {
        !pressed.is_free_while_typing()
    } else {
        pressed.is_for_controls() && ctx.memory(|memory| memory.focused()).is_some()
    };
    match event {
        _ if is_theirs => None,
        Event::Paste(text) => Some(Command::OpenLine(text.clone())),
        _ => asked(&pressed, now),
    }
}

/// What a key asks for.
fn asked(pressed: &Trigger, now: &Now<'_>) -> Option<Command> {
    let is_meant = |t: &Trigger| t.is_on(now.state.page) && t.is_same_key(pressed);
    let mut meant = ALL.iter().filter(|action| action.triggers.iter().any(is_meant));
    meant.find_map(|action| (action.command)(now))
}

/// Opens the first of the files that were dropped on the window.
pub fn dropped_file(ctx: &Context) -> Option<Command> {
    let dropped = ctx.input(|input| input.raw.dropped_files.first().cloned());
    dropped.map(|file| Command::Open(file.path().display().to_string()))
}
