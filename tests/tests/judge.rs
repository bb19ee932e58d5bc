//! The judge: pixels whose cause geometry knows, and faults that it must find.

use core::f64::consts::SQRT_2;

use glam::{DVec3, Vec3};
use shadow_cpu::{
    measure::{Cause, Counts, ENGINES, Judge, JudgeError, Judgement, Moment, Rule, Stability},
    trace::{CameraView, Sampling, SurfacePoint, Tracer},
};
use shadow_math::{
    Bias, Camera, Filter, Light, LightKind, LightShape, Projection, Receiver, ShadowSettings,
    plan::{LightPlan, ViewPlan},
};
use shadow_scene::{
    Alpha, Frame, FramePlan, Image, LayerName, Material, NO_TRIANGLE, Pixels, Request, Scene, SceneBuilder, SceneLight, Texture,
    Wrap, builtin, builtin::shapes,
};
use shadow_tests::{renderers::cpu, report::say};

/// What a judgement needs of a frame.
const JUDGED: Request = Request { camera: true, shadow_maps: true, visibility: true, color: false };

const WIDTH: u32 = 640;
const HEIGHT: u32 = 360;

/// A scene with its judge's view, and the frame of these settings.
fn judged(scene: &Scene, settings: &ShadowSettings) -> Judgement {
    let tracer = Tracer::new(scene, 0).expect("threads start");
    let judge = judge(&tracer);
    let plan = plan(scene, settings);
    judge.judge(&plan, &frame(scene, &plan)).expect("the frame is of the judge's view")
}

fn judge<'a>(tracer: &'a Tracer<'a>) -> Judge<'a> {
    let view = CameraView::new(&tracer.scene().cameras()[0].camera, WIDTH, HEIGHT);
    Judge::new(tracer, view, Sampling::default(), &|| {})
}

fn plan(scene: &Scene, settings: &ShadowSettings) -> FramePlan {
    FramePlan::new(scene, &scene.cameras()[0].camera, settings, WIDTH, HEIGHT, None).expect("the scene can be planned")
}

fn frame(scene: &Scene, plan: &FramePlan) -> Frame {
    cpu().render(&cpu().prepare(scene), plan, JUDGED).expect("the picture fits").frame
}

/// The points of the surfaces behind all pixels; `None` where there is nothing.
fn points(scene: &Scene) -> Vec<Option<SurfacePoint>> {
    let tracer = Tracer::new(scene, 0).expect("threads start");
    let view = CameraView::new(&scene.cameras()[0].camera, WIDTH, HEIGHT);
    let seen = tracer.camera(view, &|| {});
    let point = |(pixel, hit): (usize, &shadow_cpu::trace::Hit)| {
        let ray = view.ray(pixel as u32 % WIDTH, pixel as u32 / WIDTH);
        (hit.triangle != NO_TRIANGLE).then(|| tracer.surface_point(hit, ray))
    };
    seen.hits.iter().enumerate().map(point).collect()
}

/// Without a bias about half of a slanted plane shadows itself, and all of that is acne; with one that is enough nothing is wrong.
#[test]
fn a_plane_that_shadows_itself_has_acne_alone() {
    let scene = builtin::tilted_plane(Vec3::new(0.3, 1.0, 0.2), 5.0);
    for filter in [Filter::Hard, Filter::Bilinear] {
        let settings = |bias| ShadowSettings { bias, filter, map_size: 256, ..ShadowSettings::default() };
        let none = judged(&scene, &settings(Bias::NONE)).total();
        assert_eq!(none.wrong(), none.count(Cause::Acne), "{none:?}");
        assert!(none.wrong() * 5 > none.judged * 2, "{} of {} pixels", none.wrong(), none.judged);
        let automatic = judged(&scene, &settings(Bias::Automatic)).total();
        assert_eq!((automatic.wrong(), automatic.rmse()), (0, 0.0));
        assert_eq!(automatic.judged, none.judged);
    }
}

/// What does not hide the light does not hide acne either: a ceiling on which the lamp lies, and a card that is one hole.
#[test]
fn what_hides_no_light_hides_no_acne() {
    let room = |material: Material, roof: Option<f32>| {
        let mut builder = SceneBuilder::new(DVec3::ZERO);
        let white = builder.add_material(Material::white());
        builder
            .add_instance("floor", white, shapes::plane(Vec3::ZERO, Vec3::new(0.1, 1.0, 0.05), 4.0))
            .expect("the floor is whole");
        let texels = vec![[255, 255, 255, 0]];
        let image = builder.add_image(Image { width: 1, height: 1, texels });
        let texture = Texture { image, wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat };
        let material = builder.add_material(Material { texture: Some(texture), ..material });
        if let Some(height) = roof {
            let roof = shapes::plane(Vec3::Y * height, Vec3::new(0.03, -1.0, 0.02), 3.9);
            builder.add_instance("roof", material, roof).expect("the roof is whole");
        }
        let lamp = LightKind::Point { position: Vec3::Y * 2.5, range: None };
        builder.add_light("lamp", Light { kind: lamp, color: Vec3::ONE, intensity: 100.0 });
        let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far: None };
        let camera = Camera::look_at(DVec3::new(0.5, 2.0, 3.0), DVec3::new(0.0, 0.0, -0.5), projection);
        builder.add_camera("main", camera.expect("the eye is not the target"));
        builder.build().expect("the scene is whole")
    };
    let settings = ShadowSettings { bias: Bias::NONE, map_size: 512, ..ShadowSettings::default() };
    let hole = Material { alpha: Alpha::Mask { cutoff: 0.5 }, ..Material::white() };
    for (case, scene) in [
        ("nothing above", room(Material::white(), None)),
        ("a ceiling with the lamp on it", room(Material::white(), Some(2.5))),
        ("a card that is a hole", room(hole, Some(1.5))),
    ] {
        let counts = judged(&scene, &settings).total();
        assert!(counts.wrong() > 50_000, "{case}: {counts:?}");
        // Some taps lie beside the floor, and some rays pass by its edge.
        assert!(counts.count(Cause::Acne) * 100 > counts.wrong() * 99, "{case}: {counts:?}");
    }
}

/// Texels that hold what nothing has there are blamed on slivers where slivers are, and on nothing else.
#[test]
fn wrong_texels_are_blamed_on_slivers_where_there_are_any() {
    let floor_over = |sliver: Option<f32>| {
        let mut builder = SceneBuilder::new(DVec3::ZERO);
        let white = builder.add_material(Material::white());
        builder.add_instance("floor", white, shapes::plane(Vec3::ZERO, Vec3::Y, 4.0)).expect("the floor is whole");
        if let Some(height) = sliver {
            // Below the floor, where it hides nothing: a strip as long as the floor.
            let mut strip = shapes::plane(Vec3::NEG_Y, Vec3::Y, 4.0);
            strip.vertices.positions.iter_mut().for_each(|position| position.z *= height / 8.0);
            builder.add_instance("strip", white, strip).expect("the strip is whole");
        }
        let sun = LightKind::Directional { direction: Vec3::new(0.05, -1.0, 0.02) };
        builder.add_light("sun", Light { kind: sun, color: Vec3::ONE, intensity: 100.0 });
        let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far: None };
        let camera = Camera::look_at(DVec3::new(0.5, 6.0, 3.0), DVec3::ZERO, projection);
        builder.add_camera("main", camera.expect("the eye is not the target"));
        builder.build().expect("the scene is whole")
    };
    let settings = ShadowSettings { filter: Filter::Hard, map_size: 64, ..ShadowSettings::default() };
    // The bound on rounding ends where a triangle's length, squared, over its height is eight times as long as the map: about 64 m here, and so at a height of 1 m.
    for (case, scene, is_blamed) in [
        ("a floor", floor_over(None), false),
        ("a broad strip", floor_over(Some(4.0)), false),
        ("a sliver", floor_over(Some(0.2)), true),
    ] {
        let plan = plan(&scene, &settings);
        let mut drawn = frame(&scene, &plan);
        for layer in &mut drawn.layers {
            // Everything is in the shadow of what is not there.
            match (layer.name, &mut layer.pixels) {
                (LayerName::ShadowMap { .. }, Pixels::Float(texels)) => texels.fill(0.01),
                (LayerName::Visibility { .. }, Pixels::Float(visibility)) => visibility.fill(0.0),
                _ => {}
            }
        }
        let tracer = Tracer::new(&scene, 0).expect("threads start");
        let judge = judge(&tracer);
        let counts = judge.judge(&plan, &drawn).expect("the frame is of the judge's view").total();
        assert_eq!(counts.by_slivers > 0, is_blamed, "{case}: {counts:?}");
        assert!(counts.count(Cause::Acne) > 10_000, "what lies beside the sliver is no sliver's fault: {case}: {counts:?}");
        // Without the maps nothing can be blamed on anything.
        drawn.layers.retain(|layer| !matches!(layer.name, LayerName::ShadowMap { .. }));
        let without = judge.judge(&plan, &drawn).expect("the frame is of the judge's view").total();
        assert_eq!(
            (without.by_slivers, without.count(Cause::Acne)),
            (0, counts.count(Cause::Acne) + counts.by_slivers),
            "{case}"
        );
    }
}

/// With a bias of b metres along the light the shadow of an upright bar begins where the way from the floor to the bar is longer than b. Light along
/// (0, -1, -1) goes `sqrt(2)` metres for each that it goes to the side.
#[test]
fn a_bias_that_is_too_long_detaches_shadows_by_its_length() {
    const BIAS: f64 = 0.5;
    let scene = builtin::fence();
    let bias = Bias::constant(BIAS as f32);
    let settings = ShadowSettings { bias, filter: Filter::Hard, map_size: 4096, ..ShadowSettings::default() };
    let judgement = judged(&scene, &settings);
    let [texel_x, texel_y] = plan(&scene, &settings).views[0].texel_metres.map(f64::from);
    // Half a texel on either side is what a lookup can be off; along the light the floor stretches it by sqrt(2).
    let tolerance = texel_x.max(texel_y);
    let gap = BIAS / SQRT_2;
    let (mut detached, mut attached) = (0, 0);
    for (pixel, point) in points(&scene).iter().enumerate() {
        let Some(point) = point.filter(|point| point.normal.y > 0.9) else { continue };
        let (x, length) = (point.position.x, -point.position.z);
        let along_bar = (x + 4.0).rem_euclid(f64::from(builtin::FENCE_PITCH));
        let is_in_shadow = x.abs() < 3.9
            && (tolerance..f64::from(builtin::FENCE_WIDTH) - tolerance).contains(&along_bar)
            && (tolerance..f64::from(builtin::FENCE_HEIGHT) - tolerance).contains(&length);
        if is_in_shadow && (length - gap).abs() > tolerance {
            let expected = (length < gap).then_some(Cause::PeterPanning);
            assert_eq!(Cause::of_number(judgement.lights[0].causes[pixel]), expected, "at {}", point.position);
            if length < gap { detached += 1 } else { attached += 1 }
        }
    }
    assert!(detached > 300 && attached > 1000, "{detached} detached and {attached} attached pixels");
}

/// Where the bias is enough and no more, what is wrong lies beside the true outline: within the reach of the taps, half a texel or a whole one.
#[test]
fn what_resolution_leaves_lies_beside_the_outline() {
    let scene = builtin::box_on_plane();
    for (filter, cause, reach) in [(Filter::Hard, Cause::Aliasing, 0.5), (Filter::Bilinear, Cause::Filter, 1.0)] {
        let settings = ShadowSettings { filter, map_size: 256, ..ShadowSettings::default() };
        let judgement = judged(&scene, &settings);
        let [texel_x, texel_y] = plan(&scene, &settings).views[0].texel_metres.map(f64::from);
        let mut wrong = 0;
        for (pixel, point) in points(&scene).iter().enumerate() {
            let Some(point) = point.filter(|point| point.position.y < 1e-6) else { continue };
            let Some(found) = Cause::of_number(judgement.lights[0].causes[pixel]) else { continue };
            // On the floor the light's texels are as wide across the light, and sqrt(5) / 2 as long along it; either side may be the view's x.
            let position = point.position;
            let longest = texel_x.max(texel_y) * 5.0_f64.sqrt() / 2.0;
            let beside = |edge: f64, at: f64| (edge - at).abs() <= reach * longest + 1e-6;
            let is_beside = beside(2.0, position.x) || beside(1.0, position.x) || beside(1.0, position.z.abs());
            assert!(is_beside, "{found:?} at {position}");
            wrong += u32::from(found == cause);
        }
        assert!(wrong > 50, "{filter:?}: {wrong} pixels");
    }
}

/// A light with a size is judged by its centre for the cause, and by its whole for the error.
#[test]
fn a_penumbra_is_an_error_and_no_cause() {
    let scene = builtin::box_on_plane();
    let mut light = scene.lights()[0].clone();
    light.shape = LightShape::Disc { angular_diameter: 0.3 };
    let soft = scene.clone().with_lights(vec![light]);
    let settings = ShadowSettings { map_size: 4096, ..ShadowSettings::default() };
    let (hard, soft) = (judged(&scene, &settings).total(), judged(&soft, &settings).total());
    assert_eq!(hard.causes, soft.causes);
    assert!(soft.rmse() > 4.0 * hard.rmse() && hard.rmse() > 0.0, "{} and {}", hard.rmse(), soft.rmse());
}

/// The rule that is the automatic bias is judged as the renderer's frame is, and one that does nothing as no bias.
#[test]
fn rules_are_judged_as_the_frames_that_follow_them() {
    let scene = still_life();
    let tracer = Tracer::new(&scene, 0).expect("threads start");
    let judge = judge(&tracer);
    let three_js = ENGINES.iter().find(|engine| engine.name == "three.js").expect("it is among the engines").directional;
    for (rule, bias) in [(Rule::Automatic { scale: 1.0 }, Bias::Automatic), (three_js, Bias::NONE)] {
        let plan_of = |bias| plan(&scene, &ShadowSettings { map_size: 512, bias, ..ShadowSettings::default() });
        let by_frame = judge.judge(&plan_of(bias), &frame(&scene, &plan_of(bias))).expect("the frame is of the judge's view");
        // Rules are asked under one plan, that of the automatic bias.
        let plan = plan_of(Bias::Automatic);
        let drawn = frame(&scene, &plan);
        let maps = cpu().shadow_maps(&cpu().prepare(&scene), &plan);
        let ask = |light: &LightPlan, views: &[ViewPlan], receiver: &Receiver| rule.ask(light, views, receiver);
        let triangles = drawn.triangles().expect("it was asked for");
        let mut by_rule = Counts::default();
        for light in 0..scene.lights().len() {
            by_rule += judge.judge_rule(&plan, light, triangles, &maps, &ask).counts;
        }
        let (acne, expected) = (by_rule.count(Cause::Acne), by_frame.total().count(Cause::Acne));
        if bias == Bias::Automatic {
            assert_eq!(by_rule, by_frame.total());
        } else {
            // Guard bands differ by three texels of 512, and with them the texels.
            assert!(acne.abs_diff(expected) * 50 < expected, "{acne} and {expected} pixels of acne");
        }
    }
}

/// What a fault does to a plan, a frame, or the scene that is rendered.
enum Fault {
    Plan(fn(&mut FramePlan)),
    Frame(fn(&mut Frame)),
    Scene(fn() -> Scene),
}

/// The scene that faults are planted in: a table of four legs on a floor with a ball, and two lights, one with six maps.
fn still_life() -> Scene {
    furnished(true, false)
}

fn furnished(with_ball: bool, is_inside_out: bool) -> Scene {
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let white = builder.add_material(Material::white());
    let mut add = |name: &str, mut mesh: shadow_scene::Mesh| {
        if is_inside_out {
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        builder.add_instance(name, white, mesh).expect("the mesh is whole");
    };
    let block = |center: [f32; 3], half: [f32; 3]| shapes::cuboid(center.into(), half.into(), glam::Quat::from_rotation_y(0.4));
    add("floor", shapes::plane(Vec3::ZERO, Vec3::new(0.02, 1.0, 0.01), 6.0));
    add("top", block([0.0, 1.2, 0.0], [1.2, 0.05, 0.8]));
    for (x, z) in [(-0.9, -0.6), (0.9, -0.6), (0.9, 0.6), (-0.9, 0.6)] {
        let turned = glam::Quat::from_rotation_y(0.4) * Vec3::new(x, 0.55, z);
        add("leg", block(turned.to_array(), [0.05, 0.6, 0.05]));
    }
    if with_ball {
        add("ball", shapes::sphere(Vec3::new(-1.9, 0.5, 0.8), 0.5, 48));
    }
    let light = |kind, intensity| Light { kind, color: Vec3::ONE, intensity };
    builder.add_light("sun", light(LightKind::Directional { direction: Vec3::new(0.5, -1.0, -0.4) }, 10_000.0));
    builder.add_light("lamp", light(LightKind::Point { position: Vec3::new(1.5, 2.6, 1.8), range: None }, 1_000.0));
    let projection = Projection::Perspective { vertical_fov: 0.7, near: 0.1, far: None };
    let camera = Camera::look_at(DVec3::new(2.5, 4.0, 6.0), DVec3::new(-0.2, 0.5, 0.0), projection);
    builder.add_camera("main", camera.expect("the eye is not the target"));
    builder.build().expect("the scene is whole")
}

fn floats(frame: &mut Frame, name: LayerName) -> &mut Vec<f32> {
    let layer = frame.layers.iter_mut().find(|layer| layer.name == name).expect("the layer is there");
    match &mut layer.pixels {
        Pixels::Float(values) => values,
        other => panic!("{name} has {other:?}"),
    }
}

const SUN: LayerName = LayerName::Visibility { light: 0 };
const LAMP: LayerName = LayerName::Visibility { light: 1 };

/// A plan's rows `clip_x` to `clip_w` of a view as one matrix, for faults that mix them.
fn transpose(rows: [[f32; 4]; 4]) -> [[f32; 4]; 4] {
    core::array::from_fn(|i| core::array::from_fn(|j| rows[j][i]))
}

/// Judges the still life with a fault in it.
fn with(fault: &Fault) -> Judgement {
    let scene = still_life();
    let settings = ShadowSettings { map_size: 1024, ..ShadowSettings::default() };
    let tracer = Tracer::new(&scene, 0).expect("threads start");
    let judge = judge(&tracer);
    let mut faulty_plan = plan(&scene, &settings);
    let frame = match fault {
        Fault::Plan(change) => {
            change(&mut faulty_plan);
            frame(&scene, &faulty_plan)
        }
        Fault::Frame(change) => {
            let mut frame = frame(&scene, &faulty_plan);
            change(&mut frame);
            frame
        }
        Fault::Scene(other) => {
            let other = other();
            frame(&other, &plan(&other, &settings))
        }
    };
    judge.judge(&faulty_plan, &frame).expect("the frame is of the judge's view")
}

/// A planted fault is caught if far more pixels are wrong than without it, for the cause that it should have.
fn assert_caught(name: &str, fault: &Fault, cause: Cause) {
    static SOUND: std::sync::OnceLock<Counts> = std::sync::OnceLock::new();
    let sound = SOUND.get_or_init(|| with(&Fault::Frame(|_| {})).total());
    let faulty = with(fault).total();
    let (before, after) = (sound.count(cause), faulty.count(cause));
    say(&format!("{name}: {:?} became {:?} rmse {:.4} to {:.4}", sound.causes, faulty.causes, sound.rmse(), faulty.rmse()));
    assert_eq!(sound.count(Cause::Acne), 0, "the sound scene has no acne");
    assert!(
        after >= before + 40 && after >= 2 * before,
        "{name} is not caught: {before} pixels of {} became {after}",
        cause.name()
    );
}

/// Names each fault by the test that catches it, with the cause that it must show.
macro_rules! faults {
    ($($(#[$doc:meta])* $name:ident: $cause:ident, $fault:expr;)*) => {
        mod faults {
            use super::*;

            $($(#[$doc])* #[test] fn $name() { assert_caught(stringify!($name), &$fault, Cause::$cause); })*

            /// The names of all faults, which a run of the tests lists.
            pub(super) const NAMES: &[&str] = &[$(stringify!($name)),*];
        }
    };
}

faults! {
    transposed_matrix: Leak, Fault::Plan(|plan| {
        let view = &mut plan.views[0];
        let rows = transpose([view.clip_x, view.clip_y, view.clip_z, view.clip_w]);
        [view.clip_x, view.clip_y, view.clip_z, view.clip_w] = rows;
    });
    one_texel_of_shift: Leak, Fault::Plan(|plan| plan.views[0].texel_offset[0] += 1.0);
    half_a_texel_of_shift: Acne, Fault::Plan(|plan| plan.views[0].texel_offset.iter_mut().for_each(|offset| *offset += 0.5));
    wrong_cube_face: Acne, Fault::Plan(|plan| {
        // What looks down is answered from the map that looks to the side, and the other way round.
        let first = plan.lights[1].first_view as usize;
        (plan.views[first + 1].layer, plan.views[first + 3].layer) = (plan.views[first + 3].layer, plan.views[first + 1].layer);
    });
    swapped_winding: Coverage, Fault::Scene(|| furnished(true, true));
    bias_removed: Acne, Fault::Plan(|plan| plan.lights[0].bias = shadow_math::plan::BIAS_NONE);
    bias_halved: Acne, Fault::Plan(|plan| plan.lights.iter_mut().for_each(|light| light.slope_scale = 0.5));
    bias_for_a_smaller_filter: Acne, Fault::Plan(|plan| plan.lights.iter_mut().for_each(|light| light.slope_scale = 0.75));
    bias_of_half_a_metre: PeterPanning, Fault::Plan(|plan| {
        plan.lights[0].bias = shadow_math::plan::BIAS_CONSTANT;
        plan.lights[0].bias_metres = 0.5;
    });
    near_plane_too_far: Leak, Fault::Plan(|plan| plan.views[0].clip_z[3] -= 0.62);
    far_plane_too_near: Acne, Fault::Plan(|plan| {
        let view = &mut plan.views[0];
        view.clip_z = view.clip_z.map(|number| 2.6 * number);
    });
    flipped_rows_of_the_map: Leak, Fault::Plan(|plan| {
        // The maps are drawn with y up, and read with y down.
        let view = &mut plan.views[0];
        view.texel_scale[1] = -view.texel_scale[1];
    });
    light_from_behind: Acne, Fault::Frame(|frame| floats(frame, SUN).iter_mut().for_each(|v| *v = 0.0));
    light_turned_by_two_degrees: Leak, Fault::Scene(|| {
        let scene = still_life();
        let mut lights = scene.lights().to_vec();
        let turned = glam::Quat::from_rotation_z(2.0_f32.to_radians()) * Vec3::new(0.5, -1.0, -0.4);
        lights[0].light.kind = LightKind::Directional { direction: turned };
        scene.with_lights(lights)
    });
    light_moved_by_a_decimetre: Leak, Fault::Scene(|| {
        let scene = still_life();
        let mut lights = scene.lights().to_vec();
        lights[1].light.kind = LightKind::Point { position: Vec3::new(1.6, 2.6, 1.8), range: None };
        scene.with_lights(lights)
    });
    a_quarter_of_the_map: Leak, Fault::Plan(|plan| plan.views[0].rect = [0, 0, 512, 512]);
    missing_caster: Leak, Fault::Scene(|| furnished(false, false));
    visibility_inverted: Acne, Fault::Frame(|frame| floats(frame, SUN).iter_mut().for_each(|v| *v = 1.0 - *v));
    shadows_left_out: Leak, Fault::Frame(|frame| floats(frame, LAMP).fill(1.0));
    visibility_mirrored: Acne, Fault::Frame(|frame| floats(frame, SUN).chunks_mut(WIDTH as usize).for_each(<[f32]>::reverse));
    visibility_a_pixel_to_the_right: Aliasing, Fault::Frame(|frame| floats(frame, SUN).rotate_right(1));
    visibilities_of_two_lights_exchanged: Acne, Fault::Frame(|frame| {
        let sun = std::mem::take(floats(frame, SUN));
        let lamp = std::mem::replace(floats(frame, LAMP), sun);
        *floats(frame, SUN) = lamp;
    });
    visibility_that_is_no_number: Acne, Fault::Frame(|frame| floats(frame, SUN).iter_mut().step_by(7).for_each(|v| *v = f32::NAN));
    camera_that_draws_eight_pixels_beside: Coverage, Fault::Plan(|plan| {
        let camera = &mut plan.camera;
        let shift = 2.0 * 8.0 / WIDTH as f32;
        camera.clip_x = core::array::from_fn(|i| camera.clip_x[i] + shift * camera.clip_w[i]);
    });
}

#[test]
fn at_least_twenty_faults_are_planted() {
    assert!(faults::NAMES.len() >= 20);
    say(&format!("planted faults: {}", faults::NAMES.join(", ")));
}

#[test]
fn frames_of_another_view_are_refused() {
    let scene = builtin::box_on_plane();
    let tracer = Tracer::new(&scene, 0).expect("threads start");
    let judge = judge(&tracer);
    let plan = plan(&scene, &ShadowSettings { map_size: 64, ..ShadowSettings::default() });
    let sound = frame(&scene, &plan);
    let mut missing = sound.clone();
    missing.layers.retain(|layer| layer.name != SUN);
    assert_eq!(judge.judge(&plan, &missing), Err(JudgeError::Missing(SUN)));
    let mut other_size = sound.clone();
    other_size.layers[0].width = 5;
    assert!(matches!(judge.judge(&plan, &other_size), Err(JudgeError::Size { layer: LayerName::Triangle, width: 5, .. })));
    let mut other_kind = sound.clone();
    other_kind.layers.iter_mut().for_each(|layer| layer.pixels = Pixels::Float(vec![1.0; layer.pixels.len()]));
    assert!(matches!(judge.judge(&plan, &other_kind), Err(JudgeError::Size { width: 0, .. })));
    let more_lights = scene.clone().with_lights(vec![scene.lights()[0].clone(); 2]);
    let other_plan = FramePlan::new(&more_lights, &scene.cameras()[0].camera, &ShadowSettings::default(), 64, 36, None);
    let other_plan = other_plan.expect("the scene can be planned");
    assert_eq!(judge.judge(&other_plan, &sound), Err(JudgeError::Lights { plan: 2, scene: 1 }));
}

/// A fit that does not look at the camera stands still when it moves; a light that turns changes what it should not.
#[test]
fn shadows_stand_still_while_the_camera_moves() {
    let scene = still_life();
    let settings = ShadowSettings { map_size: 512, ..ShadowSettings::default() };
    let moved = |camera: Camera, lights: &[SceneLight]| {
        let scene = scene.clone().with_lights(lights.to_vec());
        let plan = FramePlan::new(&scene, &camera, &settings, WIDTH, HEIGHT, None).expect("the scene can be planned");
        let maps = cpu().shadow_maps(&cpu().prepare(&scene), &plan);
        (plan, maps)
    };
    let camera = scene.cameras()[0].camera;
    let tracer = Tracer::new(&scene, 0).expect("threads start");
    let points: Vec<_> = points(&scene).into_iter().flatten().step_by(11).collect();
    let (plan, maps) = moved(camera, scene.lights());
    let before = Moment { plan: &plan, maps: &maps, lights: scene.lights() };
    let score = |camera: Camera, lights: &[SceneLight]| {
        let (plan, maps) = moved(camera, lights);
        Stability::between(&tracer, &points, &before, &Moment { plan: &plan, maps: &maps, lights })
    };
    let still = score(Camera { eye: camera.eye + DVec3::new(0.001, 0.0, 0.002), ..camera }, scene.lights());
    assert_eq!(still.changed, 0);
    // The points of pixels at the picture's edge leave it.
    assert_eq!(still.compared + 2 * still.out_of_view, 2 * points.len() as u64);
    assert!(still.out_of_view < points.len() as u64 / 50, "{still:?}");
    let mut lights = scene.lights().to_vec();
    lights[0].light.kind = LightKind::Directional { direction: Vec3::new(0.501, -1.0, -0.4) };
    let turned = score(camera, &lights);
    assert!(turned.changed > 10 && turned.score() < 0.1, "{turned:?}");
    assert!(turned.compared < still.compared, "some points truly change");
}
