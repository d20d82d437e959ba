//! `--dry-run`: what a map would take, and how far earlier estimates were off.
//!
//! Estimates are kept in `estimates.csv` beside the output. A run that was estimated there adds
//! the time it took.

use super::Job;
use super::finish::{tile_bytes, tiles_in_flight};
use crate::cli::Common;
use crate::commands::Outcome;
use crate::commands::inspect::MemoryFacts;
use crate::output;
use crate::table::{Align, columns, number};
use anyhow::Result;
use serde::Serialize;
use std::fs::OpenOptions;
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use stratcore::input::{self, MAX_DOCUMENT};
use stratcore::map::{Header, MapStudy, ROW_BYTES, Shard};
use stratcore::study::{Control, collect, thread_count};

/// What a map would take.
#[derive(Serialize)]
struct Estimate {
    hash: String,
    shard: Shard,
    pixels: u64,
    tiles: usize,
    samples: u64,
    threads: usize,
    /// Pixels that were studied for the estimate.
    calibrated_on: usize,
    seconds: f64,
    /// Its standard error, from the spread of the pixels' times.
    std_error: f64,
    memory_bytes: u64,
    disk_bytes: u64,
    /// (estimate - truth) / truth of the runs that followed earlier estimates here.
    past_errors: Vec<f64>,
}

/// Measures some pixels and says what all would take.
pub fn run(job: &Job, common: &Common) -> Result<Outcome> {
    let tiles = job.tiles();
    let (times, threads) = (calibrate(job, &tiles)?, thread_count());
    let pixels = job.pixels(&tiles);
    let n = times.len() as f64;
    let mean = times.iter().sum::<f64>() / n;
    let variance = times.iter().map(|t| (t - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
    let share = pixels as f64 / threads as f64;
    let estimate = Estimate {
        hash: job.identity.hash(),
        shard: job.shard,
        pixels,
        tiles: tiles.len(),
        samples: job.samples(&tiles),
        threads,
        calibrated_on: times.len(),
        seconds: mean * share,
        std_error: (variance / n).sqrt() * share,
        memory_bytes: memory(job, tiles.len()),
        disk_bytes: disk(job, pixels),
        past_errors: past(job).iter().filter_map(Past::error).collect(),
    };
    let key = key(&estimate.hash, job.shard, threads);
    append(job, &format!("{key},{},{},", estimate.seconds, estimate.std_error), common);
    if common.json {
        output::print_json(estimate)?;
    } else {
        output::print(&text(&estimate, job.plan.exact))?;
    }
    Ok(Outcome::Done)
}

/// Seconds of single pixels, for half a second on every thread. Pixels are taken from all over
/// the tiles: any number of them in a row is spread evenly.
fn calibrate(job: &Job, tiles: &[usize]) -> Result<Vec<f64>> {
    const LASTS: Duration = Duration::from_millis(500);
    const PER_THREAD: u64 = 16;
    /// The golden ratio's fractional part, as a fraction of 2^64.
    const STEP: u64 = 0x9e37_79b9_7f4a_7c15;
    let tiling = job.identity.tiling();
    let total = job.pixels(tiles);
    let mut ends = Vec::with_capacity(tiles.len());
    let mut sum = 0;
    for &tile in tiles {
        sum += tiling.tile(tile).n_pixels();
        ends.push(sum);
    }
    let pixel = |i: u64| -> Option<[u32; 2]> {
        let at = ((u128::from(i.wrapping_mul(STEP)) * u128::from(total)) >> 64) as u64;
        let place = ends.partition_point(|end| *end <= at);
        let region = tiling.tile(*tiles.get(place)?);
        let within = at - (ends[place] - region.n_pixels());
        let width = u64::from(region.size()[0]);
        Some([region.x0 + (within % width) as u32, region.y0 + (within / width) as u32])
    };
    let study = MapStudy::new(&job.scene, &job.plan)?;
    let time = |i: u64| -> Result<Option<f64>> {
        let Some(pixel) = pixel(i) else { return Ok(None) };
        let start = Instant::now();
        study.pixel(pixel, Control::unwatched())?;
        Ok(Some(start.elapsed().as_secs_f64()))
    };
    // What is made once in a process, such as costly point sets, is no part of a pixel's time.
    time(0)?;
    let start = Instant::now();
    let mut times = Vec::new();
    let mut next = 0;
    while next < total && (times.is_empty() || start.elapsed() < LASTS) {
        let end = total.min(next + PER_THREAD * thread_count() as u64);
        times.extend(collect((next..end).collect(), time)?.into_iter().flatten());
        next = end;
    }
    Ok(times)
}

/// Bytes that are kept of one pixel.
fn record_bytes(job: &Job) -> u64 {
    (ROW_BYTES * job.identity.rows_per_pixel()) as u64
}

fn memory(job: &Job, n_tiles: usize) -> u64 {
    /// The program, its tables and the overview.
    const PROGRAM: u64 = 32 << 20;
    let MemoryFacts { scene, bvh } = MemoryFacts::of(&job.scene);
    let tiles = tile_bytes(&job.identity) * tiles_in_flight(&job.identity);
    let places = 40 * n_tiles as u64;
    (scene + bvh + tiles) as u64 + PROGRAM + places
}

/// The tiles and the results that stand beside them, compression left out.
fn disk(job: &Job, pixels: u64) -> u64 {
    const FIT_ROW: u64 = 200;
    const POINT_ROW: u64 = 130;
    let plan = &job.identity;
    let (samplers, rows) = (plan.samplers.len() as u64, plan.rows_per_pixel() as u64);
    let tiles = record_bytes(job);
    let results = match job.output.kind {
        super::finish::Kind::Tiles => tiles,
        super::finish::Kind::Picture { points } => {
            let channels = 3 + 4 * samplers + rows;
            4 * channels + FIT_ROW * samplers + if points { POINT_ROW * rows } else { 0 }
        }
    };
    pixels.saturating_mul(tiles + results)
}

fn text(estimate: &Estimate, exact: bool) -> String {
    let Estimate { pixels, tiles, samples, threads, seconds, std_error, .. } = estimate;
    let bytes = |bytes: u64| match bytes {
        ..1_000_000_000 => format!("{} MB", number(bytes as f64 * 1e-6, 3)),
        _ => format!("{} GB", number(bytes as f64 * 1e-9, 3)),
    };
    let rows = [
        ("pixels", format!("{pixels} in {tiles} tiles")),
        // Which pixels need trials is known when they have been tried.
        ("samples", if exact { "up to " } else { "" }.to_owned() + &number(*samples as f64, 4)),
        (
            "time",
            format!(
                "{} s ± {} on {threads} threads, from {} pixels",
                number(*seconds, 3),
                number(*std_error, 2),
                estimate.calibrated_on
            ),
        ),
        ("past estimates", past_text(&estimate.past_errors)),
        ("memory", bytes(estimate.memory_bytes)),
        ("disk", format!("up to {}", bytes(estimate.disk_bytes))),
        ("plan", estimate.hash.clone()),
    ];
    let rows: Vec<_> = rows.map(|(name, fact)| vec![name.to_owned(), fact]).into();
    columns(Align::Left, &rows)
}

fn past_text(errors: &[f64]) -> String {
    let percent = |x: f64| format!("{:+.0} %", 100.0 * x);
    let (low, high) =
        errors.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    match errors {
        [] => "none in this folder".to_owned(),
        [one] => format!("one in this folder, off by {}", percent(*one)),
        _ => {
            format!("{} in this folder, off by {} to {}", errors.len(), percent(low), percent(high))
        }
    }
}

const COLUMNS: &str = "plan,shard,threads,estimated_s,std_error_s,took_s";

/// A line of `estimates.csv`.
struct Past {
    key: String,
    estimated: f64,
    took: Option<f64>,
}

impl Past {
    fn error(&self) -> Option<f64> {
        self.took.map(|took| self.estimated / took - 1.0)
    }
}

fn file(job: &Job) -> PathBuf {
    job.output.path.with_file_name("estimates.csv")
}

fn key(hash: &str, shard: Shard, threads: usize) -> String {
    format!("{hash},{shard},{threads}")
}

/// Lines that are none of ours, as after a full disk, are passed over.
fn past(job: &Job) -> Vec<Past> {
    let text = input::read_text(&file(job), MAX_DOCUMENT).unwrap_or_default();
    let read = |line: &str| -> Option<Past> {
        let fields: Vec<_> = line.split(',').collect();
        let [plan, shard, threads, estimated, _, took] = *fields else { return None };
        let key = [plan, shard, threads].join(",");
        Some(Past { key, estimated: estimated.parse().ok()?, took: took.parse().ok() })
    };
    text.lines().filter_map(read).collect()
}

/// Remembers a line. An estimate or a map is worth having where it cannot be remembered.
fn append(job: &Job, line: &str, common: &Common) {
    let path = file(job);
    let write = || -> std::io::Result<()> {
        let mut file = OpenOptions::new().append(true).create(true).open(&path)?;
        if file.metadata()?.len() == 0 {
            writeln!(file, "{COLUMNS}")?;
        }
        writeln!(file, "{line}")
    };
    if let Err(error) = write()
        && !common.quiet
    {
        output::note(&format!(
            "note: cannot write {}: {error}; this is not remembered for later estimates",
            path.display()
        ));
    }
}

/// Holds the time that a run took against its estimate, if there is one.
pub fn judge(job: &Job, header: &Header, took: Duration, common: &Common) {
    let key = key(&header.hash, job.shard, thread_count());
    let Some(past) = past(job).into_iter().rfind(|past| past.key == key) else { return };
    let took = took.as_secs_f64();
    append(job, &format!("{key},{},,{took}", past.estimated), common);
    if !common.quiet {
        output::note(&format!(
            "took {} s; the estimate was {} s, {:+.0} %",
            number(took, 3),
            number(past.estimated, 3),
            100.0 * (past.estimated / took - 1.0)
        ));
    }
}
