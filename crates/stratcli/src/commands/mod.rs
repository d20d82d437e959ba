//! One file per command. Each reads its words, lets the library work, and writes the result.

mod completions;
mod discrepancy;
mod inspect;
mod integrand;
mod list;
mod map;
mod measure;
mod merge;
mod pixel;
mod points;
mod render;
mod reproduce;
mod spectrum;
mod stability;
mod study;
mod trade;

use crate::cli::{Cli, Command, Common};
use crate::output;
use anyhow::Result;
use std::process::ExitCode;
use stratcore::scene::{self, Scene};
use stratcore::study::with_threads;

/// How a command ended that could run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// All was done.
    Done,
    /// All was done, and a stated expectation did not hold.
    ExpectationFailed,
    /// Stopped by Ctrl-C; what was finished has been written.
    Interrupted,
}

impl Outcome {
    /// As the shell sees it.
    pub fn exit_code(self) -> ExitCode {
        ExitCode::from(match self {
            Self::Done => 0,
            Self::ExpectationFailed => 1,
            Self::Interrupted => 130,
        })
    }
}

/// Runs the command with as many threads as asked for.
pub fn run(cli: &Cli) -> Result<Outcome> {
    let common = &cli.common;
    with_threads(common.threads.map(usize::from), || match &cli.command {
        Command::Reproduce(args) => reproduce::run(args, common),
        Command::Render(args) => render::run(args, common),
        Command::Inspect(args) => inspect::run(args, common),
        Command::Integrand(args) => integrand::run(args, common),
        Command::Pixel(args) => pixel::run(args, common),
        Command::Points(args) => points::run(args, common),
        Command::Discrepancy(args) => discrepancy::run(args, common),
        Command::Spectrum(args) => spectrum::run(args, common),
        Command::Map(args) => map::run(args, common),
        Command::Merge(args) => merge::run(args, common),
        Command::Study(args) => study::run(args, common),
        Command::Trade(args) => trade::run(args, common),
        Command::Stability(args) => stability::run(args, common),
        Command::List(args) => list::run(args, common),
        Command::Completions(args) => completions::run(args, common),
    })
}

/// Loads a scene and passes on what its files made the loader remark.
fn load(spec: &str, common: &Common) -> Result<Scene> {
    let scene = scene::load(spec)?;
    if !common.quiet {
        for remark in &scene.notes {
            output::note(&format!("note: {}: {remark}", scene.name));
        }
    }
    Ok(scene)
}
