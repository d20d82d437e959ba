//! Convex polygons within a pixel, and their cuts.

use crate::beam::Affine;

/// Corners that a polygon may have. A triangle clipped to the pixel before the eye has up to
/// eight; further cuts add and remove corners.
const MAX_CORNERS: usize = 16;

/// Distances below this, in pixels, are rounding: a corner as close to a line lies on it.
const ON_LINE: f64 = 1e-14;

/// Areas below this, in pixels, are nothing but rounding.
const NO_AREA: f64 = 1e-15;

/// Corners (s, t), counter-clockwise in axes s to the right and t upwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct Polygon {
    len: usize,
    corners: [[f64; 2]; MAX_CORNERS],
}

/// The two parts of a polygon that a line cuts; none where a part has no area.
pub(super) struct Split {
    pub inside: Option<Polygon>,
    pub outside: Option<Polygon>,
}

impl Polygon {
    const EMPTY: Self = Self { len: 0, corners: [[0.0; 2]; MAX_CORNERS] };

    /// The polygon of these corners.
    pub fn of(corners: &[[f64; 2]]) -> Self {
        let mut polygon = Self::EMPTY;
        corners.iter().for_each(|corner| polygon.push(*corner));
        polygon
    }

    /// The whole pixel.
    pub fn pixel() -> Self {
        Self::of(&[[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
    }

    pub fn corners(&self) -> &[[f64; 2]] {
        &self.corners[..self.len.min(MAX_CORNERS)]
    }

    /// Sides from corner to corner, all around.
    pub fn sides(&self) -> impl Iterator<Item = [[f64; 2]; 2]> {
        let corners = self.corners();
        (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]])
    }

    /// Whether cuts gave it more corners than it can hold; its shape is then wrong.
    pub fn overflows(&self) -> bool {
        self.len > MAX_CORNERS
    }

    pub fn area(&self) -> f64 {
        let corners = self.corners();
        let Some(&[s0, t0]) = corners.first() else { return 0.0 };
        let double: f64 = corners[1..]
            .windows(2)
            .map(|pair| {
                let ([sa, ta], [sb, tb]) = (pair[0], pair[1]);
                (sa - s0) * (tb - t0) - (sb - s0) * (ta - t0)
            })
            .sum();
        0.5 * double
    }

    /// Least and greatest s, least and greatest t.
    pub fn bounds(&self) -> [[f64; 2]; 2] {
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for corner in self.corners() {
            for ([lo, hi], x) in bounds.iter_mut().zip(corner) {
                *lo = lo.min(*x);
                *hi = hi.max(*x);
            }
        }
        bounds
    }

    /// Least and greatest value of a function on the polygon.
    pub fn range(&self, function: &Affine) -> [f64; 2] {
        self.corners().iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], [s, t]| {
            let value = function.at(*s, *t);
            [lo.min(value), hi.max(value)]
        })
    }

    /// Cuts along the zero line of `function`, whose largest coefficient is of the order of 1.
    pub fn split(&self, function: &Affine) -> Split {
        let value = |[s, t]: [f64; 2]| {
            let value = function.at(s, t);
            if value.abs() <= ON_LINE { 0.0 } else { value }
        };
        let (mut inside, mut outside) = (Self::EMPTY, Self::EMPTY);
        let corners = self.corners();
        let Some(&last) = corners.last() else { return Split { inside: None, outside: None } };
        let (mut from, mut from_value) = (last, value(last));
        for &to in corners {
            let to_value = value(to);
            if from_value * to_value < 0.0 {
                let share = from_value / (from_value - to_value);
                let cut = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
                inside.push(cut);
                outside.push(cut);
            }
            if to_value >= 0.0 {
                inside.push(to);
            }
            if to_value <= 0.0 {
                outside.push(to);
            }
            (from, from_value) = (to, to_value);
        }
        let with_area = |part: Self| {
            (part.len >= 3 && (part.overflows() || part.area() > NO_AREA)).then_some(part)
        };
        Split { inside: with_area(inside), outside: with_area(outside) }
    }

    /// Whether a function is nowhere negative: a split would leave nothing outside.
    fn is_inside(&self, function: &Affine) -> bool {
        self.corners().iter().all(|[s, t]| function.at(*s, *t) >= -ON_LINE)
    }

    /// The part where no function is negative.
    pub fn clipped(mut self, functions: &[Affine]) -> Option<Self> {
        for function in functions {
            if !self.is_inside(function) {
                self = self.split(function).inside?;
            }
        }
        Some(self)
    }

    /// Whether some function is nowhere positive: they do not overlap.
    pub fn misses(&self, region: &[Affine]) -> bool {
        region.iter().any(|function| self.range(function)[1] <= ON_LINE)
    }

    /// Takes the convex region where no function is negative out of the polygon: appends what
    /// is left to `rest`, and what was taken, if they overlap, to `taken`.
    pub fn subtract(&self, region: &[Affine], rest: &mut Vec<Self>, taken: &mut Vec<Self>) {
        if self.misses(region) {
            rest.push(*self);
            return;
        }
        let kept = rest.len();
        let mut part = *self;
        for function in region {
            if part.is_inside(function) {
                continue;
            }
            let Split { inside, outside } = part.split(function);
            let Some(inside) = inside else {
                rest.truncate(kept);
                rest.push(*self);
                return;
            };
            rest.extend(outside);
            part = inside;
        }
        taken.push(part);
    }

    fn push(&mut self, corner: [f64; 2]) {
        if let Some(slot) = self.corners.get_mut(self.len) {
            *slot = corner;
        }
        self.len = (self.len + 1).min(MAX_CORNERS + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(c: f64, s: f64, t: f64) -> Affine {
        Affine { c, s, t }
    }

    #[test]
    fn a_cut_keeps_the_area_and_a_line_along_a_side_cuts_nothing() {
        let square = Polygon::pixel();
        assert_eq!(square.area(), 1.0);
        let Split { inside, outside } = square.split(&line(0.1, 1.0, 0.3));
        let (a, b) = (inside.unwrap().area(), outside.unwrap().area());
        assert!((a - 0.6).abs() < 1e-15 && (b - 0.4).abs() < 1e-15, "{a} {b}");
        let Split { inside, outside } = square.split(&line(0.5, 1.0, 0.0));
        assert!(outside.is_none() && inside.unwrap().corners() == square.corners());
    }

    #[test]
    fn subtraction_gives_disjoint_parts_of_the_whole() {
        let triangle = [line(0.2, 1.0, 0.0), line(0.2, 0.0, 1.0), line(0.1, -1.0, -1.0)];
        let (mut rest, mut taken) = (Vec::new(), Vec::new());
        Polygon::pixel().subtract(&triangle, &mut rest, &mut taken);
        let [taken] = taken[..] else { panic!("{} parts", taken.len()) };
        let area: f64 = rest.iter().map(Polygon::area).sum();
        assert!((taken.area() - 0.125).abs() < 1e-15, "{}", taken.area());
        assert!((area + taken.area() - 1.0).abs() < 1e-15);
        assert_eq!(rest.len(), 3);

        rest.clear();
        // Beside the pixel; and a region without inside, which no side of the pixel rejects.
        for region in [[line(-0.6, 1.0, 0.0); 2], [line(-0.2, 1.0, 0.0), line(0.1, -1.0, 0.0)]] {
            let mut taken = Vec::new();
            Polygon::pixel().subtract(&region, &mut rest, &mut taken);
            assert!(taken.is_empty());
        }
        assert!(rest.iter().all(|part| part.area() == 1.0) && rest.len() == 2);
    }

    #[test]
    fn too_many_corners_are_noticed() {
        let mut part = Polygon::pixel();
        let mut angles = (0..40).map(|i| f64::from(i) * 0.157);
        let overflow = angles.any(|angle| {
            part = part.split(&line(0.45, angle.cos(), angle.sin())).inside.unwrap();
            part.overflows()
        });
        assert!(overflow);
    }
}
