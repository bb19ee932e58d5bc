//! The tests across crates: one program, one file a topic.

mod tidy;
mod layout;
mod mirrors;
mod comparator;
mod rasterizer;
mod analytic;
mod slope_bias;
mod limits;
mod agreement;
mod program;
