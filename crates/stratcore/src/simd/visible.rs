//! The nearest of several facets at each of a vector of samples.

use super::shader::{Shader, affine, at, coefficients};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::{Lanes4, Pixel32};

/// A sample's inside test or depth comparison closer than this is settled again in f64. Edges
/// have a largest coefficient of 1: rounding of three coefficients and two fused steps is below
/// 2.4e-7. Depths have a unit in which two of them round by no more together, or a facet is
/// [steep](Facet32::margin_cap).
pub(crate) const DOUBT: f32 = 4e-7;

/// Rounding of 1/t anywhere in the pixel, in that unit.
pub(crate) const W_SLACK: f32 = 0.5 * DOUBT;

/// A facet that may be seen where the samples are.
#[derive(Clone)]
pub(super) struct Candidate<O> {
    pub facet: u32,
    /// Neither it nor any later one is nearer than this.
    pub w_hi: f32,
    /// Wholly in shadow there.
    pub shadowed: bool,
    /// Bit e: the samples may lie outside of edge e.
    pub edges: u8,
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

/// Samples meet the next facet. What a lane does depends on its own sample alone.
#[inline(always)]
fn meet<S: Shader, V: Vector, const K: usize>(
    samples: &mut [Sample<V>; K],
    pixel: &Pixel32,
    candidate: &Candidate<impl Iterator<Item = u32> + Clone>,
) {
    let facet = &pixel.facets[candidate.facet as usize];
    let mut margins = [V::splat(facet.margin_cap); K];
    for which in 0..3 {
        if candidate.edges >> which & 1 != 0 {
            let edge = coefficients(&facet.lanes, which);
            for (margin, sample) in margins.iter_mut().zip(&*samples) {
                *margin = at(edge, sample.s, sample.t).min(*margin);
            }
        }
    }
    let inverse_depth = coefficients(&facet.lanes, 3);
    for (sample, margin) in samples.iter_mut().zip(margins) {
        let Sample { s, t, .. } = *sample;
        // Beyond a needle's tip the plane may come nearer than the facet does, which raises a
        // doubt or not as neighbouring lanes need the facet or not. Capped, it raises none.
        let w = at(inverse_depth, s, t).min(V::splat(facet.w_cap));
        // Positive where the facet is hit and nearest, and near 0 where either is in doubt: what
        // is hidden, or not hit, raises none.
        let clearance = w.sub(sample.nearest).min(margin);
        sample.closest = clearance.abs().min(sample.closest);
        let wins = clearance.gt(V::splat(0.0));
        let mut lit = V::mask_all();
        if S::SHADOWS {
            if candidate.shadowed {
                lit = V::mask_none();
            }
            for id in candidate.occluders.clone() {
                let occluder = &pixel.occluders[id as usize];
                let margin = least_of_three(occluder, s, t).min(affine(occluder, 3, s, t));
                lit = V::mask_without(lit, margin.ge(V::splat(0.0)));
                let edge = V::select(wins, margin.abs(), V::splat(f32::INFINITY));
                sample.closest = edge.min(sample.closest);
            }
        }
        let value = if S::LATE {
            V::splat(facet.shade_gain[0])
        } else {
            S::shade(&pixel.ground, facet, s, t, w, lit)
        };
        sample.value = V::select(wins, value, sample.value);
        sample.nearest = V::select(wins, w, sample.nearest);
    }
}

/// Samples meet all facets of a list.
#[inline(always)]
pub(super) fn meet_all<S: Shader, V: Vector, const K: usize>(
    samples: &mut [Sample<V>; K],
    pixel: &Pixel32,
    list: impl Iterator<Item = Candidate<impl Iterator<Item = u32> + Clone>>,
) {
    // In registers from the first to the last.
    let mut here = *samples;
    for candidate in list {
        meet::<S, V, K>(&mut here, pixel, &candidate);
    }
    *samples = here;
}

impl<V: Vector> Sample<V> {
    /// Samples that see the background.
    #[inline(always)]
    pub fn new(pixel: &Pixel32, [s, t]: [V; 2]) -> Self {
        let value = V::splat(pixel.ground.background.shade[0]);
        Self { s, t, value, nearest: V::splat(0.0), closest: V::splat(f32::INFINITY) }
    }

    /// Behind this a lane sees nothing.
    #[inline(always)]
    pub fn horizon(&self) -> V {
        self.nearest.sub(V::splat(W_SLACK))
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
    const FEW: usize = 2;
    let mut samples = [Sample::new(pixel, [V::splat(0.0); 2]); K];
    for (sample, place) in samples.iter_mut().zip(places) {
        *sample = Sample::new(pixel, place);
    }
    for (at, candidate) in list.clone().enumerate() {
        if at >= FEW {
            let mut horizon = samples[0].horizon();
            for sample in &samples[1..] {
                horizon = sample.horizon().min(horizon);
            }
            // No later one is nearer.
            if V::mask_bits(V::splat(candidate.w_hi).gt(horizon)) == 0 {
                break;
            }
        }
        meet::<S, V, K>(&mut samples, pixel, &candidate);
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
