//! `stratcli`: batch studies of how fast image estimates converge.
//!
//! Exit codes: 0 done; 1 done, but a stated expectation did not hold; 2 could not run;
//! 130 interrupted, with what was finished printed.

mod commands;
mod progress;

use clap::Parser;
use clap::error::ErrorKind;
use std::process::ExitCode;
use stratcli::{cli, output, picture, plan, report, study_file, table};
use stratcore::StudyError;

fn main() -> ExitCode {
    let cli = match cli::Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    match progress::catch_interrupts().and_then(|()| commands::run(&cli)) {
        Ok(outcome) => outcome.exit_code(),
        Err(error) if output::is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) if matches!(error.downcast_ref(), Some(StudyError::Cancelled)) => {
            output::note("interrupted before anything was finished");
            commands::Outcome::Interrupted.exit_code()
        }
        Err(error) => {
            output::note(&format!("error: {error:#}"));
            ExitCode::from(2)
        }
    }
}

/// Help and version as they are; a fault as the one line that every other fault is.
fn usage(error: &clap::Error) -> ExitCode {
    use ErrorKind::{DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion};
    match error.kind() {
        DisplayHelp | DisplayVersion | DisplayHelpOnMissingArgumentOrSubcommand => {
            // A closed pipe is the only way to fail, and it is no fault.
            let _ = error.print();
        }
        _ => {
            let text = error.render().to_string();
            let paragraphs = text.split("\n\n").map(output::on_one_line);
            output::note(&paragraphs.collect::<Vec<_>>().join("; "));
        }
    }
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}
