//! The words of `trade`.

use super::ProtocolArgs;
use clap::Args;
use std::path::PathBuf;

#[derive(Debug, Args)]
#[command(mut_arg("trials", |arg| arg.default_value("100")))]
pub struct TradeArgs {
    /// A scene (a file, an .obj, or a built-in one) or the name of an integrand
    #[arg(value_name = "SCENE|NAME")]
    pub subject: String,
    /// One pixel of the scene; 0,0 is the top-left
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, conflicts_with_all = ["region", "lattice"])]
    pub at: Option<String>,
    /// Pixels from X0,Y0 up to but without X1,Y1 [default: the whole picture]
    #[arg(long, value_name = "X0,Y0,X1,Y1", allow_hyphen_values = true)]
    pub region: Option<String>,
    /// Measure a lattice of at most L × L pixels, evenly over the picture or region
    #[arg(long, value_name = "L", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub lattice: u32,
    /// Dimensions of an integrand [default: its own]
    #[arg(long, value_name = "D", conflicts_with = "at")]
    pub dim: Option<usize>,
    /// A parameter of an integrand; may be given many times
    #[arg(long, value_name = "NAME=VALUE", allow_hyphen_values = true, conflicts_with = "at")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub protocol: ProtocolArgs,
    /// Errors to reach: shares of the mean (1%), or in the integrand's unit (0.004)
    #[arg(
        long,
        visible_alias = "target",
        value_name = "E,F",
        value_delimiter = ',',
        allow_hyphen_values = true,
        default_value = "1%"
    )]
    pub targets: Vec<String>,
    /// Count this much time for one evaluation, in place of what was measured: 40ns, 1us, 2ms
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub eval_cost: Option<String>,
    /// Write every row as CSV
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Draw error against time to a file that ends in .svg or .png
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Write a page that carries everything, DIR/trade.html
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Measure every pixel of the scene: how many samples it needs for the target, under each
    /// sampler (under random only if it is alone); an .exr, and a picture of it as .png beside it
    #[arg(
        long,
        value_name = "FILE.exr",
        conflicts_with_all = ["at", "region", "lattice", "csv", "plot", "report", "eval_cost"]
    )]
    pub needed: Option<PathBuf>,
}
