//! Means of functions of uniform coordinates, with their standard errors.

use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::rng::StreamKey;
use crate::sampler::{PointSet, Random, Sampler, Scramble};
use crate::study::{Control, collect};
use serde::Serialize;
use std::sync::atomic::Ordering;

/// A number and its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

impl Estimate {
    /// Whether noise alone is unlikely to have made it: above 0 by 4 standard errors, which a
    /// normal 0 is once in 30,000 times.
    pub fn is_there(self) -> bool {
        self.value > 4.0 * self.std_error && self.value > 0.0
    }
}

/// Draws of one pixel: addressed apart from all samplers', and from one another by purpose.
#[derive(Clone, Copy)]
pub(super) struct Draws<'a> {
    pub integrand: &'a dyn Integrand,
    pub seed: u64,
    pub pixel: [u32; 2],
    pub control: Control<'a>,
}

/// Number of these streams. No sampler has it.
const STREAM: u8 = 254;

/// What draws are for. Each has addresses of its own: no number is used for two questions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// The parts of the variance, of a pixel that is studied.
    Parts,
    /// The parts that each feature moves, while pixels are chosen.
    Features,
    /// How differences fall with the strata, at a glance.
    Glance,
    /// Whether a pixel varies at all.
    Spread,
    /// Differences along one axis.
    Along {
        /// The axis.
        axis: usize,
    },
    /// Differences within cells of the axes of a mask, so many strata along each.
    Within {
        /// A bit for each axis.
        axes: u32,
        /// Strata along each.
        strata: u64,
    },
}

impl Purpose {
    /// Below 2^5 the first four, then the axes; the cells from 2^32 on.
    fn address(self) -> u64 {
        match self {
            Self::Parts => 1,
            Self::Features => 2,
            Self::Glance => 3,
            Self::Spread => 4,
            Self::Along { axis } => 16 + axis as u64,
            Self::Within { axes, strata } => 1 << 32 | u64::from(axes) << 20 | strata & 0xf_ffff,
        }
    }
}

/// Draws that one task makes.
const BLOCK: u32 = 128;

/// Room for the points of a draw and their values.
#[derive(Default)]
pub(super) struct Scratch {
    pub points: Vec<f64>,
    pub values: Vec<f64>,
}

impl Scratch {
    /// Evaluates what lies in `points`.
    pub fn eval(&mut self, integrand: &dyn Integrand) {
        self.values.resize(self.points.len() / integrand.dim(), 0.0);
        integrand.eval_block(&self.points, &mut self.values);
    }
}

impl Draws<'_> {
    /// Means over `n` draws of the `N` numbers that `statistic` makes of `coordinates` uniform
    /// ones. Two calls of one purpose see the same draws.
    pub fn means<const N: usize>(
        self,
        purpose: Purpose,
        n: u32,
        coordinates: usize,
        statistic: impl Fn(&[f64], &mut Scratch) -> [f64; N] + Sync,
    ) -> Result<[Estimate; N], StudyError> {
        let Self { seed, pixel, control, .. } = self;
        let n_samples = purpose.address();
        let key = StreamKey { seed, pixel, sampler: STREAM, n_samples, trial: 0 };
        key.check()?;
        let scramble = Scramble::None;
        let set = PointSet { key, dim: coordinates, scramble, rectangular: false };
        let blocks = (0..n).step_by(BLOCK as usize).collect();
        let sums = collect(blocks, |first: u32| {
            if control.cancel.load(Ordering::Relaxed) {
                return Err(StudyError::Cancelled);
            }
            let len = BLOCK.min(n - first) as usize;
            let mut uniform = vec![0.0; len * coordinates];
            Random.points(&set).fill(first.into(), &mut uniform);
            let (mut scratch, mut sums) = (Scratch::default(), [[0.0; 2]; N]);
            let mut evaluated = 0;
            for draw in uniform.chunks_exact(coordinates) {
                for (sum, value) in sums.iter_mut().zip(statistic(draw, &mut scratch)) {
                    *sum = [sum[0] + value, sum[1] + value * value];
                }
                evaluated += scratch.values.len() as u64;
            }
            (control.progress)(evaluated);
            Ok(sums)
        })?;
        let n = f64::from(n);
        Ok(std::array::from_fn(|i| {
            let [sum, squares] =
                sums.iter().fold([0.0; 2], |[a, b], block| [a + block[i][0], b + block[i][1]]);
            let value = sum / n;
            let spread = (squares / n - value * value).max(0.0);
            Estimate { value, std_error: (spread / n).sqrt() }
        }))
    }
}
