//! Keys as they are pressed and as they are written.

use crate::state::Page;
use eframe::egui::{Event, Key, KeyboardShortcut, ModifierNames, Modifiers};

/// A key that asks for an action.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trigger {
    shortcut: KeyboardShortcut,
    /// The only page on which it does.
    page: Option<Page>,
}

/// A key by itself.
pub(super) const fn key(key: Key) -> Trigger {
    with(Modifiers::NONE, key)
}

/// A key with Shift.
pub(super) const fn shift(key: Key) -> Trigger {
    with(Modifiers::SHIFT, key)
}

/// A key with Ctrl, or with ⌘ where that is customary.
pub(super) const fn ctrl(key: Key) -> Trigger {
    with(Modifiers::COMMAND, key)
}

/// A key with Ctrl and Shift.
pub(super) const fn ctrl_shift(key: Key) -> Trigger {
    with(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

/// A key by itself, on one page.
pub(super) const fn on(page: Page, at: Key) -> Trigger {
    Trigger { page: Some(page), ..key(at) }
}

const fn with(modifiers: Modifiers, key: Key) -> Trigger {
    Trigger { shortcut: KeyboardShortcut::new(modifiers, key), page: None }
}

impl Trigger {
    /// What the system calls copying.
    pub const COPY: Self = ctrl(Key::C);
    /// What the system calls pasting.
    pub const PASTE: Self = ctrl(Key::V);

    /// The key of an event, on whatever page.
    pub fn of(event: &Event) -> Option<Self> {
        match event {
            // The plus sign is Shift and the equals sign on many keyboards.
            Event::Key { key: Key::Plus | Key::Equals, pressed: true, modifiers, .. } => {
                Some(with(Modifiers { shift: false, ..*modifiers }, Key::Plus))
            }
            Event::Key { key, pressed: true, modifiers, .. } => Some(with(*modifiers, *key)),
            Event::Copy => Some(Self::COPY),
            Event::Paste(_) => Some(Self::PASTE),
            _ => None,
        }
    }

    /// Whether it means anything on this page.
    pub fn is_on(&self, page: Page) -> bool {
        self.page.is_none_or(|only| only == page)
    }

    /// Whether both are the same key with the same modifiers.
    pub fn is_same_key(&self, pressed: &Self) -> bool {
        let [ours, theirs] = [self.shortcut, pressed.shortcut];
        ours.logical_key == theirs.logical_key && theirs.modifiers.matches_exact(ours.modifiers)
    }

    /// Whether it is a key that a text field has no use for.
    pub fn is_free_while_typing(&self) -> bool {
        let is_text = [Self::COPY, Self::PASTE].iter().any(|text| text.is_same_key(self));
        self.shortcut.modifiers.command && !is_text
    }

    /// Whether a control that was reached by Tab has it for itself.
    pub fn is_for_controls(&self) -> bool {
        use Key::{ArrowDown, ArrowLeft, ArrowRight, ArrowUp, Enter, Space};
        [ArrowLeft, ArrowRight, ArrowUp, ArrowDown, Space, Enter]
            .contains(&self.shortcut.logical_key)
    }

    /// As it is written; with its page, where it has one and that is wanted.
    pub fn words(&self, with_page: bool) -> String {
        let words = self.shortcut.format(&ModifierNames::NAMES, cfg!(target_os = "macos"));
        match self.page.filter(|_| with_page) {
            Some(page) => format!("{words} ({})", page.name()),
            None => words,
        }
    }
}
