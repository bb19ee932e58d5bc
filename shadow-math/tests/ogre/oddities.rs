//! Where OGRE is wrong: each property that its matrices lack, and ours have.

use glam::{DVec2, DVec3, Vec3};
use shadow_math::{
    LightKind,
    bounds::Aabb,
    fit::{
        FallBack, LightFrame, OgreLightSpace, Subject, optimal_warp, visible_body, visible_range,
    },
};

use crate::{
    data::{Case, case, cases, ndc},
    lispsm::{general_warp, standard, tweak},
    plane_optimal::{ROUNDING, distance_from_camera, our_view, points_of_plane, rows},
};

/// `defect_singular`: OGRE takes the last entry of its matrix for 1, which it cannot be where the light is at the world's origin.
#[test]
fn a_light_at_the_origin_is_no_singular_place() {
    for case in cases(1, |case| case.has_tag("defect_singular")) {
        let ogre = distance_from_camera(case, case.clip_from_world());
        assert!(ogre > 10.0, "OGRE's image of the plane is sixteen maps off: {ogre}");
        let ours = distance_from_camera(case, our_view(case).clip_from_world());
        assert!(ours < ROUNDING, "{ours}");
    }
}

/// `defect_depth_row`: OGRE takes directions for points where the horizon is in view, and what is on the plane is beyond its far plane.
#[test]
fn a_plane_up_to_the_horizon_has_one_depth() {
    for case in cases(2, |case| case.has_tag("defect_depth_row")) {
        let deepest = |matrix| points_of_plane(case).into_iter().filter_map(|p| Some(ndc(matrix, p)?.z)).fold(0.0, f64::max);
        let (ours, ogre) = (deepest(our_view(case).clip_from_world()), deepest(case.clip_from_world()));
        println!("{} {ogre}", case.id);
        assert!(ogre > 1.0, "{}: {ogre} is beyond OGRE's far plane", case.id);
        assert!((ours - 0.99).abs() < ROUNDING, "{}: {ours}", case.id);
    }
}

#[test]
fn dbg_dir() {
    for case in cases(2, |case| case.has_tag("unstable_direction")) {
        let s = case.standard();
        let e = case.nearest();
        let d = s.project_point3(e + case.camera().direction()) - s.project_point3(e);
        println!("{} {:?} {:?} {:?}", case.id, d, case.intermediate.ls_view_dir, case.clip_from_world());
        let l = case.direction_for_ogre();
        println!("{}", l.cross(case.camera().direction()));
    }
    for case in cases(18, |case| case.setup == "plane_optimal") {
        let deepest = points_of_plane(case).into_iter().filter_map(|p| Some(ndc(case.clip_from_world(), p)?.z)).fold(0.0, f64::max);
        println!("{} {deepest} {}", case.id, distance_from_camera(case, case.clip_from_world()));
    }
}
