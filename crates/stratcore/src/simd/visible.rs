//! The nearest of several facets at each of a vector of samples.

use super::shader::{Shader, affine, at};
use super::types::Exact;
use super::vector::{MAX_LANES, Vector};
use super::{Entry, Facet32, Lanes4, Pixel32};

/// A sample's inside test or depth comparison closer than this, in f32 units of functions whose
/// largest coefficient is 1, is settled again in f64. Rounding of three coefficients and two
/// fused steps is below 2.4e-7.
pub(super) const DOUBT: f32 = 4e-7;

/// A facet that may be seen where the samples are.
pub(super) struct Candidate<'a> {
    pub facet: &'a Facet32,
    /// Wholly in shadow there.
    pub shadowed: bool,
    /// Bit e: the samples may lie outside of edge e.
    pub edges: u8,
}

/// All three edges of a facet.
pub(super) const EDGES: u8 = 0b111;

/// A vector of samples, and the nearest facets that they have met.
#[derive(Clone, Copy)]
pub(super) struct Sample<V: Vector> {
    s: V,
    t: V,
    value: V,
    /// 1/t, 0 for the background, and its rounding.
    pub nearest: V,
    nearest_slack: V,
    /// To be settled in f64.
    doubt: V::Mask,
}

impl<V: Vector> Sample<V> {
    /// Samples that see the background.
    #[inline(always)]
    pub fn new(pixel: &Pixel32, [s, t]: [V; 2]) -> Self {
        let zero = V::splat(0.0);
        let value = V::splat(pixel.ground.background.shade[0]);
        Self { s, t, value, nearest: zero, nearest_slack: zero, doubt: V::mask_none() }
    }

    /// Meets the next facet, of which `occluders` may shadow a part, and gives the lanes that
    /// see it. What a lane does depends on its own sample alone. With `OFTEN_HIDDEN` a facet that
    /// no lane sees is not shaded.
    #[inline(always)]
    pub fn meet<S: Shader, const OFTEN_HIDDEN: bool>(
        &mut self,
        pixel: &Pixel32,
        candidate: &Candidate<'_>,
        occluders: impl Iterator<Item = u32>,
    ) -> V::Mask {
        let Self { s, t, .. } = *self;
        let facet = candidate.facet;
        let (zero, limit) = (V::splat(0.0), V::splat(DOUBT));
        // Beyond a needle's tip the plane may come nearer than the facet does, which raises a doubt
        // or not as neighbouring lanes need the facet or not. Capped, it raises none.
        let w = affine(&facet.lanes, 3, s, t).min(V::splat(facet.w_cap));
        let gap = w.sub(self.nearest);
        let slack = V::splat(facet.w_slack);
        let both = slack.add(self.nearest_slack);
        let mut margin = V::splat(f32::INFINITY);
        for which in 0..3 {
            if candidate.edges >> which & 1 != 0 {
                margin = affine(&facet.lanes, which, s, t).min(margin);
            }
        }
        // What is hidden raises no doubt.
        let front = V::mask_and(gap.add(both).ge(zero), margin.ge(V::splat(-DOUBT)));
        let mut unsure = V::mask_and(front, V::mask_or(gap.le(both), margin.le(limit)));
        let wins = V::mask_and(gap.gt(zero), margin.ge(zero));
        if OFTEN_HIDDEN && V::mask_bits(wins) == 0 {
            self.doubt = V::mask_or(self.doubt, unsure);
            return wins;
        }
        let mut lit = V::mask_all();
        if S::SHADOWS {
            if candidate.shadowed {
                lit = V::mask_none();
            }
            for id in occluders {
                let occluder = &pixel.occluders[id as usize];
                let margin = least_of_three(occluder, s, t).min(affine(occluder, 3, s, t));
                lit = V::mask_without(lit, margin.ge(zero));
                let edge = V::mask_and(wins, margin.abs().le(limit));
                unsure = V::mask_or(unsure, edge);
            }
        }
        let shade = S::shade(&pixel.ground, facet, s, t, w, lit);
        self.value = V::select(wins, shade, self.value);
        self.nearest = V::select(wins, w, self.nearest);
        self.nearest_slack = V::select(wins, slack, self.nearest_slack);
        self.doubt = V::mask_or(self.doubt, unsure);
        wins
    }

    /// Whether some lane may see a facet with these edges, no nearer than `w_hi`. Where none
    /// does, [`Self::meet`] does nothing.
    #[inline(always)]
    pub fn may_see(&self, edges: &[[V; 3]; 3], w_hi: V) -> bool {
        let Self { s, t, .. } = *self;
        let [a, b, c] = *edges;
        let margin = at(a, s, t).min(at(b, s, t)).min(at(c, s, t));
        let near = margin.ge(V::splat(-DOUBT));
        V::mask_bits(V::mask_and(near, w_hi.gt(self.horizon()))) != 0
    }

    /// Behind this a lane sees nothing.
    #[inline(always)]
    pub fn horizon(&self) -> V {
        self.nearest.sub(self.nearest_slack)
    }

    /// The values, doubtful ones by f64; the list is complete where the samples are.
    #[inline(always)]
    pub fn settled(&self, list: &[Entry], exact: Exact<'_>) -> V {
        let doubt = V::mask_bits(self.doubt);
        if doubt == 0 {
            return self.value;
        }
        let mut values = self.value.store();
        settle(doubt, list, &mut values, &self.s.store(), &self.t.store(), exact);
        V::load(&values)
    }
}

/// Values of samples that lie anywhere where `list` is complete.
#[inline(always)]
pub(super) fn visible<S: Shader, V: Vector>(
    pixel: &Pixel32,
    list: &[Entry],
    occluders: &[u32],
    s: V,
    t: V,
    exact: Exact<'_>,
) -> V {
    /// Facets that are met whatever stands before them: telling whether they are hidden takes
    /// as long.
    const FEW: usize = 2;
    let mut sample = Sample::new(pixel, [s, t]);
    for (at, entry) in list.iter().enumerate() {
        // No later entry is nearer.
        if at >= FEW && V::mask_bits(V::splat(entry.w_hi).gt(sample.horizon())) == 0 {
            break;
        }
        let facet = &pixel.facets[entry.facet as usize];
        let Entry { shadowed, edges, .. } = *entry;
        let candidate = Candidate { facet, shadowed, edges };
        let ids = &occluders[entry.occluders[0] as usize..entry.occluders[1] as usize];
        sample.meet::<S, false>(pixel, &candidate, ids.iter().copied());
    }
    sample.settled(list, exact)
}

/// Puts the f64 answer in place of each doubtful lane's.
#[cold]
#[inline(never)]
fn settle(
    mut lanes: u32,
    list: &[Entry],
    values: &mut [f32; MAX_LANES],
    s: &[f32; MAX_LANES],
    t: &[f32; MAX_LANES],
    exact: Exact<'_>,
) {
    while lanes != 0 {
        let l = lanes.trailing_zeros() as usize;
        values[l] = exact(list, f64::from(s[l]), f64::from(t[l])) as f32;
        lanes &= lanes - 1;
    }
}

#[inline(always)]
fn least_of_three<V: Vector>(functions: &Lanes4, s: V, t: V) -> V {
    affine(functions, 0, s, t).min(affine(functions, 1, s, t)).min(affine(functions, 2, s, t))
}
