//! Figures and pages: numbers in, SVG, PNG and HTML out. Nothing is measured here.

pub mod axis;
pub mod chart;
pub mod gain;
pub mod histogram;
pub mod page;
pub mod picture;
pub mod raster;
pub mod sides;
pub mod summary;
pub mod svg;
