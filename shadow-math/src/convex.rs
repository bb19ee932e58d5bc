//! Convex polygons and bodies, clipped without a heap.
//!
//! A plane adds at most one vertex to a convex polygon: it cuts off a run of vertices, at least one, and puts two in
//! their place. A quadrilateral clipped by six planes therefore has at most [`MAX_FACE_VERTICES`] = 4 + 6 vertices, and the
//! twelve faces of two boxes, each clipped by the other's planes, at most [`MAX_BODY_POINTS`].

use glam::{DVec3, DVec4};

use crate::{bounds::Aabb, frustum::Frustum};

/// The most vertices of a quadrilateral clipped by six planes.
pub const MAX_FACE_VERTICES: usize = 4 + 6;
/// The most points of [`intersect`]: twelve faces of [`MAX_FACE_VERTICES`].
pub const MAX_BODY_POINTS: usize = 12 * MAX_FACE_VERTICES;

/// A list of at most `N` points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Points<const N: usize> {
    points: [DVec3; N],
    len: usize,
}

impl<const N: usize> Points<N> {
    const EMPTY: Self = Self { points: [DVec3::ZERO; N], len: 0 };

    /// The points.
    #[must_use]
    pub fn as_slice(&self) -> &[DVec3] {
        &self.points[..self.len]
    }

    fn push(&mut self, point: DVec3) {
        self.points[self.len] = point;
        self.len += 1;
    }
}

/// The part of a convex quadrilateral where all `planes` are `dot(normal, point) + offset >= 0` (Sutherland and Hodgman 1974).
///
/// The quadrilateral must be convex and planar up to rounding; at most six planes, as the capacity's proof needs.
/// Points exactly on a plane are kept. Nothing left gives no points.
#[must_use]
pub fn clip_face(face: [DVec3; 4], planes: &[DVec4; 6]) -> Points<MAX_FACE_VERTICES> {
    let mut polygon = Points::EMPTY;
    for corner in face {
        polygon.push(corner);
    }
    for plane in planes {
        let mut clipped = Points::EMPTY;
        let points = polygon.as_slice();
        // Rounding can make a polygon that is thinner than it cross a plane more than twice. Counting the crossings keeps the
        // proof of the capacity: two are what a convex polygon has.
        let mut crossings = 0;
        for (i, &from) in points.iter().enumerate() {
            let to = points[(i + 1) % points.len()];
            let from_distance = plane.dot(from.extend(1.0));
            let to_distance = plane.dot(to.extend(1.0));
            if from_distance >= 0.0 {
                clipped.push(from);
            }
            if (from_distance >= 0.0) != (to_distance >= 0.0) && crossings < 2 {
                crossings += 1;
                clipped.push(from + (to - from) * (from_distance / (from_distance - to_distance)));
            }
        }
        polygon = clipped;
    }
    polygon
}

/// Points whose convex hull is what a frustum and a box have in common; none if they do not meet.
///
/// A vertex of the common body can come up once for every face it lies on.
#[must_use]
pub fn intersect(frustum: &Frustum, bounds: Aabb) -> Points<MAX_BODY_POINTS> {
    let mut body = Points::EMPTY;
    if bounds.is_empty() {
        return body;
    }
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let solid = Frustum {
        corners: [
            corner(max.x, max.y, max.z),
            corner(min.x, max.y, max.z),
            corner(min.x, min.y, max.z),
            corner(max.x, min.y, max.z),
            corner(max.x, max.y, min.z),
            corner(min.x, max.y, min.z),
            corner(min.x, min.y, min.z),
            corner(max.x, min.y, min.z),
        ],
    };
    let box_planes = [
        DVec4::new(1.0, 0.0, 0.0, -min.x),
        DVec4::new(-1.0, 0.0, 0.0, max.x),
        DVec4::new(0.0, 1.0, 0.0, -min.y),
        DVec4::new(0.0, -1.0, 0.0, max.y),
        DVec4::new(0.0, 0.0, 1.0, -min.z),
        DVec4::new(0.0, 0.0, -1.0, max.z),
    ];
    let frustum_planes = frustum.planes();
    for (faces, planes) in [(frustum.faces(), box_planes), (solid.faces(), frustum_planes)] {
        for face in faces {
            for &point in clip_face(face, &planes).as_slice() {
                body.push(point);
            }
        }
    }
    body
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use proptest::prelude::*;

    use super::*;
    use crate::camera::{Camera, Projection};

    fn cube_frustum(half: f64, center: DVec3) -> Frustum {
        let camera = Camera {
            eye: center + DVec3::Z * half,
            orientation: glam::DQuat::IDENTITY,
            projection: Projection::Orthographic { half_height: half, near: 0.0, far: 2.0 * half },
        };
        Frustum::slice(&camera, 1.0, 0.0, 2.0 * half).unwrap()
    }

    #[test]
    fn two_overlapping_cubes_share_a_cube() {
        let body = intersect(&cube_frustum(1.0, DVec3::splat(1.0)), Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0)));
        let min = body.as_slice().iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let max = body.as_slice().iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        assert!((min - DVec3::ZERO).length() < 1e-12 && (max - DVec3::ONE).length() < 1e-12, "{min} to {max}");
    }

    #[test]
    fn one_inside_the_other_gives_the_inner_one_and_apart_gives_nothing() {
        let unit = Aabb::new(Vec3::splat(-1.0), Vec3::splat(1.0));
        let inner = intersect(&cube_frustum(0.25, DVec3::ZERO), unit);
        assert_eq!(inner.as_slice().len(), 24, "four corners on each of six faces");
        assert!(intersect(&cube_frustum(1.0, DVec3::splat(9.0)), unit).as_slice().is_empty());
        assert!(intersect(&cube_frustum(1.0, DVec3::ZERO), Aabb::EMPTY).as_slice().is_empty());
    }

    proptest! {
        /// Every point of the common body lies in both solids: that is what the fits rely on, and it exercises the capacity.
        #[test]
        fn the_common_body_lies_in_both(
            eye in prop::array::uniform3(-4.0..4.0_f64),
            target in prop::array::uniform3(-4.0..4.0_f64),
            fov in 0.05..3.0_f64,
            half in prop::array::uniform3(0.01..5.0_f32),
        ) {
            let projection = Projection::Perspective { vertical_fov: fov, near: 0.1, far: Some(10.0) };
            let Ok(camera) = Camera::look_at(eye.into(), target.into(), projection) else { return Ok(()) };
            let frustum = Frustum::slice(&camera, 1.3, 0.1, 10.0).unwrap();
            let half = Vec3::from(half);
            let body = intersect(&frustum, Aabb::new(-half, half));
            let planes = frustum.planes();
            for &point in body.as_slice() {
                prop_assert!((point.abs() - half.as_dvec3()).max_element() < 1e-9, "{} outside the box", point);
                for plane in planes {
                    // The widest frustum above is 140 m across, and its corners carry that many metres' rounding.
                    prop_assert!(plane.dot(point.extend(1.0)) > -1e-9, "{} outside the frustum", point);
                }
            }
        }
    }
}
