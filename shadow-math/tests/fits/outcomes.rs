//! Whatever the scene, a plan has numbers, and says what became of its fit.

use std::collections::BTreeMap;

use proptest::prelude::*;
use shadow_math::{
    Camera, Fit, Light, LightKind, PlanError, Projection, ShadowSettings, Split,
    bounds::Aabb,
    fit::{FallBack, FitOutcome},
    glam::{DQuat, DVec3, DVec4, Vec3},
    plan::{LightPlan, ViewPlan},
};

use super::scenes::{Case, bytemuck_filled, case};

fn assert_finite<T: bytemuck::NoUninit>(plan: &T, what: &str) {
    // Whole numbers, read as floats, are too small to be anything but finite.
    let floats =
        bytemuck::bytes_of(plan).chunks_exact(4).map(|bytes| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    for (i, float) in floats.enumerate() {
        assert!(float.is_finite(), "number {i} of the {what} is {float}");
    }
}

fn check(light: &LightPlan, views: &[ViewPlan]) {
    assert_finite(light, "light");
    for view in views {
        assert_finite(view, "view");
        let outcome = FitOutcome::of_code(view.fit_outcome).expect("every view says how it came about");
        assert_eq!(view.has_map(), outcome != FitOutcome::NothingVisible, "nothing has no map, and all else has one");
    }
    let layers: Vec<_> = views.iter().filter(|view| view.has_map()).map(|view| view.layer).collect();
    assert_eq!(layers, (0..layers.len() as u32).collect::<Vec<_>>(), "each map takes the next layer");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn plans_are_finite_and_whole(seed in any::<u64>()) {
        let case = case(seed, &Fit::ALL, [1e-3, 1e6], 12);
        if let Ok((light, views)) = case.plan() {
            check(&light, &views);
            let (again, others) = case.plan_over(bytemuck_filled(0x55)).expect("it could be planned before");
            prop_assert_eq!(bytemuck::bytes_of(&light), bytemuck::bytes_of(&again));
            let bytes = bytemuck::cast_slice::<_, u8>;
            prop_assert_eq!(bytes(&views), bytes(&others), "nothing is left of what was there before");
        }
    }
}

/// Random scenes are refused for what they ask, not because numbers overflow; and each outcome comes up.
#[test]
fn random_scenes_have_every_outcome_and_none_overflows() {
    let mut outcomes = BTreeMap::new();
    for seed in 0..10_000 {
        // OGRE's box has the width of 300 near planes' distances: of an orthographic camera's own, whose least is 0, it has none.
        let fits = Fit::ALL;
        let what = match case(seed, &fits, [1e-3, 1e6], 12).plan() {
            Ok((_, views)) => {
                for view in views {
                    *outcomes.entry(format!("{:?}", view.outcome())).or_insert(0) += 1;
                }
                continue;
            }
            Err(error) => format!("{error:?}").chars().take_while(|c| c.is_alphabetic()).collect(),
        };
        *outcomes.entry(what).or_insert(0) += 1;
    }
    let fall_backs = ["LightAlongView", "LightInPlane", "PlaneOutOfView", "NoPlane"];
    let fall_backs = fall_backs.map(|why| format!("FellBackToUniform {{ why: {why} }}"));
    for expected in ["Fitted".to_string(), "NothingVisible".to_string()].iter().chain(&fall_backs) {
        assert!(outcomes.contains_key(expected), "{expected} is not among {outcomes:?}");
    }
    assert!(!outcomes.contains_key("LightOverflow"), "{outcomes:?}");
}

/// A box of 2 m on a floor of 20 m, a sun from the side, and a camera of 60 degrees that looks at it from 6 m away.
fn street(fit: Fit) -> Case {
    let floor = Aabb::new(Vec3::new(-10.0, 0.0, -10.0), Vec3::new(10.0, 0.0, 10.0));
    let block = Aabb::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0));
    let projection = Projection::Perspective { vertical_fov: 1.0, near: 0.1, far: None };
    Case {
        light: Light { kind: LightKind::Directional { direction: Vec3::new(0.4, -1.0, 0.3) }, color: Vec3::ONE, intensity: 1.0 },
        casters: vec![floor, block],
        bounds: floor.union(block),
        camera: Camera::look_at(DVec3::new(0.0, 2.0, 6.0), DVec3::Y, projection).expect("it looks at the block"),
        aspect: 1.5,
        samples: Vec::new(),
        plane: Some(DVec4::Y),
        settings: ShadowSettings { fit, ..ShadowSettings::default() },
    }
}

fn fell_back(why: FallBack) -> FitOutcome {
    FitOutcome::FellBackToUniform { why }
}

#[track_caller]
fn expect(case: &Case, expected: FitOutcome) {
    let (light, views) = case.plan().expect("the scene can be planned");
    check(&light, &views);
    for view in views {
        assert_eq!(view.outcome(), expected, "{:?}", case.settings.fit);
    }
}

const FOLLOWING: [Fit; 4] = [Fit::Focused, Fit::Lispsm, Fit::PlaneOptimal, Fit::OgreLispsm];

#[test]
fn every_fit_of_a_plain_scene_is_what_was_asked_for() {
    for fit in Fit::ALL {
        expect(&street(fit), FitOutcome::Fitted);
    }
}

/// The camera's near plane lies deep in the block.
#[test]
fn a_camera_inside_a_caster_is_fitted() {
    for fit in FOLLOWING {
        let mut case = street(fit);
        case.camera.eye = DVec3::new(0.3, 1.0, 0.2);
        expect(&case, FitOutcome::Fitted);
    }
}

#[test]
fn a_light_inside_the_frustum_is_fitted() {
    for fit in [Fit::Focused, Fit::Lispsm, Fit::OgreLispsm] {
        for outer in [0.5, 1.2] {
            let mut case = street(fit);
            let (position, direction) = (Vec3::new(0.5, 3.0, 1.5), Vec3::new(0.2, -1.0, 0.1));
            case.light.kind = LightKind::Spot { position, direction, inner: 0.1, outer, range: None };
            expect(&case, FitOutcome::Fitted);
        }
    }
}

/// A point light in the middle of the block has its near plane by rule, and all six faces of its cube see the block or the floor.
#[test]
fn a_light_inside_a_caster_is_planned() {
    let mut case = street(Fit::Focused);
    case.light.kind = LightKind::Point { position: Vec3::Y, range: None };
    let (light, views) = case.plan().expect("the scene can be planned");
    check(&light, &views);
    assert_eq!(views.iter().filter(|view| view.has_map()).count(), 6);
}

#[test]
fn a_camera_that_looks_along_the_light_is_not_warped() {
    for sign in [1.0, -1.0] {
        let mut case = street(Fit::Lispsm);
        case.light.kind = LightKind::Directional { direction: (sign * case.camera.direction()).as_vec3() };
        // Directions are given in single precision: a turn by as much.
        case.camera = Camera {
            orientation: DQuat::from_rotation_arc(case.camera.direction(), {
                let LightKind::Directional { direction } = case.light.kind else { unreachable!("it was set above") };
                sign * direction.as_dvec3().normalize()
            }) * case.camera.orientation,
            ..case.camera
        };
        expect(&case, fell_back(FallBack::LightAlongView));
    }
}

#[test]
fn what_nothing_shadows_or_nobody_sees_has_no_map() {
    for fit in FOLLOWING {
        let mut turned = street(fit);
        turned.camera.orientation = DQuat::from_rotation_y(core::f64::consts::PI) * turned.camera.orientation;
        turned.camera.eye.z = 30.0;
        expect(&turned, FitOutcome::NothingVisible);
        let mut short = street(fit);
        short.settings.shadow_distance = Some(0.05);
        expect(&short, FitOutcome::NothingVisible);
        let mut beyond = street(fit);
        beyond.camera.eye.z = 500.0;
        beyond.camera.projection = Projection::Perspective { vertical_fov: 1.0, near: 0.1, far: Some(400.0) };
        expect(&beyond, FitOutcome::NothingVisible);
    }
    for fit in [Fit::Focused, Fit::Lispsm, Fit::OgreLispsm] {
        let mut empty = street(fit);
        empty.casters.clear();
        expect(&empty, FitOutcome::NothingVisible);
        let mut out_of_reach = street(fit);
        out_of_reach.light.kind =
            LightKind::Spot { position: Vec3::Y * 9.0, direction: Vec3::Y, inner: 0.1, outer: 0.5, range: None };
        expect(&out_of_reach, FitOutcome::NothingVisible);
    }
}

/// A wall without thickness, and a scene of one point.
#[test]
fn flat_scenes_are_fitted() {
    for fit in [Fit::Uniform, Fit::Focused, Fit::Lispsm, Fit::OgreLispsm] {
        for half in [Vec3::new(2.0, 2.0, 0.0), Vec3::new(2.0, 0.0, 0.0), Vec3::ZERO] {
            let mut case = street(fit);
            case.bounds = Aabb::new(Vec3::Y - half, Vec3::Y + half);
            case.casters = vec![case.bounds];
            expect(&case, FitOutcome::Fitted);
        }
    }
}

#[test]
fn near_and_far_planes_that_almost_meet_are_fitted() {
    for fit in [Fit::Focused, Fit::Lispsm, Fit::OgreLispsm] {
        let mut case = street(fit);
        case.camera.projection = Projection::Perspective { vertical_fov: 1.0, near: 5.0, far: Some(5.0 * (1.0 + 1e-12)) };
        expect(&case, FitOutcome::Fitted);
    }
}

#[test]
fn orthographic_cameras_are_fitted() {
    for fit in Fit::ALL {
        let mut case = street(fit);
        // OGRE's box has the width of 300 times the near plane's distance.
        let near = if fit == Fit::OgreUniform { 0.1 } else { 0.0 };
        case.camera.projection = Projection::Orthographic { half_height: 2.0, near, far: 30.0 };
        expect(&case, FitOutcome::Fitted);
    }
}

#[test]
fn a_plane_that_has_no_image_falls_back() {
    let with = |change: &dyn Fn(&mut Case)| {
        let mut case = street(Fit::PlaneOptimal);
        change(&mut case);
        case
    };
    let grazing = LightKind::Directional { direction: Vec3::X };
    expect(&with(&|case| case.light.kind = grazing), fell_back(FallBack::LightInPlane));
    let in_plane = LightKind::Point { position: Vec3::new(3.0, 0.0, 1.0), range: None };
    expect(&with(&|case| case.light.kind = in_plane), fell_back(FallBack::LightInPlane));
    expect(&with(&|case| case.camera.eye.y = 0.0), fell_back(FallBack::CameraInPlane));
    expect(&with(&|case| case.plane = None), fell_back(FallBack::NoPlane));
    expect(&with(&|case| case.plane = Some(DVec4::new(0.0, 1.0, 0.0, 100.0))), fell_back(FallBack::PlaneOutOfView));
    let vast = with(&|case| {
        case.camera.projection = Projection::Orthographic { half_height: 2.0, near: 0.0, far: 30.0 };
        case.camera.orientation = DQuat::IDENTITY;
    });
    expect(&vast, fell_back(FallBack::CameraInPlane));
}

/// What is given as the plane is refused before anything is fitted to it.
#[test]
fn a_plane_without_a_normal_is_refused() {
    for plane in [[0.0, 0.0, 0.0, 1.0], [0.0, f32::NAN, 0.0, 1.0]] {
        let mut case = street(Fit::PlaneOptimal);
        case.settings.plane = Some(plane);
        assert!(matches!(case.plan(), Err(PlanError::Plane(_))));
    }
    let mut cube = street(Fit::Focused);
    cube.settings.split = Split::Cube;
    assert_eq!(cube.plan().expect_err("a sun is nowhere"), PlanError::CubeAroundDirection);
}
