//! OGRE's default setup: one uniform view for each light.

use glam::{DVec3, Vec3};
use shadow_math::{
    Light, LightKind,
    fit::{OgreSetup, Subject, ViewFit, ogre_frame, ogre_uniform_view},
};

use crate::data::{Case, apart, case, cases, ndc};

/// What OGRE loses in NDC x and y. A directional light's camera stands 10 km away, where single precision has steps of half a millimetre, and few of them add up: one part in ten thousand of the narrowest box, 80 m.
const TOLERANCE: f64 = 1e-4;

/// What a case tells the setup.
pub(crate) fn setup(case: &Case) -> OgreSetup {
    let Case { light, scene, .. } = case;
    OgreSetup {
        far_clip: f64::from(light.shadow_far_clip_setting.max(0.0)),
        offset: f64::from(scene.dir_light_texture_offset),
        extrusion: f64::from(scene.dir_light_extrusion_distance),
        ..OgreSetup::of_camera(&case.camera(), f64::from(light.shadow_far_distance))
    }
}

fn our_view(case: &Case) -> ViewFit {
    let casters = [case.casters()];
    let subject = Subject::unseen(&casters, case.casters().union(case.receivers()));
    // A texel is as wide as the box over the map's width; a map of another height gets a box as high as it is wide.
    let [width, _] = case.scene.shadow_texture_size;
    ogre_uniform_view(&case.light(), &case.camera(), &setup(case), &subject, width)
}

/// Where both take points that lie before the light.
fn images(case: &Case) -> Vec<[DVec3; 2]> {
    let matrices = [our_view(case).clip_from_world(), case.clip_from_world()];
    let both = |point: DVec3| Some([ndc(matrices[0], point)?, ndc(matrices[1], point)?]);
    let images: Vec<_> = case.sample_points().into_iter().filter_map(both).collect();
    assert!(images.len() > 20, "{}: only {} points are before the light", case.id, images.len());
    images
}

fn agree(kind: &str, count: usize) {
    for case in cases(count, |case| case.setup == "default" && case.light.kind == kind) {
        for [ours, ogre] in images(case) {
            let difference = apart(ours.truncate(), ogre.truncate());
            assert!(difference < TOLERANCE, "{}: {ours} against {ogre}, {difference}", case.id);
        }
    }
}

#[test]
fn directional_lights_have_ogres_box() {
    agree("directional", 7);
}

#[test]
fn spot_lights_have_ogres_pyramid() {
    agree("spot", 4);
}

#[test]
fn point_lights_have_ogres_pyramid() {
    agree("point", 2);
}

/// Depth ranges differ on purpose, and what is behind something else is so for both.
///
/// OGRE's reach from its camera to its light's far distance; ours from the highest caster down to the lowest. All that both must have in common is the order.
#[test]
fn depths_have_the_same_order() {
    /// Points that lie a centimetre behind one another: OGRE rounds places 10 km away to half a millimetre, and few such errors add up.
    const STEP: f64 = 0.01;
    for case in cases(13, |case| case.setup == "default") {
        let view = our_view(case);
        let (ours, ogre) = (view.clip_from_world(), case.clip_from_world());
        let seen = |point: DVec3| {
            let distance = -view.view_from_world.transform_point3(point).z;
            Some((distance, ndc(ours, point)?.z, ndc(ogre, point)?.z))
        };
        let mut depths: Vec<_> = case.sample_points().into_iter().filter_map(seen).collect();
        depths.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (i, near) in depths.iter().enumerate() {
            for far in depths[i..].iter().filter(|far| far.0 > near.0 + STEP) {
                assert!(near.1 < far.1 && near.2 < far.2, "{}: {near:?} {far:?}", case.id);
            }
        }
        // The casters' corners are in our range; the light's frustum can leave out others.
        let corners = case.casters().corners().into_iter().filter_map(|corner| ndc(ours, corner.as_dvec3()));
        let in_map = corners.filter(|corner| corner.truncate().abs().max_element() <= 1.0);
        assert!(in_map.into_iter().all(|corner| (0.0..=1.0).contains(&corner.z)), "{}", case.id);
    }
}

/// Without a far plane, a metre is `1e-5 / near` of OGRE's two units of depth; ours is a share of the casters' height.
#[test]
fn a_metre_of_depth_is_far_more_than_in_ogre() {
    let case = case("def_dir_nofar");
    let metre = |matrix| {
        let depth = |point| ndc(matrix, point).expect("w is 1 everywhere").z;
        depth(case.direction_for_ogre()) - depth(DVec3::ZERO)
    };
    // The near distance is 0.5. OGRE's own rounding: six digits of 1e-5.
    assert!((0.5 * metre(case.clip_from_world()) - 1e-5).abs() < 1e-10, "{}", metre(case.clip_from_world()));
    assert!(metre(our_view(case).clip_from_world()) > 1e-2);
}

/// OGRE asks in single precision whether a light is vertical, and takes another up vector.
#[test]
fn lights_that_are_vertical_in_single_precision_are_vertical() {
    let camera = case("def_dir_down").camera();
    let setup = OgreSetup::of_camera(&camera, 0.0);
    let right = |direction| {
        let light = Light { kind: LightKind::Directional { direction }, color: Vec3::ONE, intensity: 1.0 };
        ogre_frame(&light, &camera, &setup).rotation * DVec3::X
    };
    // y is 1 - 5e-9, which single precision rounds to 1: z is up, and x points to the left, as straight down.
    assert!(right(Vec3::new(1e-4, -1.0, 0.0)).distance(DVec3::NEG_X) < 1e-3);
    assert!(right(Vec3::NEG_Y).distance(DVec3::NEG_X) < 1e-12);
    // y is 1 - 5e-7, and not 1: y is up, and x is across the light.
    assert!(right(Vec3::new(1e-3, -1.0, 0.0)).distance(DVec3::Z) < 1e-2);
}
