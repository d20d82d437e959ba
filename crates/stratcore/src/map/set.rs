//! Files of tiles, read as one.

use super::cost::Shard;
use super::plan::Identity;
use super::record_error::{RecordError, RecordFault};
use super::records::{Header, Scan, read_frame, read_header, scan};
use crate::input;
use crate::study::collect;
use crate::variance::Moments;
use std::collections::{BTreeMap, HashSet};
use std::io::{self, BufReader, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Where a tile's frame begins: file and byte.
type Place = (u32, u64);

/// Files of one plan's tiles, read as one.
#[derive(Debug)]
pub struct TileSet {
    plan: Identity,
    pub(super) files: Vec<PathBuf>,
    /// Of the tiles that are there: a header alone, however large its picture, takes no room.
    pub(super) places: BTreeMap<usize, Place>,
}

impl TileSet {
    /// Opens the files of shards that make up one map.
    ///
    /// # Errors
    /// [`RecordError`] names the file that is of another plan, damaged, or doubles another; or
    /// the tiles and shards that are missing.
    pub fn merge(paths: &[PathBuf]) -> Result<Self, RecordError> {
        let scan_file = |path: &PathBuf| -> Result<(Header, Scan), RecordError> {
            let fail = |fault: RecordFault| fault.of(path);
            let file = input::open(path).map_err(|e| fail(RecordFault::Read(e)))?;
            let mut file = BufReader::new(file);
            let header = read_header(&mut file).map_err(fail)?;
            let scan = scan(&mut file, &header.plan).map_err(|e| fail(RecordFault::Read(e)))?;
            Ok((header, scan))
        };
        let mut set: Option<Self> = None;
        let mut shards: Vec<Shard> = Vec::new();
        // Every byte is read and hashed here, several files at a time.
        let scanned = collect(paths.iter().collect(), |path| Ok((path, scan_file(path))));
        let Ok(scanned): Result<_, std::convert::Infallible> = scanned;
        for (path, found) in scanned {
            let fail = |fault: RecordFault| fault.of(path);
            let (header, scan) = found?;
            let set = set.get_or_insert_with(|| Self::empty(header.plan.clone()));
            let differences = set.plan.differences(&header.plan);
            if !differences.is_empty() {
                return Err(fail(RecordFault::ForeignPlan(differences)));
            }
            if scan.rest > 0 {
                let (finished, shard) = (scan.frames.len(), header.shard);
                return Err(fail(RecordFault::Damaged { finished, shard }));
            }
            let number = set.files.len() as u32;
            set.files.push(path.clone());
            for (tile, at) in scan.frames {
                if let Some((other, _)) = set.places.insert(tile, (number, at)) {
                    let other = set.files[other as usize].clone();
                    return Err(fail(RecordFault::Overlap { tile, other }));
                }
            }
            shards.push(header.shard);
        }
        let set = set.ok_or_else(|| RecordFault::Nothing.of(Path::new("merge")))?;
        set.check_complete(&shards)?;
        Ok(set)
    }

    /// No tiles yet.
    pub(super) fn empty(plan: Identity) -> Self {
        Self { plan, files: Vec::new(), places: BTreeMap::new() }
    }

    fn check_complete(&self, shards: &[Shard]) -> Result<(), RecordError> {
        let total = self.plan.tiling().n_tiles();
        let missing = total - self.places.len();
        if missing == 0 {
            return Ok(());
        }
        // Keys run 0, 1, … up to the first that is missing.
        let tile = self.places.keys().zip(0..).take_while(|(tile, i)| *tile == i).count();
        let of = shards.iter().map(|shard| shard.of).max().unwrap_or(1);
        let given: HashSet<&Shard> = shards.iter().collect();
        let absent: Vec<_> = (1..=of)
            .map(|index| Shard { index, of })
            .filter(|shard| !given.contains(shard))
            .map(|shard| shard.to_string())
            .collect();
        let absent = match absent.as_slice() {
            [] => "finish the unfinished shards with --resume".to_owned(),
            [first, _, .., last] if absent.len() > 8 => {
                format!("add the files of {} shards, {first} to {last}", absent.len())
            }
            few => format!("add the files of shards {}", few.join(", ")),
        };
        let fault = RecordFault::Gap { missing, total, tile, absent };
        Err(fault.of(self.files.first().map_or(Path::new("merge"), PathBuf::as_path)))
    }

    /// The plan that the tiles are of.
    pub fn plan(&self) -> &Identity {
        &self.plan
    }

    /// Which tiles are there, in order.
    pub fn tiles(&self) -> impl Iterator<Item = usize> + '_ {
        self.places.keys().copied()
    }

    /// Whether the tile is there.
    pub fn contains(&self, tile: usize) -> bool {
        self.places.contains_key(&tile)
    }

    /// The rows of a tile that is there; nothing for one that is not.
    ///
    /// # Errors
    /// The file has changed since it was opened.
    pub fn read(&self, tile: usize) -> Result<Vec<Moments>, RecordError> {
        let Some((number, at)) = self.places.get(&tile).copied() else {
            return Ok(Vec::new());
        };
        let path = &self.files[number as usize];
        let frame = || -> io::Result<Option<Vec<Moments>>> {
            let mut file = input::open(path)?;
            file.seek(SeekFrom::Start(at))?;
            Ok(read_frame(&mut file, &self.plan)?.map(|(_, rows)| rows))
        };
        match frame() {
            Ok(Some(rows)) => Ok(rows),
            Ok(None) => Err(RecordFault::Changed.of(path)),
            Err(error) => Err(RecordFault::Read(error).of(path)),
        }
    }
}
