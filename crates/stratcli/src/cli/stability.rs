//! `stratcli stability` as typed.

use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct StabilityArgs {
    /// Fewer samples: under a minute
    #[arg(long)]
    pub quick: bool,
    /// Only these families of extremes, such as positions,geometry (see `stratcli list
    /// extremes`)
    #[arg(long, value_name = "A,B", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Write a page that carries everything, DIR/stability.html, with the table as .csv and .json
    /// and its figures beside it
    #[arg(long, visible_alias = "out", value_name = "DIR")]
    pub report: Option<PathBuf>,
}
