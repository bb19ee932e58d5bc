//! What a frustum and a box have in common by another way: each one's faces, clipped by the planes of the other.

use std::vec::Vec;

use glam::{DVec3, DVec4};

use crate::{bounds::Aabb, frustum::Frustum, polytope::box_planes};

/// The corners of a frustum's or box's faces, in the order of [`Frustum::faces`].
fn solid(bounds: Aabb) -> Frustum {
    let [a, b, c, d, e, f, g, h] = bounds.corners().map(|corner| corner.as_dvec3());
    // Corners of a box count x in the first bit, y in the second and z in the third.
    Frustum { corners: [h, g, e, f, d, c, a, b] }
}

/// The part of a convex polygon where all planes are `dot(normal, point) + offset >= 0` (Sutherland and Hodgman 1974). It knows no tolerance.
fn clip_face(face: [DVec3; 4], planes: &[DVec4; 6]) -> Vec<DVec3> {
    planes.iter().fold(face.to_vec(), |polygon, plane| {
        let mut clipped = Vec::new();
        for (i, &from) in polygon.iter().enumerate() {
            let to = polygon[(i + 1) % polygon.len()];
            let [from_distance, to_distance] = [from, to].map(|point| plane.dot(point.extend(1.0)));
            if from_distance >= 0.0 {
                clipped.push(from);
            }
            if (from_distance >= 0.0) != (to_distance >= 0.0) {
                clipped.push(from + (to - from) * (from_distance / (from_distance - to_distance)));
            }
        }
        clipped
    })
}

/// Points whose hull is what a frustum and a box have in common; none if they do not meet. A corner comes up once for every face it lies on.
pub(super) fn common_points(frustum: &Frustum, bounds: Aabb) -> Vec<DVec3> {
    let of_frustum = frustum.faces().into_iter().flat_map(|face| clip_face(face, &box_planes(bounds)));
    let of_box = solid(bounds).faces().into_iter().flat_map(|face| clip_face(face, &frustum.planes()));
    of_frustum.chain(of_box).collect()
}
