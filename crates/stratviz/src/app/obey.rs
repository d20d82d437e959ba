//! What the app does about a command.

use super::{App, Over};
use crate::command::{Command, Look};
use crate::export::Export;
use crate::line;
use crate::model::{Notice, Study};
use crate::panels::dialogs::Dialog;
use crate::panels::palette::Palette;
use crate::state::{Overlay, Page, State};
use eframe::egui::{Context, ViewportCommand};

impl App {
    /// Does what was asked for.
    pub fn apply(&mut self, command: Command, ctx: &Context) {
        let Self { state, model, work, .. } = self;
        model.notice = None;
        match command {
            Command::Open(spec) => {
                self.pending = None;
                work.load(&spec, model);
            }
            Command::Reload => work.reload(model),
            Command::Study(pixel) => {
                // A click on a pixel whose study was stopped runs it again.
                for study in model.studies.iter_mut().filter(|study| study.stopped) {
                    study.planned.clear();
                }
                self.turn_to_pixel();
                self.study_pixels(vec![pixel]);
            }
            Command::Compare(pixel) => {
                let mut pixels = state.pixels.clone();
                if !pixels.contains(&pixel) {
                    pixels.push(pixel);
                }
                self.turn_to_pixel();
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
                work.choose(state, model);
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
            Command::Normalise => {
                state.picture.exposure =
                    model.exposure_of_brightest().unwrap_or(state.picture.exposure);
            }
            Command::Look(look) => self.picture.look(look),
            Command::SetInside(words) => {
                state.inside = words;
                work.look_inside(state, model);
            }
            Command::SetTheory(words) => {
                state.theory = words;
                work.theory(state, model);
            }
            Command::SetTrade(words) => state.trade = words,
            Command::SetPatterns(words) => {
                state.patterns = words;
                work.patterns(state, model);
            }
            Command::SetLayout(layout) => state.layout = layout,
            Command::Stop => work.stop(model),
            Command::Restart => {
                work.stop(model);
                for study in model.studies.iter_mut().chain([&mut model.theory]) {
                    study.planned.clear();
                }
                for planned in [
                    &mut model.drawn.planned,
                    &mut model.spectra.planned,
                    &mut model.discrepancy.planned,
                ] {
                    planned.clear();
                }
                match state.page {
                    Page::Trade => work.trade(state, model),
                    Page::Pixel | Page::Theory | Page::Patterns => self.study_again(),
                }
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
            Command::SaveDiscrepancies(path) => work.save(Export::discrepancies(model), path),
            Command::CopyText(text) => {
                model.notice = Some(Notice { text: format!("copied: {text}"), is_fault: false });
                ctx.copy_text(text);
            }
            Command::ShowStrata(strata) => state.strata = strata,
            Command::Ask(question) => {
                self.over = Some(Over::Dialog(Dialog::new(question, state)));
            }
            Command::ShowHelp => self.over = Some(Over::Help),
            Command::ShowPalette => self.over = Some(Over::Palette(Palette::default())),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
        }
    }

    /// A scene has arrived: everything that belongs to the one before goes.
    pub(super) fn show_scene(&mut self) {
        let pending = self.pending.take();
        let Self { state, model, work, .. } = self;
        let Some(loaded) = &model.loaded else { return };
        let size = loaded.traced.scene().camera.resolution;
        if state.scene != loaded.spec {
            state.pixels.clear();
            self.picture.look(Look::Fit);
        }
        if let Some(pending) = pending.filter(|pending| pending.scene == loaded.spec) {
            *state = State { recent: std::mem::take(&mut state.recent), ..pending };
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
        let Self { state, model, .. } = self;
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
        let is_other = first_before != state.pixels.first().copied() || model.seen.is_none();
        // The curve has the right of way, and must have taken it before the inside begins.
        self.study_again();
        if is_other {
            self.work.look_inside(&self.state, &mut self.model);
        }
    }

    /// A click on the picture asks for a curve: turns to where there is one.
    fn turn_to_pixel(&mut self) {
        if !matches!(self.state.page, Page::Pixel | Page::Trade) {
            self.state.page = Page::Pixel;
        }
    }

    /// Studies what the page shows, as far as it is not under way.
    fn study_again(&mut self) {
        match self.state.page {
            Page::Pixel | Page::Trade => self.work.study(&self.state, &mut self.model),
            Page::Theory => self.work.theory(&self.state, &mut self.model),
            Page::Patterns => self.work.patterns(&self.state, &mut self.model),
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

    /// The command lines whose numbers are on screen: with the trials that were made.
    fn copy_line(&mut self, ctx: &Context) {
        let Self { state, model, .. } = self;
        let made = |study: Option<&Study>| {
            study.and_then(|s| s.result.as_ref()).map_or(state.study.trials, |r| r.trials)
        };
        let of_study = |study: &Study| line::pixel(state, study.pixel, made(Some(study)));
        let mut lines = match state.page {
            Page::Pixel => model.studies.iter().map(of_study).collect(),
            Page::Theory => {
                vec![line::integrand(&state.theory, &state.study, made(Some(&model.theory)))]
            }
            Page::Trade => line::trade(state).into_iter().collect(),
            Page::Patterns => {
                vec![line::points(state), line::spectrum(state), line::discrepancy(state)]
            }
        };
        if lines.is_empty() {
            lines.push(line::render(state));
        }
        let lines: Vec<_> = lines.iter().map(|words| line::line(words)).collect();
        self.apply(Command::CopyText(lines.join("\n")), ctx);
    }

    fn open_line(&mut self, text: &str) {
        match line::open(text, &self.state) {
            // Until the scene is there, what is on screen stays.
            Ok(state) if state.scene != self.state.scene => {
                self.work.load(&state.scene, &mut self.model);
                self.pending = Some(state);
            }
            Ok(state) => {
                self.state = state;
                self.model.seen = None;
                self.work.choose(&self.state, &mut self.model);
                self.study_pixels(self.state.pixels.clone());
                self.work.render(&self.state, &mut self.model);
            }
            Err(text) => self.model.notice = Some(Notice { text, is_fault: true }),
        }
    }
}
