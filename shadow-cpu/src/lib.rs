//! Shadow mapping on the CPU.
//!
//! [`CpuRenderer`] follows a [`FramePlan`](shadow_scene::FramePlan): it rasterises the shadow maps and the camera's visibility buffer
//! ([`raster`]), asks [`visibility`](shadow_math::visibility()) of every pixel and shades it ([`resolve`]).
//! Work is spread over a rayon pool of its own; the result is the same to the byte for every number of threads.
//!
//! ```
//! use shadow_cpu::{CpuRenderer, RasterRules};
//! use shadow_math::ShadowSettings;
//! use shadow_scene::{FramePlan, Request, builtin};
//!
//! let scene = builtin::box_on_plane();
//! let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &ShadowSettings::default(), 64, 36, None)?;
//! let renderer = CpuRenderer::new(0, RasterRules::default())?;
//! let frame = renderer.render(&renderer.prepare(&scene), &plan, Request::ALL)?.frame;
//! assert_eq!(frame.color().map(<[_]>::len), Some(64 * 36));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod buffer;
mod kernel;
pub mod raster;
pub mod resolve;
pub mod trace;
pub mod measure;
pub mod renderer;

pub use buffer::Buffer;
pub use raster::RasterRules;
pub use renderer::{CpuError, CpuRenderer, Drawn, PreparedScene, Rendered};
