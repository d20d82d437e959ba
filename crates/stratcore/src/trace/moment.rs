//! Where the triangles are while a sample is taken.

use crate::scene::Mesh;
use glam::DVec3;

/// A moment of the shutter's time. A type and not a number, so that a scene in which nothing
/// moves is traced by code that knows of no time.
pub(crate) trait Moment: Copy {
    /// The corners of triangle `id` at this moment.
    fn corners(self, mesh: &Mesh, id: usize) -> [DVec3; 3];
}

/// Nothing moves.
#[derive(Clone, Copy)]
pub(crate) struct Still;

impl Moment for Still {
    #[inline(always)]
    fn corners(self, mesh: &Mesh, id: usize) -> [DVec3; 3] {
        mesh.corners(id)
    }
}

/// A share of the shutter's time in [0, 1).
#[derive(Clone, Copy)]
pub(crate) struct At<'a> {
    /// Displacement of each vertex over the shutter's time.
    pub vertices: &'a [DVec3],
    /// The share.
    pub time: f64,
}

impl Moment for At<'_> {
    #[inline(always)]
    fn corners(self, mesh: &Mesh, id: usize) -> [DVec3; 3] {
        let [a, b, c] = mesh.triangles[id];
        let at = |i: u32| mesh.positions[i as usize] + self.vertices[i as usize] * self.time;
        [at(a), at(b), at(c)]
    }
}
