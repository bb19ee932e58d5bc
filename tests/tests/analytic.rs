//! Scenes whose shadows follow from geometry.

use glam::{DQuat, DVec3, Quat, Vec3};
use shadow_math::{
    Bias, Camera, Filter, Light, LightKind, Projection, ShadowSettings, Split, bounds::Aabb, settings::BiasParts,
    triangle::pixel_ray,
};
use shadow_scene::{Frame, FramePlan, LayerName, Material, Request, Scene, SceneBuilder, SceneLight, builtin, builtin::shapes};
use shadow_tests::renderers;

/// A camera straight above the origin that sees `half_height` metres to either side.
fn from_above(half_height: f64) -> Camera {
    Camera {
        eye: DVec3::new(0.0, 50.0, 0.0),
        orientation: DQuat::from_rotation_x(-core::f64::consts::FRAC_PI_2),
        projection: Projection::Orthographic { half_height, near: 1.0, far: 100.0 },
    }
}

const PIXELS: u32 = 512;

fn render(scene: &Scene, half_height: f64, filter: Filter) -> (FramePlan, Frame) {
    let settings = ShadowSettings { filter, bias: Bias::default(), map_size: 2048, ..ShadowSettings::default() };
    let plan =
        FramePlan::new(scene, &from_above(half_height), &settings, PIXELS, PIXELS, None).expect("the scene can be planned");
    let renderer = renderers::cpu();
    let frame = renderer.render(&renderer.prepare(scene), &plan, Request::ALL).expect("the scene can be rendered").frame;
    (plan, frame)
}

/// Compares the visibility of every pixel on the ground with a closed form. Pixels nearer than `blur` metres to the outline, where a texel of
/// the map decides, are left out and counted: `(wrong, left out, shadowed)`.
fn against_closed_form(scene: &Scene, half_height: f64, blur: f64, shadowed: impl Fn(f32, f32) -> bool) -> (usize, usize, usize) {
    let (plan, frame) = render(scene, half_height, Filter::Hard);
    let visibility = frame.floats(LayerName::Visibility { light: 0 }).expect("the layer was asked for");
    let triangles = frame.triangles().expect("the layer was asked for");
    let (mut wrong, mut left_out, mut in_shadow) = (0, 0, 0);
    for (i, (&visibility, &triangle)) in visibility.iter().zip(triangles).enumerate() {
        let (x, y) = (i as u32 % PIXELS, i as u32 / PIXELS);
        let ray = pixel_ray(&plan.camera.rays, x as f32 + 0.5, y as f32 + 0.5);
        if triangle == u32::MAX {
            continue;
        }
        let point = scene.point(triangle, ray).point.as_dvec3() + scene.origin();
        // Only the ground; what stands on it is not in the closed form.
        if point.y.abs() > 1e-6 {
            continue;
        }
        let shadowed = |dx: f64, dz: f64| shadowed((point.x + dx) as f32, (point.z + dz) as f32);
        let expected = shadowed(0.0, 0.0);
        let near_outline =
            [(blur, 0.0), (-blur, 0.0), (0.0, blur), (0.0, -blur), (blur, blur), (-blur, -blur), (blur, -blur), (-blur, blur)]
                .into_iter()
                .any(|(dx, dz)| shadowed(dx, dz) != expected);
        in_shadow += usize::from(expected);
        if near_outline {
            left_out += 1;
        } else {
            wrong += usize::from((visibility == 0.0) != expected);
        }
    }
    (wrong, left_out, in_shadow)
}

/// How far an outline may be off: a texel's diagonal, and what the slope bias lifts off the ground.
fn blur_of(scene: &Scene, half_height: f64) -> f64 {
    let (plan, _) = render(scene, half_height, Filter::Hard);
    let [width, height] = plan.views[0].texel_metres;
    2.0 * f64::from(width.max(height)) * core::f64::consts::SQRT_2
}

#[test]
fn the_shadow_of_a_box_has_the_outline_that_geometry_gives() {
    let scene = builtin::box_on_plane();
    let blur = 1.5 * blur_of(&scene, 6.0);
    let (wrong, left_out, in_shadow) = against_closed_form(&scene, 6.0, blur, builtin::box_on_plane_is_shadowed);
    assert!(in_shadow > 3000, "the shadow is in the picture: {in_shadow}");
    assert!(left_out < in_shadow / 4, "the outline is thin: {left_out} of {in_shadow}");
    assert_eq!(wrong, 0);
}

/// Whether the segment between two points meets a box: the slabs of its axes (Kay and Kajiya 1986), in f64.
fn meets_box(from: DVec3, to: DVec3, bounds: Aabb) -> bool {
    let direction = to - from;
    let (a, b) = ((bounds.min.as_dvec3() - from) / direction, (bounds.max.as_dvec3() - from) / direction);
    let enter = a.min(b).max_element().max(0.0);
    let leave = a.max(b).min_element().min(1.0);
    enter < leave
}

/// The shadow of the box under every kind of light, also through the seams of a cube, is where segments to the light meet the box.
#[test]
fn the_shadow_of_a_box_is_where_rays_to_the_light_meet_it() {
    let scene = builtin::box_on_plane();
    let box_bounds = scene.instances().iter().map(|instance| instance.bounds).find(|bounds| bounds.max.y > 1.0).expect("the box");
    // Every light lies off the axes, where the slabs would divide by zero.
    let position = Vec3::new(1.9, 3.3, -1.3);
    let down = Vec3::new(-0.45, -1.0, 0.3);
    let spot = |outer| LightKind::Spot { position, direction: down, inner: 0.1, outer, range: None };
    let cases = [
        ("directional", LightKind::Directional { direction: down }, Split::Single),
        ("spot", spot(1.1), Split::Single),
        ("spot in a cube", spot(1.1), Split::Cube),
        ("wide spot", spot(1.5), Split::Single),
        ("point", LightKind::Point { position, range: None }, Split::Single),
        // Level with the box: its shadow leaves through the side faces of the cube.
        ("low point", LightKind::Point { position: Vec3::new(3.1, 1.2, 0.4), range: None }, Split::Single),
    ];
    for (name, kind, split) in cases {
        let light = Light { kind, color: Vec3::ONE, intensity: 1000.0 };
        let scene = scene.clone().with_lights(vec![SceneLight::new(name, light)]);
        let settings = ShadowSettings { filter: Filter::Hard, split, map_size: 2048, ..ShadowSettings::default() };
        let plan = FramePlan::new(&scene, &from_above(6.0), &settings, PIXELS, PIXELS, None).expect("the scene can be planned");
        let renderer = renderers::cpu();
        let frame = renderer.render(&renderer.prepare(&scene), &plan, Request::ALL).expect("the scene can be rendered").frame;
        let visibility = frame.floats(LayerName::Visibility { light: 0 }).expect("the layer was asked for");
        let triangles = frame.triangles().expect("the layer was asked for");
        let (mut wrong, mut left_out, mut in_shadow, mut tested) = (0, 0, 0, 0);
        for (i, (&visibility, &triangle)) in visibility.iter().zip(triangles).enumerate() {
            let ray = pixel_ray(&plan.camera.rays, (i as u32 % PIXELS) as f32 + 0.5, (i as u32 / PIXELS) as f32 + 0.5);
            if triangle == u32::MAX {
                continue;
            }
            let point = scene.point(triangle, ray).point.as_dvec3();
            let toward = match kind {
                LightKind::Directional { direction } => direction.as_dvec3() * -100.0,
                LightKind::Spot { position, .. } | LightKind::Point { position, .. } => position.as_dvec3() - point,
            };
            let cosine = toward.normalize().y;
            let in_cone = match kind {
                LightKind::Spot { outer, .. } => (-toward.normalize()).dot(down.as_dvec3().normalize()) > f64::from(outer).cos(),
                _ => true,
            };
            // Only the ground, where the light reaches it at no less than 6 degrees.
            if point.y.abs() > 1e-6 || cosine < 0.1 || !in_cone {
                continue;
            }
            // A texel's diagonal on the ground: its size at the light's distance, stretched by the slope; and what the bias lifts.
            let metres = f64::from(plan.views[0].texel_metres[0].max(plan.views[0].texel_metres[1]));
            let distance = if plan.views[0].w_per_metre > 0.0 { toward.length() } else { 1.0 };
            let blur = 3.0 * metres * distance / cosine + 0.01;
            let shadowed = |dx: f64, dz: f64| {
                let start = point + DVec3::new(dx, 0.0, dz);
                let light = match kind {
                    LightKind::Directional { .. } => start + toward,
                    _ => point + toward,
                };
                meets_box(start, light, box_bounds)
            };
            let expected = shadowed(0.0, 0.0);
            tested += 1;
            in_shadow += usize::from(expected);
            let steps = [-blur, 0.0, blur];
            if steps.iter().any(|&dx| steps.iter().any(|&dz| shadowed(dx, dz) != expected)) {
                left_out += 1;
            } else {
                wrong += usize::from((visibility == 0.0) != expected);
            }
        }
        assert_eq!(wrong, 0, "{name}: of {tested} pixels, {in_shadow} in shadow, {left_out} left out");
        assert!(in_shadow > 2000 && left_out < tested / 8, "{name}: {in_shadow} in shadow, {left_out} of {tested} left out");
    }
}

#[test]
fn a_fence_shadows_the_share_that_its_bars_take_up() {
    let scene = builtin::fence();
    let blur = blur_of(&scene, 1.0);
    let (wrong, left_out, in_shadow) = against_closed_form(&scene, 1.0, blur, builtin::fence_is_shadowed);
    assert!(in_shadow > 1000, "the shadow is in the picture: {in_shadow}");
    assert!(left_out < 4 * in_shadow, "some of every bar is left to test: {left_out} of {in_shadow}");
    assert_eq!(wrong, 0);
}

/// The lit plane at one degree: the case that every constant bias fails.
#[test]
fn a_grazing_light_leaves_no_acne() {
    let scene = builtin::grazing();
    for filter in [Filter::Hard, Filter::Bilinear] {
        let (_, frame) = render(&scene, 4.0, filter);
        let visibility = frame.floats(LayerName::Visibility { light: 0 }).expect("the layer was asked for");
        let seen = frame.triangles().expect("the layer was asked for").iter().filter(|&&triangle| triangle != u32::MAX).count();
        assert!(seen > 10_000, "the plane is in the picture");
        assert!(visibility.iter().all(|&visibility| visibility == 1.0), "{filter:?}");
    }
    let constant = ShadowSettings { bias: Bias::constant(0.01), map_size: 512, ..ShadowSettings::default() };
    let plan = FramePlan::new(&scene, &from_above(4.0), &constant, PIXELS, PIXELS, None).expect("the scene can be planned");
    let renderer = renderers::cpu();
    let frame = renderer.render(&renderer.prepare(&scene), &plan, Request::ALL).expect("the scene can be rendered").frame;
    let visibility = frame.floats(LayerName::Visibility { light: 0 }).expect("the layer was asked for");
    assert!(visibility.iter().any(|&visibility| visibility < 1.0), "a centimetre is not enough at one degree");
}

/// Under a light that stands straight above a box the map holds its top, or with back faces alone its bottom, as far below as the box is high. A material with two sides keeps both, and so the top.
#[test]
fn back_faces_of_a_box_are_as_far_below_as_it_is_high() {
    const HEIGHT: f32 = 1.5;
    let middle_of_map = |double_sided: bool, bias: Bias| {
        let mut builder = SceneBuilder::new(DVec3::ZERO);
        let material = builder.add_material(Material { double_sided, ..Material::white() });
        let cuboid = shapes::cuboid(Vec3::Y, Vec3::new(1.0, 0.5 * HEIGHT, 1.0), Quat::IDENTITY);
        builder.add_instance("box", material, cuboid).expect("the mesh is whole");
        let sun = LightKind::Directional { direction: Vec3::NEG_Y };
        builder.add_light("sun", Light { kind: sun, color: Vec3::ONE, intensity: 1.0 });
        builder.add_camera("above", from_above(2.0));
        let scene = builder.build().expect("the scene is whole");
        let settings = ShadowSettings { bias, map_size: 64, ..ShadowSettings::default() };
        let plan = FramePlan::new(&scene, &from_above(2.0), &settings, 16, 16, None).expect("the scene can be planned");
        let map = LayerName::ShadowMap { light: 0, view: 0 };
        let cpu = renderers::cpu().render(&renderers::cpu().prepare(&scene), &plan, Request::ALL).expect("it fits").frame;
        let gpu = pollster::block_on(async {
            let scene = renderers::gpu().upload(&scene).await.expect("the scene fits");
            renderers::gpu().render(&scene, &plan, Request::ALL).await.expect("the picture fits").frame
        });
        [cpu, gpu].map(|frame| frame.floats(map).expect("the layer was asked for")[32 * 64 + 32] / plan.views[0].depth_factor)
    };
    let back_faces = Bias::Parts(BiasParts { back_faces: true, ..BiasParts::NONE });
    for (double_sided, expected) in [(false, HEIGHT), (true, 0.0)] {
        let (fronts, backs) = (middle_of_map(double_sided, Bias::NONE), middle_of_map(double_sided, back_faces));
        for (front, back) in fronts.into_iter().zip(backs) {
            // Depths in f32 over a range of some metres.
            assert!((back - front - expected).abs() < 1e-5, "two sides {double_sided}: {front} m and {back} m");
        }
    }
}
