//! Pancaking: it changes no shadow that 32 bits have, and gives 16 bits back what a high caster takes from them.

use glam::{DVec3, Vec2, Vec3, Vec4};
use shadow_cpu::{
    CpuRenderer, RasterRules,
    measure::{Cause, Counts, Judge},
    trace::{CameraView, Sampling, Tracer},
};
use shadow_math::{Bias, Cascades, Filter, Fit, Light, LightKind, Selection, ShadowSettings, Split, Store, settings::BiasParts};
use shadow_scene::{FramePlan, LayerName, Material, Mesh, Request, Scene, SceneBuilder, SceneLight, Vertices, builtin};
use shadow_tests::{
    cameras::{self, Cameras},
    lights::one_of_each,
    report::say,
};

const PICTURE: (u32, u32) = (320, 180);

/// A built-in scene under a light of each kind.
fn lit(name: &str) -> Scene {
    let scene = builtin::by_name(name).expect("it is listed");
    let lights = one_of_each(&scene).map(|(name, light)| SceneLight::new(name, light));
    scene.with_lights(lights.into())
}

/// Biases that no near plane must stand in the way of.
const BIASES: [Bias; 3] = [
    Bias::Automatic,
    Bias::slope(1.0, 0.01),
    Bias::Parts(BiasParts { constant: Some(0.02), normal_offset: Some(2.0), receiver_plane: Some(0.5), ..BiasParts::NONE }),
];

#[test]
fn no_shadow_changes_where_depth_has_32_bits() {
    let renderer = CpuRenderer::new(2, RasterRules::default()).expect("the threads start");
    let (mut pixels, mut changed, mut pancaked, mut gained) = (0, 0, 0, 0.0_f32);
    for name in ["demo", "fence"] {
        let scene = lit(name);
        let prepared = renderer.prepare(&scene);
        for (turn, cameras) in cameras::all().into_iter().enumerate().filter(|(_, cameras)| !cameras.pancake) {
            let bias = BIASES[turn % BIASES.len()];
            let filter = [Filter::Bilinear, Filter::Hard][turn % 2];
            let settings = ShadowSettings { bias, filter, map_size: 256, ..ShadowSettings::default() };
            let draw = |pancake: bool| {
                let plan = Cameras { pancake, ..cameras }.plan((&renderer, &prepared), &scene, &settings, PICTURE);
                let plan = plan.unwrap_or_else(|error| panic!("{name}, {}: {error}", cameras.name));
                let frame = renderer.render(&prepared, &plan, Request::ALL).expect("the picture is small").frame;
                (plan, frame)
            };
            let ((_, with_all), (plan, with_planes)) = (draw(false), draw(true));
            pancaked += plan.views.iter().filter(|view| view.is_pancaked()).count();
            gained = plan.views.iter().fold(gained, |most, view| most.max(view.drawn_scale));
            for light in 0..scene.lights().len() as u32 {
                let layer = LayerName::Visibility { light };
                let [a, b] = [&with_all, &with_planes].map(|frame| frame.floats(layer).expect("it was asked for"));
                pixels += a.len();
                changed += a.iter().zip(b).filter(|(a, b)| (*a - *b).abs() > 1.0 / 255.0).count();
            }
        }
    }
    say(&format!(
        "no_shadow_changes_where_depth_has_32_bits: {changed} of {pixels} change in {pancaked} views, whose depth is up to {gained:.1} times as fine"
    ));
    assert!(pancaked > 60 && gained > 50.0, "{pancaked} views are pancaked, by up to {gained}");
    // Every pixel has what a bias of this kind gives it: not one may change but by single precision, which here none does.
    assert_eq!(changed, 0, "of {pixels}");
}

/// The demo with a kite, high up in the sky, whose shadow falls into the picture.
fn under_a_kite(height: f32) -> Scene {
    let demo = builtin::by_name("demo").expect("it is listed");
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let material = builder.add_material(Material::white());
    let mesh = Mesh { vertices: demo.vertices().clone(), triangles: demo.triangles().to_vec() };
    builder.add_instance("demo", material, mesh).expect("the demo's mesh is sound");
    let center = -SUN / SUN.y.abs() * height;
    let corners = [Vec3::new(0.0, 0.0, 0.0), Vec3::new(1.5, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.5)].map(|corner| center + corner);
    let vertices = Vertices {
        positions: corners.to_vec(),
        normals: vec![Vec3::NEG_Y; 3],
        uvs: vec![Vec2::ZERO; 3],
        colors: vec![Vec4::ONE; 3],
    };
    let kite = Mesh { vertices, triangles: vec![[0, 1, 2]] };
    builder.add_instance("kite", material, kite).expect("a triangle is a mesh");
    let kind = LightKind::Directional { direction: SUN };
    builder.add_light("sun", Light { kind, color: Vec3::ONE, intensity: 50_000.0 });
    builder.add_camera("main", demo.cameras()[0].camera);
    builder.build().expect("the demo is a scene")
}

const SUN: Vec3 = Vec3::new(0.45, -1.0, 0.3);

#[test]
fn sixteen_bits_are_for_what_is_seen() {
    let scene = under_a_kite(3000.0);
    let renderer = CpuRenderer::new(2, RasterRules::default()).expect("the threads start");
    let prepared = renderer.prepare(&scene);
    let tracer = Tracer::new(&scene, 2).expect("the threads start");
    let view = CameraView::new(&scene.cameras()[0].camera, PICTURE.0, PICTURE.1);
    let judge = Judge::new(&tracer, view, Sampling::default(), &|| {});
    let four = Cascades::default();
    let splits = [
        ("one map", Fit::Focused, Split::Single),
        ("stabilised", Fit::Uniform, Split::Cascades(Cascades { stabilised: true, ..four })),
        ("contained", Fit::Focused, Split::Cascades(Cascades { selection: Selection::Containment, ..four })),
    ];
    let mut lines = String::new();
    for (name, fit, split) in splits {
        let count = |pancake: bool, store: Store| -> Counts {
            let settings = ShadowSettings {
                fit,
                split,
                pancake,
                store,
                map_size: 512,
                shadow_distance: Some(30.0),
                ..ShadowSettings::default()
            };
            let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &settings, PICTURE.0, PICTURE.1, None);
            let plan = plan.expect("the scene can be planned");
            let frame = renderer.render(&prepared, &plan, Request::ALL).expect("the picture is small").frame;
            judge.judge(&plan, &frame).expect("the frame has what is judged").total()
        };
        let best = count(false, Store::Depth32);
        // The kite's way up takes steps of 5 cm from what is seen, and a bias as long.
        let coarse = count(false, Store::Depth16).squared_error - best.squared_error;
        for store in [Store::Depth16, Store::Depth24, Store::Depth32] {
            let pancaked = count(true, store);
            let off = pancaked.squared_error - best.squared_error;
            lines +=
                &format!("{name}, {} pancaked: {off:+.3} of {:.1}, depth16: {coarse:+.3}\n", store.name(), best.squared_error);
            // Casters are drawn in single precision over the whole way, in steps of 0.2 mm: of one pixel they may decide a tap.
            assert!(coarse > 4.0 && off.abs() < 1.0, "{lines}");
            assert_eq!(pancaked.count(Cause::Acne), 0, "{lines}");
        }
    }
    say(&format!("sixteen_bits_are_for_what_is_seen, squared error of a picture:\n{lines}"));
}
