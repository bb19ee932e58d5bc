//! The plane-optimal fit against the truth: on its plane, each pixel has a texel of its own.

use glam::{DVec4, Vec3};
use shadow_cpu::{
    CpuRenderer, RasterRules,
    measure::{Cause, FrameAliasing, Judge},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_math::{Filter, Fit, Light, LightKind, ShadowSettings};
use shadow_scene::{FramePlan, NO_TRIANGLE, Request, Scene, SceneLight, builtin};
use shadow_tests::{cameras::feedback, report::say};

/// Width and height of picture and map.
const SIZE: u32 = 512;

/// The demo under lights that reach its whole floor.
fn scene() -> Scene {
    let lamp = Vec3::new(1.5, 7.0, 2.0);
    let lights = [
        ("high sun", LightKind::Directional { direction: Vec3::new(0.45, -1.0, 0.3) }),
        ("low sun", LightKind::Directional { direction: Vec3::new(1.0, -0.35, 0.2) }),
        ("against the camera", LightKind::Directional { direction: Vec3::new(0.3, -0.5, 1.0) }),
        ("spot", LightKind::Spot { position: lamp, direction: Vec3::new(-0.2, -1.0, -0.2), inner: 0.5, outer: 1.1, range: None }),
        ("point", LightKind::Point { position: lamp, range: None }),
    ];
    let light = |kind| Light { kind, color: Vec3::ONE, intensity: 1000.0 };
    let lights = lights.map(|(name, kind)| SceneLight::new(name, light(kind)));
    builtin::by_name("demo").expect("it is listed").with_lights(lights.into())
}

#[test]
fn a_planes_picture_is_the_truth() {
    let scene = scene();
    let camera = scene.cameras()[0].camera;
    let renderer = CpuRenderer::new(2, RasterRules::default()).expect("the threads start");
    let prepared = renderer.prepare(&scene);
    let seen = feedback((&renderer, &prepared), &scene, &camera, (SIZE, SIZE)).expect("the scene can be planned");
    let plane = seen.plane.expect("the camera sees a plane");
    assert!((plane - DVec4::Y).length() < 1e-6, "the floor is what most pixels show: {plane}");
    let settings = ShadowSettings { fit: Fit::PlaneOptimal, filter: Filter::Hard, map_size: SIZE, ..ShadowSettings::default() };
    let plan =
        FramePlan::with_feedback(&scene, &camera, SIZE, |_, _| settings, (SIZE, SIZE), None, &seen).expect("it can be planned");
    assert_eq!(plan.views.len(), scene.lights().len(), "each light has one map, the point light too");
    let frame = renderer.render(&prepared, &plan, Request::ALL).expect("the picture is small").frame;
    let tracer = Tracer::new(&scene, 2).expect("the threads start");
    let judge = Judge::new(&tracer, CameraView::new(&camera, SIZE, SIZE), Sampling::default(), &|| {});
    let judgement = judge.judge(&plan, &frame).expect("the frame has what is judged");
    let triangles = frame.triangles().expect("they were asked for");
    let aliasing = FrameAliasing::of(&scene, &plan, triangles, 2).expect("the layer is of the plan");
    let is_floor: Vec<bool> = triangles
        .iter()
        .map(|&triangle| {
            triangle != NO_TRIANGLE
                && scene.triangles()[triangle as usize]
                    .iter()
                    .all(|&vertex| plane.dot(scene.vertices().positions[vertex as usize].as_dvec3().extend(1.0)).abs() < 1e-6)
        })
        .collect();
    let floor = is_floor.iter().filter(|is_floor| **is_floor).count();
    assert!(floor > 50_000, "{floor} pixels show the floor");
    let mut lines = String::new();
    for ((light, judged), aliasing) in scene.lights().iter().zip(&judgement.lights).zip(&aliasing.lights) {
        let of_floor = |cause: Cause| {
            is_floor.iter().zip(&judged.causes).filter(|(is_floor, found)| **is_floor && **found == cause as u8).count()
        };
        let [near_edges, within_rounding] = [Cause::Aliasing, Cause::PeterPanning].map(of_floor);
        lines += &format!(
            "{}: {floor} pixels of the floor, {near_edges} within a sub-pixel step of an edge and {within_rounding} within rounding of a caster are wrong\n",
            light.name
        );
        // A lookup is at its texel's centre, where the light's ray through the pixel was drawn: nothing but the snapping of corners can be wrong.
        for cause in [Cause::Coverage, Cause::Terminator, Cause::Filter, Cause::Acne, Cause::Leak] {
            assert_eq!(of_floor(cause), 0, "{lines}{cause:?}");
        }
        // The rim of the picture is the rim of the map, where a lookup can fall outside by rounding.
        assert!(of_floor(Cause::Seam) <= 4 * SIZE as usize, "{lines}");
        // A step is a 256th of a texel, and outlines cross some hundred texels in either direction.
        assert!(near_edges + within_rounding < floor / 2000, "{lines}");
        // m is 1 wherever the light reaches the floor: rows are rounded to single precision, by 2^-24 of terms that are some times larger.
        let reached = is_floor.iter().zip(&aliasing.stretches).filter(|(is_floor, stretch)| **is_floor && **stretch > 0.0);
        let off = reached.map(|(_, stretch)| (stretch - 1.0).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{}: m is off by {off}", light.name);
    }
    say(&format!("a_planes_picture_is_the_truth:\n{lines}"));
}
