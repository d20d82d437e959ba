//! `edges`: a target whose pixels have known convergence.
//!
//! Everything is drawn in pixels of a 256 × 256 picture, on the plane z = 0 seen from
//! (0, 0, 20): one pixel is 1/16 unit, +x is right and +y up. Patterns only emit, so that each
//! side of an edge is a constant; ramps only reflect the headlight. `assets/README.md` lists
//! what lies where.

use super::{Model, icosphere};
use glam::{DAffine3, DQuat, DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::TAU;

const EYE: DVec3 = DVec3::new(0.0, 0.0, 20.0);
const BRIGHT: f64 = 0.8;
const DARK: f64 = 0.1;
/// Where the bars of the axis-parallel edges meet, in pixels of their cell.
const BARS: [f64; 9] = [0.0, 8.5, 16.25, 24.3, 32.707, 40.05, 48.6, 56.9, 64.0];

/// The point behind picture position (x, y), moved from the plane towards the eye: 1 is on the
/// plane, 0.5 half way.
fn behind(p: DVec2, depth: f64) -> DVec3 {
    let on_plane = dvec3((p.x - 128.0) / 16.0, (128.0 - p.y) / 16.0, 0.0);
    EYE + (on_plane - EYE) * depth
}

struct Target {
    model: Model,
    bright: u32,
    dark: u32,
}

/// The target: four rows of four cells, each 64 pixels square.
pub(super) fn model() -> Model {
    let mut model = Model::default();
    let [bright, dark] = [model.emitter("bright", [BRIGHT; 3]), model.emitter("dark", [DARK; 3])];
    let mut target = Target { model, bright, dark };
    let cell = |column: i32, row: i32| dvec2(64.0 * f64::from(column), 64.0 * f64::from(row));
    target.constant(cell(0, 0));
    target.upright_edges(cell(1, 0));
    target.level_edges(cell(2, 0));
    target.turned_edges(cell(3, 0));
    target.fan(cell(0, 1));
    target.rings(cell(1, 1));
    target.lines(cell(2, 1));
    target.checkers(cell(3, 1));
    target.ramp(cell(0, 2), dvec2(128.0, 64.0), [1.3, 0.7, 0.7, 1.3]);
    target.ball(cell(2, 2));
    target.folds(cell(3, 2));
    target.ramp(cell(0, 3), dvec2(256.0, 64.0), [0.6, 0.6, 1.5, 1.5]);
    target.model
}

impl Target {
    /// A polygon on the plane, in picture coordinates.
    fn draw(&mut self, corners: &[DVec2], material: u32) {
        let corners: Vec<_> = corners.iter().map(|p| behind(*p, 1.0)).collect();
        self.model.polygon(&corners, material);
    }

    fn rectangle(&mut self, at: DVec2, size: DVec2, material: u32) {
        self.draw(&box_corners(at, size), material);
    }

    /// One colour all over.
    fn constant(&mut self, at: DVec2) {
        self.rectangle(at, DVec2::splat(64.0), self.bright);
    }

    /// Bars that start and end within pixels.
    fn upright_edges(&mut self, at: DVec2) {
        for (i, pair) in BARS.windows(2).enumerate() {
            let material = if i % 2 == 0 { self.dark } else { self.bright };
            self.rectangle(at + dvec2(pair[0], 0.0), dvec2(pair[1] - pair[0], 64.0), material);
        }
    }

    fn level_edges(&mut self, at: DVec2) {
        for (i, pair) in BARS.windows(2).enumerate() {
            let material = if i % 2 == 0 { self.bright } else { self.dark };
            self.rectangle(at + dvec2(0.0, pair[0]), dvec2(64.0, pair[1] - pair[0]), material);
        }
    }

    /// Sixteen squares of 16 pixels, each cut through its pixel (8, 8) at another angle: square
    /// (i, j) at (4 j + i + 1/2) · 180°/16 against the horizontal.
    fn turned_edges(&mut self, at: DVec2) {
        for number in 0..16 {
            let corner = at + dvec2(f64::from(number % 4), f64::from(number / 4)) * 16.0;
            let angle = (f64::from(number) + 0.5) * TAU / 32.0;
            let normal = dvec2(angle.sin(), angle.cos());
            let square = box_corners(corner, DVec2::splat(16.0));
            let middle = corner + dvec2(8.4, 8.6);
            let [bright, dark] = [self.bright, self.dark];
            self.draw(&half(&square, middle, normal), bright);
            self.draw(&half(&square, middle, -normal), dark);
        }
    }

    /// Thirty-two spokes from the middle of the cell.
    fn fan(&mut self, at: DVec2) {
        let middle = at + 32.0;
        let rim = |i: i32| {
            let (sin, cos) = ((f64::from(i) + 0.25) * TAU / 64.0).sin_cos();
            // The point of the cell's border in this direction.
            middle + dvec2(cos, sin) * (32.0 / cos.abs().max(sin.abs()))
        };
        for i in 0..64 {
            let [a, b] = [rim(i), rim(i + 1)];
            let corner = [dvec2(a.x, b.y), dvec2(b.x, a.y)].map(|p| p - middle);
            let corner = corner.into_iter().find(|p| p.x.abs() == 32.0 && p.y.abs() == 32.0);
            let material = if i % 2 == 0 { self.bright } else { self.dark };
            match corner.filter(|_| a.x != b.x && a.y != b.y) {
                Some(corner) => self.draw(&[middle, a, middle + corner, b], material),
                None => self.draw(&[middle, a, b], material),
            }
        }
    }

    /// Circles of radius 6, 12, 18, 24 and 30 about the middle of the cell, as polygons of 720
    /// sides: the widest is at most 3e-4 pixels off.
    fn rings(&mut self, at: DVec2) {
        const SIDES: i32 = 720;
        let middle = at + 32.0;
        let on_circle = |radius: f64, i: i32| {
            let (sin, cos) = (f64::from(i) * TAU / f64::from(SIDES)).sin_cos();
            middle + dvec2(cos, sin) * radius
        };
        let on_border = |i: i32| {
            let p = on_circle(1.0, i) - middle;
            middle + p * (32.0 / p.abs().max_element())
        };
        for i in 0..SIDES {
            for ring in 0..5 {
                let material = if ring % 2 == 0 { self.bright } else { self.dark };
                let [inner, outer] = [6.0 * f64::from(ring), 6.0 * f64::from(ring + 1)];
                let out = [on_circle(outer, i), on_circle(outer, i + 1)];
                if ring == 0 {
                    self.draw(&[middle, out[0], out[1]], material);
                } else {
                    let inside = [on_circle(inner, i + 1), on_circle(inner, i)];
                    self.draw(&[inside[1], out[0], out[1], inside[0]], material);
                }
            }
            let rest = [on_circle(30.0, i), on_border(i), on_border(i + 1), on_circle(30.0, i + 1)];
            self.draw(&rest, self.dark);
        }
    }

    /// Eight lines that leave the lower left corner of the cell, 0.05 to 0.8 pixels wide.
    fn lines(&mut self, at: DVec2) {
        let foot = at + dvec2(2.0, 62.0);
        for i in 0..8 {
            let angle = (f64::from(i) + 0.5) * TAU / 32.0;
            let along = dvec2(angle.cos(), -angle.sin());
            let across = along.perp() * (0.05 * 2f64.powf(f64::from(i) * 4.0 / 7.0) / 2.0);
            let [near, far] = [foot + along * 10.0, foot + along * 58.0];
            let quad = [near - across, near + across, far + across, far - across];
            let corners = quad.map(|p| behind(p, 0.999));
            self.model.polygon(&corners, self.bright);
        }
        self.rectangle(at, DVec2::splat(64.0), self.dark);
    }

    /// Four checkerboards of 32 × 32 pixels, with this many squares to a pixel's side.
    fn checkers(&mut self, at: DVec2) {
        for (number, per_pixel) in (0u8..).zip([0.37f64, 1.3, 3.1, 6.3]) {
            let corner = at + dvec2(f64::from(number % 2), f64::from(number / 2)) * 32.0;
            let side = 1.0 / per_pixel;
            let squares = (32.0 / side).ceil() as i32;
            let line = |i: i32| (f64::from(i) * side).min(32.0);
            for j in 0..squares {
                for i in 0..squares {
                    let material = if (i + j) % 2 == 0 { self.bright } else { self.dark };
                    let square = dvec2(line(i + 1) - line(i), line(j + 1) - line(j));
                    self.rectangle(corner + dvec2(line(i), line(j)), square, material);
                }
            }
        }
    }

    /// A flat panel that fills a rectangle of the picture and leans: its corners lie at these
    /// depths, clockwise from the top left.
    fn ramp(&mut self, at: DVec2, size: DVec2, depths: [f64; 4]) {
        let white = self.model.material("white", [0.9; 3]);
        let outline = box_corners(at, size);
        let corners: Vec<_> =
            outline.iter().zip(depths).map(|(p, depth)| behind(*p, depth)).collect();
        self.model.polygon(&corners, white);
    }

    /// A ball of 28 pixels' radius in the plane, before a dark ground that lies behind it.
    fn ball(&mut self, at: DVec2) {
        let white = self.model.material("ball", [0.9; 3]);
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::splat(28.0 / 16.0),
            DQuat::IDENTITY,
            behind(at + 32.0, 1.0),
        );
        self.model.add(&icosphere(6), place, white);
        let ground = box_corners(at, DVec2::splat(64.0)).map(|p| behind(p, 1.2));
        self.model.polygon(&ground, self.dark);
    }

    /// A paper folded eight times: radiance is continuous across a fold, its slope is not, and
    /// every other fold is also a step.
    fn folds(&mut self, at: DVec2) {
        let paper = self.model.material("paper", [0.9; 3]);
        let depth = |i: i32| if i % 2 == 0 { 1.0 } else { 1.06 };
        for i in 0..8 {
            let left = 8.0 * f64::from(i) + if i == 0 { 0.0 } else { 0.4 };
            let right = if i == 7 { 64.0 } else { 8.0 * f64::from(i + 1) + 0.4 };
            let strip = box_corners(at + dvec2(left, 0.0), dvec2(right - left, 64.0));
            let depths = [depth(i), depth(i + 1), depth(i + 1), depth(i)];
            let corners: Vec<_> =
                strip.iter().zip(depths).map(|(p, depth)| behind(*p, depth)).collect();
            self.model.polygon(&corners, paper);
        }
    }
}

/// Corners clockwise from the top left.
fn box_corners(at: DVec2, size: DVec2) -> [DVec2; 4] {
    [at, at + dvec2(size.x, 0.0), at + size, at + dvec2(0.0, size.y)]
}

/// The part of a convex polygon on the side of a line that `normal` points to.
fn half(polygon: &[DVec2], through: DVec2, normal: DVec2) -> Vec<DVec2> {
    let side = |p: DVec2| (p - through).dot(normal);
    let mut kept = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let next = polygon[(i + 1) % polygon.len()];
        if side(p) >= 0.0 {
            kept.push(p);
        }
        if (side(p) > 0.0 && side(next) < 0.0) || (side(p) < 0.0 && side(next) > 0.0) {
            kept.push(p.lerp(next, side(p) / (side(p) - side(next))));
        }
    }
    kept
}
