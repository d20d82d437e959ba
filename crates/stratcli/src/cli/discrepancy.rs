//! `stratcli discrepancy` as typed.

use super::NPolicy;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct DiscrepancyArgs {
    /// A file of point sets (CSV, or UTK text or binary): each set is a trial, and counts are
    /// those of the file
    #[arg(value_name = "FILE", conflicts_with_all = ["samplers", "scramble", "counts", "n_policy"])]
    pub file: Option<String>,
    /// Samplers to compare, a scramble after a plus sign: jittered,annealed+none (see `stratcli
    /// list samplers`)
    #[arg(
        long,
        alias = "sampler",
        value_name = "A,B",
        value_delimiter = ',',
        default_value = "random,jittered"
    )]
    pub samplers: Vec<String>,
    /// Scramble of the samplers that name none themselves
    #[arg(long, value_name = "R")]
    pub scramble: Option<String>,
    /// Sample counts N: 2..16^2 (4, 9, …, 256), 2^0..2^12, or a list such as 16,64
    #[arg(long, value_name = "COUNTS", default_value = "2..16^2")]
    pub counts: String,
    /// Point sets of each sampler at each N, M [default: 50; all of a file]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..))]
    pub trials: Option<u32>,
    /// Dimensions of the points [default: 2; a file's own]
    #[arg(short, long, value_name = "D")]
    pub dim: Option<usize>,
    /// Discrepancies to measure: edge, edge-l2, star (in two dimensions), l2-star, centred,
    /// wrap-around, mixture [default: edge; centred unless d = 2]
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub measure: Vec<String>,
    /// What to do with an N that a sampler cannot make
    #[arg(long, value_enum, value_name = "POLICY", default_value_t = NPolicy::Error)]
    pub n_policy: NPolicy,
    /// Draw discrepancy against N to a file that ends in .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write the rows as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}
