//! The `senca` command.
fn main() {}
