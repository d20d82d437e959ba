//! Where the coordinates of points are written.

/// The points of a run: the coordinates of an axis come together.
pub(super) enum Target<'a> {
    /// Row-major, `dim` coordinates to a point.
    Rows { points: &'a mut [f64], dim: usize },
    /// In two dimensions and for the beam: by axis, [`centred`].
    Centred([&'a mut [f32]; 2]),
}

impl Target<'_> {
    /// Points.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Rows { points, dim } => points.len() / dim,
            Self::Centred([s, _]) => s.len(),
        }
    }

    /// Writes coordinate `axis` of the points from number `at` of the run on.
    #[inline(always)]
    pub(super) fn put(&mut self, axis: usize, at: usize, coordinates: impl Iterator<Item = f64>) {
        match self {
            Self::Rows { points, dim } => {
                let points = points[at * *dim..].chunks_exact_mut(*dim);
                for (point, x) in points.zip(coordinates) {
                    point[axis] = x;
                }
            }
            Self::Centred(axes) => {
                for (to, x) in axes[axis][at..].iter_mut().zip(coordinates) {
                    *to = centred(x);
                }
            }
        }
    }
}

/// A coordinate about the middle of its axis, to the precision of the beam.
#[inline(always)]
pub(super) fn centred(x: f64) -> f32 {
    (x - 0.5) as f32
}
