//! The paper's whole protocol over pictures: samples per second by beam and by rays, on one
//! thread and on two, and the cost of a sample by the length of the pixel's list.
//!
//! Rows are measured in turn, round after round, so that a machine that slows down slows all
//! of them: medians of ratios within a round mean more than the rates.

mod common;
#[path = "common/covered.rs"]
mod covered;

use anyhow::{Context, Result};
use clap::Parser;
use common::clock::Clock;
use common::{lattice, n_samples, protocol};
use covered::covered_by_one_triangle;
use std::collections::BTreeMap;
use std::io::{Write, stdout};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::time::{Duration, Instant};
use stratcli::report::PlotFile;
use stratcli::report::axis::{self, Axis, INK, plain};
use stratcli::report::chart::Style;
use stratcli::report::svg::{Rect, Stroke, Svg};
use stratcore::beam::PixelBeam;
use stratcore::scene::{Channel, Scene, load};
use stratcore::simd::Isa;
use stratcore::study::{Control, SamplerChoice, StudyPlan, study, study_pixels, with_threads};
use stratcore::trace::{TracedScene, Tracer};

#[derive(Parser)]
struct Args {
    /// Scene: a built-in name, or a .toml or .obj file; may be given again
    #[arg(long, default_values = ["classic", "grass", "classic-shadows"])]
    scene: Vec<String>,
    /// Sampler
    #[arg(long, default_value = "jittered")]
    sampler: String,
    /// Pixels per axis of the lattice
    #[arg(long, default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..))]
    lattice: u32,
    /// Draw time per sample against list length into this file, .svg or .png
    #[arg(long)]
    plot: Option<PathBuf>,
    /// Leave out the rows traced by rays and those on two threads
    #[arg(long)]
    beam_only: bool,
    /// Times that every row is measured
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..))]
    rounds: u32,
    /// What cargo says to every bench
    #[arg(long, hide = true)]
    bench: bool,
}

/// Pixels per axis of the sparse lattice that rays can afford.
const SPARSE_SIDE: u32 = 4;

fn main() -> Result<()> {
    let args = Args::parse();
    let plan = protocol(SamplerChoice::named(&args.sampler)?);
    writeln!(
        stdout(),
        "instruction set {}; {} samples a pixel",
        Isa::detect().name(),
        n_samples(&plan)
    )?;
    let plot = args.plot.as_deref().map(PlotFile::create).transpose()?;
    let mut clouds = Vec::new();
    for name in &args.scene {
        clouds.push(measure(load(name)?, &plan, &args).with_context(|| name.clone())?);
    }
    plot.map_or(Ok(()), |plot| plot.commit(&draw(&clouds)))
}

/// Pixels of one scene: list length and nanoseconds per sample; and the same of the median pixel
/// at the limit.
struct Cloud {
    scene: String,
    pixels: Vec<(usize, f64)>,
    limit: f64,
}

/// What is measured: pixels of a scene, by a tracer, on so many threads.
struct Row<'a> {
    name: &'static str,
    scene: &'a TracedScene,
    pixels: &'a [[u32; 2]],
    threads: usize,
    /// The row that `ratio` compares with.
    base: usize,
}

fn measure(scene: Scene, plan: &StudyPlan, args: &Args) -> Result<Cloud> {
    let name = scene.name.clone();
    let n_triangles = scene.mesh.triangles.len();
    let limit = TracedScene::new(covered_by_one_triangle(scene.clone()));
    let rays = TracedScene::new(scene.clone()).with_tracer(Tracer::Bvh);
    let start = Instant::now();
    let scene = TracedScene::new(scene);
    let build = start.elapsed();

    let all = lattice(&scene.scene().camera, args.lattice);
    let sparse = lattice(&scene.scene().camera, SPARSE_SIDE);
    let mut non_empty = all.clone();
    non_empty.retain(|&pixel| list_length(&scene, pixel).is_none_or(|length| length > 0));
    let row = |name, scene, pixels, threads, base| Row { name, scene, pixels, threads, base };
    let mut rows = vec![
        row("limit: one triangle covers all", &limit, &all[..], 1, 0),
        row("beam, all pixels", &scene, &all, 1, 0),
        row("beam, non-empty pixels", &scene, &non_empty, 1, 0),
        row("beam, all pixels", &scene, &all, 2, 1),
        row("beam, non-empty pixels", &scene, &non_empty, 2, 2),
        row("BVH, sparse lattice", &rays, &sparse, 1, 5),
        row("beam, sparse lattice", &scene, &sparse, 1, 5),
    ];
    if args.beam_only {
        rows.truncate(3);
    }
    let mut times = vec![Vec::new(); rows.len()];
    for _ in 0..args.rounds {
        for (row, times) in rows.iter().zip(&mut times) {
            times.push(time(row, plan)?.as_secs_f64());
        }
    }

    let mut out = stdout().lock();
    writeln!(out, "\n{name}: {n_triangles} triangles, BVH built in {:.2} s", build.as_secs_f64())?;
    writeln!(out, "{:32} {:>7} {:>7} {:>9}   ratio", "", "pixels", "threads", "M/s")?;
    for (i, row) in rows.iter().enumerate().filter(|(_, row)| !row.pixels.is_empty()) {
        let rate = |i: usize, round: usize| {
            rows[i].pixels.len() as f64 * n_samples(plan) as f64 / times[i][round]
        };
        let rounds = 0..times[i].len();
        let speed = median(rounds.clone().map(|round| rate(i, round)).collect());
        let ratio = median(rounds.map(|round| rate(i, round) / rate(row.base, round)).collect());
        let (pixels, threads) = (row.pixels.len(), row.threads);
        write!(out, "{:32} {pixels:7} {threads:7} {:9.1}", row.name, speed / 1e6)?;
        match row.base {
            base if base == i => writeln!(out)?,
            base => writeln!(out, "   {ratio:.3} of {}", described(&rows[base]))?,
        }
    }
    let (pixels, limit) = by_list_length(&mut out, [&scene, &limit], &all, plan)?;
    Ok(Cloud { scene: name, pixels, limit })
}

/// Empty lists stand at one half.
fn draw(clouds: &[Cloud]) -> Svg {
    let title = "Time per sample against triangles in the pixel's list";
    let area = Rect { x: 78.0, y: 50.0 + 19.0 * clouds.len() as f64, w: 412.0, h: 290.0 };
    let mut svg = Svg::new(540.0, area.y + area.h + 56.0, title);
    svg.text([28.0, 30.0], plain(16.0, INK), title);
    let pixels = || clouds.iter().flat_map(|cloud| &cloud.pixels);
    let longest = pixels().map(|(length, _)| *length).max().unwrap_or(1).max(1) as f64;
    let [least, most] =
        pixels().fold([0.5, 5.0], |[lo, hi]: [f64; 2], (_, time)| [lo.min(*time), hi.max(*time)]);
    let x = Axis::log([0.4, 1.5 * longest], [area.x, area.x + area.w]);
    let y = Axis::log([0.8 * least, 1.25 * most], [area.y + area.h, area.y]);
    axis::draw(&mut svg, area, &x, &y, ["triangles in the list", "ns per sample"]);
    for (i, cloud) in clouds.iter().enumerate() {
        let Style { colour, .. } = Style::nth(i);
        let row = 50.0 + 19.0 * i as f64;
        svg.disc([36.0, row], 4.0, colour);
        let words = format!(
            "{}: {} pixels; dashed: one triangle, {:.2} ns",
            cloud.scene,
            cloud.pixels.len(),
            cloud.limit
        );
        svg.text([50.0, row + 4.5], plain(13.0, INK), &words);
        for (length, time) in &cloud.pixels {
            svg.disc([x.at((*length as f64).max(0.5)), y.at(*time)], 1.3, colour);
        }
        let dashed = Stroke { colour, width: 0.9, dash: "4 4" };
        svg.line([area.x, y.at(cloud.limit)], [area.x + area.w, y.at(cloud.limit)], dashed);
    }
    svg
}

fn described(row: &Row) -> String {
    format!("\"{}\" on {} thread{}", row.name, row.threads, if row.threads == 1 { "" } else { "s" })
}

/// Triangles that the pixel's beam holds; none where the scene is traced by rays.
fn list_length(scene: &TracedScene, pixel: [u32; 2]) -> Option<usize> {
    let beam = PixelBeam::new(scene.scene(), scene.accel(), pixel, Channel::Luminance)?;
    Some(beam.n_facets())
}

/// Time of a row, threads started: the processor's. That goes in steps, so short rows are
/// measured several times over.
fn time(row: &Row, plan: &StudyPlan) -> Result<Duration> {
    const ENOUGH: Duration = Duration::from_millis(400);
    let Row { scene, pixels, threads, .. } = *row;
    let integrand = |pixel| scene.pixel(pixel, Channel::Luminance);
    with_threads(Some(threads), || {
        let start = Clock::start(threads == 1);
        let mut passes = 0;
        loop {
            let pixels = pixels.iter().copied();
            study_pixels(&integrand, pixels, plan, Control::unwatched(), &mut |_| ())?;
            passes += 1;
            let elapsed = start.elapsed();
            if elapsed >= ENOUGH || row.pixels.is_empty() {
                return Ok(elapsed / passes);
            }
        }
    })
}

/// Time per sample, set-up included, of the pixels whose lists are about as long, and of the
/// median pixel beside the same pixel at the limit. Gives back each pixel's length and time, and
/// the median at the limit.
fn by_list_length(
    out: &mut impl Write,
    [scene, limit]: [&TracedScene; 2],
    pixels: &[[u32; 2]],
    plan: &StudyPlan,
) -> Result<(Vec<(usize, f64)>, f64)> {
    let mut all = Vec::new();
    let mut groups: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
    let mut at_limit = Vec::new();
    let nanoseconds = |scene: &TracedScene, pixel| -> Result<f64> {
        // Too short for the processor's clock; other work only ever adds time to the wall's.
        let mut fastest = Duration::MAX;
        for _ in 0..3 {
            let start = Instant::now();
            let integrand = scene.pixel(pixel, Channel::Luminance);
            study(&integrand, pixel, plan, Control::unwatched())?;
            fastest = fastest.min(start.elapsed());
        }
        Ok(fastest.as_secs_f64() * 1e9 / n_samples(plan) as f64)
    };
    with_threads(Some(1), || -> Result<()> {
        for &pixel in pixels {
            let Some(length) = list_length(scene, pixel) else { continue };
            let time = nanoseconds(scene, pixel)?;
            groups.entry(octave(length)).or_default().push(time);
            all.push((length, time));
            at_limit.push(nanoseconds(limit, pixel)?);
        }
        Ok(())
    })?;
    if groups.is_empty() {
        writeln!(out, "traced by rays: the beam does not serve this scene")?;
        return Ok((all, f64::NAN));
    }
    let every: Vec<f64> = groups.values().flatten().copied().collect();
    writeln!(out, "{:>14} {:>7} {:>12}", "list length", "pixels", "ns/sample")?;
    for (octave, times) in groups {
        let lengths = lengths(octave);
        let lengths = format!("{}-{}", lengths.start(), lengths.end());
        let pixels = times.len();
        writeln!(out, "{lengths:>14} {pixels:7} {:12.2}", median(times))?;
    }
    writeln!(out, "{:>14} {:7} {:12.2}", "median of all", every.len(), median(every))?;
    let (n, limit) = (at_limit.len(), median(at_limit));
    writeln!(out, "{:>14} {n:7} {limit:12.2}", "limit")?;
    Ok((all, limit))
}

/// 0 for an empty list, else one more than the length's binary logarithm.
fn octave(length: usize) -> usize {
    length.checked_ilog2().map_or(0, |log| log as usize + 1)
}

/// The lengths in an octave.
fn lengths(octave: usize) -> RangeInclusive<usize> {
    match octave.checked_sub(1) {
        None => 0..=0,
        Some(log) => 1 << log..=(2 << log) - 1,
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
