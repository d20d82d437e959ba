//! Studied pixels and their curves.

use crate::window::{Window, session};
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use std::sync::mpsc;
use std::time::Duration;
use stratcore::dimensions::predict_pixel;
use stratcore::scene::Channel;
use stratcore::study::{Control, study};
use stratcore::trace::TracedScene;
use stratviz::line;
use stratviz::state::State;

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
    let mut batch = study(&integrand, [216, 24], &plan, Control::unwatched()).unwrap();
    predict_pixel(&mut batch, &integrand, Control::unwatched()).unwrap();
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
    // Nor does it run again because another page was looked at.
    for page in [Key::Num2, Key::Num1] {
        window.harness.key_press(page);
        window.harness.run_steps(2);
    }
    assert!(!window.harness.state().model.studies[0].running);
    window.harness.key_press(Key::Space);
    window.harness.run_steps(2);
    assert!(window.harness.state().model.studies[0].running);
    // Closed in mid-study: the worker is cancelled and hangs up.
    let Window { harness, bell } = window;
    drop(harness);
    while bell.recv_timeout(Duration::from_secs(120)).is_ok() {}
    assert_eq!(bell.try_recv(), Err(mpsc::TryRecvError::Disconnected));
}
