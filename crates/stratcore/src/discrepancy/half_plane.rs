//! What straight lines of one direction cut off the unit square.

/// The unit square as lines of one direction see it: the distribution function of the product
/// normal·x over the square, which is that of a trapezium.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SquareCut {
    normal: [f64; 2],
    /// Least product of the normal with a point of the square.
    least: f64,
    /// The normal's larger and smaller component.
    sides: [f64; 2],
}

impl SquareCut {
    /// For lines with this normal, of any length above 0.
    pub(crate) fn new(normal: [f64; 2]) -> Self {
        let [x, y] = normal;
        let sides = [x.abs().max(y.abs()), x.abs().min(y.abs())];
        Self { normal, least: x.min(0.0) + y.min(0.0), sides }
    }

    /// Area of the square before the line through a point of it: where the product with the
    /// normal is less than the point's.
    pub(crate) fn before(&self, [x, y]: [f64; 2]) -> f64 {
        let [a, b] = self.sides;
        // Rounding may take a corner just outside.
        let t = (self.normal[0] * x + self.normal[1] * y - self.least).max(0.0).min(a + b);
        if t < b {
            t * t / (2.0 * a * b)
        } else if t <= a {
            (t - 0.5 * b) / a
        } else {
            1.0 - (a + b - t) * (a + b - t) / (2.0 * a * b)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_of_known_cuts() {
        for (normal, point, area) in [
            ([1.0, 0.0], [0.3, 0.9], 0.3),
            ([0.0, -2.0], [0.3, 0.9], 0.1),
            ([3.0, 3.0], [0.25, 0.25], 0.125),
            ([1.0, 1.0], [1.0, 0.5], 0.875),
            ([-1.0, 2.0], [0.5, 0.5], 0.5),
            ([1.0, 0.5], [0.0, 1.0], 0.25),
            ([1.0, 1.0], [0.0, 0.0], 0.0),
            ([0.1, 0.7], [1.0, 1.0], 1.0),
        ] {
            let found = SquareCut::new(normal).before(point);
            assert!((found - area).abs() < 1e-15, "{normal:?} {point:?}: {found}");
        }
    }

    #[test]
    fn corners_and_axes_stay_in_range() {
        for i in 0..1000 {
            let (s, c) = (f64::from(i) * 0.1).sin_cos();
            for corner in [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]] {
                for normal in [[s, c], [s, 1e-300], [0.0, c]] {
                    let area = SquareCut::new(normal).before(corner);
                    assert!((0.0..=1.0).contains(&area), "{normal:?} {corner:?}: {area}");
                }
            }
        }
    }
}
