//! Where OGRE is wrong: each property that its matrices lack, and ours have.

use glam::{DMat4, DQuat, DVec3, DVec4, Vec3};
use shadow_math::{
    Camera, Light, LightKind,
    bounds::Aabb,
    fit::{
        Content, Eye, FallBack, FitOutcome, LightFrame, LispsmWarp, OgreLightSpace, Subject, focused_view, ogre_frame,
        ogre_standard_matrix, optimal_warp, visible_body, visible_range,
    },
};

use crate::{
    data::{Case, case, cases, file},
    lispsm::{general_warp, is_stable, standard, tweak},
    plane_optimal::{DEPTH_ROUNDING, ROUNDING, depth_off, distance_from_camera, our_view, points_of_plane, rows},
    uniform::setup,
};

/// Every tag of the file has a test here, which asks for as many cases as there are.
#[test]
fn every_oddity_has_a_test() {
    const TAGS: [&str; 7] = [
        "defect_depth_row",
        "defect_n_opt",
        "defect_singular",
        "quirk_null_boxes",
        "quirk_point_direction",
        "unstable_direction",
        "untouched",
    ];
    let mut tags: Vec<_> = file().cases.iter().flat_map(|case| &case.tags).map(String::as_str).collect();
    tags.sort_unstable();
    tags.dedup();
    assert_eq!(tags, TAGS);
}

/// `defect_singular`: OGRE takes the last entry of its matrix for 1, and it is 0 where the light is at the world's origin.
#[test]
fn a_light_at_the_origin_is_no_singular_place() {
    for case in cases(1, |case| case.has_tag("defect_singular")) {
        let ogre = distance_from_camera(case, case.clip_from_world());
        assert!(ogre > 16.0, "OGRE's image of the plane is eight maps off: {ogre}");
        let ours = distance_from_camera(case, our_view(case).clip_from_world());
        assert!(ours < ROUNDING, "{ours}");
    }
}

/// `defect_depth_row`: OGRE takes directions for points where the horizon is in view. The plane has many depths, some of them beyond the far plane.
#[test]
fn a_plane_up_to_the_horizon_has_one_depth() {
    for case in cases(2, |case| case.has_tag("defect_depth_row")) {
        let [ours, ogre] = [our_view(case).clip_from_world(), case.clip_from_world()].map(|matrix| depth_off(case, matrix));
        // A light at a place has from 0.98 to 0.99 for everything: there, a little is much.
        assert!(ogre > if case.light.kind == "directional" { 0.05 } else { 2e-4 }, "{}: {ogre}", case.id);
        assert!(ours < DEPTH_ROUNDING, "{}: {ours}", case.id);
    }
    let case = case("po_horizon_dir");
    let clipped = points_of_plane(case).into_iter().filter(|point| case.clip_from_world().project_point3(*point).z > 1.0).count();
    assert!(clipped > 0, "some of the plane is beyond OGRE's far plane");
}

/// `untouched`: OGRE leaves the camera as it was where it finds fewer than four corners of the plane in view.
#[test]
fn a_plane_with_three_corners_in_view_has_a_matrix() {
    for case in cases(2, |case| case.has_tag("untouched")) {
        let hull = case.intermediate.plane_view_hull.as_ref().expect("the setup has a hull");
        assert!(hull.len() < 4 && !case.result.custom_proj, "{}", case.id);
        let [near, far] = case.planes();
        let is_seen = rows(case).is_seen(&case.eye(), [near, far]);
        assert_eq!(is_seen, !hull.is_empty(), "{}", case.id);
        if is_seen {
            let [ours, ogre] =
                [our_view(case).clip_from_world(), case.clip_from_world()].map(|matrix| distance_from_camera(case, matrix));
            assert!(ogre > 1.0, "OGRE's matrix is that of nothing: {ogre}");
            assert!(ours < ROUNDING, "{ours}");
        } else {
            assert!(points_of_plane(case).is_empty(), "{}: the plane is out of view, which the caller is told", case.id);
        }
    }
}

/// The light of a case, with its direction moved by some steps of single precision.
fn nudged(case: &Case, steps: Vec3) -> Light {
    let mut light = case.light();
    if let LightKind::Directional { direction } = &mut light.kind {
        *direction += steps * (f32::EPSILON / 2.0);
    }
    light
}

/// `unstable_direction`: where the camera looks along the light, OGRE takes rounding for a direction. Ours is none, whatever the last digit.
#[test]
fn a_light_along_the_view_has_no_direction() {
    let mut against = 0;
    for case in cases(2, |case| case.has_tag("unstable_direction")) {
        // What OGRE takes the direction from: the difference of two points' images, without depth.
        let matrix = case.standard();
        let step = matrix.project_point3(case.nearest() + case.camera().direction()) - matrix.project_point3(case.nearest());
        assert!(step.truncate().length() < f64::from(f32::EPSILON), "{}: {step} is rounding", case.id);
        let ogre = Vec3::from_array(case.intermediate.ls_view_dir.expect("the setup has a direction"));
        // z of light space is y of the image. OGRE's way out where there is no direction is -z.
        assert!(ogre == Vec3::Z, "{}: {ogre} is rounding at unit length", case.id);
        against += usize::from(f64::from(ogre.z) * step.y < 0.0);

        for steps in [Vec3::ZERO, Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z, Vec3::new(1.0, -1.0, 0.0)] {
            let light = nudged(case, steps);
            let frame = ogre_frame(&light, &case.camera(), &setup(case));
            assert_eq!(optimal_warp(&frame, &case.eye(), &case.body_b()), Err(FallBack::LightAlongView), "{steps}");
            let standard = ogre_standard_matrix(&light, &case.camera(), &setup(case), case.light_planes());
            assert_eq!(OgreLightSpace::new(standard, &case.camera(), case.nearest()), Err(FallBack::LightAlongView), "{steps}");
        }
    }
    assert_eq!(against, 1, "in one of the two, double precision has the opposite direction");
    // Elsewhere there is one.
    for case in cases(46, is_stable) {
        assert!(OgreLightSpace::new(standard(case), &case.camera(), case.nearest()).is_ok(), "{}", case.id);
    }
}

/// `defect_n_opt`: where the light shines across the view, OGRE looks for a point in which a plane and a line parallel to it meet. The parameter needs no such point.
#[test]
fn light_across_the_view_has_the_limit_of_the_parameters() {
    for case in cases(1, |case| case.has_tag("defect_n_opt")) {
        let ogre = case.intermediate.n_opt_general.expect("the setup has a parameter");
        assert!((ogre - 0.508).abs() < 1e-3, "{ogre}");
        let ours = general_warp(case);
        // Between the near point, 0.5 m away, and 30 m behind it: 0.5 + sqrt(0.5 * 30.5). OGRE's own places are off by millionths.
        assert!((ours - (0.5 + 15.25_f64.sqrt())).abs() < 1e-4, "{ours}");
        // Exactly across, where plane and line have no point in common or all: light along -y, and a camera along -z.
        let exact = DMat4::from_cols(DVec4::X, DVec4::NEG_Z, DVec4::NEG_Y, DVec4::W);
        let camera = Camera { orientation: DQuat::IDENTITY, ..case.camera() };
        let space = OgreLightSpace::new(exact, &camera, case.nearest()).expect("the light shines across the view");
        let exact = space.general_warp(&case.body_b(), case.planes()[0], case.adjust_factor(), tweak(case));
        assert!((exact - ours).abs() < 1e-6, "{exact} is but a step of single precision away from {ours}");
        // And it is what lights nearby have.
        let body = case.body_b();
        for angle in [1e-3_f64, -1e-3, 1e-6, -1e-6] {
            let turned = DMat4::from_rotation_x(angle) * standard(case);
            let space = OgreLightSpace::new(turned, &case.camera(), case.nearest()).expect("the light shines across the view");
            let nearby = space.general_warp(&body, case.planes()[0], case.adjust_factor(), tweak(case));
            // The body's extent along the view grows by its height, 62 m, times the angle, and the parameter by a part of that.
            assert!((nearby - ours).abs() < 62.0 * angle.abs() + 1e-9, "{angle}: {nearby}");
        }
    }
}

/// `quirk_point_direction`: OGRE warps a point light by the direction of the node it hangs on, fifteen times as much for one as for another. Ours has no such thing.
#[test]
fn turning_a_point_light_changes_nothing() {
    let turned = cases(2, |case| case.has_tag("quirk_point_direction"));
    let of_ogre = |case: &Case| f64::from(case.intermediate.n_opt_simple.expect("the setup has a parameter"));
    let mut parameters: Vec<_> = turned.iter().map(|case| of_ogre(case)).collect();
    parameters.sort_by(f64::total_cmp);
    assert!((parameters[1] / parameters[0] - 15.03).abs() < 0.01, "{parameters:?}");
    assert_ne!(turned[0].direction_for_ogre(), turned[1].direction_for_ogre());
    // All else is the same, and so is our warp.
    assert_eq!(turned[0].body_b(), turned[1].body_b());
    let ours = |case: &Case| -> LispsmWarp {
        let frame = ogre_frame(&case.light(), &case.camera(), &setup(case));
        optimal_warp(&frame, &case.eye(), &case.body_b()).expect("the camera looks across the light")
    };
    assert_eq!(ours(turned[0]), ours(turned[1]));
}

/// `quirk_null_boxes`: with nothing in the scene, OGRE fits all that the camera sees, from the world's origin. Ours sees nothing.
#[test]
fn an_empty_scene_is_nothing() {
    for case in cases(1, |case| case.has_tag("quirk_null_boxes")) {
        assert!(case.casters().is_empty() && case.receivers().is_empty());
        // The frustum's eight corners, and the same moved toward the light.
        assert_eq!(case.body_b().len(), 16);
        assert_eq!(case.nearest(), DVec3::ZERO);
        let eye: Eye<'_> = case.eye();
        assert_eq!(visible_range(&eye, Aabb::EMPTY, f64::INFINITY), None);
        let LightKind::Directional { direction } = case.light().kind else { unreachable!("the case has parallel light") };
        let frame = LightFrame::parallel(direction);
        let body_of = |casters, bounds| visible_body(&eye, case.planes(), &Subject::unseen(casters, bounds), &frame);
        let body = body_of(&[], Aabb::EMPTY);
        assert!(body.is_empty(), "{:?}", body.vertices());
        // Nor is there anything where nothing is drawn, or where nothing throws a shadow.
        let scene = [Aabb::new(Vec3::new(-15.0, -1.0, -15.0), Vec3::new(15.0, 5.0, 15.0))];
        assert!(body_of(&scene, Aabb::EMPTY).is_empty() && body_of(&[], scene[0]).is_empty());
        assert!(!body_of(&scene, scene[0]).is_empty());
        let view = focused_view(&frame, &Content::new(body.vertices(), &[]), 1024, 2);
        assert_eq!(view.outcome, FitOutcome::NothingVisible);
    }
}
