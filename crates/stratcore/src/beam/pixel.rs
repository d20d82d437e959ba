//! One pixel, ready to be sampled.

use crate::beam::affine::{Affine, CentredFrame, Quadratic};
use crate::beam::facet::{Facet, SetUp};
use crate::beam::gather::{Frustum, gather};
use crate::beam::placed;
use crate::beam::shade::{Lit, Shade, coefficients};
use crate::beam::shadow::{Occluder, occluders};
use crate::integrand::Integrand;
use crate::sampler::{Placement, PointSet, Sampler, Scramble};
use crate::scene::{Channel, Distribution, Light, PixelFrame, Scene};
use crate::simd::{
    self, Anywhere, Cells, Columns, DOUBT, Facet32, Ground, Isa, Lanes4, Pixel32, Scattered,
    Shading, Sorted, Strata, Trials, W_SLACK, Work,
};
use crate::trace::Accel;
use std::cell::RefCell;
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

/// Directions may turn by this much across a pixel before a polynomial of second order is off
/// by more than 1e-8 of the radiance.
const NARROW: f64 = 4e-3;

thread_local! {
    /// Room for lists, kept from row to row and from pixel to pixel.
    static WORK: RefCell<(Strata, Work)> = RefCell::default();
    /// The same for samples without strata.
    static SCATTERED: RefCell<Scattered> = RefCell::default();
    /// Room for facets that are not sorted yet.
    static FACETS: RefCell<Vec<Facet>> = RefCell::default();
}

/// A pixel's visible triangles in its own coordinates; the integrand of a study.
pub struct PixelBeam {
    isa: Isa,
    centred: CentredFrame,
    facets: Vec<Facet>,
    shades: Vec<Shade>,
    /// Occluders of all facets; each facet's run is in its [`Facet32`].
    occluders: Vec<Occluder>,
    length_squared: Quadratic,
    background: f64,
    /// The value that the kernels' radiances are relative to.
    ground: f64,
    pixel32: Pixel32,
    /// Made when a sampler first asks for it.
    cells: OnceLock<Cells>,
}

impl PixelBeam {
    /// Gathers and sets up what pixel (x, y) can see of the scene, whose triangles `accel`
    /// holds relative to the eye.
    ///
    /// None for a scene that asks for smooth shading, whose radiance is not affine data, and for
    /// one with a lens, a shutter, mirrors, glass or bounces. None for a pixel that sees a plane
    /// right beside a point light, where f32 would lose the square of its distance. Area lights
    /// are left to [`AreaBeam`](super::AreaBeam).
    pub fn new(scene: &Scene, accel: &Accel, pixel: [u32; 2], channel: Channel) -> Option<Self> {
        Self::of_frame(scene, accel, &scene.camera.pixel(pixel), channel)
    }

    /// The same for any parallelogram of the picture.
    pub fn of_frame(
        scene: &Scene,
        accel: &Accel,
        frame: &PixelFrame,
        channel: Channel,
    ) -> Option<Self> {
        let Distribution { lens, lights: _, motion, specular_depth, bounces } = &scene.distribution;
        let is_seen_from_a_point =
            lens.is_none() && motion.is_none() && *specular_depth == 0 && *bounces == 0;
        if scene.mesh.corner_normals.is_some() || !is_seen_from_a_point {
            return None;
        }
        let centred = CentredFrame::new(frame);
        let isa = Isa::detect();
        let facets = visible_facets(isa, scene, accel, &centred);
        // Far apart in memory: asked for side by side, they arrive together.
        let materials: Vec<u32> =
            facets.iter().map(|facet| scene.mesh.materials[facet.triangle as usize]).collect();
        let shade = |(facet, material): (&Facet, u32)| {
            Shade::new(scene, &scene.materials[material as usize], channel, facet, &centred)
        };
        let shades: Vec<_> = facets.iter().zip(materials).map(shade).collect();
        let background = channel.of(scene.background);
        let length_squared = centred.length_squared();
        // Area lights are reckoned in f64.
        let is_next_to_light = |shade: &Shade| shade.is_next_to_light(length_squared.c);
        if scene.distribution.lights.is_empty() && shades.iter().any(is_next_to_light) {
            return None;
        }
        let ground = match (facets.first(), shades.first()) {
            (Some(facet), Some(shade)) => {
                shade.at(0.0, 0.0, facet.inverse_depth.c, length_squared.c, true)
            }
            _ => background,
        };
        let ground = if ground.is_finite() { ground } else { 0.0 };
        let depth_unit = depth_unit(&facets);
        let shading = match scene.light {
            Light::Headlight => {
                let turn = centred.du.length().max(centred.dv.length()) / length_squared.c.sqrt();
                // A single facet never meets another in a stratum.
                let is_late = facets.len() > 1
                    && (ground as f32).is_finite()
                    && shades.iter().all(|shade| shade.is_factor(depth_unit));
                match (turn < NARROW, is_late) {
                    (false, _) => Shading::WideHeadlight,
                    (true, true) => Shading::Headlight,
                    (true, false) => Shading::Polynomial,
                }
            }
            Light::Off | Light::Directional { .. } => Shading::Directional,
            Light::Point { .. } => Shading::Point,
        };
        // Its kernel subtracts the ground in f32.
        let ground = if shading == Shading::Headlight { f64::from(ground as f32) } else { ground };
        let inverse_root = length_squared.inverse_root();
        let mut all_occluders = Vec::new();
        let mut facets32 = Vec::with_capacity(facets.len());
        for (facet, shade) in facets.iter().zip(&shades) {
            let first = all_occluders.len() as u32;
            if shade.is_lit() {
                occluders(scene, accel.bvh(), facet, &centred, &mut all_occluders);
            }
            let mut out = facet_lanes(facet, depth_unit);
            out.occluders = first..all_occluders.len() as u32;
            shade.write(shading, ground, &inverse_root, depth_unit, &mut out);
            facets32.push(out);
        }
        // Steep ones and needles reach nearer than some before them: the bounds fall only so.
        let mut bound = 0.0;
        for facet in facets32.iter_mut().rev() {
            bound = facet.w_hi.max(bound);
            facet.w_hi = bound;
        }
        let mut seen_behind = Facet32 { is_flat: true, ..Facet32::default() };
        seen_behind.shade[0] = (background - ground) as f32;
        let columns = facets32.chunks(Columns::LEN).map(|some| Columns::of(some.iter())).collect();
        let pixel32 = Pixel32 {
            facets: facets32,
            columns,
            occluders: all_occluders.iter().map(Occluder::lanes).collect(),
            ground: Ground {
                shading,
                background: seen_behind,
                value: ground as f32,
                length_squared: coefficients(&length_squared),
                inverse_length: coefficients(&inverse_root),
            },
        };
        let occluders = all_occluders;
        Some(Self {
            isa,
            centred,
            facets,
            shades,
            occluders,
            length_squared,
            background,
            ground,
            pixel32,
            cells: OnceLock::new(),
        })
    }

    /// The same beam, run by another instruction set.
    #[must_use]
    pub fn with_isa(mut self, isa: Isa) -> Self {
        self.isa = isa;
        self
    }

    /// Triangles that may be seen in the pixel.
    pub fn n_facets(&self) -> usize {
        self.facets.len()
    }

    /// The same triangles, in f64.
    pub(crate) fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// The directions of the pixel.
    pub(super) fn centred(&self) -> &CentredFrame {
        &self.centred
    }

    /// The visible triangle at (u, v) in [0, 1)² and its radiance, in f64 throughout.
    pub fn exact_sample(&self, u: f64, v: f64) -> (Option<u32>, f64) {
        let (s, t) = (u - 0.5, v - 0.5);
        let (winner, value) = self.nearest((0..self.facets.len()).map(|i| i as u32), s, t);
        (winner.map(|(id, _)| self.facets[id as usize].triangle), value)
    }

    /// The nearest of the listed facets at (s, t) with its inverse depth, and its radiance.
    pub(super) fn nearest(
        &self,
        list: impl Iterator<Item = u32>,
        s: f64,
        t: f64,
    ) -> (Option<(u32, f64)>, f64) {
        let mut best: Option<(u32, f64)> = None;
        for id in list {
            if let Some(w) = self.facets[id as usize].hit(s, t) {
                let wins = best.is_none_or(|(other, nearest)| {
                    let triangle = |id: u32| self.facets[id as usize].triangle;
                    w > nearest || w == nearest && triangle(id) < triangle(other)
                });
                if wins {
                    best = Some((id, w));
                }
            }
        }
        let Some((id, w)) = best else { return (None, self.background) };
        let lit = !self.occluders_of(id as usize).iter().any(|occluder| occluder.blocks(s, t));
        let shade = &self.shades[id as usize];
        (Some((id, w)), shade.at(s, t, w, self.length_squared.at(s, t), lit))
    }

    /// Settles what f32 leaves in doubt.
    fn settle(&self, list: &mut dyn Iterator<Item = u32>, s: f64, t: f64) -> f64 {
        self.nearest(list, s, t).1 - self.ground
    }

    /// What may stand between a facet and the light.
    pub(crate) fn occluders_of(&self, facet: usize) -> &[Occluder] {
        let run = self.pixel32.facets[facet].occluders.clone();
        &self.occluders[run.start as usize..run.end as usize]
    }

    /// Radiance of a facet's plane at a position, in the light or out of it.
    pub(crate) fn facet_radiance(&self, facet: usize, s: f64, t: f64, lit: bool) -> f64 {
        let w = self.facets[facet].inverse_depth.at(s, t);
        self.shades[facet].at(s, t, w, self.length_squared.at(s, t), lit)
    }

    /// Whether a facet's radiance is one number in the light and one in shadow.
    pub(crate) fn is_constant(&self, facet: usize) -> bool {
        match self.shades[facet].lit {
            Lit::Constant(_) => true,
            Lit::Headlight { cosine, .. } => cosine.magnitude() == 0.0,
            Lit::Point { factor, .. } => factor == 0.0,
        }
    }

    pub(crate) fn background(&self) -> f64 {
        self.background
    }

    /// A value near those of the pixel.
    pub(crate) fn ground(&self) -> f64 {
        self.ground
    }

    /// Overwrites `values` with those at positions about the centre, less the ground.
    fn values_at(&self, positions: [&[f32]; 2], values: &mut [f32], sorted: &mut Sorted) {
        let settle = |list: &mut dyn Iterator<Item = u32>, s, t| self.settle(list, s, t);
        let (isa, pixel) = (self.isa, &self.pixel32);
        simd::values_at(isa, pixel, self.cells(), positions, values, sorted, &settle);
    }

    fn cells(&self) -> &Cells {
        /// Facets that are tried one after the other at every sample: sorting samples into
        /// cells costs more.
        const FEW: usize = 7;
        self.cells.get_or_init(|| {
            let per_axis = if self.facets.len() <= FEW { 1 } else { 16 };
            simd::cells(self.isa, &self.pixel32, per_axis)
        })
    }
}

impl Integrand for PixelBeam {
    fn dim(&self) -> usize {
        2
    }

    fn axes(&self) -> Vec<String> {
        vec!["pixel_x".into(), "pixel_y".into()]
    }

    fn eval(&self, point: &[f64]) -> f64 {
        self.exact_sample(point[0], point[1]).1
    }

    /// Evaluates at the f32 numbers next to each point's offset from the pixel's centre.
    fn eval_block(&self, points: &[f64], values: &mut [f64]) {
        let axis = |axis: usize| points.chunks_exact(2).map(move |p| (p[axis] - 0.5) as f32);
        let (s, t): (Vec<f32>, Vec<f32>) = (axis(0).collect(), axis(1).collect());
        let mut found = vec![0.0; values.len()];
        SCATTERED.with_borrow_mut(|room| {
            self.values_at([&s, &t], &mut found, &mut room.sorted);
        });
        for (value, found) in values.iter_mut().zip(found) {
            *value = self.ground + f64::from(found);
        }
    }

    fn trial_means(
        &self,
        sampler: &dyn Sampler,
        set: &PointSet,
        first_trial: u32,
        means: &mut [f64],
        cancel: &AtomicBool,
    ) -> bool {
        /// Strata per axis up to which f32 positions leave no mark on the variance.
        const MAX_STRATA: u64 = 4096;
        if means.is_empty() {
            return true;
        }
        if self.facets.is_empty() {
            means.fill(self.background);
            return true;
        }
        let n = set.key.n_samples;
        let placement = match set.scramble {
            Scramble::None => sampler.placement(2),
            _ => Placement::Other,
        };
        let strata = match (placement, sampler.strata(n, 2).as_deref()) {
            (Placement::Strata, Some(&[columns, rows])) if columns.max(rows) <= MAX_STRATA => {
                Some([columns as u32, rows as u32])
            }
            _ => None,
        };
        let (isa, pixel) = (self.isa, &self.pixel32);
        let settle = |list: &mut dyn Iterator<Item = u32>, s, t| self.settle(list, s, t);
        let trials = Trials { key: &set.key, first: first_trial, cancel };
        match (placement, strata, u32::try_from(n)) {
            (Placement::Strata, Some(per_axis), _) => {
                WORK.with_borrow_mut(|(strata, work)| {
                    strata.set(per_axis);
                    simd::strata_sums(isa, pixel, strata, &trials, means, work, &settle);
                });
            }
            (Placement::Independent, _, Ok(n)) => {
                SCATTERED.with_borrow_mut(|room| {
                    let samples = Anywhere { n, cells: self.cells() };
                    simd::scattered_sums(isa, pixel, samples, &trials, means, room, &settle);
                });
            }
            _ => SCATTERED.with_borrow_mut(|room| {
                let evaluate = |positions: [&[f32]; 2], values: &mut [f32], sorted: &mut _| {
                    self.values_at(positions, values, sorted);
                };
                placed::sums(isa, sampler, set, &trials, means, room, evaluate);
            }),
        }
        for mean in means {
            *mean = self.ground + *mean / n as f64;
        }
        true
    }
}

/// Facets of the triangles that are not certainly hidden, nearest first.
fn visible_facets(isa: Isa, scene: &Scene, accel: &Accel, centred: &CentredFrame) -> Vec<Facet> {
    let (mesh, eye) = (&scene.mesh, scene.camera.eye);
    let frustum = &Frustum::new(centred);
    FACETS.with_borrow_mut(|facets| {
        facets.clear();
        let mut horizon = 0.0;
        gather(isa, accel, frustum, |ids| {
            let horizon = &mut horizon;
            simd::run(isa, SetUp { mesh, ids, eye, centred, frustum, horizon, facets });
            (horizon.recip() * (1.0 + 1e-6)) as f32
        });
        // In no way that depends on the tree, whose boxes round with the units of the scene.
        let key = |facet: &Facet, at: u32| {
            // Bits of positive numbers rise with them.
            let farness = u128::from(!facet.nearest.to_bits());
            farness << 64 | u128::from(facet.triangle) << 32 | u128::from(at)
        };
        let is_seen = |facet: &Facet| facet.nearest >= horizon * (1.0 - 1e-9);
        let seen = facets.iter().zip(0..).filter(|(facet, _)| is_seen(facet));
        let mut order: Vec<u128> = seen.map(|(facet, at)| key(facet, at)).collect();
        order.sort_unstable();
        order.into_iter().map(|key| facets[key as u32 as usize]).collect()
    })
}

/// A power of two: in units of it the greatest 1/t of the pixel is 1/8 to 1/4. A plane that lies
/// before the eye in all of the pixel, and nowhere nearer than that, then rounds by less than
/// [`W_SLACK`], and one that a horizon cuts does so down to half of the pixel; and f32 holds the
/// cube of 1/t, whatever the units of the scene. Dividing by it changes no bit of a number. Facets
/// come nearest first.
pub(super) fn depth_unit(facets: &[Facet]) -> f64 {
    let greatest = facets.first().map_or(0.0, |facet| facet.nearest);
    if greatest > 0.0 && greatest.is_finite() { 8.0 * greatest.log2().floor().exp2() } else { 1.0 }
}

pub(super) fn facet_lanes(facet: &Facet, depth_unit: f64) -> Facet32 {
    let mut w = facet.inverse_depth.scaled(depth_unit.recip());
    // Each coefficient rounds by 2^-24 of itself, and so do the two fused steps: in all by less
    // than 2^-22 of c and s and t.
    let rounding = (w.c.abs() + w.s.abs() + w.t.abs()) * 2f64.powi(-22);
    let is_steep = rounding > f64::from(W_SLACK);
    // So that it is never found hidden where it is not.
    let bias = if is_steep { rounding } else { 0.0 };
    w.c += bias;
    let w_slack = if is_steep { (2.0 * rounding) as f32 } else { W_SLACK };
    let anywhere = w.c + 0.5 * (w.s.abs() + w.t.abs());
    let reach = reach(&facet.edges, &w, 2.0 * f64::from(DOUBT)).max(facet.nearest / depth_unit);
    let nearest = reach.min(anywhere) as f32;
    Facet32 {
        lanes: lanes([facet.edges[0], facet.edges[1], facet.edges[2], w]),
        w_bias: bias as f32,
        w_slack,
        is_steep,
        w_hi: nearest + 3.0 * w_slack,
        rows: [facet.rows[0] as f32 - 1e-6, facet.rows[1] as f32 + 1e-6],
        ..Facet32::default()
    }
}

/// Greatest value of a function at the corners of the triangle on whose sides the edges are
/// -`margin`, beyond a needle's tip far from those where they are 0; infinite where two sides are
/// parallel to rounding.
fn reach(edges: &[Affine; 3], f: &Affine, margin: f64) -> f64 {
    /// Edges have a largest coefficient of 1.
    const PARALLEL: f64 = 1e-9;
    let [a, b, c] = edges;
    let at_corner = |p: &Affine, q: &Affine| {
        let area = p.s * q.t - p.t * q.s;
        let (p_c, q_c) = (p.c + margin, q.c + margin);
        let s = (p.t * q_c - q.t * p_c) / area;
        let t = (q.s * p_c - p.s * q_c) / area;
        if area.abs() > PARALLEL { f.at(s, t) } else { f64::INFINITY }
    };
    at_corner(a, b).max(at_corner(b, c)).max(at_corner(c, a))
}

pub(super) fn lanes(functions: [Affine; 4]) -> Lanes4 {
    Lanes4 {
        c: functions.map(|f| f.c as f32),
        s: functions.map(|f| f.s as f32),
        t: functions.map(|f| f.t as f32),
    }
}
