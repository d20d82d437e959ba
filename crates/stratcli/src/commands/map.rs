//! `map`: how fast every pixel of a picture converges.
//!
//! Finished tiles are kept in a file beside the output, `OUTPUT.part`. When all are there, one
//! pass over them in order writes every result, so that results do not depend on how, when and
//! where the tiles were made.

mod csv;
mod estimate;
mod exr;
pub mod finish;
mod overview;
mod shard;
mod text;

use super::Outcome;
use crate::cli::{Common, MapArgs};
use crate::output;
use crate::plan;
use crate::progress::Progress;
use anyhow::{Context, Result, ensure};
use finish::{Found, Kind, Output};
use std::fs;
use std::time::Instant;
use stratcore::StudyError;
use stratcore::integrand::Integrand as _;
use stratcore::map::{Header, Identity, MapPlan, MapStudy, Region, Shard, TileLog, expected_costs};
use stratcore::study::for_each;
use stratcore::trace::TracedScene;

/// What one run of `map` has to do.
pub struct Job {
    pub scene: TracedScene,
    pub plan: MapPlan,
    pub identity: Identity,
    pub shard: Shard,
    pub output: Output,
    pub resume: bool,
}

pub fn run(args: &MapArgs, common: &Common) -> Result<Outcome> {
    let output = Output::of(&args.output, args.points)?;
    let shard = args.shard.as_deref().map_or(Ok(Shard::WHOLE), shard::read)?;
    ensure!(
        args.shard.is_none() || output.kind == Kind::Tiles,
        "--output {}: a shard writes tiles, not a picture; name a file that ends in .tiles, and \
         merge the shards' files by `stratcli merge`",
        args.output.display()
    );
    let region = args.region.as_deref().map(str::parse).transpose().context("--region")?;
    let scene = super::load(&args.scene, common)?;
    let traced = TracedScene::new(scene).with_tracer(plan::tracer(args.tracer));
    let (channel, _) = plan::channel(args.channel);
    let dim = traced.pixel([0, 0], channel).dim();
    let study = plan::study_plan(&args.protocol, common, dim)?;
    let size = traced.scene().camera.resolution;
    let region = region.unwrap_or(Region::whole(size));
    region.check(size).context("--region")?;
    let plan = MapPlan { study, region, channel, exact: args.exact };
    let job = Job::new(traced, plan, output)?;
    let job = Job { shard, resume: args.resume, ..job };
    if args.dry_run {
        return estimate::run(&job, common);
    }
    match job.run(common)? {
        Made::Written(found) => finish::show(&found, common)?,
        Made::Earlier => {
            if !common.quiet {
                output::note(&format!("{} is finished already", job.output.path.display()));
            }
            finish::show(&finish::read(&job.output)?, common)?;
        }
        Made::Interrupted => return Ok(Outcome::Interrupted),
    }
    Ok(Outcome::Done)
}

/// What became of a job.
pub enum Made {
    /// Its results were written.
    Written(Box<Found>),
    /// They were there already.
    Earlier,
    /// Stopped by Ctrl-C; what was finished is kept.
    Interrupted,
}

impl Job {
    /// The whole map of a plan, from the beginning. The plan's region has been checked.
    pub fn new(scene: TracedScene, plan: MapPlan, output: Output) -> Result<Self> {
        let identity = plan.identity(&scene)?;
        Ok(Self { scene, plan, identity, shard: Shard::WHOLE, output, resume: false })
    }

    /// The tiles of its shard, in order.
    fn tiles(&self) -> Vec<usize> {
        match self.shard {
            Shard::WHOLE => (0..self.identity.tiling().n_tiles()).collect(),
            shard => shard.tiles(&expected_costs(&self.scene, &self.plan)),
        }
    }

    /// Makes what is missing of the map and writes its results.
    pub fn run(&self, common: &Common) -> Result<Made> {
        let hash = self.identity.hash();
        let header = Header { hash, shard: self.shard, plan: self.identity.clone() };
        let part = self.output.part();
        if self.resume && !part.exists() && self.output.is_finished(&header)? {
            return Ok(Made::Earlier);
        }
        let tiles = self.tiles();
        let log = TileLog::open(&part, &header, tiles.len(), self.resume)?;
        if log.unlocked && !common.quiet {
            output::note(&format!(
                "note: {}: this file system locks no files; see to it that no other run writes \
                 the same output",
                part.display()
            ));
        }
        let is_fresh = log.with_set(|set| set.tiles().next().is_none());
        let start = Instant::now();
        match self.measure(&log, &tiles, common) {
            Ok(()) => {}
            Err(error) if matches!(error.downcast_ref(), Some(StudyError::Cancelled)) => {
                let kept = log.with_set(|set| set.tiles().count());
                output::note(&format!(
                    "interrupted: {kept} of {} tiles are kept in {}; go on with --resume",
                    tiles.len(),
                    part.display()
                ));
                return Ok(Made::Interrupted);
            }
            Err(error) => return Err(error),
        }
        if is_fresh {
            estimate::judge(self, &header, start.elapsed(), common);
        }
        let found = log.with_set(|set| finish::write(set, &header, &self.output))?;
        fs::remove_file(&part).with_context(|| format!("cannot remove {}", part.display()))?;
        Ok(Made::Written(Box::new(found)))
    }

    /// Studies the tiles that the log lacks.
    fn measure(&self, log: &TileLog, tiles: &[usize], common: &Common) -> Result<()> {
        let missing: Vec<usize> =
            log.with_set(|set| tiles.iter().copied().filter(|tile| !set.contains(*tile)).collect());
        let progress = Progress::new("map", self.samples(tiles), common);
        let control = progress.control();
        (control.progress)(self.samples(tiles) - self.samples(&missing));
        let study = MapStudy::new(&self.scene, &self.plan)?;
        let measure_one = |tile: usize| -> Result<()> {
            let spreads = study.tile(self.identity.tiling().tile(tile), control)?;
            log.append(tile, &spreads).context("the tiles so far are kept; go on with --resume")
        };
        for_each(missing.into_iter(), measure_one)
    }

    /// Pixels of some tiles.
    fn pixels(&self, tiles: &[usize]) -> u64 {
        let tiling = self.identity.tiling();
        tiles.iter().map(|tile| tiling.tile(*tile).n_pixels()).sum()
    }

    /// Samples drawn for some tiles.
    fn samples(&self, tiles: &[usize]) -> u64 {
        self.identity.samples_per_pixel().saturating_mul(self.pixels(tiles))
    }
}
