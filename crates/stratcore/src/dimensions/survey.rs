//! Which classes of pixel a picture has, and which route their samples take.

use super::choose::codimension;
use super::choose::lattice;
use super::draw::{Draws, Purpose};
use super::needs::{is_detail, is_smooth};
use crate::error::StudyError;
use crate::integrand::Integrand as _;
use crate::scene::Channel;
use crate::study::{Control, collect};
use crate::theory::Class;
use crate::trace::{Route, TracedScene};

/// Pixels per axis that a survey looks at.
pub const SURVEYED: u32 = 8;

/// Classes of pixel by differences of radiance within strata, with their routes and how many of
/// [`SURVEYED`]² pixels take each; in the order of classes. A cheap look, not a measurement of p:
/// what no pair of points met is not seen.
///
/// # Errors
/// [`StudyError::Cancelled`].
pub fn survey(
    scene: &TracedScene,
    seed: u64,
    control: Control<'_>,
) -> Result<Vec<(Class, Route, u32)>, StudyError> {
    const PAIRS: u32 = 512;
    let seen = collect(lattice(scene, SURVEYED), |pixel| {
        let integrand = scene.pixel(pixel, Channel::Luminance);
        let draws = Draws { integrand: &integrand, seed, pixel, control };
        let dim = integrand.dim();
        let [spread] = draws.means(Purpose::Spread, PAIRS, 2 * dim, |uniform, scratch| {
            scratch.points.clear();
            scratch.points.extend_from_slice(uniform);
            scratch.eval(&integrand);
            [(scratch.values[0] - scratch.values[1]).powi(2)]
        })?;
        let class = match codimension(draws, PAIRS)? {
            _ if spread.value == 0.0 => Class::Exact,
            None => Class::Edge,
            Some(codimension) if is_detail(codimension) => Class::Complex,
            Some(codimension) if is_smooth(codimension) => Class::Smooth,
            Some(_) => Class::Edge,
        };
        Ok::<_, StudyError>((class, integrand.route()))
    })?;
    let mut counts = std::collections::BTreeMap::new();
    for found in seen {
        *counts.entry(found).or_insert(0) += 1;
    }
    Ok(counts.into_iter().map(|((class, route), pixels)| (class, route, pixels)).collect())
}
