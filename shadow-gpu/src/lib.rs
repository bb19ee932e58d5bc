//! Shadow mapping on the GPU, with wgpu.
//!
//! [`GpuRenderer`] follows the same [`FramePlan`](shadow_scene::FramePlan) as any other renderer: it draws the shadow maps and the camera's
//! visibility buffer, and resolves visibility and colour in compute shaders. Its shaders mirror `shadow-math` file by file.
//! It is headless, asynchronous at its core and compiles for the web; on other targets [`block_on`](https://docs.rs/pollster) or any
//! executor drives it.

#![forbid(unsafe_code)]

pub mod adapter;
pub mod shaders;
mod clock;
mod error;
mod limits;
mod wait;
mod device;
mod passes;
mod pipelines;
mod buffers;
mod renderer;
mod shelf;
pub mod probe;

pub use adapter::{AdapterSummary, DriverRules, find_adapter, list_adapters};
pub use error::GpuError;
pub use renderer::{GpuRenderer, GpuScene, Rendered};

pub use wgpu;
