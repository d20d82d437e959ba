//! The window: draws the panels, then does what they ask for.

mod obey;

use crate::command::Command;
use crate::jobs::Wake;
use crate::keys;
use crate::model::Model;
use crate::panels::dialogs::{Answer, Dialog};
use crate::panels::inside::InsidePanel;
use crate::panels::patterns::PatternsPanel;
use crate::panels::picture::PicturePanel;
use crate::panels::study::StudyPanel;
use crate::panels::top::{self, Wish};
use crate::panels::{curve, divider, help, theory, trade};
use crate::state::{Page, State};
use crate::work::{Event, Work};
use eframe::egui::{self, Context, Theme, Ui, ViewportCommand};
use std::time::Duration;

/// The explorer.
pub struct App {
    /// What is remembered.
    pub state: State,
    /// What was computed.
    pub model: Model,
    work: Work,
    picture: PicturePanel,
    study: StudyPanel,
    inside: InsidePanel,
    patterns: PatternsPanel,
    dialog: Option<Dialog>,
    help: bool,
    cpu_clock: Option<Duration>,
    drawing: Duration,
}

impl App {
    /// Opens the session's scene. `wake` is called whenever a new frame is worth drawing.
    pub fn new(state: State, wake: Wake) -> Self {
        let mut app = Self {
            state,
            model: Model::default(),
            work: Work::new(wake),
            picture: PicturePanel::default(),
            study: StudyPanel::default(),
            inside: InsidePanel::default(),
            patterns: PatternsPanel::default(),
            dialog: None,
            help: false,
            cpu_clock: None,
            drawing: Duration::ZERO,
        };
        app.work.load(&app.state.scene, &mut app.model);
        app
    }

    /// Takes in what the workers sent.
    pub fn poll(&mut self) {
        for event in self.work.poll(&self.state, &mut self.model) {
            match event {
                Event::SceneLoaded => self.show_scene(),
                Event::SceneFailed => {
                    if let Some(loaded) = &self.model.loaded {
                        self.state.scene.clone_from(&loaded.spec);
                    }
                }
                Event::FilesChanged => self.work.reload(&mut self.model),
            }
        }
    }

    /// Draws everything, then obeys.
    pub fn ui(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        let start = thread_cpu_time();
        self.measure_frame(start);
        let theme = if self.state.dark { Theme::Dark } else { Theme::Light };
        ctx.set_theme(theme);
        let mut wishes = if self.dialog.is_none() && !self.help {
            keys::wishes(&ctx, &self.state, &self.model, self.picture.hovered())
        } else {
            Vec::new()
        };
        self.draw(ui, &mut wishes);
        for wish in wishes {
            match wish {
                Wish::Do(command) => self.apply(command, &ctx),
                Wish::Ask(dialog) => self.dialog = Some(dialog),
                Wish::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            }
        }
        if let (Some(start), Some(end)) = (start, thread_cpu_time()) {
            self.drawing = end.saturating_sub(start);
        }
    }

    fn draw(&mut self, ui: &mut Ui, wishes: &mut Vec<Wish>) {
        let Self { state, model, .. } = self;
        egui::Panel::top("top").show(ui, |ui| wishes.extend(top::ui(ui, state, model)));
        let mut commands = Vec::new();
        let mut layout = state.layout.clone();
        let flush = egui::Frame::new();
        let whole = ui.available_rect_before_wrap();
        let width = layout.picture_width(whole.width());
        let left = egui::Panel::left("picture").resizable(false).exact_size(width).frame(flush);
        left.show(ui, |ui| commands.extend(self.picture.ui(ui, state, model)));
        egui::Panel::top("study").show(ui, |ui| commands.extend(self.study.ui(ui, state, model)));
        let right = ui.available_rect_before_wrap();
        let has_inside = state.page == Page::Pixel && !state.pixels.is_empty();
        if has_inside {
            let height = layout.inside_height(right.height());
            let bottom = egui::Panel::bottom("inside").resizable(false).exact_size(height);
            bottom.show(ui, |ui| commands.extend(self.inside.ui(ui, state, model)));
        }
        egui::CentralPanel::default().show(ui, |ui| {
            commands.extend(match state.page {
                Page::Pixel => curve::ui(ui, state, model),
                Page::Theory => theory::ui(ui, state, model),
                Page::Trade => trade::ui(ui, state, model),
                Page::Patterns => self.patterns.ui(ui, state, model),
            });
        });
        divider::upright(ui, whole, &mut layout.picture);
        if has_inside {
            divider::level(ui, right, &mut layout.inside);
        }
        if layout != state.layout {
            commands.push(Command::SetLayout(layout));
        }
        match self.dialog.as_mut().and_then(|dialog| dialog.ui(ui.ctx())) {
            Some(Answer::Do(command)) => {
                commands.push(command);
                self.dialog = None;
            }
            Some(Answer::Never) => self.dialog = None,
            None => {}
        }
        if self.help {
            self.help = help::ui(ui.ctx());
        }
        wishes.extend(commands.into_iter().map(Wish::Do));
    }

    /// Notes the CPU time of this thread since the last frame began, and the part of it that
    /// went into the panels.
    fn measure_frame(&mut self, now: Option<Duration>) {
        if let (Some(before), Some(now)) = (self.cpu_clock, now) {
            self.model.frame_times.push([self.drawing, now.saturating_sub(before)]);
        }
        self.cpu_clock = now;
    }
}

impl eframe::App for App {
    fn logic(&mut self, _ctx: &Context, _frame: &mut eframe::Frame) {
        self.poll();
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        App::ui(self, ui);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, eframe::APP_KEY, &self.state);
    }
}

/// CPU time that this thread has used, where the system tells (Linux: proc(5), `schedstat`).
fn thread_cpu_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(text.split_whitespace().next()?.parse().ok()?))
}
