//! The bodies that OGRE's focused setups fit, against ours of the same planes.

use glam::DVec3;
use shadow_math::polytope::Polytope;

use crate::data::{Case, cases, clipped, size, support_difference};

/// What OGRE's bodies lose to single precision and to clipping edge by edge, as a share of their size.
const TOLERANCE: f64 = 1e-4;

pub(crate) fn is_focused(case: &Case) -> bool {
    matches!(case.setup.as_str(), "focused" | "lispsm" | "pssm")
}

fn is_directional(case: &Case) -> bool {
    case.light.kind == "directional"
}

/// The body of what the camera sees.
fn view(case: &Case) -> Polytope {
    Polytope::from_frustum(&case.frustum())
}

/// The planes of a parallel light's body besides the camera's: the receivers' box, where there are any, and shadows' far distance.
fn directional_body(case: &Case) -> Polytope {
    let mut body = view(case);
    // OGRE does not clip by an empty box.
    if !case.receivers().is_empty() {
        body.clip_to_bounds(case.receivers());
    }
    let far = f64::from(case.light.shadow_far_distance);
    if far > 0.0 {
        let camera = case.camera();
        let axis = camera.direction();
        body.clip((-axis).extend(axis.dot(camera.eye) + far));
    }
    body
}

/// A body and its copy toward the light: by the far distance, or 3000 near distances without one.
fn extruded(case: &Case, body: &Polytope) -> Vec<DVec3> {
    let far = f64::from(case.light.shadow_far_distance);
    let by = if far > 0.0 { far } else { 3000.0 * case.planes()[0] };
    body.vertices().iter().flat_map(|&point| [point, point - case.direction_for_ogre() * by]).collect()
}

/// What both a light at a place and the camera see of the scene; for parallel light, what the camera does.
fn seen_body(case: &Case) -> Polytope {
    let mut body = clipped(view(case), &case.clip_planes());
    body.clip_to_bounds(case.merged());
    body
}

fn tolerance(ogre: &[DVec3]) -> f64 {
    TOLERANCE * size(ogre)
}

fn assert_same(case: &Case, what: &str, ours: &[DVec3], ogre: &[DVec3]) {
    let (difference, most) = (support_difference(ours, ogre), tolerance(ogre));
    assert!(difference <= most, "{}'s {what}: {difference} m is more than {most}", case.id);
}

#[test]
fn bodies_of_directional_lights_are_ogres() {
    let mut empty = Vec::new();
    for case in cases(40, |case| is_focused(case) && is_directional(case)) {
        let (ours, ogre) = (directional_body(case), case.body_b());
        assert_same(case, "body", &extruded(case, &ours), &ogre);
        if ogre.is_empty() {
            empty.push(&case.id);
        }
    }
    assert_eq!(empty, ["foc_dir_far10"], "where shadows end before the scene there is no body");
}

/// OGRE takes the hull of what is seen and the light, and cuts it by the scene and the light's frustum. In none of its cases does the hull add anything: what is left is what both see.
#[test]
fn bodies_of_lights_at_a_place_are_ogres() {
    let mut empty = Vec::new();
    for case in cases(10, |case| is_focused(case) && !is_directional(case)) {
        let ogre = case.body_b();
        assert_eq!(case.clip_planes().len(), 6, "{}", case.id);
        assert_same(case, "body", seen_body(case).vertices(), &ogre);
        if ogre.is_empty() {
            empty.push(&case.id);
        }
    }
    assert_eq!(empty, ["foc_spot_behind"], "where the light shines away from the scene there is no body");
}

/// The part of the scene that is seen, and its point nearest to the camera.
#[test]
fn what_is_seen_is_ogres() {
    let mut with_nearest = 0;
    // OGRE gives up before it asks where its body is empty.
    for case in cases(48, |case| is_focused(case) && !case.body_b().is_empty()) {
        let ours = seen_body(case);
        let ogre = case.body_lvs();
        // An empty scene is the camera's place, which the camera does not see.
        if case.has_tag("quirk_null_boxes") {
            assert!(ours.is_empty() && ogre.is_empty());
            continue;
        }
        assert_same(case, "visible part", ours.vertices(), &ogre);
        // The point nearest to the camera is one of them, as near as any.
        let row = case.eye().distance_row();
        let distance = |point: &DVec3| row.dot(point.extend(1.0));
        let nearest = ours.vertices().iter().map(distance).fold(f64::INFINITY, f64::min);
        assert!((distance(&case.nearest()) - nearest).abs() < tolerance(&ogre), "{}", case.id);
        with_nearest += 1;
    }
    assert_eq!(with_nearest, 47);
}
