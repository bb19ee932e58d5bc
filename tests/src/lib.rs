//! The differential harness.

pub mod mirror;
