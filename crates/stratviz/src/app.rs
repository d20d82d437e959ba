//! The window: draws the panels, then does what they ask for.

use crate::command::Command;
use crate::export::Export;
use crate::jobs::Wake;
use crate::keys;
use crate::line;
use crate::model::{Model, Notice, Study};
use crate::panels::dialogs::{Answer, Dialog};
use crate::panels::inside::InsidePanel;
use crate::panels::picture::PicturePanel;
use crate::panels::study::StudyPanel;
use crate::panels::top::{self, Wish};
use crate::panels::{curve, help, theory, trade};
use crate::state::{Overlay, Page, State};
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
        for event in self.work.poll(&mut self.model) {
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
            keys::wishes(&ctx, &self.state, &self.model)
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
        let width = ui.available_width();
        let left = egui::Panel::left("picture").resizable(true).default_size(width * 0.44);
        let flush = egui::Frame::new();
        let mut commands = Vec::new();
        left.frame(flush).size_range(200.0..=width - 320.0).show(ui, |ui| {
            commands.extend(self.picture.ui(ui, state, model));
        });
        egui::Panel::top("study").show(ui, |ui| {
            commands.extend(self.study.ui(ui, state, model));
        });
        if state.page == Page::Pixel {
            let height = ui.available_height();
            let bottom = egui::Panel::bottom("inside").resizable(true).default_size(height * 0.34);
            bottom.size_range(120.0..=height * 0.7).show(ui, |ui| {
                commands.extend(self.inside.ui(ui, state, model));
            });
        }
        egui::CentralPanel::default().show(ui, |ui| {
            commands.extend(match state.page {
                Page::Pixel => curve::ui(ui, state, model),
                Page::Theory => theory::ui(ui, state, model),
                Page::Trade => trade::ui(ui, state, model),
            });
        });
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

    /// Does what was asked for.
    pub fn apply(&mut self, command: Command, ctx: &Context) {
        let Self { state, model, work, .. } = self;
        model.notice = None;
        match command {
            Command::Open(spec) => work.load(&spec, model),
            Command::Reload => work.reload(model),
            Command::Study(pixel) => self.study_pixels(vec![pixel]),
            Command::Compare(pixel) => {
                let mut pixels = state.pixels.clone();
                if !pixels.contains(&pixel) {
                    pixels.push(pixel);
                }
                self.study_pixels(pixels);
            }
            Command::Remove(pixel) => {
                let pixels = state.pixels.iter().copied().filter(|other| *other != pixel);
                let pixels = pixels.collect();
                self.study_pixels(pixels);
            }
            Command::Move(by) => self.move_pixel(by),
            Command::SetStudy(words) => {
                let redraws = words.seed != state.study.seed;
                let looks = redraws || words.channel != state.study.channel;
                state.study = words;
                if redraws {
                    work.render(state, model);
                }
                if looks {
                    work.look_inside(state, model);
                }
                self.study_again();
            }
            Command::SetPicture(words) => {
                let redraws = words.spp != state.picture.spp;
                state.picture = words;
                if redraws {
                    work.render(state, model);
                }
            }
            Command::SetInside(words) => {
                state.inside = words;
                work.look_inside(state, model);
            }
            Command::SetTheory(words) => {
                state.theory = words;
                work.theory(state, model);
            }
            Command::Stop => work.stop_studies(model),
            Command::Restart => {
                work.stop_studies(model);
                for study in model.studies.iter_mut().chain([&mut model.theory]) {
                    study.planned.clear();
                }
                self.study_again();
            }
            Command::ForgetKept => {
                for study in &mut model.studies {
                    study.kept.clear();
                }
            }
            Command::StartMap => {
                if state.picture.overlay == Overlay::Off {
                    state.picture.overlay = Overlay::Exponent;
                }
                work.start_map(state, model);
            }
            Command::CancelMap => work.cancel_map(model),
            Command::Trade => work.trade(state, model),
            Command::ShowPage(page) => {
                state.page = page;
                self.study_again();
            }
            Command::SetDark(dark) => state.dark = dark,
            Command::CopyLine => self.copy_line(ctx),
            Command::OpenLine(text) => self.open_line(&text),
            Command::SavePicture(path) => work.save(Export::picture(state, model), path),
            Command::SaveCurve(path) => work.save(Export::curves(state, model), path),
            Command::ShowHelp(help) => self.help = help,
        }
    }

    /// A scene has arrived: everything that belongs to the one before goes.
    fn show_scene(&mut self) {
        let Self { state, model, work, .. } = self;
        let Some(loaded) = &model.loaded else { return };
        let size = loaded.traced.scene().camera.resolution;
        if state.scene != loaded.spec {
            state.pixels.clear();
        }
        state.scene.clone_from(&loaded.spec);
        state.remember(&state.scene.clone());
        work.drop_scene(model);
        model.studies.clear();
        model.picture.reset(size, [0.0; 3]);
        model.map.reset(size, None);
        work.render(state, model);
        self.study_pixels(self.state.pixels.clone());
    }

    fn study_pixels(&mut self, mut pixels: Vec<[u32; 2]>) {
        let Self { state, model, work, .. } = self;
        let [width, height] = model.picture.size;
        if let Some([x, y]) = pixels.iter().find(|[x, y]| *x >= width || *y >= height) {
            let text = format!(
                "pixel {x},{y} is outside the picture of {}, which is {width} × {height}",
                state.scene
            );
            model.notice = Some(Notice { text, is_fault: true });
            pixels.retain(|[x, y]| *x < width && *y < height);
        }
        let first_before = state.pixels.first().copied();
        state.pixels = pixels;
        if first_before != state.pixels.first().copied() || model.seen.is_none() {
            work.look_inside(state, model);
        }
        self.study_again();
    }

    /// Studies what the page shows, as far as it is not under way.
    fn study_again(&mut self) {
        match self.state.page {
            Page::Pixel | Page::Trade => self.work.study(&self.state, &mut self.model),
            Page::Theory => self.work.theory(&self.state, &mut self.model),
        }
    }

    fn move_pixel(&mut self, [dx, dy]: [i64; 2]) {
        let [width, height] = self.model.picture.size;
        if width == 0 || height == 0 {
            return;
        }
        let mut pixels = self.state.pixels.clone();
        let clamped =
            |at: u32, by: i64, side: u32| (i64::from(at) + by).clamp(0, i64::from(side) - 1) as u32;
        match pixels.first_mut() {
            Some([x, y]) => [*x, *y] = [clamped(*x, dx, width), clamped(*y, dy, height)],
            None => pixels.push([width / 2, height / 2]),
        }
        let first = pixels[0];
        let mut others = pixels.split_off(1);
        others.retain(|other| *other != first);
        pixels.extend(others);
        self.picture.reveal(first);
        self.study_pixels(pixels);
    }

    /// The command line whose numbers are on screen: with the trials that were made.
    fn copy_line(&mut self, ctx: &Context) {
        let Self { state, model, .. } = self;
        let made = |study: Option<&Study>| {
            study.and_then(|s| s.result.as_ref()).map_or(state.study.trials, |r| r.trials)
        };
        let words = match (state.page, state.pixels.first()) {
            (Page::Trade, Some(pixel)) => line::trade(state, *pixel),
            (Page::Pixel, Some(pixel)) => line::pixel(state, *pixel, made(model.studies.first())),
            (Page::Pixel | Page::Trade, None) => line::render(state),
            (Page::Theory, _) => {
                line::integrand(&state.theory, &state.study, made(Some(&model.theory)))
            }
        };
        let line = line::line(&words);
        ctx.copy_text(line.clone());
        model.notice = Some(Notice { text: format!("copied: {line}"), is_fault: false });
    }

    fn open_line(&mut self, text: &str) {
        match line::open(text, &self.state) {
            Ok(state) => {
                let scene = state.scene.clone();
                let is_new = scene != self.state.scene;
                // Until the scene is there, the one on screen keeps its name.
                self.state = State { scene: self.state.scene.clone(), ..state };
                if is_new {
                    self.state.scene = scene.clone();
                    self.work.load(&scene, &mut self.model);
                } else {
                    self.model.seen = None;
                    self.study_pixels(self.state.pixels.clone());
                    self.work.render(&self.state, &mut self.model);
                }
            }
            Err(text) => self.model.notice = Some(Notice { text, is_fault: true }),
        }
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
