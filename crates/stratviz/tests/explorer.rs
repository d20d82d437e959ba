//! The explorer driven through its accessibility tree: no display, no GPU.

use clap::Parser as _;
use eframe::egui::{Key, Modifiers, OutputCommand, Pos2, Role, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::sync::{Arc, mpsc};
use std::time::Duration;
use stratcli::cli::{Cli, Command as Words};
use stratcli::plan;
use stratcli::report::spectrum::SamplerSpectrum;
use stratcore::scene::Channel;
use stratcore::study::{Control, discrepancies, study};
use stratcore::trace::TracedScene;
use stratcore::trade::{Subject, TradeResult, trade};
use stratviz::app::App;
use stratviz::command::Command;
use stratviz::jobs::Wake;
use stratviz::line;
use stratviz::model::Progress;
use stratviz::state::{Overlay, Page, PatternWords, State, StudyWords, TradeWords};

/// The window, and the bell that workers ring.
struct Window {
    harness: Harness<'static, App>,
    bell: mpsc::Receiver<()>,
}

fn session(scene: &str) -> State {
    let study = StudyWords { trials: 120, until: 0.0, ..StudyWords::default() };
    State { scene: scene.to_owned(), study, ..State::default() }
}

impl Window {
    /// Opens the explorer on a session, and waits for its scene.
    fn open(state: State) -> Self {
        let (ring, bell) = mpsc::channel();
        let wake: Wake = Arc::new(move || {
            let _ = ring.send(()); // nobody listens after the window is closed
        });
        let app = App::new(state, wake);
        let draw = |ui: &mut eframe::egui::Ui, app: &mut App| {
            app.poll();
            app.ui(ui);
        };
        let harness = Harness::builder().with_size([1280.0, 720.0]).build_ui_state(draw, app);
        let mut window = Self { harness, bell };
        window.wait("the scene", |app| app.model.loading.is_none());
        window
    }

    /// Draws whenever a worker rings until `there` holds. Nothing depends on how long it takes;
    /// the limit ends a test that would hang.
    fn wait(&mut self, what: &str, there: impl Fn(&App) -> bool) {
        const PATIENCE: Duration = Duration::from_secs(120);
        loop {
            self.harness.step();
            if there(self.harness.state()) {
                break;
            }
            assert!(self.bell.recv_timeout(PATIENCE).is_ok(), "{what} never came");
        }
        // What depends on the size of what was drawn settles in the next frames.
        self.harness.run_steps(3);
    }

    fn click_pixel(&mut self, pixel: [u32; 2], modifiers: Modifiers) {
        let at = self.screen(pixel);
        self.harness.hover_at(at);
        for pressed in [true, false] {
            let button = eframe::egui::PointerButton::Primary;
            let event = eframe::egui::Event::PointerButton { pos: at, button, pressed, modifiers };
            self.harness.event_modifiers(event, modifiers);
        }
        self.harness.step();
    }

    /// Where the middle of a pixel is while the whole picture is seen.
    fn screen(&self, [x, y]: [u32; 2]) -> Pos2 {
        let area = self.harness.get_by_label("Picture").rect();
        let [width, height] = self.harness.state().model.picture.size;
        let size = vec2(width as f32, height as f32);
        let scale = (area.size() / size).min_elem();
        area.center() + (vec2(x as f32 + 0.5, y as f32 + 0.5) - size / 2.0) * scale
    }

    fn sees(&self, words: &str) -> bool {
        self.harness.query_all_by_label_contains(words).next().is_some()
    }

    /// What the window put into the clipboard in the last step.
    fn copied(&self) -> String {
        let commands = &self.harness.output().platform_output.commands;
        let copied = commands.iter().find_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        copied.expect("nothing was copied")
    }

    fn wait_for_studies(&mut self) {
        self.wait("the study", |app| {
            !app.model.studies.is_empty() && app.model.studies.iter().all(|study| !study.running)
        });
    }
}

#[test]
fn a_click_shows_the_curve_that_the_command_line_gives() {
    let mut window = Window::open(session("edges"));
    assert!(window.sees("edges: 256 × 256, 195470 triangles"));
    window.click_pixel([216, 24], Modifiers::NONE);
    assert_eq!(window.harness.state().state.pixels, [[216, 24]]);
    window.wait_for_studies();
    assert!(window.sees("Pixel 216, 24"));
    assert!(window.sees("M = 120 trials"));
    assert!(window.sees("An edge: the variance under jittered is √N times below random"));
    assert!(window.sees("samples of "));

    // The line that is copied, run as stratcli runs it, gives the same numbers to the last bit.
    window.harness.key_down(Key::C);
    window.harness.step();
    let copied = window.copied();
    assert!(copied.starts_with("stratcli pixel edges --at 216,24"), "{copied}");
    let opened = line::open(&copied, &State::default()).unwrap();
    let words = line::pixel(&opened, opened.pixels[0], opened.study.trials);
    let plan = line::study_plan(&words, 2).unwrap();
    let scene = stratcore::scene::load("edges").unwrap();
    let traced = TracedScene::new(scene);
    let integrand = traced.pixel([216, 24], Channel::Luminance);
    let batch = study(&integrand, [216, 24], &plan, Control::unwatched()).unwrap();
    let shown = window.harness.state().model.studies[0].result.as_ref().unwrap();
    assert_eq!(*shown, batch);
    for sampler in &batch.samplers {
        let fit = sampler.fit.unwrap();
        let p = stratcli::table::with_error(fit.exponent, fit.std_error);
        assert!(window.sees(&format!("p = {p}")), "p = {p} is not on screen");
    }
}

#[test]
fn a_sampler_that_is_switched_off_leaves_its_curve() {
    let mut window = Window::open(State { pixels: vec![[216, 24]], ..session("edges") });
    window.wait_for_studies();
    window.harness.get_by_label("Samplers (4)").click();
    window.harness.run_steps(3);
    for name in ["halton", "lhs"] {
        window.harness.get_by_role_and_label(Role::CheckBox, name).click();
        window.harness.run_steps(2);
    }
    window.wait_for_studies();
    let names = &window.harness.state().state.study.samplers;
    assert_eq!(names, &["random", "jittered", "sobol", "lhs"]);
    assert!(window.sees("kept at M = 120"), "the curve is gone");
    window.harness.key_press(Key::Escape);
    window.harness.run_steps(3);
    window.harness.get_by_label("Forget kept curves").click();
    window.harness.run_steps(2);
    assert!(!window.sees("kept at M"));
}

#[test]
fn pixels_are_compared_moved_and_removed() {
    let mut window = Window::open(session("edges"));
    window.click_pixel([216, 24], Modifiers::NONE);
    window.click_pixel([100, 150], Modifiers::SHIFT);
    window.wait_for_studies();
    assert!(window.sees("Pixel 216, 24") && window.sees("Pixel 100, 150"));
    assert!(window.sees("2: jittered"));
    window.harness.key_press(Key::ArrowRight);
    window.harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowDown);
    window.harness.run_steps(4);
    assert_eq!(window.harness.state().state.pixels, [[217, 34], [100, 150]]);
    window.click_pixel([10, 10], Modifiers::NONE);
    window.wait_for_studies();
    assert!(window.sees("Constant: every estimate is exact"));
}

#[test]
fn a_study_that_is_stopped_stays_as_it_is_and_runs_again() {
    let mut state = session("edges");
    (state.study.trials, state.pixels) = (1_000_000, vec![[216, 24]]);
    let mut window = Window::open(state);
    window.wait("a first curve", |app| app.model.studies.iter().any(|s| s.result.is_some()));
    window.harness.get_by_label("Stop").click();
    window.harness.run_steps(3);
    assert!(window.sees("stopped"));
    let before = window.harness.state().model.studies[0].result.clone();
    assert!(before.is_some());
    window.harness.run_steps(5);
    assert_eq!(window.harness.state().model.studies[0].result, before);
    window.harness.key_press(Key::Space);
    window.harness.run_steps(2);
    assert!(window.harness.state().model.studies[0].running);
    // Closed in mid-study: the worker is cancelled and hangs up.
    let Window { harness, bell } = window;
    drop(harness);
    while bell.recv_timeout(Duration::from_secs(120)).is_ok() {}
    assert_eq!(bell.try_recv(), Err(mpsc::TryRecvError::Disconnected));
}

#[test]
fn faults_are_told_where_they_arose_and_leave_the_rest() {
    let mut window = Window::open(session("edges"));
    let ctx = window.harness.ctx.clone();
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("broken.toml");
    std::fs::write(&broken, "[camera]\neye = [0, 0]\n").unwrap();
    for spec in ["no-such-scene", &broken.display().to_string()] {
        window.harness.state_mut().apply(Command::Open(spec.to_owned()), &ctx);
        window.wait("the fault", |app| app.model.loading.is_none());
        assert!(window.sees("cannot open: "), "{spec}");
        assert!(window.sees("edges: 256 × 256"), "the scene before is gone");
        assert_eq!(window.harness.state().state.scene, "edges");
    }
    window.click_pixel([216, 24], Modifiers::NONE);
    let study = StudyWords { counts: "1..x^2".to_owned(), ..StudyWords::default() };
    window.harness.state_mut().apply(Command::SetStudy(study), &ctx);
    window.wait("the fault", |app| app.model.studies.iter().any(|study| study.fault.is_some()));
    assert!(window.sees("--counts"), "a wrong count is not told");
    window.harness.state_mut().apply(Command::OpenLine("rm -rf /".to_owned()), &ctx);
    window.harness.run_steps(2);
    assert!(window.sees("paste a line that begins with stratcli"));
}

#[test]
fn the_map_is_begun_cancelled_and_read_under_the_pointer() {
    let mut state = session("edges");
    state.picture.overlay = Overlay::Exponent;
    state.study.counts = "1..4^2".to_owned();
    let mut window = Window::open(state);
    window.harness.get_by_label("Map").click();
    window
        .wait("the first lattice", |app| app.model.map.at([208, 16]).is_some_and(Option::is_some));
    window.harness.get_by_label("Cancel map").click();
    window.harness.run_steps(2);
    assert!(window.sees("stopped at"));
    let at = window.screen([0, 0]);
    window.harness.hover_at(at);
    window.harness.run_steps(2);
    assert!(window.sees("exact") && window.sees("x 0  y 0"));
}

#[test]
fn theory_is_measured_against_its_formula() {
    let mut state = session("edges");
    state.theory.name = "step".to_owned();
    state.theory.dim = 2;
    let mut window = Window::open(state);
    window.harness.get_by_label("Theory").click();
    window.wait("the study", |app| app.model.theory.result.is_some() && !app.model.theory.running);
    assert!(window.sees("against 1.5 = min(1 + 2/d, 2 - k/d) with d = 2, k = 1"));
}

#[test]
fn patterns_are_those_of_the_command_line() {
    let mut state = session("edges");
    state.study.samplers = ["random", "jittered", "oa"].map(str::to_owned).to_vec();
    state.patterns.sampler = "oa".to_owned();
    (state.patterns.n, state.patterns.sets) = (50, 20);
    state.patterns.counts = "2..5^2".to_owned();
    let mut window = Window::open(state);
    window.harness.get_by_label("Patterns").click();
    window.wait("patterns", |app| {
        app.model.discrepancy.result.as_ref().is_some_and(|curves| curves.len() == 3)
            && app.model.spectra.progress == Progress::Done
            && app.model.discrepancy.progress == Progress::Done
            && app.model.drawn.progress == Progress::Done
    });
    assert!(window.sees("has no set of 50; these are 49"));
    assert!(window.sees("Power of oa") && window.sees("mean of 20"));
    for curve in window.harness.state().model.discrepancy.result.as_ref().unwrap() {
        let fit = curve.fit.unwrap();
        let p = stratcli::table::with_error(fit.exponent, fit.std_error);
        assert!(window.sees(&format!("p = {p}")), "p = {p} is not on screen");
    }

    window.harness.key_down(Key::C);
    window.harness.step();
    let copied = window.copied();
    let lines: Vec<_> = copied.lines().collect();
    let commands = lines.iter().map(|line| line.split(' ').nth(1).unwrap()).collect::<Vec<_>>();
    assert_eq!(commands, ["points", "spectrum", "discrepancy"]);
    // The three lines as `stratcli` takes them: the same bits.
    let cli = |line: &str| Cli::try_parse_from(line.split(' ')).unwrap();
    let model = &window.harness.state().model;
    let Cli { command: Words::Points(args), common } = cli(lines[0]) else { panic!() };
    let points = plan::points(&args, &common, false).unwrap().draw(args.trial).unwrap();
    assert_eq!(model.drawn.result.as_ref().unwrap().points, points);
    let Cli { command: Words::Spectrum(args), common } = cli(lines[1]) else { panic!() };
    let spectra = plan::point_spectra(&args, &common).unwrap();
    let shown = model.spectra.result.as_ref().unwrap();
    for (i, shown) in shown.iter().enumerate() {
        let batch = spectra.measure(i, Control::unwatched(), &mut |_| {}).unwrap();
        // Power at frequency zero is NaN, which is not equal to itself.
        let bits = |s: &SamplerSpectrum| -> Vec<_> {
            s.spectrum.power().iter().map(|power| power.to_bits()).collect()
        };
        assert_eq!((&shown.rings, bits(shown)), (&batch.rings, bits(&batch)));
    }
    assert_eq!(shown.len(), 3);
    let Cli { command: Words::Discrepancy(args), common } = cli(lines[2]) else { panic!() };
    let (plan, dim, measures) = plan::discrepancy(&args, &common).unwrap();
    let batch = discrepancies(&plan, dim, &measures, Control::unwatched()).unwrap();
    assert_eq!(model.discrepancy.result.as_ref().unwrap(), &batch.curves);

    // Nothing reaches beyond the window.
    for name in ["Points", "Power spectrum"] {
        let area = window.harness.get_by_label(name).rect();
        assert!(area.right() <= 1280.0 && area.bottom() <= 720.0, "{name}: {area}");
    }

    // The keys of the page: the next N that the sampler has, the next sampler.
    window.harness.key_press(Key::ArrowRight);
    window.harness.run_steps(2);
    assert_eq!(window.harness.state().state.patterns.n, 121);
    window.harness.key_press(Key::ArrowUp);
    window.harness.run_steps(2);
    assert_eq!(window.harness.state().state.patterns.sampler, "jittered");
    // A fault is told where it arose.
    let ctx = window.harness.ctx.clone();
    let words = PatternWords { counts: "x".to_owned(), ..PatternWords::default() };
    window.harness.state_mut().apply(Command::SetPatterns(words), &ctx);
    window.wait("the fault", |app| matches!(app.model.discrepancy.progress, Progress::Failed(_)));
    assert!(window.sees("--counts"));
}

#[test]
fn a_long_transform_is_cancelled() {
    let mut state = session("edges");
    state.page = Page::Patterns;
    (state.patterns.n, state.patterns.sets) = (1024, 10_000);
    let mut window = Window::open(state);
    window.wait("a first spectrum", |app| app.model.spectra.result.is_some());
    window.harness.get_by_label("Stop").click();
    window.harness.run_steps(3);
    assert!(window.sees("stopped at"));
    assert!(!window.harness.state().model.is_busy());
    let model = &window.harness.state().model;
    let trials = model.spectra.result.as_ref().unwrap()[0].trials;
    assert!((16..10_000).contains(&trials), "{trials}");
}

#[test]
fn the_trade_of_a_picture_has_the_errors_of_the_command_line() {
    let mut state = session("edges");
    state.page = Page::Trade;
    state.study.samplers = ["random", "jittered"].map(str::to_owned).to_vec();
    state.study.counts = "1..4^2".to_owned();
    state.trade = TradeWords { whole: true, lattice: 3 };
    let mut window = Window::open(state);
    window.harness.get_by_label("Measure").click();
    window.wait("the trade", |app| app.model.trade.result.is_some());
    assert!(window.sees("luminance of 9 pixels"));
    assert!(window.sees("For an error of 0.01 take "));
    window.harness.key_down(Key::C);
    window.harness.step();
    let copied = window.copied();
    assert!(copied.starts_with("stratcli trade edges --lattice 3 --targets 0.01"), "{copied}");

    let Cli { command: Words::Trade(args), common } =
        Cli::try_parse_from(copied.split(' ')).unwrap()
    else {
        panic!()
    };
    let traced = TracedScene::new(stratcore::scene::load("edges").unwrap());
    let (_, pixels) = plan::trade_pixels(&args, traced.scene()).unwrap();
    let integrands: Vec<_> =
        pixels.iter().map(|&pixel| traced.pixel(pixel, Channel::Luminance)).collect();
    let subjects = pixels.iter().zip(&integrands);
    let subjects: Vec<_> =
        subjects.map(|(&pixel, integrand)| Subject { pixel, integrand }).collect();
    let plan = plan::trade_plan(&args, &common, 2).unwrap();
    let control = Control::unwatched();
    let start = std::time::Instant::now();
    let batch = trade(&subjects, &plan, &|| start.elapsed(), control).unwrap();
    // Times are the machine's; errors are not.
    let errors = |trade: &TradeResult| -> Vec<_> {
        let rows = trade.samplers.iter().flat_map(|sampler| &sampler.rows);
        rows.map(|row| row.error).collect()
    };
    let model = &window.harness.state().model;
    let shown = &model.trade.result.as_ref().unwrap().result;
    assert_eq!((shown.reference, errors(shown)), (batch.reference, errors(&batch)));

    // Another error is looked up in what was measured.
    let ctx = window.harness.ctx.clone();
    let study = StudyWords { error: 0.02, ..window.harness.state().state.study.clone() };
    window.harness.state_mut().apply(Command::SetStudy(study), &ctx);
    window.harness.run_steps(2);
    assert!(window.sees("For an error of 0.02 take ") && !window.sees("was not measured"));
}

#[test]
fn the_picture_is_zoomed_by_a_rectangle_and_its_pixels_hold_numbers() {
    let mut window = Window::open(State { pixels: vec![[216, 24]], ..session("edges") });
    window.wait_for_studies();
    window.wait("the picture", |app| app.model.picture_progress == Progress::Done);
    let [from, to] = [[210, 20], [216, 26]].map(|pixel| window.screen(pixel));
    window.harness.hover_at(from);
    let button = |pos, pressed| eframe::egui::Event::PointerButton {
        pos,
        button: eframe::egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::COMMAND,
    };
    window.harness.event_modifiers(button(from, true), Modifiers::COMMAND);
    window.harness.step();
    for share in [0.5, 1.0] {
        let event = eframe::egui::Event::PointerMoved(from + (to - from) * share);
        window.harness.event_modifiers(event, Modifiers::COMMAND);
        window.harness.step();
    }
    window.harness.event_modifiers(button(to, false), Modifiers::COMMAND);
    window.harness.run_steps(3);
    // The middle of the panel is now the middle of the rectangle.
    window.harness.hover_at(window.harness.get_by_label("Picture").rect().center());
    window.harness.run_steps(2);
    assert!(window.sees("x 213  y 23"), "the picture is not where it should be");
    assert_eq!(window.harness.state().state.pixels, [[216, 24]]);
    // x,y of what is under the pointer.
    window.harness.event(eframe::egui::Event::Copy);
    window.harness.step();
    assert_eq!(window.copied(), "213,23");
}

/// A file that is dropped on the window.
#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl eframe::egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn a_pixel_is_removed_and_a_dropped_file_is_opened() {
    let mut window = Window::open(State { pixels: vec![[216, 24], [30, 200]], ..session("edges") });
    window.wait_for_studies();
    let at = window.screen([216, 24]);
    window.harness.hover_at(at);
    for pressed in [true, false] {
        let button = eframe::egui::PointerButton::Secondary;
        let modifiers = Modifiers::NONE;
        window.harness.event(eframe::egui::Event::PointerButton {
            pos: at,
            button,
            pressed,
            modifiers,
        });
    }
    window.harness.run_steps(2);
    assert_eq!(window.harness.state().state.pixels, [[30, 200]]);

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wall.obj");
    std::fs::write(&path, "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nf 1 2 3\n").unwrap();
    window.harness.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
    window.harness.step();
    window.wait("the file", |app| app.model.loading.is_none());
    assert_eq!(window.harness.state().state.scene, path.display().to_string());
    assert!(window.sees("1 triangles"));
}

#[test]
fn parts_keep_their_shares_when_the_window_grows() {
    let mut window = Window::open(State { pixels: vec![[216, 24]], ..session("edges") });
    let share = |window: &Window, whole: f32| {
        let [picture, inside] =
            ["Picture", "Inside"].map(|name| window.harness.get_by_label(name).rect());
        [picture.width() / whole, inside.height() / whole]
    };
    let small = share(&window, 1280.0);
    window.harness.set_size(vec2(2560.0, 1440.0));
    window.harness.run_steps(3);
    let large = share(&window, 2560.0);
    for (small, large) in small.into_iter().zip(large) {
        assert!((small - large).abs() < 0.03, "{small} {large}");
    }
}

#[test]
fn curves_and_pictures_are_saved_from_the_keyboard() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = Window::open(State { pixels: vec![[216, 24]], ..session("edges") });
    window.wait_for_studies();
    for (key, name, starts) in [
        (Key::E, "curve.csv", "subject,x,y"),
        (Key::E, "curve.svg", "<svg"),
        (Key::S, "p.exr", "v/1"),
    ] {
        let path = folder.path().join(name);
        window.harness.key_press_modifiers(Modifiers::COMMAND, key);
        window.harness.run_steps(4);
        let hint = if key == Key::E { ".csv: every number" } else { ".png: 8-bit sRGB" };
        let field = window.harness.get_by(|node| {
            node.label().is_some_and(|l| l.starts_with(hint)) && node.value().is_some()
        });
        field.set_text_value_accesskit(&path.display().to_string());
        window.harness.run_steps(2);
        window.harness.get_by_label("Save").click();
        window.harness.run_steps(2);
        window.wait("the file", |app| app.model.notice.is_some());
        let notice = window.harness.state().model.notice.clone().unwrap();
        assert!(!notice.is_fault, "{}", notice.text);
        let bytes = std::fs::read(&path).unwrap();
        assert!(String::from_utf8_lossy(&bytes).contains(starts), "{name}");
    }
}
