//! OGRE's focused and LiSPSM matrices: all of x, y and z.

use glam::{DMat4, DVec3};
use shadow_math::{
    LightKind,
    fit::{
        Content, LightFrame, LispsmWarp, OgreLightSpace, OgreSetup, ViewFit, lispsm_view, ogre_standard_matrix, ogre_tweak,
        ogre_warp, optimal_warp,
    },
};

use crate::{
    bodies::is_focused,
    data::{Case, cases, ndc},
    uniform::setup,
};

/// What OGRE loses in NDC over the body.
const TOLERANCE: f64 = 1e-4;

/// The same where the body is hundreds of kilometres long.
const TOLERANCE_AT_100_KM: f64 = 1e-3;

/// What OGRE's parameters lose, as a share: they come from a distance to a point that has been clipped by several planes, in coordinates some hundred times as large.
const PARAMETER_TOLERANCE: f64 = 1e-4;

pub(crate) fn tolerance(case: &Case) -> f64 {
    if case.id.starts_with("pssm_ctor_") { TOLERANCE_AT_100_KM } else { TOLERANCE }
}

/// Cases that have a body and a direction: 46 of all.
pub(crate) fn is_stable(case: &Case) -> bool {
    is_focused(case) && !case.body_b().is_empty() && !case.has_tag("unstable_direction")
}

fn is_warped(case: &Case) -> bool {
    matches!(case.setup.as_str(), "lispsm" | "pssm")
}

/// What the focused setups are told: lights aim from 3000 near distances where nothing is said, ten times what the default setup takes.
fn focused_setup(case: &Case) -> OgreSetup {
    let mut setup = setup(case);
    if case.light.shadow_far_distance == 0.0 {
        setup.far_distance = 3000.0 * case.planes()[0];
    }
    setup
}

pub(crate) fn standard(case: &Case) -> DMat4 {
    ogre_standard_matrix(&case.light(), &case.camera(), &focused_setup(case), case.light_planes())
}

pub(crate) fn light_space(case: &Case) -> OgreLightSpace {
    OgreLightSpace::new(standard(case), &case.camera(), case.nearest()).expect("the camera looks across the light")
}

/// The tweak, of what OGRE takes for the light's direction.
pub(crate) fn tweak(case: &Case) -> f64 {
    // Cascades have the threshold by default.
    ogre_tweak(case.camera().direction().dot(case.direction_for_ogre()).abs(), case.threshold())
}

/// The parameter in its simple form.
fn simple_warp(case: &Case) -> f64 {
    let nearest = case.eye().distance_row().dot(case.nearest().extend(1.0));
    ogre_warp(nearest, case.planes(), case.adjust_factor(), tweak(case))
}

/// The parameter in its general form.
pub(crate) fn general_warp(case: &Case) -> f64 {
    light_space(case).general_warp(&case.body_b(), case.planes()[0], case.adjust_factor(), tweak(case))
}

/// The greatest difference in NDC between two matrices over some points.
fn difference(ours: DMat4, ogre: DMat4, points: &[DVec3]) -> f64 {
    let at = |matrix, point| ndc(matrix, point).expect("the body lies before the light");
    points.iter().map(|&point| (at(ours, point) - at(ogre, point)).abs().max_element()).fold(0.0, f64::max)
}

/// The matrices that OGRE begins with, and ends with where there is nothing to fit.
#[test]
fn standard_matrices_are_ogres() {
    let mut empty = 0;
    for case in cases(50, is_focused) {
        let ours = standard(case);
        // A body of its own: a box of a metre around what the light sees in the middle, or around the origin for parallel light.
        let is_perspective = case.light_point().w != 0.0;
        let middle = ours.inverse().project_point3(DVec3::Z * if is_perspective { 0.9 } else { 0.0 });
        let points: Vec<_> = [DVec3::NEG_ONE, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE].map(|step| middle + step).to_vec();
        // In metres for parallel light, of coordinates as large as the camera's.
        let scale = if is_perspective { 1.0 } else { 1.0 + case.camera().eye.length() };
        assert!(difference(ours, case.standard(), &points) < TOLERANCE * scale, "{}", case.id);
        if case.body_b().is_empty() {
            assert!(difference(ours, case.clip_from_world(), &points) < TOLERANCE * scale, "{}", case.id);
            empty += 1;
        }
    }
    assert_eq!(empty, 2);
}

#[test]
fn tweaks_are_ogres() {
    for case in cases(35, is_warped) {
        let ogre = f64::from(case.intermediate.opt_adjust_tweak.expect("warped cases have it"));
        // The cosine is off by some roundings of 2^-24, and its distance from that of the threshold, a tenth, is scaled up to 20.
        assert!((tweak(case) - ogre).abs() < 1e-4, "{}: {} against {ogre}", case.id, tweak(case));
    }
}

#[test]
fn simple_parameters_are_ogres() {
    for case in cases(35, is_warped) {
        let ogre = f64::from(case.intermediate.n_opt_simple.expect("warped cases have it"));
        let ours = simple_warp(case);
        assert!((ours - ogre).abs() <= PARAMETER_TOLERANCE * ogre, "{}: {ours} against {ogre}", case.id);
    }
}

/// In all cases but those in which OGRE's search for a point of the plane fails.
#[test]
fn general_parameters_are_ogres() {
    let mut failed = Vec::new();
    for case in cases(22, |case| case.intermediate.n_opt_general.is_some()) {
        let ogre = f64::from(case.intermediate.n_opt_general.expect("these cases have it"));
        let ours = general_warp(case);
        if (ours - ogre).abs() > PARAMETER_TOLERANCE * ogre {
            failed.push((&case.id, ours, ogre));
        }
    }
    let names: Vec<_> = failed.iter().map(|(id, ..)| id.as_str()).collect();
    assert_eq!(names, ["lisp_dir_perp", "lisp_dir_perp_general"], "{failed:?}");
}

/// The parameter that a case's matrix is made with.
fn parameter(case: &Case) -> f64 {
    match (is_warped(case), case.params.use_simple_n_opt) {
        (false, _) => 0.0,
        // OGRE's own where it is wrong: this is about the matrix.
        (true, Some(false)) if case.has_tag("defect_n_opt") => {
            f64::from(case.intermediate.n_opt_general.expect("these cases have it"))
        }
        (true, Some(false)) => general_warp(case),
        (true, _) => simple_warp(case),
    }
}

#[test]
fn focused_and_warped_matrices_are_ogres() {
    let mut general = 0;
    for case in cases(46, is_stable) {
        let body = case.body_b();
        let ours = light_space(case).clip_from_world(&body, parameter(case));
        let difference = difference(ours, case.clip_from_world(), &body);
        assert!(difference < tolerance(case), "{}: {difference}", case.id);
        general += usize::from(case.params.use_simple_n_opt == Some(false));
    }
    assert_eq!(general, 6);
}

/// The renderer's own LiSPSM view with OGRE's body, axis and parameter.
fn our_view(case: &Case) -> ViewFit {
    let LightKind::Directional { direction } = case.light().kind else { unreachable!("the case has parallel light") };
    let (frame, body) = (LightFrame::parallel(direction), case.body_b());
    let warp = optimal_warp(&frame, &case.eye(), &body).expect("the camera looks across the light");
    lispsm_view(
        &frame,
        case.nearest(),
        LispsmWarp { parameter: parameter(case), ..warp },
        &Content::new(&body, &[case.casters()]),
        1024,
        0,
    )
}

/// For parallel light the renderer's warp is OGRE's, if it is given OGRE's body and parameter; depth has a range of its own.
///
/// For a light at a place it is another one: OGRE's image is four to three, and takes metres of the world for units of the image.
#[test]
fn the_renderers_warp_is_ogres_for_parallel_light() {
    for case in cases(29, |case| is_stable(case) && is_warped(case) && case.light.kind == "directional" && parameter(case) > 0.0)
    {
        let (ours, ogre) = (our_view(case).clip_from_world(), case.clip_from_world());
        for point in case.body_b() {
            let at = |matrix| ndc(matrix, point).expect("the body lies before the light");
            let difference = (at(ours) - at(ogre)).truncate().abs().max_element();
            assert!(difference < tolerance(case), "{}: {} against {}", case.id, at(ours), at(ogre));
            // Depth ends with the body. It begins with the casters, and OGRE's body goes on toward the light.
            assert!(at(ours).z < 1.0, "{}: {}", case.id, at(ours));
        }
    }
}
