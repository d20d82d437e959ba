//! What one frame of the explorer costs the window's thread, without a GPU or a rasteriser:
//! panels, plots and tessellation, when all is still and while workers run. And how soon after a
//! click the window has a first curve, while the picture is rendered and when it stands.

use divan::Bencher;
use eframe::egui::{Context, RawInput, Rect, pos2, vec2};
use std::sync::{Arc, mpsc};
use stratviz::app::App;
use stratviz::command::Command;
use stratviz::jobs::Wake;
use stratviz::model::Progress;
use stratviz::state::{Overlay, Page, PatternWords, PictureWords, State};

fn main() {
    divan::main();
}

/// The explorer without a window.
struct Headless {
    ctx: Context,
    app: App,
    bell: mpsc::Receiver<()>,
    size: [f32; 2],
}

impl Headless {
    fn open(page: Page, size: [f32; 2]) -> Self {
        let (ring, bell) = mpsc::channel();
        let wake: Wake = Arc::new(move || ring.send(()).unwrap_or_default());
        let mut state = State { scene: "edges".to_owned(), page, ..State::default() };
        state.pixels = vec![[216, 24]];
        state.picture.overlay = Overlay::Exponent;
        let mut new = Self { ctx: Context::default(), app: App::new(state, wake), bell, size };
        new.wait(|app| app.model.loading.is_none());
        new
    }

    /// Draws one frame up to what a GPU would be given: meshes and changed textures, so many.
    fn frame(&mut self) -> usize {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(self.size[0], self.size[1]));
        let input = RawInput { screen_rect: Some(rect), ..RawInput::default() };
        self.app.poll();
        let mut output = self.ctx.run_ui(input, |ui| self.app.ui(ui));
        let textures = output.textures_delta.set.len();
        output.textures_delta.clear();
        self.ctx.tessellate(output.shapes, output.pixels_per_point).len() + textures
    }

    fn wait(&mut self, there: impl Fn(&App) -> bool) {
        loop {
            self.frame();
            if there(&self.app) {
                return;
            }
            // Whoever worked has hung up: there is nothing to wait for.
            if self.bell.recv().is_err() {
                return;
            }
        }
    }
}

const SIZES: [[f32; 2]; 2] = [[1280.0, 720.0], [2560.0, 1440.0]];

/// Four curves, the map done, nothing under way.
#[divan::bench(args = SIZES)]
fn still(bencher: Bencher<'_, '_>, size: [f32; 2]) {
    let mut window = Headless::open(Page::Pixel, size);
    let ctx = window.ctx.clone();
    window.app.apply(Command::StartMap, &ctx);
    window.wait(|app| {
        let done = [&app.model.picture_progress, &app.model.map_progress];
        done.into_iter().all(|progress| *progress == Progress::Done) && !app.model.is_busy()
    });
    bencher.bench_local(|| window.frame());
}

/// The picture, the map and the study under way.
#[divan::bench(args = SIZES, sample_count = 60)]
fn while_workers_run(bencher: Bencher<'_, '_>, size: [f32; 2]) {
    let mut window = Headless::open(Page::Pixel, size);
    let ctx = window.ctx.clone();
    let endless = |app: &mut App| {
        let mut words = app.state.study.clone();
        (words.trials, words.until) = (1_000_000, 0.0);
        app.apply(Command::SetStudy(words), &ctx);
        app.apply(Command::StartMap, &ctx);
    };
    endless(&mut window.app);
    window.wait(|app| app.model.studies.iter().any(|study| study.result.is_some()));
    bencher.bench_local(|| {
        // A frame is drawn when there is something new.
        let _ = window.bell.recv();
        window.frame()
    });
}

/// Points, power, radial means and discrepancies.
#[divan::bench(args = SIZES)]
fn patterns(bencher: Bencher<'_, '_>, size: [f32; 2]) {
    let mut window = Headless::open(Page::Patterns, size);
    window.wait(|app| !app.model.is_busy());
    bencher.bench_local(|| window.frame());
}

/// The same, with every pair of six dimensions of the points.
#[divan::bench(args = SIZES)]
fn pairs(bencher: Bencher<'_, '_>, size: [f32; 2]) {
    let mut window = Headless::open(Page::Patterns, size);
    let ctx = window.ctx.clone();
    let words = PatternWords { all_pairs: true, ..PatternWords::default().in_dim(6) };
    window.app.apply(Command::SetPatterns(words), &ctx);
    window.wait(|app| !app.model.is_busy());
    bencher.bench_local(|| window.frame());
}

/// From the click to the curve: an edge, under four samplers, by beam.
#[divan::bench(args = [false, true], sample_count = 40)]
fn first_curve(bencher: Bencher<'_, '_>, is_rendering: bool) {
    let mut window = Headless::open(Page::Pixel, SIZES[0]);
    window.wait(|app| app.model.picture_progress == Progress::Done && !app.model.is_busy());
    let ctx = window.ctx.clone();
    if is_rendering {
        let words = PictureWords { spp: 4096, ..window.app.state.picture.clone() };
        window.app.apply(Command::SetPicture(words), &ctx);
    }
    let mut step = 0;
    bencher.bench_local(|| {
        step += 1;
        window.app.apply(Command::Study([216, 24 + step % 2]), &ctx);
        while window.app.model.studies.iter().all(|study| study.result.is_none()) {
            let _ = window.bell.recv();
            window.app.poll();
        }
    });
}
