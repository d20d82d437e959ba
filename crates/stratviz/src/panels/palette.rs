//! Every command by its name: typing filters, Enter runs.

use super::dialogs::Answer;
use crate::actions::{Entry, Now, entries};
use eframe::egui::{self, Align, Align2, Button, Context, Key, Modifiers, RichText, TextEdit, Ui};

/// What was typed, and which of the commands found is marked.
#[derive(Debug, Clone, Default)]
pub struct Palette {
    typed: String,
    marked: usize,
}

impl Palette {
    /// Draws it; an answer ends it.
    pub fn ui(&mut self, ctx: &Context, now: &Now<'_>) -> Option<Answer> {
        const WIDTH: f32 = 560.0;
        let found = matching(entries(now), &self.typed);
        let moved = self.step(ctx, found.len());
        let entered = ctx.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter));
        let mut chosen = entered.then(|| found.get(self.marked)).flatten();
        let mut is_open = true;
        let window = egui::Window::new("Commands").collapsible(false).resizable(false);
        let window = window.open(&mut is_open).anchor(Align2::CENTER_TOP, [0.0, 60.0]);
        window.show(ctx, |ui| {
            ui.set_width(WIDTH);
            self.field(ui);
            let height = ctx.content_rect().height() - 200.0;
            egui::ScrollArea::vertical()
                .max_height(height)
                .min_scrolled_height(height)
                .auto_shrink([false, true])
                .show(ui, |ui| {
                    for (i, entry) in found.iter().enumerate() {
                        let response = ui.add(row(entry, i == self.marked, WIDTH));
                        if moved && i == self.marked {
                            response.scroll_to_me(Some(Align::Center));
                        }
                        if response.clicked() {
                            chosen = Some(entry);
                        }
                    }
                    if found.is_empty() {
                        ui.weak("No command has these words; Backspace takes some away.");
                    }
                });
        });
        if let Some(entry) = chosen {
            return Some(Answer::Do(entry.command.clone()));
        }
        let is_left = !is_open || ctx.input(|input| input.key_pressed(Key::Escape));
        is_left.then_some(Answer::Never)
    }

    fn field(&mut self, ui: &mut Ui) {
        let label = ui.label("Type to find a command, Enter runs it.");
        let field = TextEdit::singleline(&mut self.typed).desired_width(f32::INFINITY);
        let field = ui.add(field).labelled_by(label.id);
        if field.changed() {
            self.marked = 0;
        }
        field.request_focus();
    }

    /// Moves the mark by the arrow keys, which the field would take; whether it moved.
    fn step(&mut self, ctx: &Context, len: usize) -> bool {
        let pressed = |key| ctx.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let before = self.marked;
        if pressed(Key::ArrowDown) {
            self.marked += 1;
        }
        if pressed(Key::ArrowUp) {
            self.marked = self.marked.saturating_sub(1);
        }
        self.marked = self.marked.min(len.saturating_sub(1));
        before != self.marked
    }
}

fn row<'a>(entry: &'a Entry, is_marked: bool, width: f32) -> Button<'a> {
    let about = RichText::new(&entry.about).size(11.0);
    let about = if is_marked { about } else { about.weak() };
    let row = Button::selectable(is_marked, (RichText::new(&entry.name), about));
    row.shortcut_text(&entry.keys).truncate().min_size(egui::vec2(width, 0.0))
}

/// The entries that have every typed word in their name or meaning; those first whose name
/// begins with what was typed, then those that have it in their name.
fn matching(entries: Vec<Entry>, typed: &str) -> Vec<Entry> {
    let typed = typed.trim().to_lowercase();
    let has_all = |text: &str| typed.split_whitespace().all(|word| text.contains(word));
    let rank = |entry: &Entry| {
        let name = entry.name.to_lowercase();
        if name.starts_with(&typed) {
            Some(0)
        } else if has_all(&name) {
            Some(1)
        } else {
            has_all(&format!("{name} {}", entry.about.to_lowercase())).then_some(2)
        }
    };
    let mut found: Vec<_> = entries.into_iter().filter_map(|e| Some((rank(&e)?, e))).collect();
    found.sort_by_key(|(rank, _)| *rank);
    found.into_iter().map(|(_, entry)| entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::state::State;

    #[test]
    fn typing_filters_and_puts_names_first() {
        let (state, model) = (State::default(), Model::default());
        let now = Now { state: &state, model: &model, hovered: None };
        let names = |typed: &str| -> Vec<_> {
            matching(entries(&now), typed).into_iter().map(|entry| entry.name).collect()
        };
        assert_eq!(names("").len(), entries(&now).len());
        assert_eq!(names("dark"), ["Darker", "Dark or light"]);
        assert_eq!(names("  PAGE theory "), ["Theory page"]);
        assert_eq!(names("add halton"), [""; 0]);
        assert_eq!(names("remove halton"), ["Remove halton"]);
        assert!(names("openexr").is_empty(), "there is no picture to save");
        assert!(names("as csv").contains(&"Save curves…".to_owned()));
    }
}
