//! How fast does a pixel's estimate converge, and why?
//!
//! The experiment of D. P. Mitchell, *Consequences of Stratified Sampling in Graphics*
//! (SIGGRAPH 1996): estimate one integral M times from N samples each, measure the variance of
//! those means, repeat for growing N, and read the exponent p of `variance ~ C N^-p` off a
//! line in log space.
//!
//! ```text
//! Scene → PixelIntegrand (or another Integrand) → Sampler fills points → trial means [M]
//!       → variance of the mean → rows (N, variance) → Fit → StudyResult
//! ```

pub mod beam;
pub mod counts;
pub mod dimensions;
pub mod discrepancy;
mod double;
pub mod error;
pub mod exact;
pub mod fit;
pub mod input;
pub mod integrand;
pub mod literature;
pub mod map;
pub mod noise;
pub mod rng;
pub mod sampler;
pub mod scene;
pub mod simd;
pub mod spectrum;
pub mod stability;
pub mod study;
pub mod theory;
pub mod trace;
pub mod trade;
pub mod trial;
pub mod variance;

pub use error::StudyError;
pub use study::{StudyPlan, StudyResult, study};
