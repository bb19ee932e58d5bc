//! Every corner that three planes have, and points that are tried one by one.

use glam::{DMat4, DVec3, DVec4, Vec3};
use proptest::prelude::*;

use super::{directions, faces::common_points, perspective};
use crate::{
    bounds::Aabb,
    polytope::{MAX_VERTICES, Polytope, TOLERANCE, box_planes, shadow_planes},
};

/// What a vertex may lie beyond a plane that cut it, as a share of the largest coordinate: the tolerance, and as much again for the roundings
/// of the tests' own distances.
const SLACK: f64 = 2.0 * TOLERANCE;

/// How far apart two ways to the same extent may be, as a share of the largest coordinate: each of up to 32 planes moves a vertex by the tolerance.
const EXTENT_SLACK: f64 = 64.0 * TOLERANCE;

/// Whether a point lies in a body, but for the slack of a body with coordinates up to `largest`.
fn check_within(body: &Polytope, point: DVec3, largest: f64) -> Result<(), TestCaseError> {
    prop_assert!(!body.is_empty(), "{} is missing", point);
    for direction in directions() {
        let (min, max) = body.extent_along(direction);
        let beyond = (min - direction.dot(point)).max(direction.dot(point) - max);
        prop_assert!(beyond <= EXTENT_SLACK * largest, "{} lies {} m outside {:?}", point, beyond, body.vertices());
    }
    Ok(())
}

fn largest(body: &Polytope) -> f64 {
    body.vertices().iter().fold(0.0_f64, |largest, point| largest.max(point.abs().max_element()))
}

/// A plane to cut with, some through what a body already has.
#[derive(Clone, Copy, Debug)]
enum Cut {
    /// Across a direction, a share of the body's extent along it from its end.
    Free { normal: [f64; 3], share: f64 },
    /// Across one of the axes.
    Across { axis: usize, is_lower: bool, at: [f64; 3] },
    /// Through one of the vertices.
    Vertex { vertex: usize, normal: [f64; 3] },
    /// Through two of the vertices.
    Edge { vertices: [usize; 2], normal: [f64; 3] },
    /// Through three of the vertices.
    Face { vertices: [usize; 3], is_flipped: bool },
}

impl Cut {
    /// The plane, with a normal of unit length, or zero where the vertices have none.
    fn plane(self, body: &Polytope) -> DVec4 {
        let vertex = |i: usize| body.vertices()[i % body.vertices().len()];
        let place = |at: [f64; 3]| {
            let (min, max) = body.transformed(DMat4::IDENTITY);
            min + DVec3::from(at) * (max - min)
        };
        let (normal, point) = match self {
            Self::Free { normal, share } => {
                let normal = DVec3::from(normal).normalize_or_zero();
                let (min, max) = body.extent_along(normal);
                return normal.extend(-(min + share * (max - min)));
            }
            Self::Across { axis, is_lower, at } => (DVec3::AXES[axis] * if is_lower { 1.0 } else { -1.0 }, place(at)),
            Self::Vertex { vertex: i, normal } => (normal.into(), vertex(i)),
            Self::Edge { vertices: [i, j], normal } => ((vertex(j) - vertex(i)).cross(normal.into()), vertex(i)),
            Self::Face { vertices: [i, j, k], is_flipped } => {
                let normal = (vertex(j) - vertex(i)).normalize_or_zero().cross((vertex(k) - vertex(i)).normalize_or_zero());
                // Three vertices on a line up to rounding have no plane that could be known.
                let normal = if normal.length() < 1e-3 { DVec3::ZERO } else { normal };
                (if is_flipped { -normal } else { normal }, vertex(i))
            }
        };
        let normal = normal.normalize_or_zero();
        normal.extend(-normal.dot(point))
    }
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-1.0..1.0_f64)
}

fn cut() -> impl Strategy<Value = Cut> {
    let at = || prop::array::uniform3(0.0..1.0_f64);
    prop_oneof![
        2 => (vector(), 0.0..1.0_f64).prop_map(|(normal, share)| Cut::Free { normal, share }),
        // These leave most of the body, so that it comes to have many faces.
        6 => (vector(), 0.0..0.2_f64).prop_map(|(normal, share)| Cut::Free { normal, share }),
        1 => (0..3_usize, any::<bool>(), at()).prop_map(|(axis, is_lower, at)| Cut::Across { axis, is_lower, at }),
        1 => (0..60_usize, vector()).prop_map(|(vertex, normal)| Cut::Vertex { vertex, normal }),
        1 => (prop::array::uniform2(0..60_usize), vector()).prop_map(|(vertices, normal)| Cut::Edge { vertices, normal }),
        1 => (prop::array::uniform3(0..60_usize), any::<bool>()).prop_map(|(vertices, is_flipped)| Cut::Face { vertices, is_flipped }),
    ]
}

/// A body to begin with, and the six planes or fewer that it is bounded by.
#[derive(Clone, Copy, Debug)]
struct Start {
    body: Polytope,
    planes: [DVec4; 6],
}

/// How large the body is and how far from the origin, in metres.
fn place() -> impl Strategy<Value = (f64, DVec3)> {
    let scale = prop_oneof![4 => Just(1.0), 1 => Just(1e-3), 1 => Just(1e6)];
    let origin = prop_oneof![4 => Just(DVec3::ZERO), 1 => Just(DVec3::new(1e5, -3e4, 7e4))];
    (scale, origin)
}

/// Frustums, some of which begin at the eye, and boxes, some of which are flat, segments or points.
fn start() -> impl Strategy<Value = Start> {
    let near = prop_oneof![2 => 0.0..3.0_f64, 1 => Just(0.0)];
    let frustum = (place(), vector(), vector(), 0.1..2.5_f64, near, 4.0..100.0_f64);
    let frustum = frustum.prop_filter_map("the camera looks somewhere", |((scale, origin), eye, target, fov, near, far)| {
        let [eye, target] = [eye, target].map(|point| origin + scale * DVec3::from(point));
        let frustum = perspective(eye, target, fov, scale * near, scale * far)?;
        Some(Start { body: Polytope::from_frustum(&frustum), planes: frustum.planes() })
    });
    let solid = (place(), vector(), prop::array::uniform3(prop_oneof![3 => 0.01..2.0_f64, 1 => Just(0.0)]));
    let solid = solid.prop_map(|((scale, origin), center, half)| {
        let center = origin + scale * DVec3::from(center);
        let half = scale * DVec3::from(half);
        let bounds = Aabb::new((center - half).as_vec3(), (center + half).as_vec3());
        Start { body: Polytope::from_bounds(bounds), planes: box_planes(bounds) }
    });
    prop_oneof![frustum, solid]
}

/// Every point that three planes have in common and that no other plane cuts off.
fn corners(planes: &[DVec4]) -> std::vec::Vec<DVec3> {
    let mut found = std::vec::Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            for c in &planes[j + 1..] {
                let [u, v, w] = [a, b, c].map(|plane| plane.truncate());
                let determinant = u.dot(v.cross(w));
                // Planes closer to parallel than this have a point in common that rounding moves too far to compare it.
                if determinant.abs() < 1e-2 {
                    continue;
                }
                let point = -(a.w * v.cross(w) + b.w * w.cross(u) + c.w * u.cross(v)) / determinant;
                if planes.iter().all(|plane| plane.dot(point.extend(1.0)) >= 0.0) {
                    found.push(point);
                }
            }
        }
    }
    found
}

/// Cuts a body with planes that may depend on what it has become, and gives it with all planes that bound it.
fn cut_body(start: &Start, cuts: &[Cut]) -> (Polytope, std::vec::Vec<DVec4>) {
    let mut body = start.body;
    let mut planes: std::vec::Vec<_> = start.planes.into_iter().filter(|plane| *plane != DVec4::ZERO).collect();
    for cut in cuts {
        if body.is_empty() {
            break;
        }
        let plane = cut.plane(&body);
        if plane != DVec4::ZERO {
            body.clip(plane);
            planes.push(plane);
        }
    }
    (body, planes)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    /// This holds only if no cut has been left out for want of room.
    #[test]
    fn no_vertex_is_beyond_a_plane(start in start(), cuts in prop::collection::vec(cut(), 0..=20)) {
        let largest = largest(&start.body);
        let (body, planes) = cut_body(&start, &cuts);
        prop_assert!(body.vertices().len() <= MAX_VERTICES);
        for point in body.vertices() {
            for plane in &planes {
                let distance = plane.dot(point.extend(1.0));
                prop_assert!(distance >= -SLACK * largest, "{} is {} m inside {}", point, distance, plane);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    /// Nothing is missing: three planes' common point, where no other plane cuts it off, is in the body.
    #[test]
    fn every_corner_of_the_planes_is_in_the_body(start in start(), cuts in prop::collection::vec(cut(), 0..=20)) {
        let largest = largest(&start.body);
        let (body, planes) = cut_body(&start, &cuts);
        for corner in corners(&planes) {
            check_within(&body, corner, largest)?;
        }
    }

    /// The same by points that have nothing to do with corners.
    #[test]
    fn every_point_inside_all_planes_is_in_the_body(
        start in start(),
        cuts in prop::collection::vec(cut(), 0..12),
        samples in prop::collection::vec(prop::array::uniform3(0.0..1.0_f64), 200),
    ) {
        let largest = largest(&start.body);
        let (body, planes) = cut_body(&start, &cuts);
        let (min, max) = start.body.transformed(DMat4::IDENTITY);
        for at in samples {
            let point = min + DVec3::from(at) * (max - min);
            if planes.iter().all(|plane| plane.dot(point.extend(1.0)) >= 0.0) {
                check_within(&body, point, largest)?;
            }
        }
    }

    /// What a camera sees of what a box can shadow: up to 21 planes, of which many meet in the corners of that box.
    #[test]
    fn a_view_of_a_boxs_shadow_is_cut_by_all_its_planes(
        (scale, origin) in place(),
        [eye, target, center, light] in prop::array::uniform4(vector()),
        half in prop::array::uniform3(prop_oneof![3 => 0.01..1.0_f64, 1 => Just(0.0)]),
        is_position in any::<bool>(),
    ) {
        let [eye, target, center] = [eye, target, center].map(|point| origin + scale * DVec3::from(point));
        let Some(frustum) = perspective(eye, target, 1.0, 0.01 * scale, 10.0 * scale) else { return Ok(()) };
        let half = scale * DVec3::from(half);
        let casters = Aabb::new((center - half).as_vec3(), (center + half).as_vec3());
        let scene = Aabb::new((origin - 2.0 * scale).as_vec3(), (origin + 2.0 * scale).as_vec3());
        let light = if is_position { (origin + 3.0 * scale * DVec3::from(light)).extend(1.0) } else { DVec3::from(light).extend(0.0) };
        let (shadow, count) = shadow_planes(casters, light);
        let planes = frustum.planes().into_iter().chain(box_planes(scene)).chain(shadow[..count].iter().copied());
        let planes: std::vec::Vec<_> = planes.map(|plane| plane / plane.truncate().length()).collect();
        let mut body = Polytope::from_frustum(&frustum);
        let largest = largest(&body);
        planes.iter().for_each(|plane| body.clip(*plane));
        for point in body.vertices() {
            for plane in &planes {
                let distance = plane.dot(point.extend(1.0));
                prop_assert!(distance >= -SLACK * largest, "{} is {} m inside {}", point, distance, plane);
            }
        }
        for corner in corners(&planes) {
            check_within(&body, corner, largest)?;
        }
    }

    /// The clipping of faces, which knows no tolerance, has the same extents.
    #[test]
    fn a_frustum_and_a_box_have_in_common_what_their_faces_have(
        eye in prop::array::uniform3(-4.0..4.0_f64),
        target in prop::array::uniform3(-4.0..4.0_f64),
        fov in 0.1..2.5_f64,
        near in 0.1..3.0_f64,
        half in prop::array::uniform3(prop_oneof![4 => 0.01..5.0_f32, 1 => Just(0.0)]),
    ) {
        let Some(frustum) = perspective(eye.into(), target.into(), fov, near, 20.0) else { return Ok(()) };
        let half = Vec3::from(half);
        let bounds = Aabb::new(-half, half);
        let mut body = Polytope::from_frustum(&frustum);
        body.clip_to_bounds(bounds);
        let mut other = Polytope::from_bounds(bounds);
        frustum.planes().into_iter().for_each(|plane| other.clip(plane));
        let points = common_points(&frustum, bounds);
        for direction in directions() {
            let along = points.iter().map(|point| direction.dot(*point));
            let (min, max) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), at| (min.min(at), max.max(at)));
            // Two solids that only touch can have nothing in common under one rounding and a point under the other.
            if points.is_empty() || body.is_empty() || other.is_empty() {
                continue;
            }
            for (least, greatest) in [body.extent_along(direction), other.extent_along(direction)] {
                // The frustum above is less than 200 m across; see `EXTENT_SLACK`.
                let slack = EXTENT_SLACK * 200.0;
                prop_assert!((least - min).abs() < slack && (greatest - max).abs() < slack, "{} to {}, not {} to {}", least, greatest, min, max);
            }
        }
    }
}
