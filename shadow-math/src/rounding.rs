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
//! A rasteriser evaluates the depth plane of a triangle from one of its vertices, with slopes that are quotients by the triangle's area.
//! Let `L` be its longest side, `h` its height over it, both in texels on the triangle's own plane, and `g` the plane's slope. The two terms of
//! a slope are at most `g L / h` each and pass through four roundings, the area's two through two more, so over a length `L` depth is off by at
//! most `12 u g L^2 / h`: 12 u L^2 / h texels. That has no bound over all triangles. The bound here holds where `L^2 / h` is at most
//! [`MAX_TRIANGLE_LENGTH`] times the size of the map: any well-shaped triangle, a fan of up to a hundred triangles or eight strips across the whole
//! map, and slivers of any kind that are short. A longer sliver can shadow itself in single samples: a
//! disc of 3000 triangles across a map of 2048 texels did in one pixel of 900,000. Clipping at the sides of a view cuts such slivers from triangles that are well
//! shaped: of random planes cut into strips or fans, under lights of all kinds, one in 300 had one. What a filter's width needs hides them, and only a bias that leaves nothing for it, as the receiver
//! plane's, shows them. A triangle that the light sees edge-on has a slope without a bound, and
//! where its image is thinner than the rounding of its corners a rasteriser can give it any depth at all, in the few samples that it covers.

use glam::{DMat4, DVec4, Vec3};

use crate::{fit::ViewFit, settings::Store};

/// Half the distance between 1 and the next f32: the largest relative error of one rounding.
pub const UNIT_ROUNDOFF: f64 = 1.0 / (1_u32 << 24) as f64;

/// The number of roundings in a row of four terms, as the factor of `u N`.
const ROW_ROUNDINGS: f64 = 4.0;

/// How many roundings of the coordinates' size lie between the vertices and a point `v0 + e1 u + e2 v`: with `u + v <= 1` the edges and
/// products make four, the sums two. Two more move it along the normal.
const POINT_ROUNDINGS: f64 = 8.0;

/// How many roundings of `L^2 / h` the slopes of a depth plane carry: see the [module](self).
const PLANE_ROUNDINGS: f64 = 12.0;

/// The longest side of a triangle, squared, over its height, both on its own plane, up to which the bound holds: in sizes of the map.
pub const MAX_TRIANGLE_LENGTH: f64 = 8.0;

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
    /// A receiver's own w, in metres.
    pub w: f64,
    /// Metres along the axis: what linear depth adds.
    pub metres: f64,
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
        let [texels, depth] = map_bound(size);
        let depth_over_w = 2.0 * (z_error + w_error);
        // The receiver's point lies off the caster's plane by this many metres, which shows in depth at the rate of a
        // push along the axis, and in texels at the rate of a step to the side.
        let metres = POINT_ROUNDINGS * UNIT_ROUNDOFF * extent.truncate().length();
        if view.is_warped {
            // The quotient rule, with image and depth at most 1: a metre moves them by no more than the rows' own lengths, over w.
            let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_world.row(row).truncate().length());
            return Self {
                texels,
                texels_over_w: texels_over_w + metres * 0.5 * size * (x.max(y) + w),
                depth,
                depth_over_w: depth_over_w + metres * (z + w),
                w: w_error,
                metres: 0.0,
            };
        }
        let texel = view.texel_metres[0].min(view.texel_metres[1]);
        let scale = view.depth_scale;
        // For a perspective view the rate is factor / w^2, and at least near of one w divides it: factor / near / w.
        let depth_per_metre = if scale.w_per_metre > 0.0 { scale.factor / view.range.near } else { scale.factor };
        Self {
            texels,
            texels_over_w: texels_over_w + metres / texel,
            depth,
            depth_over_w: depth_over_w + metres * depth_per_metre,
            w: w_error,
            metres: 0.0,
        }
    }

    /// The bound for what a map stores of the depth that this one is for. `view` is the view that draws it, and `is_reversed` whether it draws reversed depth.
    ///
    /// Reversed depth of a perspective view is at most `near / w`, and so are the roundings that go by its size. Steps add what [`step_rounding`] says, the sum of a midpoint one rounding. Linear depth takes six
    /// operations in a map and two at a receiver, each off by u of the range at most, and the receiver's w.
    #[must_use]
    pub fn of_store(mut self, store: Store, view: &ViewFit, is_reversed: bool) -> Self {
        let is_perspective = view.depth_scale.w_per_metre > 0.0 && !view.is_warped;
        if is_reversed && is_perspective {
            self.depth_over_w += self.depth * view.range.near;
            self.depth = 0.0;
        }
        match store {
            Store::Depth24 | Store::Depth16 => self.depth += step_rounding(store.steps()),
            Store::Midpoint => self.depth += UNIT_ROUNDOFF,
            Store::Linear if is_perspective => {
                self.metres = 8.0 * UNIT_ROUNDOFF * view.range.far + self.w;
            }
            _ => {}
        }
        self
    }

    /// The bound for a view that draws casters between wider planes than its own, to be applied last: as it is for others. `store` and `is_reversed` are as for [`Self::of_store`].
    ///
    /// Casters have depths of the wider planes, whose row rounds as the view's own does, and which count as much more as its planes are nearer to each other, `s` times. Rasterising and turning a depth into the
    /// view's own take ten roundings of a depth of at most 1, times `s`, and one of what is added. A reversed depth of a perspective view goes by `factor / w`, and so do they.
    #[must_use]
    pub fn of_pancake(mut self, store: Store, view: &ViewFit, extent: Vec3, is_reversed: bool) -> Self {
        const DRAWN_ROUNDINGS: f64 = 10.0;
        if !view.is_pancaked() {
            return self;
        }
        let [nearest, farthest] = view.caster_depth;
        let scale = farthest - nearest;
        let extent = extent.as_dvec3().extend(1.0);
        let of_rows = scale
            * [view.drawn_row(is_reversed), view.clip_from_world().row(3)].map(|row| row_error(row, extent)).iter().sum::<f64>();
        let added = UNIT_ROUNDOFF * (1.0 + if is_reversed { 1.0 - farthest } else { nearest }.abs());
        let is_perspective = view.depth_scale.w_per_metre > 0.0 && !view.is_warped;
        let of_drawing = DRAWN_ROUNDINGS * UNIT_ROUNDOFF;
        if store == Store::Linear && is_perspective {
            // A reversed depth changes by factor / w^2 a metre, at the far plane the least.
            let (far, factor) = (view.range.far, view.depth_scale.factor);
            self.metres += (of_rows + of_drawing * factor) * far / factor + added * far * far / factor;
            return self;
        }
        self.depth_over_w += of_rows;
        self.depth += added;
        if is_reversed && is_perspective {
            self.depth_over_w += of_drawing * view.depth_scale.factor;
        } else {
            self.depth += of_drawing * scale;
        }
        self
    }
}

/// How far a depth from 0 to 1 is moved by rounding it to one of so many steps in f32: half a step, and as much as the product before it and the quotient after it are off.
#[must_use]
pub fn step_rounding(steps: f32) -> f64 {
    let step = 1.0 / f64::from(steps);
    0.5 * step + 2.0 * UNIT_ROUNDOFF
}

/// The part of the bound that every view of a map of `size` texels has, in texels and in depth: what a rasteriser may be off by between the corners that it is
/// given and the depth that it writes is within `texels (|g1| + |g2|) + depth`, for triangles up to [`MAX_TRIANGLE_LENGTH`].
#[must_use]
pub fn map_bound(size: f64) -> [f64; 2] {
    // Divisions and the change to texels on both sides, which round at the size of the map, and the depth plane's slopes.
    [(6.0 + PLANE_ROUNDINGS * MAX_TRIANGLE_LENGTH) * UNIT_ROUNDOFF * size, 6.0 * UNIT_ROUNDOFF]
}

/// The largest error of each row of a matrix over points with coordinates up to `extent`.
fn row_errors(matrix: DMat4, extent: DVec4) -> [f64; 4] {
    let transposed = matrix.transpose();
    [transposed.x_axis, transposed.y_axis, transposed.z_axis, transposed.w_axis].map(|row| row_error(row, extent))
}

/// The same of one row.
fn row_error(row: DVec4, extent: DVec4) -> f64 {
    // A row of zeros but for its constant is exact: an orthographic view's w is 1.
    if row.truncate().abs().max_element() == 0.0 { 0.0 } else { ROW_ROUNDINGS * UNIT_ROUNDOFF * row.abs().dot(extent) }
}
