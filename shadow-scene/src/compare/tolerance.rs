//! The tolerances of [`Contract::Tolerance`](super::Contract): one table, every entry with its reason.
//!
//! A map's layer says nothing about triangles, so its differing texels are only counted, not traced to an edge as the camera's are.
//!
//! They say what may differ between renderers that follow WebGPU and nothing more. Where the rules of a driver are known completely there is no
//! tolerance at all.

/// The sub-pixel step in pixels: the coarsest grid, of 4 bits, that WebGPU's backends are allowed to snap vertices to.
pub const SUBPIXEL_STEP: f64 = 1.0 / 16.0;

/// Depths agree within this, and [`SUBPIXEL_STEP`] times their slope: sixteen roundings of a depth near 1, since WebGPU does not say in
/// which order the interpolation is computed, nor from which vertex.
pub const DEPTH: f64 = 1.0 / (1_u32 << 20) as f64;

/// Coverage may differ in one sample of this many. Drivers that snap to the same grid differ where an edge passes within rounding of a sample:
/// at about 20 of 300,000 samples in soups of 20,000 random triangles, whose edges are far denser than those of scenes.
pub const COVERAGE_ONE_IN: usize = 100_000;

/// Visibility agrees within this where it is not left out: what an 8-bit picture can show.
pub const VISIBILITY: f32 = 1.0 / 255.0;

/// Visibility may be left out at one pixel of this many: edges of shadows are where rounding decides, and they are few.
pub const VISIBILITY_LEFT_OUT_ONE_IN: usize = 1_000;

/// A lookup nearer than this to a texel's border, in texels, can fall into either texel under a hard filter. Where the view's own bound on rounding
/// is larger, as on maps beyond 500 texels, that bound takes its place.
pub const TEXEL_BORDER: f32 = 1.0 / 256.0;

/// Colours of a picture agree within this many steps of 8 bits: rounding to a step can fall either way.
pub const COLOR_STEPS: u8 = 1;

/// How many samples of `count` may differ in coverage: at least one, so that a small picture is not held to more than a large one.
#[must_use]
pub fn coverage_allowance(count: usize) -> usize {
    (count / COVERAGE_ONE_IN).max(1)
}

/// How many pixels of `count` may be left out of the comparison of visibility: at least one.
#[must_use]
pub fn left_out_allowance(count: usize) -> usize {
    (count / VISIBILITY_LEFT_OUT_ONE_IN).max(1)
}
