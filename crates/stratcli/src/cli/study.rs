//! `study` as typed.

use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct StudyFileArgs {
    /// A .toml file that lists scenes, samplers, counts and trials (see docs/commands.md)
    pub file: PathBuf,
    /// Folder for a map of each scene, report.html and summary.json; maps that are there already
    /// are kept, unfinished ones are gone on with
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}
