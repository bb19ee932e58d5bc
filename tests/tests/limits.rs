//! What is too large is refused with a sentence before anything is made of it.

use glam::Vec3;
use shadow_cpu::CpuError;
use shadow_gpu::GpuError;
use shadow_math::{Light, LightKind, ShadowSettings};
use shadow_scene::{FramePlan, Scene, SceneLight, builtin};
use shadow_tests::renderers;

fn lit_by_points(count: usize) -> Scene {
    let light = Light { kind: LightKind::Point { position: Vec3::Y * 4.0, range: None }, color: Vec3::ONE, intensity: 10.0 };
    builtin::demo().with_lights(vec![SceneLight::new("point", light); count])
}

fn plan(scene: &Scene, width: u32, height: u32, map_size: u32) -> FramePlan {
    let settings = ShadowSettings { map_size, ..ShadowSettings::default() };
    FramePlan::new(scene, &scene.cameras()[0].camera, &settings, width, height, None).expect("the plan itself has no such limit")
}

fn gpu_refusal(plan: &FramePlan, scene: &Scene) -> GpuError {
    pollster::block_on(async {
        let uploaded = renderers::gpu().upload(scene).await.expect("the scene fits");
        renderers::gpu().camera(&uploaded, plan).await.err().expect("it is too large")
    })
}

#[test]
fn too_many_maps_are_refused_by_name() {
    let layers = renderers::gpu().adapter().max_texture_layers;
    let lights = layers as usize / 6 + 1;
    let scene = lit_by_points(lights);
    let error = gpu_refusal(&plan(&scene, 64, 64, 16), &scene);
    let GpuError::Limit { needed, allowed, limit, .. } = &error else { panic!("{error}") };
    assert_eq!((*needed, *allowed, *limit), (6 * lights as u64, u64::from(layers), "maxTextureArrayLayers"));
    let sentence = error.to_string();
    for word in [&needed.to_string(), &allowed.to_string(), "fewer lights"] {
        assert!(sentence.contains(word), "`{word}` is not in: {sentence}");
    }
}

#[test]
fn too_large_pictures_are_refused_by_both() {
    let scene = builtin::demo();
    let size = renderers::gpu().adapter().max_texture_size + 1;
    let error = gpu_refusal(&plan(&scene, size, 1, 16), &scene);
    assert!(matches!(error, GpuError::Limit { limit: "maxTextureDimension2D", .. }), "{error}");

    let renderer = renderers::cpu();
    let error = renderer.camera(&renderer.prepare(&scene), &plan(&scene, 1, 16_385, 16)).expect_err("it is too large");
    assert!(matches!(error, CpuError::PictureSize { width: 1, height: 16_385 }), "{error}");
}

/// An adapter that does not exist is an error that lists those that do, never another adapter.
#[test]
fn an_unknown_adapter_is_refused() {
    let name = &renderers::gpu().adapter().name;
    let error = pollster::block_on(shadow_gpu::GpuRenderer::new(Some("no such adapter"))).err().expect("there is none");
    let sentence = error.to_string();
    assert!(sentence.contains("no such adapter") && sentence.contains(name.as_str()), "{sentence}");
}
