//! What can be wrong with a file of tiles, each with its way out.

use super::cost::Shard;
use std::io;
use std::path::{Path, PathBuf};

/// A file of tiles that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct RecordError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong, and the way out.
    pub fault: RecordFault,
}

/// What is wrong with a file of tiles.
#[derive(Debug, thiserror::Error)]
pub enum RecordFault {
    /// The system refused to read.
    #[error("cannot read it: {0}; give the path of a file of tiles")]
    Read(io::Error),
    /// The system refused to write.
    #[error("cannot write it: {0}; choose a folder that exists, can be written to and has room")]
    Write(io::Error),
    /// Another run is writing to it.
    #[error("another run is writing it; wait for that run to end, or choose another output")]
    Locked,
    /// An unfinished run, and no word to go on with it.
    #[error(
        "an unfinished run is kept here, {finished} of {total} tiles done; go on with it by \
         --resume, or delete the file to start again"
    )]
    Unfinished {
        /// Tiles that are done.
        finished: usize,
        /// Tiles that were to be done.
        total: usize,
    },
    /// Not of this format.
    #[error("holds no tiles of a map; give files that `map` wrote, with the ending .tiles")]
    NotTiles,
    /// Of a plan other than that of the files before it.
    #[error("is of another plan: {0}; run both with the same scene and options")]
    ForeignPlan(String),
    /// An unfinished run of another plan.
    #[error(
        "an unfinished run of another plan is kept here: {0}; go on with that plan by --resume, \
         name another output, or delete the file"
    )]
    UnfinishedOther(String),
    /// Of another shard.
    #[error("holds shard {found}, not {wanted}; name one output for each shard")]
    ForeignShard {
        /// The shard in the file.
        found: Shard,
        /// The shard that is run.
        wanted: Shard,
    },
    /// Bytes that no run wrote.
    #[error(
        "is damaged or unfinished after {finished} tiles; run its shard, {shard}, again with \
         --resume"
    )]
    Damaged {
        /// Tiles before the damage.
        finished: usize,
        /// The file's shard.
        shard: Shard,
    },
    /// A tile that was there is not there any more.
    #[error("has changed since it was opened; leave it alone until the results are written")]
    Changed,
    /// A tile that stands in another file, too.
    #[error("tile {tile} is also in {}; give each shard once", other.display())]
    Overlap {
        /// The tile.
        tile: usize,
        /// The other file.
        other: PathBuf,
    },
    /// A tile that stands in no file.
    #[error(
        "and the other files lack {missing} of {total} tiles, the first of them tile {tile}; \
         {absent}"
    )]
    Gap {
        /// Tiles that are nowhere.
        missing: usize,
        /// Tiles of the map.
        total: usize,
        /// The first that is nowhere.
        tile: usize,
        /// The way out: shards to be run or finished.
        absent: String,
    },
    /// No file.
    #[error("there is nothing to merge; name the files that the shards wrote")]
    Nothing,
}

impl RecordFault {
    /// The same, said of a file.
    pub(super) fn of(self, path: &Path) -> RecordError {
        RecordError { path: path.to_owned(), fault: self }
    }
}
