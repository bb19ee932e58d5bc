//! What pancaking must not change: the outcome of any depth test.

use proptest::prelude::*;
use shadow_math::{
    Bias, Camera, Cascades, Filter, Fit, FitFrom, LightKind, PlanError, Projection, Receiver, ShadowSettings, Split, Store,
    bias::{needed_depth, normal_offset},
    bounds::Aabb,
    caster::{caster_offset, pushed_depth},
    depth::{DEPTH_LINEAR, DEPTH_Z_OVER_W, comparable_depth, depth_limits, encoded_depth, linear_bias},
    fit::{FitOutcome, MIN_PANCAKE_SHARE, Subject},
    glam::{DVec3, Vec2, Vec3},
    plan::{LightPlan, MAX_VIEWS_PER_LIGHT, ViewPlan, plan_light, toward_light},
    settings::{BiasParts, Ogre2006, PolygonOffset},
    visibility::{MapAccess, NO_VIEW, choose_views, lookup_in_view, visibility},
};

use super::{
    cover::{FITS, axis_and_reach, is_seen, place, row, within},
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
    if view.depth_kind == DEPTH_Z_OVER_W { offset } else { 1.0 - offset - scale }
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
    assert!(tried.views > 1500 && tried.lookups > 5000 && tried.tight > 300, "{tried:?}");
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
                let is_forward = view.depth_kind == DEPTH_Z_OVER_W;
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

/// A map all of whose texels hold one thing: a caster that was drawn at this depth, as it is drawn, or none.
struct Flat<'a> {
    views: &'a [ViewPlan],
    /// By view; the far plane's depth where there is nothing.
    drawn: Vec<f32>,
}

impl<'a> Flat<'a> {
    fn empty(views: &'a [ViewPlan]) -> Self {
        let far = |view: &ViewPlan| if view.depth_kind == DEPTH_Z_OVER_W { 1.0 } else { 0.0 };
        Self { views, drawn: views.iter().map(far).collect() }
    }

    /// A caster at a point, in every view that has it.
    fn at(views: &'a [ViewPlan], point: DVec3) -> Self {
        let mut flat = Self::empty(views);
        for (view, drawn) in views.iter().zip(&mut flat.drawn) {
            let here = place(view, point);
            if here.w > 0.0 && (0.0..=1.0).contains(&here.drawn) {
                *drawn = (if view.depth_kind == DEPTH_Z_OVER_W { here.drawn } else { 1.0 - here.drawn }) as f32;
            }
        }
        flat
    }
}

impl MapAccess for Flat<'_> {
    fn fetch_texel(&self, layer: u32, _: u32, _: u32) -> f32 {
        let of_layer = self.views.iter().zip(&self.drawn).find(|(view, _)| view.has_map() && view.layer == layer);
        of_layer.map_or(f32::NAN, |(view, &drawn)| encoded_depth(view, drawn))
    }
}

/// Empty maps shadow nothing, and hold to the bit what they are cleared to.
#[test]
fn nothing_is_shadowed_by_nothing() {
    let (mut views_tried, mut receivers, mut beyond) = (0, 0, 0);
    for seed in 0..6000 {
        let case = pancaked_case(seed, [1.0, 1000.0]);
        let Ok((light, views)) = case.plan() else { continue };
        let maps = Flat::empty(&views);
        for (view, &far) in views.iter().zip(&maps.drawn).filter(|(view, _)| view.is_pancaked()) {
            views_tried += 1;
            assert_eq!(encoded_depth(view, far), far, "{view:?}");
        }
        for &point in &case.samples {
            let toward = toward_light(&light, point);
            let receiver = Receiver::new(point, toward);
            let choice = choose_views(&light, &views, &receiver);
            if choice.first == NO_VIEW {
                continue;
            }
            receivers += 1;
            beyond += usize::from(place(&views[choice.first as usize], point.as_dvec3()).drawn > 1.0);
            assert_eq!(visibility(&light, &views, &maps, &receiver), 1.0, "{point}: {:?}", case.settings);
        }
    }
    assert!(
        views_tried > 2500 && receivers > 50_000 && beyond > 500,
        "{views_tried} views, {receivers} receivers, {beyond} beyond"
    );
}

/// Whether a lookup is decided by what single precision, or a bias that reckons with it, leaves open.
fn is_tie(case: &Case, light: &LightPlan, views: &[ViewPlan], maps: &Flat<'_>, receiver: &Receiver) -> bool {
    let choice = choose_views(light, views, receiver);
    let asked = [Some(choice.first), (choice.share > 0.0).then_some(choice.second)];
    asked.into_iter().flatten().filter(|&index| index != NO_VIEW).any(|index| {
        let view = &views[index as usize];
        let found = lookup_in_view(light, view, index, receiver);
        if found.view == NO_VIEW {
            return false;
        }
        let stored = f64::from(comparable_depth(view, maps.fetch_texel(view.layer, 0, 0)));
        let off = f64::from(found.depth) - f64::from(found.bias) - stored;
        let here = place(view, receiver.point.as_dvec3());
        let of_linear = if view.depth_kind == DEPTH_LINEAR { view.rounding_metres * view.linear_scale } else { 0.0 };
        // Taps that follow the receiver's plane are compared with as many depths.
        let of_plane = match case.settings.bias {
            Bias::Parts(BiasParts { receiver_plane: Some(_), .. }) => f64::from(found.slope.abs().element_sum()) * 20.0,
            _ => 0.0,
        };
        // The bound on z / w, in the depth that the map holds.
        let slack = f64::from(linear_bias(view, here.w as f32, here.slack[1] as f32));
        off.abs() <= 2.0 * (slack + f64::from(of_linear)) + 1e-4 * f64::from(found.bias) + of_plane
    })
}

/// Whether a shadow is there does not depend on pancaking, wherever between receiver and light the caster is.
fn check_outcome(seed: u64, outcomes: &mut [usize; 2]) {
    let mut case = case(seed, &Fit::ALL, [0.1, 1e4], 20);
    let random = &mut Random(seed ^ 4);
    let size = case.bounds.radius();
    let plane = BiasParts { normal_offset: Some(3.0), receiver_plane: Some(0.05 * size), ..BiasParts::NONE };
    case.settings.bias = match random.below(6) {
        0 => Bias::NONE,
        1 => Bias::constant(0.01 * size),
        2 => Bias::Parts(BiasParts { normal_offset: Some(2.0), slope: Some(1.5), ..BiasParts::NONE }),
        3 => Bias::Parts(plane),
        _ => Bias::Automatic,
    };
    let stores = [Store::Depth32, Store::Reversed32, Store::Linear];
    case.settings.store = random.of(&stores);
    let points = case.samples.clone();
    case.samples = points.into_iter().filter(|point| is_seen(&case, point.as_dvec3())).collect();
    case.settings.pancake = false;
    let Ok((light, views)) = case.plan() else { return };
    case.settings.pancake = true;
    let (other_light, other_views) = case.plan().expect("pancaking refuses nothing else");
    for &point in &case.samples {
        if !axis_and_reach(&case, point.as_dvec3()).1 || !case.bounds.contains(point) {
            continue;
        }
        let p = point.as_dvec3();
        let parallel = case.light.position().is_none();
        let way = case.light.position().map_or_else(|| toward_light(&light, point).as_dvec3(), |place| place.as_dvec3() - p);
        let toward = way.normalize();
        let across = random.direction().cross(toward).normalize_or(toward.any_orthonormal_vector());
        let normal = (toward + across * STEEPEST * random.between(0.0, 0.999)).normalize().as_vec3();
        let receiver = Receiver::new(point, normal);
        for caster in &case.casters {
            let Some([begin, end]) = within(*caster, p, way, if parallel { f64::INFINITY } else { 1.0 }) else { continue };
            let at = p + way * (begin + (end - begin) * random.between(0.0, 1.0));
            // What lies on the receiver is no caster of it, but acne.
            if at.distance(p) <= 1e-6 * p.length() {
                continue;
            }
            let (maps, other_maps) = (Flat::at(&views, at), Flat::at(&other_views, at));
            let visible = visibility(&light, &views, &maps, &receiver);
            let other = visibility(&other_light, &other_views, &other_maps, &receiver);
            outcomes[usize::from(visible > 0.5)] += 1;
            let is_open = is_tie(&case, &light, &views, &maps, &receiver)
                || is_tie(&case, &other_light, &other_views, &other_maps, &receiver);
            assert!(
                is_open || (visible - other).abs() < 1.0 / 255.0,
                "{point} before {at} is {visible}, and {other} pancaked: {:?}",
                case.settings
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn no_depth_test_has_another_outcome(seed in any::<u64>()) {
        check_outcome(seed, &mut [0; 2]);
    }
}

/// Scenes in which a shadow was once lost: by steps along the normal that lead behind the far plane, or into the map from beside it, and by receivers that lie behind all casters.
#[test]
fn rare_scenes_keep_their_shadows() {
    for seed in [9366, 36_410, 71_345, 149_027, 12_281_249_299_421_689_794] {
        check_outcome(seed, &mut [0; 2]);
    }
    for seed in [13_443, 14_336, 41_001, 109_518] {
        check_room(seed, [1e-3, 1e6], &mut Tried::default());
    }
}

#[test]
fn both_outcomes_are_tried() {
    let mut outcomes = [0; 2];
    for seed in 0..4000 {
        check_outcome(seed, &mut outcomes);
    }
    assert!(outcomes.into_iter().all(|count| count > 1000), "{outcomes:?} are dark and lit");
}

/// Casters are drawn deeper by as much as in a view that is not pancaked: by steps and slopes of the view's own depth, and by the same metres.
#[test]
fn casters_are_pushed_in_the_views_own_depth() {
    let (mut by_steps, mut by_metres) = (0, 0);
    for seed in 0..3000 {
        let mut case = pancaked_case(seed, [1.0, 100.0]);
        if case.settings.fit.is_warped() || matches!(case.settings.split, Split::Cascades(_)) {
            continue;
        }
        let metres = 0.02 * case.bounds.radius();
        let polygon_offset = Some(PolygonOffset { slope: 0.0, units: 20.0, clamp: 0.0 });
        let ogre_2006 = Some(Ogre2006 { metres, is_corrected: false });
        case.settings.store = if seed % 2 == 0 { Store::Depth16 } else { Store::Depth32 };
        case.settings.bias = Bias::Parts(if seed % 2 == 0 {
            BiasParts { polygon_offset, ..BiasParts::NONE }
        } else {
            BiasParts { ogre_2006, ..BiasParts::NONE }
        });
        let Ok((_, views)) = case.plan() else { continue };
        for view in views.iter().filter(|view| view.is_pancaked() && view.has_map()) {
            for point in &case.samples {
                let here = place(view, point.as_dvec3());
                if here.w <= 0.0 || here.depth <= 0.0 || here.drawn >= 1.0 {
                    continue;
                }
                // What slopes add is left out, and steps of the format that the result is rounded to.
                let level = ViewPlan { caster_slope: 0.0, ..*view };
                let offset = caster_offset(&level, *point, *point + Vec3::X, *point + Vec3::Y);
                let unrounded = ViewPlan { depth_steps: 0.0, ..*view };
                let pushed = f64::from(encoded_depth(&unrounded, pushed_depth(view, here.drawn as f32, offset)));
                if pushed >= 1.0 {
                    continue;
                }
                let bound = here.slack[1] + 1e-5;
                if seed % 2 == 0 {
                    by_steps += 1;
                    let steps = (pushed - here.depth) * f64::from(view.depth_steps);
                    assert!((steps - 20.0).abs() <= bound * f64::from(view.depth_steps), "{steps} steps in {view:?}");
                } else {
                    by_metres += 1;
                    // To the first order: `factor metres / w^2` in a perspective view.
                    let expected = f64::from(view.depth_factor) * f64::from(metres) / (here.w * here.w);
                    let off = (pushed - here.depth - expected).abs();
                    assert!(off <= bound + 1e-4 * expected, "{} instead of {expected}: {:?}", pushed - here.depth, case.settings);
                }
            }
        }
    }
    assert!(by_steps > 300 && by_metres > 300, "{by_steps} by steps, {by_metres} by metres");
}

/// A steep plane whose need is more than a pancaked view's own range has its lookup moved, as without pancaking: it is not lit for that.
#[test]
fn lookups_on_steep_planes_are_moved() {
    let mut beyond_range = 0;
    for seed in 0..4000 {
        let mut case = pancaked_case(seed, [1.0, 1000.0]);
        (case.settings.bias, case.settings.store) = (Bias::Automatic, Store::Depth32);
        let Ok((light, views)) = case.plan() else { continue };
        case.settings.pancake = false;
        let (plain_light, plain_views) = case.plan().expect("it could be planned pancaked");
        let random = &mut Random(seed ^ 5);
        for &point in case.samples.iter().filter(|point| axis_and_reach(&case, point.as_dvec3()).1) {
            let toward = toward_light(&light, point).as_dvec3().normalize();
            let across = random.direction().cross(toward).normalize_or(toward.any_orthonormal_vector());
            let normal = (toward + across * STEEPEST * random.between(2.0, 20.0)).normalize().as_vec3();
            let choice = choose_views(&light, &views, &Receiver::new(point, normal));
            if choice.first == NO_VIEW || !views[choice.first as usize].is_pancaked() {
                continue;
            }
            let need_and_step = |light: &LightPlan, view: &ViewPlan| {
                let w = place(view, point.as_dvec3()).w as f32;
                let needed = needed_depth(light, view, point, normal, w, [Vec2::ZERO; 2]);
                (needed, normal_offset(light, view, point, normal, needed, w))
            };
            let (needed, step) = need_and_step(&light, &views[choice.first as usize]);
            let (plain_needed, plain_step) = need_and_step(&plain_light, &plain_views[choice.first as usize]);
            // Where it needs nearly all that there is without pancaking, rounding may decide.
            if plain_step > 0.0 && plain_needed < 0.9 {
                assert!(step > 0.0, "{point} needs {needed}, {plain_needed} without pancaking, and stays");
                beyond_range += usize::from(needed >= 1.0);
            }
        }
    }
    assert!(beyond_range > 100, "{beyond_range} need more than the view's own range");
}

/// The planes by which casters are drawn are those of the view that is not pancaked.
#[test]
fn casters_are_drawn_between_the_planes_that_enclose_them() {
    let mut compared = 0;
    for seed in 0..2000 {
        let mut case = pancaked_case(seed, [1.0, 100.0]);
        let Ok((_, pancaked)) = case.plan() else { continue };
        case.settings.pancake = false;
        let (_, plain) = case.plan().expect("it could be planned pancaked");
        for (view, plain) in pancaked.iter().zip(&plain).filter(|(view, _)| view.is_pancaked() && view.is_warped == 0) {
            compared += 1;
            let ([near, far], expected) = (view.drawn_range(), plain.depth_range.map(f64::from));
            // Parallel light's distances are counted from its own near plane.
            let begin = if view.w_per_metre == 0.0 { near } else { 0.0 };
            // The depths of the planes are f32, and a step of depth is `far / near` times as long at the far plane as the range is on average.
            let stretch = if view.w_per_metre == 0.0 { 1.0 } else { expected[1] / expected[0] };
            let bound = 8.0 * f64::from(f32::EPSILON) * stretch.max(f64::from(view.drawn_scale)) * expected[1];
            let off = [near - begin - expected[0], far - begin - expected[1]];
            assert!(off.into_iter().all(|off| off.abs() < bound), "{near} to {far} m instead of {expected:?}");
        }
    }
    assert!(compared > 500, "{compared} views");
}

/// Nobody looks: what is seen is not known.
#[test]
fn pancaking_asks_for_a_camera() {
    let case = pancaked_case(1, [1.0, 10.0]);
    let subject = Subject::unseen(&case.casters, case.bounds);
    let settings = ShadowSettings { pancake: true, ..ShadowSettings::default() };
    let mut views = vec![ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
    assert_eq!(plan_light(&case.light, &subject, &settings, [0, 0], &mut views), Err(PlanError::NoCamera));
}

/// A stabilised range has one length to the bit, and begins at a whole one of its steps, wherever the camera is and looks.
#[test]
fn stabilised_ranges_move_by_whole_steps_of_their_own() {
    let tower = Aabb::new(Vec3::new(-2.0, 0.0, -40.0), Vec3::new(2.0, 900.0, -36.0));
    let street = Aabb::new(Vec3::new(-200.0, 0.0, -200.0), Vec3::new(200.0, 0.1, 200.0));
    let mut case = case(1, &[Fit::Uniform], [10.0, 10.0], 0);
    let direction = Vec3::new(0.45, -1.0, 0.3);
    case.light.kind = LightKind::Directional { direction };
    (case.casters, case.bounds, case.aspect) = (vec![tower, street], tower.union(street), 1.5);
    let split = Split::Cascades(Cascades { stabilised: true, ..Cascades::default() });
    for bias in [Bias::Automatic, Bias::slope(1.0, 0.01), Bias::NONE] {
        for store in [Store::Depth16, Store::Depth24] {
            case.settings = ShadowSettings { split, pancake: true, bias, store, map_size: 1024, ..ShadowSettings::default() };
            let mut lengths = Vec::new();
            for pose in 0..40 {
                let random = &mut Random(pose);
                let moved = random.point() * 60.0;
                let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far: Some(100.0) };
                let (eye, target) = (DVec3::new(0.0, 4.0, 20.0) + moved, moved + random.point() * 10.0);
                case.camera = Camera::look_at(eye, target, projection).expect("they differ");
                let (_, views) = case.plan().expect("it can be planned");
                let pancaked: Vec<_> = views.iter().filter(|view| view.is_pancaked()).collect();
                lengths.push(
                    pancaked.iter().map(|view| [view.depth_range[1], view.drawn_scale].map(f32::to_bits)).collect::<Vec<_>>(),
                );
                for view in pancaked {
                    // Depth is 0 on the near plane: its height over the world's origin, along the light, in steps of the map.
                    let z = row(view.clip_z);
                    let steps = z.w * f64::from(view.depth_steps);
                    // The row is rounded to f32, which has whole steps of 16 bits to spare here.
                    let rounding = 1e-7 * steps.abs() + 1e-3;
                    assert!(store == Store::Depth24 || rounding < 0.2);
                    assert!((steps - steps.round()).abs() < rounding, "{steps} steps at {moved}, {bias:?}");
                }
            }
            assert!(lengths[0].len() >= 2, "{lengths:?}");
            assert!(lengths.iter().all(|of_pose| *of_pose == lengths[0]), "{bias:?}: {lengths:?}");
        }
    }
}

/// A tower of a kilometre beside a street of ten metres: 16 bits of the whole way are steps of 1.5 cm, and of the street less than a millimetre.
#[test]
fn depth_is_for_what_is_seen() {
    let mut case = case(1, &[Fit::Focused], [10.0, 10.0], 0);
    let direction = Vec3::new(0.0, -1.0, 0.2);
    case.light.kind = LightKind::Directional { direction };
    let tower = Aabb::new(Vec3::new(-2.0, 0.0, -40.0), Vec3::new(2.0, 1000.0, -36.0));
    let street = Aabb::new(Vec3::new(-10.0, 0.0, -50.0), Vec3::new(10.0, 0.1, 50.0));
    case.casters = vec![tower, street];
    case.bounds = tower.union(street);
    let projection = Projection::Perspective { vertical_fov: 0.6, near: 0.1, far: None };
    case.camera = Camera::look_at(DVec3::new(0.0, 4.0, 20.0), DVec3::new(0.0, 0.0, 10.0), projection).expect("they differ");
    case.aspect = 1.5;
    case.settings = ShadowSettings {
        fit: Fit::Focused,
        store: Store::Depth16,
        map_size: 1024,
        filter: Filter::Bilinear,
        ..ShadowSettings::default()
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
