//! Light-space perspective shadow maps: what is near to the camera has more of the samples.
//!
//! The light's image is warped by a perspective of its own, whose axis lies in the image along the camera's view, so that rays of light stay parallel: they have one w each. With `Y` the image's coordinate toward
//! the camera and `D` the light's own depth, a point goes to
//!
//! ```text
//! w = (Y_0 + n - Y) / n,   x = X / w,   y = a + b / w,   depth = c D / w
//! ```
//!
//! where `Y_0` is the end of the body nearest to the camera, at which w is 1, and n is the parameter: the distance from there to the perspective's centre, in the image's units. Small ones warp most.
//!
//! The best n for a plane below the camera is `(z_n + sqrt(z_n z_f)) / s` (Wimmer, Scherzer and Purgathofer 2004, section 4, with the correction of 2006): `z_n` and `z_f` are the least and greatest
//! distances from the camera of what is seen, and s says how fast that distance grows along the image's axis: the sine of the angle between view and light for parallel light, in whose image lengths are metres, and
//! that times the distance from the light for a light at a place. It grows without bound as the camera turns to look along the light: the warp fades away.

use glam::{DMat4, DVec2, DVec3, DVec4};

use super::{
    DepthRange, Eye, FallBack, LightFrame, RANGE_MARGIN, ViewFit, Window,
    boxed::{Content, boxed_view, depth_of_heights, least_extent, nothing_visible},
    guard_scale, heights_of_casters, range_in_view,
    uniform::MIN_EXTENT_SHARE,
};
use crate::{depth::DepthScale, rounding::UNIT_ROUNDOFF};

/// The greatest warp parameter, in sizes of the image: beyond it w changes by less than a thousandth, and nothing is warped.
pub const MAX_WARP_PARAMETER: f64 = 1024.0;

/// The least warp parameter, in sizes of the image: w then grows by a factor of a thousand over it, and single precision keeps four digits of what is far away.
const MIN_WARP_PARAMETER: f64 = 1.0 / 1024.0;

/// By what share more than the greatest w of its body a warped view is of use: w is off by up to a sixteenth of 1 ([`least_parameter`]), and lengths along the warp grow with its square.
const FARTHEST_W_MARGIN: f64 = 1.25;

/// The axis and the parameter of a warp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LispsmWarp {
    /// The unit vector of the light's image toward the camera.
    pub toward_camera: DVec2,
    /// The distance from the end of the image nearest to the camera to the perspective's centre, in the image's units; infinite for no warp.
    pub parameter: f64,
}

/// The best warp of a body, given by its points in world space, for a camera.
///
/// # Errors
///
/// [`FallBack::LightAlongView`] where no direction of the image leads away from the camera.
pub fn optimal_warp(frame: &LightFrame, eye: &Eye<'_>, points: &[DVec3]) -> Result<LispsmWarp, FallBack> {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    /// The sine of the least angle between view and light that has a direction: single precision, in which lights are given, tells no less.
    const MIN_SINE: f64 = 4.0 * f32::EPSILON as f64;
    let along = frame.rotation.inverse() * eye.camera.direction();
    let sine = along.truncate().length();
    if !(sine > MIN_SINE) {
        return Err(FallBack::LightAlongView);
    }
    if matches!(eye.camera.projection, crate::Projection::Orthographic { .. }) {
        // Parallel rays of a camera see everything at one size: no warp is the best.
        return Ok(LispsmWarp { toward_camera: -along.truncate() / sine, parameter: f64::INFINITY });
    }
    let row = eye.distance_row();
    let distances = points.iter().map(|point| row.dot(point.extend(1.0)));
    let [near, far] = distances.fold([f64::INFINITY, 0.0], |[near, far]: [f64; 2], d| [near.min(d), far.max(d)]);
    let near = near.max(eye.planes()[0]).max(far * f64::EPSILON);
    // How fast the distance from the camera grows along the image's axis.
    let growth = if frame.is_perspective {
        let view_from_world = frame.view_from_world();
        let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        sine * -view_from_world.transform_point3(mean).z
    } else {
        sine
    };
    let parameter = (near + (near * far).sqrt()) / growth;
    Ok(LispsmWarp { toward_camera: -along.truncate() / sine, parameter })
}

/// The view of the image of some points under a warp.
///
/// `eye` is the camera's place, or another that the perspective's axis is to go through; `guard` texels of the `size` stay free on every side. The warp's parameter is no less than single precision can tell, and is kept between
/// a thousandth and [`MAX_WARP_PARAMETER`] sizes of the image, and beyond the latter there is none, nor of an image without a size. Depth is 0 at the highest caster, and at most 1 at every point of the body.
#[must_use]
pub fn lispsm_view(frame: &LightFrame, eye: DVec3, warp: LispsmWarp, content: &Content<'_>, size: u32, guard: u32) -> ViewFit {
    let frame = &frame.rolled(warp.toward_camera);
    let view_from_world = frame.view_from_world();
    let of_view = || content.points.iter().map(|&point| view_from_world.transform_point3(point));
    let Some(image) = Window::around(of_view().map(|point| frame.image(point))) else {
        return nothing_visible(frame, size);
    };
    let length = image.max.y - image.min.y;
    let parameter = warp.parameter.max(MIN_WARP_PARAMETER * length).max(least_parameter(frame, view_from_world, content.points));
    if !(parameter < MAX_WARP_PARAMETER * length && length > least_extent(frame)) {
        return boxed_view(frame, content, size, guard);
    }
    // The perspective's axis goes through the camera, so that the sides of its frustum become parallel; where the light has no image of it, through the middle. Another axis shears the map: a camera beside the
    // light, whose image is far away, must not make a line of it.
    let eye = view_from_world.transform_point3(eye);
    let has_image = !frame.is_perspective || eye.z < 0.0;
    let axis_x = if has_image { frame.image(eye).x.clamp(image.min.x, image.max.x) } else { image.center().x };
    let w_of = |y: f64| (image.max.y + parameter - y) / parameter;
    let mut sides = [f64::INFINITY, f64::NEG_INFINITY];
    for point in of_view().map(|point| frame.image(point)) {
        let side = (point.x - axis_x) / w_of(point.y);
        sides = [sides[0].min(side), sides[1].max(side)];
    }
    let farthest_w = w_of(image.min.y);
    let scale = 1.0 / guard_scale(size, guard);
    let half_side = (0.5 * (sides[1] - sides[0])).max(MIN_EXTENT_SHARE * length / farthest_w);
    let middle_side = 0.5 * (sides[0] + sides[1]);
    // The part of the image that the map has, guard bands and all: a trapezoid, whose w is least where y / w is 1 in the map and greatest where it is -1. The guard band of a strong warp can reach beyond its
    // horizon: the map then has all that the light reaches.
    let w_at = |side: f64| 2.0 * farthest_w / ((farthest_w + 1.0) + side * (farthest_w - 1.0) / scale);
    let (least_w, greatest_w) = (w_at(1.0), w_at(-1.0));
    // The square that the light reaches is turned in this frame: its corners are farthest.
    let farthest_image = frame.reach * core::f64::consts::SQRT_2;
    let everywhere = Window { min: DVec2::splat(-farthest_image), max: DVec2::splat(farthest_image) };
    let map = if greatest_w > 0.0 {
        let reach = |w: f64| [-1.0, 1.0].map(|side| axis_x + (middle_side + side * half_side / scale) * w);
        let ([a, b], [c, d]) = (reach(least_w), reach(greatest_w));
        let y_of = |w: f64| image.max.y - parameter * (w - 1.0);
        let (min, max) = (DVec2::new(a.min(c), y_of(greatest_w)), DVec2::new(b.max(d), y_of(least_w)));
        Window { min: min.max(everywhere.min), max: max.min(everywhere.max) }
    } else {
        everywhere
    };
    let light_space = LightSpace::of(frame, view_from_world, map, 0.5 * length, content);

    // Rows over (X, Y, D, 1), homogeneous; D is the light's own depth.
    let w = DVec4::new(0.0, -1.0, 0.0, image.max.y + parameter) / parameter;
    let x = DVec4::new(1.0, 0.0, 0.0, -axis_x);
    let mut depth_factor = f64::INFINITY;
    for point in of_view().map(|point| light_space.of_view(point)).filter(|point| point.z > 0.0) {
        depth_factor = depth_factor.min(w.dot(point) / point.z);
    }
    // Where the others are is not known but for being in the map: w is at least 1 in it, less the guard band.
    for &other in content.others {
        let depth = light_space.of_view(view_from_world.transform_point3(other)).z;
        if depth > 0.0 {
            depth_factor = depth_factor.min(least_w / depth);
        }
    }
    let depth_factor = if depth_factor.is_finite() { depth_factor } else { light_space.deepest.recip() };
    let clip_x = (x - w * middle_side) * (scale / half_side);
    // y / w is 1 where w is 1 and -1 where w is greatest: (2 f / w - f - 1) / (f - 1).
    let clip_y = (DVec4::W * (2.0 * farthest_w) - w * (farthest_w + 1.0)) * (scale / (farthest_w - 1.0));
    let clip_z = DVec4::Z * (depth_factor * (1.0 - RANGE_MARGIN));
    let clip_from_light = DMat4::from_cols(clip_x, clip_y, clip_z, w).transpose();
    let clip_from_view = clip_from_light * light_space.light_from_view;
    let at_center = w_of(image.center().y);
    let distance = if frame.is_perspective { light_space.middle_distance } else { 1.0 };
    let texel_x = 2.0 * at_center * half_side / scale * distance / f64::from(size);
    let texel_y = at_center * at_center * parameter * (farthest_w - 1.0) / (farthest_w * scale) * distance / f64::from(size);
    ViewFit {
        view_from_world,
        clip_from_view,
        range: light_space.range,
        // The light itself is all depth: what its image is under the matrix says how depth grows toward it.
        depth_scale: DepthScale {
            factor: depth_factor * (1.0 - RANGE_MARGIN) * light_space.depth_at_light,
            w_per_metre: if frame.is_perspective { 1.0 } else { 0.0 },
        },
        texel_metres: [texel_x, texel_y],
        is_warped: true,
        farthest_w: farthest_w * FARTHEST_W_MARGIN,
        ..ViewFit::unwarped(size)
    }
}

/// The least warp parameter of which single precision leaves anything: w is the sum of coordinates over it, each off by some roundings of its own size, and must stay near to 1 where it is 1.
fn least_parameter(frame: &LightFrame, view_from_world: DMat4, points: &[DVec3]) -> f64 {
    /// Four roundings of a row, some of its numbers and of the point, and as little as a fifth of w for all.
    const ROUNDINGS: f64 = 64.0;
    let of_point = |point: &DVec3| {
        let largest = point.length() + frame.eye.length();
        let seen = view_from_world.transform_point3(*point);
        if frame.is_perspective { largest * (1.0 + frame.image(seen).length()) / -seen.z } else { largest }
    };
    ROUNDINGS * UNIT_ROUNDOFF * points.iter().map(of_point).fold(0.0, f64::max)
}

/// The space in which a light's rays are parallel: its image, with depth from the highest caster on.
struct LightSpace {
    light_from_view: DMat4,
    range: DepthRange,
    /// The greatest depth in it.
    deepest: f64,
    /// Minus the depth component of the light's own image: what a step toward it takes off.
    depth_at_light: f64,
    /// The distance of the middle of what is seen from a light at a place, in metres.
    middle_distance: f64,
}

impl LightSpace {
    /// The space for what a window of the image can show; `extent` is half the length of the body's own image.
    fn of(frame: &LightFrame, view_from_world: DMat4, image: Window, extent: f64, content: &Content<'_>) -> Self {
        let casters = content.casters;
        let [lowest, highest] = content.heights(view_from_world);
        if frame.is_perspective {
            let world_from_view = DMat4::from_rotation_translation(frame.rotation, frame.eye);
            let range = range_in_view(world_from_view, image, casters, frame.limit.min(-lowest));
            let DepthRange { near, far } = range;
            // As a projection has it: depth (far / (far - near)) (1 - near / distance).
            let slope = far / (far - near);
            let light_from_view = DMat4::from_cols(
                DVec4::X,
                DVec4::Y,
                DVec4::new(0.0, 0.0, -slope, -1.0),
                DVec4::new(0.0, 0.0, -slope * near, 0.0),
            );
            let middle_distance = -0.5 * (lowest + highest);
            return Self { light_from_view, range, deepest: 1.0, depth_at_light: slope * near, middle_distance };
        }
        let of_casters = heights_of_casters(view_from_world, image, casters);
        let [top, bottom] = depth_of_heights(of_casters, [lowest, highest], extent);
        let light_from_view =
            DMat4::from_cols(DVec4::X, DVec4::Y, DVec4::new(0.0, 0.0, -1.0, 0.0), DVec4::new(0.0, 0.0, top, 1.0));
        let range = DepthRange { near: 0.0, far: top - bottom };
        Self { light_from_view, range, deepest: top - bottom, depth_at_light: 1.0, middle_distance: 1.0 }
    }

    /// A point of view space as (X, Y, D, 1).
    fn of_view(&self, point: DVec3) -> DVec4 {
        let point = self.light_from_view * point.extend(1.0);
        point / point.w
    }
}
