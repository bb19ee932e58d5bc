//! The uniform fit: the whole reach of the light, whatever the camera sees.

use glam::{DMat4, DQuat, DVec2, DVec3, Vec3, dcamera::rh};

use super::{DepthRange, RANGE_MARGIN, ViewFit, Window, guard_scale, range_in_view};
use crate::{bounds::Aabb, camera::world_from_view_rotation, depth::DepthScale};

/// The smallest extent of a directional light's box on an axis, as a share of the bounds' radius: a scene without
/// thickness, seen edge-on, still gets a box that can be inverted.
pub(super) const MIN_EXTENT_SHARE: f64 = 1e-3;

/// A radius below this, in metres, is taken for it.
pub(super) const MIN_RADIUS: f64 = 1e-6;

/// The camera of a directional light: the box, in light space, of the scene's bounds.
///
/// `direction` is the way the light travels, of any length above 0; `bounds`, not empty, is in metres relative to the scene's
/// origin; `guard` texels of the `size` stay free on every side. The eye lies on the near plane in the middle of the box.
/// The box is as wide and as high as the bounds are seen from the light, so texels need not be square.
///
/// Depth is affine in position, and the matrix is orthographic: `w` is exactly 1.
#[must_use]
pub fn directional_view(direction: Vec3, bounds: Aabb, size: u32, guard: u32) -> ViewFit {
    let rotation = world_from_view_rotation(direction.as_dvec3().normalize());
    let (min, max) = bounds.transformed(DMat4::from_quat(rotation.inverse()));
    let radius = f64::from(bounds.radius()).max(MIN_RADIUS);
    let extent = (max - min).max(DVec3::splat(MIN_EXTENT_SHARE * radius));
    let center = 0.5 * (min + max);
    let depth = extent.z * (1.0 + 2.0 * RANGE_MARGIN);
    let eye = rotation * DVec3::new(center.x, center.y, center.z + 0.5 * depth);
    let half = 0.5 * guard_scale(size, guard) * extent;
    ViewFit {
        view_from_world: rigid_inverse(rotation, eye),
        clip_from_view: rh::proj::directx::orthographic(-half.x, half.x, -half.y, half.y, 0.0, depth),
        range: DepthRange { near: 0.0, far: depth },
        depth_scale: DepthScale::orthographic(depth),
        texel_metres: [2.0 * half.x / f64::from(size), 2.0 * half.y / f64::from(size)],
        ..ViewFit::unwarped(size)
    }
}

/// The camera of a spot light: the pyramid around its cone.
///
/// `direction` is the axis, the way the light travels; `outer_angle`, in radians, is the angle from it to the cone's edge, above
/// 0 and at most [`MAX_SINGLE_MAP_OUTER_ANGLE`](crate::light::MAX_SINGLE_MAP_OUTER_ANGLE); `limit` is the light's range in metres.
#[must_use]
pub fn spot_view(
    position: Vec3,
    direction: Vec3,
    outer_angle: f64,
    limit: f64,
    casters: &[Aabb],
    size: u32,
    guard: u32,
) -> ViewFit {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    let rotation = world_from_view_rotation(direction.as_dvec3().normalize());
    let half_width = outer_angle.tan() * guard_scale(size, guard);
    let world_from_view = DMat4::from_rotation_translation(rotation, position.as_dvec3());
    let image = Window { min: DVec2::splat(-half_width), max: DVec2::splat(half_width) };
    let range = range_in_view(world_from_view, image, casters, limit);
    perspective_view(rigid_inverse(rotation, position.as_dvec3()), half_width, range, size)
}

/// A square perspective view; `half_width` is half the width of its image at a distance of 1 m, in metres.
pub(super) fn perspective_view(view_from_world: DMat4, half_width: f64, range: DepthRange, size: u32) -> ViewFit {
    let half = half_width * range.near;
    let texel = 2.0 * half_width / f64::from(size);
    ViewFit {
        view_from_world,
        clip_from_view: rh::proj::directx::frustum(-half, half, -half, half, range.near, range.far),
        range,
        depth_scale: DepthScale::perspective(range.near, range.far),
        texel_metres: [texel, texel],
        ..ViewFit::unwarped(size)
    }
}

/// The inverse of a rotation followed by a translation, without the general inverse's rounding.
pub(super) fn rigid_inverse(rotation: DQuat, translation: DVec3) -> DMat4 {
    let inverse = rotation.inverse();
    DMat4::from_rotation_translation(inverse, -(inverse * translation))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_corner_of_the_bounds_lies_in_the_box_and_some_on_its_guarded_rim() {
        let bounds = Aabb::new(Vec3::new(-7.0, 0.0, -2.0), Vec3::new(1.0, 3.0, 5.0));
        for direction in [Vec3::new(0.3, -1.0, 0.2), Vec3::NEG_Y, Vec3::X, Vec3::new(1e-9, -2.0, 0.0)] {
            let view = directional_view(direction, bounds, 512, 2);
            let clip_from_world = view.clip_from_world();
            let mut reach = DVec3::ZERO;
            for corner in bounds.corners() {
                let ndc = clip_from_world.project_point3(corner.as_dvec3());
                assert!((0.0..=1.0).contains(&ndc.z), "{direction}: {ndc}");
                reach = reach.max(ndc.abs());
            }
            let rim = 1.0 - 2.0 * 2.0 / 512.0;
            // The corners touch the guard band: not a texel is wasted. Rounding of f64.
            assert!((reach.x - rim).abs() < 1e-9 && (reach.y - rim).abs() < 1e-9, "{direction}: {reach}");
        }
    }

    #[test]
    fn depth_grows_along_the_light() {
        let view = directional_view(Vec3::NEG_Y, Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0)), 64, 2);
        let depth = |y: f64| view.clip_from_world().project_point3(DVec3::new(0.2, y, -0.3)).z;
        assert!(depth(-1.0) > depth(1.0));
        let metre = depth(-1.0) - depth(0.0);
        assert!((metre - view.depth_scale.depth_of_metres(1.0, 1.0)).abs() < 1e-12);
    }

    #[test]
    fn the_spots_cone_touches_the_guard_band() {
        let caster = Aabb::new(Vec3::new(-1.0, -1.0, -9.0), Vec3::new(1.0, 1.0, -3.0));
        let outer = 0.6_f64;
        let view = spot_view(Vec3::ZERO, Vec3::NEG_Z, outer, f64::INFINITY, &[caster], 256, 2);
        let on_cone = DVec3::new(outer.tan() * 5.0, 0.0, -5.0);
        let ndc = view.clip_from_world().project_point3(on_cone);
        assert!((ndc.x - (1.0 - 4.0 / 256.0)).abs() < 1e-12, "{ndc}");
        assert!(view.range.near < 3.0 && view.range.far > 9.0);
    }
}
