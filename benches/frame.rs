//! What one frame of the explorer costs the window's thread, without a GPU or a rasteriser:
//! panels, plots and tessellation, when all is still and while workers run. And how soon after a
//! click the window has a first curve, while the picture is rendered and when it stands.
//!
//! Frames are timed by the thread's CPU time, where the system tells it: what else runs on the
//! machine counts for little. Clicks are timed by the wall.

use eframe::egui::{Context, Event, Key, Modifiers, RawInput, Rect, pos2, vec2};
use std::io::{Write, stdout};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};
use stratviz::app::App;
use stratviz::clock::thread_cpu_time;
use stratviz::command::Command;
use stratviz::jobs::Wake;
use stratviz::model::Progress;
use stratviz::state::{Overlay, Page, PatternWords, PictureWords, State};

/// The explorer without a window.
struct Headless {
    ctx: Context,
    app: App,
    bell: mpsc::Receiver<()>,
    size: [f32; 2],
}

impl Headless {
    fn open(scene: &str, pixel: [u32; 2], page: Page, size: [f32; 2]) -> Self {
        let (ring, bell) = mpsc::channel();
        let wake: Wake = Arc::new(move || ring.send(()).unwrap_or_default());
        let mut state = State { scene: scene.to_owned(), page, ..State::default() };
        state.pixels = vec![pixel];
        state.picture.overlay = Overlay::Exponent;
        let mut new = Self { ctx: Context::default(), app: App::new(state, wake), bell, size };
        new.wait(|app| app.model.loading.is_none());
        new
    }

    fn apply(&mut self, command: Command) {
        self.app.apply(command, &self.ctx.clone());
    }

    /// Draws one frame up to what a GPU would be given: meshes and changed textures, so many.
    fn frame(&mut self, events: Vec<Event>) -> usize {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(self.size[0], self.size[1]));
        let input = RawInput { screen_rect: Some(rect), events, ..RawInput::default() };
        self.app.poll();
        let mut output = self.ctx.run_ui(input, |ui| self.app.ui(ui));
        let textures = output.textures_delta.set.len();
        output.textures_delta.clear();
        self.ctx.tessellate(output.shapes, output.pixels_per_point).len() + textures
    }

    fn wait(&mut self, there: impl Fn(&App) -> bool) {
        loop {
            self.frame(Vec::new());
            // Whoever worked has hung up: there is nothing to wait for.
            if there(&self.app) || self.bell.recv().is_err() {
                return;
            }
        }
    }

    /// The CPU time of frames, each drawn when there is something new, and at 60 Hz at least.
    fn frames(&mut self) -> Vec<Duration> {
        const FRAMES: usize = 200;
        const EVERY: Duration = Duration::from_micros(16_667);
        let time = |window: &mut Self| {
            let (wall, cpu) = (Instant::now(), thread_cpu_time());
            std::hint::black_box(window.frame(Vec::new()));
            let cpu = thread_cpu_time().zip(cpu).map(|(after, before)| after - before);
            cpu.unwrap_or_else(|| wall.elapsed())
        };
        let frame = |_| {
            let _ = self.bell.recv_timeout(EVERY); // nothing new is no fault
            time(self)
        };
        (0..FRAMES).map(frame).collect()
    }
}

fn print(what: &str, mut times: Vec<Duration>) -> std::io::Result<()> {
    times.sort_unstable();
    let ms = |time: Option<&Duration>| time.map_or(f64::NAN, |time| 1e3 * time.as_secs_f64());
    let [least, median, most] = [0, times.len() / 2, times.len() - 1].map(|i| ms(times.get(i)));
    writeln!(stdout(), "{what:44} {least:8.2} {median:8.2} {most:8.2}")
}

/// What is on the window while its frames are timed.
fn frames(size: [f32; 2]) -> std::io::Result<()> {
    let open = |page| Headless::open("edges", [216, 24], page, size);
    let name = |what: &str| format!("{what}, {} x {}", size[0], size[1]);

    let mut window = open(Page::Pixel);
    window.apply(Command::StartMap);
    window.wait(|app| {
        let done = [&app.model.picture_progress, &app.model.map_progress];
        done.into_iter().all(|progress| *progress == Progress::Done) && !app.model.is_busy()
    });
    print(&name("four curves and the map, still"), window.frames())?;
    let key = Event::Key {
        key: Key::P,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::COMMAND.plus(Modifiers::SHIFT),
    };
    window.frame(vec![key]);
    print(&name("the palette over them"), window.frames())?;

    let mut window = open(Page::Pixel);
    let study = window.app.state.study.clone();
    let words = stratviz::state::StudyWords { trials: 1_000_000, until: 0.0, ..study };
    window.apply(Command::SetStudy(words));
    window.apply(Command::SetPicture(PictureWords { spp: 4096, ..PictureWords::default() }));
    window.apply(Command::StartMap);
    window.wait(|app| app.model.studies.iter().any(|study| study.result.is_some()));
    print(&name("study, map and picture under way"), window.frames())?;

    let mut window = open(Page::Patterns);
    window.wait(|app| !app.model.is_busy());
    print(&name("points, power, discrepancy, still"), window.frames())?;
    let words = PatternWords { all_pairs: true, ..PatternWords::default().in_dim(6) };
    window.apply(Command::SetPatterns(words));
    print(&name("all pairs of six dimensions, under way"), window.frames())
}

/// From the click to the curve: four samplers.
fn clicks(what: &str, scene: &str, pixel: [u32; 2], is_rendering: bool) -> std::io::Result<()> {
    const CLICKS: u32 = 40;
    let mut window = Headless::open(scene, pixel, Page::Pixel, [1280.0, 720.0]);
    let still = |app: &App| app.model.picture_progress == Progress::Done && !app.model.is_busy();
    window.apply(Command::Stop);
    window.wait(still);
    if is_rendering {
        let words = PictureWords { spp: 4096, ..window.app.state.picture.clone() };
        window.apply(Command::SetPicture(words));
    }
    let mut times = Vec::new();
    for click in 1..=CLICKS {
        let start = Instant::now();
        window.apply(Command::Study([pixel[0], pixel[1] + click % 2]));
        while window.app.model.studies.iter().all(|study| study.result.is_none()) {
            let _ = window.bell.recv(); // the window holds a sender
            window.app.poll();
        }
        times.push(start.elapsed());
    }
    print(what, times)
}

fn main() -> std::io::Result<()> {
    writeln!(
        stdout(),
        "{:44} {:>8} {:>8} {:>8}",
        "ms of CPU time a frame",
        "least",
        "median",
        "most"
    )?;
    for size in [[1280.0, 720.0], [2560.0, 1440.0]] {
        frames(size)?;
    }
    writeln!(stdout(), "ms from a click to its first curve")?;
    clicks("an edge, by beam", "edges", [216, 24], false)?;
    clicks("the same while the picture is rendered", "edges", [216, 24], true)?;
    clicks("grass, by beam", "grass", [128, 180], false)?;
    clicks("mirrors, by rays", "classic-mirrors", [128, 150], false)?;
    clicks("a room in seven dimensions, by rays", "room-all", [150, 190], false)
}
