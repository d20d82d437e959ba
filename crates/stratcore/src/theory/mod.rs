//! What theory says before anything is measured: exponents p and constants C of
//! `variance_of_mean ~ C N^-p`, each with its source.

mod class;
mod constants;
mod interaction;
mod predict;

pub use class::Class;
pub use constants::{
    circle_edge_constant, edge_constant, lattice_edge_constant, shifted_ramp_variance,
    step_variance, stratified_variance,
};
pub use interaction::interaction_variance;
pub use predict::{Basis, Prediction, Subject, predict};
