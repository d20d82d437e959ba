//! Rays against triangles: the general path, exact in f64.

mod accel;
mod exact;
mod integrand;
#[cfg(test)]
mod tests;
mod tracer;
mod triangle;

pub use accel::Accel;
pub use integrand::{PixelIntegrand, PixelRays, Tracer};
pub use tracer::{Hit, TracedScene};
pub use triangle::{Crossing, Ray};
