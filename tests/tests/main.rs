//! The tests across crates: one program, one file a topic.

mod agreement;
mod comparator;
mod analytic;
mod slope_bias;
mod rasterizer;
