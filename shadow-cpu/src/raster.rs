//! The rasteriser: triangles in, depth maps and visibility buffers out.
//!
//! 1. `transform` takes every vertex once to window coordinates and the sub-pixel grid.
//! 2. `clip` cuts the triangles that cross the view volume.
//! 3. `setup` makes edge functions and a depth plane of each triangle, and `bins` sorts them by tile.
//! 4. `tile` evaluates them, eight samples at a time, into a tile that stays in the cache.
//!
//! Chunks of triangles and rows of tiles are worked on in parallel. Chunks are made by number of triangles, never by number of
//! threads, and each tile takes its triangles in order: the result does not depend on the threads.

mod bins;
mod clip;
mod pass;
mod plane;
mod rules;
mod sample;
mod setup;
mod stored;
mod tile;
mod transform;

pub use pass::{AlphaTest, MAX_TARGET_SIZE, NoAlphaTest, Run, Scratch, Target, rasterize_depth, rasterize_visibility};
pub use rules::{ClipRule, DepthPlaneRule, RasterRules, SnapRule};
pub use setup::Culling;
pub use stored::{Drawing, rasterize_second, rasterize_stored};
pub use transform::Positions;
