//! Shadow mapping on the CPU.
//!
//! [`CpuRenderer`] follows a [`FramePlan`](shadow_scene::FramePlan): it rasterises the shadow maps and the camera's visibility buffer
//! ([`raster`]), asks [`visibility`](shadow_math::visibility()) of every pixel and shades it ([`resolve`]).
//! Work is spread over a rayon pool of its own; the result is the same to the byte for every number of threads.

mod kernel;
pub mod raster;
pub mod resolve;
pub mod renderer;

pub use raster::RasterRules;
pub use renderer::{CpuError, CpuRenderer, PreparedScene, Rendered};
