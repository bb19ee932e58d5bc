//! The differential harness: what the tests across crates share.
//!
//! The tests themselves are in `tests/` beside it, one file a topic, joined into one program.

pub mod cameras;
mod known;
pub mod lights;
pub mod mirror;
pub mod renderers;
pub mod report;
