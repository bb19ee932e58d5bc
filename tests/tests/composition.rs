//! Lights and shadows put together: in one pass or many, added or multiplied, and lights and objects without shadows.

use glam::Vec3;
use shadow_cpu::{
    measure::{Cause, Judge},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_gpu::GpuError;
use shadow_math::{Composition, ShadowSettings, plan::COMPOSE_UNSHADOWED, settings::OGRE_SHADOW_COLOR, srgb::linear_to_srgb};
use shadow_scene::{
    Frame, FramePlan, FramePlanError, LayerName, LightPasses, Request, Scene, SceneLight, builtin, compare::Contract,
};
use shadow_tests::{
    lights::one_of_each,
    renderers::{self, contract, counterpart},
    report::say,
};

const SIZE: (u32, u32) = (240, 135);

/// The demo under three lights.
fn demo() -> Scene {
    let demo = builtin::demo();
    let lights = one_of_each(&demo).map(|(name, light)| SceneLight::new(name, light));
    demo.with_lights(lights.into())
}

fn plan_of(scene: &Scene, composition: Composition, light_passes: LightPasses) -> FramePlan {
    let settings = ShadowSettings { map_size: 512, ..renderers::settings() };
    let plan = FramePlan::new(scene, &scene.cameras()[0].camera, &settings, SIZE.0, SIZE.1, None).expect("it can be planned");
    FramePlan { light_passes, ..plan.with_composition(composition).expect("the color is one") }
}

/// On the CPU and on the GPU.
fn frames(scene: &Scene, plan: &FramePlan) -> [Frame; 2] {
    let on_cpu = counterpart().render(&counterpart().prepare(scene), plan, Request::ALL).expect("it can be rendered").frame;
    let uploaded = pollster::block_on(renderers::gpu().upload(scene)).expect("it fits");
    [on_cpu, pollster::block_on(renderers::gpu().render(&uploaded, plan, Request::ALL)).expect("it can be rendered").frame]
}

/// The largest difference of two pictures in 8-bit steps.
fn difference(a: &Frame, b: &Frame) -> f32 {
    let encode = |frame: &Frame| -> Vec<f32> {
        let color = frame.color().expect("it was asked for");
        assert!(color.as_flattened().iter().all(|channel| channel.is_finite()), "{}: a color is no number", frame.source);
        color.as_flattened().iter().map(|&channel| 255.0 * linear_to_srgb(channel.clamp(0.0, 1.0))).collect()
    };
    encode(a).iter().zip(encode(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn many_passes_are_one_pass() {
    let scene = demo();
    if !renderers::gpu().device().features().contains(wgpu::Features::FLOAT32_BLENDABLE) {
        let plan = plan_of(&scene, Composition::Additive, LightPasses::Each);
        let uploaded = pollster::block_on(renderers::gpu().upload(&scene)).expect("it fits");
        let refused =
            pollster::block_on(renderers::gpu().render(&uploaded, &plan, Request::ALL)).map(|_| ()).expect_err("it cannot blend");
        assert!(matches!(&refused, GpuError::Unsupported { what, .. } if what.contains("blending")), "{refused}");
        say("many_passes_are_one_pass: the adapter cannot add up passes, and says so");
        return;
    }
    for composition in [Composition::Additive, Composition::Modulative(OGRE_SHADOW_COLOR)] {
        let one = frames(&scene, &plan_of(&scene, composition, LightPasses::One));
        let each = frames(&scene, &plan_of(&scene, composition, LightPasses::Each));
        for (one, each) in one.iter().zip(&each) {
            let steps = difference(one, each);
            // Sums of four floats in another order: far below a step of 8 bits.
            assert!(steps < 0.01, "{composition:?} on {}: {steps} steps", one.source);
        }
        if contract() == Contract::Exact {
            assert!(one[0].color() == one[1].color(), "both renderers draw the same bits in one pass");
            assert!(difference(&each[0], &each[1]) < 0.01);
        }
    }
}

#[test]
fn a_plan_in_passes_has_each_light_once() {
    let scene = demo();
    let plan = plan_of(&scene, Composition::Additive, LightPasses::Each);
    let passes: Vec<_> = core::iter::once(plan.first_pass()).chain(plan.passes_of_lights()).collect();
    assert_eq!(
        passes.iter().map(|pass| (pass.first_light, pass.light_count)).collect::<Vec<_>>(),
        [(0, 0), (0, 1), (1, 1), (2, 1)]
    );
    assert!(passes[1..].iter().all(|pass| pass.ambient == [0.0; 3]) && passes[0].ambient == plan.camera.ambient);
}

/// Where every light is seen both compositions are the same sum. Where one is not, modulative shadows keep its highlight, darkened, and additive ones do not.
#[test]
fn modulative_shadows_differ_where_there_are_shadows() {
    let scene = demo();
    let [additive, modulative] = [Composition::Additive, Composition::Modulative(OGRE_SHADOW_COLOR)]
        .map(|composition| frames(&scene, &plan_of(&scene, composition, LightPasses::One)));
    for (additive, modulative) in additive.iter().zip(&modulative) {
        let visibility: Vec<&[f32]> =
            (0..3).map(|light| additive.floats(LayerName::Visibility { light }).expect("it was asked for")).collect();
        let (a, m) = (additive.color().expect("it was asked for"), modulative.color().expect("it was asked for"));
        let triangles = additive.triangles().expect("they were asked for");
        let (mut lit, mut shadowed) = (0, 0);
        for pixel in (0..a.len()).filter(|&pixel| triangles[pixel] != u32::MAX) {
            let is_lit = visibility.iter().all(|of_light| of_light[pixel] == 1.0);
            if is_lit {
                assert_eq!(a[pixel], m[pixel]);
                lit += 1;
            } else {
                shadowed += usize::from(a[pixel] != m[pixel]);
            }
        }
        assert!(lit > 1000 && shadowed > 1000, "{lit} {shadowed}");
    }
    // A shadow of white leaves everything as it is without shadows, and one of black takes everything, ambient light too.
    let white = frames(&scene, &plan_of(&scene, Composition::Modulative([1.0; 3]), LightPasses::One));
    let black = frames(&scene, &plan_of(&scene, Composition::Modulative([0.0; 3]), LightPasses::One));
    let dark = |frame: &Frame| frame.color().expect("it was asked for").iter().filter(|color| color[..3] == [0.0; 3]).count();
    assert_eq!(dark(&white[0]), 0);
    assert!(dark(&black[0]) > 1000);
}

/// A light without shadows reaches whatever faces it, in maps as in truth; an object that casts none hides nothing from lights, and is seen by the camera as before.
#[test]
fn what_casts_no_shadow_is_left_out_by_all() {
    let with = demo();
    let mut lights = with.lights().to_vec();
    lights[0].casts_shadows = false;
    let without_light = with.clone().with_lights(lights);
    let knot = with.instances().iter().position(|instance| instance.triangle_count > 1000).expect("the demo has a dense object");
    let without_object = with.clone().with_casters(|index, _| index != knot);
    let plan = plan_of(&with, Composition::Additive, LightPasses::One);
    let before = frames(&with, &plan);
    for (name, scene) in [("light", &without_light), ("object", &without_object)] {
        let plan = plan_of(scene, Composition::Additive, LightPasses::One);
        let frames = frames(scene, &plan);
        if contract() == Contract::Exact {
            assert!(frames[0].color() == frames[1].color(), "{name}: the renderers differ");
        }
        let lit = |frame: &Frame, light: u32| -> f32 {
            frame.floats(LayerName::Visibility { light }).expect("it was asked for").iter().sum()
        };
        assert!(lit(&frames[0], 0) > lit(&before[0], 0) + 100.0, "{name}: more is lit");
        let camera = scene.cameras()[0].camera;
        let tracer = Tracer::new(scene, 0).expect("threads start");
        let judge = Judge::new(&tracer, CameraView::new(&camera, SIZE.0, SIZE.1), Sampling { side: 1 }, &|| {});
        let counts = judge.judge(&plan, &frames[0]).expect("the frame is of the judge's view").total();
        assert_eq!(counts.count(Cause::Acne), 0, "{name}");
        // Outlines aside, which a map of 512 texels blurs, truth and maps leave out the same.
        let leaks = counts.count(Cause::Leak) + counts.count(Cause::PeterPanning);
        assert!(leaks * 500 < counts.judged, "{name}: {leaks} of {} are lit wrongly", counts.judged);
    }
    let unshadowed = plan_of(&without_light, Composition::Additive, LightPasses::One);
    assert_eq!(unshadowed.lights[0].view_count, 0);
    assert_eq!(unshadowed.views.len() + 1, plan.views.len());
    // The camera sees the same surfaces, whatever order they are drawn in.
    let depth = |scene: &Scene| {
        let plan = plan_of(scene, Composition::Additive, LightPasses::One);
        frames(scene, &plan)[0].floats(LayerName::Depth).expect("it was asked for").to_vec()
    };
    assert_eq!(depth(&with), depth(&without_object));
    // Nothing that casts: no map is needed.
    let nothing = with.clone().with_casters(|_, _| false);
    assert!(plan_of(&nothing, Composition::Additive, LightPasses::One).views.is_empty());
    let all = nothing.with_casters(|_, _| true);
    assert_eq!(all.triangles(), with.triangles(), "the order is back");
}

/// A picture without shadows is the same in however many passes the lights are drawn.
#[test]
fn a_picture_without_shadows_has_no_passes() {
    let scene = demo();
    let mut plan = plan_of(&scene, Composition::Modulative(OGRE_SHADOW_COLOR), LightPasses::Each);
    plan.camera.composition = COMPOSE_UNSHADOWED;
    let each = frames(&scene, &plan);
    let one = frames(&scene, &FramePlan { light_passes: LightPasses::One, ..plan });
    assert!(each[0].color() == one[0].color() && each[1].color() == one[1].color());
}

#[test]
fn maps_beyond_the_budget_are_refused_with_the_size_that_fits() {
    let scene = demo();
    let plan = plan_of(&scene, Composition::Additive, LightPasses::One);
    // A directional light's map, a spot's, and six around a point: of 512 x 512 texels and 4 bytes.
    assert_eq!(plan.map_bytes(), 8 * 512 * 512 * 4);
    assert_eq!(plan.check_budget(plan.map_bytes()), Ok(()));
    let error = plan.check_budget(plan.map_bytes() / 4 + 100).expect_err("four times too large");
    assert!(matches!(error, FramePlanError::Budget { fitting: 256, maps: 8, .. }), "{error:?}");
    assert!(error.to_string().contains("256 texels fit"), "{error}");
    let color = plan.with_composition(Composition::Modulative([0.5, 1.5, 0.5])).expect_err("no color is that bright");
    assert_eq!(color, FramePlanError::ShadowColor(1.5));
    assert_eq!(Vec3::from(OGRE_SHADOW_COLOR), Vec3::splat(0.25));
}
