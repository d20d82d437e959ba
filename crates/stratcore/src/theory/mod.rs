//! What theory says before anything is measured: exponents p and constants C of
//! `variance_of_mean ~ C N^-p`, each with its source.

mod class;
mod constants;
mod predict;

pub use class::Class;
pub use constants::{
    circle_edge_constant, edge_constant, lattice_edge_constant, step_variance, stratified_variance,
};
pub use predict::{Basis, Prediction, Subject, predict};
