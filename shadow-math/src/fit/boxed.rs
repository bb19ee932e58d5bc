//! Views of a window of a light's image: the fits without a warp.

use glam::{DMat4, DVec2, DVec3, dcamera::rh};

use super::{
    DepthRange, FitOutcome, LightFrame, RANGE_MARGIN, ViewFit, Window,
    depth_range::touching_distance,
    guard_scale, heights_of_casters, range_in_view,
    uniform::{MIN_EXTENT_SHARE, MIN_RADIUS},
};
use crate::{
    bounds::Aabb,
    depth::DepthScale,
    polytope::MAX_VERTICES,
    rectangle::{convex_hull, smallest_rectangle},
};

/// The most points of a [`Content`]: the vertices of two bodies.
pub const MAX_POINTS: usize = 2 * MAX_VERTICES;

/// What a view is to show.
#[derive(Clone, Copy, Debug)]
pub struct Content<'a> {
    /// The points of a convex body in world space, before the light: its image has to be in the map.
    pub points: &'a [DVec3],
    /// Points of a convex body as well, of which some may be looked up where the map happens to have them: their depths have to be in it. None for those above alone.
    pub others: &'a [DVec3],
    /// The bounds of what can cast a shadow.
    pub casters: &'a [Aabb],
}

impl<'a> Content<'a> {
    /// A body and the casters that can shadow it.
    #[must_use]
    pub const fn new(points: &'a [DVec3], casters: &'a [Aabb]) -> Self {
        Self { points, others: &[], casters }
    }

    /// The least and the greatest height over a plane across a light's axis, toward the light and in metres, of what may be looked up; `[infinity, -infinity]` for nothing.
    pub(super) fn heights(&self, view_from_world: DMat4) -> [f64; 2] {
        let heights = self.points.iter().chain(self.others).map(|&point| view_from_world.transform_point3(point).z);
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[lowest, highest], z| [lowest.min(z), highest.max(z)])
    }
}

/// The view of the smallest rectangle, with sides along the frame's axes, around the image of some points.
///
/// `guard` texels of the `size` stay free on every side. Depth reaches from the nearest caster whose shadow can fall into the rectangle to the farthest of the points. No points give
/// [`FitOutcome::NothingVisible`].
#[must_use]
pub fn boxed_view(frame: &LightFrame, content: &Content<'_>, size: u32, guard: u32) -> ViewFit {
    let view_from_world = frame.view_from_world();
    let seen = content.points.iter().map(|&point| view_from_world.transform_point3(point));
    let Some(image) = Window::around(seen.map(|point| frame.image(point))) else {
        return nothing_visible(frame, size);
    };
    rectangle_view(frame, image, content, size, guard)
}

/// The view of the smallest rectangle, turned as need be, around the image of some points.
///
/// As [`boxed_view`]; the rectangle's longer side lies along the image's x axis. At most [`MAX_POINTS`] points count.
#[must_use]
pub fn focused_view(frame: &LightFrame, content: &Content<'_>, size: u32, guard: u32) -> ViewFit {
    let view_from_world = frame.view_from_world();
    let mut images = [DVec2::ZERO; MAX_POINTS];
    let count = content.points.len().min(MAX_POINTS);
    for (image, point) in images.iter_mut().zip(content.points) {
        *image = frame.image(view_from_world.transform_point3(*point));
    }
    let mut hull = [DVec2::ZERO; MAX_POINTS];
    let corners = convex_hull(&mut images[..count], &mut hull);
    if corners == 0 {
        return nothing_visible(frame, size);
    }
    let rectangle = smallest_rectangle(&hull[..corners]);
    // The image's x axis is the y axis turned back by a quarter.
    let frame = frame.rolled(rectangle.axis.perp());
    boxed_view(&frame, content, size, guard)
}

/// A view of a frame in which nothing is seen.
pub(super) fn nothing_visible(frame: &LightFrame, size: u32) -> ViewFit {
    let image = Window { min: DVec2::NEG_ONE, max: DVec2::ONE };
    ViewFit { outcome: FitOutcome::NothingVisible, ..rectangle_view(frame, image, &Content::new(&[], &[]), size, 0) }
}

/// The view of a rectangle of the image; depth reaches as far as the content.
pub(super) fn rectangle_view(frame: &LightFrame, image: Window, content: &Content<'_>, size: u32, guard: u32) -> ViewFit {
    let view_from_world = frame.view_from_world();
    let heights = content.heights(view_from_world);
    let image = with_extent(frame, image).scaled(guard_scale(size, guard));
    if frame.is_perspective {
        perspective_rectangle(frame, view_from_world, image, -heights[0], content.casters, size)
    } else {
        parallel_rectangle(frame, view_from_world, image, heights, content.casters, size)
    }
}

/// Half the width and height that an image has at least, in its own units: below, there is no telling it from rounding.
pub(super) fn least_extent(frame: &LightFrame) -> f64 {
    // A tangent is a length at a distance of 1 m.
    if frame.is_perspective { MIN_EXTENT_SHARE * 1e-3 } else { MIN_RADIUS }
}

/// A rectangle that is at least wide and high enough to be inverted.
fn with_extent(frame: &LightFrame, image: Window) -> Window {
    let half = image.half();
    let least = (MIN_EXTENT_SHARE * half.max_element()).max(least_extent(frame));
    let (center, half) = (image.center(), half.max(DVec2::splat(least)));
    Window { min: center - half, max: center + half }
}

/// The view of a rectangle of a light at a place, as deep as its casters are, and no deeper than `farthest`.
fn perspective_rectangle(
    frame: &LightFrame,
    view_from_world: DMat4,
    image: Window,
    farthest: f64,
    casters: &[Aabb],
    size: u32,
) -> ViewFit {
    let is_before = farthest > touching_distance(frame.eye, 0.0) && farthest.is_finite();
    let limit = if is_before { frame.limit.min(farthest) } else { frame.limit };
    let world_from_view = DMat4::from_rotation_translation(frame.rotation, frame.eye);
    let range = range_in_view(world_from_view, image, casters, limit);
    let Window { min, max } = image;
    let n = range.near;
    let texel = (max - min) / f64::from(size);
    ViewFit {
        view_from_world,
        clip_from_view: rh::proj::directx::frustum(min.x * n, max.x * n, min.y * n, max.y * n, n, range.far),
        range,
        depth_scale: DepthScale::perspective(n, range.far),
        texel_metres: texel.to_array(),
        ..ViewFit::unwarped(size)
    }
}

/// The view of a rectangle of parallel light, from the highest caster to the lowest point.
fn parallel_rectangle(
    frame: &LightFrame,
    view_from_world: DMat4,
    image: Window,
    [lowest, highest]: [f64; 2],
    casters: &[Aabb],
    size: u32,
) -> ViewFit {
    let of_casters = heights_of_casters(view_from_world, image, casters);
    let [top, bottom] = depth_of_heights(of_casters, [lowest, highest], image.half().max_element());
    let center = image.center();
    let depth = top - bottom;
    let eye = frame.rotation * center.extend(top);
    let half = image.half();
    ViewFit {
        view_from_world: super::uniform::rigid_inverse(frame.rotation, eye),
        clip_from_view: rh::proj::directx::orthographic(-half.x, half.x, -half.y, half.y, 0.0, depth),
        range: DepthRange { near: 0.0, far: depth },
        depth_scale: DepthScale::orthographic(depth),
        texel_metres: (2.0 * half / f64::from(size)).to_array(),
        ..ViewFit::unwarped(size)
    }
}

/// The heights at which a parallel view begins and ends: from the highest caster to the lowest receiver or caster, whichever is higher, since what lies below the last caster is compared there.
pub(super) fn depth_of_heights(casters: Option<[f64; 2]>, receivers: [f64; 2], extent: f64) -> [f64; 2] {
    let [lowest, highest] = if receivers[0].is_finite() && receivers[1].is_finite() { receivers } else { [0.0, 0.0] };
    let [lowest_caster, highest_caster] = casters.unwrap_or([lowest, highest]);
    let bottom = lowest.max(lowest_caster);
    let depth = (highest_caster - bottom).max(MIN_EXTENT_SHARE * extent).max(MIN_RADIUS);
    let margin = RANGE_MARGIN * depth;
    [bottom + depth + margin, bottom - margin]
}
