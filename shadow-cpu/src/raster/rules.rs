//! What WebGPU leaves open about rasterisation, as a value.

/// Where triangles are clipped on the four sides of the view, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipRule {
    /// At the sides themselves, and after them at the near and far planes. Where an edge crosses one is a step from the endpoint that is nearer to it.
    Viewport,
    /// At the near and far planes, and after them at the sides themselves. Where an edge crosses one is a weighted sum of its endpoints.
    NearFirst,
    /// Only at a guard band of [`ClipRule::GUARD_BAND`] times the view's size; what lies between is cut by the pixels' limits.
    GuardBand,
}

impl ClipRule {
    /// How many times as wide as the view the guard band is. With the largest target and the finest grid, coordinates
    /// then differ by at most `2^23` steps, which is what the edge functions have room for.
    pub const GUARD_BAND: f32 = 2.0;
}

/// How vertices get from clip space to the sub-pixel grid. That decides which way those are rounded that lie half-way between two lines, but for what their coordinates are off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SnapRule {
    /// To window coordinates in pixels first, whose distance from the first pixel's centre is then counted in steps.
    FromPixels,
    /// To steps from the first pixel's centre at once.
    AtOnce,
}

/// Which vertices the depth plane goes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthPlaneRule {
    /// The window coordinates as they were computed.
    Unsnapped,
    /// The window coordinates on the sub-pixel grid: of a triangle that is clipped those of its own corners, wherever they are, and not of those that clipping makes. Depth is counted from the farthest one.
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
    /// How they are snapped.
    pub snap: SnapRule,
    /// Which vertices the depth plane goes through.
    pub depth_plane: DepthPlaneRule,
    /// Where triangles are clipped on the sides.
    pub clip: ClipRule,
    /// Whether the viewport, and the depth plane unless it is snapped, use fused multiply-adds.
    pub fused: bool,
}

impl RasterRules {
    /// Mesa 22.3's lavapipe on a processor with or without fused multiply-adds: it uses them where there are any.
    #[must_use]
    pub const fn lavapipe(fused: bool) -> Self {
        Self {
            subpixel_bits: 8,
            snap: SnapRule::FromPixels,
            depth_plane: DepthPlaneRule::Unsnapped,
            clip: ClipRule::Viewport,
            fused,
        }
    }

    /// The rules of a driver of which the sub-pixel bits and the vertices of the depth plane were measured, as far as they were; the rest is the default.
    ///
    /// A grid finer than 8 bits counts as one of 8, and one coarser than 4 as one of 4: no driver is known to have such.
    #[must_use]
    pub fn measured(subpixel_bits: Option<u32>, depth_plane: Option<DepthPlaneRule>) -> Self {
        let default = Self::default();
        Self {
            subpixel_bits: subpixel_bits.unwrap_or(default.subpixel_bits).clamp(4, 8),
            depth_plane: depth_plane.unwrap_or(default.depth_plane),
            ..default
        }
    }

    /// SwiftShader, the software driver of browsers, with the code generator Subzero. Taken from its source (`SetupRoutine.cpp`, `Clipper.cpp`) and found by comparison: with it this rasteriser and that driver
    /// agree in every bit too.
    pub const SWIFTSHADER: Self = Self {
        subpixel_bits: 4,
        snap: SnapRule::AtOnce,
        depth_plane: DepthPlaneRule::Snapped,
        clip: ClipRule::NearFirst,
        fused: false,
    };
}

impl Default for RasterRules {
    /// Lavapipe's rules on this processor.
    fn default() -> Self {
        Self::lavapipe(crate::kernel::has_fused_multiply_add())
    }
}
