//! Bodies against brute force: every corner that three planes have, and points that are tried one by one.

use glam::{DMat4, Vec3};
use proptest::prelude::*;

use super::*;
use crate::{
    camera::{Camera, Projection},
    convex,
};

/// What a vertex may lie beyond a plane that cut it, as a share of the largest coordinate: the tolerance, and as much again for the roundings
/// of the tests' own distances.
const SLACK: f64 = 2.0 * TOLERANCE;

/// How far apart two ways to the same extent may be, as a share of the largest coordinate: each of up to 32 planes moves a vertex by the tolerance.
const EXTENT_SLACK: f64 = 64.0 * TOLERANCE;

fn aabb(min: [f32; 3], max: [f32; 3]) -> Aabb {
    Aabb::new(Vec3::from(min), Vec3::from(max))
}

fn unit(plane: DVec4) -> DVec4 {
    plane / plane.truncate().length()
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

fn perspective(eye: DVec3, target: DVec3, fov: f64, near: f64, far: f64) -> Option<Frustum> {
    let projection = Projection::Perspective { vertical_fov: fov, near: near.max(1e-6 * far), far: Some(far) };
    let camera = Camera::look_at(eye, target, projection).ok()?;
    Frustum::slice(&camera, 1.5, near, far).ok()
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
fn corners(planes: &[DVec4], slack: f64) -> std::vec::Vec<DVec3> {
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
                if planes.iter().all(|plane| plane.dot(point.extend(1.0)) >= -slack) {
                    found.push(point);
                }
            }
        }
    }
    found
}

/// Some directions that have nothing to do with the axes, and the axes.
fn directions() -> impl Iterator<Item = DVec3> {
    let turned = (0..20).map(|i| {
        let (height, angle) = (1.0 - (2.0 * f64::from(i) + 1.0) / 20.0, 2.4 * f64::from(i));
        ((1.0 - height * height).sqrt() * DVec3::new(angle.cos(), angle.sin(), 0.0)).with_z(height)
    });
    turned.chain(DVec3::AXES)
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
    fn no_vertex_is_beyond_a_plane(start in start(), cuts in prop::collection::vec(cut(), 0..20)) {
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
    fn every_corner_of_the_planes_is_in_the_body(start in start(), cuts in prop::collection::vec(cut(), 0..20)) {
        let largest = largest(&start.body);
        let (body, planes) = cut_body(&start, &cuts);
        for corner in corners(&planes, 0.0) {
            prop_assert!(!body.is_empty(), "{} is missing", corner);
            for direction in directions() {
                let (min, max) = body.extent_along(direction);
                let beyond = (min - direction.dot(corner)).max(direction.dot(corner) - max);
                prop_assert!(beyond <= EXTENT_SLACK * largest, "{} lies {} m outside {:?}", corner, beyond, body.vertices());
            }
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
                prop_assert!(!body.is_empty(), "{} is missing", point);
                for direction in directions() {
                    let (min, max) = body.extent_along(direction);
                    let beyond = (min - direction.dot(point)).max(direction.dot(point) - max);
                    prop_assert!(beyond <= EXTENT_SLACK * largest, "{} lies {} m outside", point, beyond);
                }
            }
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
        let faces = convex::intersect(&frustum, bounds);
        for direction in directions() {
            let along = faces.as_slice().iter().map(|point| direction.dot(*point));
            let (min, max) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), at| (min.min(at), max.max(at)));
            // Two solids that only touch can have nothing in common under one rounding and a point under the other.
            if faces.as_slice().is_empty() || body.is_empty() || other.is_empty() {
                continue;
            }
            for (least, greatest) in [body.extent_along(direction), other.extent_along(direction)] {
                // The frustum above is less than 200 m across; see `EXTENT_SLACK`.
                let slack = EXTENT_SLACK * 200.0;
                prop_assert!((least - min).abs() < slack && (greatest - max).abs() < slack, "{} to {}, not {} to {}", least, greatest, min, max);
            }
        }
    }

    /// What the volume is defined by, point by point, with the way to the light tried against the box by slabs.
    #[test]
    fn shadow_planes_hold_the_points_whose_way_to_the_light_meets_the_box(
        center in vector(),
        half in prop::array::uniform3(prop_oneof![3 => 0.01..1.0_f64, 1 => Just(0.0)]),
        light in prop::array::uniform3(prop_oneof![4 => -4.0..4.0_f64, 1 => Just(0.0)]),
        is_position in any::<bool>(),
        samples in prop::collection::vec(prop::array::uniform3(prop_oneof![4 => -5.0..5.0_f64, 1 => Just(0.0)]), 100),
    ) {
        let (center, half) = (DVec3::from(center), DVec3::from(half));
        let bounds = Aabb::new((center - half).as_vec3(), (center + half).as_vec3());
        let light = DVec3::from(light);
        prop_assume!(is_position || light.length() > 1e-3);
        let (planes, count) = shadow_planes(bounds, light.extend(f64::from(u8::from(is_position))));
        for sample in samples {
            let point = DVec3::from(sample);
            let way = if is_position { light - point } else { light };
            let nearest = planes[..count].iter().map(|plane| unit(*plane).dot(point.extend(1.0))).fold(f64::INFINITY, f64::min);
            // Rounding decides about points on the surface: some ten units in the last place of coordinates below 10 m. The planes of a flat box
            // hold its shadow between them, and all of it is surface.
            if nearest.abs() > 1e-14 {
                prop_assert_eq!(nearest > 0.0, meets(bounds, point, way, is_position), "{} and {}", point, nearest);
            }
        }
    }
}

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

fn cube() -> Polytope {
    Polytope::from_bounds(aabb([-1.0; 3], [1.0; 3]))
}

#[test]
fn a_cut_corner_leaves_a_triangle_in_its_place() {
    let mut body = cube();
    body.clip(DVec4::new(-1.0, -1.0, -1.0, 2.0));
    assert_eq!(body.vertices().len(), 10);
    for corner in [DVec3::new(0.0, 1.0, 1.0), DVec3::new(1.0, 0.0, 1.0), DVec3::new(1.0, 1.0, 0.0)] {
        // Halves of ones are exact.
        assert!(body.vertices().contains(&corner), "{corner} is not among {:?}", body.vertices());
    }
}

#[test]
fn a_cut_through_the_middle_is_a_hexagon() {
    let mut body = cube();
    body.clip(DVec4::new(3e9, 3e9, 3e9, 0.0));
    assert_eq!(body.vertices().len(), 4 + 6);
    body.clip(DVec4::new(-1.0, -1.0, -1.0, 0.0));
    assert_eq!(body.vertices().len(), 6, "only the hexagon is left of it");
    body.clip(DVec4::new(1.0, -1.0, 0.0, 0.0));
    assert_eq!(body.vertices().len(), 5, "three of a hexagon's corners and two new ones: its diagonals are no edges");
}

#[test]
fn what_cuts_nothing_off_changes_nothing() {
    let before = cube();
    let nothing = [DVec4::ZERO, DVec4::new(0.0, 0.0, 0.0, -1.0), DVec4::NAN, DVec4::new(f64::INFINITY, 0.0, 0.0, 1.0)];
    let touching = [DVec4::new(1.0, 0.0, 0.0, 1.0), DVec4::new(1.0, 1.0, 0.0, 2.0), DVec4::new(1.0, 1.0, 1.0, 3.0)];
    for plane in nothing.into_iter().chain(touching) {
        let mut body = before;
        body.clip(plane);
        assert_eq!((body.vertices(), body.planes), (before.vertices(), before.planes), "{plane}");
    }
}

#[test]
fn what_lies_beyond_a_plane_is_gone() {
    let mut body = cube();
    body.clip(DVec4::new(1e-300, 0.0, 0.0, -1e10));
    assert!(body.is_empty());
    assert_eq!(body.extent_along(DVec3::X), (f64::INFINITY, f64::NEG_INFINITY));
    body.clip(DVec4::X);
    assert!(body.is_empty() && Polytope::from_bounds(Aabb::EMPTY).is_empty());
    let mut body = cube();
    body.clip_to_bounds(Aabb::EMPTY);
    assert!(body.is_empty());
}

#[test]
fn a_frustum_that_begins_at_the_eye_has_five_vertices() {
    let frustum = perspective(DVec3::ONE, DVec3::ZERO, 1.0, 0.0, 9.0).expect("the camera looks somewhere");
    let mut body = Polytope::from_frustum(&frustum);
    assert_eq!(body.vertices().len(), 5);
    let middle = 0.5 * (DVec3::ONE + frustum.corners[4]);
    let axis = (DVec3::ZERO - DVec3::ONE).normalize();
    body.clip(axis.extend(-axis.dot(middle)));
    assert_eq!(body.vertices().len(), 8, "cut off at the tip it is a frustum");
}

#[test]
fn flat_boxes_are_cut_like_polygons() {
    let floor = Polytope::from_bounds(aabb([-1.0, 0.0, -1.0], [1.0, 0.0, 1.0]));
    assert_eq!(floor.vertices().len(), 4);
    let mut body = floor;
    for i in 0..20 {
        let (sin, cos) = (0.37 * f64::from(i)).sin_cos();
        body.clip(DVec4::new(cos, 0.3, sin, 0.9));
    }
    assert!((12..=24).contains(&body.vertices().len()), "a polygon of 24 sides at most: {}", body.vertices().len());
    let mut half = floor;
    half.clip(DVec4::new(0.0, 1.0, 1.0, 0.0));
    assert_eq!(half.vertices().len(), 4);
    let mut edge = floor;
    edge.clip(DVec4::new(1.0, 5.0, 0.0, -1.0));
    assert_eq!(edge.vertices().len(), 2, "a plane through an edge leaves the edge");
    edge.clip(DVec4::new(0.0, 0.0, 1.0, 0.0));
    assert_eq!(edge.extent_along(DVec3::Z), (0.0, 1.0));
    edge.clip(DVec4::new(0.0, 0.0, -1.0, 0.0));
    assert_eq!(edge.vertices(), [DVec3::X], "and of a segment a point can be left");
    edge.clip(DVec4::new(-1.0, 0.0, 0.0, 0.5));
    assert!(edge.is_empty());
}

#[test]
fn a_line_and_a_point_are_boxes_too() {
    let mut line = Polytope::from_bounds(aabb([0.0; 3], [0.0, 4.0, 0.0]));
    assert_eq!(line.vertices().len(), 2);
    line.clip(DVec4::new(1.0, -1.0, 0.0, 1.0));
    assert_eq!(line.extent_along(DVec3::Y), (0.0, 1.0));
    let mut point = Polytope::from_bounds(aabb([2.0; 3], [2.0; 3]));
    point.clip(DVec4::new(1.0, 0.0, 0.0, -2.0));
    assert_eq!(point.vertices(), [DVec3::splat(2.0)]);
}

/// A plane that runs along a face so closely that one of its edges counts as on it, and the opposite one does not.
#[test]
fn a_plane_almost_along_a_face_takes_no_more_than_it_should() {
    let mut floor = Polytope::from_bounds(aabb([-1.0, 0.0, -1.0], [1.0, 0.0, 1.0]));
    floor.clip(DVec4::new(1.5 * TOLERANCE, 1.0, 0.0, -0.6 * TOLERANCE));
    // The cut is at 0.4, but for rounding of f64; the tolerance is that of 1 m.
    assert_eq!(floor.extent_along(DVec3::X).1, 1.0);
    assert!((floor.extent_along(DVec3::X).0 - 0.4).abs() < 1e-9, "{:?}", floor.extent_along(DVec3::X));
}

/// Where room runs out, bodies become no smaller than they should be.
#[test]
fn more_planes_than_there_is_room_for_leave_too_much() {
    let mut body = cube();
    let mut planes = std::vec::Vec::new();
    for i in 0..200 {
        let (height, angle) = (1.0 - (2.0 * f64::from(i) + 1.0) / 200.0, 2.4 * f64::from(i));
        let normal = ((1.0 - height * height).sqrt() * DVec3::new(angle.cos(), angle.sin(), 0.0)).with_z(height);
        planes.push(normal.extend(0.9));
        body.clip(normal.extend(0.9));
    }
    assert!(body.vertices().len() > 50, "nearly all room is taken: {}", body.vertices().len());
    for direction in directions() {
        assert!(body.extent_along(direction).1 >= 0.9, "the sphere inside all planes is inside the body");
    }
}

/// A plane that only touches a solid gives way to one that cuts it.
#[test]
fn planes_that_hold_no_face_are_given_up() {
    let mut body = cube();
    // The masks say that each corner lies on planes which hold nothing else, as rounding could bring about.
    for i in 0..26 {
        body.planes[i % 8] |= 1 << (6 + i);
    }
    body.clip(DVec4::new(1.0, 0.0, 0.0, 0.0));
    assert_eq!(body.extent_along(DVec3::X), (0.0, 1.0));
    assert_eq!(body.vertices().len(), 8);
}

#[test]
fn a_light_in_the_box_bounds_no_shadow_and_one_above_it_five_faces() {
    let bounds = aabb([-1.0; 3], [1.0; 3]);
    assert_eq!(shadow_planes(bounds, DVec4::new(0.5, -1.0, 1.0, 1.0)).1, 0);
    assert_eq!(shadow_planes(Aabb::EMPTY, DVec4::Y).1, 0);
    assert_eq!(shadow_planes(bounds, DVec4::new(0.0, 2.0, 0.0, 1.0)).1, 5);
    assert_eq!(shadow_planes(bounds, DVec4::new(1.0, 2.0, 3.0, 0.0)).1, MAX_SHADOW_PLANES);
    let (planes, count) = shadow_planes(bounds, DVec4::Y);
    assert_eq!(count, 5);
    let mut body = Polytope::from_bounds(aabb([-9.0; 3], [9.0; 3]));
    planes[..count].iter().for_each(|plane| body.clip(*plane));
    assert_eq!(body.transformed(DMat4::IDENTITY), (DVec3::new(-1.0, -9.0, -1.0), DVec3::splat(1.0)));
}
