//! The folder that a reproduction leaves: written anew after every part.

use super::verdicts::verdicts;
use crate::output::{self, AtomicFile};
use crate::report::page::{self, Figure};
use crate::report::summary::Summary;
use crate::report::svg::Svg;
use crate::report::{PlotFile, dimensions, literature, trade};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use stratcore::input::{self, MAX_DATA};

/// A report being written.
pub struct Report {
    folder: PathBuf,
    /// Every number so far.
    pub summary: Summary,
    figures: Vec<Figure>,
}

impl Report {
    /// Makes the folder and writes the empty report there, so that an unwritable place is found
    /// before the work is done.
    pub fn create(folder: &Path, summary: Summary) -> Result<Self> {
        create_folder(folder)?;
        let mut report = Self { folder: folder.to_owned(), summary, figures: Vec::new() };
        report.write()?;
        Ok(report)
    }

    /// Adds a figure: `figures/NAME.svg` and `.png` now, and its place in the page.
    pub fn figure(&mut self, name: &'static str, caption: String, svg: &Svg) -> Result<()> {
        self.figures.push(save_figure(&self.folder, name, caption, svg)?);
        self.summary.figures.push(name.to_owned());
        Ok(())
    }

    /// Writes the page and the numbers as they stand.
    pub fn write(&mut self) -> Result<()> {
        self.summary.verdicts = verdicts(&self.summary);
        let mut page = page::render(&self.summary, &self.figures);
        for (file, title) in [
            (literature::PAGE, literature::TITLE),
            (trade::PAGE, trade::TITLE),
            (dimensions::PAGE, dimensions::TITLE),
        ] {
            if self.folder.join(file).exists() {
                page = page::with_link(&page, file, title);
            }
        }
        write(&self.folder.join(page::NAME), page.as_bytes())?;
        let json = output::json(&self.summary)?;
        write(&self.folder.join("summary.json"), json.as_bytes())
    }

    /// Where the page is.
    pub fn page(&self) -> PathBuf {
        self.folder.join(page::NAME)
    }
}

/// A report of the paper that is there already gets its link to another page in the folder.
pub fn link_from_report(folder: &Path, file: &str, title: &str) -> Result<()> {
    let path = folder.join(page::NAME);
    match input::read_text(&path, MAX_DATA) {
        Ok(report) => write(&path, page::with_link(&report, file, title).as_bytes()),
        // There is none, or it is not ours to touch.
        Err(_) => Ok(()),
    }
}

/// Makes the folder of a report, with its folder of figures.
pub fn create_folder(folder: &Path) -> Result<()> {
    fs::create_dir_all(folder.join("figures")).with_context(|| {
        format!("cannot make the folder {}; choose another with --out", folder.display())
    })
}

/// Writes `figures/NAME.svg` and `.png`, and returns the figure for the page.
pub fn save_figure(
    folder: &Path,
    name: &'static str,
    caption: String,
    svg: &Svg,
) -> Result<Figure> {
    for ending in ["svg", "png"] {
        let path = folder.join("figures").join(format!("{name}.{ending}"));
        PlotFile::create(&path)?.commit(svg)?;
    }
    Ok(Figure { name, caption, inline: svg.to_inline() })
}

/// Writes a whole file or none.
pub fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    AtomicFile::create(path)?.commit(bytes)
}
