//! What the command line shares with the explorer and with tests: words and their meaning,
//! `study.toml`, figures, pictures, tables, and files that appear whole or not at all.
#![allow(missing_docs, reason = "only our own tools read it; a word's meaning is its help text")]

#[allow(missing_docs, reason = "the comments of its fields are the help that users read")]
pub mod cli;
pub mod output;
pub mod picture;
pub mod plan;
pub mod report;
pub mod study_file;
pub mod table;
