//! The exact curve: a pixel's mean, and the variance of the mean of random and of jittered
//! points at every N, without a random number.
//!
//! Where a pixel's visible polygons can be resolved (`visible`), its radiance is a smooth
//! function on each, a polynomial to within a tolerance (`polynomial`). With f = r + h, r the
//! polynomial of one label over the whole pixel and h what the others differ from it, the
//! variances within the N strata of a grid sum up to
//!
//! Σ vₛ = Σ Vₛ(r) + N ∫ h (h + 2r) - Σ ηₛ (ηₛ + 2ρₛ)
//!
//! with η and ρ the means of h and r in a stratum. The first sum has a closed form (`strata`);
//! the integral is taken once per pixel; only the last sum is walked, along the sides of the
//! patches where h is not zero (`walk`). Then Var(x̄) = Σ vₛ / N² for one point in each stratum,
//! and for N independent points the sum at one stratum over N. METHOD.md, "The exact curve".

mod polygon;
mod polynomial;
mod strata;
mod visible;
mod walk;

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;

use crate::beam::PixelBeam;
use crate::sampler::strata_per_axis;
use polygon::Polygon;
use polynomial::{Fitter, Polynomial};
use serde::{Serialize, Serializer};
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::OnceLock;
use strata::{Axis, VarianceWithin, products};
use visible::{Label, Regions, Room, Seen};
use walk::{Side, Walker};

thread_local! {
    static ROOM: RefCell<Room> = RefCell::default();
}

/// How far a variance may be off, as a share of itself, unless the caller says otherwise.
pub const TOLERANCE: f64 = 1e-5;

/// The exact curve of one pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactCurve {
    /// Mean of f over the pixel.
    pub mean: f64,
    /// Variance of f over the pixel. The mean of N independent points has this over N.
    pub variance: f64,
    /// Variance of the mean of N jittered points, one in each stratum, for each N of the
    /// [`Grids`].
    pub jittered: Vec<f64>,
    /// Estimate of the largest relative error of these variances, from what the polynomials
    /// leave out and from rounding. At most the tolerance asked for.
    pub error: f64,
    /// Convex patches that the pixel was made of; 0 where one function covers it.
    pub patches: usize,
}

/// Why a pixel, or a plan, has no exact curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unresolved {
    /// More convex patches, or more corners in one, than are kept.
    #[error("too many visible polygons in the pixel")]
    TooComplex,
    /// Two triangles of different looks that rounding alone tells apart.
    #[error("triangles {} and {} lie at one depth to rounding, and look different", .0[0], .0[1])]
    EqualDepth([u32; 2]),
    /// No polynomial of the degrees tried is near enough to the radiance, or a variance is so
    /// much smaller than that of its parts that rounding blurs it.
    #[error(
        "a variance might be off by {error:.1e} of itself, more than the {tolerance:.1e} allowed"
    )]
    Imprecise {
        /// Estimate of the relative error.
        error: f64,
        /// What was asked for.
        tolerance: f64,
    },
    /// Grids that have too many strata to sum, one of them or all together.
    #[error(
        "up to N = {n} there are too many strata; grids of up to {} strata an axis, and of {} \
         with all N together, are summed: give fewer N or smaller ones",
        Grids::MAX_PER_AXIS,
        Grids::MAX_STRATA
    )]
    TooManyStrata {
        /// The count that was too much, after those before it.
        n: u64,
    },
    /// A pixel that is traced by rays: smooth shading, a point light right beside a surface, or
    /// `Tracer::Bvh`.
    #[error("the pixel is traced by rays; its polygons are known to the beam alone")]
    Rays,
    /// An area light or a reconstruction filter: the pixel is more than its visible polygons.
    #[error("the pixel has an area light or a filter, and is more than its visible polygons")]
    Weighted,
    /// A sampler other than `random` and `jittered`, or a scramble.
    #[error("only random and jittered points without a scramble have exact variances")]
    Sampler,
    /// Radiance that is not a finite number.
    #[error("the pixel's radiance is not finite")]
    NotFinite,
}

/// As its text.
impl Serialize for Unresolved {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The grids of strata of a list of N, with what every pixel needs of them.
///
/// An N that is no square has the strata that rectangular jittered sampling gives it.
pub struct Grids {
    counts: Vec<u64>,
    /// Strata along the two axes, for each count.
    strata: Vec<[usize; 2]>,
    constant: Tables<1>,
    quadratic: OnceLock<Tables<3>>,
    quartic: OnceLock<Tables<5>>,
    octic: OnceLock<Tables<9>>,
}

impl Grids {
    /// Strata along an axis that are kept in tables.
    pub const MAX_PER_AXIS: u64 = 1 << 12;
    /// Strata of all grids together.
    pub const MAX_STRATA: u64 = 1 << 24;

    /// The grids of these N.
    ///
    /// # Errors
    /// [`Unresolved::TooManyStrata`].
    pub fn new(counts: &[u64]) -> Result<Self, Unresolved> {
        let mut total = 0u64;
        let mut strata = Vec::with_capacity(counts.len());
        for &n in counts {
            total = total.saturating_add(n);
            if n == 0 || total > Self::MAX_STRATA {
                return Err(Unresolved::TooManyStrata { n });
            }
            let along = strata_per_axis(n, 2);
            if along[0] > Self::MAX_PER_AXIS {
                return Err(Unresolved::TooManyStrata { n });
            }
            strata.push([along[0] as usize, along[1] as usize]);
        }
        Ok(Self {
            counts: counts.to_vec(),
            constant: Tables::new(&strata),
            strata,
            quadratic: OnceLock::new(),
            quartic: OnceLock::new(),
            octic: OnceLock::new(),
        })
    }

    /// The N of these grids.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// The exact curve of a pixel, its variances to `tolerance` of themselves.
    ///
    /// # Errors
    /// Any [`Unresolved`] but `TooManyStrata`, `Rays` and `Sampler`.
    pub fn curve(&self, beam: &PixelBeam, tolerance: f64) -> Result<ExactCurve, Unresolved> {
        let curve = ROOM.with_borrow_mut(|room| {
            visible::resolve(beam, room).map(|regions| self.of_regions(beam, regions, tolerance))
        })?;
        let finite = |x: &f64| x.is_finite();
        if ![curve.mean, curve.variance].iter().chain(&curve.jittered).all(finite) {
            return Err(Unresolved::NotFinite);
        }
        if curve.error <= tolerance {
            Ok(curve)
        } else {
            Err(Unresolved::Imprecise { error: curve.error, tolerance })
        }
    }

    /// By polynomials of the least degree that is within the tolerance, or the greatest.
    fn of_regions(&self, beam: &PixelBeam, regions: &Regions, tolerance: f64) -> ExactCurve {
        let is_seen = |seen: &&Seen| seen.area != 0.0;
        if regions.labels.iter().filter(is_seen).all(|seen| is_constant(beam, seen.label)) {
            return self.constant.curve(beam, regions);
        }
        let strata = &self.strata;
        let curve = self.quadratic.get_or_init(|| Tables::new(strata)).curve(beam, regions);
        if curve.error <= tolerance {
            return curve;
        }
        let curve = self.quartic.get_or_init(|| Tables::new(strata)).curve(beam, regions);
        if curve.error <= tolerance {
            return curve;
        }
        self.octic.get_or_init(|| Tables::new(strata)).curve(beam, regions)
    }
}

/// The exact curve of one pixel at these N: [`Grids::curve`] where the grids serve once.
///
/// # Errors
/// Those of [`Grids::new`] and [`Grids::curve`].
pub fn curve(beam: &PixelBeam, counts: &[u64], tolerance: f64) -> Result<ExactCurve, Unresolved> {
    Grids::new(counts)?.curve(beam, tolerance)
}

fn is_constant(beam: &PixelBeam, label: Label) -> bool {
    match label {
        Label::Background => true,
        Label::Facet { index, lit } => !lit || beam.is_constant(index),
    }
}

/// What polynomials of degree D - 1 need of all grids.
struct Tables<const D: usize> {
    fitter: Fitter<D>,
    /// One for each number of strata along an axis; that of one stratum comes first.
    axes: Vec<Axis<D>>,
    /// Of the pixel as one stratum.
    whole: VarianceWithin,
    /// The two axes of each grid, by their places in `axes`.
    grids: Vec<([usize; 2], VarianceWithin)>,
    /// Columns and rows of the largest of them.
    largest: [usize; 2],
}

impl<const D: usize> Tables<D> {
    fn new(strata: &[[usize; 2]]) -> Self {
        let numbers: BTreeSet<usize> = strata.iter().flatten().copied().chain([1]).collect();
        let axes: Vec<_> = numbers.iter().map(|k| Axis::new(*k)).collect();
        let within = |[k, l]: [usize; 2]| VarianceWithin::new(&axes[k], &axes[l]);
        let place = |k: &usize| numbers.range(..k).count();
        let grids = strata.iter().map(|along| {
            let along = along.each_ref().map(place);
            (along, within(along))
        });
        let largest = [0, 1].map(|axis| strata.iter().map(|along| along[axis]).max().unwrap_or(1));
        Self { fitter: Fitter::new(), grids: grids.collect(), whole: within([0; 2]), largest, axes }
    }

    fn curve(&self, beam: &PixelBeam, regions: &Regions) -> ExactCurve {
        /// Rounding of a sum, as a share of its terms.
        const ROUNDING: f64 = 4e-15;
        /// And more for each stratum along an axis: pieces of a side are differences of
        /// integrals along all of it.
        const ROUNDING_OF_PIECES: f64 = 2e-17;
        /// What is nothing but rounding.
        const NOTHING: f64 = 1e-13;
        let fits: Vec<_> = regions
            .labels
            .iter()
            .enumerate()
            .map(|(i, seen)| {
                // The base is spoken of everywhere in the pixel.
                let bounds = if i == regions.base { [[-0.5, 0.5]; 2] } else { seen.bounds };
                self.fit(beam, seen.label, bounds)
            })
            .collect();
        let mut base = fits[regions.base].0;
        let one = self.axes[0].powers(0);
        // Relative to the mean of the base, so that no constant is carried along.
        let middle = (0..D)
            .flat_map(|a| (0..D - a).map(move |b| (a, b)))
            .map(|(a, b)| base.0[a][b] * one[a] * one[b])
            .sum::<f64>();
        base.0[0][0] -= middle;
        let mut sides = Vec::new();
        let mut patches = 0;
        let (mut change, mut squares, mut size) = (0.0, 0.0, 0.0f64);
        for patch in &regions.patches {
            let step = fits[patch.to].0.minus(&fits[patch.from].0);
            if step == Polynomial::ZERO {
                continue;
            }
            patches += 1;
            sides.extend(Side::of(&patch.polygon, &step));
            let mut to = fits[patch.to].0;
            let mut from = fits[patch.from].0;
            to.0[0][0] -= middle;
            from.0[0][0] -= middle;
            let [first, second] = integral(&self.fitter.rule, &patch.polygon, |s, t| {
                let (to, from) = (to.at(s, t), from.at(s, t));
                [to - from, (to - from) * (to + from)]
            });
            change += first;
            squares += second;
            size += second.abs();
        }
        // Least squares of what the polynomials leave out.
        let left_out: f64 =
            regions.labels.iter().zip(&fits).map(|(seen, fit)| seen.area * fit.1 * fit.1).sum();
        let products = products(&base);
        let mut error = 0.0f64;
        let mut within = |[k, l]: [usize; 2], form: &VarianceWithin, walked: f64| {
            let n = k as f64 * l as f64;
            let terms = n * size + walked.abs();
            let rounding = ROUNDING + ROUNDING_OF_PIECES * k.max(l) as f64;
            let sum = form.of(&products) + (n * squares - walked);
            // Constants that fit the grid leave nothing.
            if D == 1 && sum <= NOTHING.max(2.0 * rounding) * terms {
                return 0.0;
            }
            // What is left out is at most about a Legendre polynomial of degree D, whose slope
            // bounds what it varies within a stratum.
            let slope = (D * (D + 1)) as f64 / 12f64.sqrt() / k.min(l) as f64;
            let left_out = n * left_out * slope.powi(2).min(1.0);
            let relative = if sum > 0.0 {
                2.0 * (left_out / sum).sqrt() + rounding * terms / sum
            } else {
                f64::INFINITY
            };
            error = error.max(relative);
            sum
        };
        let variance = within([1, 1], &self.whole, change * change);
        let mut walker = (!sides.is_empty()).then(|| Walker::new(self.largest));
        let jittered = self
            .grids
            .iter()
            .map(|(along, form)| {
                let along = along.map(|at| &self.axes[at]);
                let walked = walker
                    .as_mut()
                    .map_or(0.0, |walker| walker.squared_means(&sides, &base, along));
                let along = along.map(Axis::strata);
                let n = along[0] as f64 * along[1] as f64;
                within(along, form, walked) / (n * n)
            })
            .collect();
        let mean = beam.ground() + (middle + change);
        ExactCurve { mean, variance, jittered, error, patches }
    }

    /// Radiance of a label relative to the beam's ground value, and how far it is off.
    fn fit(&self, beam: &PixelBeam, label: Label, bounds: [[f64; 2]; 2]) -> (Polynomial<D>, f64) {
        /// Boxes are no smaller than this: powers about the pixel's centre hold a polynomial
        /// of a small box badly.
        const SMALLEST: f64 = 0.25;
        let Label::Facet { index, lit } = label else {
            return (Polynomial::constant(beam.background() - beam.ground()), 0.0);
        };
        if is_constant(beam, label) {
            let value = beam.facet_radiance(index, 0.0, 0.0, lit);
            return (Polynomial::constant(value - beam.ground()), 0.0);
        }
        let bounds = bounds.map(|[lo, hi]| {
            let middle = f64::midpoint(lo, hi);
            let half = (0.5 * (hi - lo)).max(0.5 * SMALLEST);
            [middle - half, middle + half]
        });
        self.fitter.fit(bounds, |s, t| beam.facet_radiance(index, s, t, lit) - beam.ground())
    }
}

/// Integrals of a pair of functions over a polygon, exact for polynomials of degree 2(D - 1).
fn integral<const D: usize>(
    rule: &[(f64, f64); D],
    polygon: &Polygon,
    f: impl Fn(f64, f64) -> [f64; 2],
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let Some(&[start, _]) = polygon.corners().first() else { return sums };
    for [from, to] in polygon.sides() {
        let rise = to[1] - from[1];
        if rise == 0.0 {
            continue;
        }
        for (along, weight) in rule {
            let s = from[0] + along * (to[0] - from[0]);
            let t = from[1] + along * rise;
            let width = s - start;
            for (across, share) in rule {
                let values = f(start + across * width, t);
                for (sum, value) in sums.iter_mut().zip(values) {
                    *sum += rise * weight * width * share * value;
                }
            }
        }
    }
    sums
}
