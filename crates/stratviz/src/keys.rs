//! The keyboard, and files that are dropped.

use crate::actions::{ALL, Now, Trigger};
use crate::command::Command;
use eframe::egui::{Context, Event};

/// What the keys pressed in this frame ask for. A field that is typed into keeps its keys, a
/// control that was reached by Tab the arrows, Space and Enter.
pub fn commands(ctx: &Context, now: &Now<'_>) -> Vec<Command> {
    let is_typing = ctx.text_edit_focused();
    let is_in_control = ctx.memory(|memory| memory.focused()).is_some();
    let command = |event: &Event| {
        let pressed = Trigger::of(event)?;
        let is_theirs = if is_typing {
            !pressed.is_free_while_typing()
        } else {
            is_in_control && pressed.is_for_controls()
        };
        if is_theirs {
            return None;
        }
        match event {
            Event::Paste(text) => Some(Command::OpenLine(text.clone())),
            _ => asked(&pressed, now),
        }
    };
    ctx.input(|input| input.events.iter().filter_map(command).collect())
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
