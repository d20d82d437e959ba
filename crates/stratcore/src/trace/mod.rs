//! Rays against triangles: the general path, exact in f64.

mod accel;
mod exact;
mod filtered;
mod integrand;
mod moment;
mod rays;
mod scatter;
mod surface;
#[cfg(test)]
mod tests;
mod tracer;
mod triangle;

pub use accel::Accel;
pub(crate) use accel::LEAF;
pub use filtered::Filtered;
pub use integrand::{PixelIntegrand, Route, Tracer};
pub use rays::Radiance;
pub use tracer::{Hit, TracedScene};
pub use triangle::{Crossing, Ray};
