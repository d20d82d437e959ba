//! `merge` as typed.

use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct MergeArgs {
    /// The shards' files, in any order
    #[arg(required = true, value_name = "FILE.tiles")]
    pub shards: Vec<PathBuf>,
    /// Where to write, as for `map`: FILE.exr, or FILE.tiles
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Also write .points.csv: a row with its interval for every pixel, sampler and N
    #[arg(long)]
    pub points: bool,
}
