//! The fast path: all samples of a study lie in one pixel.
//!
//! Once per pixel, the triangles that can be seen in it are gathered from the BVH and set up in
//! the pixel's own coordinates (`facet`); then many samples are evaluated at once against
//! that short list ([`crate::simd`]), whose doubtful cases are settled in f64.

mod affine;
mod area;
mod facet;
mod gather;
mod numbers;
mod pixel;
mod placed;
mod shade;
mod shadow;

#[cfg(test)]
mod tests;

pub(crate) use affine::Affine;
pub use area::AreaBeam;
pub use pixel::PixelBeam;
