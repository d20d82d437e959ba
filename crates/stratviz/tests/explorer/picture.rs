//! The picture, the map over it, and the parts of the window.

use crate::window::{Window, session};
use eframe::egui::{Modifiers, vec2};
use egui_kittest::kittest::Queryable as _;
use stratcore::integrand::Integrand as _;
use stratcore::scene::Channel;
use stratcore::study::{Control, study};
use stratviz::jobs::Studied;
use stratviz::line;
use stratviz::model::Progress;
use stratviz::state::{Overlay, State};

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
fn the_map_of_a_scene_of_many_dimensions_is_that_of_the_command_line() {
    let mut window = Window::open(session("room-all"));
    window.harness.get_by_label("Map").click();
    let at = [0, 0];
    window.wait("the pixel", |app| app.model.map.at(at).is_some_and(Option::is_some));
    window.harness.get_by_label("Cancel map").click();
    let app = window.harness.state();
    let traced = &app.model.loaded.as_ref().unwrap().traced;
    let integrand = traced.pixel(at, Channel::Luminance);
    assert_eq!(integrand.dim(), 7);
    let plan = line::study_plan(&line::map_pixel(&app.state), 7).unwrap();
    let result = study(&integrand, at, &plan, Control::unwatched()).unwrap();
    let sampler = &result.samplers[0];
    match app.model.map.at(at).unwrap().unwrap() {
        Studied::Exact => assert!(sampler.exact),
        Studied::Fitted { exponent, .. } => assert_eq!(exponent, sampler.fit.unwrap().exponent),
        Studied::Unfitted => assert!(sampler.fit.is_none()),
    }
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
    window.harness.hover_at(window.image("Picture").center());
    window.harness.run_steps(2);
    assert!(window.sees("x 213  y 23"), "the picture is not where it should be");
    assert_eq!(window.harness.state().state.pixels, [[216, 24]]);
    // x,y of what is under the pointer.
    window.harness.event(eframe::egui::Event::Copy);
    window.harness.step();
    assert_eq!(window.copied(), "213,23");
}

#[test]
fn parts_keep_their_shares_when_the_window_grows() {
    let mut window = Window::open(State { pixels: vec![[216, 24]], ..session("edges") });
    let share = |window: &Window, whole: f32| {
        let [picture, inside] = ["Picture", "Inside"].map(|name| window.image(name));
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
