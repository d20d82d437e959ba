//! The exact curve beside the paper's protocol, and how many pixels have one.
//!
//! Each pixel's time is the least of several rounds, in which both ways take turns: other work
//! on the machine only ever adds time.

mod common;

use anyhow::{Context, Result};
use clap::Parser;
use common::{lattice, n_samples, protocol};
use std::collections::BTreeMap;
use std::io::{Write, stdout};
use std::time::Instant;
use stratcore::exact::{Grids, TOLERANCE};
use stratcore::scene::{Channel, Scene, load};
use stratcore::study::{Control, SamplerChoice, StudyPlan, study, with_threads};
use stratcore::trace::{PixelIntegrand, TracedScene};

#[derive(Parser)]
struct Args {
    /// Scene: a built-in name, or a .toml or .obj file; may be given again
    #[arg(long, default_values = ["classic", "classic-shadows", "edges", "grass"])]
    scene: Vec<String>,
    /// Pixels along each side of the picture, whatever the scene says
    #[arg(long, default_value_t = 512)]
    resolution: u32,
    /// Pixels per axis of the lattice
    #[arg(long, default_value_t = 32)]
    side: u32,
    /// Times that each pixel is measured
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// What cargo says to every bench
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> Result<()> {
    let args = Args::parse();
    let plan = protocol(SamplerChoice::named("jittered")?);
    writeln!(
        stdout(),
        "{0} × {0} pixels, a lattice of {1} × {1}, one thread; µs a pixel, set-up included; \
         sampled: {2} jittered samples",
        args.resolution,
        args.side,
        n_samples(&plan)
    )?;
    for name in &args.scene {
        let mut scene = load(name)?;
        scene.camera.resolution = [args.resolution; 2];
        with_threads(Some(1), || measure(scene, &plan, &args)).with_context(|| name.clone())?;
    }
    Ok(())
}

/// One pixel's least times, in µs.
struct Times {
    /// N = 1, 4, …, 256 by 50 trials of jittered points.
    sampled: f64,
    /// Random and jittered points, every N.
    exact: f64,
    resolved: bool,
    patches: usize,
}

fn measure(scene: Scene, plan: &StudyPlan, args: &Args) -> Result<()> {
    let name = scene.name.clone();
    let grids = Grids::new(&plan.counts)?;
    let traced = TracedScene::new(scene);
    let mut reasons: BTreeMap<String, u32> = BTreeMap::new();
    let mut pixels = Vec::new();
    for pixel in lattice(&traced.scene().camera, args.side) {
        let mut times =
            Times { sampled: f64::INFINITY, exact: f64::INFINITY, resolved: false, patches: 0 };
        let mut reason = None;
        for _ in 0..args.rounds {
            let start = Instant::now();
            let integrand = traced.pixel(pixel, Channel::Luminance);
            study(&integrand, pixel, plan, Control::unwatched())?;
            times.sampled = times.sampled.min(start.elapsed().as_secs_f64() * 1e6);

            let start = Instant::now();
            let PixelIntegrand::Beam(beam) = traced.pixel(pixel, Channel::Luminance) else {
                writeln!(stdout(), "\n{name}: traced by rays, no pixel can be resolved")?;
                return Ok(());
            };
            let curve = grids.curve(&beam, TOLERANCE);
            times.exact = times.exact.min(start.elapsed().as_secs_f64() * 1e6);
            (times.resolved, times.patches) =
                curve.as_ref().map_or((false, 0), |c| (true, c.patches));
            reason = curve.err().map(|reason| reason.to_string());
        }
        if let Some(reason) = reason {
            *reasons.entry(reason).or_default() += 1;
        }
        pixels.push(times);
    }
    report(&name, &pixels, &reasons)
}

fn report(name: &str, pixels: &[Times], reasons: &BTreeMap<String, u32>) -> Result<()> {
    let mut out = stdout().lock();
    let resolved: Vec<_> = pixels.iter().filter(|times| times.resolved).collect();
    writeln!(
        out,
        "\n{name}: {:.1} % of {} pixels resolved",
        100.0 * resolved.len() as f64 / pixels.len() as f64,
        pixels.len()
    )?;
    for (reason, count) in reasons {
        writeln!(out, "  {count} not: {reason}")?;
    }
    writeln!(
        out,
        "{:24} {:>7} {:>10} {:>8} {:>8}",
        "patches", "pixels", "sampled", "exact", "ratio"
    )?;
    let mut row = |label: &str, some: &[&Times]| -> Result<()> {
        let mean = |time: fn(&Times) -> f64| {
            some.iter().map(|times| time(times)).sum::<f64>() / some.len() as f64
        };
        let (sampled, exact) = (mean(|times| times.sampled), mean(|times| times.exact));
        let ratio = sampled / exact;
        writeln!(out, "{label:24} {:7} {sampled:10.1} {exact:8.1} {ratio:8.1}", some.len())?;
        Ok(())
    };
    for (label, range) in [
        ("0", 0..1),
        ("1-3", 1..4),
        ("4-15", 4..16),
        ("16-63", 16..64),
        ("64 and more", 64..usize::MAX),
    ] {
        let some: Vec<_> =
            resolved.iter().copied().filter(|times| range.contains(&times.patches)).collect();
        if !some.is_empty() {
            row(label, &some)?;
        }
    }
    row("all resolved", &resolved)?;
    // Where a pixel is not resolved, trials follow.
    let everything: Vec<_> = pixels
        .iter()
        .map(|times| Times {
            exact: times.exact + if times.resolved { 0.0 } else { times.sampled },
            ..*times
        })
        .collect();
    row("all, trials where not", &everything.iter().collect::<Vec<_>>())
}
