//! The pages beside that of the pixel.

use crate::window::{Window, session};
use clap::Parser as _;
use eframe::egui::{Key, Role};
use egui_kittest::kittest::Queryable as _;
use stratcli::cli::{Cli, Command as Words};
use stratcli::plan;
use stratcli::report::spectrum::SamplerSpectrum;
use stratcore::scene::Channel;
use stratcore::study::{Control, SamplerResult, discrepancies};
use stratcore::trace::TracedScene;
use stratcore::trade::{Subject, TradeResult, trade};
use stratviz::app::App;
use stratviz::command::Command;
use stratviz::model::Progress;
use stratviz::state::{Page, PatternWords, StudyWords, TheoryWords, TradeWords};

#[test]
fn theory_is_measured_against_its_formula() {
    let mut state = session("edges");
    state.theory.name = "step".to_owned();
    state.theory.dim = 2;
    let mut window = Window::open(state);
    window.harness.get_by_label("Theory").click();
    window.wait("the study", |app| app.model.theory.result.is_some() && !app.model.theory.running);
    assert!(window.sees("against 1.5 = min(1 + 2/d, 2 - k/d) with d = 2, k = 1"));

    // d and k are controls.
    let ctx = window.harness.ctx.clone();
    let theory = TheoryWords { name: "rough-edge".to_owned(), dim: 2, ..TheoryWords::default() };
    window.harness.state_mut().apply(Command::SetTheory(theory), &ctx);
    let is_there = |k: f64| {
        move |app: &App| {
            let exact = |sampler: &SamplerResult| {
                sampler.predicted.is_some_and(|p| (p - (2.0 - k / 2.0)).abs() < 1e-9)
            };
            let result = app.model.theory.result.as_ref();
            result.is_some_and(|result| result.samplers.iter().any(exact))
        }
    };
    window.wait("the study", is_there(1.5));
    assert!(window.sees("min(1 + 2/d, 2 - k/d) with d = 2, k = 1.5"));
    let k = window.harness.get_by_role_and_label(Role::Slider, "k");
    k.focus();
    window.harness.run_steps(2);
    window.harness.key_press(Key::ArrowRight);
    window.wait("the study", is_there(1.55));
    assert!(window.sees("with d = 2, k = 1.55"));
    window.harness.key_press(Key::Escape);
    window.harness.run_steps(2);
    window.harness.key_press(Key::D);
    window.wait("the study", |app| app.model.theory.result.as_ref().is_some_and(|r| r.dim == 3));
    assert!(window.sees("with d = 3, k = 2.55"));
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
        let area = window.image(name);
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
