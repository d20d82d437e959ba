//! A window without a display.

use eframe::egui::{Modifiers, OutputCommand, Pos2, Rect, Role, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use std::sync::{Arc, mpsc};
use std::time::Duration;
use stratviz::app::App;
use stratviz::jobs::Wake;
use stratviz::state::{State, StudyWords};

/// The window, and the bell that workers ring.
pub struct Window {
    pub harness: Harness<'static, App>,
    pub bell: mpsc::Receiver<()>,
}

/// A session whose studies end with 120 trials.
pub fn session(scene: &str) -> State {
    let study = StudyWords { trials: 120, until: 0.0, ..StudyWords::default() };
    State { scene: scene.to_owned(), study, ..State::default() }
}

impl Window {
    /// Opens the explorer on a session, and waits for its scene.
    pub fn open(state: State) -> Self {
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
    pub fn wait(&mut self, what: &str, there: impl Fn(&App) -> bool) {
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

    /// Clicks on a pixel while the whole picture is seen.
    pub fn click_pixel(&mut self, pixel: [u32; 2], modifiers: Modifiers) {
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
    pub fn screen(&self, [x, y]: [u32; 2]) -> Pos2 {
        let area = self.image("Picture");
        let [width, height] = self.harness.state().model.picture.size;
        let size = vec2(width as f32, height as f32);
        let scale = (area.size() / size).min_elem();
        area.center() + (vec2(x as f32 + 0.5, y as f32 + 0.5) - size / 2.0) * scale
    }

    /// Where something is drawn that is no text.
    pub fn image(&self, name: &str) -> Rect {
        self.harness.get_by_role_and_label(Role::Image, name).rect()
    }

    /// Whether some label has these words.
    pub fn sees(&self, words: &str) -> bool {
        self.harness.query_all_by_label_contains(words).next().is_some()
    }

    /// What the window put into the clipboard in the last step.
    pub fn copied(&self) -> String {
        let commands = &self.harness.output().platform_output.commands;
        let copied = commands.iter().find_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
        copied.expect("nothing was copied")
    }

    /// Waits until every study has ended.
    pub fn wait_for_studies(&mut self) {
        self.wait("the study", |app| {
            !app.model.studies.is_empty() && app.model.studies.iter().all(|study| !study.running)
        });
    }
}
