//! What fills a pixel, as convex patches.
//!
//! A pixel starts as one label everywhere and is painted over, patch by patch. Each facet is
//! clipped to the pixel; where another facet is nearer is a convex region (three edges and the
//! sign of the difference of two inverse depths, all affine), and so is each shadow. Taking one
//! convex region after the other out of a convex polygon leaves convex parts.

use super::Unresolved;
use super::polygon::Polygon;
use crate::beam::{Affine, PixelBeam};

/// Patches beyond which a pixel counts as unresolved.
const MAX_PATCHES: usize = 4096;

/// Two inverse depths that differ by less than this share of themselves are told apart by
/// rounding alone.
const LEVEL: f64 = 1e-13;

/// The part of the pixel that is missed by all facets, below which it is rounding.
const NO_GAP: f64 = 1e-12;

/// What is seen somewhere in the pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Label {
    Background,
    /// A facet by its place in the beam's list, in the light or in shadow.
    Facet {
        index: usize,
        lit: bool,
    },
}

/// A convex part of the pixel that is painted over: `from` and `to` are places in the list of
/// labels.
pub(super) struct Patch {
    pub polygon: Polygon,
    pub from: usize,
    pub to: usize,
}

/// A pixel, resolved: `labels[base]` everywhere, then the patches in any order, for they add up.
#[derive(Default)]
pub(super) struct Regions {
    pub labels: Vec<Seen>,
    pub base: usize,
    pub patches: Vec<Patch>,
}

/// A label, the area where it is seen and a box around that.
pub(super) struct Seen {
    pub label: Label,
    pub area: f64,
    pub bounds: [[f64; 2]; 2],
}

/// A facet's outline in the pixel.
struct Outline {
    index: usize,
    polygon: Polygon,
    bounds: [[f64; 2]; 2],
    inverse_depth: [f64; 2],
}

/// Room for lists, kept from pixel to pixel.
#[derive(Default)]
pub(super) struct Room {
    work: Work,
    regions: Regions,
}

pub(super) fn resolve<'a>(
    beam: &PixelBeam,
    Room { work, regions }: &'a mut Room,
) -> Result<&'a Regions, Unresolved> {
    let mut outlines = Vec::with_capacity(beam.facets().len());
    outlines.extend((0..beam.facets().len()).filter_map(|i| outline(beam, i)));
    // Nearer ones first: what is hidden is soon hidden altogether.
    outlines.sort_unstable_by(|a, b| {
        b.inverse_depth[1].total_cmp(&a.inverse_depth[1]).then(a.index.cmp(&b.index))
    });
    let background = Seen { label: Label::Background, area: 1.0, bounds: [[-0.5, 0.5]; 2] };
    regions.labels.clear();
    regions.labels.push(background);
    regions.patches.clear();
    regions.base = 0;
    for outline in &outlines {
        carve(beam, outline, &outlines, work)?;
        regions.paint(beam, outline, work)?;
    }
    let seen: f64 = regions.labels[1..].iter().map(|seen| seen.area).sum();
    regions.labels[0].area = (1.0 - seen).max(0.0);
    if regions.labels[0].area <= NO_GAP {
        let by_area =
            |a: &usize, b: &usize| regions.labels[*a].area.total_cmp(&regions.labels[*b].area);
        regions.base = (1..regions.labels.len()).max_by(by_area).unwrap_or(0);
        regions.labels[0].area = 0.0;
    }
    // What a facet leaves bare shows the base.
    let base = regions.base;
    for patch in &mut regions.patches {
        patch.from = if patch.from == 0 { base } else { patch.from };
        patch.to = if patch.to == 0 { base } else { patch.to };
    }
    regions.patches.retain(|patch| patch.from != patch.to);
    Ok(regions)
}

fn outline(beam: &PixelBeam, index: usize) -> Option<Outline> {
    let facet = &beam.facets()[index];
    let [e0, e1, e2] = facet.edges;
    let w = scaled(facet.inverse_depth)?;
    let polygon = Polygon::pixel().clipped(&[e0, e1, e2, w])?;
    let (bounds, inverse_depth) = (polygon.bounds(), polygon.range(&facet.inverse_depth));
    Some(Outline { index, polygon, bounds, inverse_depth })
}

/// With a largest coefficient of 1, as the cuts of polygons want it.
fn scaled(function: Affine) -> Option<Affine> {
    let magnitude = function.magnitude();
    (magnitude > 0.0).then(|| function.scaled(magnitude.recip()))
}

#[derive(Default)]
struct Work {
    /// What is left of the facet.
    parts: Vec<Polygon>,
    /// What others took out of it.
    taken: Vec<Polygon>,
    next: Vec<Polygon>,
}

impl Work {
    /// Takes a region out of all parts; tells whether it took anything.
    fn take(&mut self, region: &[Affine]) -> Result<bool, Unresolved> {
        if self.parts.iter().all(|part| part.misses(region)) {
            return Ok(false);
        }
        let before = self.taken.len();
        self.next.clear();
        for part in &self.parts {
            part.subtract(region, &mut self.next, &mut self.taken);
        }
        std::mem::swap(&mut self.parts, &mut self.next);
        if self.parts.len() + self.taken.len() > MAX_PATCHES
            || self.taken[before..].iter().chain(&self.parts).any(Polygon::overflows)
        {
            return Err(Unresolved::TooComplex);
        }
        Ok(self.taken.len() > before)
    }
}

/// Leaves in `work.parts` what can be seen of a facet, and in `work.taken` what others hide.
fn carve(
    beam: &PixelBeam,
    outline: &Outline,
    all: &[Outline],
    work: &mut Work,
) -> Result<(), Unresolved> {
    work.taken.clear();
    work.parts.clear();
    work.parts.push(outline.polygon);
    let facet = &beam.facets()[outline.index];
    for other in all {
        let is_behind = other.inverse_depth[1] < outline.inverse_depth[0] * (1.0 - 1e-9);
        if is_behind || work.parts.is_empty() {
            break;
        }
        let apart =
            outline.bounds.iter().zip(&other.bounds).any(|(a, b)| a[1].min(b[1]) <= a[0].max(b[0]));
        if apart || other.index == outline.index {
            continue;
        }
        let nearer = &beam.facets()[other.index];
        let [e0, e1, e2] = nearer.edges;
        let gap = nearer.inverse_depth.plus(facet.inverse_depth.scaled(-1.0));
        let size = nearer.inverse_depth.magnitude().max(facet.inverse_depth.magnitude());
        if gap.magnitude() > LEVEL * size {
            if let Some(gap) = scaled(gap) {
                work.take(&[e0, e1, e2, gap])?;
            }
            continue;
        }
        // At one depth the lower triangle is seen, where it is one depth and not a rounded two.
        let is_tie = gap.magnitude() == 0.0 || look_alike(beam, outline.index, other.index);
        if is_tie {
            if nearer.triangle < facet.triangle {
                work.take(&[e0, e1, e2])?;
            }
        } else if work.take(&[e0, e1, e2])? {
            return Err(Unresolved::EqualDepth([facet.triangle, nearer.triangle]));
        }
    }
    Ok(())
}

/// Whether two facets of one depth have the same radiance, but for rounding.
fn look_alike(beam: &PixelBeam, a: usize, b: usize) -> bool {
    let spots = [(-0.4, -0.3), (0.5, -0.1), (0.1, 0.45)];
    spots.iter().flat_map(|spot| [(spot, true), (spot, false)]).all(|(&(s, t), lit)| {
        let [a, b] = [a, b].map(|facet| beam.facet_radiance(facet, s, t, lit));
        (a - b).abs() <= 1e-12 * a.abs()
    })
}

impl Regions {
    /// Paints what `carve` left of a facet, then its shadows.
    fn paint(
        &mut self,
        beam: &PixelBeam,
        outline: &Outline,
        work: &mut Work,
    ) -> Result<(), Unresolved> {
        if work.parts.is_empty() {
            return Ok(());
        }
        let index = outline.index;
        let area_of = |parts: &[Polygon]| parts.iter().map(Polygon::area).sum::<f64>();
        let visible = area_of(&work.parts);
        let lit = self.labels.len();
        // All of it and what is hidden taken off again, or what is left: whatever has fewer sides.
        let sides_of = |parts: &[Polygon]| parts.iter().map(|part| part.corners().len()).sum();
        let [left, hidden]: [usize; 2] = [sides_of(&work.parts), sides_of(&work.taken)];
        let painted = |polygon| Patch { polygon, from: 0, to: lit };
        if left < outline.polygon.corners().len() + hidden {
            self.patches.extend(work.parts.iter().copied().map(painted));
            work.taken.clear();
        } else {
            self.patches.push(painted(outline.polygon));
            let hidden = work.taken.drain(..).map(|polygon| Patch { polygon, from: lit, to: 0 });
            self.patches.extend(hidden);
        }
        let label = |lit| Label::Facet { index, lit };
        let bounds = outline.bounds;
        self.labels.push(Seen { label: label(true), area: visible, bounds });
        for occluder in beam.occluders_of(index) {
            work.take(occluder.conditions())?;
        }
        if work.parts.is_empty() {
            self.labels[lit].label = label(false);
            work.taken.clear();
        } else if !work.taken.is_empty() {
            let shadow = lit + 1;
            let area = area_of(&work.taken);
            self.labels[lit].area = visible - area;
            self.labels.push(Seen { label: label(false), area, bounds });
            let dark = work.taken.drain(..).map(|polygon| Patch { polygon, from: lit, to: shadow });
            self.patches.extend(dark);
        }
        if self.patches.len() > MAX_PATCHES { Err(Unresolved::TooComplex) } else { Ok(()) }
    }
}
