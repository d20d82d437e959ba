//! `completions SHELL`: a completion script.

use super::Outcome;
use crate::cli::{Cli, Common, CompletionsArgs};
use crate::output;
use anyhow::{Context, Result};
use clap::CommandFactory;
use serde::Serialize;

#[derive(Serialize)]
struct Completions {
    shell: String,
    script: String,
}

pub fn run(args: &CompletionsArgs, common: &Common) -> Result<Outcome> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "stratcli", &mut script);
    let script = String::from_utf8(script).context("the completion script is not UTF-8")?;
    if common.json {
        output::print_json(Completions { shell: args.shell.to_string(), script })?;
    } else {
        output::print(&script)?;
    }
    Ok(Outcome::Done)
}
