//! Where the coordinates of points are written.

use super::Points;
use crate::rng::Stream;
use crate::simd::Isa;

/// Points that are made axis by axis, wherever their coordinates go.
pub(super) trait ByAxis {
    /// Coordinates of a point.
    fn dim(&self) -> usize;
    /// Writes points `first ..`, as many as the target holds.
    fn write(&self, isa: Isa, first: u64, target: &mut Target<'_>);
    /// [`Points::renew`].
    fn renew_axes(&mut self, stream: &Stream) -> bool;
}

impl<P: ByAxis> Points for P {
    fn fill_with(&self, isa: Isa, first: u64, points: &mut [f64]) {
        self.write(isa, first, &mut Target::Rows { points, dim: self.dim() });
    }
    fn fill_centred(&self, isa: Isa, first: u64, columns: [&mut [f32]; 2]) {
        self.write(isa, first, &mut Target::Centred(columns));
    }
    fn renew(&mut self, stream: &Stream) -> bool {
        self.renew_axes(stream)
    }
}

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
