//! Which classes of pixel a picture has, and which way their samples take.

use super::choose::codimension;
use super::choose::lattice;
use super::draw::Draws;
use super::needs::is_smooth;
use crate::error::StudyError;
use crate::integrand::Integrand as _;
use crate::scene::Channel;
use crate::study::{Control, collect};
use crate::theory::Class;
use crate::trace::{Path, TracedScene};

/// Pixels per axis that a survey looks at.
pub const SURVEYED: u32 = 8;

/// Classes of pixel by differences of radiance within strata, with their paths and how many of
/// [`SURVEYED`]² pixels take each; in the order of classes. A cheap look, not a measurement of p:
/// what no pair of points met is not seen.
///
/// # Errors
/// [`StudyError::Cancelled`].
pub fn survey(
    scene: &TracedScene,
    seed: u64,
    control: Control<'_>,
) -> Result<Vec<(Class, Path, u32)>, StudyError> {
    const PAIRS: u32 = 512;
    let seen = collect(lattice(scene, SURVEYED), |pixel| {
        let integrand = scene.pixel(pixel, Channel::Luminance);
        let draws = Draws { integrand: &integrand, seed, pixel, control };
        let dim = integrand.dim();
        let [spread] = draws.means(4, PAIRS, 2 * dim, |uniform, scratch| {
            scratch.points.clear();
            scratch.points.extend_from_slice(uniform);
            scratch.eval(&integrand);
            [(scratch.values[0] - scratch.values[1]).powi(2)]
        })?;
        let class = match codimension(draws, PAIRS)? {
            _ if spread.value == 0.0 => Class::Exact,
            None => Class::Edge,
            Some(codimension) if codimension < 0.5 => Class::Complex,
            Some(codimension) if is_smooth(codimension) => Class::Smooth,
            Some(_) => Class::Edge,
        };
        Ok::<_, StudyError>((class, integrand.path()))
    })?;
    let mut counts = std::collections::BTreeMap::new();
    for found in seen {
        *counts.entry(found).or_insert(0) += 1;
    }
    Ok(counts.into_iter().map(|((class, path), pixels)| (class, path, pixels)).collect())
}
