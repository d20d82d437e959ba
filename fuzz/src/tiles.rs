//! Files of tiles: checkpoints, and what `merge` is given.

use super::{files, says_one_line};
use std::cell::OnceCell;
use std::fs;
use std::path::{Path, PathBuf};
use stratcore::map::{Header, Identity, Shard, Tally, TileLog, TileSet, read_tile};
use stratcore::variance::Moments;

thread_local! {
    static FOLDER: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// A file in a folder of this thread's own, in memory where the system has such a place.
fn path(name: &str) -> PathBuf {
    let make =
        || tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder");
    FOLDER.with(|folder| folder.get_or_init(make).path().join(name))
}

/// A file as it is, merged and resumed.
pub fn raw(data: &[u8]) {
    let path = path("raw.tiles");
    fs::write(&path, data).expect("a writable folder");
    read(std::slice::from_ref(&path));
    match Header::read_file(&path) {
        Ok(Some(header)) => {
            let total = header.plan.tiling().n_tiles();
            match TileLog::open(&path, &header, total, true) {
                Ok(log) => drop(log.with_set(|set| set.tiles().count())),
                Err(error) => says_one_line(&error.to_string()),
            }
        }
        Ok(None) => panic!("the file was written"),
        Err(error) => says_one_line(&error.to_string()),
    }
}

/// A plan as JSON with the right hash, then tiles of any numbers with the right hash: what only
/// a forger writes. Each tile is its index and number of rows, a byte each, and words.
pub fn frames(data: &[u8]) {
    let [plan, tiles] = files(data);
    let Ok(plan) = serde_json::from_slice::<Identity>(plan) else { return };
    let header = Header { hash: plan.hash(), shard: Shard::WHOLE, plan };
    let path = path("frames.tiles");
    let _ = fs::remove_file(&path);
    let log = match TileLog::open(&path, &header, 1, false) {
        Ok(log) => log,
        Err(error) => return says_one_line(&error.to_string()),
    };
    let mut rest = tiles;
    while let [tile, n_rows, after @ ..] = rest {
        let mut words = after.chunks_exact(8).map(|word| {
            let bits = u64::from_le_bytes(std::array::from_fn(|i| word[i]));
            f64::from_bits(bits)
        });
        let mut number = || words.next().unwrap_or(1.0);
        let rows: Vec<_> = (0..*n_rows)
            .map(|_| Moments {
                count: number().to_bits(),
                mean: number(),
                variance: number(),
                skewness: number(),
                kurtosis: number(),
            })
            .collect();
        if log.append((*tile).into(), &rows).is_err() {
            break;
        }
        rest = &after[after.len().min(40 * usize::from(*n_rows))..];
    }
    drop(log);
    read(&[path]);
}

/// What `merge` does with files but for writing pictures.
fn read(paths: &[PathBuf]) {
    let set = match TileSet::merge(paths) {
        Ok(set) => set,
        Err(error) => return says_one_line(&error.to_string()),
    };
    let plan = set.plan();
    let mut tally = Tally::new(plan);
    for tile in set.tiles() {
        let moments = match set.read(tile) {
            Ok(moments) => moments,
            Err(error) => return says_one_line(&error.to_string()),
        };
        for (at, pixel) in plan.tiling().tile(tile).pixels().zip(read_tile(plan, &moments)) {
            tally.add(at, &pixel);
        }
    }
    serde_json::to_string(&tally.summary()).expect("a summary can be written");
    let header = Header { hash: plan.hash(), shard: Shard::WHOLE, plan: plan.clone() };
    let mut again = Vec::new();
    header.write_file(&set, &mut again, Path::new("again")).expect("what is read can be written");
}
