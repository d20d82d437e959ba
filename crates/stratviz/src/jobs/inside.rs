//! The inside of a pixel, and the points of one trial.

use super::{Job, RightOfWay, Wake};
use std::sync::Arc;
use stratcore::integrand::Integrand as _;
use stratcore::rng::StreamKey;
use stratcore::sampler::{CountPolicy, PointSet, Scramble, count_used};
use stratcore::scene::Channel;
use stratcore::study::{Control, Inside, SamplerChoice, inside};
use stratcore::trace::TracedScene;

/// Rays along each side of a magnified pixel.
const SIDE: u32 = 320;

/// The pixel and the trial whose points are wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct PointsAsked {
    /// The pixel.
    pub pixel: [u32; 2],
    /// The number whose variance is shared out among strata.
    pub channel: Channel,
    /// Sampler with its scramble, as on the command line.
    pub sampler: String,
    /// N, snapped to the nearest that the sampler has.
    pub n: u64,
    /// Which of the M trials.
    pub trial: u32,
    /// Seed of all randomness.
    pub seed: u64,
}

/// What a look into a pixel shows.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The magnified pixel.
    pub inside: Arc<Inside>,
    /// What was asked for.
    pub asked: PointsAsked,
    /// N as used.
    pub n_used: u64,
    /// The first two coordinates of each point, in [0, 1)².
    pub points: Vec<[f64; 2]>,
    /// Strata across and down, where the sampler has a grid of them.
    pub strata: Option<[u64; 2]>,
    /// The variance shares of these strata.
    pub shares: Vec<f64>,
}

impl Seen {
    /// Whether this is the inside of the pixel that is asked for.
    pub fn shows(&self, asked: &PointsAsked) -> bool {
        self.asked.pixel == asked.pixel && self.asked.channel == asked.channel
    }
}

/// Sends what is seen, or what is wrong.
pub type InsideJob = Job<Result<Seen, String>>;

/// Looks into a pixel; `known` is its inside if that was seen already.
pub fn look(
    traced: &Arc<TracedScene>,
    asked: PointsAsked,
    known: Option<Arc<Inside>>,
    way: RightOfWay,
    wake: Wake,
) -> InsideJob {
    let traced = traced.clone();
    Job::spawn("inside", wake, move |reporter| {
        let control = Control { cancel: reporter.cancel(), ..Control::unwatched() };
        let magnified = match known {
            Some(known) => Ok(known),
            None => {
                way.give_first(reporter);
                inside(&traced, asked.pixel, asked.channel, SIDE, control).map(Arc::new)
            }
        };
        let seen = magnified.map_err(|error| error.to_string()).and_then(|inside| {
            let (n_used, points, strata) =
                points(&asked, traced.pixel(asked.pixel, asked.channel).dim())?;
            let shares = strata.map_or_else(Vec::new, |strata| inside.variance_shares(strata));
            Ok(Seen { inside, asked, n_used, points, strata, shares })
        });
        if !reporter.is_cancelled() {
            reporter.send(seen);
        }
    })
}

type Points = (u64, Vec<[f64; 2]>, Option<[u64; 2]>);

/// The points that this trial of a study draws.
fn points(asked: &PointsAsked, dim: usize) -> Result<Points, String> {
    let words = |error: stratcore::StudyError| error.to_string();
    let choice = SamplerChoice::named(&asked.sampler).map_err(words)?;
    let PointsAsked { pixel, seed, trial, .. } = *asked;
    let n = count_used(choice.sampler, asked.n, dim, CountPolicy::Snap).map_err(words)?;
    let key = StreamKey { seed, pixel, sampler: choice.sampler.stream_id(), n_samples: n, trial };
    key.check().map_err(words)?;
    let set = PointSet { key, dim, scramble: choice.scramble, rectangular: false };
    let mut coordinates = vec![0.0; n as usize * dim];
    choice.sampler.points(&set).fill(0, &mut coordinates);
    let points = coordinates.chunks_exact(dim).map(|p| [p[0], p[dim.min(2) - 1]]).collect();
    // A shift takes the points out of their strata.
    let strata = match choice.sampler.strata(n, dim) {
        Some(strata) if dim >= 2 && choice.scramble == Scramble::None => {
            Some([strata[0], strata[1]])
        }
        _ => None,
    };
    Ok((n, points, strata))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(sampler: &str, n: u64) -> PointsAsked {
        let (pixel, channel) = ([5, 6], Channel::Luminance);
        let sampler = sampler.to_owned();
        PointsAsked { pixel, channel, sampler, n, trial: 3, seed: 1996 }
    }

    #[test]
    fn jittered_points_fill_their_strata() {
        let (n, points, strata) = points(&asked("jittered", 17), 2).unwrap();
        assert_eq!((n, points.len(), strata), (16, 16, Some([4, 4])));
        let mut cells: Vec<_> = points.iter().map(|p| p.map(|x| (x * 4.0) as u32)).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells.len(), 16);
    }

    #[test]
    fn samplers_without_strata_have_no_grid_and_unknown_ones_are_named() {
        assert_eq!(points(&asked("random", 9), 2).unwrap().2, None);
        assert_eq!(points(&asked("jittered+torus-shift", 9), 2).unwrap().2, None);
        assert!(points(&asked("jitered", 9), 2).unwrap_err().contains("jitered"));
    }
}
