//! The results of a map: one pass over its tiles, in order, in memory that does not grow with
//! the picture.

use super::csv::{self, Table};
use super::exr::ExrLayout;
use super::overview::Overview;
use super::text;
use crate::cli::Common;
use crate::output::{self, AtomicFile};
use crate::picture;
use crate::report::PNG_SCALE;
use anyhow::{Context, Result, anyhow, bail};
use exr::block::chunk::Chunk;
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use stratcore::input::{self, MAX_DOCUMENT};
use stratcore::map::{
    Header, Identity, PixelReading, ROW_BYTES, RecordError, Region, Summary, Tally, TileSet,
    read_tile,
};
use stratcore::study::{both, in_order, thread_count};

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Pictures, tables and a summary.
    Picture {
        /// With the table of points.
        points: bool,
    },
    /// Tiles to be merged.
    Tiles,
}

/// Where a map goes.
pub struct Output {
    pub path: PathBuf,
    pub kind: Kind,
}

impl Output {
    /// The kind that the file's name asks for.
    pub fn of(path: &Path, points: bool) -> Result<Self> {
        let extension = path.extension().map(|e| e.to_ascii_lowercase());
        let kind = match extension.as_ref().and_then(|e| e.to_str()) {
            Some("exr") => Kind::Picture { points },
            Some("tiles") if points => bail!(
                "--points: {} holds tiles, not tables; give --points when they are merged",
                path.display()
            ),
            Some("tiles") => Kind::Tiles,
            _ => bail!(
                "cannot write a map to {}: name a file that ends in .exr, or in .tiles for tiles \
                 to be merged",
                path.display()
            ),
        };
        Ok(Self { path: path.to_owned(), kind })
    }

    /// The file of finished tiles while the map is made.
    pub fn part(&self) -> PathBuf {
        let mut name = self.path.clone().into_os_string();
        name.push(".part");
        name.into()
    }

    /// The file of another ending beside it.
    pub fn beside(&self, ending: &str) -> PathBuf {
        self.path.with_extension(ending)
    }

    /// Whether the results are there already, of this very plan and shard.
    pub fn is_finished(&self, header: &Header) -> Result<bool> {
        #[derive(Deserialize)]
        struct Hash {
            hash: String,
        }
        if !self.path.exists() {
            return Ok(false);
        }
        if self.kind == Kind::Tiles {
            return Ok(Header::read_file(&self.path)?.as_ref() == Some(header));
        }
        let points_are_there = match self.kind {
            Kind::Picture { points: true } => self.beside("points.csv").exists(),
            _ => true,
        };
        let summary = input::read(&self.beside("json"), MAX_DOCUMENT).unwrap_or_default();
        let found: Option<Hash> = serde_json::from_slice(&summary).ok();
        Ok(points_are_there && found.is_some_and(|found| found.hash == header.hash))
    }
}

/// What an earlier run found that wrote the results to `output`.
pub fn read(output: &Output) -> Result<Found> {
    let path = &output.path;
    if output.kind == Kind::Tiles {
        let header = Header::read_file(path)?;
        let header = header.with_context(|| format!("{} is not there any more", path.display()))?;
        return Ok(Found { files: vec![path.clone()], header, summary: None });
    }
    let json = output.beside("json");
    let fault = || format!("{} is no summary of a map; delete it", json.display());
    let mut found: Found =
        serde_json::from_slice(&input::read(&json, MAX_DOCUMENT).with_context(fault)?)
            .with_context(fault)?;
    for file in &mut found.files {
        *file = path.with_file_name(&*file);
    }
    Ok(found)
}

/// What is known of a finished map.
#[derive(Serialize, Deserialize)]
pub struct Found {
    /// Files written, the one asked for first.
    pub files: Vec<PathBuf>,
    #[serde(flatten)]
    pub header: Header,
    /// Nothing where tiles were written.
    #[serde(flatten)]
    pub summary: Option<Summary>,
}

/// Writes the results.
pub fn write(set: &TileSet, header: &Header, output: &Output) -> Result<Found> {
    match output.kind {
        Kind::Tiles => {
            let file = AtomicFile::create_locked(&output.path)?;
            let mut out = BufWriter::new(file.file());
            header.write_file(set, &mut out, &output.path)?;
            out.flush().with_context(|| output::unwritten(&output.path))?;
            drop(out);
            file.commit_written()?;
            let files = vec![output.path.clone()];
            Ok(Found { files, header: header.clone(), summary: None })
        }
        Kind::Picture { points } => write_picture(set, header, output, points),
    }
}

/// Prints what was found.
pub fn show(found: &Found, common: &Common) -> Result<()> {
    if common.json { output::print_json(found) } else { output::print(&text::report(found)) }
}

/// How many tiles may be in memory at once while results are made of them.
pub fn tiles_in_flight(plan: &Identity) -> usize {
    /// Bytes for them all, however many threads there are.
    const ROOM: usize = 96 << 20;
    /// Tiles for each thread: one being made, and some that wait for their turn.
    const PER_THREAD: usize = 8;
    (ROOM / tile_bytes(plan)).clamp(2, PER_THREAD * thread_count())
}

/// Bytes in memory, about, of one tile while results are made of it.
pub fn tile_bytes(plan: &Identity) -> usize {
    /// Its rows as stored, as numbers, as readings, as pixels and as text.
    const COPIES: usize = 6;
    COPIES * ROW_BYTES * plan.rows_per_pixel() * (plan.tile_side as usize).pow(2)
}

/// What is made of one tile, by any thread.
struct Piece {
    region: Region,
    readings: Vec<Vec<PixelReading>>,
    chunk: Chunk,
    rows: Vec<String>,
}

fn write_picture(set: &TileSet, header: &Header, output: &Output, points: bool) -> Result<Found> {
    let plan = set.plan();
    let layout = ExrLayout::new(plan);
    let file = AtomicFile::create_locked(&output.path)?;
    let mut tables = vec![TableFile::create(output.beside("fits.csv"), Table::Fits)?];
    if points {
        tables.push(TableFile::create(output.beside("points.csv"), Table::Points)?);
    }
    let mut tally = Tally::new(plan);
    let mut overview = Overview::new(plan);
    let comments = serde_json::to_string(&header)?;
    let kinds: Vec<Table> = tables.iter().map(|table| table.kind).collect();
    picture::exr::write(file.file(), layout.header(plan, &comments), |meta, chunks| {
        let make = |tile: usize| -> Result<(usize, Piece)> {
            let region = plan.tiling().tile(tile);
            let readings = read_tile(plan, &set.read(tile)?);
            let chunk = layout.chunk(meta, plan, region, &readings)?;
            let rows = kinds.iter().map(|kind| csv::rows(*kind, plan, region, &readings)).collect();
            Ok((tile, Piece { region, readings, chunk, rows }))
        };
        let each = |(tile, piece): (usize, Piece)| -> Result<()> {
            picture::exr::write_chunk(chunks, tile, piece.chunk)?;
            for (table, rows) in tables.iter_mut().zip(&piece.rows) {
                table.out.write_all(rows.as_bytes())?;
            }
            for (pixel, reading) in piece.region.pixels().zip(&piece.readings) {
                tally.add(pixel, reading);
                overview.add(plan, pixel, reading);
            }
            Ok(())
        };
        in_order(0..plan.tiling().n_tiles(), tiles_in_flight(plan), make, each)
    })
    .map_err(|fault| match fault.is::<RecordError>() {
        // It names the file of tiles that could not be read.
        true => fault,
        false => fault.context(output::unwritten(&output.path)),
    })?;
    let summary = tally.summary();
    // The disk is waited for while the map is drawn.
    let (on_disk, drawing) = both(
        || {
            tables.iter_mut().try_for_each(TableFile::flush)?;
            file.sync()
        },
        || overview.draw(plan, &summary).to_png(PNG_SCALE),
    );
    on_disk.with_context(|| output::unwritten(&output.path))?;
    let drawing = drawing.map_err(|fault| anyhow!("cannot draw the map: {fault}"))?;
    // The summary comes last: it says that all the others are there.
    file.commit_written()?;
    let mut files = vec![output.path.clone()];
    let png = output.beside("png");
    AtomicFile::create_locked(&png)?.commit(&drawing)?;
    files.push(png);
    for table in tables {
        files.push(table.finish()?);
    }
    let json = output.beside("json");
    files.push(json.clone());
    let found = Found { files, header: header.clone(), summary: Some(summary) };
    AtomicFile::create_locked(&json)?.commit(output::json(found.without_folders())?.as_bytes())?;
    Ok(found)
}

impl Found {
    /// With the files' names alone: what stands beside them.
    fn without_folders(&self) -> Self {
        let names = self.files.iter().filter_map(|path| path.file_name().map(PathBuf::from));
        let Self { header, summary, .. } = self;
        Self { files: names.collect(), header: header.clone(), summary: summary.clone() }
    }
}

/// A table being written.
struct TableFile {
    path: PathBuf,
    kind: Table,
    file: AtomicFile,
    out: BufWriter<fs::File>,
}

impl TableFile {
    fn create(path: PathBuf, kind: Table) -> Result<Self> {
        let file = AtomicFile::create_locked(&path)?;
        let again = file.file().try_clone();
        let mut out = BufWriter::new(again.context("cannot open a file twice")?);
        out.write_all(csv::header(kind).as_bytes()).with_context(|| output::unwritten(&path))?;
        Ok(Self { path, kind, file, out })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()?;
        self.file.sync()
    }

    fn finish(mut self) -> Result<PathBuf> {
        self.flush().with_context(|| output::unwritten(&self.path))?;
        self.file.commit_written()?;
        Ok(self.path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, Command};
    use clap::Parser;
    use stratcore::map::Shard;

    /// Tiles that go away between opening and reading are a fault of theirs, not of the picture.
    #[test]
    fn what_cannot_be_read_is_not_called_unwritable() {
        let folder = tempfile::tempdir().unwrap();
        let [tiles, picture] = ["m.tiles", "m.exr"].map(|name| folder.path().join(name));
        let typed = "stratcli --quiet map edges --region 0,0,8,8 --counts 1,4 --trials 2 -o";
        let cli = Cli::parse_from(typed.split(' ').map(Path::new).chain([&*tiles]));
        let Command::Map(args) = &cli.command else { unreachable!("a map was typed") };
        super::super::run(args, &cli.common).unwrap();
        let set = TileSet::merge(std::slice::from_ref(&tiles)).unwrap();
        let plan = set.plan().clone();
        let header = Header { hash: plan.hash(), shard: Shard::WHOLE, plan };
        let output = Output { path: picture.clone(), kind: Kind::Picture { points: false } };
        fs::remove_file(&tiles).unwrap();
        let fault = format!("{:#}", write(&set, &header, &output).err().unwrap());
        assert!(fault.contains("m.tiles: cannot read it"), "{fault}");
        assert!(!fault.contains("cannot write") && !picture.exists(), "{fault}");
    }
}
