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
