//! The file that a run adds its tiles to.

use super::record_error::{RecordError, RecordFault};
use super::records::{Header, frame_bytes, header_bytes, read_header, scan};
use super::set::TileSet;
use crate::input::refuse_irregular;
use crate::variance::Moments;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A file that one run adds finished tiles to. It is locked against other runs for as long as
/// this value, or the process, lives.
#[derive(Debug)]
pub struct TileLog {
    path: PathBuf,
    /// The file and its length.
    file: Mutex<(File, u64)>,
    set: Mutex<TileSet>,
    /// Whether the file system refused to lock the file.
    pub unlocked: bool,
}

impl TileLog {
    /// Opens the file, or makes it. An existing one must be of the same plan and shard, and is
    /// gone on with only if `resume`; `total` is how many tiles the shard has.
    ///
    /// # Errors
    /// [`RecordError`] says why the file cannot be used.
    pub fn open(
        path: &Path,
        header: &Header,
        total: usize,
        resume: bool,
    ) -> Result<Self, RecordError> {
        let fail = |fault: RecordFault| fault.of(path);
        let read = |error| fail(RecordFault::Read(error));
        let write = |error| fail(RecordFault::Write(error));
        let mut options = OpenOptions::new();
        let mut file = options
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(path)
            .map_err(write)?;
        file.metadata().and_then(|found| refuse_irregular(&found)).map_err(read)?;
        let unlocked = match file.try_lock() {
            Ok(()) => false,
            Err(TryLockError::WouldBlock) => return Err(fail(RecordFault::Locked)),
            Err(TryLockError::Error(_)) => true,
        };
        let first_bytes = header_bytes(header);
        let mut set = TileSet::empty(header.plan.clone());
        set.files.push(path.to_owned());
        let mut start = Vec::new();
        (&file).take(first_bytes.len() as u64).read_to_end(&mut start).map_err(read)?;
        let len = if first_bytes.starts_with(&start) && start.len() < first_bytes.len() {
            // New, or killed before the header was written.
            file.set_len(0).and_then(|()| file.rewind()).map_err(write)?;
            file.write_all(&first_bytes).map_err(write)?;
            first_bytes.len() as u64
        } else {
            file.rewind().map_err(read)?;
            let mut reader = BufReader::new(&file);
            let found = read_header(&mut reader).map_err(fail)?;
            let differences = header.plan.differences(&found.plan);
            if !differences.is_empty() {
                return Err(fail(RecordFault::UnfinishedOther(differences)));
            }
            if found.shard != header.shard {
                let (found, wanted) = (found.shard, header.shard);
                return Err(fail(RecordFault::ForeignShard { found, wanted }));
            }
            let scan = scan(&mut reader, &header.plan).map_err(read)?;
            if !resume && !scan.frames.is_empty() {
                let finished = scan.frames.len();
                return Err(fail(RecordFault::Unfinished { finished, total }));
            }
            for (tile, at) in scan.frames {
                set.places.insert(tile, (0, at));
            }
            file.set_len(scan.end).map_err(write)?;
            file.seek(SeekFrom::Start(scan.end)).map_err(write)?;
            scan.end
        };
        let file = Mutex::new((file, len));
        Ok(Self { path: path.to_owned(), file, set: Mutex::new(set), unlocked })
    }

    /// Adds a finished tile. A process that is killed from here on keeps it.
    ///
    /// # Errors
    /// The disk is full, or gone.
    pub fn append(&self, tile: usize, rows: &[Moments]) -> Result<(), RecordError> {
        let frame = frame_bytes(tile, rows);
        let mut guard = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let (file, len) = &mut *guard;
        file.write_all(&frame).map_err(|e| RecordFault::Write(e).of(&self.path))?;
        let at = *len;
        *len += frame.len() as u64;
        let mut set = self.set.lock().unwrap_or_else(PoisonError::into_inner);
        set.places.insert(tile, (0, at));
        Ok(())
    }

    /// Looks at the finished tiles.
    pub fn with_set<R>(&self, look: impl FnOnce(&TileSet) -> R) -> R {
        look(&self.set.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
