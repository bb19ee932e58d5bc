//! What WebGPU leaves open about rasterisation, as a value.

/// Where triangles are clipped on the four sides of the view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipRule {
    /// At the sides themselves.
    Viewport,
    /// Only at a guard band of [`ClipRule::GUARD_BAND`] times the view's size; what lies between is cut by the pixels' limits.
    GuardBand,
}

impl ClipRule {
    /// How many times as wide as the view the guard band is. With the largest target and the finest grid, coordinates
    /// then differ by at most `2^23` steps, which is what the edge functions have room for.
    pub const GUARD_BAND: f32 = 2.0;
}

/// Which vertices the depth plane goes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthPlaneRule {
    /// The window coordinates as they were computed.
    Unsnapped,
    /// The window coordinates on the sub-pixel grid. The plane of a triangle that is clipped goes through its own corners, wherever they are, and not through those that clipping makes.
    Snapped,
}

/// A driver's choices where WebGPU leaves one.
///
/// WebGPU fixes samples at pixel centres and the top-left rule. The default is what Mesa 22.3's lavapipe does, found by
/// experiment: with it this rasteriser and that driver agree in every bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RasterRules {
    /// Bits of the sub-pixel grid that vertices are snapped to, from 4 to 8.
    pub subpixel_bits: u32,
    /// Which vertices the depth plane goes through.
    pub depth_plane: DepthPlaneRule,
    /// Where triangles are clipped on the sides.
    pub clip: ClipRule,
    /// Whether the viewport and the depth plane use fused multiply-adds.
    pub fused: bool,
}

impl RasterRules {
    /// Mesa 22.3's lavapipe on a processor with or without fused multiply-adds: it uses them where there are any.
    #[must_use]
    pub const fn lavapipe(fused: bool) -> Self {
        Self { subpixel_bits: 8, depth_plane: DepthPlaneRule::Unsnapped, clip: ClipRule::Viewport, fused }
    }

    /// SwiftShader: 4 bits of sub-pixel grid, and depth from snapped vertices. Found by comparison, and complete but for the order in which a depth plane's terms are summed: on the scenes that were compared all
    /// samples are covered alike, and depths differ by up to `4e-5` of the range in the steepest triangles.
    pub const SWIFTSHADER: Self =
        Self { subpixel_bits: 4, depth_plane: DepthPlaneRule::Snapped, clip: ClipRule::Viewport, fused: false };
}

impl Default for RasterRules {
    /// Lavapipe's rules on this processor.
    fn default() -> Self {
        Self::lavapipe(crate::kernel::has_fused_multiply_add())
    }
}
