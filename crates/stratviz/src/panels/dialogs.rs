//! Questions with a line of text for an answer.

use crate::command::Command;
use crate::line::stem;
use crate::state::{Page, State};
use eframe::egui::{self, Context, Key, TextEdit};
use std::path::PathBuf;

/// A question, and the answer so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialog {
    question: Question,
    answer: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Question {
    Open,
    SavePicture,
    SaveCurve,
    SaveDiscrepancies,
    OpenLine,
}

/// How a dialog ended.
pub enum Answer {
    /// With a wish.
    Do(Command),
    /// With nothing.
    Never,
}

impl Dialog {
    /// Which scene?
    pub fn open(state: &State) -> Self {
        Self { question: Question::Open, answer: state.scene.clone() }
    }

    /// The picture, to which file?
    pub fn save_picture(state: &State) -> Self {
        Self { question: Question::SavePicture, answer: format!("{}.png", stem(state)) }
    }

    /// The curves, to which file?
    pub fn save_curve(state: &State) -> Self {
        let answer = match (state.page, state.pixels.first()) {
            (Page::Trade, _) => format!("{}-trade.csv", stem(state)),
            (Page::Pixel, Some([x, y])) => format!("{}-{x}-{y}.csv", stem(state)),
            (Page::Pixel, None) => format!("{}.csv", stem(state)),
            (Page::Theory, _) => format!("{}.csv", state.theory.name),
            (Page::Patterns, _) => format!("spectrum-{}.csv", state.patterns.n),
        };
        Self { question: Question::SaveCurve, answer }
    }

    /// The discrepancies of the patterns page, to which file?
    pub fn save_discrepancies() -> Self {
        Self { question: Question::SaveDiscrepancies, answer: "discrepancy.csv".to_owned() }
    }

    /// Which line of `stratcli`?
    pub fn open_line() -> Self {
        Self { question: Question::OpenLine, answer: String::new() }
    }

    /// Its title.
    pub fn title(&self) -> &'static str {
        match self.question {
            Question::Open => "Open a scene",
            Question::SavePicture => "Save the picture",
            Question::SaveCurve => "Save the curve",
            Question::SaveDiscrepancies => "Save the discrepancies",
            Question::OpenLine => "Open a command",
        }
    }

    /// The key that asks it, if there is one.
    pub fn key(&self) -> Option<&'static str> {
        match self.question {
            Question::Open => Some("Ctrl+O"),
            Question::SavePicture => Some("Ctrl+S"),
            Question::SaveCurve => Some("Ctrl+E"),
            Question::SaveDiscrepancies => None,
            Question::OpenLine => Some("Ctrl+V"),
        }
    }

    fn hint(&self) -> &'static str {
        match self.question {
            Question::Open => {
                "A path to a .toml or .obj, or a built-in name. Files can be dropped on the window."
            }
            Question::SavePicture => ".png: 8-bit sRGB. .exr: 32-bit linear RGB.",
            Question::SaveCurve | Question::SaveDiscrepancies => {
                ".csv: every number. .svg or .png: the chart."
            }
            Question::OpenLine => {
                "Lines of stratcli pixel, integrand, trade, points, spectrum, discrepancy, render or inspect."
            }
        }
    }

    fn button(&self) -> &'static str {
        match self.question {
            Question::Open | Question::OpenLine => "Open",
            Question::SavePicture | Question::SaveCurve | Question::SaveDiscrepancies => "Save",
        }
    }

    fn wish(&self) -> Command {
        let answer = self.answer.trim().to_owned();
        match self.question {
            Question::Open => Command::Open(answer),
            Question::SavePicture => Command::SavePicture(PathBuf::from(answer)),
            Question::SaveCurve => Command::SaveCurve(PathBuf::from(answer)),
            Question::SaveDiscrepancies => Command::SaveDiscrepancies(PathBuf::from(answer)),
            Question::OpenLine => Command::OpenLine(answer),
        }
    }

    /// Draws it; an answer ends it.
    pub fn ui(&mut self, ctx: &Context) -> Option<Answer> {
        let mut answer = None;
        let mut open = true;
        let window = egui::Window::new(self.title()).collapsible(false).resizable(false);
        window.open(&mut open).anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
            let label = ui.label(self.hint());
            let field = ui.add(TextEdit::singleline(&mut self.answer).desired_width(420.0));
            let field = field.labelled_by(label.id);
            let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            if !entered && !field.has_focus() && !field.lost_focus() {
                field.request_focus();
            }
            if ui.button(self.button()).clicked() || entered {
                answer = Some(Answer::Do(self.wish()));
            }
        });
        if !open || ctx.input(|input| input.key_pressed(Key::Escape)) {
            answer = Some(Answer::Never);
        }
        answer
    }
}
