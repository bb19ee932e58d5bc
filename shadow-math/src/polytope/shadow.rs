//! The shadow volume of a box.

use glam::DVec4;

use super::box_planes;
use crate::bounds::Aabb;

/// The most planes of a box's shadow volume: three faces that face the light, and the six edges of a hexagonal outline.
pub const MAX_SHADOW_PLANES: usize = 9;

/// The planes of all that a box can shadow, and how many they are: the points from which the way to the light meets the box.
///
/// The light is homogeneous: `(position, 1)` in metres relative to the scene's origin, or `(direction toward the light, 0)` of any length above 0.
/// The planes are `(normal, offset)` with `dot(normal, point) + offset >= 0` inside, the normals of any length. A light in the box gives none, for
/// every way to it ends in the box. An empty box, which shadows nothing, gives none either: ask [`Aabb::is_empty`] first.
///
/// The volume is the box drawn out away from the light. What bounds it are the faces that have the light strictly on their outer side,
/// and the planes through the light and each edge of the box's outline, that is between a face of that kind and one that is not. Such a plane is
/// the sum of the planes of the edge's two faces with weights that make it vanish at the light: as one has the light outside and the other does not,
/// both weights can be taken at least 0, so that the box lies on the sum's inner side. Nothing in this needs the box to be solid.
#[must_use]
pub fn shadow_planes(bounds: Aabb, light: DVec4) -> ([DVec4; MAX_SHADOW_PLANES], usize) {
    let mut planes = [DVec4::ZERO; MAX_SHADOW_PLANES];
    let mut count = 0;
    if bounds.is_empty() {
        return (planes, count);
    }
    let faces = box_planes(bounds);
    let sides = faces.map(|face| face.dot(light));
    for (face, side) in faces.into_iter().zip(sides) {
        if side < 0.0 {
            planes[count] = face;
            count += 1;
            for (neighbour, other_side) in faces.into_iter().zip(sides) {
                // The opposite face is parallel and has no edge with this one.
                let is_opposite = (neighbour.truncate() + face.truncate()).abs().max_element() == 0.0;
                if other_side >= 0.0 && !is_opposite {
                    planes[count] = other_side * face - side * neighbour;
                    count += 1;
                }
            }
        }
    }
    (planes, count)
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DVec3, Vec3};
    use proptest::prelude::*;

    use super::*;
    use crate::polytope::Polytope;

    /// Whether the way from a point, to its end or for ever, meets a box (by slabs).
    fn meets(bounds: Aabb, from: DVec3, way: DVec3, is_finite: bool) -> bool {
        let (mut begin, mut end) = (0.0_f64, if is_finite { 1.0 } else { f64::INFINITY });
        for axis in 0..3 {
            let (low, high) = (f64::from(bounds.min[axis]) - from[axis], f64::from(bounds.max[axis]) - from[axis]);
            if way[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
            } else {
                let (a, b) = (low / way[axis], high / way[axis]);
                (begin, end) = (begin.max(a.min(b)), end.min(a.max(b)));
            }
        }
        begin <= end
    }

    proptest! {
        /// What the volume is defined by, point by point, with the way to the light tried against the box by slabs.
        #[test]
        fn shadow_planes_hold_the_points_whose_way_to_the_light_meets_the_box(
            center in prop::array::uniform3(-1.0..1.0_f64),
            half in prop::array::uniform3(prop_oneof![3 => 0.01..1.0_f64, 1 => Just(0.0)]),
            light in prop::array::uniform3(prop_oneof![4 => -4.0..4.0_f64, 1 => Just(0.0)]),
            is_position in any::<bool>(),
            samples in prop::collection::vec(prop::array::uniform3(prop_oneof![4 => -5.0..5.0_f64, 1 => Just(0.0)]), 100),
        ) {
            let (center, half) = (DVec3::from(center), DVec3::from(half));
            let bounds = Aabb::new((center - half).as_vec3(), (center + half).as_vec3());
            let light = DVec3::from(light);
            if !is_position && light == DVec3::ZERO {
                return Ok(());
            }
            let (planes, count) = shadow_planes(bounds, light.extend(f64::from(u8::from(is_position))));
            for sample in samples {
                let point = DVec3::from(sample);
                let way = if is_position { light - point } else { light };
                let distance = |plane: &DVec4| plane.dot(point.extend(1.0)) / plane.truncate().length();
                let nearest = planes[..count].iter().map(distance).fold(f64::INFINITY, f64::min);
                // Rounding decides about points on the surface: a hundred times that of coordinates below 10 m, as planes tilt a little where the light is
                // close to an edge. The planes of a box that is flat toward the light hold its shadow between them, and all of that is surface.
                if nearest.abs() > 1e-12 {
                    prop_assert_eq!(nearest > 0.0, meets(bounds, point, way, is_position), "{} and {}", point, nearest);
                }
            }
        }
    }

    #[test]
    fn a_light_in_the_box_bounds_no_shadow_and_one_above_it_five_faces() {
        let bounds = Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0));
        assert_eq!(shadow_planes(bounds, DVec4::new(0.5, -1.0, 1.0, 1.0)).1, 0);
        assert_eq!(shadow_planes(Aabb::EMPTY, DVec4::Y).1, 0);
        assert_eq!(shadow_planes(bounds, DVec4::new(0.0, 2.0, 0.0, 1.0)).1, 5);
        assert_eq!(shadow_planes(bounds, DVec4::new(1.0, 2.0, 3.0, 0.0)).1, MAX_SHADOW_PLANES);
        let (planes, count) = shadow_planes(bounds, DVec4::Y);
        assert_eq!(count, 5);
        let mut body = Polytope::from_bounds(Aabb::new(Vec3::splat(-9.0), Vec3::splat(9.0)));
        planes[..count].iter().for_each(|plane| body.clip(*plane));
        assert_eq!(body.transformed(DMat4::IDENTITY), (DVec3::new(-1.0, -9.0, -1.0), DVec3::splat(1.0)));
    }
}
