//! The nearest of several facets at each of a vector of samples.

use super::shader::{Shader, affine, at, coefficients};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::{Facet32, Lanes4, Pixel32};

/// A sample's inside test or depth comparison closer than this is settled again in f64. Edges
/// have a largest coefficient of 1: rounding of three coefficients and two fused steps is below
/// 2.4e-7. Depths have a unit in which two of them round by no more together, or a facet is
/// [steep](Facet32::is_steep).
pub(crate) const DOUBT: f32 = 4e-7;

/// Rounding of 1/t anywhere in the pixel, in that unit.
pub(crate) const W_SLACK: f32 = 0.5 * DOUBT;

/// A facet that may be seen where the samples are.
pub(super) struct Candidate<O> {
    pub facet: u32,
    /// Neither it nor any later one is nearer than this.
    pub w_hi: f32,
    /// Bit e: the samples may lie outside of edge e.
    pub edges: u8,
    pub shadow: Shadow<O>,
}

/// What shadow lies on a facet.
pub(super) struct Shadow<O> {
    /// All of it does.
    pub is_whole: bool,
    /// What may shadow a part of it.
    pub occluders: O,
}

/// All three edges of a facet.
pub(super) const EDGES: u8 = 0b111;

/// A vector of samples, and the nearest facets that they have met.
#[derive(Clone, Copy)]
pub(super) struct Sample<V: Vector> {
    s: V,
    t: V,
    /// Radiance, or the factor of a shader that comes late.
    value: V,
    /// 1/t, 0 for the background.
    pub nearest: V,
    /// How close the closest decision was.
    closest: V,
}

/// Samples meet the next facet, whose edges among `edges` they may lie outside of. What a lane
/// does depends on its own sample alone.
#[inline(always)]
fn meet<S: Shader, V: Vector, const K: usize>(
    samples: &mut [Sample<V>; K],
    pixel: &Pixel32,
    facet: &Facet32,
    edges: u8,
    shadow: &Shadow<impl Iterator<Item = u32> + Clone>,
) {
    let inverse_depth = coefficients(&facet.lanes, 3);
    let mut depths = [V::splat(0.0); K];
    // Positive where the facet is hit and nearest, and near 0 where either is in doubt: what is
    // hidden, or not hit, raises none.
    let mut clearances = [V::splat(0.0); K];
    for ((w, clearance), sample) in depths.iter_mut().zip(&mut clearances).zip(&*samples) {
        *w = at(inverse_depth, sample.s, sample.t);
        *clearance = w.sub(sample.nearest);
    }
    if facet.is_steep {
        for ((w, clearance), sample) in depths.iter_mut().zip(&mut clearances).zip(&*samples) {
            // Where coefficients leave the range of f32 it is no number, which this makes one.
            *w = w.min(V::splat(facet.w_hi));
            *clearance = w.sub(sample.nearest).min(V::splat(0.5 * DOUBT));
        }
    }
    for which in 0..3 {
        if edges >> which & 1 != 0 {
            let edge = coefficients(&facet.lanes, which);
            for (clearance, sample) in clearances.iter_mut().zip(&*samples) {
                *clearance = at(edge, sample.s, sample.t).min(*clearance);
            }
        }
    }
    for ((w, clearance), sample) in depths.into_iter().zip(clearances).zip(samples) {
        let Sample { s, t, .. } = *sample;
        sample.closest = clearance.abs().min(sample.closest);
        let mut lit = V::mask_all();
        if S::SHADOWS {
            if shadow.is_whole {
                lit = V::mask_none();
            }
            for id in shadow.occluders.clone() {
                let occluder = &pixel.occluders[id as usize];
                let margin = least_of_three(occluder, s, t).min(affine(occluder, 3, s, t));
                lit = V::mask_without(lit, margin.ge(V::splat(0.0)));
                let edge = V::select_negative(clearance, V::splat(f32::INFINITY), margin.abs());
                sample.closest = edge.min(sample.closest);
            }
        }
        let value = if S::LATE {
            V::splat(facet.shade_gain[0])
        } else {
            S::shade(&pixel.ground, facet, s, t, w, lit)
        };
        sample.value = V::select_negative(clearance, sample.value, value);
        sample.nearest = V::select_negative(clearance, sample.nearest, w);
    }
}

/// Vectors of samples, one after the other, meet the next facet, wherever its edges are: where
/// they are many, what is read of the facet stays in registers, and they come and go.
#[inline(always)]
pub(super) fn meet_each<S: Shader, V: Vector>(
    samples: &mut [Sample<V>],
    pixel: &Pixel32,
    facet: &Facet32,
    shadow: &Shadow<impl Iterator<Item = u32> + Clone>,
) {
    for sample in samples {
        let mut here = [*sample];
        meet::<S, V, 1>(&mut here, pixel, facet, EDGES, shadow);
        [*sample] = here;
    }
}

/// 1/t of the farthest that several vectors of samples see, lane by lane.
#[inline(always)]
pub(super) fn farthest<V: Vector>(samples: &[Sample<V>]) -> V {
    let mut farthest = V::splat(f32::INFINITY);
    for sample in samples {
        farthest = sample.nearest.min(farthest);
    }
    farthest
}

impl<V: Vector> Sample<V> {
    /// Samples that see the background.
    #[inline(always)]
    pub fn new(pixel: &Pixel32, [s, t]: [V; 2]) -> Self {
        let value = V::splat(pixel.ground.background.shade[0]);
        Self { s, t, value, nearest: V::splat(0.0), closest: V::splat(f32::INFINITY) }
    }

    /// The values, doubtful ones by f64; the list is complete where the samples are.
    #[inline(always)]
    pub fn settled<S: Shader>(
        &self,
        pixel: &Pixel32,
        list: impl Iterator<Item = u32> + Clone,
        exact: Exact<'_>,
    ) -> V {
        let value = S::late(&pixel.ground, self.value, [self.s, self.t], self.nearest);
        let doubt = V::mask_bits(self.closest.le(V::splat(DOUBT)));
        if doubt == 0 {
            return value;
        }
        let mut values = value.store();
        let places = [self.s.store(), self.t.store()];
        settle(doubt, list, &mut values, &places, exact);
        V::load(&values)
    }
}

/// Values of K vectors of samples that lie anywhere where `list` is complete.
#[inline(always)]
pub(super) fn visible<S: Shader, V: Vector, const K: usize>(
    pixel: &Pixel32,
    list: impl Iterator<Item = Candidate<impl Iterator<Item = u32> + Clone>> + Clone,
    places: [[V; 2]; K],
    exact: Exact<'_>,
) -> [V; K] {
    /// Facets that are met whatever stands before them: telling whether they are hidden takes
    /// as long.
    const FEW: usize = 4;
    let mut samples = [Sample::new(pixel, [V::splat(0.0); 2]); K];
    for (sample, place) in samples.iter_mut().zip(places) {
        *sample = Sample::new(pixel, place);
    }
    for (at, candidate) in list.clone().enumerate() {
        if at >= FEW {
            // No later one is nearer.
            let bound = V::splat(candidate.w_hi + W_SLACK);
            if V::mask_bits(bound.ge(farthest(&samples))) == 0 {
                break;
            }
        }
        let facet = &pixel.facets[candidate.facet as usize];
        meet::<S, V, K>(&mut samples, pixel, facet, candidate.edges, &candidate.shadow);
    }
    let list = list.map(|candidate| candidate.facet);
    let mut values = [V::splat(0.0); K];
    for (value, sample) in values.iter_mut().zip(&samples) {
        *value = sample.settled::<S>(pixel, list.clone(), exact);
    }
    values
}

/// Puts the f64 answer in place of each doubtful lane's.
#[cold]
#[inline(never)]
fn settle(
    mut lanes: u32,
    list: impl Iterator<Item = u32> + Clone,
    values: &mut [f32; MAX_LANES],
    [s, t]: &[[f32; MAX_LANES]; 2],
    exact: Exact<'_>,
) {
    while lanes != 0 {
        let l = lanes.trailing_zeros() as usize;
        values[l] = exact(&mut list.clone(), f64::from(s[l]), f64::from(t[l])) as f32;
        lanes &= lanes - 1;
    }
}

#[inline(always)]
fn least_of_three<V: Vector>(functions: &Lanes4, s: V, t: V) -> V {
    affine(functions, 0, s, t).min(affine(functions, 1, s, t)).min(affine(functions, 2, s, t))
}
