//! `map` as typed.

use super::{ProtocolArgs, StudiedChannel, TracerChoice};
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(mut_arg("samplers", |arg| arg.default_value("jittered")))]
pub struct MapArgs {
    /// A scene file, an .obj, or a built-in scene (see `stratcli list scenes`)
    pub scene: String,
    /// Where to write: FILE.exr, with .png, .fits.csv and .json beside it, or FILE.tiles, to be
    /// merged later
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Only these pixels: the first column and row, and those after the last [default: all]
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
    pub region: Option<String>,
    /// Go on with the unfinished run at this output; do nothing if it is finished
    #[arg(long)]
    pub resume: bool,
    /// The I-th of N even parts, to a .tiles file; `slurm` takes I and N from the array task
    #[arg(long, value_name = "I/N")]
    pub shard: Option<String>,
    /// Only say what it would take: samples, time on this machine, memory and disk
    #[arg(long, conflicts_with = "resume")]
    pub dry_run: bool,
    /// Also write .points.csv: a row with its interval for every pixel, sampler and N
    #[arg(long)]
    pub points: bool,
    /// The number that is studied
    #[arg(long, value_enum, default_value_t = StudiedChannel::Luminance)]
    pub channel: StudiedChannel,
    /// How samples are traced
    #[arg(long, value_enum, default_value_t = TracerChoice::Beam)]
    pub tracer: TracerChoice,
    /// Compute random and jittered exactly, without trials, where a pixel's visible polygons can
    /// be resolved; measure the rest by --trials
    #[arg(long)]
    pub exact: bool,
    #[command(flatten)]
    pub protocol: ProtocolArgs,
}
