//! Cascades that stand still.

use shadow_math::{
    Bias, Camera, Cascades, Fit, Light, LightKind, Projection, ShadowSettings, Split,
    bounds::Aabb,
    fit::{CascadeSphere, Eye, Subject},
    frustum::Frustum,
    glam::{DQuat, DVec2, DVec3, DVec4, EulerRot, Vec3},
    plan::{MAX_VIEWS_PER_LIGHT, ViewPlan, plan_light},
    rounding::UNIT_ROUNDOFF,
};

use super::scenes::Random;

/// The distances from a place on the camera's axis to the corners of a slice: the farthest of the near ones and of the far ones.
fn corner_distances(slice: &Frustum, place: DVec3) -> [f64; 2] {
    let farthest = |corners: &[DVec3]| corners.iter().map(|corner| corner.distance(place)).fold(0.0, f64::max);
    [farthest(&slice.corners[..4]), farthest(&slice.corners[4..])]
}

#[test]
fn the_sphere_is_the_smallest_on_the_axis() {
    let random = &mut Random(1);
    for turn in 0..300 {
        let near = random.power(-2.0, 1.0);
        let far = near * (1.0 + random.power(-2.0, 2.0));
        let projection = if turn % 3 == 0 {
            Projection::Orthographic { half_height: random.power(-1.0, 1.0), near: 0.0, far: 1e4 }
        } else {
            Projection::Perspective { vertical_fov: random.between(0.05, 2.8), near: 1e-3, far: None }
        };
        let aspect = random.between(0.4, 2.5);
        let sphere = CascadeSphere::around(projection, aspect, [near, far]);
        let camera = Camera { eye: random.point(), orientation: DQuat::from_rotation_y(random.between(0.0, 6.0)), projection };
        let slice = Frustum::slice(&camera, aspect, near, far).expect("the slice has two ends");
        let [near_corner, far_corner] = corner_distances(&slice, camera.eye + camera.direction() * sphere.distance);
        // Rounding of f64.
        let rounding = 1e-12 * (1.0 + far + sphere.radius);
        assert!((far_corner - sphere.radius).abs() < rounding && near_corner <= sphere.radius + rounding, "{sphere:?}");
        // Beyond the far face as well: a middle there would only be farther from all.
        for step in 0..=2000 {
            let distance = near + (1.5 * far - near) * f64::from(step) / 2000.0;
            let [a, b] = corner_distances(&slice, camera.eye + camera.direction() * distance);
            assert!(a.max(b) >= sphere.radius - rounding, "{} at {distance} is smaller than {sphere:?}", a.max(b));
        }
    }
}

/// A scene of 60 m.
const SCENE: Aabb = Aabb { min: Vec3::new(-30.0, -2.0, -30.0), max: Vec3::new(30.0, 8.0, 30.0) };

/// The plan of four cascades of a scene, for a camera at a place relative to the scene's origin.
fn plan(camera: Camera, bounds: Aabb, origin: DVec3, stabilised: bool) -> Vec<ViewPlan> {
    let casters = [bounds];
    let eye = Eye { camera, aspect: 1.6, samples: &[], plane: None };
    let subject = Subject { casters: &casters, bounds, origin, eye: Some(eye) };
    let kind = LightKind::Directional { direction: Vec3::new(0.35, -0.8, 0.21) };
    let sun = Light { kind, color: Vec3::ONE, intensity: 1.0 };
    let split = Split::Cascades(Cascades { stabilised, ..Cascades::default() });
    let settings = ShadowSettings { fit: Fit::Uniform, split, map_size: 1024, bias: Bias::NONE, ..ShadowSettings::default() };
    let mut views = vec![ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
    let light = plan_light(&sun, &subject, &settings, [0, 0], &mut views).expect("the scene can be planned");
    views.truncate(light.view_count as usize);
    views
}

/// Where a point is in a view, in texels, and by how much the rounding of the view's rows can move it.
fn texel(view: &ViewPlan, point: DVec3) -> (DVec2, f64) {
    let row = |numbers: [f32; 4]| DVec4::from_array(numbers.map(f64::from));
    let at = |numbers| row(numbers).dot(point.extend(1.0));
    let scale = DVec2::from(view.texel_scale.map(f64::from));
    let offset = DVec2::from(view.texel_offset.map(f64::from));
    let size = |numbers| row(numbers).abs().dot(point.abs().extend(1.0));
    let rounding = UNIT_ROUNDOFF * scale.abs().max_element() * size(view.clip_x).max(size(view.clip_y));
    (DVec2::new(at(view.clip_x), at(view.clip_y)) * scale + offset, rounding)
}

/// By how much two numbers differ but for whole ones.
fn off(a: DVec2, b: DVec2) -> f64 {
    let d = a - b;
    (d - d.round()).abs().max_element()
}

/// The most by which a fixed point's place within its texel differs between poses, in texels, and the most that rounding explains.
fn drift(origin: DVec3, stabilised: bool) -> (f64, f64) {
    let random = &mut Random(9);
    let point = DVec3::new(3.217, 0.5, -4.411);
    let mut first: Option<Vec<(DVec2, f64)>> = None;
    let (mut most, mut explained) = (0.0_f64, 0.0_f64);
    for _ in 0..300 {
        let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far: Some(80.0) };
        let turn =
            DQuat::from_euler(EulerRot::YXZ, random.between(0.0, 6.3), random.between(-1.0, 1.0), random.between(-0.3, 0.3));
        let camera = Camera { eye: random.point() * DVec3::new(20.0, 3.0, 20.0), orientation: turn, projection };
        let places: Vec<_> = plan(camera, SCENE, origin, stabilised).iter().map(|view| texel(view, point)).collect();
        let Some(first) = &first else {
            first = Some(places);
            continue;
        };
        for ((here, rounding), (there, other_rounding)) in places.iter().zip(first) {
            most = most.max(off(*here, *there));
            explained = explained.max(rounding + other_rounding);
        }
    }
    (most, explained)
}

#[test]
fn texels_stand_still_while_the_camera_moves_and_turns() {
    for distance in [0.0, 1e4, 1e5, 6.4e6] {
        let origin = DVec3::new(0.48, 0.6, -0.64) * distance;
        let (stabilised, explained) = drift(origin, true);
        let (unstabilised, _) = drift(origin, false);
        // Beside the rows' rounding there is that of f64: 64 units of the place in texels, which are a centimetre wide at least.
        let double = 64.0 * f64::EPSILON * (distance + 100.0) / 0.01;
        assert!(
            stabilised <= explained + double,
            "at {distance} m texels move by {stabilised}, of which rounding explains {explained}; unstabilised by {unstabilised}"
        );
        assert!(explained < 0.01, "{explained} texels are next to nothing");
        assert!(unstabilised > 0.25, "cascades that follow the camera move by any part of a texel, not just {unstabilised}");
    }
}

/// A scene that is counted from another origin has the same texels in the world: origins can follow the camera.
#[test]
fn texels_do_not_follow_the_scenes_origin() {
    let point = DVec3::new(3.25, 0.5, -4.375);
    for (far, world) in [Some(40.0), None].into_iter().flat_map(|far| [0.0, 1e4, 6.4e6].map(|world| (far, world))) {
        let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far };
        let camera = Camera { eye: DVec3::new(1.0, 2.0, 8.0), orientation: DQuat::IDENTITY, projection };
        let origin = DVec3::new(world, 0.0, -0.5 * world);
        let home = plan(camera, SCENE, origin, true);
        // Exact steps, so that nothing but the fit rounds.
        for step in [DVec3::new(1.015625, 0.0, 0.0), DVec3::new(-7.328125, 3.15625, 11.78125)] {
            let moved = Camera { eye: camera.eye - step, ..camera };
            let bounds = Aabb::new(SCENE.min - step.as_vec3(), SCENE.max - step.as_vec3());
            for (here, there) in home.iter().zip(&plan(moved, bounds, origin + step, true)) {
                let ((a, rounding), (b, other_rounding)) = (texel(here, point), texel(there, point - step));
                // Rounding of f64, at such places in texels of a centimetre and more.
                let double = 64.0 * f64::EPSILON * (world + 100.0) / 0.01;
                assert!(off(a, b) <= rounding + other_rounding + double, "{a} and {b}, at {world} m with an end at {far:?}");
            }
        }
    }
}

/// What moves in the scene, and with it the scene's bounds, leaves the texels where they are.
#[test]
fn texels_do_not_follow_the_scenes_bounds() {
    let point = DVec3::new(3.25, 0.5, -4.375);
    for far in [Some(40.0), None] {
        let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far };
        let camera = Camera { eye: DVec3::new(1.0, 2.0, 8.0), orientation: DQuat::IDENTITY, projection };
        let home = plan(camera, SCENE, DVec3::ZERO, true);
        for raised in [Vec3::Y, Vec3::new(4.0, 3.0, -1.0)] {
            let bounds = Aabb::new(SCENE.min, SCENE.max + raised);
            for (here, there) in home.iter().zip(&plan(camera, bounds, DVec3::ZERO, true)) {
                let ((a, rounding), (b, other_rounding)) = (texel(here, point), texel(there, point));
                assert!((a - b).abs().max_element() <= rounding + other_rounding, "{a} and {b}, with an end at {far:?}");
            }
        }
    }
}

/// A camera that sees without an end from far away is given a longer last cascade, by steps of 2, and nothing changes within a step.
#[test]
fn radii_do_not_follow_the_pose() {
    let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far: None };
    let widths = |eye: DVec3, turn: f64| -> Vec<f32> {
        let camera = Camera { eye, orientation: DQuat::from_rotation_y(turn), projection };
        plan(camera, SCENE, DVec3::ZERO, true).iter().map(|view| view.texel_metres[0]).collect()
    };
    let home = widths(DVec3::ZERO, 0.0);
    let random = &mut Random(2);
    for _ in 0..100 {
        assert_eq!(widths(random.point() * 20.0, random.between(0.0, 6.0)), home);
    }
    let last = |widths: Vec<f32>| widths[3];
    let far = last(widths(DVec3::X * 200.0, 0.0));
    assert!(far > 1.9 * home[3], "{far} is no longer the cascade of {home:?}");
    assert_eq!(far, last(widths(DVec3::Z * 190.0, 1.0)), "both lie between two steps");
}
