//! Files of finished tiles.
//!
//! A file is two lines of text, the format's name and a [`Header`] as JSON, and then a frame per
//! tile in any order: its index, its rows (trials, and mean, variance, skewness and kurtosis of
//! their means), and the hash of both, in words of 64 bits, least significant byte first. How long a
//! frame is follows from the plan. A frame that a killed run left unfinished is not counted, and
//! is overwritten when the run goes on.

use super::cost::Shard;
use super::digest::Digest;
use super::plan::Identity;
use super::record_error::{RecordError, RecordFault};
use super::set::TileSet;
use crate::input;
use crate::variance::Moments;
use serde::{Deserialize, Serialize};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// First line of every file.
const FORMAT: &str = "strat tiles 1\n";

/// What a file says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`Identity::hash`] of the plan.
    pub hash: String,
    /// Which part of the plan's tiles the file is for.
    pub shard: Shard,
    /// The plan.
    pub plan: Identity,
}

impl Header {
    /// Writes a file of tiles to `out`: this header, then every tile of `set` in order. `path`
    /// is what errors name.
    ///
    /// # Errors
    /// Those of reading the set, and of writing.
    pub fn write_file(
        &self,
        set: &TileSet,
        out: &mut dyn Write,
        path: &Path,
    ) -> Result<(), RecordError> {
        let fail = |error| RecordFault::Write(error).of(path);
        out.write_all(&header_bytes(self)).map_err(fail)?;
        for tile in set.tiles() {
            out.write_all(&frame_bytes(tile, &set.read(tile)?)).map_err(fail)?;
        }
        Ok(())
    }

    /// The header of an existing file of tiles; none where there is no file.
    ///
    /// # Errors
    /// The file is there but cannot be read, or holds no tiles.
    pub fn read_file(path: &Path) -> Result<Option<Self>, RecordError> {
        match input::open(path) {
            Ok(file) => {
                read_header(&mut BufReader::new(file)).map(Some).map_err(|fault| fault.of(path))
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(RecordFault::Read(error).of(path)),
        }
    }
}

pub(super) fn header_bytes(header: &Header) -> Vec<u8> {
    // None of its parts can fail to be written.
    let json = serde_json::to_string(header).unwrap_or_default();
    [FORMAT.as_bytes(), json.as_bytes(), b"\n"].concat()
}

/// Reads the header; what follows are frames.
pub(super) fn read_header(file: &mut impl BufRead) -> Result<Header, RecordFault> {
    /// Longer than any plan: a file of another kind may have no lines.
    const LONGEST: u64 = 1 << 20;
    let mut line = |longest| {
        let mut bytes = Vec::new();
        file.take(longest).read_until(b'\n', &mut bytes).map_err(RecordFault::Read)?;
        Ok(bytes)
    };
    if line(FORMAT.len() as u64)? != FORMAT.as_bytes() {
        return Err(RecordFault::NotTiles);
    }
    let json = line(LONGEST)?;
    let header: Header = serde_json::from_slice(&json).map_err(|_| RecordFault::NotTiles)?;
    let Shard { index, of } = header.shard;
    let is_sound = header.plan.is_sound() && Shard::new(index, of).is_ok();
    if header.plan.hash() != header.hash || !is_sound {
        return Err(RecordFault::NotTiles);
    }
    Ok(header)
}

/// The sound frames of a file.
pub(super) struct Scan {
    /// Tile and first byte.
    pub frames: Vec<(usize, u64)>,
    /// Byte after the last of them.
    pub end: u64,
    /// Bytes after that.
    pub rest: u64,
}

/// Reads frames from just after the header.
pub(super) fn scan(file: &mut (impl BufRead + Seek), plan: &Identity) -> io::Result<Scan> {
    let mut frames = Vec::new();
    let mut end = file.stream_position()?;
    while let Some((tile, _)) = read_frame(file, plan)? {
        frames.push((tile, end));
        end = file.stream_position()?;
    }
    let rest = file.seek(SeekFrom::End(0))?.saturating_sub(end);
    Ok(Scan { frames, end, rest })
}

/// Numbers that are kept of one sampler and count: count, mean, variance, skewness, kurtosis.
const NUMBERS: usize = 5;
/// The same in bytes.
pub const ROW_BYTES: usize = 8 * NUMBERS;

pub(super) fn frame_bytes(tile: usize, rows: &[Moments]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(ROW_BYTES * rows.len() + 24);
    let mut digest = Digest::new();
    let words = rows.iter().flat_map(|row| {
        let Moments { count, mean, variance, skewness, kurtosis } = *row;
        let [mean, variance, skewness, kurtosis] =
            [mean, variance, skewness, kurtosis].map(f64::to_bits);
        [count, mean, variance, skewness, kurtosis]
    });
    for word in std::iter::once(tile as u64).chain(words) {
        digest.word(word);
        bytes.extend(word.to_le_bytes());
    }
    bytes.extend(digest.finish().to_le_bytes());
    bytes
}

/// The next frame; none where there is no whole and sound one.
pub(super) fn read_frame(
    file: &mut impl Read,
    plan: &Identity,
) -> io::Result<Option<(usize, Vec<Moments>)>> {
    let mut word = [0; 8];
    if !read_whole(file, &mut word)? {
        return Ok(None);
    }
    let index = u64::from_le_bytes(word);
    let tiling = plan.tiling();
    let Some(tile) = usize::try_from(index).ok().filter(|tile| *tile < tiling.n_tiles()) else {
        return Ok(None);
    };
    let n_rows = tiling.tile(tile).n_pixels() as usize * plan.rows_per_pixel();
    // Memory follows what the file holds, not what its plan promises.
    let len = ROW_BYTES * n_rows + 16;
    let mut bytes = Vec::with_capacity(len.min(1 << 20));
    if file.take(len as u64).read_to_end(&mut bytes)? < len {
        return Ok(None);
    }
    let (payload, hash) = bytes.split_at(ROW_BYTES * n_rows);
    let mut digest = Digest::new();
    digest.word(index);
    let (rows, _) = payload.as_chunks::<ROW_BYTES>();
    let moments = rows.iter().map(|row| {
        let (words, _) = row.as_chunks::<8>();
        let [count, rest @ ..]: [u64; NUMBERS] = std::array::from_fn(|i| {
            let word = u64::from_le_bytes(words[i]);
            digest.word(word);
            word
        });
        let [mean, variance, skewness, kurtosis] = rest.map(f64::from_bits);
        Moments { count, mean, variance, skewness, kurtosis }
    });
    let moments = moments.collect();
    Ok((hash == digest.finish().to_le_bytes()).then_some((tile, moments)))
}

/// Fills `bytes`; false where the file ends before.
fn read_whole(file: &mut impl Read, bytes: &mut [u8]) -> io::Result<bool> {
    match file.read_exact(bytes) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(false),
        Err(error) => Err(error),
    }
}
