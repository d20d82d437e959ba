//! Figures and pages: numbers in, SVG, PNG and HTML out. Nothing is measured here.

pub mod axis;
pub mod chart;
pub mod comparison;
pub mod dimensions;
pub mod discrepancy;
pub mod gain;
pub mod histogram;
mod html;
pub mod literature;
pub mod loglog;
pub mod needed;
pub mod page;
pub mod panels;
pub mod picture;
pub mod points;
pub mod raster;
pub mod sides;
pub mod spectrum;
pub mod stability;
pub mod summary;
pub mod svg;
pub mod trade;

use crate::output::AtomicFile;
use anyhow::{Result, anyhow, bail};
use std::path::Path;
use svg::Svg;

/// Device pixels per unit in PNG files.
pub const PNG_SCALE: f64 = 2.0;

/// A file for one figure, opened before the work so that a place or an ending that cannot be
/// written is found first.
pub struct PlotFile {
    file: AtomicFile,
    png: bool,
}

impl PlotFile {
    /// Opens a file that ends in `.svg` or `.png`.
    pub fn create(path: &Path) -> Result<Self> {
        let ending = path.extension().map(|e| e.to_ascii_lowercase());
        let png = match ending.as_ref().and_then(|e| e.to_str()) {
            Some("svg") => false,
            Some("png") => true,
            _ => bail!("cannot draw {}: name a file that ends in .svg or .png", path.display()),
        };
        Ok(Self { file: AtomicFile::create(path)?, png })
    }

    /// Writes the figure.
    pub fn commit(self, svg: &Svg) -> Result<()> {
        if self.png {
            let png = svg.to_png(PNG_SCALE).map_err(|fault| anyhow!("cannot draw: {fault}"))?;
            self.file.commit(&png)
        } else {
            self.file.commit(svg.to_svg().as_bytes())
        }
    }
}
