//! What the palette offers: the table, and choices that depend on the session.

use super::{ALL, Now};
use crate::command::Command;
use crate::state::{Overlay, PictureWords, State};
use stratcore::sampler::SHELF;
use stratcore::scene::library::SCENES;

/// Something that can be asked for now.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its name in a menu.
    pub name: String,
    /// What it does.
    pub about: String,
    /// Its keys on this page, or nothing.
    pub keys: String,
    /// What it asks for.
    pub command: Command,
}

impl Entry {
    fn new(name: &str, about: String, command: Command) -> Self {
        Self { name: name.to_owned(), about, keys: String::new(), command }
    }
}

/// Everything that can be asked for now.
pub fn entries(now: &Now<'_>) -> Vec<Entry> {
    let page = Some(now.state.page);
    let of_table = ALL.iter().filter_map(|action| {
        let command = (action.command)(now)?;
        let keys = action.keys(page);
        Some(Entry { keys, ..Entry::new(action.name, action.about.to_owned(), command) })
    });
    of_table
        .chain(overlays(now.state))
        .chain(samplers(now.state))
        .chain(built_in())
        .chain(recent(now.state).filter(|entry| !is_built_in(&entry.name)))
        .collect()
}

/// Scenes that are built in.
pub fn built_in() -> impl Iterator<Item = Entry> {
    SCENES.iter().map(|scene| {
        let about = format!("open the built-in scene: {}", scene.summary);
        Entry::new(scene.name, about, Command::Open(scene.name.to_owned()))
    })
}

fn is_built_in(spec: &str) -> bool {
    SCENES.iter().any(|scene| scene.name == spec)
}

/// Scenes that were opened before.
pub fn recent(state: &State) -> impl Iterator<Item = Entry> {
    state.recent.iter().map(|spec| {
        Entry::new(spec, "open this scene again".to_owned(), Command::Open(spec.clone()))
    })
}

/// What can lie over the picture.
pub fn overlays(state: &State) -> impl Iterator<Item = Entry> {
    Overlay::ALL.into_iter().map(|overlay| {
        let words = PictureWords { overlay, ..state.picture.clone() };
        let about = "show this over the picture".to_owned();
        Entry::new(overlay.label(), about, Command::SetPicture(words))
    })
}

/// Samplers, to be switched on or off.
fn samplers(state: &State) -> impl Iterator<Item = Entry> {
    SHELF.iter().filter_map(|sampler| {
        let name = sampler.name();
        let words = state.study.with_sampler_switched(name)?;
        let is_more = words.samplers.len() > state.study.samplers.len();
        let verb = if is_more { "Add" } else { "Remove" };
        let about = format!("a sampler: {}", sampler.facts().summary);
        let command = Command::SetStudy(words);
        Some(Entry::new(&format!("{verb} {name}"), about, command))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;

    #[test]
    fn the_palette_offers_what_can_be_done() {
        let mut state = State::default();
        state.remember("a.toml");
        let model = Model::default();
        let all = entries(&Now { state: &state, model: &model, hovered: None });
        let names: Vec<_> = all.iter().map(|entry| entry.name.as_str()).collect();
        for name in ["Open…", "map of p", "Remove sobol", "Add lhs", "grass", "a.toml"] {
            assert!(names.contains(&name), "{name}: {names:?}");
        }
        // Nothing is open, nothing is kept.
        for name in ["Map", "Cancel map", "Stop", "Forget kept curves", "Next axes"] {
            assert!(!names.contains(&name), "{name}");
        }
    }
}
