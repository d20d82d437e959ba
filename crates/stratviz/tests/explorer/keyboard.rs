//! The table of actions: menus, keys, help and palette.

use crate::window::{Window, session};
use eframe::egui::{Event, Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use stratviz::actions::{ALL, Menu};
use stratviz::state::{Page, State};

const CTRL_SHIFT: Modifiers = Modifiers::COMMAND.plus(Modifiers::SHIFT);

/// Opens the palette, types, and runs what stands first.
fn run(window: &mut Window, typed: &str) {
    window.harness.key_press_modifiers(CTRL_SHIFT, Key::P);
    window.harness.run_steps(3);
    assert!(window.sees("Type to find a command"), "there is no palette");
    window.harness.event(Event::Text(typed.to_owned()));
    window.harness.run_steps(2);
    window.harness.key_press(Key::Enter);
    window.harness.run_steps(3);
    assert!(!window.sees("Type to find a command"), "the palette is still there");
}

#[test]
fn the_palette_runs_what_is_typed() {
    let mut window = Window::open(State { pixels: vec![[216, 24]], ..session("edges") });
    window.wait_for_studies();
    run(&mut window, "theory page");
    assert_eq!(window.harness.state().state.page, Page::Theory);
    run(&mut window, "dark or");
    assert!(!window.harness.state().state.dark);
    run(&mut window, "remove halton");
    assert_eq!(window.harness.state().state.study.samplers, ["random", "jittered", "sobol"]);
    run(&mut window, "keys");
    assert!(window.sees("Ctrl+Shift+P"), "there is no help");
    window.harness.key_press(Key::Escape);
    window.harness.run_steps(2);
    assert!(!window.sees("Ctrl+Shift+P"));
    run(&mut window, "room-all");
    window.wait("the scene", |app| app.model.loading.is_none());
    assert_eq!(window.harness.state().state.scene, "room-all");
}

#[test]
fn the_palette_is_walked_by_arrows_and_left_by_escape() {
    let mut window = Window::open(session("edges"));
    window.harness.key_press_modifiers(CTRL_SHIFT, Key::P);
    window.harness.run_steps(3);
    let rows = |window: &Window| window.harness.query_all_by_role(Role::Button).count();
    let all = rows(&window);
    window.harness.event(Event::Text(" page".to_owned()));
    window.harness.run_steps(2);
    assert!(rows(&window) + 20 < all, "{} of {all}", rows(&window));
    // The second of the pages.
    window.harness.key_press(Key::ArrowDown);
    window.harness.run_steps(2);
    window.harness.key_press(Key::Enter);
    window.harness.run_steps(2);
    assert_eq!(window.harness.state().state.page, Page::Theory);
    window.harness.key_press_modifiers(CTRL_SHIFT, Key::P);
    window.harness.run_steps(2);
    window.harness.event(Event::Text("no such words".to_owned()));
    window.harness.run_steps(2);
    assert!(window.sees("No command has these words"));
    window.harness.key_press(Key::Enter);
    window.harness.run_steps(2);
    window.harness.key_press(Key::Escape);
    window.harness.run_steps(2);
    assert!(!window.sees("Type to find a command"));
    assert_eq!(window.harness.state().state.page, Page::Theory);
}

#[test]
fn help_and_menus_are_those_of_the_table() {
    let mut window = Window::open(session("edges"));
    window.harness.key_press(Key::H);
    window.harness.run_steps(3);
    for action in ALL.iter().filter(|action| !action.triggers.is_empty()) {
        assert!(window.sees(&action.keys(None)), "{}: {}", action.name, action.keys(None));
    }
    window.harness.key_press(Key::Escape);
    window.harness.run_steps(2);
    for (menu, title) in Menu::ALL {
        window.harness.get_by_role_and_label(Role::Button, title).click();
        window.harness.run_steps(3);
        for action in menu.actions() {
            assert!(window.sees(action.name), "{} is not in {title}", action.name);
        }
        window.harness.key_press(Key::Escape);
        window.harness.run_steps(3);
    }
}

#[test]
fn keys_change_dimensions_axes_and_views_of_the_patterns() {
    let mut window = Window::open(State { page: Page::Patterns, ..session("edges") });
    let press = |window: &mut Window, key: Key| {
        window.harness.key_press(key);
        window.harness.run_steps(2);
        window.harness.state().state.patterns.clone()
    };
    assert_eq!(press(&mut window, Key::V).axes, [0, 1]);
    press(&mut window, Key::D);
    assert_eq!(press(&mut window, Key::D).dim, 4);
    assert_eq!(press(&mut window, Key::V).axes, [0, 2]);
    assert!(press(&mut window, Key::P).all_pairs);
    window.wait("the set", |app| app.model.drawn.result.as_ref().is_some_and(|set| set.dim == 4));
    assert!(window.sees("N = 256"));
    // As many pairs as there is room for, and the rest is said.
    window.harness.state_mut().state.patterns.n = 4096;
    assert!(press(&mut window, Key::T).all_pairs);
    window.wait("the set", |app| app.model.drawn.result.as_ref().is_some_and(|set| set.n == 4096));
    assert!(window.sees("pairs of the first 3 dimensions"));
    assert!(!press(&mut window, Key::P).all_pairs);
    press(&mut window, Key::G);
    assert!(!window.harness.state().state.strata);
}

#[test]
fn a_field_keeps_its_keys_and_a_palette_opens_from_it() {
    let mut window = Window::open(session("edges"));
    window.harness.get_by_role_and_label(Role::TextInput, "counts").focus();
    window.harness.run_steps(2);
    window.harness.key_press(Key::L);
    window.harness.run_steps(2);
    assert!(window.harness.state().state.dark, "a letter that is typed is no command");
    window.harness.key_press_modifiers(CTRL_SHIFT, Key::P);
    window.harness.run_steps(3);
    assert!(window.sees("Type to find a command"));
}
