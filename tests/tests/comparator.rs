//! The comparator is tested before anything is tested with it: every planted difference must be found.

use glam::DVec3;
use shadow_cpu::{CpuRenderer, RasterRules};
use shadow_math::{Camera, Projection, ShadowSettings};
use shadow_scene::{
    Frame, FramePlan, LayerName, Pixels, Request, Scene, builtin,
    compare::{CompareError, Contract, compare},
};
use shadow_tests::renderers;

/// A rendered frame of the demo, and its twin under another name.
fn twins() -> (Scene, FramePlan, Frame, Frame) {
    let scene = builtin::demo();
    let settings = ShadowSettings { map_size: 256, ..ShadowSettings::default() };
    let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &settings, 160, 90, None).expect("the demo can be planned");
    let prepared = renderers::counterpart().prepare(&scene);
    let first = renderers::counterpart().render(&prepared, &plan, Request::ALL).expect("the demo can be rendered").frame;
    let second = Frame { source: "twin".into(), ..first.clone() };
    (scene, plan, first, second)
}

fn floats(frame: &mut Frame, name: LayerName) -> &mut Vec<f32> {
    let layer = frame.layers.iter_mut().find(|layer| layer.name == name).expect("the layer is there");
    match &mut layer.pixels {
        Pixels::Float(values) => values,
        _ => panic!("{name} holds single numbers"),
    }
}

fn colors(frame: &mut Frame) -> &mut Vec<[f32; 4]> {
    let layer = frame.layers.iter_mut().find(|layer| layer.name == LayerName::Color).expect("the layer is there");
    match &mut layer.pixels {
        Pixels::Rgba(values) => values,
        _ => panic!("colours are four numbers"),
    }
}

/// Plants a difference and says under which contracts the frames still agree: `(exact, tolerance)`.
fn agreement_after(plant: impl Fn(&mut Frame)) -> (bool, bool) {
    let (scene, plan, first, mut second) = twins();
    plant(&mut second);
    let verdict = |contract| compare(&first, &second, &scene, &plan, contract).expect("the frames can be compared").agree();
    let swapped = |contract| compare(&second, &first, &scene, &plan, contract).expect("the frames can be compared").agree();
    let verdicts = (verdict(Contract::Exact), verdict(Contract::Tolerance));
    assert_eq!(verdicts, (swapped(Contract::Exact), swapped(Contract::Tolerance)), "the verdict does not depend on the order");
    verdicts
}

#[test]
fn equal_frames_agree() {
    assert_eq!(agreement_after(|_| ()), (true, true));
}

#[test]
fn a_single_bit_breaks_the_exact_contract_alone() {
    let nudged = agreement_after(|frame| {
        let color = &mut colors(frame)[5000][1];
        *color = f32::from_bits(color.to_bits() + 1);
    });
    assert_eq!(nudged, (false, true));
}

#[test]
fn a_picture_shifted_by_one_pixel_is_found_in_every_layer() {
    let names: Vec<LayerName> = twins().2.layers.iter().map(|layer| layer.name).collect();
    assert!(names.len() >= 6, "the demo has two lights: {names:?}");
    for name in names {
        let shifted = agreement_after(|frame| {
            let layer = frame.layers.iter_mut().find(|layer| layer.name == name).expect("the layer is there");
            match &mut layer.pixels {
                Pixels::Float(values) => values.rotate_right(1),
                Pixels::Rgba(values) => values.rotate_right(1),
                Pixels::Id(values) => values.rotate_right(1),
            }
        });
        assert_eq!(shifted, (false, false), "{name}");
    }
}

#[test]
fn a_change_of_alpha_alone_is_found() {
    assert_eq!(agreement_after(|frame| colors(frame)[77][3] = 0.5), (false, false));
}

#[test]
fn nan_is_found_wherever_it_is() {
    assert_eq!(agreement_after(|frame| colors(frame)[4000][2] = f32::NAN), (false, false));
    for name in [LayerName::Depth, LayerName::Visibility { light: 0 }, LayerName::ShadowMap { light: 0, view: 0 }] {
        assert_eq!(agreement_after(|frame| floats(frame, name)[4321] = f32::NAN), (false, false), "{name}");
    }
}

#[test]
fn swapped_channels_and_swapped_layers_are_found() {
    let channels = agreement_after(|frame| colors(frame).iter_mut().for_each(|color| color.swap(0, 2)));
    assert_eq!(channels, (false, false));
    let layers = agreement_after(|frame| {
        let first = floats(frame, LayerName::Visibility { light: 0 }).clone();
        let second = core::mem::replace(floats(frame, LayerName::Visibility { light: 1 }), first);
        *floats(frame, LayerName::Visibility { light: 0 }) = second;
    });
    assert_eq!(layers, (false, false));
}

/// A tolerance must not swallow what it is not meant for: visibility that is wrong where no tap could explain it.
#[test]
fn wrong_visibility_without_an_excuse_is_found() {
    let (_, _, first, _) = twins();
    let lit = first.floats(LayerName::Visibility { light: 0 }).expect("the layer is there").to_vec();
    let triangles = first.triangles().expect("the layer is there").to_vec();
    // A pixel in the middle of a lit patch of a triangle, so that none of its taps is near a tie.
    let inner = (161..lit.len() - 161)
        .find(|&i| [i, i - 1, i + 1, i - 160, i + 160].iter().all(|&i| lit[i] == 1.0 && triangles[i] != u32::MAX))
        .expect("the demo has lit surfaces");
    assert_eq!(agreement_after(|frame| floats(frame, LayerName::Visibility { light: 0 })[inner] = 0.5), (false, false));
}

/// Nor a wrong colour, because a light's visibility differs there by a bit.
#[test]
fn wrong_colour_is_not_excused_by_a_bit_of_visibility() {
    let planted = agreement_after(|frame| {
        let lit = LayerName::Visibility { light: 0 };
        let pixel = floats(frame, lit).iter().position(|&visibility| visibility == 1.0).expect("something is lit");
        floats(frame, lit)[pixel] = 1.0 - f32::EPSILON;
        colors(frame)[pixel] = [0.0, 1.0, 0.0, 1.0];
    });
    assert_eq!(planted, (false, false));
}

#[test]
fn frames_that_cannot_be_compared_are_an_error() {
    let (scene, plan, first, second) = twins();
    let error = |second: &Frame| compare(&first, second, &scene, &plan, Contract::Tolerance).unwrap_err();

    let same = error(&first);
    assert!(matches!(same, CompareError::SameSource(_)), "{same}");

    let mut fewer = second.clone();
    fewer.layers.pop();
    assert!(matches!(error(&fewer), CompareError::Missing { which: "first", .. }));

    let mut smaller = second.clone();
    smaller.layers[0].width -= 1;
    assert!(matches!(error(&smaller), CompareError::Size { .. }));

    let mut truncated = second.clone();
    colors(&mut truncated).pop();
    assert!(matches!(error(&truncated), CompareError::Values { .. }));

    let nothing = Frame { source: "nothing".into(), layers: Vec::new() };
    let nobody = Frame { source: "nobody".into(), layers: Vec::new() };
    assert_eq!(compare(&nothing, &nobody, &scene, &plan, Contract::Exact).unwrap_err(), CompareError::Empty);
    assert!(matches!(compare(&nothing, &second, &scene, &plan, Contract::Exact), Err(CompareError::Missing { .. })));
}

/// The tolerance contract forgives another rounding of an edge, but not many of them.
#[test]
fn too_many_edges_are_too_many() {
    let scene = builtin::demo();
    let settings = ShadowSettings { map_size: 256, ..ShadowSettings::default() };
    let camera = scene.cameras()[0].camera;
    let shifted = Camera { eye: camera.eye + DVec3::new(0.004, 0.0, 0.0), ..camera };
    assert!(matches!(camera.projection, Projection::Perspective { .. }));
    let render = |camera: &Camera| {
        let plan = FramePlan::new(&scene, camera, &settings, 160, 90, None).expect("the demo can be planned");
        let prepared = renderers::counterpart().prepare(&scene);
        (renderers::counterpart().render(&prepared, &plan, Request::ALL).expect("the demo can be rendered").frame, plan)
    };
    let (first, plan) = render(&camera);
    let (moved, _) = render(&shifted);
    let moved = Frame { source: "moved".into(), ..moved };
    assert!(!compare(&first, &moved, &scene, &plan, Contract::Tolerance).expect("comparable").agree());
}

/// What the tolerances are for: a driver that rounds differently passes, one that snaps to another grid does not.
#[test]
fn another_rounding_is_tolerated_and_another_grid_is_not() {
    let scene = builtin::demo();
    let settings = ShadowSettings { map_size: 1024, ..ShadowSettings::default() };
    let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &settings, 640, 360, None).expect("the demo can be planned");
    let render = |rules: RasterRules| {
        let renderer = CpuRenderer::new(0, rules).expect("the threads start");
        let frame = renderer.render(&renderer.prepare(&scene), &plan, Request::ALL).expect("the demo can be rendered").frame;
        Frame { source: format!("{rules:?}"), ..frame }
    };
    let fused = render(RasterRules::lavapipe(true));
    let separate = render(RasterRules::lavapipe(false));
    let verdict = |other: &Frame, contract| compare(&fused, other, &scene, &plan, contract).expect("comparable");
    assert!(!verdict(&separate, Contract::Exact).agree(), "the two roundings are not the same");
    let tolerant = verdict(&separate, Contract::Tolerance);
    assert!(tolerant.agree(), "{:#?}", tolerant.layers);

    let coarse = render(RasterRules { subpixel_bits: 4, ..RasterRules::lavapipe(true) });
    assert!(!verdict(&coarse, Contract::Tolerance).agree(), "a grid of 4 bits differs in more than a few samples");
}
