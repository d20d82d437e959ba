//! Maps: the study of every pixel of a region, in tiles that can be stored, split and merged.
//!
//! ```text
//! MapPlan + TracedScene → MapStudy → a tile's moments → TileLog → TileSet → read_tile
//! ```
//!
//! * The unit of work and of storage is a tile: the moments of its pixels' trial means, one per sampler and
//!   count ([`MapStudy::tile`]). Every interval, fit and class is worked out from them again
//!   ([`read_tile`]), so a map that was resumed, or merged from shards, is the map of one run.
//! * [`TileLog`] is the file that finished tiles are added to; [`TileSet`] is any number of such
//!   files that are read as one.
//! * [`Shard`] is an even part of the tiles, by expected cost ([`expected_costs`]).

mod cost;
mod digest;
mod histogram;
mod log;
mod plan;
mod record_error;
mod records;
mod region;
mod set;
mod summary;

pub use cost::{Shard, ShardError, expected_costs};
pub use histogram::Histogram;
pub use log::TileLog;
pub use plan::{Identity, MapPlan, SamplerIdentity};
pub use record_error::{RecordError, RecordFault};
pub use records::{Header, ROW_BYTES};
pub use region::{Region, RegionError, Tiling};
pub use set::TileSet;
pub use summary::{ClassShare, Comparison, Gain, SamplerSummary, Summary, Tally};

use crate::error::StudyError;
use crate::exact;
use crate::integrand::Integrand as _;
use crate::study::{Control, ExactStudy, Reading, collect, measure};
use crate::trace::TracedScene;
use crate::variance::Moments;

/// A plan and its scene, ready to be measured pixel by pixel.
pub struct MapStudy<'a> {
    scene: &'a TracedScene,
    plan: &'a MapPlan,
    /// Of each sampler; all pixels have the same dimensions.
    counts_used: Vec<Vec<u64>>,
    /// Where variances are to be computed without trials.
    exact: Option<ExactStudy<'a>>,
}

impl<'a> MapStudy<'a> {
    /// Makes ready what all pixels share.
    ///
    /// # Errors
    /// What [`StudyPlan::counts_used`](crate::StudyPlan::counts_used) refuses.
    pub fn new(scene: &'a TracedScene, plan: &'a MapPlan) -> Result<Self, StudyError> {
        let exact = plan.exact.then(|| ExactStudy::new(&plan.study, exact::TOLERANCE));
        let dim = scene.pixel([plan.region.x0, plan.region.y0], plan.channel).dim();
        let counts_used = plan.study.counts_used(dim)?;
        Ok(Self { scene, plan, counts_used, exact: exact.transpose()? })
    }

    /// The moments of one pixel's trial means, one per sampler and count, samplers first. All are NaN
    /// where some trial's mean is not finite: one such pixel should not cost the others.
    ///
    /// # Errors
    /// As [`study`](crate::study::study()), but for `NonFinite`.
    pub fn pixel(&self, pixel: [u32; 2], control: Control<'_>) -> Result<Vec<Moments>, StudyError> {
        let plan = &self.plan.study;
        let missing = Moments {
            count: plan.n_trials.into(),
            mean: f64::NAN,
            variance: f64::NAN,
            ..Moments::default()
        };
        let integrand = self.scene.pixel(pixel, self.plan.channel);
        let measured = match &self.exact {
            Some(exact) => exact.measure(&integrand, pixel, control),
            None => measure(&integrand, pixel, plan, &self.counts_used, control),
        };
        match measured {
            Err(StudyError::NonFinite { .. }) => {
                Ok(vec![missing; plan.samplers.len() * plan.counts.len()])
            }
            other => other,
        }
    }

    /// The moments of a tile's pixels, row by row: what is stored of it.
    ///
    /// # Errors
    /// As [`MapStudy::pixel`].
    pub fn tile(&self, tile: Region, control: Control<'_>) -> Result<Vec<Moments>, StudyError> {
        Ok(collect(tile.pixels().collect(), |pixel| self.pixel(pixel, control))?.concat())
    }
}

/// What a map says of one pixel under one sampler.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelReading {
    /// Mean and variance of the mean per count, and their shape.
    pub moments: Vec<Moments>,
    /// Fit and class.
    pub reading: Reading,
}

impl PixelReading {
    /// Whether nothing is known: some trial's mean was not finite.
    pub fn is_missing(&self) -> bool {
        self.moments.iter().any(|moments| moments.variance.is_nan())
    }

    /// Whether its variances were computed without trials.
    pub fn is_computed(&self) -> bool {
        self.moments.iter().all(|moments| moments.count == 0)
    }
}

/// Works out fits and classes from a tile's moments: for each pixel, row by row, one reading per
/// sampler.
pub fn read_tile(identity: &Identity, moments: &[Moments]) -> Vec<Vec<PixelReading>> {
    let n_counts = identity.counts.len();
    let read_sampler = |(sampler, moments): (&SamplerIdentity, &[Moments])| {
        let rows: Vec<_> =
            sampler.counts_used.iter().copied().zip(moments.iter().copied()).collect();
        let reading = Reading::of(&sampler.name, sampler.scramble, identity.dim, &rows);
        PixelReading { moments: moments.to_vec(), reading }
    };
    let read_pixel = |moments: &[Moments]| {
        identity.samplers.iter().zip(moments.chunks_exact(n_counts)).map(read_sampler).collect()
    };
    moments.chunks_exact(identity.rows_per_pixel()).map(read_pixel).collect()
}
