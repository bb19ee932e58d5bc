//! Every fit and every split on both renderers, and what has no meaning together.

use shadow_cpu::CpuRenderer;
use shadow_math::{Filter, Fit, PlanError, ShadowSettings, Split, Store, settings::Cascades};
use shadow_scene::{FramePlan, FramePlanError, Request, Scene, SceneLight, builtin, compare::compare};
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
    let scenes: Vec<Scene> = builtin::NAMES.iter().map(|name| lit(name)).collect();
    let mut failures = String::new();
    let mut turn = 0;
    for scene in &scenes {
        let prepared = cpu.prepare(scene);
        let uploaded = pollster::block_on(renderers::gpu().upload(scene)).expect("it can be uploaded");
        for cameras in cameras::all() {
            turn += 1;
            let store = Store::ALL[turn % Store::ALL.len()];
            let filter = [Filter::Hard, Filter::Bilinear, Filter::Box3, Filter::Poisson][turn % 4];
            // Small maps of cascades have room for narrow filters alone.
            let filter = if cameras.name == "cascades of all kinds" { Filter::Bilinear } else { filter };
            let settings = ShadowSettings { store, filter, map_size: 128, ..renderers::settings() };
            let name = format!("{} {} {}", cameras.name, store.name(), filter.name());
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
