//! How far f32 arithmetic can move a depth test: the part of the bias that no geometry explains.
//!
//! Let `u = 2^-24` be half the distance between 1 and the next f32. Every sum, product and quotient is off by at most `u` of its
//! result. A row of a matrix times a point, `((m0 x + m1 y) + m2 z) + m3`, is then off by at most `4 u N` with
//! `N = |m0 x| + |m1 y| + |m2 z| + |m3|` (Higham 2002, section 3.1), and the division by `w` turns errors `e` of the row and
//! `e_w` of `w` into at most `(e + e_w) / w + 2 u` where the quotient is at most 1.
//!
//! A map's depth and a receiver's depth and texel all pass through such rows. Measured against the receiver's plane, an error of `t`
//! texels counts as `t (|g1| + |g2|)` of depth, with `g` the plane's depth gradient. So the whole is
//! `(texels + texels_over_w / w) (|g1| + |g2|) + depth + depth_over_w / w`.
//!
//! What the bound assumes: the depth plane of a triangle is evaluated from a vertex of it in f32, as every rasteriser here does.
//! Its slopes are a quotient by the triangle's area; for a triangle with longest side `l` and height `h`
//! in the map they are off by some `u l / h` of themselves. The bound holds for `l / h` up to [`MAX_TRIANGLE_ASPECT`]; a sliver beyond
//! can be off by more over its own length.

use glam::{DMat4, DVec4, Vec3};

use crate::fit::ViewFit;

/// Half the distance between 1 and the next f32: the largest relative error of one rounding.
pub const UNIT_ROUNDOFF: f64 = 1.0 / (1_u32 << 24) as f64;

/// The number of roundings in a row of four terms, as the factor of `u N`.
const ROW_ROUNDINGS: f64 = 4.0;

/// How many roundings of its own size lie between a vertex and a point rebuilt from it: three products and three sums.
const POINT_ROUNDINGS: f64 = 6.0;

/// The ratio of a triangle's longest side to its height, in texels of the map, up to which the bound holds.
pub const MAX_TRIANGLE_ASPECT: f64 = 8.0;

/// The bound on rounding of one view: see the [module](self).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RoundingBound {
    /// Texels, wherever the receiver is.
    pub texels: f64,
    /// Texels times w: divided by the receiver's w, which is 1 for an orthographic view and metres for a perspective one.
    pub texels_over_w: f64,
    /// Depth, wherever the receiver is.
    pub depth: f64,
    /// Depth times w.
    pub depth_over_w: f64,
}

impl RoundingBound {
    /// The bound for points whose coordinates are at most `extent` from the scene's origin on each axis, in metres.
    #[must_use]
    pub fn of_view(view: &ViewFit, extent: Vec3, size: u32) -> Self {
        let clip_from_world = view.clip_from_world();
        let size = f64::from(size);
        let extent = extent.as_dvec3().extend(1.0);
        let [x_error, y_error, z_error, w_error] = row_errors(clip_from_world, extent);
        // A map's texel and a receiver's texel are each off by this, hence the factor 2; half the size is texels per unit of NDC.
        let texels_over_w = 2.0 * (0.5 * size) * (x_error.max(y_error) + w_error);
        // Divisions, the change to texels and the evaluation of the depth plane across the triangle: each rounds at the
        // size of the map.
        let texels = (6.0 + MAX_TRIANGLE_ASPECT) * UNIT_ROUNDOFF * size;
        let depth_over_w = 2.0 * (z_error + w_error);
        let depth = 6.0 * UNIT_ROUNDOFF;
        // The receiver's point lies off the caster's plane by this many metres, which shows in depth at the rate of a
        // push along the axis, and in texels at the rate of a step to the side.
        let metres = POINT_ROUNDINGS * UNIT_ROUNDOFF * extent.truncate().length();
        let texel = view.texel_metres[0].min(view.texel_metres[1]);
        let scale = view.depth_scale;
        // For a perspective view the rate is factor / w^2, and at least near of one w divides it: factor / near / w.
        let depth_per_metre = if scale.w_per_metre > 0.0 { scale.factor / view.range.near } else { scale.factor };
        Self {
            texels,
            texels_over_w: texels_over_w + metres / texel,
            depth,
            depth_over_w: depth_over_w + metres * depth_per_metre,
        }
    }
}

/// The largest error of each row of a matrix over points with coordinates up to `extent`.
fn row_errors(matrix: DMat4, extent: DVec4) -> [f64; 4] {
    let transposed = matrix.transpose();
    [transposed.x_axis, transposed.y_axis, transposed.z_axis, transposed.w_axis].map(|row| {
        // A row of zeros but for its constant is exact: an orthographic view's w is 1.
        if row.truncate().abs().max_element() == 0.0 { 0.0 } else { ROW_ROUNDINGS * UNIT_ROUNDOFF * row.abs().dot(extent) }
    })
}
