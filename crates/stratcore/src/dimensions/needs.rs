//! Which axes an integrand needs, which of them it jumps along, and which it needs together.
//!
//! f is split into a sum of functions of one axis, of two, and so on, that are uncorrelated
//! (Hoeffding 1948; Efron & Stein 1981). A sampler that stratifies some sets of axes by
//! themselves removes the parts that live in them; the rest is sampled as by random points,
//! which gives padded sets, Latin hypercubes and orthogonal arrays their exponent of 1 and its
//! constant (Stein 1987; Owen 1992).

use super::draw::{Draws, Estimate, Purpose, Scratch};
use crate::error::StudyError;
use crate::integrand::Integrand;
use crate::study::Control;
use serde::Serialize;

/// The most dimensions that are taken apart: each draw is evaluated at all 2^d corners.
pub const MOST_DIMENSIONS: usize = 10;

/// What an integrand needs of its axes, estimated from uniform points of their own.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Needs {
    /// Each axis, in order.
    pub axes: Vec<AxisNeeds>,
    /// Variance of f at one uniform point, σ².
    pub variance: Estimate,
    /// The part of σ² beyond functions of one axis: what a Latin hypercube leaves.
    pub beyond_axes: Estimate,
    /// The part beyond functions of the axes that padded samplers place together, two by two.
    pub beyond_pairs: Estimate,
    /// The part beyond functions of any two axes: what an orthogonal array of strength 2 leaves.
    pub beyond_two: Estimate,
}

/// What is needed of one axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AxisNeeds {
    /// Its name.
    pub name: String,
    /// The part of σ² in all functions that know this axis, over σ²; shares of several axes
    /// overlap.
    pub share: Estimate,
    /// How f behaves along it.
    pub behaviour: Behaviour,
    /// Codimension of what f jumps across along this axis: mean squares of differences within
    /// 1/K of it fall as K^-this from K = 16 to 128. About 1 with jumps, 2 without, 0 where
    /// detail is finer; none for an axis without use, and where jumps were met at K = 16 alone.
    pub codimension: Option<Estimate>,
}

/// How f behaves along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Behaviour {
    /// It does not depend on the axis.
    Unused,
    /// It varies without jumps.
    Smooth,
    /// It jumps.
    Jumps,
    /// It jumps so often that strata of 1/128 do not tell the jumps apart.
    Detail,
}

impl std::fmt::Display for Behaviour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Unused => "unused",
            Self::Smooth => "smooth",
            Self::Jumps => "jumps",
            Self::Detail => "detail",
        })
    }
}

/// Axes that a sampler places together.
pub(super) type Groups = Vec<Vec<usize>>;

/// Two by two, the last by itself where d is odd.
pub(super) fn pairs(dim: usize) -> Groups {
    let axes: Vec<usize> = (0..dim).collect();
    axes.chunks(2).map(<[usize]>::to_vec).collect()
}

/// Each by itself.
pub(super) fn singles(dim: usize) -> Groups {
    (0..dim).map(|axis| vec![axis]).collect()
}

impl Needs {
    /// Estimates what `integrand` needs, from about `evaluations` values for the shares and as
    /// many for the jumps. `pixel` addresses the randomness.
    ///
    /// # Errors
    /// [`StudyError::Cancelled`]; [`StudyError::TooManyAxes`] beyond [`MOST_DIMENSIONS`].
    pub fn of(
        integrand: &dyn Integrand,
        pixel: [u32; 2],
        seed: u64,
        evaluations: u32,
        control: Control<'_>,
    ) -> Result<Self, StudyError> {
        let dim = integrand.dim();
        if dim > MOST_DIMENSIONS {
            return Err(StudyError::TooManyAxes { dim, limit: MOST_DIMENSIONS });
        }
        let draws = Draws { integrand, seed, pixel, control };
        let in_a_pair = |set: u32| pairs(dim).iter().any(|pair| set & !mask(pair) == 0);
        let order = u32::count_ones;
        let sums = Split::new(singles(dim), 4 + dim, |part, set| match part {
            0 => set != 0,
            1 => order(set) >= 2,
            2 => !in_a_pair(set),
            3 => order(set) >= 3,
            _ => set >> (part - 4) & 1 == 1,
        });
        let n = (evaluations >> dim).max(64);
        let parts: [Estimate; 4 + MOST_DIMENSIONS] =
            draws.means(Purpose::Parts, n, 2 * dim, |uniform, scratch| {
                sums.parts(draws, uniform, scratch)
            })?;
        let variance = parts[0];
        let axes = integrand.axes().into_iter().enumerate().map(|(axis, name)| {
            let share = match variance.value {
                // A constant needs nothing.
                0.0 => Estimate { value: 0.0, std_error: 0.0 },
                v => {
                    let Estimate { value, std_error } = parts[4 + axis];
                    let share = value / v;
                    // Both are noisy; that they move together is left out.
                    let std_error = std_error.hypot(share * variance.std_error) / v;
                    Estimate { value: share, std_error }
                }
            };
            let [coarse, fine] = differences_along(draws, axis, evaluations)?;
            let (behaviour, codimension) = behaviour(coarse, fine);
            Ok(AxisNeeds { name, share, behaviour, codimension })
        });
        let axes = axes.collect::<Result<_, StudyError>>()?;
        let [beyond_axes, beyond_pairs, beyond_two] = [parts[1], parts[2], parts[3]];
        Ok(Self { axes, variance, beyond_axes, beyond_pairs, beyond_two })
    }

    /// Dimensions d.
    pub fn dim(&self) -> usize {
        self.axes.len()
    }

    /// Axes along which f jumps: those that the edge depends on.
    pub fn jumping_axes(&self) -> usize {
        let jumps = |behaviour| matches!(behaviour, Behaviour::Jumps | Behaviour::Detail);
        self.axes.iter().filter(|axis| jumps(axis.behaviour)).count()
    }

    /// Whether jumps along any axis are too many for strata of 1/128.
    pub fn has_detail(&self) -> bool {
        self.axes.iter().any(|axis| axis.behaviour == Behaviour::Detail)
    }

    /// Dimension k of the set that f jumps across: d - 1, however few axes the edge depends on,
    /// for it runs along all others; d where detail is everywhere; none without a jump.
    pub fn discontinuity_dim(&self) -> Option<usize> {
        match self.dim() {
            d if self.has_detail() => Some(d),
            d if self.jumping_axes() > 0 => Some(d - 1),
            _ => None,
        }
    }

    /// Whether noise leaves no doubt about [`Needs::discontinuity_dim`]: one axis that surely
    /// jumps decides, and without jumps every axis in use has to be surely smooth.
    pub fn is_sure(&self) -> bool {
        let decides = |axis: &&AxisNeeds| match self.discontinuity_dim() {
            None => axis.behaviour == Behaviour::Smooth,
            Some(k) if k == self.dim() => axis.behaviour == Behaviour::Detail,
            Some(_) => axis.behaviour == Behaviour::Jumps,
        };
        let mut deciding = self.axes.iter().filter(decides).map(AxisNeeds::is_sure);
        match self.discontinuity_dim() {
            None => deciding.all(|sure| sure),
            Some(_) => deciding.any(|sure| sure),
        }
    }
}

/// Strata along an axis between which differences are compared.
const COARSE: f64 = 16.0;
const FINE: f64 = 128.0;

/// Half the mean square of f's differences within one of [`COARSE`] and [`FINE`] strata of an
/// axis.
fn differences_along(
    draws: Draws<'_>,
    axis: usize,
    evaluations: u32,
) -> Result<[Estimate; 2], StudyError> {
    let dim = draws.integrand.dim();
    let n = (evaluations / 3 / dim as u32).max(1024);
    draws.means(Purpose::Along { axis }, n, dim + 1, |uniform, scratch| {
        let (x, other) = uniform.split_at(dim);
        scratch.points.clear();
        scratch.points.extend_from_slice(x);
        for strata in [COARSE, FINE] {
            let from = scratch.points.len();
            scratch.points.extend_from_slice(x);
            scratch.points[from + axis] = ((x[axis] * strata).floor() + other[0]) / strata;
        }
        scratch.eval(draws.integrand);
        let [f, coarse, fine] = [0, 1, 2].map(|i| scratch.values[i]);
        [coarse, fine].map(|g| 0.5 * (g - f).powi(2))
    })
}

fn behaviour(coarse: Estimate, fine: Estimate) -> (Behaviour, Option<Estimate>) {
    if coarse.value == 0.0 && fine.value == 0.0 {
        return (Behaviour::Unused, None);
    }
    if fine.value == 0.0 || coarse.value == 0.0 {
        // A smooth f varies at every scale: these are jumps too rare to be met again.
        return (Behaviour::Jumps, None);
    }
    let span = (FINE / COARSE).ln();
    let value = (coarse.value / fine.value).ln() / span;
    // Both are noisy; that they move together is left out.
    let noise = |e: Estimate| e.std_error / e.value;
    let std_error = noise(coarse).hypot(noise(fine)) / span;
    let behaviour = match value {
        c if is_detail(c) => Behaviour::Detail,
        c if is_smooth(c) => Behaviour::Smooth,
        _ => Behaviour::Jumps,
    };
    (behaviour, Some(Estimate { value, std_error }))
}

impl AxisNeeds {
    /// Whether the codimension's 95 % interval keeps to its side of the half-way marks between
    /// detail (0), jumps (1) and smoothness (2).
    fn is_sure(&self) -> bool {
        let Some(Estimate { value, std_error }) = self.codimension else { return true };
        let [lo, hi] = [value - 1.96 * std_error, value + 1.96 * std_error];
        match self.behaviour {
            Behaviour::Unused => true,
            Behaviour::Detail => hi < 0.5,
            Behaviour::Jumps => lo > 0.5 && hi < 1.5,
            Behaviour::Smooth => lo > 1.5,
        }
    }
}

/// Whether differences hardly fall at all: detail is finer than the strata.
pub(super) fn is_detail(codimension: f64) -> bool {
    codimension < 0.5
}

/// Whether differences fall as those of a smooth f: as the square of the strata. They fall faster
/// only where rare jumps were met among the coarse and not again among the fine.
pub(super) fn is_smooth(codimension: f64) -> bool {
    (1.7..2.3).contains(&codimension)
}

pub(super) fn mask(axes: &[usize]) -> u32 {
    axes.iter().fold(0, |mask, axis| mask | 1 << axis)
}

/// Parts of the variance from values of f at the corners between two independent points, which
/// differ in whole groups of axes.
///
/// With c_v the contrast of the corners that differs along the groups of v, E c_v² is the sum
/// over u ⊇ v of σ_u² / 2^|u|; so σ_u² = 2^|u| Σ over v ⊇ u of (-1)^|v - u| E c_v², which is
/// unbiased and has little noise where the part is small.
pub(super) struct Split {
    /// The group of each axis.
    group_of: Vec<usize>,
    corners: usize,
    /// For each part and each v, what c_v² counts.
    weights: Vec<Vec<f64>>,
}

impl Split {
    /// `is_part(i, u)`: whether the functions of the groups u belong to part i.
    pub fn new(groups: Groups, parts: usize, is_part: impl Fn(usize, u32) -> bool) -> Self {
        let corners = 1 << groups.len();
        let weight = |part: usize, v: u32| {
            let subsets = (1..corners as u32).filter(|u| u & !v == 0 && is_part(part, *u));
            subsets
                .map(|u| {
                    let sign = if (v ^ u).count_ones().is_multiple_of(2) { 1.0 } else { -1.0 };
                    sign * f64::from(1u32 << u.count_ones())
                })
                .sum::<f64>()
        };
        let weights = (0..parts).map(|part| (0..corners as u32).map(|v| weight(part, v)).collect());
        let mut group_of = vec![0; groups.iter().map(Vec::len).sum()];
        for (group, axes) in groups.iter().enumerate() {
            axes.iter().for_each(|axis| group_of[*axis] = group);
        }
        Self { group_of, corners, weights: weights.collect() }
    }

    /// Unbiased for each part, from one pair of points; 0 for parts that there are not.
    pub fn parts<const N: usize>(
        &self,
        draws: Draws<'_>,
        uniform: &[f64],
        scratch: &mut Scratch,
    ) -> [f64; N] {
        let (a, b) = uniform.split_at(self.group_of.len());
        scratch.points.clear();
        for corner in 0..self.corners {
            let from = |(axis, group): (usize, &usize)| {
                if corner >> group & 1 == 0 { a[axis] } else { b[axis] }
            };
            scratch.points.extend(self.group_of.iter().enumerate().map(from));
        }
        scratch.eval(draws.integrand);
        // All contrasts by halves (Yates 1937).
        let values = &mut scratch.values;
        let mut step = 1;
        while step < self.corners {
            for low in (0..self.corners).filter(|corner| corner & step == 0) {
                let (x, y) = (values[low], values[low | step]);
                values[low] = 0.5 * (x + y);
                values[low | step] = 0.5 * (x - y);
            }
            step *= 2;
        }
        std::array::from_fn(|part| {
            let Some(weights) = self.weights.get(part) else { return 0.0 };
            weights.iter().zip(&*values).skip(1).map(|(w, c)| w * c * c).sum()
        })
    }
}
