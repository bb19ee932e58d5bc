//! Every space that the project uses, defined once.
//!
//! | space | axes | unit |
//! |---|---|---|
//! | world | right-handed, y up, relative to the scene's origin | metre |
//! | view | right-handed, x right, y up, looks along -z | metre |
//! | clip | x right, y up, before the division by w | - |
//! | NDC | clip / w; x and y in -1 to 1, z in 0 to 1 ([`ClipDepth`]) | - |
//! | texel | x right, y **down**, origin at the top left corner, centres at + 0.5 | texel |
//! | UV | texel / size | - |
//!
//! Matrices are named by what they map: `clip_from_world` times a world point is a clip point, and neighbouring names
//! cancel in a product.
//!
//! NDC's y points up and texel's y points down. [`texel_from_ndc`] is the one place that turns it over.

use glam::{DMat4, DVec2, DVec4};

/// The range of depth after the division by w.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum ClipDepth {
    /// 0 at the near plane, 1 at the far plane: WebGPU, Direct3D, Metal, Vulkan.
    ZeroToOne,
    /// -1 at the near plane, 1 at the far plane: OpenGL, and the matrices that OGRE computes.
    MinusOneToOne,
    /// 1 at the near plane, 0 at the far plane or at infinity: the camera's own depth.
    Reversed,
}

impl ClipDepth {
    /// The matrix from this range's clip space to that of [`ClipDepth::ZeroToOne`].
    ///
    /// ```
    /// use shadow_math::spaces::ClipDepth;
    /// use glam::DVec4;
    ///
    /// let near_in_opengl = DVec4::new(0.2, 0.4, -2.0, 2.0);
    /// let near = ClipDepth::MinusOneToOne.zero_to_one_from_clip() * near_in_opengl;
    /// assert_eq!(near.z / near.w, 0.0);
    /// ```
    #[must_use]
    pub fn zero_to_one_from_clip(self) -> DMat4 {
        let (scale, offset) = match self {
            Self::ZeroToOne => (1.0, 0.0),
            Self::MinusOneToOne => (0.5, 0.5),
            Self::Reversed => (-1.0, 1.0),
        };
        let mut matrix = DMat4::IDENTITY;
        matrix.z_axis.z = scale;
        matrix.w_axis.z = offset;
        matrix
    }
}

/// The scale and the offset that take NDC x and y to texels of a rectangle: `texel = ndc * scale + offset`.
///
/// `origin` is the rectangle's top left corner and `size` its extent, both in texels. The negative scale in y is the
/// project's only y flip.
///
/// ```
/// use shadow_math::spaces::texel_from_ndc;
/// use glam::DVec2;
///
/// let (scale, offset) = texel_from_ndc(DVec2::ZERO, DVec2::splat(512.0));
/// let top_left = DVec2::new(-1.0, 1.0) * scale + offset;
/// assert_eq!(top_left, DVec2::ZERO);
/// ```
#[must_use]
pub fn texel_from_ndc(origin: DVec2, size: DVec2) -> (DVec2, DVec2) {
    let scale = DVec2::new(0.5 * size.x, -0.5 * size.y);
    let offset = origin + 0.5 * size;
    (scale, offset)
}

/// [`texel_from_ndc`] as a matrix on homogeneous points; z and w pass through.
///
/// The article "Shadow Mapping in Ogre" (Chong 2006, section 1.2) calls this matrix `V`.
#[must_use]
pub fn texel_from_clip(origin: DVec2, size: DVec2) -> DMat4 {
    let (scale, offset) = texel_from_ndc(origin, size);
    DMat4::from_cols(
        DVec4::new(scale.x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, scale.y, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 1.0, 0.0),
        DVec4::new(offset.x, offset.y, 0.0, 1.0),
    )
}
