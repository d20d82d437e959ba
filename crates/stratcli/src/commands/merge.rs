//! `merge`: the shards of a map to one map.

use super::Outcome;
use super::map::finish::{self, Output};
use crate::cli::{Common, MergeArgs};
use anyhow::{Context, Result};
use std::fs;
use stratcore::map::{Header, Shard, TileLog, TileSet};

pub fn run(args: &MergeArgs, common: &Common) -> Result<Outcome> {
    let output = Output::of(&args.output, args.points)?;
    let set = TileSet::merge(&args.shards)?;
    let plan = set.plan().clone();
    let header = Header { hash: plan.hash(), shard: Shard::WHOLE, plan };
    // Nothing is logged: the log's lock keeps other runs away from the output.
    let part = output.part();
    let total = header.plan.tiling().n_tiles();
    let lock = TileLog::open(&part, &header, total, true)?;
    let found = finish::write(&set, &header, &output)?;
    fs::remove_file(&part).with_context(|| format!("cannot remove {}", part.display()))?;
    drop(lock);
    finish::show(&found, common)?;
    Ok(Outcome::Done)
}
