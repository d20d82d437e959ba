//! What the command line shares with the explorer: words and their meaning, figures, pictures,
//! tables, and files that appear whole or not at all.

pub mod cli;
pub mod output;
pub mod picture;
pub mod plan;
pub mod report;
pub mod table;
