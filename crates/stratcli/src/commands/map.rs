//! `map`: how fast every pixel of a picture converges.
//!
//! Finished tiles are kept in a file beside the output, `OUTPUT.part`. When all are there, one
//! pass over them in order writes every result, so that results do not depend on how, when and
//! where the tiles were made.

pub mod csv;
pub mod exr;
pub mod finish;
pub mod overview;
mod shard;
pub mod text;

use super::Outcome;
use crate::cli::{Common, MapArgs};
use crate::output;
use crate::plan;
use crate::progress::Progress;
use anyhow::{Context, Result, ensure};
use finish::{Kind, Output};
use std::fs;
use stratcore::StudyError;
use stratcore::integrand::Integrand as _;
use stratcore::map::{
    Header, Identity, MapPlan, RecordError, Region, Shard, TileLog, expected_costs, measure_tile,
};
use stratcore::scene::Scene;
use stratcore::study::{Control, for_each};
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
    let scene = super::load(&args.scene, common)?;
    let job = Job::new(args, scene, shard, output, common)?;
    job.run(common)
}

impl Job {
    fn new(
        args: &MapArgs,
        scene: Scene,
        shard: Shard,
        output: Output,
        common: &Common,
    ) -> Result<Self> {
        let size = scene.camera.resolution;
        let region = match &args.region {
            Some(text) => text.parse::<Region>().context("--region")?,
            None => Region::whole(size),
        };
        region.check(size).context("--region")?;
        let scene = TracedScene::new(scene).with_tracer(plan::tracer(args.tracer));
        let (channel, _) = plan::channel(args.channel);
        let dim = scene.pixel([region.x0, region.y0], channel).dim();
        let study = plan::study_plan(&args.protocol, common, dim)?;
        let plan = MapPlan { study, region, channel };
        let identity = plan.identity(&scene)?;
        Ok(Self { scene, plan, identity, shard, output, resume: args.resume })
    }

    /// Makes what is missing of the map and writes its results.
    pub fn run(&self, common: &Common) -> Result<Outcome> {
        let header =
            Header { hash: self.identity.hash(), shard: self.shard, plan: self.identity.clone() };
        let part = self.output.part();
        if self.resume && !part.exists() && self.output.is_finished(&header)? {
            if !common.quiet {
                output::note(&format!("{} is finished already", self.output.path.display()));
            }
            return Ok(Outcome::Done);
        }
        let tiles = match self.shard {
            Shard::WHOLE => (0..self.identity.tiling().n_tiles()).collect(),
            shard => shard.tiles(&expected_costs(&self.scene, &self.plan)),
        };
        let log = TileLog::open(&part, &header, tiles.len(), self.resume)?;
        if log.unlocked && !common.quiet {
            output::note(&format!(
                "note: {}: this file system locks no files; see to it that no other run writes \
                 the same output",
                part.display()
            ));
        }
        match self.measure(&log, &tiles, common) {
            Ok(()) => {}
            Err(error) if matches!(error.downcast_ref(), Some(StudyError::Cancelled)) => {
                let kept = log.with_set(|set| set.tiles().count());
                output::note(&format!(
                    "interrupted: {kept} of {} tiles are kept in {}; go on with --resume",
                    tiles.len(),
                    part.display()
                ));
                return Ok(Outcome::Interrupted);
            }
            Err(error) => return Err(error),
        }
        let found = log.with_set(|set| finish::write(set, &header, &self.output, common))?;
        fs::remove_file(&part).with_context(|| format!("cannot remove {}", part.display()))?;
        finish::show(&found, common)?;
        Ok(Outcome::Done)
    }

    /// Studies the tiles that the log lacks.
    fn measure(&self, log: &TileLog, tiles: &[usize], common: &Common) -> Result<()> {
        let missing: Vec<usize> =
            log.with_set(|set| tiles.iter().copied().filter(|tile| !set.contains(*tile)).collect());
        let tiling = self.identity.tiling();
        let pixels = |tiles: &[usize]| -> u64 {
            tiles.iter().map(|tile| tiling.tile(*tile).n_pixels()).sum()
        };
        let per_pixel = self.identity.samples_per_pixel();
        let samples = |tiles: &[usize]| per_pixel.saturating_mul(pixels(tiles));
        let progress = Progress::new("map", samples(tiles), common);
        let control = progress.control();
        (control.progress)(samples(tiles) - samples(&missing));
        for_each(missing.into_iter(), |tile| self.measure_one(log, tile, control))
    }

    fn measure_one(&self, log: &TileLog, tile: usize, control: Control<'_>) -> Result<()> {
        let region = self.identity.tiling().tile(tile);
        let spreads = measure_tile(&self.scene, region, &self.plan, control)?;
        log.append(tile, &spreads).map_err(|error: RecordError| {
            anyhow::Error::new(error).context("the tiles so far are kept; go on with --resume")
        })
    }
}
