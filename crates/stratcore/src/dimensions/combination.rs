//! Pictures with each combination of lens, area light and shutter.

use super::choose::{CANDIDATES, Kind, candidates};
use super::draw::Draws;
use super::measure::{PixelTable, Size, measure};
use super::needs::Needs;
use crate::error::StudyError;
use crate::literature::Effort;
use crate::scene::Channel;
use crate::study::Control;
use crate::trace::TracedScene;

/// A scene that needs a combination of features, and what it is called in a report.
#[derive(Debug, Clone, Copy)]
pub struct Combination {
    /// The built-in scene.
    pub scene: &'static str,
    /// Its dimensions d.
    pub dim: usize,
    /// What its pixels integrate over.
    pub features: &'static str,
    /// Names of the figures of its edge and of its smooth pixel.
    pub figures: [&'static str; 2],
}

/// All of them, d = 2 to 7.
pub const COMBINATIONS: &[Combination] = &[
    Combination {
        scene: "room-point",
        dim: 2,
        features: "pixel",
        figures: ["pixel-edge", "pixel-smooth"],
    },
    Combination {
        scene: "room-point-motion",
        dim: 3,
        features: "pixel, time",
        figures: ["time-edge", "time-smooth"],
    },
    Combination {
        scene: "room-point-lens",
        dim: 4,
        features: "pixel, lens",
        figures: ["lens-edge", "lens-smooth"],
    },
    Combination {
        scene: "room",
        dim: 4,
        features: "pixel, light",
        figures: ["light-edge", "light-smooth"],
    },
    Combination {
        scene: "room-point-lens-motion",
        dim: 5,
        features: "pixel, lens, time",
        figures: ["lens-time-edge", "lens-time-smooth"],
    },
    Combination {
        scene: "room-motion",
        dim: 5,
        features: "pixel, light, time",
        figures: ["light-time-edge", "light-time-smooth"],
    },
    Combination {
        scene: "room-lens",
        dim: 6,
        features: "pixel, lens, light",
        figures: ["lens-light-edge", "lens-light-smooth"],
    },
    Combination {
        scene: "room-all",
        dim: 7,
        features: "pixel, lens, light, time",
        figures: ["all-edge", "all-smooth"],
    },
];

impl Combination {
    /// Chooses a pixel of each kind of [`Combination::scene`], where there is one, and measures it
    /// under every family of samplers. The result depends on scene, seed and effort alone.
    ///
    /// # Errors
    /// [`StudyError::Cancelled`] when cancelled.
    pub fn measure(
        &self,
        scene: &TracedScene,
        seed: u64,
        effort: Effort,
        control: Control<'_>,
    ) -> Result<Vec<PixelTable>, StudyError> {
        // Progress is counted in combinations, by the caller.
        let control = Control { progress: &|_| {}, clock: None, ..control };
        let candidates = candidates(scene, seed, control)?;
        let size = Size::of(effort);
        let mut tables = Vec::new();
        for kind in [Kind::Edge, Kind::Smooth] {
            for pixel in candidates(kind).into_iter().take(CANDIDATES) {
                let integrand = scene.pixel(pixel, Channel::Luminance);
                let draws = Draws { integrand: &integrand, seed, pixel, control };
                let needs = Needs::of(&integrand, pixel, seed, size.evaluations, control)?;
                let jumps = needs.discontinuity_dim().is_some();
                if needs.variance.is_there() && jumps == (kind == Kind::Edge) {
                    tables.push(measure(self, kind, draws, needs, &size)?);
                    break;
                }
            }
        }
        Ok(tables)
    }
}
