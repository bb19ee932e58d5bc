//! OGRE's plane-optimal matrices against the closed form.

use glam::{DMat4, DVec3, DVec4};
use shadow_math::fit::{PlaneOptimal, ViewFit, plane_depth_factor, plane_optimal};

use crate::data::{Case, apart, cases, ndc};

/// What OGRE loses in NDC x and y: its system is solved in double precision and rounded to single. 4.4e-6 for parallel light and 6.1e-5 for lights at a place, whose matrix is split in two.
const TOLERANCE: f64 = 1e-4;

/// What the closed form loses in double precision in x and y: tens of roundings of 2^-53, magnified by what is far away over what is near.
pub(crate) const ROUNDING: f64 = 1e-12;

/// What it loses in depth: it adds the height over the plane, 0 but for rounding of coordinates that are as large as what is far away.
pub(crate) const DEPTH_ROUNDING: f64 = 1e-11;

/// The depth of the plane, ours in 0 to 1 and OGRE's in -1 to 1.
pub(crate) const PLANE_DEPTH: f64 = 0.99;

/// Cases with a matrix of OGRE's, right in x and y.
fn is_right(case: &Case) -> bool {
    case.setup == "plane_optimal" && case.result.custom_proj && !case.has_tag("defect_singular")
}

pub(crate) fn rows(case: &Case) -> PlaneOptimal {
    plane_optimal(&case.eye(), case.plane(), case.light_point()).expect("neither light nor camera lies in the plane")
}

pub(crate) fn our_view(case: &Case) -> ViewFit {
    let (rows, casters) = (rows(case), [case.casters()]);
    rows.view(&case.eye(), plane_depth_factor(&rows, &casters), 1024)
}

/// Points of the plane that the camera sees.
pub(crate) fn points_of_plane(case: &Case) -> Vec<DVec3> {
    let (plane, camera) = (rows(case).plane, case.camera());
    let world_from_clip = case.camera_clip_from_world().inverse();
    let grid = (0..21_i32).flat_map(|i| (0..21_i32).map(move |j| [0.1 * f64::from(i) - 1.0, 0.1 * f64::from(j) - 1.0]));
    let points = grid.filter_map(|[x, y]| {
        let ray = world_from_clip.project_point3(DVec3::new(x, y, 0.0)) - camera.eye;
        let distance = -plane.dot(camera.eye.extend(1.0)) / plane.truncate().dot(ray);
        let point = camera.eye + ray * distance;
        // What is ten thousand times as far away as the near plane is of no pixel.
        (distance > 0.0 && point.distance(camera.eye) < 1e4 * case.planes()[0]).then_some(point)
    });
    points.collect()
}

/// Points above a plane's, on their rays of light: a third and nine tenths of the way to a light at a place, and up to two hundred near distances toward parallel light.
fn points_above(case: &Case) -> Vec<DVec3> {
    let light = case.light_point();
    let above = |point: DVec3| {
        [0.3, 0.9].map(|share| {
            if light.w > 0.0 {
                point.lerp(light.truncate(), share)
            } else {
                point + light.truncate() * 200.0 * share * case.planes()[0]
            }
        })
    };
    points_of_plane(case).into_iter().flat_map(above).collect()
}

#[test]
fn the_image_is_ogres() {
    for case in cases(15, is_right) {
        let (rows, ogre) = (rows(case), case.clip_from_world());
        let ours = |point: DVec4| DVec3::new(rows.clip_x.dot(point), rows.clip_y.dot(point), 0.0) / rows.clip_w.dot(point);
        let on_plane = points_of_plane(case);
        assert!(on_plane.len() > 50, "{}: {} points are in view", case.id, on_plane.len());
        for point in on_plane.into_iter().chain(points_above(case)) {
            assert!(rows.clip_w.dot(point.extend(1.0)) > 0.0, "{}: {point} is before the camera", case.id);
            let theirs = ndc(ogre, point).expect("so it is for OGRE");
            let difference = apart(ours(point.extend(1.0)).truncate(), theirs.truncate());
            assert!(difference < TOLERANCE, "{}: {difference} at {point}", case.id);
        }
    }
}

/// On the plane, camera and light agree wherever the camera sees the plane, and depth is the same everywhere.
#[test]
fn the_image_is_the_cameras() {
    for case in cases(17, |case| case.setup == "plane_optimal" && case.id != "po_notvisible") {
        assert!(points_of_plane(case).len() > 50, "{}", case.id);
        let off = distance_from_camera(case, our_view(case).clip_from_world());
        assert!(off < ROUNDING, "{}: {off}", case.id);
        let depth_off = depth_off(case, our_view(case).clip_from_world());
        assert!(depth_off < DEPTH_ROUNDING, "{}: {depth_off}", case.id);
    }
}

/// OGRE's depth of the plane is the same as ours where it is right.
#[test]
fn the_planes_depth_is_ogres() {
    for case in cases(13, |case| is_right(case) && !case.has_tag("defect_depth_row")) {
        // Single precision, times a few: depth is a quotient of sums.
        let off = depth_off(case, case.clip_from_world());
        assert!(off < 1e-6, "{}: {off}", case.id);
    }
}

/// How far depths on the plane are at most from what they should be.
pub(crate) fn depth_off(case: &Case, light: DMat4) -> f64 {
    points_of_plane(case).into_iter().map(|point| (light.project_point3(point).z - PLANE_DEPTH).abs()).fold(0.0, f64::max)
}

/// How far a light's image of the plane is at most from the camera's, in NDC.
pub(crate) fn distance_from_camera(case: &Case, light: DMat4) -> f64 {
    let at = |matrix: DMat4, point| matrix.project_point3(point).truncate();
    let camera = case.camera_clip_from_world();
    points_of_plane(case).into_iter().map(|point| at(light, point).distance(at(camera, point))).fold(0.0, f64::max)
}
