//! The near and far planes of a light's camera, from the casters.
//!
//! The planes lie just outside the bounds of what can cast a shadow.
//! A light inside the bounds of a caster has no distance to it that the bounds could tell; then, and wherever the nearest
//! caster is closer still, the near plane lies at [`MIN_NEAR_SHARE`] of the far plane's distance. What is nearer to the light
//! than that casts no shadow, and is lit.

use glam::{DMat4, DVec3};

use super::Window;
use crate::{bounds::Aabb, polytope::Polytope, rounding::UNIT_ROUNDOFF};

/// The near plane of a perspective view lies at least at this share of the far plane's distance.
///
/// Depth z / w loses `far / near` times its precision at the far plane: at 1/1024 a step of 32-bit depth is `2^-14` of the far distance, 1.2 mm at
/// 20 m, and the [bound on rounding](crate::rounding) is some twenty steps: 2 to 3 cm there, falling with the square of the distance. three.js
/// uses 1/1000 for its point lights.
pub const MIN_NEAR_SHARE: f64 = 1.0 / 1024.0;

/// By what share of itself a range is widened at either end, so that no caster is clipped by the rounding of its depth.
pub const RANGE_MARGIN: f64 = 1.0 / 1024.0;

/// What lies before a light by less than this share of the sizes around it is there by rounding: a light that touches a box sees nothing of the side that it touches.
///
/// The corners of cut bodies are off by 2^-42 of their size ([`Polytope::clip`]), measured across the plane that cuts: a box whose side the light lies in is met by a plane along that side a thousand times as far
/// from where it should be.
const TOUCHING: f64 = 1.0 / (1_u64 << 32) as f64;

/// The distance up to which something counts as touching a light at `eye`, where there are bodies with a size up to `largest`, in metres.
///
/// Positions are given in single precision: what is nearer to the light than that tells has no distance.
pub(super) fn touching_distance(eye: DVec3, largest: f64) -> f64 {
    UNIT_ROUNDOFF * eye.length() + TOUCHING * largest
}

/// The distances of the near and far planes from the eye along the view axis, in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// The near plane; 0 for an orthographic view, whose eye lies on it.
    pub near: f64,
    /// The far plane.
    pub far: f64,
}

/// The distance in the maximum norm between a point and a box, in metres: 0 inside.
///
/// Of the six faces of a cube around the point, the one that looks at the box sees no part of it nearer than this along its axis.
#[must_use]
pub fn distance_to_box(point: DVec3, bounds: Aabb) -> f64 {
    let gap = (bounds.min.as_dvec3() - point).max(point - bounds.max.as_dvec3());
    gap.max(DVec3::ZERO).max_element()
}

/// The range of a perspective view: from the nearest to the farthest point of the casters' bounds within it.
///
/// `image` is what the view has of the plane at a distance of 1 m, in metres; `limit` is the distance beyond which nothing is to be shadowed, infinite for none.
/// Without a caster in view, the range lies around 1 m, or the limit if that is nearer: the map then stays empty and everything is lit.
///
/// Each caster's box is turned into view space and cut by the four sides of the view there, so that neither the distance from the scene's origin nor a narrow image costs digits.
#[must_use]
pub fn range_in_view(world_from_view: DMat4, image: Window, casters: &[Aabb], limit: f64) -> DepthRange {
    let view_from_world = world_from_view.inverse();
    let Window { min, max } = image;
    let sides =
        [DVec3::new(1.0, 0.0, min.x), DVec3::new(-1.0, 0.0, -max.x), DVec3::new(0.0, 1.0, min.y), DVec3::new(0.0, -1.0, -max.y)];
    let eye = world_from_view.w_axis.truncate();
    let mut near = f64::INFINITY;
    let mut far = 0.0_f64;
    for caster in casters.iter().filter(|caster| !caster.is_empty()) {
        let turned = TurnedBox::of(*caster, view_from_world);
        let [nearest, farthest] = turned.extent_along(DVec3::NEG_Z);
        let touching = touching_distance(eye, turned.center.length());
        // What changes nothing need not be cut.
        if farthest <= touching || nearest.max(0.0) >= near && farthest <= far {
            continue;
        }
        let ranges = sides.map(|side| turned.extent_along(side));
        if ranges.iter().any(|range| range[1] < 0.0) {
            continue;
        }
        if nearest > 0.0 && ranges.iter().all(|range| range[0] >= 0.0) {
            near = near.min(nearest);
            far = far.max(farthest);
            continue;
        }
        let mut seen = Polytope::from_parallelepiped(turned.corners());
        for side in sides {
            seen.clip(side.extend(0.0));
        }
        let (nearest, farthest) = seen.extent_along(DVec3::NEG_Z);
        if farthest > touching {
            near = near.min(nearest.max(0.0));
            far = far.max(farthest);
        }
    }
    widened(near, far, limit)
}

/// A box in another space, whose axes need not lie along those of the space.
struct TurnedBox {
    center: DVec3,
    /// From the centre to the middles of three faces.
    halves: [DVec3; 3],
}

impl TurnedBox {
    /// A box that is not empty, by an affine matrix.
    fn of(bounds: Aabb, to_from_world: DMat4) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let half = 0.5 * (max - min);
        let axis = |i: usize| to_from_world.col(i).truncate() * half[i];
        Self { center: to_from_world.transform_point3(0.5 * (min + max)), halves: [axis(0), axis(1), axis(2)] }
    }

    /// The least and the greatest `dot(direction, point)` of its points.
    fn extent_along(&self, direction: DVec3) -> [f64; 2] {
        let (middle, reach) =
            (direction.dot(self.center), self.halves.iter().map(|half| direction.dot(*half).abs()).sum::<f64>());
        [middle - reach, middle + reach]
    }

    /// The corners, in the order of [`Aabb::corners`].
    fn corners(&self) -> [DVec3; 8] {
        core::array::from_fn(|i| {
            let sign = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            self.center + self.halves[0] * sign(0) + self.halves[1] * sign(1) + self.halves[2] * sign(2)
        })
    }
}

/// Between which heights over a plane across parallel light, toward the light and in metres, there are casters whose shadows can fall into a rectangle of its image: `[lowest, highest]`; `None` without any.
///
/// Each caster counts with its box in light space, as high as it is anywhere: a plain test for each of many casters, and never too narrow.
#[must_use]
pub fn heights_of_casters(view_from_world: DMat4, image: Window, casters: &[Aabb]) -> Option<[f64; 2]> {
    let mut heights = [f64::INFINITY, f64::NEG_INFINITY];
    for caster in casters.iter().filter(|caster| !caster.is_empty()) {
        let turned = TurnedBox::of(*caster, view_from_world);
        let reach = turned.halves.iter().fold(DVec3::ZERO, |reach, half| reach + half.abs());
        let (min, max) = (turned.center - reach, turned.center + reach);
        let meets = min.truncate().cmple(image.max).all() && max.truncate().cmpge(image.min).all();
        if meets {
            heights = [heights[0].min(min.z), heights[1].max(max.z)];
        }
    }
    (heights[0] <= heights[1]).then_some(heights)
}

/// Between which heights along a unit vector toward parallel light, in metres, there are casters, wherever they are: `[lowest, highest]`; `None` without any.
#[must_use]
pub fn heights_along(toward_light: DVec3, casters: &[Aabb]) -> Option<[f64; 2]> {
    let mut heights = [f64::INFINITY, f64::NEG_INFINITY];
    for caster in casters.iter().filter(|caster| !caster.is_empty()) {
        let (min, max) = (caster.min.as_dvec3(), caster.max.as_dvec3());
        let (middle, reach) = (toward_light.dot(0.5 * (min + max)), toward_light.abs().dot(0.5 * (max - min)));
        heights = [heights[0].min(middle - reach), heights[1].max(middle + reach)];
    }
    (heights[0] <= heights[1]).then_some(heights)
}

/// The common range of the six faces of a cube around `position`.
///
/// `limit` is the light's range in metres, infinite for none.
#[must_use]
pub fn range_around_point(position: DVec3, casters: &[Aabb], limit: f64) -> DepthRange {
    let mut near = f64::INFINITY;
    let mut far = 0.0_f64;
    for caster in casters.iter().filter(|caster| !caster.is_empty()) {
        near = near.min(distance_to_box(position, *caster));
        for corner in caster.corners() {
            far = far.max((corner.as_dvec3() - position).abs().max_element());
        }
    }
    widened(near, far, limit)
}

/// Applies the limit, the margin and the near rule.
fn widened(near: f64, far: f64, limit: f64) -> DepthRange {
    let far = if far > 0.0 { far.min(limit) } else { limit.min(1.0) } * (1.0 + RANGE_MARGIN);
    let nearest = far * MIN_NEAR_SHARE;
    // The upper bound keeps a range where the nearest caster is also the farthest, or lies beyond the limit.
    let farthest = far * (1.0 - RANGE_MARGIN);
    DepthRange { near: (near * (1.0 - RANGE_MARGIN)).max(nearest).min(farthest), far }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, Vec3};

    use super::*;

    fn square(half: f64) -> Window {
        Window { min: DVec2::splat(-half), max: DVec2::splat(half) }
    }

    #[test]
    fn the_range_encloses_the_casters_in_view() {
        let caster = Aabb::new(Vec3::new(-1.0, -1.0, -6.0), Vec3::new(1.0, 1.0, -4.0));
        let behind = Aabb::new(Vec3::new(-1.0, -1.0, 3.0), Vec3::new(1.0, 1.0, 5.0));
        let aside = Aabb::new(Vec3::new(50.0, -1.0, -1.0), Vec3::new(52.0, 1.0, -0.5));
        let range = range_in_view(DMat4::IDENTITY, square(1.0), &[caster, behind, aside], f64::INFINITY);
        assert!(range.near < 4.0 && range.near > 3.99 && range.far > 6.0 && range.far < 6.01, "{range:?}");
    }

    /// A floor that reaches behind the lamp is cut to what the lamp sees of it.
    #[test]
    fn a_large_caster_counts_only_where_it_is_seen() {
        let floor = Aabb::new(Vec3::new(-100.0, -2.1, -100.0), Vec3::new(100.0, -2.0, 100.0));
        let range = range_in_view(DMat4::IDENTITY, square(0.5), &[floor], 40.0);
        // The lower edge of a view that widens by 0.5 a metre meets the floor 2 m below after 4 m.
        assert!(range.near < 4.0 && range.near > 3.99, "{range:?}");
    }

    #[test]
    fn a_light_inside_a_caster_takes_the_near_rule() {
        let around = Aabb::new(Vec3::splat(-3.0), Vec3::splat(3.0));
        for range in [
            range_in_view(DMat4::IDENTITY, square(1.0), &[around], f64::INFINITY),
            range_around_point(DVec3::ZERO, &[around], f64::INFINITY),
        ] {
            assert!(range.near <= range.far * MIN_NEAR_SHARE * (1.0 + 1e-9), "{range:?}");
            assert!(range.far > 3.0, "{range:?}");
        }
    }

    #[test]
    fn the_lights_own_range_bounds_the_far_plane() {
        let caster = Aabb::new(Vec3::new(-1.0, -1.0, -60.0), Vec3::new(1.0, 1.0, -40.0));
        let range = range_in_view(DMat4::IDENTITY, square(1.0), &[caster], 10.0);
        assert!(range.near < range.far && range.far <= 10.0 * (1.0 + RANGE_MARGIN), "{range:?}");
    }

    #[test]
    fn no_caster_still_gives_a_range() {
        let nothing = range_in_view(DMat4::IDENTITY, square(1.0), &[], f64::INFINITY);
        for range in [nothing, range_around_point(DVec3::ZERO, &[Aabb::EMPTY], 0.5)] {
            assert!(range.near > 0.0 && range.near < range.far && range.far.is_finite(), "{range:?}");
        }
    }
}
