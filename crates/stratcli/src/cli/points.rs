//! `stratcli points` as typed.

use super::NPolicy;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct PointsArgs {
    /// The sampler, or file:PATH (see `stratcli list samplers`)
    #[arg(long, value_name = "S")]
    pub sampler: String,
    /// How its points are scrambled [default: the sampler's own]
    #[arg(long, value_name = "R")]
    pub scramble: Option<String>,
    /// Points in a set
    #[arg(short, value_name = "N")]
    pub n: u64,
    /// Dimensions
    #[arg(short, long, value_name = "D", default_value_t = 2)]
    pub dim: usize,
    /// The first trial whose set is written, counted from 0
    #[arg(long, value_name = "T", default_value_t = 0)]
    pub trial: u32,
    /// How many sets, of this trial and those after it
    #[arg(long, value_name = "M", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub sets: u32,
    /// What to do with an N that the sampler cannot make
    #[arg(long, value_enum, value_name = "POLICY", default_value_t = NPolicy::Error)]
    pub n_policy: NPolicy,
    /// How they are written [default: csv; json with --json]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub format: Option<PointFormat>,
    /// Where to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw the first set to a file that ends in .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// The two dimensions that are drawn, counted from 0
    #[arg(long, value_name = "I,J", default_value = "0,1")]
    pub axes: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PointFormat {
    /// A line of names, then a point a line, commas between coordinates, # between sets
    Csv,
    /// A point a line, blanks between coordinates, # between sets: text of UTK
    Utk,
    /// One document with every set
    Json,
}
