//! The window: draws the panels, then does what they ask for.

mod obey;

use crate::actions::Now;
use crate::command::Command;
use crate::jobs::Wake;
use crate::keys;
use crate::model::Model;
use crate::panels::dialogs::{Answer, Dialog};
use crate::panels::inside::InsidePanel;
use crate::panels::palette::Palette;
use crate::panels::patterns::PatternsPanel;
use crate::panels::picture::PicturePanel;
use crate::panels::study::StudyPanel;
use crate::panels::{curve, divider, help, theory, top, trade};
use crate::state::{Page, State};
use crate::work::{Event, Work};
use eframe::egui::{self, Context, Theme, Ui};
use std::time::Duration;

/// What lies over the window and has the keyboard.
enum Over {
    Dialog(Dialog),
    Palette(Palette),
    Help,
}

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
    over: Option<Over>,
    /// The session that a pasted line opens, once its scene is there.
    pending: Option<State>,
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
            over: None,
            pending: None,
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
                    self.pending = None;
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
        let mut commands: Vec<_> = keys::dropped_file(&ctx).into_iter().collect();
        if self.over.is_none() {
            let hovered = self.picture.hovered();
            let now = Now { state: &self.state, model: &self.model, hovered };
            commands.extend(keys::commands(&ctx, &now));
        }
        commands.extend(self.draw(ui));
        for command in commands {
            self.apply(command, &ctx);
        }
        if let (Some(start), Some(end)) = (start, thread_cpu_time()) {
            self.drawing = end.saturating_sub(start);
        }
    }

    fn draw(&mut self, ui: &mut Ui) -> Vec<Command> {
        let now = &Now { state: &self.state, model: &self.model, hovered: self.picture.hovered() };
        let state = now.state;
        let mut commands = Vec::new();
        egui::Panel::top("top").show(ui, |ui| commands.extend(top::ui(ui, now)));
        let mut layout = state.layout.clone();
        let flush = egui::Frame::new();
        let whole = ui.available_rect_before_wrap();
        let width = layout.picture_width(whole.width());
        let left = egui::Panel::left("picture").resizable(false).exact_size(width).frame(flush);
        left.show(ui, |ui| commands.extend(self.picture.ui(ui, now)));
        egui::Panel::top("study").show(ui, |ui| commands.extend(self.study.ui(ui, now)));
        let right = ui.available_rect_before_wrap();
        let has_inside = state.page == Page::Pixel && !state.pixels.is_empty();
        if has_inside {
            let height = layout.inside_height(right.height());
            let bottom = egui::Panel::bottom("inside").resizable(false).exact_size(height);
            bottom.show(ui, |ui| commands.extend(self.inside.ui(ui, now)));
        }
        egui::CentralPanel::default().show(ui, |ui| {
            commands.extend(match state.page {
                Page::Pixel => curve::ui(ui, now),
                Page::Theory => theory::ui(ui, now),
                Page::Trade => trade::ui(ui, now),
                Page::Patterns => self.patterns.ui(ui, now),
            });
        });
        divider::upright(ui, whole, &mut layout.picture);
        if has_inside {
            divider::level(ui, right, &mut layout.inside);
        }
        if layout != state.layout {
            commands.push(Command::SetLayout(layout));
        }
        let answer = match &mut self.over {
            Some(Over::Dialog(dialog)) => dialog.ui(ui.ctx()),
            Some(Over::Palette(palette)) => palette.ui(ui.ctx(), now),
            Some(Over::Help) => (!help::ui(ui.ctx())).then_some(Answer::Never),
            None => None,
        };
        if let Some(answer) = answer {
            self.over = None;
            if let Answer::Do(command) = answer {
                commands.push(command);
            }
        }
        commands
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
