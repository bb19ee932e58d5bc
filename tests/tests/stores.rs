//! What maps hold, against rays and closed forms.

use glam::{DMat4, DVec2, DVec4, Vec3};
use shadow_cpu::{
    resolve::ShadowMaps,
    trace::{Ray, Tracer},
};
use shadow_math::{
    Bias, Filter, Light, LightKind, ShadowSettings, Store, Texels,
    bias::gradient_by_plane,
    plan::ViewPlan,
    rounding::step_rounding,
    settings::{BiasParts, Ogre2006, PolygonOffset},
    triangle::pixel_ray,
};
use shadow_scene::{FramePlan, LayerName, Request, Scene, builtin};
use shadow_tests::{
    lights::{lit_by, one_of_each},
    renderers::{self, cpu},
};

const MAP: u32 = 256;

fn plan_of(scene: &Scene, settings: ShadowSettings) -> FramePlan {
    FramePlan::new(scene, &scene.cameras()[0].camera, &settings, 64, 36, None).expect("the scene can be planned")
}

fn maps_of(scene: &Scene, plan: &FramePlan) -> ShadowMaps {
    cpu().shadow_maps(&cpu().prepare(scene), plan)
}

/// The distance along the view's axis of the first and the second surface behind a texel's centre, as rays meet them.
fn surfaces_behind(tracer: &Tracer<'_>, view: &ViewPlan, x: u32, y: u32) -> [Option<f64>; 2] {
    let texel = pixel_ray(&view.rays, x as f32 + 0.5, y as f32 + 0.5);
    let (eye, direction) = (texel.origin.as_dvec3(), texel.direction.as_dvec3());
    let mut rays = tracer.rays();
    let mut ray = Ray::along(eye, direction);
    let mut found = [None; 2];
    for distance in &mut found {
        let Some(hit) = rays.closest(ray) else { break };
        let point = ray.at(hit.distance);
        // The texel's direction is one along the axis, whichever way it leans.
        *distance = Some((point - eye).dot(direction) / direction.length_squared());
        ray = Ray::along(point, direction).leaving(hit.triangle);
    }
    found
}

/// What a store makes of distances along the axis, by its definition.
fn expected(store: Store, view: &ViewPlan, [first, second]: [Option<f64>; 2]) -> f64 {
    let [near, far] = view.depth_range.map(f64::from);
    let is_perspective = view.w_per_metre > 0.0;
    // An orthographic view's rays begin on its near plane.
    let linear = |distance: f64| if is_perspective { (distance - near) / (far - near) } else { distance / (far - near) };
    let depth = |distance: f64| if is_perspective { far / (far - near) * (1.0 - near / distance) } else { linear(distance) };
    match (store, first, second) {
        (Store::Reversed32, Some(first), _) => 1.0 - depth(first),
        (Store::Reversed32, ..) => 0.0,
        (Store::Linear, Some(first), _) => linear(first),
        (Store::Second, _, Some(second)) => depth(second),
        (Store::Midpoint, Some(first), Some(second)) => 0.5 * (depth(first) + depth(second)),
        (Store::Second | Store::Midpoint, ..) => 1.0,
        (_, Some(first), _) => depth(first),
        _ => 1.0,
    }
}

#[test]
fn every_store_holds_what_rays_meet() {
    let demo = builtin::demo();
    for (name, light) in one_of_each(&demo) {
        let scene = lit_by(&demo, name, light);
        let tracer = Tracer::new(&scene, 0).expect("threads start");
        for store in Store::ALL {
            let plan = plan_of(&scene, ShadowSettings { store, map_size: MAP, ..ShadowSettings::default() });
            let maps = maps_of(&scene, &plan);
            // Of a cube the face that looks down.
            let index = if plan.views.len() > 1 { 3 } else { 0 };
            let (view, map) = (&plan.views[index], &maps.layers[index]);
            let (mut off, mut held) = (0, 0);
            for y in (0..MAP).step_by(3) {
                for x in (0..MAP).step_by(3) {
                    let surfaces = surfaces_behind(&tracer, view, x, y);
                    let stored = f64::from(map[(y * MAP + x) as usize]);
                    // Half a step; and what snapped corners leave open on the slopes of the demo, whose steepest change by a texel's width of depth.
                    let steps = f64::from(store.steps());
                    let tolerance = if steps > 0.0 { step_rounding(store.steps()) } else { 0.0 } + 2e-5;
                    // The quotient of a whole number and the steps, as f32 has it.
                    let whole = (stored * steps).round();
                    assert!(steps == 0.0 || stored == f64::from((whole / steps) as f32), "{store:?}: {stored} is no step");
                    off += usize::from((stored - expected(store, view, surfaces)).abs() > tolerance);
                    held += usize::from(surfaces[0].is_some());
                }
            }
            assert!(held > 1000, "{name} {store:?}: only {held} texels hold anything");
            // Where an outline passes a texel's centre rays and rasteriser may see different triangles; second surfaces have more outlines.
            assert!(off * 100 <= held, "{name} {store:?}: {off} of {held} texels");
        }
    }
}

/// The largest error of a map of a plane, in metres along the axis, for a light whose near plane lies at a thousandth of the far plane's distance.
fn largest_error(store: Store) -> f64 {
    let plane = builtin::by_name("tilted-plane").expect("it is built in");
    // The light stands close beside a corner of the plane and shines along it, so that the depth range is wide.
    let bounds = plane.bounds();
    let position = bounds.center() + Vec3::new(0.0, 0.55, 0.0) * bounds.radius();
    let direction = Vec3::new(0.3, -1.0, 0.2);
    let light = Light {
        kind: LightKind::Spot { position, direction, inner: 0.1, outer: 1.2, range: None },
        color: Vec3::ONE,
        intensity: 100.0,
    };
    let scene = lit_by(&plane, "lamp", light);
    let tracer = Tracer::new(&scene, 0).expect("threads start");
    let plan = plan_of(&scene, ShadowSettings { store, map_size: MAP, ..ShadowSettings::default() });
    let maps = maps_of(&scene, &plan);
    let view = &plan.views[0];
    let [near, far] = view.depth_range.map(f64::from);
    let mut largest: f64 = 0.0;
    for index in (0..MAP * MAP).step_by(7) {
        let (x, y) = (index % MAP, index / MAP);
        let Some(true_distance) = surfaces_behind(&tracer, view, x, y)[0] else { continue };
        let stored = f64::from(maps.layers[0][index as usize]);
        let distance = match store {
            Store::Linear => near + stored * (far - near),
            Store::Reversed32 => near * far / (near + stored * (far - near)),
            _ => near * far / (far - stored * (far - near)),
        };
        // Half of a texel's slope is rasterisation, not storage: a plane's depth is exact at its centre but for the sub-pixel grid.
        largest = largest.max((distance - true_distance).abs());
    }
    largest
}

#[test]
fn narrow_formats_are_as_far_off_as_their_steps() {
    let [float, reversed, linear, bits_24, bits_16] =
        [Store::Depth32, Store::Reversed32, Store::Linear, Store::Depth24, Store::Depth16].map(largest_error);
    assert!(reversed <= float * 1.01 && linear <= float * 1.01, "{reversed} {linear} {float}");
    assert!(bits_24 <= 4.0 * float && bits_16 > 20.0 * float, "{bits_24} {bits_16} {float}");
}

/// Of each texel that shows the plane of the scene `tilted-plane`: its depth, by how much a bias pushes it, and the larger of the plane's two slopes.
fn pushed(parts: BiasParts, store: Store, light: Light) -> Vec<(f64, f64, f64)> {
    let plane = builtin::by_name("tilted-plane").expect("it is built in");
    let scene = lit_by(&plane, "light", light);
    let corners = scene.triangles()[0].map(|corner| scene.vertices().positions[corner as usize].as_dvec3());
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let settings = ShadowSettings { bias: Bias::NONE, store, map_size: MAP, ..ShadowSettings::default() };
    let plain = plan_of(&scene, settings);
    let biased = plan_of(&scene, ShadowSettings { bias: Bias::Parts(parts), ..settings });
    let view = &plain.views[0];
    let row = |row: [f32; 4]| DVec4::from_array(row.map(f64::from));
    let (x, y, z, w) = (row(view.clip_x), row(view.clip_y), row(view.clip_z), row(view.clip_w));
    let texel = |ndc: DVec4, axis: usize| ndc * f64::from(view.texel_scale[axis]) + w * f64::from(view.texel_offset[axis]);
    let texel_from_world = DMat4::from_cols(texel(x, 0), texel(y, 1), z, w).transpose();
    let gradient = gradient_by_plane(texel_from_world, normal.extend(-normal.dot(corners[0]))).abs();
    let before = maps_of(&scene, &plain);
    let after = maps_of(&scene, &biased);
    let texels = before.layers[0].iter().zip(after.layers[0].iter()).filter(|(before, _)| (0.2..0.9).contains(*before));
    let pushed: Vec<_> = texels.map(|(&before, &after)| (f64::from(before), f64::from(after) - f64::from(before))).collect();
    assert!(pushed.len() > 1000, "only {} texels show the plane", pushed.len());
    pushed.into_iter().map(|(depth, push)| (depth, push, gradient.x.max(gradient.y))).collect()
}

fn sun() -> Light {
    Light { kind: LightKind::Directional { direction: Vec3::new(-0.4, -1.0, 0.3) }, color: Vec3::ONE, intensity: 1e4 }
}

#[test]
fn a_polygon_offset_is_its_formula() {
    let offset = PolygonOffset { slope: 3.0, units: 500.0, clamp: 0.0 };
    let parts = |offset| BiasParts { polygon_offset: Some(offset), ..BiasParts::NONE };
    for (store, unit) in [(Store::Depth16, 1.0 / 65_535.0), (Store::Depth24, 1.0 / 16_777_215.0), (Store::Depth32, 0.0)] {
        for (depth, push, slope) in pushed(parts(offset), store, sun()) {
            // A float's unit goes by the largest depth of the triangle: here between a half and one.
            let unit = if store == Store::Depth32 { 0.5_f64.powi(24) } else { unit };
            let expected = 3.0 * slope + 500.0 * unit;
            // Two roundings to steps, and the gradient in single precision.
            let tolerance = if store == Store::Depth16 { 1.01 / 65_535.0 } else { 4e-7 } + 1e-4 * expected;
            assert!((push - expected).abs() <= tolerance, "{store:?} at {depth}: {push} instead of {expected}");
        }
    }
    let clamped = PolygonOffset { clamp: 0.001, ..offset };
    for (depth, push, slope) in pushed(parts(clamped), Store::Depth32, sun()) {
        assert!(3.0 * slope > 0.001 && (push - 0.001).abs() < 2e-7, "at {depth}: {push}");
    }
}

/// Against what the shader computes, in the depth of OpenGL's clip space, for a directional and for a spot light.
#[test]
fn the_caster_shader_of_2006_is_what_was_published() {
    let plane = builtin::by_name("tilted-plane").expect("it is built in");
    let [_, (_, spot), _] = one_of_each(&plane);
    for light in [sun(), spot] {
        let parts = |is_corrected| BiasParts { ogre_2006: Some(Ogre2006 { metres: 0.02, is_corrected }), ..BiasParts::NONE };
        let scene = lit_by(&plane, "light", light);
        // The depth range goes by what lies in the view, and the view by how far the bias reaches.
        let view = plan_of(&scene, ShadowSettings { bias: Bias::NONE, map_size: MAP, ..ShadowSettings::default() }).views[0];
        let [near, far] = view.depth_range.map(f64::from);
        let range = far - near;
        for (depth, push, larger) in pushed(parts(false), Store::Depth32, light) {
            // A push by a length along the axis, to the first order: uDepthOffset * ddepth, halved.
            let by_metres = if view.w_per_metre > 0.0 {
                let w = near * far / (far - depth * range);
                0.02 * near * far / range / (w * w)
            } else {
                0.02 / range
            };
            // Steps of 1 / width are half a texel, in a depth of twice the size; of that a half is added, and halved into 0 to 1.
            let by_slope = 0.5 * (0.5 * (larger * 0.5 * 2.0));
            let expected = by_slope + by_metres;
            assert!(
                (push - expected).abs() < 1e-4 * expected + 3e-7,
                "{:?} at {depth}: {push} instead of {expected}, {by_slope} {by_metres}",
                light.kind
            );
        }
        let corrected = pushed(parts(true), Store::Depth32, light);
        let published = pushed(parts(false), Store::Depth32, light);
        for (corrected, published) in corrected.iter().zip(&published) {
            let ratio = (corrected.1 - published.1) / corrected.2;
            // The sum of both slopes less a quarter of the larger: from 3/4 of it, where the other is nothing, to 7/4, where they are alike.
            assert!((0.74..=1.76).contains(&ratio), "{ratio}");
        }
    }
}

/// The shadow of a box moves by half a texel on both axes where lookups think that texels are elsewhere.
#[test]
fn mixed_texel_conventions_move_shadows_by_half_a_texel() {
    let scene = builtin::by_name("box-on-plane").expect("it is built in");
    let camera = scene.cameras()[0].camera;
    let shadowed = |texels: Texels| {
        // Twice what a hard test needs where texels are: half a texel more each way.
        let bias = Bias::slope(2.5, 0.0);
        let settings = ShadowSettings { texels, bias, filter: Filter::Hard, map_size: 128, ..ShadowSettings::default() };
        let plan = FramePlan::new(&scene, &camera, &settings, 640, 360, None).expect("it can be planned");
        let frame = cpu().render(&cpu().prepare(&scene), &plan, Request::ALL).expect("it can be rendered").frame;
        let visibility = frame.floats(LayerName::Visibility { light: 0 }).expect("it was asked for").to_vec();
        let triangles = frame.triangles().expect("they were asked for").to_vec();
        // Where in the map the middle of the shadow lies on the ground, in texels: of everything that is dark on it.
        let view = plan.views[0];
        let (mut sum, mut count) = (DVec2::ZERO, 0.0);
        for (index, (&visibility, &triangle)) in visibility.iter().zip(&triangles).enumerate() {
            if triangle == u32::MAX || visibility > 0.5 {
                continue;
            }
            let (x, y) = (index as u32 % 640, index as u32 / 640);
            let point = scene.point(triangle, pixel_ray(&plan.camera.rays, x as f32 + 0.5, y as f32 + 0.5)).point;
            if (point.y + scene.origin().y as f32).abs() > 1e-4 {
                continue;
            }
            // Each pixel counts by how much of the ground it shows, so that near ones do not weigh more.
            let area = (point.as_dvec3() - camera.eye).length().powi(3);
            let ndc = view.clip_from_world().as_dmat4().project_point3(point.as_dvec3());
            let texel = |ndc: f64, axis: usize| ndc * f64::from(view.texel_scale[axis]) + f64::from(view.texel_offset[axis]);
            sum += DVec2::new(texel(ndc.x, 0), texel(ndc.y, 1)) * area;
            count += area;
        }
        sum / count
    };
    let moved = shadowed(Texels::Direct3d) - shadowed(Texels::OpenGl);
    // What is read half a texel farther is seen half a texel nearer. The box itself hides a part of the shadow's outline, which then moves less.
    assert!((-0.6..-0.2).contains(&moved.x) && (-0.6..-0.2).contains(&moved.y), "{moved}");
}

/// On both renderers a second surface keeps closed casters free of acne without any bias, where first surfaces have it.
#[test]
fn second_surfaces_need_no_bias_on_closed_casters() {
    let scene = builtin::by_name("box-on-plane").expect("it is built in");
    let lit = |store: Store, filter: Filter| {
        let settings = ShadowSettings { store, filter, bias: Bias::NONE, map_size: MAP, ..ShadowSettings::default() };
        let plan = FramePlan::new(&scene, &scene.cameras()[0].camera, &settings, 320, 180, None).expect("it can be planned");
        let on_cpu = cpu().render(&cpu().prepare(&scene), &plan, Request::ALL).expect("it can be rendered").frame;
        let uploaded = pollster::block_on(renderers::gpu().upload(&scene)).expect("it fits");
        let on_gpu = pollster::block_on(renderers::gpu().render(&uploaded, &plan, Request::ALL)).expect("it fits").frame;
        [on_cpu, on_gpu].map(|frame| {
            let visibility = frame.floats(LayerName::Visibility { light: 0 }).expect("it was asked for").to_vec();
            visibility.iter().filter(|&&visibility| visibility < 1.0).count()
        })
    };
    for filter in [Filter::Hard, Filter::Bilinear] {
        let [first, second, midpoint] = [Store::Depth32, Store::Second, Store::Midpoint].map(|store| lit(store, filter));
        for renderer in 0..2 {
            assert!(first[renderer] > 2 * second[renderer], "{filter:?}: {} and {}", first[renderer], second[renderer]);
            assert!(first[renderer] > 2 * midpoint[renderer], "{filter:?}: {} and {}", first[renderer], midpoint[renderer]);
        }
    }
}
