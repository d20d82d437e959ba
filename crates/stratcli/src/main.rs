//! Batch studies.
fn main() {}
