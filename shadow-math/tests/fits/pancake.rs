//! What pancaking must not change: the outcome of any depth test.

use proptest::prelude::*;
use shadow_math::{
    Bias, Fit, FitFrom, LightKind, Receiver, Split, Store,
    depth::{DEPTH_LINEAR, comparable_depth, depth_limits, encoded_depth},
    fit::{FitOutcome, MIN_PANCAKE_SHARE},
    glam::{DVec3, Vec3},
    plan::{ViewPlan, toward_light},
    settings::BiasParts,
    visibility::{NO_VIEW, choose_views, lookup_in_view},
};

use super::{
    cover::{FITS, axis_and_reach, is_seen, place, within},
    scenes::{Case, Random, case},
};

/// A case that is pancaked, with one of the biases whose length is known.
fn pancaked_case(seed: u64, sizes: [f64; 2]) -> Case {
    let mut case = case(seed, &FITS, sizes, 60);
    case.settings.pancake = true;
    case.settings.fit_from = if seed.is_multiple_of(3) { FitFrom::Samples } else { FitFrom::Frustum };
    let size = case.bounds.radius();
    case.settings.bias = match seed % 5 {
        0 => Bias::NONE,
        1 => Bias::constant(0.01 * size),
        2 => Bias::Parts(BiasParts { normal_offset: Some(2.0), slope: Some(1.5), ..BiasParts::NONE }),
        _ => Bias::Automatic,
    };
    let points = case.samples.clone();
    case.samples = points.into_iter().filter(|point| is_seen(&case, point.as_dvec3())).collect();
    case
}

/// How steep a plane may be toward the light, as a tangent: as steep as the automatic bias leaves lookups where they are.
const STEEPEST: f64 = 24.0;

#[derive(Debug, Default)]
struct Tried {
    lookups: usize,
    tight: usize,
    views: usize,
}

/// What lies before the near plane hides a receiver at whatever depth it is drawn: no bias reaches there.
fn check_room(seed: u64, sizes: [f64; 2], tried: &mut Tried) {
    let case = pancaked_case(seed, sizes);
    let Ok((light, views)) = case.plan() else { return };
    tried.views += views.iter().filter(|view| view.is_pancaked()).count();
    let random = &mut Random(seed ^ 2);
    for &point in &case.samples {
        if !axis_and_reach(&case, point.as_dvec3()).1 || !case.bounds.contains(point) {
            continue;
        }
        // What nothing can shadow is lit, whatever its bias.
        let way = toward_light(&light, point).as_dvec3();
        let longest = if case.light.position().is_none() { f64::INFINITY } else { 1.0 };
        if !case.casters.iter().any(|caster| within(*caster, point.as_dvec3(), way, longest).is_some()) {
            continue;
        }
        let toward = way.normalize();
        let across = random.direction().cross(toward).normalize_or(toward.any_orthonormal_vector());
        let normal = (toward + across * STEEPEST * random.between(0.0, 0.999)).normalize().as_vec3();
        let receiver = Receiver::new(point, normal);
        let choice = choose_views(&light, &views, &receiver);
        let asked = [Some(choice.first), (choice.share > 0.0).then_some(choice.second)];
        for index in asked.into_iter().flatten().filter(|&index| index != NO_VIEW) {
            let view = &views[index as usize];
            let found = lookup_in_view(&light, view, index, &receiver);
            let here = place(view, point.as_dvec3());
            // Outside of the map, or so near to the light that there is no depth before it, and nothing is drawn.
            if !view.is_pancaked() || found.view == NO_VIEW || here.drawn <= here.slack[1] {
                continue;
            }
            tried.lookups += 1;
            let [nearest, farthest] = depth_limits(view).map(f64::from);
            let (depth, bias) = (f64::from(found.depth), f64::from(found.bias));
            // The whole range is a bias that lights everything, and not for what is drawn before the near plane.
            if bias >= farthest - nearest {
                continue;
            }
            // Where the view's own near plane is the one that casters are drawn by, nothing lies before it.
            let begins = place_of_drawn_near(view);
            if begins >= -1e-6 * f64::from(view.drawn_scale) {
                continue;
            }
            tried.tight += usize::from(depth - bias < nearest + 0.1 * (farthest - nearest));
            assert!(
                depth - bias > nearest,
                "{point} in view {index} is compared at {depth} less {bias} (from {nearest}), slack {:?}, range {:?}, casters from {begins}",
                here.slack,
                view.depth_range
            );
        }
    }
}

/// The depth, in a view's own counting from its near plane, at which casters begin to be drawn.
fn place_of_drawn_near(view: &ViewPlan) -> f64 {
    let (scale, offset) = (f64::from(view.drawn_scale), f64::from(view.drawn_offset));
    if view.depth_kind == shadow_math::depth::DEPTH_Z_OVER_W { offset } else { 1.0 - offset - scale }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn no_bias_reaches_back_to_the_near_plane(seed in any::<u64>()) {
        check_room(seed, [1e-3, 1e6], &mut Tried::default());
    }
}

#[test]
fn enough_is_tried() {
    let mut tried = Tried::default();
    for seed in 0..4000 {
        check_room(seed, [1e-3, 1e6], &mut tried);
    }
    assert!(tried.views > 2000 && tried.lookups > 5000 && tried.tight > 300, "{tried:?}");
}

/// What a map holds of a drawn depth is what the view's own matrix says, cut off at its planes; in the order of the distances.
#[test]
fn what_is_held_is_the_views_own_depth() {
    let mut pancaked = 0;
    for seed in 0..3000 {
        let mut case = pancaked_case(seed, [1.0, 100.0]);
        let is_warped = case.settings.fit.is_warped()
            || matches!(case.settings.split, Split::Cascades(cascades) if cascades.fits.iter().flatten().any(|fit| fit.is_warped()));
        let stores = [Store::Depth32, Store::Reversed32, Store::Depth24, Store::Linear];
        case.settings.store = stores[seed as usize % if is_warped { 3 } else { 4 }];
        let Ok((_, views)) = case.plan() else { continue };
        let random = &mut Random(seed ^ 3);
        for view in views.iter().filter(|view| view.is_pancaked() && view.has_map()) {
            for caster in &case.casters {
                let point = random.point_of(*caster).as_dvec3();
                let here = place(view, point);
                if here.w <= 0.0 || here.drawn < 0.0 || here.drawn > 1.0 {
                    continue;
                }
                pancaked += 1;
                let is_forward = view.depth_kind == shadow_math::depth::DEPTH_Z_OVER_W;
                let drawn = if is_forward { here.drawn } else { 1.0 - here.drawn };
                let held = f64::from(comparable_depth(view, encoded_depth(view, drawn as f32)));
                let [near, far] = view.depth_range.map(f64::from);
                let own = here.depth.clamp(0.0, 1.0);
                let expected = if view.depth_kind == DEPTH_LINEAR {
                    (near * far / (far - own * (far - near)) - near) / (far - near)
                } else if is_forward {
                    own
                } else {
                    own - 1.0
                };
                // The plan's own bound, which is for what maps and receivers are off by together.
                let bound =
                    if view.depth_kind == DEPTH_LINEAR { f64::from(view.rounding_metres) / (far - near) } else { here.slack[1] };
                let off = (held - expected).abs();
                assert!(off <= bound, "{held} is held of {expected} at {point} by {off:e} of {bound:e}: {:?}", case.settings);
            }
        }
    }
    assert!(pancaked > 1000, "{pancaked} depths are tried");
}

/// A tower of a kilometre beside a street of ten metres: 16 bits of the whole way are steps of 1.5 cm, and of the street less than a millimetre.
#[test]
fn depth_is_for_what_is_seen() {
    let mut case = case(1, &[Fit::Focused], [10.0, 10.0], 0);
    let direction = Vec3::new(0.0, -1.0, 0.2);
    case.light.kind = LightKind::Directional { direction };
    let tower = shadow_math::bounds::Aabb::new(Vec3::new(-2.0, 0.0, -40.0), Vec3::new(2.0, 1000.0, -36.0));
    let street = shadow_math::bounds::Aabb::new(Vec3::new(-10.0, 0.0, -50.0), Vec3::new(10.0, 0.1, 50.0));
    case.casters = vec![tower, street];
    case.bounds = tower.union(street);
    let projection = shadow_math::Projection::Perspective { vertical_fov: 0.6, near: 0.1, far: None };
    case.camera =
        shadow_math::Camera::look_at(DVec3::new(0.0, 4.0, 20.0), DVec3::new(0.0, 0.0, 10.0), projection).expect("they differ");
    case.aspect = 1.5;
    case.settings = shadow_math::ShadowSettings {
        fit: Fit::Focused,
        store: Store::Depth16,
        map_size: 1024,
        filter: shadow_math::Filter::Bilinear,
        ..shadow_math::ShadowSettings::default()
    };
    let length = |pancake: bool| {
        case.settings.pancake = pancake;
        let (_, views) = case.plan().expect("it can be planned");
        assert_eq!(views[0].outcome(), FitOutcome::Fitted);
        let [near, far] = views[0].depth_range;
        far - near
    };
    let mut length = length;
    let (whole, seen) = (length(false), length(true));
    assert!(whole > 900.0 && seen < 15.0, "{whole} m, {seen} m");
    assert!(f64::from(seen) > MIN_PANCAKE_SHARE * f64::from(whole));
}
