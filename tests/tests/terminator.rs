//! Light at the terminator of a smooth mesh, where facets turn away before the smooth surface does.

use glam::{DVec3, Vec3};
use shadow_math::{Camera, Light, LightKind, Projection, ShadowSettings, Terminator};
use shadow_scene::{Frame, FramePlan, LayerName, Material, Request, Scene, SceneBuilder, SceneLight, builtin::shapes};
use shadow_tests::renderers::{self, counterpart};

/// A coarse sphere with smooth normals, lit from the right.
fn sphere() -> (Scene, Camera) {
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let white = builder.add_material(Material::white());
    builder.add_instance("sphere", white, shapes::sphere(Vec3::ZERO, 1.0, 24)).expect("the sphere is sound");
    let kind = LightKind::Directional { direction: Vec3::new(-1.0, -0.2, -0.1) };
    let light = Light { kind, color: Vec3::ONE, intensity: 10_000.0 };
    let scene = builder.build().expect("there is a sphere").with_lights(vec![SceneLight::new("sun", light)]);
    let projection = Projection::Perspective { vertical_fov: 0.6, near: 0.1, far: None };
    let camera = Camera::look_at(DVec3::new(0.0, 0.0, 4.0), DVec3::ZERO, projection).expect("the camera looks somewhere");
    (scene, camera)
}

fn frames(terminator: Terminator) -> [Frame; 2] {
    let (scene, camera) = sphere();
    let settings = ShadowSettings { terminator, map_size: 1024, ..renderers::settings() };
    let plan = FramePlan::new(&scene, &camera, &settings, 400, 400, None).expect("the sphere can be planned");
    let on_cpu = counterpart().render(&counterpart().prepare(&scene), &plan, Request::ALL).expect("it can be rendered").frame;
    let uploaded = pollster::block_on(renderers::gpu().upload(&scene)).expect("it fits");
    [on_cpu, pollster::block_on(renderers::gpu().render(&uploaded, &plan, Request::ALL)).expect("it fits").frame]
}

/// The mean step in brightness from pixels that are dark because their facet turns away to neighbours that are fully lit, and the brightness of the brightest pixel.
fn mean_step(frame: &Frame) -> (f32, f32) {
    let color = frame.color().expect("it was asked for");
    let visibility = frame.floats(LayerName::Visibility { light: 0 }).expect("it was asked for");
    let triangles = frame.triangles().expect("they were asked for");
    let mut steps = Vec::new();
    for y in 0..399 {
        for x in 0..399 {
            let here = y * 400 + x;
            for there in [here + 1, here + 400] {
                let is_edge = visibility[here].min(visibility[there]) == 0.0 && visibility[here].max(visibility[there]) == 1.0;
                if is_edge && triangles[here] != u32::MAX && triangles[there] != u32::MAX {
                    steps.push((color[here][0] - color[there][0]).abs());
                }
            }
        }
    }
    assert!(steps.len() > 100, "only {} edges", steps.len());
    let of_sphere = color.iter().zip(triangles).filter(|(_, triangle)| **triangle != u32::MAX);
    let most = of_sphere.map(|(color, _)| color[0]).fold(0.0, f32::max);
    (steps.iter().sum::<f32>() / steps.len() as f32, most)
}

#[test]
fn a_soft_terminator_leaves_no_step() {
    let [hard, soft] = [Terminator::Hard, Terminator::Soft].map(frames);
    for (hard, soft) in hard.iter().zip(&soft) {
        let ((hard_step, hard_most), (soft_step, soft_most)) = (mean_step(hard), mean_step(soft));
        // A facet of a sphere of 24 segments leans away by up to 7.5 degrees, whose sine is the most light that is cut off.
        assert!(hard_step > 0.02 * hard_most, "{hard_step} of {hard_most}");
        // Light has left both sides of such an edge; what is left of steps comes of pixels, whose centres lie a little beside it.
        assert!(soft_step < 0.02 * hard_step, "{soft_step} in place of {hard_step}");
        // What faces the light stays as bright.
        assert!((hard_most - soft_most).abs() < 1e-3 * hard_most, "{hard_most} {soft_most}");
        assert_eq!(hard.floats(LayerName::Visibility { light: 0 }), soft.floats(LayerName::Visibility { light: 0 }));
    }
}
