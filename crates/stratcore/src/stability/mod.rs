//! Numerical extremes, each measured: what f32 and f64 do there, how far this program is from a
//! reference of higher precision, and the floor below which no number means anything.
//!
//! A [`Family`] of extremes gives [`Row`]s and [`Figure`]s. A row has one quantity, an error:
//! that of plain f32 arithmetic (or of the beam, where a pixel is traced), that of plain f64,
//! and that of the program's own way, which has to stay within a limit that the arithmetic
//! sets. References are sums without rounding, whole numbers, closed forms, or
//! double-double arithmetic on the same samples, so that sampling noise cancels
//! and rounding alone is left.

mod accumulation;
mod dimensions;
mod geometry;
mod numbers;
mod positions;
mod row;
mod scene;
mod statistics;
mod studio;
mod watertight;

pub use row::{Row, Verdict};

use crate::error::StudyError;
use crate::literature::{Effort, Figure};
use crate::rng::StreamKey;
use crate::study::Control;
use serde::Serialize;
use std::sync::atomic::Ordering;

/// Extremes of one kind.
pub struct Family {
    /// As typed and as the page's anchor: "positions".
    pub name: &'static str,
    /// Heading.
    pub title: &'static str,
    /// What a user may rely on, and why.
    pub advice: &'static str,
    measure: fn(&mut Bench<'_>) -> Result<(), StudyError>,
}

/// A family that was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// Name of the family.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What a user may rely on, and why.
    pub advice: &'static str,
    /// At least one.
    pub rows: Vec<Row>,
    /// Errors as curves, with their floors.
    pub figures: Vec<Figure>,
}

/// Every family, in the order of the table.
pub const FAMILIES: &[Family] = &[
    positions::FAMILY,
    accumulation::FAMILY,
    scene::FAMILY,
    geometry::FAMILY,
    statistics::FAMILY,
    dimensions::FAMILY,
];

/// Number of the streams that place things. No sampler has it.
const PLACEMENT: u8 = 255;

/// The family of this name; none if there is no such.
pub fn by_name(name: &str) -> Option<&'static Family> {
    FAMILIES.iter().find(|family| family.name == name)
}

impl Family {
    /// Measures it. The result depends on the seed and the effort alone.
    ///
    /// # Errors
    /// [`StudyError::Cancelled`].
    pub fn measure(
        &self,
        seed: u64,
        effort: Effort,
        control: Control<'_>,
    ) -> Result<Measured, StudyError> {
        let control = Control { progress: &|_| {}, clock: None, ..control };
        let mut bench = Bench { seed, effort, control, rows: Vec::new(), figures: Vec::new() };
        (self.measure)(&mut bench)?;
        bench.check()?;
        let Bench { rows, figures, .. } = bench;
        Ok(Measured { name: self.name, title: self.title, advice: self.advice, rows, figures })
    }
}

/// What a family measures with.
struct Bench<'a> {
    seed: u64,
    effort: Effort,
    control: Control<'a>,
    rows: Vec<Row>,
    figures: Vec<Figure>,
}

impl Bench<'_> {
    fn push(&mut self, row: Row) {
        self.rows.push(row);
    }

    fn draw(&mut self, figure: Figure) {
        self.figures.push(figure);
    }

    /// One of two sizes.
    fn either<T>(&self, quick: T, full: T) -> T {
        match self.effort {
            Effort::Quick => quick,
            Effort::Full => full,
        }
    }

    /// Names a set of N points; `column` tells apart what a family draws.
    fn key(&self, sampler: u8, column: u32, n_samples: u64) -> StreamKey {
        StreamKey { seed: self.seed, pixel: [column, 0], sampler, n_samples, trial: 0 }
    }

    /// # Errors
    /// [`StudyError::Cancelled`] once the caller asked to stop.
    fn check(&self) -> Result<(), StudyError> {
        match self.control.cancel.load(Ordering::Relaxed) {
            true => Err(StudyError::Cancelled),
            false => Ok(()),
        }
    }
}
