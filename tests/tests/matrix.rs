//! Every store with every bias and every filter, on both renderers, and what has no meaning together.

use std::collections::BTreeSet;

use shadow_cpu::{CpuRenderer, PreparedScene};
use shadow_gpu::GpuScene;
use shadow_math::{
    Bias, Filter, PlanError, ShadowSettings, Store, Terminator, Texels,
    settings::{BiasParts, Ogre2006, PolygonOffset, ReceiverGradient},
};
use shadow_scene::{FramePlan, FramePlanError, Request, Scene, SceneLight, builtin, compare::compare};
use shadow_tests::{
    lights::one_of_each,
    renderers::{self, contract},
    report::disagreement,
};

/// Every bias by its name.
fn biases() -> Vec<(&'static str, Bias)> {
    let gradient = ReceiverGradient { scale: 1.0, ..ReceiverGradient::default() };
    let shader = |is_corrected: bool| Some(Ogre2006 { metres: 0.01, is_corrected });
    let parts = |parts: BiasParts| Bias::Parts(parts);
    vec![
        ("automatic", Bias::Automatic),
        ("none", Bias::NONE),
        ("constant", Bias::constant(0.01)),
        ("slope", Bias::slope(1.0, 0.0)),
        ("normal-offset", parts(BiasParts { normal_offset: Some(1.5), ..BiasParts::NONE })),
        ("receiver-plane", parts(BiasParts { receiver_plane: Some(0.2), ..BiasParts::NONE })),
        ("receiver-gradient", parts(BiasParts { receiver_gradient: Some(gradient), ..BiasParts::NONE })),
        ("back-faces", parts(BiasParts { back_faces: true, ..BiasParts::NONE })),
        ("polygon-offset", parts(BiasParts { polygon_offset: Some(PolygonOffset::default()), ..BiasParts::NONE })),
        ("ogre-2006", parts(BiasParts { ogre_2006: shader(false), ..BiasParts::NONE })),
        ("ogre-2006-corrected", parts(BiasParts { ogre_2006: shader(true), ..BiasParts::NONE })),
        (
            "constant+normal-offset+back-faces+polygon-offset",
            parts(BiasParts {
                constant: Some(0.001),
                normal_offset: Some(0.5),
                back_faces: true,
                polygon_offset: Some(PolygonOffset { clamp: 0.01, ..PolygonOffset::default() }),
                ..BiasParts::NONE
            }),
        ),
    ]
}

/// What has no meaning together, by names: offsets of a format's steps where there is no such format, and what reckons with depth that grows, or is flat, where it is not.
const MEANINGLESS: [(&str, Store); 16] = [
    ("receiver-plane", Store::Linear),
    ("receiver-gradient", Store::Reversed32),
    ("polygon-offset", Store::Linear),
    ("polygon-offset", Store::Second),
    ("polygon-offset", Store::Midpoint),
    ("ogre-2006", Store::Reversed32),
    ("ogre-2006", Store::Linear),
    ("ogre-2006", Store::Second),
    ("ogre-2006", Store::Midpoint),
    ("ogre-2006-corrected", Store::Reversed32),
    ("ogre-2006-corrected", Store::Linear),
    ("ogre-2006-corrected", Store::Second),
    ("ogre-2006-corrected", Store::Midpoint),
    ("constant+normal-offset+back-faces+polygon-offset", Store::Linear),
    ("constant+normal-offset+back-faces+polygon-offset", Store::Second),
    ("constant+normal-offset+back-faces+polygon-offset", Store::Midpoint),
];

struct Case<'a> {
    scene: Scene,
    prepared: PreparedScene<'a>,
    uploaded: GpuScene,
}

#[test]
fn every_combination_agrees_or_is_refused_by_name() {
    const PICTURE: (u32, u32) = (96, 54);
    const MAP: u32 = 128;
    let cpu = CpuRenderer::new(2, renderers::rules()).expect("the threads start");
    let own: Vec<Scene> = builtin::NAMES.iter().map(|name| builtin::by_name(name).expect("it is listed")).collect();
    // All kinds of light at once: each frame has a map of each.
    let cases: Vec<Case<'_>> = own
        .iter()
        .map(|scene| Case {
            scene: scene.clone().with_lights(one_of_each(scene).map(|(name, light)| SceneLight::new(name, light)).into()),
            prepared: cpu.prepare(scene),
            uploaded: pollster::block_on(renderers::gpu().upload(scene)).expect("it can be uploaded"),
        })
        .collect();
    let mut refused = BTreeSet::new();
    let mut failures = String::new();
    let mut turn = 0;
    for store in Store::ALL {
        for (name, bias) in biases() {
            for filter in Filter::ALL {
                turn += 1;
                let case = &cases[turn % cases.len()];
                let settings = ShadowSettings {
                    store,
                    bias,
                    filter,
                    texels: [Texels::OpenGl, Texels::Direct3d][turn % 2],
                    terminator: [Terminator::Hard, Terminator::Soft][turn / 2 % 2],
                    map_size: MAP,
                    ..renderers::settings()
                };
                let camera = &case.scene.cameras()[0].camera;
                let plan = match FramePlan::new(&case.scene, camera, &settings, PICTURE.0, PICTURE.1, None) {
                    Ok(plan) => plan,
                    Err(FramePlanError::Light { source: error @ PlanError::BiasOfOtherStores { bias, store }, .. }) => {
                        assert!(name.contains(bias) && error.to_string().contains(bias), "{name}: {error}");
                        assert!(error.to_string().contains(store.name()), "{error}");
                        refused.insert((name, store.name()));
                        continue;
                    }
                    Err(error) => panic!("{name} {} {}: {error}", store.name(), filter.name()),
                };
                let name = format!("{name} {} {}", store.name(), filter.name());
                let on_cpu = cpu.render(&case.prepared, &plan, Request::ALL).expect("the picture is small").frame;
                let on_gpu = pollster::block_on(renderers::gpu().render(&case.uploaded, &plan, Request::ALL));
                let on_gpu = on_gpu.unwrap_or_else(|error| panic!("{name}: {error}")).frame;
                let comparison = compare(&on_cpu, &on_gpu, &case.scene, &plan, contract()).expect("both have all layers");
                failures += &disagreement(&name, &comparison, &on_cpu, &on_gpu).unwrap_or_default();
            }
        }
    }
    let meaningless: BTreeSet<_> = MEANINGLESS.into_iter().map(|(bias, store)| (bias, store.name())).collect();
    assert_eq!(refused, meaningless);
    assert!(failures.is_empty(), "{failures}");
}
