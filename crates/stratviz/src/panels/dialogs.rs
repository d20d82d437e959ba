//! Questions with a line of text for an answer.

use crate::command::{Command, Question};
use crate::line::{OPENED, stem};
use crate::state::{Page, State};
use eframe::egui::{self, Context, Key, TextEdit};
use std::path::PathBuf;

/// A question, and the answer so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Dialog {
    question: Question,
    answer: String,
}

/// How a dialog ended.
pub enum Answer {
    /// With a wish.
    Do(Command),
    /// With nothing.
    Never,
}

impl Dialog {
    /// Asks, and suggests an answer.
    pub fn new(question: Question, state: &State) -> Self {
        let answer = match question {
            Question::Open => state.scene.clone(),
            Question::SavePicture => format!("{}.png", stem(state)),
            Question::SaveCurve => match (state.page, state.pixels.first()) {
                (Page::Trade, _) => format!("{}-trade.csv", stem(state)),
                (Page::Pixel, Some([x, y])) => format!("{}-{x}-{y}.csv", stem(state)),
                (Page::Pixel, None) => format!("{}.csv", stem(state)),
                (Page::Theory, _) => format!("{}.csv", state.theory.name),
                (Page::Patterns, _) => format!("spectrum-{}.csv", state.patterns.n),
            },
            Question::SaveDiscrepancies => "discrepancy.csv".to_owned(),
            Question::OpenLine => String::new(),
        };
        Self { question, answer }
    }

    fn title(&self) -> &'static str {
        match self.question {
            Question::Open => "Open a scene",
            Question::SavePicture => "Save the picture",
            Question::SaveCurve => "Save the curves",
            Question::SaveDiscrepancies => "Save the discrepancies",
            Question::OpenLine => "Open a command",
        }
    }

    fn hint(&self) -> String {
        match self.question {
            Question::Open => {
                "A path to a .toml or .obj, or a built-in name. Files can be dropped on the window."
                    .to_owned()
            }
            Question::SavePicture => ".png: 8-bit sRGB. .exr: 32-bit linear RGB.".to_owned(),
            Question::SaveCurve | Question::SaveDiscrepancies => {
                ".csv: every number. .svg or .png: the chart.".to_owned()
            }
            Question::OpenLine => format!("Lines of stratcli {OPENED}."),
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
