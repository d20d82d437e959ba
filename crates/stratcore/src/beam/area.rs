//! A pixel lit by area lights: d grows, but what the eye sees and what can stand before a light
//! are still short lists that are found once.

use crate::beam::facet::Facet;
use crate::beam::pixel::PixelBeam;
use crate::beam::shadow::between;
use crate::integrand::Integrand;
use crate::scene::{Channel, Rgb, SHORT_OF_THE_LIGHT};
use crate::trace::{Ray, TracedScene};
use std::sync::OnceLock;

/// The integral over a pixel's square and a point on each area light.
///
/// Everything is reckoned in f64, sample by sample: the nearest facet of the cell that the
/// sample falls into, and for each light the triangles in the shaft between that facet's part of
/// the pixel and the light.
pub struct AreaBeam<'a> {
    scene: &'a TracedScene,
    beam: PixelBeam,
    channel: Channel,
    /// For each facet and then each light, what may stand between them; found when it is first
    /// asked for.
    between: Vec<OnceLock<Vec<u32>>>,
    grid: Grid,
}

impl<'a> AreaBeam<'a> {
    pub(crate) fn new(scene: &'a TracedScene, beam: PixelBeam, channel: Channel) -> Self {
        let n_lights = scene.scene().distribution.lights.len();
        let between = (0..beam.n_facets() * n_lights).map(|_| OnceLock::new()).collect();
        let grid = Grid::new(beam.facets());
        Self { scene, beam, channel, between, grid }
    }

    /// Triangles that may be seen in the pixel.
    pub fn n_facets(&self) -> usize {
        self.beam.n_facets()
    }

    /// Irradiance over π on a facet at a position of the pixel, by one point on each light.
    fn irradiance(&self, id: u32, w: f64, [s, t]: [f64; 2], lights: &[f64]) -> Rgb {
        let scene = self.scene.scene();
        let facet = &self.beam.facets()[id as usize];
        let point = scene.camera.eye + self.beam.centred().direction(s, t) / w;
        let all = &scene.distribution.lights;
        scene.distribution.irradiance(point, lights, |number, to_light| {
            let cosine = facet.normal.dot(to_light) / to_light.length();
            if cosine <= 0.0 {
                return 0.0;
            }
            let between = self.between[id as usize * all.len() + number].get_or_init(|| {
                let ends = all[number].bounds().map(|p| p - scene.camera.eye);
                between(scene, self.scene.accel().bvh(), facet, self.beam.centred(), ends)
            });
            let ray = Ray { origin: point, direction: to_light };
            let is_dark = between.iter().any(|id| {
                ray.meets(scene.mesh.corners(*id as usize))
                    .is_some_and(|crossing| crossing.inverse_t * SHORT_OF_THE_LIGHT > 1.0)
            });
            if is_dark { 0.0 } else { cosine }
        })
    }
}

impl Integrand for AreaBeam<'_> {
    fn dim(&self) -> usize {
        2 + 2 * self.scene.scene().distribution.lights.len()
    }

    fn axes(&self) -> Vec<String> {
        self.scene.scene().distribution.axes()
    }

    fn eval(&self, point: &[f64]) -> f64 {
        let [s, t] = [point[0] - 0.5, point[1] - 0.5];
        let (seen, value) = self.beam.nearest(self.grid.at(s, t).iter().copied(), s, t);
        let Some((id, w)) = seen else { return value };
        let scene = self.scene.scene();
        let triangle = self.beam.facets()[id as usize].triangle;
        let kd = scene.materials[scene.mesh.materials[triangle as usize] as usize].kd;
        let irradiance = self.irradiance(id, w, [s, t], &point[2..]);
        value + self.channel.of(std::array::from_fn(|i| kd[i] * irradiance[i]))
    }
}

/// Facets by where in the pixel they may be seen.
struct Grid {
    per_axis: usize,
    cells: Vec<Vec<u32>>,
}

impl Grid {
    fn new(facets: &[Facet]) -> Self {
        /// Facets that are tried one after the other at every sample: finding a cell costs more.
        const FEW: usize = 4;
        const PER_AXIS: usize = 16;
        let per_axis = if facets.len() <= FEW { 1 } else { PER_AXIS };
        let half = 0.5 / per_axis as f64;
        let middle = |cell: usize| (2 * cell + 1) as f64 * half - 0.5;
        let may_be_seen = |facet: &Facet, s: f64, t: f64| {
            facet.edges.iter().chain([&facet.inverse_depth]).all(|f| {
                let slack = 1e-9 * f.magnitude();
                f.at(s, t) + half * (f.s.abs() + f.t.abs()) >= -slack
            })
        };
        let cells = (0..per_axis * per_axis).map(|cell| {
            let [s, t] = [middle(cell % per_axis), middle(cell / per_axis)];
            (0..)
                .zip(facets)
                .filter(|(_, facet)| may_be_seen(facet, s, t))
                .map(|(id, _)| id)
                .collect()
        });
        Self { per_axis, cells: cells.collect() }
    }

    fn at(&self, s: f64, t: f64) -> &[u32] {
        let along = |x: f64| (((x + 0.5) * self.per_axis as f64) as usize).min(self.per_axis - 1);
        &self.cells[along(t) * self.per_axis + along(s)]
    }
}
