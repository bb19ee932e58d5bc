//! LiSPSM and the focused fit: the warp's parameter by its closed forms, how it fades, and how small a window is.

use shadow_math::{
    Camera, Projection,
    bounds::Aabb,
    fit::{
        Content, Eye, FallBack, LightFrame, Subject, ViewFit, Window, boxed_view, focused_view, lispsm_view, optimal_warp,
        visible_body,
    },
    glam::{DQuat, DVec2, DVec3, Vec3},
};

use super::scenes::Random;

const SIZE: u32 = 256;
const GUARD: u32 = 2;

fn camera(eye: DVec3, target: DVec3) -> Camera {
    let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.5, far: Some(100.0) };
    Camera::look_at(eye, target, projection).expect("it looks away from itself")
}

fn eye_of(camera: Camera) -> Eye<'static> {
    Eye { camera, aspect: 1.5, samples: &[], plane: None }
}

/// What a camera sees of a box that casts its own shadows.
fn body(camera: Camera, frame: &LightFrame) -> (Vec<DVec3>, [Aabb; 1]) {
    let bounds = Aabb::new(Vec3::new(-20.0, -0.5, -20.0), Vec3::new(20.0, 3.0, 20.0));
    let subject = Subject { eye: Some(eye_of(camera)), ..Subject::unseen(&[], bounds) };
    let casters = [bounds];
    let subject = Subject { casters: &casters, ..subject };
    (visible_body(&eye_of(camera), [0.5, 100.0], &subject, frame).vertices().to_vec(), casters)
}

fn suns() -> impl Iterator<Item = (Camera, LightFrame)> {
    let mut random = Random(11);
    (0..200).map(move |_| {
        let eye = DVec3::new(random.between(-10.0, 10.0), random.between(1.0, 6.0), random.between(5.0, 15.0));
        let camera = camera(eye, random.point() * 3.0);
        (camera, LightFrame::parallel((random.direction() - DVec3::Y).as_vec3()))
    })
}

fn lamps() -> impl Iterator<Item = (Camera, LightFrame)> {
    let mut random = Random(12);
    (0..200).map(move |_| {
        let eye = DVec3::new(random.between(-10.0, 10.0), random.between(1.0, 6.0), random.between(5.0, 15.0));
        let place = (random.point() * 5.0 + DVec3::Y * 12.0).as_vec3();
        let down = random.direction() * 0.5 - DVec3::Y;
        (camera(eye, random.point() * 3.0), LightFrame::perspective(place, down, 1.2_f64.tan(), f64::INFINITY))
    })
}

/// `(z_n + sqrt(z_n z_f)) / sin gamma`.
#[test]
fn the_best_parameter_of_parallel_light_is_that_of_the_paper() {
    for (camera, frame) in suns() {
        let (points, _) = body(camera, &frame);
        let distances: Vec<_> = points.iter().map(|point| camera.direction().dot(*point - camera.eye)).collect();
        let (near, far) = distances.iter().fold((f64::INFINITY, 0.0_f64), |(near, far), d| (near.min(*d), far.max(*d)));
        let sine = camera.direction().cross(frame.rotation * DVec3::Z).length();
        let expected = (near + (near * far).sqrt()) / sine;
        let warp = optimal_warp(&frame, &eye_of(camera), &points).expect("the light is not along the view");
        // Rounding of f64.
        assert!((warp.parameter - expected).abs() < 1e-9 * expected, "{} is not {expected}", warp.parameter);
    }
}

/// The first paper's other form: with d the depth of the body along the image's axis, `d / (sqrt(z1 / z0) - 1)`, where z0 and z1 are the distances from the camera at both ends.
#[test]
fn both_forms_of_the_paper_agree_where_the_ends_are_planes() {
    for gamma in [0.2_f64, 0.7, 1.2, core::f64::consts::FRAC_PI_2] {
        // The camera looks along -z, and the light comes at this angle to it.
        let frame = LightFrame::parallel(DVec3::new(0.0, -gamma.sin(), -gamma.cos()).as_vec3());
        let camera = camera(DVec3::ZERO, DVec3::NEG_Z);
        let (z0, z1) = (2.0_f64, 50.0_f64);
        // In the plane of both directions the image's axis is across the light; a body that lies along it has length over sine of depth.
        let along = DVec3::new(0.0, gamma.cos(), -gamma.sin());
        let points = [along * (z0 / gamma.sin()), along * (z1 / gamma.sin())];
        let d = (z1 - z0) / gamma.sin();
        let warp = optimal_warp(&frame, &eye_of(camera), &points).expect("the light is not along the view");
        let expected = d / ((z1 / z0).sqrt() - 1.0);
        // The direction is given in single precision.
        assert!((warp.parameter - expected).abs() < 1e-6 * expected, "{} is not {expected}", warp.parameter);
    }
}

fn w_range(view: &ViewFit, points: &[DVec3]) -> [f64; 2] {
    let ws = points.iter().map(|point| (view.clip_from_world() * point.extend(1.0)).w);
    ws.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], w| [least.min(w), most.max(w)])
}

/// w grows with the distance from the camera, and texels with it: on a line of sight that lies across the light, and on the average of all that is seen.
#[test]
fn what_is_near_has_more_of_the_samples() {
    for (camera, frame) in suns() {
        let (points, casters) = body(camera, &frame);
        let warp = optimal_warp(&frame, &eye_of(camera), &points).expect("the light is not along the view");
        let view = lispsm_view(&frame, camera.eye, warp, &Content::new(&points, &casters), SIZE, GUARD);
        if view.is_warped {
            let w = view.clip_from_world().row(3).truncate();
            assert!(w.dot(camera.direction()) > 0.0, "w falls along the view {}", camera.direction());
        }
    }
}

/// As the camera turns toward the light, w becomes the same everywhere, bit by bit, and in the end the view is the box's own.
#[test]
fn warps_fade_as_the_camera_turns_along_the_light() {
    let frame = LightFrame::parallel(Vec3::new(0.0, -1.0, -0.2));
    let toward = frame.rotation * DVec3::Z;
    let mut before: Option<f64> = None;
    let mut unwarped = 0;
    for step in 0..4000 {
        // From a right angle down to a millionth of one.
        let angle = core::f64::consts::FRAC_PI_2 * 10_f64.powf(-6.0 * f64::from(step) / 4000.0);
        let across = toward.cross(DVec3::X).normalize();
        let direction = -toward * angle.cos() + across * angle.sin();
        let place = DVec3::new(0.0, 30.0, 0.0) - 5.0 * direction;
        let camera = camera(place, place + direction);
        let (points, casters) = body(camera, &frame);
        if points.is_empty() {
            continue;
        }
        let warp = optimal_warp(&frame, &eye_of(camera), &points).expect("there is an angle");
        let content = Content::new(&points, &casters);
        let view = lispsm_view(&frame, place, warp, &content, SIZE, GUARD);
        let [least, most] = w_range(&view, &points);
        let ratio = most / least;
        if let Some(before) = before {
            // A step turns by a third of a percent of the angle; the ratio follows as continuously as the body does.
            assert!((ratio / before - 1.0).abs() < 0.1, "{before} to {ratio} at {angle}");
        }
        before = Some(ratio);
        if !view.is_warped {
            unwarped += 1;
            assert_eq!(view, boxed_view(&frame.rolled(warp.toward_camera), &content, SIZE, GUARD));
        }
        if angle < 1e-3 {
            assert!(ratio < 1.05, "{ratio} at {angle}");
        }
    }
    assert!(unwarped > 100, "{unwarped} views are the box's");
    let along = camera(toward * 40.0, DVec3::ZERO);
    let (points, _) = body(along, &frame);
    assert_eq!(optimal_warp(&frame, &eye_of(along), &points), Err(FallBack::LightAlongView));
}

/// A light's frame is turned about its axis at will: the map that comes of it is the same, to the last texel.
#[test]
fn a_turn_of_the_lights_frame_changes_nothing() {
    for (camera, frame) in suns().chain(lamps()) {
        let mut random = Random(camera.eye.x.to_bits());
        let turned = frame.rolled(DVec2::from_angle(random.between(0.0, 6.0)));
        let [(one, points), (other, _)] = [frame, turned].map(|frame| {
            // The sides of what a lamp reaches turn with the frame: they are left out.
            let frame = LightFrame { reach: if frame.is_perspective { 3.0 } else { frame.reach }, ..frame };
            let (points, casters) = body(camera, &LightFrame { rotation: DQuat::IDENTITY, is_perspective: false, ..frame });
            let view = frame.view_from_world();
            let points: Vec<_> =
                points.into_iter().filter(|point| !frame.is_perspective || view.transform_point3(*point).z < -1.0).collect();
            let Ok(warp) = optimal_warp(&frame, &eye_of(camera), &points) else { return (None, points) };
            let view = lispsm_view(&frame, camera.eye, warp, &Content::new(&points, &casters), SIZE, GUARD);
            (Some((view, warp.parameter)), points)
        });
        let (Some((one, parameter)), Some((other, other_parameter))) = (one, other) else { continue };
        assert!((parameter - other_parameter).abs() < 1e-9 * parameter);
        for point in &points {
            let [a, b] = [one, other].map(|view| view.clip_from_world().project_point3(*point));
            // Rounding of f64.
            assert!((a - b).length() < 1e-8, "{a} and {b}");
        }
    }
}

/// The area of a view's window, in the image's units.
fn area(view: &ViewFit) -> f64 {
    let [width, height] = view.texel_metres;
    width * height
}

#[test]
fn no_turn_makes_a_smaller_window_than_the_focused_one() {
    for (camera, frame) in suns().chain(lamps()).step_by(8) {
        let (points, casters) = body(camera, &frame);
        if points.is_empty() {
            continue;
        }
        let content = Content::new(&points, &casters);
        let focused = area(&focused_view(&frame, &content, SIZE, GUARD));
        for step in 0..1000 {
            let roll = DVec2::from_angle(f64::from(step) * 1e-3 * core::f64::consts::PI);
            let boxed = area(&boxed_view(&frame.rolled(roll), &content, SIZE, GUARD));
            // Of areas that are equal but for one part in 10^9 any is taken.
            assert!(focused <= boxed * (1.0 + 2e-9), "{focused} is more than {boxed}");
        }
    }
}

/// The window touches the image on all four sides, less the guard band.
#[test]
fn a_window_is_no_larger_than_its_content() {
    for (camera, frame) in suns().chain(lamps()) {
        let (points, casters) = body(camera, &frame);
        if points.is_empty() {
            continue;
        }
        let content = Content::new(&points, &casters);
        let mut views = vec![boxed_view(&frame, &content, SIZE, GUARD), focused_view(&frame, &content, SIZE, GUARD)];
        if let Ok(warp) = optimal_warp(&frame, &eye_of(camera), &points) {
            views.push(lispsm_view(&frame, camera.eye, warp, &content, SIZE, GUARD));
        }
        for view in views {
            let ndc = points.iter().map(|point| view.clip_from_world().project_point3(*point).truncate());
            let Window { min, max } = Window::around(ndc).expect("the points have an image");
            let rim = DVec2::splat(1.0 - 2.0 * f64::from(GUARD) / f64::from(SIZE));
            // Rounding of f64, in strong warps a thousandfold.
            assert!((max - rim).length() < 1e-9 && (min + rim).length() < 1e-9, "{min} to {max} instead of {rim}");
        }
    }
}
