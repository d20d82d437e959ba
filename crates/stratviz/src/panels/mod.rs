//! What is drawn. A panel reads the state and the model, changes neither, and returns what the
//! user asks for.

pub mod bars;
pub mod colours;
pub mod curve;
pub mod dialogs;
pub mod divider;
pub mod help;
pub mod inside;
pub mod legend;
pub mod numbers;
pub mod palette;
pub mod patterns;
pub mod picture;
pub mod plot;
pub mod study;
pub mod texture;
pub mod theory;
pub mod top;
pub mod trade;
pub mod view;
