//! Functions of the position in a pixel that a fixed eye makes affine.

use crate::scene::PixelFrame;
use glam::DVec3;

/// c + s·x + t·y over the pixel, (s, t) = (u, v) - 1/2 in [-1/2, 1/2]².
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Affine {
    pub c: f64,
    pub s: f64,
    pub t: f64,
}

impl Affine {
    /// n · D(s, t), for the directions of a pixel.
    pub fn dot(normal: DVec3, centred: &CentredFrame) -> Self {
        Self { c: normal.dot(centred.dc), s: normal.dot(centred.du), t: normal.dot(centred.dv) }
    }

    pub fn at(&self, s: f64, t: f64) -> f64 {
        self.c + self.s * s + self.t * t
    }

    pub fn scaled(self, factor: f64) -> Self {
        Self { c: self.c * factor, s: self.s * factor, t: self.t * factor }
    }

    pub fn plus(self, other: Self) -> Self {
        Self { c: self.c + other.c, s: self.s + other.s, t: self.t + other.t }
    }

    /// Largest absolute coefficient.
    pub fn magnitude(&self) -> f64 {
        self.c.abs().max(self.s.abs()).max(self.t.abs())
    }

    /// Half the width of the values taken on the pixel around `c`.
    pub fn radius(&self) -> f64 {
        0.5 * (self.s.abs() + self.t.abs())
    }
}

/// A pixel's directions about its centre: D(s, t) = dc + s du + t dv.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CentredFrame {
    pub dc: DVec3,
    pub du: DVec3,
    pub dv: DVec3,
}

impl CentredFrame {
    pub fn new(frame: &PixelFrame) -> Self {
        Self { dc: frame.direction(0.5, 0.5), du: frame.du, dv: frame.dv }
    }

    pub fn direction(&self, s: f64, t: f64) -> DVec3 {
        self.dc + self.du * s + self.dv * t
    }

    /// |D|² as c, s, t, ss, st, tt.
    pub fn length_squared(&self) -> Quadratic {
        Quadratic {
            c: self.dc.length_squared(),
            s: 2.0 * self.dc.dot(self.du),
            t: 2.0 * self.dc.dot(self.dv),
            ss: self.du.length_squared(),
            st: 2.0 * self.du.dot(self.dv),
            tt: self.dv.length_squared(),
        }
    }
}

/// c + s·x + t·y + ss·x² + st·xy + tt·y² over the pixel.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Quadratic {
    pub c: f64,
    pub s: f64,
    pub t: f64,
    pub ss: f64,
    pub st: f64,
    pub tt: f64,
}

impl Quadratic {
    pub fn at(&self, s: f64, t: f64) -> f64 {
        self.c + s * (self.s + s * self.ss + t * self.st) + t * (self.t + t * self.tt)
    }

    /// Least and greatest value over the pixel, of a function that is convex.
    pub fn convex_range(&self) -> [f64; 2] {
        let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
        let values = corners.map(|(s, t)| self.at(s, t));
        let [mut least, greatest] = values
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(*x), hi.max(*x)]);
        // Least along the four sides, and where no direction leads down.
        let along = |slope: f64, curvature: f64| {
            if curvature > 0.0 { (-0.5 * slope / curvature).clamp(-0.5, 0.5) } else { 0.0 }
        };
        for side in [-0.5, 0.5] {
            least = least.min(self.at(side, along(self.t + self.st * side, self.tt)));
            least = least.min(self.at(along(self.s + self.st * side, self.ss), side));
        }
        let determinant = 4.0 * self.ss * self.tt - self.st * self.st;
        if determinant > 0.0 {
            let s = (self.st * self.t - 2.0 * self.tt * self.s) / determinant;
            let t = (self.st * self.s - 2.0 * self.ss * self.t) / determinant;
            if s.abs() <= 0.5 && t.abs() <= 0.5 {
                least = least.min(self.at(s, t));
            }
        }
        [least, greatest]
    }

    pub fn is_constant(&self) -> bool {
        [self.s, self.t, self.ss, self.st, self.tt].iter().all(|x| *x == 0.0)
    }

    /// The second-order Taylor polynomial of q^(-1/2), q this quadratic.
    pub fn inverse_root(&self) -> Self {
        let root = self.c.sqrt().recip();
        let x = self.scaled(self.c.recip());
        Self {
            c: 1.0,
            s: -0.5 * x.s,
            t: -0.5 * x.t,
            ss: -0.5 * x.ss + 0.375 * x.s * x.s,
            st: -0.5 * x.st + 0.75 * x.s * x.t,
            tt: -0.5 * x.tt + 0.375 * x.t * x.t,
        }
        .scaled(root)
    }

    /// The product with an affine function, without its third-order terms.
    pub fn times(&self, a: &Affine) -> Self {
        Self {
            c: self.c * a.c,
            s: self.c * a.s + self.s * a.c,
            t: self.c * a.t + self.t * a.c,
            ss: self.ss * a.c + self.s * a.s,
            st: self.st * a.c + self.s * a.t + self.t * a.s,
            tt: self.tt * a.c + self.t * a.t,
        }
    }

    pub fn scaled(self, f: f64) -> Self {
        Self {
            c: self.c * f,
            s: self.s * f,
            t: self.t * f,
            ss: self.ss * f,
            st: self.st * f,
            tt: self.tt * f,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    /// Squares of affine vectors, whose least value lies within the pixel, on its edge or on a
    /// line: against a grid of 201 × 201 positions, which misses the least value by no more than
    /// the curvature times the square of half its spacing.
    #[test]
    fn convex_functions_reach_their_range() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(1996);
        for case in 0..300 {
            let mut vector =
                |size: f64| DVec3::from_array([(); 3].map(|()| rng.random_range(-size..size)));
            let (dc, du) = (vector(0.5), vector(1.0));
            let dv = if case % 3 == 0 { du * 0.5 } else { vector(1.0) };
            let q = CentredFrame { dc, du, dv }.length_squared();
            let grid = (0..201 * 201).map(|i| {
                let at = |i: i32| f64::from(i) / 200.0 - 0.5;
                q.at(at(i % 201), at(i / 201))
            });
            let [lo, hi] =
                grid.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)]);
            let [least, greatest] = q.convex_range();
            let missed = 0.0025f64.powi(2) * (q.ss + q.st.abs() + q.tt);
            assert!((lo - missed..=lo + 1e-12).contains(&least), "{q:?}: {least} {lo}");
            assert!((greatest - hi).abs() < 1e-12, "{q:?}: {greatest} {hi}");
        }
    }
}
