//! Every fit and every split on both renderers, and what has no meaning together.

use glam::DVec3;
use shadow_cpu::{
    CpuRenderer, RasterRules,
    measure::{Cause, Judge},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_math::{Camera, Filter, Fit, PlanError, Projection, ShadowSettings, Split, Store, settings::Cascades};
use shadow_scene::{FramePlan, FramePlanError, LayerName, Request, Scene, SceneLight, builtin, compare::compare};
use shadow_tests::{
    cameras,
    lights::one_of_each,
    renderers::{self, contract},
    report::disagreement,
};

/// A built-in scene with a light of each kind.
fn lit(name: &str) -> Scene {
    let scene = builtin::by_name(name).expect("it is listed");
    let lights = one_of_each(&scene).map(|(name, light)| SceneLight::new(name, light));
    scene.with_lights(lights.into())
}

#[test]
fn every_fit_and_split_agrees_with_every_store() {
    const PICTURE: (u32, u32) = (96, 54);
    let cpu = CpuRenderer::new(2, renderers::rules()).expect("the threads start");
    let mut failures = String::new();
    let mut turn = 0;
    for of_scene in builtin::NAMES {
        let scene = &lit(of_scene);
        let prepared = cpu.prepare(scene);
        let uploaded = pollster::block_on(renderers::gpu().upload(scene)).expect("it can be uploaded");
        for cameras in cameras::all() {
            turn += 1;
            let store = Store::ALL[turn % Store::ALL.len()];
            let filter = [Filter::Hard, Filter::Bilinear, Filter::Box3, Filter::Poisson][turn % 4];
            // Small maps of cascades have room for narrow filters alone.
            let filter = if cameras.name == "cascades of all kinds" { Filter::Bilinear } else { filter };
            let settings = ShadowSettings { store, filter, map_size: 128, ..renderers::settings() };
            let name = format!("{of_scene}, {}, {}, {}", cameras.name, store.name(), filter.name());
            let plan =
                cameras.plan((&cpu, &prepared), scene, &settings, PICTURE).unwrap_or_else(|error| panic!("{name}: {error}"));
            let on_cpu = cpu.render(&prepared, &plan, Request::ALL).expect("the picture is small").frame;
            let on_gpu = pollster::block_on(renderers::gpu().render(&uploaded, &plan, Request::ALL));
            let on_gpu = on_gpu.unwrap_or_else(|error| panic!("{name}: {error}")).frame;
            let comparison = compare(&on_cpu, &on_gpu, scene, &plan, contract()).expect("both have all layers");
            failures += &disagreement(&name, &comparison, &on_cpu, &on_gpu).unwrap_or_default();
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

/// Receivers below all casters: where a map has none of these, it holds nothing, on both renderers, wherever the view's planes lie.
#[test]
fn a_ground_that_casts_no_shadow_is_shadowed_by_what_does() {
    const PICTURE: (u32, u32) = (96, 54);
    let cpu = CpuRenderer::new(2, renderers::rules()).expect("the threads start");
    let scene = lit("demo").with_casters(|_, instance| instance.name != "ground");
    assert!(scene.instances().iter().any(|instance| !instance.casts_shadows), "the demo has a ground");
    let prepared = cpu.prepare(&scene);
    let uploaded = pollster::block_on(renderers::gpu().upload(&scene)).expect("it can be uploaded");
    let (mut failures, mut pancaked) = (String::new(), 0);
    for cameras in cameras::all().into_iter().filter(|cameras| cameras.pancake) {
        for store in [Store::Depth32, Store::Depth16, Store::Reversed32, Store::Linear] {
            let name = format!("no ground, {}, {}", cameras.name, store.name());
            let settings = ShadowSettings { store, map_size: 128, ..renderers::settings() };
            let plan =
                cameras.plan((&cpu, &prepared), &scene, &settings, PICTURE).unwrap_or_else(|error| panic!("{name}: {error}"));
            pancaked += plan.views.iter().filter(|view| view.is_pancaked()).count();
            let on_cpu = cpu.render(&prepared, &plan, Request::ALL).expect("the picture is small").frame;
            let on_gpu = pollster::block_on(renderers::gpu().render(&uploaded, &plan, Request::ALL));
            let on_gpu = on_gpu.unwrap_or_else(|error| panic!("{name}: {error}")).frame;
            let comparison = compare(&on_cpu, &on_gpu, &scene, &plan, contract()).expect("both have all layers");
            failures += &disagreement(&name, &comparison, &on_cpu, &on_gpu).unwrap_or_default();
        }
    }
    assert!(failures.is_empty(), "{failures}");
    assert!(pancaked >= 20, "{pancaked} views are pancaked");
}

/// Whatever the fit and the split, the automatic bias leaves nothing that shadows itself; between blended cascades, too.
#[test]
fn no_fit_or_split_has_acne() {
    const PICTURE: (u32, u32) = (160, 90);
    let renderer = CpuRenderer::new(2, RasterRules::default()).expect("the threads start");
    for name in ["demo", "fence"] {
        let scene = lit(name);
        let prepared = renderer.prepare(&scene);
        let tracer = Tracer::new(&scene, 2).expect("the threads start");
        let view = CameraView::new(&scene.cameras()[0].camera, PICTURE.0, PICTURE.1);
        let judge = Judge::new(&tracer, view, Sampling::default(), &|| {});
        for cameras in cameras::all() {
            for filter in [Filter::Hard, Filter::Bilinear] {
                let settings = ShadowSettings { filter, map_size: 256, ..ShadowSettings::default() };
                let case = format!("{name}, {}, {}", cameras.name, filter.name());
                let plan = cameras.plan((&renderer, &prepared), &scene, &settings, PICTURE);
                let plan = plan.unwrap_or_else(|error| panic!("{case}: {error}"));
                let frame = renderer.render(&prepared, &plan, Request::ALL).expect("the picture is small").frame;
                let counts = judge.judge(&plan, &frame).expect("the frame has what is judged").total();
                // Beyond the end of shadows nothing is judged.
                assert!(counts.judged > 1000 || cameras.shadow_distance.is_some(), "{case}: {counts:?}");
                assert_eq!(counts.count(Cause::Acne), 0, "{case}: {counts:?}");
            }
        }
    }
}

/// A camera that looks into the sky has a plan under every fit and split, with nothing in it.
#[test]
fn a_camera_that_sees_nothing_has_a_picture() {
    let scene = lit("demo");
    let renderer = CpuRenderer::new(1, RasterRules::default()).expect("the threads start");
    let prepared = renderer.prepare(&scene);
    let projection = Projection::Perspective { vertical_fov: 0.7, near: 0.1, far: None };
    let camera = Camera::look_at(DVec3::new(0.0, 3.0, 3.0), DVec3::new(0.0, 30.0, 3.1), projection).expect("it looks up");
    let seen = cameras::feedback((&renderer, &prepared), &scene, &camera, (64, 36)).expect("the camera can be planned");
    assert!(seen.is_seen && seen.samples.is_empty());
    for cameras in cameras::all() {
        let settings = |light: &SceneLight| {
            let filter = Filter::Hard;
            cameras.of(ShadowSettings { filter, map_size: 128, ..ShadowSettings::default() }, light, &scene)
        };
        let plan = FramePlan::with_feedback(&scene, &camera, 128, |_, light| settings(light), (64, 36), None, &seen);
        let plan = plan.unwrap_or_else(|error| panic!("{}: {error}", cameras.name));
        let frame = renderer.render(&prepared, &plan, Request::ALL).expect("the picture is small").frame;
        for light in 0..scene.lights().len() as u32 {
            let visibility = frame.floats(LayerName::Visibility { light }).expect("it was asked for");
            assert!(visibility.iter().all(|&visible| visible == 1.0), "{}", cameras.name);
        }
    }
}

#[test]
fn what_has_no_meaning_is_refused_by_name() {
    let scene = lit("demo");
    let camera = &scene.cameras()[0].camera;
    let default = ShadowSettings { map_size: 128, ..ShadowSettings::default() };
    let cascades = |cascades| ShadowSettings { split: Split::Cascades(cascades), ..default };
    let four = Cascades::default();
    let cases = [
        (cascades(four), PlanError::CascadesOfCube, "cube"),
        (
            ShadowSettings { fit: Fit::Lispsm, store: Store::Linear, ..default },
            PlanError::StoreOfFit { fit: Fit::Lispsm, store: Store::Linear },
            "linear",
        ),
        (
            ShadowSettings { fit: Fit::PlaneOptimal, store: Store::Depth16, ..default },
            PlanError::StoreOfFit { fit: Fit::PlaneOptimal, store: Store::Depth16 },
            "plane-optimal",
        ),
        (ShadowSettings { shadow_distance: Some(-1.0), ..default }, PlanError::ShadowDistance(-1.0), "-1 m"),
    ];
    for (settings, expected, said) in cases {
        let Err(FramePlanError::Light { source, .. }) = FramePlan::new(&scene, camera, &settings, 64, 36, None) else {
            panic!("{expected:?} must be refused");
        };
        assert_eq!(source, expected);
        assert!(source.to_string().contains(said), "{source}");
    }
}
