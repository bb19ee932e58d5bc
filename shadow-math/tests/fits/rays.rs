//! What holds of the matrix of every view: which way it is round, that rays of light are upright in it, and that lengths become depth as the plan says.

use shadow_math::{
    Bias, Fit, Light, LightKind, ShadowSettings,
    bias::{depth_bias, needed_depth, normal_offset, texel_width},
    bounds::Aabb,
    caster::texel_ray,
    fit::{
        Content, Eye, LightFrame, Subject, ViewFit, boxed_view, cube_face_view, directional_view, focused_view, lispsm_view,
        optimal_warp, plane_depth_factor, plane_optimal, range_around_point, spot_view, visible_body,
    },
    glam::{DMat2, DVec2, DVec3, DVec4, Vec2, Vec3},
    plan::{LightPlan, ViewPlan, toward_light},
    spaces::texel_from_ndc,
};

use super::scenes::{Case, Random, case};

const SIZE: u32 = 512;

/// A camera over a floor with a block on it, and the views that each fit makes of what it sees.
struct Setup {
    views: Vec<(&'static str, ViewFit)>,
    /// The vertices of what is seen.
    points: Vec<DVec3>,
}

fn setup(random: &mut Random, is_parallel: bool) -> Option<Setup> {
    let casters = [
        Aabb::new(Vec3::new(-10.0, -0.1, -10.0), Vec3::new(10.0, 0.0, 10.0)),
        Aabb::new(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0)),
    ];
    let bounds = casters[0].union(casters[1]);
    let projection = shadow_math::Projection::Perspective { vertical_fov: 1.0, near: 0.2, far: Some(30.0) };
    let place = DVec3::new(random.between(-5.0, 5.0), random.between(1.0, 4.0), random.between(4.0, 8.0));
    let camera = shadow_math::Camera::look_at(place, random.point(), projection).expect("it looks away from itself");
    let eye = Eye { camera, aspect: 1.4, samples: &[], plane: Some(DVec4::Y) };
    let subject = Subject { eye: Some(eye), ..Subject::unseen(&casters, bounds) };
    let direction = (random.direction() * DVec3::new(1.0, 0.3, 1.0) - DVec3::Y).as_vec3();
    let position = Vec3::new(random.between(-3.0, 3.0) as f32, random.between(4.0, 8.0) as f32, 1.0);
    let (frame, uniform) = if is_parallel {
        (LightFrame::parallel(direction), directional_view(direction, bounds, SIZE, 2))
    } else {
        let frame = LightFrame::perspective(position, direction.as_dvec3(), 1.1_f64.tan(), f64::INFINITY);
        (frame, spot_view(position, direction, 1.1, f64::INFINITY, &casters, SIZE, 2))
    };
    let body = visible_body(&eye, [0.2, 30.0], &subject, &frame);
    let content = Content::new(body.vertices(), &casters);
    let warp = optimal_warp(&frame, &eye, body.vertices()).ok()?;
    let plane = plane_optimal(&eye, DVec4::Y, frame.light()).ok()?;
    let mut views = vec![
        ("uniform", uniform),
        ("boxed", boxed_view(&frame, &content, SIZE, 2)),
        ("focused", focused_view(&frame, &content, SIZE, 2)),
        ("lispsm", lispsm_view(&frame, place, warp, &content, SIZE, 2)),
        ("plane-optimal", plane.view(&eye, plane_depth_factor(&plane, &casters), SIZE)),
    ];
    if !is_parallel {
        let range = range_around_point(position.as_dvec3(), &casters, f64::INFINITY);
        views.push(("cube", cube_face_view(position, 3, range, SIZE, 2)));
    }
    Some(Setup { views, points: body.vertices().to_vec() })
}

/// A point of the body's hull.
fn point_of(random: &mut Random, points: &[DVec3]) -> DVec3 {
    let weights: Vec<_> = points.iter().map(|_| random.between(0.0, 1.0)).collect();
    points.iter().zip(&weights).map(|(point, weight)| *point * *weight).sum::<DVec3>() / weights.iter().sum::<f64>()
}

/// Calls `check` with a view's name, the view, points that it sees, and points before them on their rays of light.
fn for_points(mut check: impl FnMut(&str, &ViewFit, DVec3, DVec3, f64)) {
    let random = &mut Random(7);
    let mut tried = 0;
    for turn in 0..300 {
        let Some(Setup { views, points }) = setup(random, turn % 2 == 0) else { continue };
        if points.is_empty() {
            continue;
        }
        for (name, view) in &views {
            for _ in 0..5 {
                let point = point_of(random, &points);
                let light = view.light();
                let way = light.truncate() - point * light.w;
                let share = random.between(0.01, 0.3);
                let before = point + way * if light.w == 0.0 { 5.0 * share } else { share };
                let clip = view.clip_from_world() * point.extend(1.0);
                let is_above = view.half_space.dot(point.extend(1.0)) > 0.0 && view.half_space.dot(before.extend(1.0)) > 0.0;
                if clip.w > 0.0 && is_above {
                    tried += 1;
                    check(name, view, point, before, share);
                }
            }
        }
    }
    assert!(tried > 4000, "{tried} points were tried");
}

#[test]
fn rays_of_light_are_upright_and_depth_grows_along_them() {
    for_points(|name, view, point, before, _| {
        let [here, there] = [point, before].map(|point| view.clip_from_world().project_point3(point));
        // Rounding of f64 with coordinates up to some hundred in NDC, for points near a horizon.
        assert!((here - there).truncate().length() < 1e-9 * (1.0 + here.truncate().length()), "{name}: {here} and {there}");
        assert!(there.z < here.z, "{name}: {there} is nearer to the light than {here}");
    });
}

/// Seen from the light, x grows to the right and y upward: the vectors in which they grow and the one toward the light are right-handed. But for a camera from below the plane, for which
/// the light sees the plane from the other side: that is what plane-optimal keeps of it.
#[test]
fn no_view_is_a_mirror_image() {
    for_points(|name, view, point, before, _| {
        let matrix = view.clip_from_world();
        let clip = matrix * point.extend(1.0);
        let gradient = |row: usize| {
            let ndc = clip[row] / clip.w;
            (matrix.row(row) - matrix.row(3) * ndc).truncate() / clip.w
        };
        let toward = (before - point).normalize();
        assert!(gradient(0).cross(gradient(1)).dot(toward) > 0.0, "{name} at {point}");
    });
}

#[test]
fn metres_along_the_axis_become_the_depth_that_the_scale_says() {
    for_points(|name, view, point, before, share| {
        let depth = |point: DVec3| view.clip_from_world().project_point3(point).z;
        let expected = depth(point) - depth(before);
        let w = (view.clip_from_world() * point.extend(1.0)).w;
        let distance = view.distance_row().dot(point.extend(1.0));
        let scale = view.depth_scale;
        // Toward a light at a place, a share of the way is that share of the distance along the axis.
        let metres = if scale.w_per_metre > 0.0 { share * distance } else { 5.0 * share };
        let given = scale.factor * metres / (w * (distance - scale.w_per_metre * metres));
        // Depths are differences of numbers up to 1 in the range, and much beyond it near a horizon.
        let rounding = 1e-12 * (1.0 + depth(point).abs() + depth(before).abs());
        assert!((given - expected).abs() < 1e-9 * expected.abs() + rounding, "{name}: {given} is not {expected}");
    });
}

/// Receivers of random plans that their views see well: light, view, point, w and distance along the axis.
fn for_receivers(settings: impl Fn(&mut ShadowSettings), mut check: impl FnMut(&Case, &LightPlan, &ViewPlan, Vec3, f32, f32)) {
    let fits = [Fit::Uniform, Fit::Focused, Fit::Lispsm, Fit::PlaneOptimal];
    let (mut tried, mut warped) = (0, 0);
    for seed in 0..3000 {
        let mut case = case(seed, &fits, [1.0, 100.0], 10);
        settings(&mut case.settings);
        let Ok((light, views)) = case.plan() else { continue };
        for view in views.iter().filter(|view| view.has_map()) {
            for &point in &case.samples {
                let at = |row: [f32; 4]| DVec4::from_array(row.map(f64::from)).dot(point.as_dvec3().extend(1.0));
                let (w, distance) = (at(view.clip_w), at(view.distance));
                let ndc = [view.clip_x, view.clip_y].map(|row| at(row) / w);
                let depth = at(view.clip_z) / w;
                let is_inside = ndc.iter().all(|ndc| ndc.abs() < 1.0) && (0.0..=1.0).contains(&depth);
                // Where single precision has digits left.
                let slack = f64::from(view.rounding_depth[0]) + f64::from(view.rounding_depth[1]) / w;
                if w > 0.0 && at(view.half_space) > 0.0 && is_inside && slack < 1e-4 {
                    tried += 1;
                    warped += view.is_warped;
                    check(&case, &light, view, point, w as f32, distance as f32);
                }
            }
        }
    }
    assert!(tried > 2000 && warped > 300, "{tried} receivers were tried, {warped} of them warped");
}

#[test]
fn a_constant_bias_is_a_length_in_every_fit_and_back() {
    const METRES: f32 = 0.05;
    for_receivers(
        |settings| settings.bias = Bias::constant(METRES),
        |_, light, view, point, w, distance| {
            let bias = depth_bias(light, view, 0.0, w, distance);
            if bias < 1.0 {
                let metres = view.metres_of_depth(point.as_dvec3(), f64::from(bias));
                // The bias is rounded some times, and its sum with the factor loses what it is smaller by.
                assert!((metres - f64::from(METRES)).abs() < 1e-4 * f64::from(METRES), "{metres} m of {METRES} m at {point}");
            }
        },
    );
}

/// A texel's width by differences: the points on the rays through texels half a texel to either side, in the plane across the ray.
#[test]
fn texels_are_as_wide_as_rays_through_their_sides_are_apart() {
    for_receivers(
        |settings| settings.map_size = 256,
        |case, light, view, point, w, _| {
            let texel_from_clip = |point: DVec3| {
                let at = |row: [f32; 4]| DVec4::from_array(row.map(f64::from)).dot(point.extend(1.0));
                let (scale, offset) = texel_from_ndc(DVec2::ZERO, DVec2::splat(f64::from(view.rect[2])));
                DVec2::new(at(view.clip_x), at(view.clip_y)) / at(view.clip_w) * scale + offset
            };
            let p = point.as_dvec3();
            // Across the ray; of a view that is not warped, across the axis.
            let is_across_axis = view.is_warped == 0 && view.w_per_metre > 0.0;
            let distance = DVec4::from_array(view.distance.map(f64::from)).truncate();
            let axis = if is_across_axis { distance } else { toward_light(light, point).as_dvec3() };
            let (u, v) = axis.normalize().any_orthonormal_pair();
            let step = 1e-4 * p.distance(case.camera.eye).min(case.light.position().map_or(1e9, |at| p.distance(at.as_dvec3())));
            if step == 0.0 {
                return;
            }
            let along = |axis: DVec3| (texel_from_clip(p + axis * step) - texel_from_clip(p - axis * step)) / (2.0 * step);
            let metres = DMat2::from_cols(along(u), along(v)).inverse();
            let expected = metres.x_axis.length().max(metres.y_axis.length());
            let given = f64::from(texel_width(light, view, point, w));
            let slack = f64::from(view.rounding_texels[0]) + f64::from(view.rounding_texels[1]) / f64::from(w);
            if slack > 0.01 {
                return;
            }
            assert!((view.texel_width_at(p) - given).abs() < 1e-2 * given, "{} {given}", view.texel_width_at(p));
            // A difference over a step, and rows of single precision.
            assert!((given - expected).abs() < 1e-2 * expected, "{given} m is not {expected} m at {point}");
        },
    );
}

#[test]
fn a_texels_ray_passes_through_the_points_of_the_texel() {
    for_receivers(
        |settings| settings.map_size = 256,
        |case, _, view, point, w, _| {
            let at = |row: [f32; 4]| DVec4::from_array(row.map(f64::from)).dot(point.as_dvec3().extend(1.0));
            let slack = f64::from(view.rounding_texels[0]) + f64::from(view.rounding_texels[1]) / f64::from(w);
            let ndc = DVec2::new(at(view.clip_x), at(view.clip_y)) / f64::from(w);
            let (scale, offset) = texel_from_ndc(DVec2::ZERO, DVec2::splat(f64::from(view.rect[2])));
            let texel = (ndc * scale + offset).as_vec2();
            let ray = texel_ray(view, texel.x, texel.y);
            let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3().normalize());
            let from = point.as_dvec3() - origin;
            let beside = (from - direction * direction.dot(from)).length();
            // A texel's place is rounded in the rows and in the ray: by as many texels as the bound says, of the width that they have here.
            let width = view.texel_width_at(point.as_dvec3()) * 4.0;
            let coordinates = f64::from(f32::EPSILON) * 8.0 * (point.length() + case.bounds.abs_max().length()) as f64;
            assert!(
                beside < (slack + 1e-3) * width + coordinates,
                "{beside} m beside {point}, texels of {width} m, slack {slack}"
            );
            assert!(direction.dot(from) > 0.0 || view.w_per_metre == 0.0, "light goes toward {point}, which it lights");
        },
    );
}

/// What is needed under the filter, met by a step along the normal: the stepped point is nearer to the light, by that much depth, than the plane on its own ray.
#[test]
fn a_step_along_the_normal_clears_the_depth_that_is_needed() {
    let mut warped = 0;
    for_receivers(
        |settings| settings.bias = Bias::Automatic,
        |_, light, view, point, w, _| {
            let toward = toward_light(light, point).as_dvec3();
            // Steeper than where steps begin.
            let across = toward.any_orthonormal_vector();
            let normal = (across + toward.normalize() / 40.0).normalize().as_vec3();
            let needed = needed_depth(light, view, point, normal, w, [Vec2::ZERO; 2]);
            let offset = normal_offset(light, view, point, normal, needed, w);
            if offset == 0.0 || needed > 0.5 {
                return;
            }
            let at = |row: [f32; 4], point: DVec3| DVec4::from_array(row.map(f64::from)).dot(point.extend(1.0));
            let (p, n) = (point.as_dvec3(), normal.as_dvec3());
            let stepped = p + n * f64::from(offset);
            // Back along the ray to the plane.
            let way = if light.kind == shadow_math::plan::LIGHT_DIRECTIONAL {
                -toward
            } else {
                stepped - DVec3::from(light.position.map(f64::from))
            };
            let on_plane = stepped + way * (n.dot(p - stepped) / n.dot(way));
            let sign = if view.depth_kind == shadow_math::depth::DEPTH_REVERSED { -1.0 } else { 1.0 };
            let depth = |point: DVec3| sign * at(view.clip_z, point) / at(view.clip_w, point);
            let cleared = depth(on_plane) - depth(stepped);
            let rounding = f64::from(view.rounding_depth[0]) + f64::from(view.rounding_depth[1]) / f64::from(w);
            warped += view.is_warped;
            assert!(
                (cleared - f64::from(needed)).abs() < 1e-2 * f64::from(needed) + rounding,
                "{cleared} is cleared of {needed} at {point} with {offset} m"
            );
        },
    );
    assert!(warped > 20, "{warped} warped receivers are stepped");
}

/// The plan's kind of light is the one that the views are tried with.
#[test]
fn lights_of_both_kinds_are_tried() {
    let is_sun = |light: &Light| matches!(light.kind, LightKind::Directional { .. });
    let suns = (0..100).filter(|seed| is_sun(&case(*seed, &[Fit::Focused], [1.0, 10.0], 0).light)).count();
    assert!((10..90).contains(&suns), "{suns} suns of a hundred lights");
}
