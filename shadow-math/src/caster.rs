//! Biases of the caster: how much deeper than it is a triangle is drawn into a map.
//!
//! They are what hardware and the article's shader do; the receiver's [biases](crate::bias) know what they need, these are told by a factor. Both are computed here from the triangle's vertices, for the units of
//! a pipeline's own state are the driver's.
//!
//! [`caster_offset`], [`pushed_depth`] and [`texel_ray`] are mirrored by `caster.wgsl`.

use glam::Vec3;

use crate::{
    depth::DEPTH_REVERSED,
    gradient::depth_gradient,
    plan::ViewPlan,
    triangle::{Ray, pixel_ray},
    vector::row_times_point,
};

/// [`ViewPlan::caster_kind`]: triangles are drawn where they are.
pub const CASTER_PLAIN: u32 = 0;
/// [`ViewPlan::caster_kind`]: `slope * max(|dz/dx|, |dz/dy|) + units * r`, up to the limit.
pub const CASTER_POLYGON_OFFSET: u32 = 1;
/// [`ViewPlan::caster_kind`]: what the article's caster shader adds.
pub const CASTER_OGRE_2006: u32 = 2;
/// [`ViewPlan::caster_kind`]: what the article's text asks for: the sum of both slopes, over a texel.
pub const CASTER_OGRE_2006_CORRECTED: u32 = 3;

/// The steepest slope that is reckoned with, in depth per texel. Any that is above 1 fills the range of depth within a texel, and its product with a factor of 0 is to be 0.
pub const MAX_CASTER_SLOPE: f32 = 1e30;

/// The ray of light through texel coordinates `(x, y)` of a view, as casters are tested at texels; texel centres lie at + 0.5.
///
/// In a warped view of parallel light the ray's origin is homogeneous: it is divided by its fourth component.
#[inline(always)]
#[must_use]
pub fn texel_ray(view: &ViewPlan, x: f32, y: f32) -> Ray {
    let mut ray = pixel_ray(&view.rays, x, y);
    if view.is_warped != 0 && view.w_per_metre == 0.0 {
        ray.origin /= view.rays.origin[3] + view.rays.origin_dx[3] * x + view.rays.origin_dy[3] * y;
    }
    ray
}

/// How much deeper a triangle is drawn, in depth as it is drawn, wherever it is: what follows is in the view's own depth, of which a pancaked view has more to a metre.
///
/// The corners are in metres relative to the scene's origin. A triangle without a normal, or one that the light sees edge-on, is as steep as can be.
/// The unit r of a polygon offset is a step of the map's format: one of `depth_steps`, or for floats `2^(e - 23)` with e the exponent of the largest depth of the corners (Direct3D 11.3, section 15.10; WebGPU says the same).
#[inline(always)]
#[must_use]
pub fn caster_offset(view: &ViewPlan, v0: Vec3, v1: Vec3, v2: Vec3) -> f32 {
    let normal = (v1 - v0).cross(v2 - v0);
    let gradient = depth_gradient(view, v0, normal);
    let across = gradient.x.abs().min(MAX_CASTER_SLOPE);
    let down = gradient.y.abs().min(MAX_CASTER_SLOPE);
    let mut slope = across.max(down);
    if view.caster_kind == CASTER_OGRE_2006_CORRECTED {
        slope = across + down;
    }
    let mut unit = 1.0;
    if view.caster_kind == CASTER_POLYGON_OFFSET {
        let largest = corner_depth(view, v0).max(corner_depth(view, v1)).max(corner_depth(view, v2));
        unit = depth_unit(view, largest);
    }
    let mut offset = (slope * view.caster_slope + unit * view.caster_units).min(view.caster_limit);
    if view.drawn_scale > 0.0 {
        offset /= view.drawn_scale;
    }
    offset
}

/// The depth of a corner, from 0 to 1; 0 behind the light, where what is left of the triangle begins at the near plane.
#[inline(always)]
fn corner_depth(view: &ViewPlan, corner: Vec3) -> f32 {
    let z = row_times_point(view.clip_z, corner);
    let w = row_times_point(view.clip_w, corner);
    if w <= 0.0 {
        return 0.0;
    }
    (z / w).max(0.0).min(1.0)
}

/// A step of the format at this depth.
#[inline(always)]
#[must_use]
pub fn depth_unit(view: &ViewPlan, depth: f32) -> f32 {
    /// The bits of an f32's exponent.
    const EXPONENT: u32 = 0x7f80_0000;
    /// 2^-23: the mantissa's last bit.
    const LAST_BIT: f32 = 1.192_092_9e-7;
    if view.depth_steps > 0.0 {
        return 1.0 / view.depth_steps;
    }
    f32::from_bits(depth.to_bits() & EXPONENT) * LAST_BIT
}

/// The depth at which a sample of a triangle is drawn: from 0 to 1, with [`caster_offset`] of the triangle.
///
/// A push by a constant length in metres is `(A - z)^2 length / factor` of depth where z is, with `A - z = factor / w`: equation (7) of Chong 2006. For an orthographic view it is a constant, and part of the offset.
#[inline(always)]
#[must_use]
pub fn pushed_depth(view: &ViewPlan, drawn: f32, offset: f32) -> f32 {
    let depth = drawn.max(0.0).min(1.0);
    if view.depth_kind == DEPTH_REVERSED {
        return (depth - offset).max(0.0);
    }
    let rest = view.caster_asymptote - depth;
    (depth + offset + rest * rest * view.caster_push).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_a_step_of_the_format() {
        let float = ViewPlan::default();
        // From a power of two to the next number that f32 has.
        for depth in [0.25_f32, 0.5, 1.0] {
            assert_eq!(depth_unit(&float, depth), depth.next_up() - depth);
        }
        assert_eq!(depth_unit(&float, 0.999), 0.5_f32.next_up() - 0.5);
        let steps = ViewPlan { depth_steps: 65_535.0, ..float };
        assert_eq!(depth_unit(&steps, 0.999), 1.0 / 65_535.0);
    }

    #[test]
    fn a_push_in_metres_is_as_long_at_every_distance() {
        let (near, far) = (0.5_f64, 40.0_f64);
        let scale = crate::depth::DepthScale::perspective(near, far);
        let view = ViewPlan {
            caster_asymptote: (far / (far - near)) as f32,
            caster_push: (0.01 / scale.factor) as f32,
            ..ViewPlan::default()
        };
        for w in [2.0_f64, 10.0, 39.0] {
            let depth = |w: f64| far / (far - near) * (1.0 - near / w);
            let pushed = f64::from(pushed_depth(&view, depth(w) as f32, 0.0));
            let metres = scale.factor / (far / (far - near) - pushed) - w;
            // A first order: the push is longer by its own share of the distance; and depth is a float, whose steps are w^2 / factor times as long in metres.
            let steps = w * w / scale.factor * 2.0 * crate::rounding::UNIT_ROUNDOFF;
            assert!((metres - 0.01).abs() < 0.01 * 0.02 / w + 2.0 * steps, "{metres} at {w}");
        }
    }
}
