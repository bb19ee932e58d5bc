//! Depth bias: how much farther than its texel's depth a receiver may lie and still count as lit.
//!
//! A texel stores one depth for an area. Over that area the depth of a slanted plane changes, and without a bias half of the plane
//! shadows itself. For a plane the change is exact: depth z / w is an affine function of the texel coordinates, so its
//! gradient `g = (du3/du1, du3/du2)` is one pair of numbers for the whole plane. A filter whose weighted taps lie at most
//! `support` texels away on each axis compares with depths that differ by at most `support * (|g1| + |g2|)`; that much bias is
//! needed, and no more.
//!
//! [`gradient`](crate::gradient) says how it is computed.
//!
//! The automatic bias is that need, `h(g) + snap + rounding`: h for the taps, half a step of the sub-pixel grid for the depth that a rasteriser takes from
//! snapped vertices, and the [bound on rounding](crate::rounding) of the map's format and of the transforms on both sides. Where the light grazes a surface it is
//! met by a step along the normal ([`normal_offset`]), elsewhere by depth ([`depth_bias`]). All three follow from the plan of one light and view and from the filter; lengths in
//! metres come from the view's own scale, so that the same settings hold for a ring and for a town.
//!
//! [`needed_depth`], [`depth_bias`] and [`normal_offset`] are mirrored by `bias.wgsl`.

use glam::{Vec2, Vec3};

pub use crate::gradient::{depth_gradient, depth_per_view_z, gradient_by_jacobian, gradient_by_plane};
use crate::{
    depth::DEPTH_LINEAR,
    filter,
    plan::{
        BIAS_AUTOMATIC, BIAS_CONSTANT, BIAS_NORMAL_OFFSET, BIAS_RECEIVER_PLANE, BIAS_SLOPE, LightPlan, ViewPlan, toward_light,
    },
    vector::normalized,
};

/// The most bias that has a meaning: the whole depth range. With it everything is lit.
pub const MAX_DEPTH_BIAS: f32 = 1.0;

/// By how much the gradient's own rounding can make it too small: as a factor on it.
///
/// The gradient is a quotient of two dot products of three terms each. Their terms cancel only as far as the receiver is seen
/// edge-on; at 89 degrees they have lost six bits of 24. `2^-14` covers that with a margin and costs no texel anything.
pub const GRADIENT_MARGIN: f32 = 1.0 + GRADIENT_ROUNDING;

/// By what share of itself the gradient can be off.
pub const GRADIENT_ROUNDING: f32 = 1.0 / 16_384.0;

/// The tangent of the angle between a plane's normal and the light from which on the automatic bias moves lookups along the normal.
///
/// A depth bias c, as a length along the light, is `R t (|cos| + |sin|)` times this tangent (R the filter's reach in texels, t a texel): it grows without bound as
/// the light grazes a surface, and what is nearer than it casts no shadow. A step of `c cos` along the normal clears as much, and is never longer than `sqrt(2) R t`; but it
/// moves every outline on the surface to the side, by as much again, where the depth bias moves none. Which costs less was measured: over a hundred scenes, three
/// lights and two filters the sum of squared errors of visibility has its least value, 10 % (hard) and 28 % (bilinear) below that without any step, where steps begin
/// between 20 and 30, and changes by 1 % in between.
pub const OFFSET_SLOPE: f32 = 24.0;

/// How much depth the receiver's plane needs under the filter: `h(g) + snap + rounding`, at least 0.
///
/// `w` is the receiver's clip w, above 0. The receiver's `point` and `normal` are as for [`depth_gradient`]. A plane that is seen edge-on needs more than there
/// is: up to infinity. `footprint` has the sides of the pixel's image in the map, in texels, for the filter that is made of them.
#[inline(always)]
#[must_use]
pub fn needed_depth(light: &LightPlan, view: &ViewPlan, point: Vec3, normal: Vec3, w: f32, footprint: [Vec2; 2]) -> f32 {
    let gradient = depth_gradient(view, point, normal);
    // A constant factor comes before the variable ones: shader compilers move it there.
    let slope = (gradient.x.abs() + gradient.y.abs()) * GRADIENT_MARGIN;
    let mut reach = filter::support(light, gradient, footprint);
    // Taps that are compared with the receiver's plane need nothing for where they lie but what the plane's own gradient is off.
    if light.bias & BIAS_RECEIVER_PLANE != 0 {
        reach *= GRADIENT_ROUNDING;
    } else {
        reach *= light.slope_scale;
    }
    let texels = reach + (view.snap_texels + view.rounding_texels[0] + view.rounding_texels[1] / w);
    let mut rounding = view.rounding_depth[0] + view.rounding_depth[1] / w;
    if view.depth_kind == DEPTH_LINEAR {
        // Linear depth is of views whose distance is w.
        rounding += metres_to_depth(view, w, w, view.rounding_metres);
    }
    slope * texels + rounding
}

/// The bias of a lookup that is not moved, in depth, from 0 to [`MAX_DEPTH_BIAS`]; it is added to the stored depth.
///
/// `needed` is what [`needed_depth`] gives, `w` the receiver's clip w, above 0, and `axis_distance` its distance along the view's axis, in metres. It is one of z / w: [`linear_bias`](crate::depth::linear_bias) turns it into one of linear depth.
#[inline(always)]
#[must_use]
pub fn depth_bias(light: &LightPlan, view: &ViewPlan, needed: f32, w: f32, axis_distance: f32) -> f32 {
    let mut bias = 0.0;
    if light.bias & BIAS_CONSTANT != 0 {
        bias = metres_to_depth(view, w, axis_distance, light.bias_metres);
    }
    if light.bias & (BIAS_SLOPE | BIAS_AUTOMATIC | BIAS_RECEIVER_PLANE) != 0 {
        bias += needed;
    }
    bias.min(MAX_DEPTH_BIAS)
}

/// How far a lookup is moved along the unit normal `normal`, in metres, in place of a depth bias; 0 where it stays.
///
/// `point` is in metres relative to the scene's origin, `w` its clip w, above 0, and `needed` what [`needed_depth`] gives there. Only the automatic bias moves lookups,
/// and only where the plane is steeper toward the light than [`OFFSET_SLOPE`]. A plane that needs the whole range of depth between the casters' planes, as one that is seen edge-on
/// does, stays where it is: [`depth_bias`] then leaves it lit.
///
/// Let `h` be the normal's component along the vector from the point to the light: its height over the plane for a light at a place, the cosine for
/// a directional one. A point `s` above the plane is nearer to the light than the plane is, along its own ray, by the depth
/// `factor s / (h (w + s w_n))`, where `w_n` is how fast w grows along the normal: similar triangles, exact. Set equal to the depth that is needed, H, that gives
/// `s = H h w / (factor - H h w_n)`. In texels the lookup moves by the support times `(|a| + |b|) |(a - c X, b - c Y)|`
/// where (a, b, c) is the normal in the view's axes and (X, Y) the tangents of the point's direction: by at most `sqrt(2)` times the support in an orthographic
/// view, 1.5 times in a cube's face, and 2.4 times in the widest spot light's map.
#[inline(always)]
#[must_use]
pub fn normal_offset(light: &LightPlan, view: &ViewPlan, point: Vec3, normal: Vec3, needed: f32, w: f32) -> f32 {
    if light.bias != BIAS_AUTOMATIC || !(needed < MAX_DEPTH_BIAS.max(view.drawn_scale)) {
        return 0.0;
    }
    let toward = toward_light(light, point);
    let height = normal.dot(toward);
    let is_steep = toward.dot(toward) > (OFFSET_SLOPE * OFFSET_SLOPE + 1.0) * (height * height);
    let needed_at_height = needed * height;
    let along = normal.x * view.clip_w[0] + normal.y * view.clip_w[1] + normal.z * view.clip_w[2];
    let rest = view.depth_factor - needed_at_height * along;
    // Nothing is left of the factor where no step along the normal would be enough: the depth bias then is.
    if is_steep && rest > 0.0 {
        return needed_at_height * w / rest;
    }
    0.0
}

/// How far a normal offset moves a lookup along the unit normal `normal`, in metres: so many texels, as wide as they are where the receiver is, times the sine of the angle between normal and
/// light; 0 without that part of the bias.
///
/// `point` is in metres relative to the scene's origin, `w` its clip w, above 0. Source: Holbert, "Saying Goodbye to Shadow Acne" (GDC 2011); Filament takes half a texel.
#[inline(always)]
#[must_use]
pub fn normal_step(light: &LightPlan, view: &ViewPlan, point: Vec3, normal: Vec3, w: f32) -> f32 {
    if light.bias & BIAS_NORMAL_OFFSET == 0 {
        return 0.0;
    }
    let cosine = normal.dot(normalized(toward_light(light, point)));
    let sine = square_root((1.0 - cosine * cosine).max(0.0));
    light.normal_texels * texel_width(light, view, point, w) * sine
}

/// The longer side of a texel across the light's ray, where a point is, in metres.
///
/// `point` is in metres relative to the scene's origin, `w` its clip w, above 0. In a warped view the point moves by `w (c - x c_w)` a texel, with c the inverse matrix's column and x the point: the quotient rule. What
/// of that is along the ray does not count.
#[inline(always)]
#[must_use]
pub fn texel_width(light: &LightPlan, view: &ViewPlan, point: Vec3, w: f32) -> f32 {
    if view.is_warped == 0 {
        return view.texel_metres[0].max(view.texel_metres[1]) * w;
    }
    let toward = normalized(toward_light(light, point));
    let across_x = across(column_step(view.world_from_texel_x, point), toward);
    let across_y = across(column_step(view.world_from_texel_y, point), toward);
    across_x.max(across_y) * w
}

/// How a point moves along a column of the inverse matrix, over w.
#[inline(always)]
fn column_step(column: [f32; 4], point: Vec3) -> Vec3 {
    Vec3::new(column[0] - point.x * column[3], column[1] - point.y * column[3], column[2] - point.z * column[3])
}

/// The length of what is left of a vector across a unit vector.
#[inline(always)]
fn across(v: Vec3, unit: Vec3) -> f32 {
    let rest = v - unit * v.dot(unit);
    square_root(rest.x * rest.x + rest.y * rest.y + rest.z * rest.z)
}

#[inline(always)]
fn square_root(x: f32) -> f32 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    x.sqrt()
}

/// The most that a receiver plane corrects a tap by, in depth: as much as its length in metres takes up before the receiver.
#[inline(always)]
#[must_use]
pub fn plane_limit(light: &LightPlan, view: &ViewPlan, w: f32, axis_distance: f32) -> f32 {
    metres_to_depth(view, w, axis_distance, light.plane_metres)
}

/// The depth that the last `metres` before a receiver take up; [`MAX_DEPTH_BIAS`] where they reach back to the light.
///
/// The image of the light itself has a depth and nothing else: x, y and w are 0 there. A point that has gone the share s of its way to a light at a place is `(1 - s)` of itself and s of the light, homogeneous, and its depth is
/// smaller by `factor s / ((1 - s) w)`, with `factor` minus the light's depth; with s the metres over the distance that is what stands here. A point that moves toward parallel light by m metres is itself and m of the light:
/// `factor m / w`. Both hold for any matrix that maps the light so, warped or not.
#[inline(always)]
fn metres_to_depth(view: &ViewPlan, w: f32, axis_distance: f32, metres: f32) -> f32 {
    let distance_before = axis_distance - view.w_per_metre * metres;
    if distance_before <= 0.0 {
        return MAX_DEPTH_BIAS;
    }
    view.depth_factor * metres / (w * distance_before)
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::*;
    use crate::{bounds::Aabb, fit::spot_view};

    /// A texel's width where the receiver is, times the sine of the angle, and nothing where the light stands over the surface.
    #[test]
    fn a_normal_step_is_texels_times_the_sine() {
        let light = LightPlan {
            kind: crate::plan::LIGHT_POINT,
            position: [0.0, 5.0, 0.0],
            bias: BIAS_NORMAL_OFFSET,
            normal_texels: 2.0,
            ..LightPlan::default()
        };
        let view = ViewPlan { texel_metres: [0.01, 0.02], ..ViewPlan::default() };
        for (degrees, w) in [(0.0_f32, 5.0), (30.0, 5.0), (80.0, 2.5)] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            let normal = Vec3::new(sine, cosine, 0.0);
            let step = normal_step(&light, &view, Vec3::ZERO, normal, w);
            // One minus the cosine's square loses half of the digits where the sine is small.
            assert!((step - 2.0 * 0.02 * w * sine).abs() < 1e-4, "{degrees} degrees: {step}");
        }
        let without = LightPlan { bias: BIAS_SLOPE, ..light };
        assert_eq!(normal_step(&without, &view, Vec3::ZERO, Vec3::X, 5.0), 0.0);
    }

    #[test]
    fn a_length_in_metres_is_that_length_at_every_distance() {
        let bounds = Aabb::new(Vec3::splat(-5.0), Vec3::splat(5.0));
        let view = spot_view(Vec3::new(2.0, 12.0, 1.0), Vec3::new(-0.1, -1.0, 0.0), 0.7, f64::INFINITY, &[bounds], 512, 2);
        let plan = ViewPlan {
            depth_factor: view.depth_scale.factor as f32,
            w_per_metre: view.depth_scale.w_per_metre as f32,
            ..ViewPlan::default()
        };
        for w in [3.0_f32, 8.0, 16.0] {
            let depth = |distance: f64| {
                let clip = view.clip_from_view * DVec4::new(0.0, 0.0, -distance, 1.0);
                clip.z / clip.w
            };
            let expected = depth(f64::from(w)) - depth(f64::from(w) - 0.1);
            let bias = f64::from(metres_to_depth(&plan, w, w, 0.1));
            // f32 rounds the factor, w - 0.1 and the quotient.
            assert!((bias - expected).abs() < 1e-6 * expected, "{bias} {expected}");
        }
        assert_eq!(metres_to_depth(&plan, 2.0, 2.0, 2.0), MAX_DEPTH_BIAS, "the length reaches back to the light");
    }
}
