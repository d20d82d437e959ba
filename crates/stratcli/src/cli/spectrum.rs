//! `stratcli spectrum` as typed.

use super::NPolicy;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub struct SpectrumArgs {
    /// A scene (.toml, .obj or built-in): the spectrum of its pictures' error. Or a file of
    /// point sets. Nothing: the samplers' own point sets
    #[arg(value_name = "SCENE|FILE")]
    pub subject: Option<String>,
    /// Samplers to compare, a scramble after a plus sign: jittered,sobol+owen (see `stratcli
    /// list samplers`) [default: random,jittered]
    #[arg(long, alias = "sampler", value_name = "A,B", value_delimiter = ',')]
    pub samplers: Vec<String>,
    /// Scramble of the samplers that name none themselves
    #[arg(long, value_name = "R")]
    pub scramble: Option<String>,
    /// Periodograms to average, M: point sets, or pictures of a scene [default: 50; all of
    /// a file; 4 pictures]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u32).range(1..))]
    pub trials: Option<u32>,
    /// Points in a set [default: 256; a file's first count]
    #[arg(short, value_name = "N", help_heading = "Point sets")]
    pub n: Option<u64>,
    /// Dimensions of the points [default: 2; a file's own]
    #[arg(short, long, value_name = "D", help_heading = "Point sets")]
    pub dim: Option<usize>,
    /// The two dimensions that are seen, counted from 0 [default: 0,1]
    #[arg(long, value_name = "I,J", help_heading = "Point sets")]
    pub axes: Option<String>,
    /// Largest frequency along each axis, in cycles per side of the square, up to 1024
    /// [default: 4√N, from 16 to 256]
    #[arg(long, value_name = "K", help_heading = "Point sets", value_parser = clap::value_parser!(u32).range(2..=1024))]
    pub cutoff: Option<u32>,
    /// What to do with an N that a sampler cannot make [default: error]
    #[arg(long, value_enum, value_name = "POLICY", help_heading = "Point sets")]
    pub n_policy: Option<NPolicy>,
    /// Samples per pixel of a scene's pictures [default: 4]
    #[arg(long, value_name = "N", help_heading = "Pictures")]
    pub spp: Option<u64>,
    /// Samples per pixel of the jittered picture that errors are measured from [default: 4096]
    #[arg(long, value_name = "N", help_heading = "Pictures")]
    pub reference_spp: Option<u64>,
    /// Write the power of one sampler at each frequency: .png, where 1 is half-way up the scale,
    /// or .exr
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Draw power, radial mean and anisotropy to a file that ends in .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write the radial means as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}
