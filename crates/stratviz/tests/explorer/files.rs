//! What is opened and saved, and what is said when that fails.

use crate::window::{Window, session};
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use std::sync::Arc;
use stratviz::command::Command;
use stratviz::state::{State, StudyWords};

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
    // A line whose scene cannot be opened changes nothing.
    let before = window.harness.state().state.clone();
    let line = "stratcli pixel no-such-scene --at 1,2 --seed 7";
    window.harness.state_mut().apply(Command::OpenLine(line.to_owned()), &ctx);
    window.wait("the fault", |app| app.model.loading.is_none());
    assert!(window.sees("cannot open: "));
    assert_eq!(window.harness.state().state, before);
}

#[test]
fn a_line_of_another_scene_opens_with_its_scene() {
    let mut window = Window::open(State { pixels: vec![[216, 24]], ..session("edges") });
    let ctx = window.harness.ctx.clone();
    let line = "stratcli pixel room-all --at 150,190 --samplers jittered --counts 1..2^7";
    window.harness.state_mut().apply(Command::OpenLine(line.to_owned()), &ctx);
    assert_eq!(window.harness.state().state.pixels, [[216, 24]]);
    window.wait("the scene", |app| app.model.loading.is_none());
    let state = &window.harness.state().state;
    assert_eq!((state.scene.as_str(), &state.pixels[..]), ("room-all", &[[150, 190]][..]));
    assert_eq!(state.study.samplers, ["jittered"]);
    assert_eq!(state.recent[..2], ["room-all", "edges"].map(str::to_owned));
    window.wait_for_studies();
    assert!(window.sees("Pixel 150, 190"));
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
