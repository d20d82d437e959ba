//! Pixels in more than two dimensions: which axes they need, what that predicts for each way to
//! stratify them, and whether it is so.
//!
//! [`Needs`] takes an integrand apart, [`limit`] says what theory makes of that, and
//! [`Combination::measure`] holds both against trials on pictures with every combination of
//! lens, area light and shutter.

mod choose;
mod combination;
mod draw;
mod expected;
mod filters;
mod measure;
mod needs;
mod predict;
mod survey;
#[cfg(test)]
mod tests;

pub use choose::{Kind, LATTICE};
pub use combination::{COMBINATIONS, Combination};
pub use draw::Estimate;
pub use expected::{Expected, Grouping};
pub use filters::{FILTERED_SCENE, FilterRow, filters};
pub use measure::{FAMILIES, Far, PixelTable, SamplerRow};
pub use needs::{AxisNeeds, Behaviour, MOST_DIMENSIONS, Needs};
pub use predict::{
    Bound, Limit, lacks_predictions, limit, needs_of_pixel, predict_from, predict_pixel,
};
pub use survey::{SURVEYED, survey};
