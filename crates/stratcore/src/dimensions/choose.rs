//! Which pixels of a picture are studied: a rule, not a hand.

use super::draw::{Draws, Estimate, Purpose};
use super::needs::{Groups, Split, is_smooth};
use crate::error::StudyError;
use crate::integrand::Integrand as _;
use crate::scene::Channel;
use crate::study::{Control, collect};
use crate::trace::TracedScene;
use serde::Serialize;

/// Pixels per axis of the lattice among which pixels are chosen.
pub const LATTICE: u32 = 16;

/// Candidates of a kind that are taken apart until one is of the kind.
pub(super) const CANDIDATES: usize = 16;

/// What a pixel was chosen for. Of a lattice's pixels the best by this rule:
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Radiance jumps, and the feature that moves it least moves it most.
    Edge,
    /// Radiance does not jump, and of the features that it needs (a share of the variance of at
    /// least 1 %) the one that moves it least moves it most.
    Smooth,
}

impl std::fmt::Display for Kind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Edge => "edge",
            Self::Smooth => "smooth",
        })
    }
}

/// What one look at a pixel finds.
struct Look {
    pixel: [u32; 2],
    /// The variance in all functions of each feature.
    moved: Vec<f64>,
    variance: f64,
    /// Whether f jumps.
    jumps: bool,
}

const MOST_FEATURES: usize = 6;
const SHARE_OF_USE: f64 = 0.01;

/// `side` × `side` pixels, evenly over the picture, row by row.
pub(super) fn lattice(scene: &TracedScene, side: u32) -> Vec<[u32; 2]> {
    let [width, height] = scene.scene().camera.resolution;
    let at = |i: u32, size: u32| (2 * i + 1) * size / (2 * side);
    (0..side)
        .flat_map(|row| (0..side).map(move |column| [at(column, width), at(row, height)]))
        .collect()
}

/// The lattice's pixels that may be of this kind, the best first.
///
/// # Errors
/// [`StudyError::Cancelled`].
pub(super) fn candidates(
    scene: &TracedScene,
    seed: u64,
    control: Control<'_>,
) -> Result<impl Fn(Kind) -> Vec<[u32; 2]> + use<>, StudyError> {
    let looks = collect(lattice(scene, LATTICE), |pixel| look(scene, pixel, seed, control))?;
    Ok(move |kind| {
        let merit = |look: &Look| {
            let used = SHARE_OF_USE * look.variance;
            let counts = |moved: &&f64| kind == Kind::Edge || **moved >= used;
            look.moved.iter().filter(counts).copied().fold(look.variance, f64::min)
        };
        let fits = |look: &&Look| look.variance > 0.0 && look.jumps == (kind == Kind::Edge);
        let mut fit: Vec<&Look> = looks.iter().filter(fits).collect();
        fit.sort_by(|a, b| merit(b).total_cmp(&merit(a)));
        fit.into_iter().map(|look| look.pixel).collect()
    })
}

/// Axes by feature: those whose names have the same first word.
pub(super) fn features(axes: &[String]) -> Vec<(String, Vec<usize>)> {
    let mut features: Vec<(String, Vec<usize>)> = Vec::new();
    for (axis, name) in axes.iter().enumerate() {
        let word = name.split('_').next().unwrap_or(name);
        match features.last_mut().filter(|(feature, _)| feature == word) {
            Some((_, axes)) => axes.push(axis),
            None => features.push((word.to_owned(), vec![axis])),
        }
    }
    features
}

fn look(
    scene: &TracedScene,
    pixel: [u32; 2],
    seed: u64,
    control: Control<'_>,
) -> Result<Look, StudyError> {
    const CORNERS: u32 = 192;
    let integrand = scene.pixel(pixel, Channel::Luminance);
    let draws = Draws { integrand: &integrand, seed, pixel, control };
    let dim = integrand.dim();
    let groups: Groups = features(&integrand.axes()).into_iter().map(|(_, axes)| axes).collect();
    let n_features = groups.len().min(MOST_FEATURES);
    let split =
        Split::new(groups, 1 + n_features, |part, set| part == 0 || set >> (part - 1) & 1 == 1);
    let parts: [Estimate; 1 + MOST_FEATURES] =
        draws.means(Purpose::Features, CORNERS, 2 * dim, |uniform, scratch| {
            split.parts(draws, uniform, scratch)
        })?;
    let moved = parts[1..=n_features].iter().map(|part| part.value).collect();
    let jumps = !codimension(draws, 1024)?.is_some_and(is_smooth);
    Ok(Look { pixel, moved, variance: parts[0].value, jumps })
}

/// How mean squares of differences within strata fall with their number along each axis; none
/// where the finer strata show no difference, so that jumps, if any, are rare.
pub(super) fn codimension(draws: Draws<'_>, pairs: u32) -> Result<Option<f64>, StudyError> {
    const STRATA: [f64; 2] = [8.0, 64.0];
    let dim = draws.integrand.dim();
    let [coarse, fine] = draws.means(Purpose::Glance, pairs, 2 * dim, |uniform, scratch| {
        let (x, u) = uniform.split_at(dim);
        scratch.points.clear();
        scratch.points.extend_from_slice(x);
        for strata in STRATA {
            let within = x.iter().zip(u).map(|(x, u)| ((x * strata).floor() + u) / strata);
            scratch.points.extend(within);
        }
        scratch.eval(draws.integrand);
        [1, 2].map(|i| 0.5 * (scratch.values[i] - scratch.values[0]).powi(2))
    })?;
    let codimension = (coarse.value / fine.value).ln() / (STRATA[1] / STRATA[0]).ln();
    Ok((fine.value > 0.0).then_some(codimension))
}
