//! Bodies of which it is known what a cut leaves of them.

mod brute_force;
mod faces;

use glam::Vec3;

use super::*;
use crate::camera::{Camera, Projection};

fn aabb(min: [f32; 3], max: [f32; 3]) -> Aabb {
    Aabb::new(Vec3::from(min), Vec3::from(max))
}

fn perspective(eye: DVec3, target: DVec3, fov: f64, near: f64, far: f64) -> Option<Frustum> {
    let projection = Projection::Perspective { vertical_fov: fov, near: near.max(1e-6 * far), far: Some(far) };
    let camera = Camera::look_at(eye, target, projection).ok()?;
    Frustum::slice(&camera, 1.5, near, far).ok()
}

/// Some directions that have nothing to do with the axes, and the axes.
fn directions() -> impl Iterator<Item = DVec3> {
    let turned = (0..20).map(|i| {
        let (height, angle) = (1.0 - (2.0 * f64::from(i) + 1.0) / 20.0, 2.4 * f64::from(i));
        ((1.0 - height * height).sqrt() * DVec3::new(angle.cos(), angle.sin(), 0.0)).with_z(height)
    });
    turned.chain(DVec3::AXES)
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
    assert_eq!(body.common_planes().count_ones(), 1, "a flat body lies in one plane");
    body.clip(DVec4::new(1.0, -1.0, 0.0, 0.0));
    assert_eq!(body.vertices().len(), 5, "three of a hexagon's corners and two new ones: its diagonals are no edges");
}

#[test]
fn what_cuts_nothing_off_changes_nothing() {
    let before = cube();
    let endless = [DVec4::new(f64::INFINITY, 0.0, 0.0, 1.0), DVec4::new(1.0, 0.0, 0.0, f64::NEG_INFINITY)];
    let nothing = [DVec4::ZERO, DVec4::new(0.0, 0.0, 0.0, -1.0), DVec4::NAN].into_iter().chain(endless);
    let touching = [DVec4::new(1.0, 0.0, 0.0, 1.0), DVec4::new(1.0, 1.0, 0.0, 2.0), DVec4::new(1.0, 1.0, 1.0, 3.0)];
    for plane in nothing.chain(touching) {
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
    assert_eq!(floor.common_planes().count_ones(), 1, "its upper and its lower face are one");
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

/// A cut that would make more vertices than there is room for, which rounding alone can bring about, is left out as a whole.
#[test]
fn more_vertices_than_there_is_room_for_leave_too_much() {
    let mut body = cube();
    while body.vertices().len() < MAX_VERTICES {
        body.push(body.points[0], body.planes[0]);
    }
    let before = body;
    body.clip(DVec4::new(-1.0, -1.0, -1.0, 2.0));
    assert_eq!((body.vertices(), &body.planes[..body.len]), (before.vertices(), &before.planes[..before.len]));
}

/// Vertices of which rounding has made two, and their edges with them, do not become more from cut to cut.
#[test]
fn vertices_that_came_up_twice_are_cut_to_one() {
    let mut body = cube();
    for i in 0..8 {
        body.push(body.points[i], body.planes[i]);
    }
    body.clip(DVec4::X);
    assert_eq!(body.vertices().len(), 8 + 4);
    body.clip(DVec4::Y);
    assert_eq!(body.vertices().len(), 4 + 4 + 2, "two edges were twofold, two were not, and two are those of the cut before");
}

/// Two planes that are so close to each other that all corners but one of a face lie on both: its diagonals then look like edges.
#[test]
fn diagonals_between_planes_that_nearly_coincide_give_no_more_than_their_ends() {
    let mut body = cube();
    let side = |i: u32| {
        let (sin, cos) = (f64::from(i) * core::f64::consts::FRAC_PI_4).sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    for i in [1, 3, 5, 7] {
        body.clip((-side(i)).extend(1.0));
    }
    assert_eq!(body.vertices().len(), 16, "a prism of eight sides");
    // Of the upper eight corners the one farthest along this lies beyond the plane by just more than the tolerance, and none lies so far on the other side.
    let tilt = 0.8 * TOLERANCE * DVec3::new(0.92, 0.38, 0.0);
    body.clip((DVec3::NEG_Z - tilt).extend(1.0 - 0.3 * TOLERANCE));
    let both = body.planes[..body.len].iter().filter(|planes| planes.count_ones() == 4);
    assert_eq!(both.count(), 7, "all upper corners but one lie on both planes");
    body.clip(DVec4::new(0.3, 1.0, 0.0, 0.05));
    // Eight of the prism's corners and four new ones, and one for the third end of an edge that is two.
    assert!(body.vertices().len() <= 13, "{}", body.vertices().len());
    body.clip(DVec4::new(1.0, -0.3, 0.0, 0.05));
    // Four of the prism's corners, two of those that were new and four new ones, and one more.
    assert!(body.vertices().len() <= 11, "{}", body.vertices().len());
}

/// The ends of a segment are an edge even if rounding has left them no planes in common.
#[test]
fn segments_need_no_planes_to_be_cut() {
    let mut line = Polytope::from_bounds(aabb([0.0; 3], [0.0, 4.0, 0.0]));
    line.planes = [0; MAX_VERTICES];
    line.clip(DVec4::new(0.0, -1.0, 0.0, 1.0));
    assert_eq!(line.extent_along(DVec3::Y), (0.0, 1.0));
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
