//! The command line as it is typed: words only; [`plan`](crate::plan) gives them meaning.

mod discrepancy;
mod map;
mod merge;
mod points;
mod spectrum;
mod stability;
mod study;
mod trade;

pub use discrepancy::DiscrepancyArgs;
pub use map::MapArgs;
pub use merge::MergeArgs;
pub use points::{PointFormat, PointsArgs};
pub use spectrum::SpectrumArgs;
pub use stability::StabilityArgs;
pub use study::StudyFileArgs;
pub use trade::TradeArgs;

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

/// How fast does a pixel's estimate converge, and why?
#[derive(Debug, Parser)]
#[command(name = "stratcli", version, arg_required_else_help = true)]
pub struct Cli {
    #[command(flatten)]
    pub common: Common,
    #[command(subcommand)]
    pub command: Command,
}

/// What every command takes.
#[derive(Debug, Clone, Args)]
pub struct Common {
    /// Seed of all randomness: the same seed gives the same bytes
    #[arg(
        long,
        global = true,
        value_name = "SEED",
        default_value_t = 1996,
        allow_negative_numbers = true
    )]
    pub seed: u64,
    /// Threads to compute with, 1 to 1024 [default: one per core]; no result depends on it
    #[arg(long, global = true, value_name = "T", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// One JSON document on standard output instead of text
    #[arg(long, global = true)]
    pub json: bool,
    /// No progress bar and no remarks: results and errors only
    #[arg(long, global = true)]
    pub quiet: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// The paper: every figure and number on ray-traced scenes, as report.html
    Reproduce(ReproduceArgs),
    /// The picture of a scene: one estimate per pixel
    Render(RenderArgs),
    /// What a scene holds, what its pixels integrate over, and what theory predicts
    Inspect(InspectArgs),
    /// How fast one pixel of a scene converges under each sampler
    Pixel(PixelArgs),
    /// The same study of an integrand whose mean is known
    Integrand(IntegrandArgs),
    /// A sampler's point sets, as text or as a picture
    Points(PointsArgs),
    /// How badly point sets misjudge the size of half-planes and boxes, against N
    Discrepancy(DiscrepancyArgs),
    /// At which frequencies the power of point sets, or of a picture's error, lies
    Spectrum(SpectrumArgs),
    /// How fast every pixel converges: exponents, classes and variances as a picture
    Map(MapArgs),
    /// The shards of a map to one map
    Merge(MergeArgs),
    /// Maps of many scenes under many samplers, and a report that compares them
    Study(StudyFileArgs),
    /// What error costs how much time: which sampler, how many samples, how long
    Trade(TradeArgs),
    /// Numerical extremes, each tried: what f32 and f64 do, the error, the floor
    Stability(StabilityArgs),
    /// Names that can be typed, each with one line of help
    List(ListArgs),
    /// A completion script for a shell
    Completions(CompletionsArgs),
}

#[derive(Debug, Args)]
pub struct ReproduceArgs {
    /// Folder for report.html, summary.json and figures/
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    pub out: PathBuf,
    /// Study a lattice of 64 × 64 pixels, not every pixel, and repeat the form factor less
    /// often; with --literature and --dimensions, fewer samples
    #[arg(long)]
    pub quick: bool,
    /// Study a lattice of L × L pixels, evenly over the picture
    #[arg(long, value_name = "L", conflicts_with = "quick", value_parser = clap::value_parser!(u32).range(1..))]
    pub lattice: Option<u32>,
    /// Repeats of the form factor's study, each with its own seed, at least 2 [default: 150; 20
    /// with a lattice]
    #[arg(long, value_name = "R", value_parser = clap::value_parser!(u32).range(2..))]
    pub repeats: Option<u32>,
    /// The scene: a file, or a built-in one (see `stratcli list scenes`)
    #[arg(long, value_name = "SCENE", default_value = "classic")]
    pub scene: String,
    /// Not the paper's figures but what the literature claims of samplers, each claim measured:
    /// literature.html, .csv and .json; exit code 1 where one does not hold
    #[arg(long, conflicts_with_all = ["lattice", "repeats", "scene"])]
    pub literature: bool,
    /// Not the paper's figures but pixels in 2 to 7 dimensions, each combination of lens, area
    /// light and shutter under each family of samplers, and filters: dimensions.html, .csv and
    /// .json; exit code 1 where a prediction does not hold
    #[arg(long, conflicts_with_all = ["lattice", "repeats", "scene", "literature"])]
    pub dimensions: bool,
    /// Only these claims of the literature, such as K4,M3
    #[arg(long, value_name = "IDS", value_delimiter = ',', requires = "literature")]
    pub claims: Vec<String>,
}

#[derive(Debug, Args)]
pub struct RenderArgs {
    /// A scene file, an .obj, or a built-in scene (see `stratcli list scenes`)
    pub scene: String,
    /// Samples per pixel; a square number fills a square of jittered strata
    #[arg(long, value_name = "N", default_value_t = 16)]
    pub spp: u64,
    /// Where the samples lie, a scramble after a plus sign (see `stratcli list samplers`)
    #[arg(long, value_name = "S", default_value = "jittered")]
    pub sampler: String,
    /// Where to write: .png (8-bit sRGB) or .exr (32-bit linear RGB)
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Brighten by this many stops: radiance times 2^STOPS
    #[arg(long, value_name = "STOPS", default_value_t = 0.0, allow_hyphen_values = true)]
    pub exposure: f64,
}

#[derive(Debug, Args)]
pub struct InspectArgs {
    /// A scene file, an .obj, or a built-in scene (see `stratcli list scenes`)
    pub scene: String,
    /// Also which axes this pixel needs, along which it jumps, and what theory makes of that for
    /// each sampler
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub at: Option<String>,
}

#[derive(Debug, Args)]
pub struct PixelArgs {
    /// A scene file, an .obj, or a built-in scene (see `stratcli list scenes`)
    pub scene: String,
    /// The pixel; 0,0 is the top-left
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    pub at: String,
    /// The number that is studied
    #[arg(long, value_enum, default_value_t = StudiedChannel::Luminance)]
    pub channel: StudiedChannel,
    /// How samples are traced
    #[arg(long, value_enum, default_value_t = TracerChoice::Beam)]
    pub tracer: TracerChoice,
    /// Compute random and jittered exactly, without trials, where the pixel's visible polygons
    /// can be resolved; other samplers and pixels are measured by --trials, and the reason is
    /// said. What is computed has no --timing
    #[arg(long, conflicts_with = "until")]
    pub exact: bool,
    #[command(flatten)]
    pub study: StudyArgs,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TracerChoice {
    /// Against the pixel's own list of triangles; by rays where the scene is shaded smoothly or has
    /// a lens, a shutter, mirrors, glass or bounces, and right beside a point light
    Beam,
    /// One ray through the BVH per sample: slower, for comparison
    Bvh,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StudiedChannel {
    /// Rec. 709 luminance of linear RGB
    Luminance,
    /// Red
    R,
    /// Green
    G,
    /// Blue
    B,
}

#[derive(Debug, Args)]
pub struct IntegrandArgs {
    /// Its name (see `stratcli list integrands`)
    pub name: String,
    /// Dimensions [default: the integrand's own]
    #[arg(long, value_name = "D")]
    pub dim: Option<usize>,
    /// A parameter; may be given many times
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// Side of a square occluder half way: short for --set occluder=SIDE
    #[arg(long, value_name = "SIDE", allow_hyphen_values = true)]
    pub occluder: Option<f64>,
    #[command(flatten)]
    pub study: StudyArgs,
}

#[derive(Debug, Args)]
pub struct ListArgs {
    /// Only these; everything unless told
    pub what: Option<Listed>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Listed {
    Samplers,
    Integrands,
    Scenes,
    Discrepancies,
    Extremes,
}

#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// The shell that is to complete commands
    pub shell: clap_complete::Shell,
}

/// Which estimates are repeated, and how often.
#[derive(Debug, Args)]
pub struct ProtocolArgs {
    /// Samplers to compare, a scramble after a plus sign: jittered,sobol+owen-hash (see
    /// `stratcli list samplers`)
    #[arg(long, value_name = "A,B", value_delimiter = ',', default_value = "random,jittered")]
    pub samplers: Vec<String>,
    /// Independent repeats of each estimate, M, at least 2
    #[arg(long, value_name = "M", default_value_t = 50, allow_negative_numbers = true)]
    pub trials: u32,
    /// Sample counts N: 1..16^2 (1, 4, 9, …, 256), 2^0..2^12, or a list such as 1,4,16
    /// [default: 1..16^2; in d > 2 dimensions 1..k^d, up to 10,000; of these, the N that every
    /// sampler has]
    #[arg(long, value_name = "COUNTS")]
    pub counts: Option<String>,
    /// What to do with an N that a sampler cannot make
    #[arg(long, value_enum, value_name = "POLICY", default_value_t = NPolicy::Error)]
    pub n_policy: NPolicy,
}

/// How a study is made, whatever it is of.
#[derive(Debug, Args)]
pub struct StudyArgs {
    #[command(flatten)]
    pub protocol: ProtocolArgs,
    /// Exit with 1 unless the exponent is P ± TOL: of the sampler named before it
    /// (random:1:0.1), else of jittered, else of the last one
    #[arg(long, value_name = "[SAMPLER:]P:TOL", allow_hyphen_values = true)]
    pub expect: Option<String>,
    /// Draw variance against N to a file that ends in .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Measure the time per sample; rows then run one at a time, on one thread
    #[arg(long, conflicts_with = "until")]
    pub timing: bool,
    /// Add trials until every 95 % interval is p ± W (p:W, such as p:0.02) or every variance is
    /// known to a share (var:5%)
    #[arg(long, value_name = "p:W|var:SHARE", conflicts_with = "trials")]
    pub until: Option<String>,
    /// Stop at so many trials even if not sure
    #[arg(long, value_name = "M", default_value_t = 100_000, requires = "until", value_parser = clap::value_parser!(u32).range(2..))]
    pub max_trials: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum NPolicy {
    /// Refuse, and name the nearest N that exist
    Error,
    /// Use the nearest N that exists
    Snap,
    /// Unequal numbers of strata per axis, where the sampler has strata
    Rect,
}
