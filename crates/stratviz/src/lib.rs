//! The explorer: click a pixel and watch its variance curve form.
//!
//! `state` is what a session remembers, `model` what was computed, `jobs` the threads that
//! compute it. Panels draw both and return a `Command`; `app` obeys it after drawing. Nothing
//! is computed here: plans come from the words of the command line, results from `stratcore`.

pub mod actions;
pub mod app;
pub mod command;
pub mod export;
pub mod jobs;
pub mod keys;
pub mod line;
pub mod model;
pub mod panels;
pub mod state;
pub mod words;
pub mod work;
