//! The keyboard, as long as no field is being typed into.

use crate::command::Command;
use crate::model::{Model, Progress};
use crate::panels::dialogs::Dialog;
use crate::panels::inside::step_count;
use crate::panels::patterns::step_admitted;
use crate::panels::top::Wish;
use crate::state::{InsideWords, Overlay, Page, PatternWords, PictureWords, State};
use eframe::egui::{Context, Event, Key, Modifiers};
use std::path::Path;

/// What the keys pressed in this frame ask for.
pub fn wishes(ctx: &Context, state: &State, model: &Model, hovered: Option<[u32; 2]>) -> Vec<Wish> {
    let mut wishes = dropped_files(ctx);
    if ctx.text_edit_focused() {
        return wishes;
    }
    // A control that was reached by Tab has the arrows and the space bar for itself.
    let is_free = ctx.memory(|memory| memory.focused()).is_none();
    ctx.input(|input| {
        for event in &input.events {
            match event {
                Event::Key { key, pressed: true, modifiers, .. } => {
                    let theirs = is_arrow(*key) || matches!(key, Key::Space | Key::Enter);
                    if is_free || !theirs {
                        wishes.extend(wish(*key, *modifiers, state, model));
                    }
                }
                Event::Copy => {
                    let pixel = hovered.or(state.pixels.first().copied());
                    let text = pixel.map(|[x, y]| format!("{x},{y}"));
                    wishes.extend(text.map(|text| Wish::Do(Command::CopyText(text))));
                }
                Event::Paste(text) => wishes.push(Wish::Do(Command::OpenLine(text.clone()))),
                _ => {}
            }
        }
    });
    wishes
}

fn is_arrow(key: Key) -> bool {
    matches!(key, Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown)
}

fn dropped_files(ctx: &Context) -> Vec<Wish> {
    let dropped = ctx.input(|input| input.raw.dropped_files.clone());
    let open = |path: &Path| Wish::Do(Command::Open(path.display().to_string()));
    dropped.first().map(|file| open(file.path())).into_iter().collect()
}

fn wish(key: Key, modifiers: Modifiers, state: &State, model: &Model) -> Option<Wish> {
    if modifiers.command {
        return match key {
            Key::O => Some(Wish::Ask(Dialog::open(state))),
            Key::S => Some(Wish::Ask(Dialog::save_picture(state))),
            Key::E => Some(Wish::Ask(Dialog::save_curve(state))),
            _ => None,
        };
    }
    let shift = modifiers.shift;
    if state.page == Page::Patterns
        && let Some(words) = patterns(key, shift, state)
    {
        return Some(Wish::Do(Command::SetPatterns(words)));
    }
    let step = if shift { 10 } else { 1 };
    let command = match key {
        Key::ArrowLeft => Command::Move([-step, 0]),
        Key::ArrowRight => Command::Move([step, 0]),
        Key::ArrowUp => Command::Move([0, -step]),
        Key::ArrowDown => Command::Move([0, step]),
        Key::E => {
            let exposure = state.picture.exposure + if shift { -0.5 } else { 0.5 };
            Command::SetPicture(PictureWords { exposure, ..state.picture.clone() })
        }
        Key::A => {
            let exposure = model.exposure_of_brightest()?;
            Command::SetPicture(PictureWords { exposure, ..state.picture.clone() })
        }
        Key::O => {
            let at = Overlay::ALL.iter().position(|overlay| *overlay == state.picture.overlay);
            let overlay = Overlay::ALL[(at.unwrap_or(0) + 1) % Overlay::ALL.len()];
            Command::SetPicture(PictureWords { overlay, ..state.picture.clone() })
        }
        Key::M if matches!(model.map_progress, Progress::Running(_)) => Command::CancelMap,
        Key::M => Command::StartMap,
        Key::Space => {
            if model.is_busy() {
                Command::Stop
            } else {
                Command::Restart
            }
        }
        Key::N => {
            let n = step_count(state.inside.n, !shift);
            Command::SetInside(InsideWords { n, ..state.inside.clone() })
        }
        Key::T => {
            let trial = state.inside.trial;
            let trial = if shift { trial.saturating_sub(1) } else { trial.saturating_add(1) };
            Command::SetInside(InsideWords { trial, ..state.inside.clone() })
        }
        Key::S => {
            let names = &state.study.samplers;
            let at = names.iter().position(|name| *name == state.inside.sampler);
            let next = at.map_or(0, |at| (at + 1) % names.len());
            let sampler = names.get(next)?.clone();
            Command::SetInside(InsideWords { sampler, ..state.inside.clone() })
        }
        Key::C => Command::CopyLine,
        Key::F5 => Command::Reload,
        Key::Num1 => Command::ShowPage(Page::Pixel),
        Key::Num2 => Command::ShowPage(Page::Theory),
        Key::Num3 => Command::ShowPage(Page::Trade),
        Key::Num4 => Command::ShowPage(Page::Patterns),
        Key::D => Command::SetDark(!state.dark),
        Key::H | Key::F1 => Command::ShowHelp(true),
        _ => return None,
    };
    Some(Wish::Do(command))
}

/// The keys of the patterns page: N, samplers and trials.
fn patterns(key: Key, shift: bool, state: &State) -> Option<PatternWords> {
    let mut words = state.patterns.clone();
    let names = &state.study.samplers;
    match key {
        Key::ArrowRight | Key::ArrowLeft | Key::N => {
            let up = key == Key::ArrowRight || key == Key::N && !shift;
            words.n = step_admitted(state.pattern_sampler(), words.n, words.dim, up);
        }
        Key::ArrowDown | Key::ArrowUp | Key::S => {
            let step = if key == Key::ArrowUp { names.len().saturating_sub(1) } else { 1 };
            words.sampler = names.get((state.pattern_place() + step) % names.len().max(1))?.clone();
        }
        Key::T if shift => words.trial = words.trial.saturating_sub(1),
        Key::T => words.trial = words.trial.saturating_add(1),
        _ => return None,
    }
    Some(words)
}
