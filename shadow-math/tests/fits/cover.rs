//! Whatever is seen and can be shadowed is in the map that is asked for it, and so is whatever can shadow it.

use proptest::prelude::*;
use shadow_math::{
    Fit, LightKind, PlanError, Projection, Receiver, Selection, Split,
    bounds::Aabb,
    depth::DEPTH_Z_OVER_W,
    fit::{CUBE_FACES, MIN_NEAR_SHARE, cube_face_of},
    glam::{DVec3, DVec4, Vec3},
    plan::{LightPlan, SELECT_BY_CONTAINMENT, SPLIT_CASCADES, SPLIT_CUBE, ViewPlan, toward_light},
    visibility::{NO_VIEW, choose_views},
};

use super::scenes::{Case, Random, case};

/// The fits that follow what is seen, and the uniform one.
pub(crate) const FITS: [Fit; 4] = [Fit::Uniform, Fit::Focused, Fit::Lispsm, Fit::OgreLispsm];

pub(crate) fn row(numbers: [f32; 4]) -> DVec4 {
    DVec4::from_array(numbers.map(f64::from))
}

/// A point of a ray to the light inside a box: where it enters and leaves, as shares of the way to a light at a place, or in metres.
pub(crate) fn within(bounds: Aabb, from: DVec3, way: DVec3, longest: f64) -> Option<[f64; 2]> {
    let (mut begin, mut end) = (0.0_f64, longest);
    for axis in 0..3 {
        let (low, high) = (f64::from(bounds.min[axis]) - from[axis], f64::from(bounds.max[axis]) - from[axis]);
        if way[axis] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
        } else {
            let (a, b) = (low / way[axis], high / way[axis]);
            (begin, end) = (begin.max(a.min(b)), end.min(a.max(b)));
        }
    }
    (begin <= end).then_some([begin, end])
}

/// Whether the camera sees a point that nothing hides.
pub(crate) fn is_seen(case: &Case, point: DVec3) -> bool {
    let view = case.camera.view_from_world().transform_point3(point);
    let half = case.camera.half_extent(case.aspect);
    let (spread, near, far) = match case.camera.projection {
        Projection::Perspective { near, far, .. } => (-view.z, near, far.unwrap_or(f64::INFINITY)),
        Projection::Orthographic { near, far, .. } => (1.0, near, far),
    };
    let end = case.settings.shadow_distance.map_or(f64::INFINITY, f64::from);
    -view.z >= near && -view.z <= far.min(end) && view.x.abs() <= half.x * spread && view.y.abs() <= half.y * spread
}

/// The axis of the map that a point asks of a light at a place, and whether the light reaches it.
pub(crate) fn axis_and_reach(case: &Case, point: DVec3) -> (DVec3, bool) {
    let from_light = |position: Vec3| point - position.as_dvec3();
    match case.light.kind {
        LightKind::Directional { direction } => (direction.as_dvec3().normalize(), true),
        LightKind::Spot { position, direction, outer, range, .. } => {
            let (axis, way) = (direction.as_dvec3().normalize(), from_light(position));
            let is_near = way.length() <= range.map_or(f64::INFINITY, f64::from);
            // The angle by its tangent: a cosine has no digits where the cone is narrow.
            let along = axis.dot(way);
            let is_within = along > 0.0
                && (outer >= core::f32::consts::FRAC_PI_2 || (way - axis * along).length() <= f64::from(outer).tan() * along);
            (axis, is_near && is_within)
        }
        LightKind::Point { position, range } => {
            let way = from_light(position);
            (DVec3::ZERO, way.length() <= range.map_or(f64::INFINITY, f64::from) && way != DVec3::ZERO)
        }
    }
}

/// How a view sees a point.
pub(crate) struct Place {
    pub(crate) w: f64,
    texel: [f64; 2],
    /// z / w, 0 toward the light.
    pub(crate) depth: f64,
    /// The same as casters are drawn.
    pub(crate) drawn: f64,
    /// The bounds on the rounding of texels and of depth.
    pub(crate) slack: [f64; 2],
}

pub(crate) fn place(view: &ViewPlan, point: DVec3) -> Place {
    let [x, y, z, w] = [view.clip_x, view.clip_y, view.clip_z, view.clip_w].map(|r| row(r).dot(point.extend(1.0)));
    let texel = [0, 1].map(|i| [x, y][i] / w * f64::from(view.texel_scale[i]) + f64::from(view.texel_offset[i]));
    let bound = |[anywhere, over_w]: [f32; 2]| f64::from(anywhere) + f64::from(over_w) / w;
    let forward = |z: f64| if view.depth_kind == DEPTH_Z_OVER_W { z / w } else { 1.0 - z / w };
    let (depth, drawn) = (forward(z), forward(row(view.drawn_z).dot(point.extend(1.0))));
    Place { w, texel, depth, drawn, slack: [bound(view.rounding_texels), bound(view.rounding_depth)] }
}

/// Counts of what was tried.
#[derive(Debug, Default)]
struct Tried {
    receivers: usize,
    casters: usize,
    blended: usize,
    pancaked: usize,
}

fn check_receiver(case: &Case, light: &LightPlan, views: &[ViewPlan], point: Vec3, random: &mut Random, tried: &mut Tried) {
    let p = point.as_dvec3();
    let toward = toward_light(light, point);
    let is_parallel = case.light.position().is_none();
    let way = case.light.position().map_or_else(|| toward.as_dvec3(), |position| position.as_dvec3() - p);
    let (mut axis, is_reached) = axis_and_reach(case, p);
    if !is_reached || !is_seen(case, p) || !case.bounds.contains(point) {
        return;
    }
    if light.split == SPLIT_CUBE {
        axis = CUBE_FACES[cube_face_of(-toward) as usize];
    }
    // What a near plane by rule leaves out: see `MIN_NEAR_SHARE`. A little more than that, for the margins of ranges.
    let mut nearest = 0.0;
    if let Some(position) = case.light.position() {
        let corners =
            case.casters.iter().flat_map(|caster| caster.corners()).map(|corner| corner.as_dvec3() - position.as_dvec3());
        // The faces of a cube can have one range for all.
        let is_cube = light.split == SPLIT_CUBE;
        let distances = corners.map(|corner| if is_cube { corner.abs().max_element() } else { axis.dot(corner) });
        let farthest = distances.fold(0.0, f64::max).min(f64::from(case.light.range()));
        nearest = MIN_NEAR_SHARE * farthest * 1.01;
        // What touches the light but for the rounding of its position has no depth at all.
        nearest = nearest.max(f64::from(f32::EPSILON * position.length()));
    }
    let longest = if is_parallel { f64::INFINITY } else { 1.0 };
    let mut shadowing = Vec::new();
    for caster in &case.casters {
        let Some([begin, end]) = within(*caster, p, way, longest) else { continue };
        for share in [0.0, 1.0, random.between(0.0, 1.0)] {
            let at = p + way * (begin + (end - begin) * share);
            if is_parallel || axis.dot(at - (p + way)) >= nearest {
                shadowing.push(at);
            }
        }
    }
    if shadowing.is_empty() {
        return;
    }
    let receiver = Receiver::new(point, toward);
    // Which map has a receiver is decided in single precision, and maps are fitted with a texel to spare for that.
    let is_decided = |view: &ViewPlan| !view.has_map() || place(view, p).slack[0].abs() < 1.0;
    if light.split == SPLIT_CASCADES && light.selection == SELECT_BY_CONTAINMENT && !views.iter().all(is_decided) {
        return;
    }
    let choice = choose_views(light, views, &receiver);
    if choice.first == NO_VIEW {
        // What the shadow distance cuts in single precision.
        let distance = row(light.view_distance).dot(p.extend(1.0));
        let rounding = 1e-6 * (f64::from(light.shadow_far) + row(light.view_distance).abs().dot(p.abs().extend(1.0)));
        assert!(distance >= f64::from(light.shadow_far) - rounding, "{point} is asked of no view at {distance} m");
        return;
    }
    tried.receivers += 1;
    tried.blended += usize::from(choice.share > 0.0);
    let asked = [Some(choice.first), (choice.share > 0.0).then_some(choice.second)];
    for index in asked.into_iter().flatten() {
        let view = &views[index as usize];
        assert!(view.has_map(), "nothing is visible in view {index}, but {point} is");
        let here = place(view, p);
        assert!(here.w > 0.0, "{point} lies behind view {index}");
        let guard = f64::from(light.guard_texels) - here.slack[0];
        for (texel, size) in here.texel.into_iter().zip([view.rect[2], view.rect[3]]) {
            let size = f64::from(size);
            assert!(
                texel >= guard && texel <= size - guard,
                "{point} is at {:?} of {size} texels in view {index} with a guard of {guard} (slack {:?}, share {})",
                here.texel,
                here.slack,
                choice.share,
            );
        }
        assert!(here.depth >= -here.slack[1], "{point} is nearer than view {index}: {} (slack {:?})", here.depth, here.slack);
        if view.is_pancaked() {
            tried.pancaked += 1;
            // What lies behind all casters can lie behind the far plane, too.
            let is_behind_all = here.drawn >= 1.0 - here.slack[1];
            assert!(is_behind_all || here.depth <= 1.0 + here.slack[1], "{point} is farther than view {index}: {}", here.depth);
        }
        for &at in &shadowing {
            tried.casters += 1;
            let there = place(view, at);
            assert!(there.w > 0.0);
            let slack = here.slack[1] + there.slack[1];
            assert!(
                there.drawn >= -slack && there.drawn <= 1.0 + slack && there.depth <= here.depth.min(1.0) + slack,
                "the caster at {at} has a depth of {}, drawn at {}, in view {index} before {point} with {} (slack {slack})",
                there.depth,
                there.drawn,
                here.depth,
            );
        }
    }
}

/// Tries all samples of a case that are seen.
fn check_case(seed: u64, sizes: [f64; 2], tried: &mut Tried) {
    let mut case = case(seed, &FITS, sizes, 60);
    let random = &mut Random(seed ^ 1);
    let points = case.samples.clone();
    // What the camera sees are the samples, and nothing else.
    case.samples = points.iter().copied().filter(|point| is_seen(&case, point.as_dvec3())).collect();
    let (light, views) = match case.plan() {
        Ok(plan) => plan,
        // Without a sample there is nothing to be tried.
        Err(error) => return assert_eq!(error, PlanError::NoSamples),
    };
    for &point in &case.samples {
        check_receiver(&case, &light, &views, point, random, tried);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn what_is_seen_and_what_shadows_it_is_in_the_map(seed in any::<u64>()) {
        check_case(seed, [1e-3, 1e6], &mut Tried::default());
    }
}

/// Scenes in which something was once missing: points looked at by an orthographic camera that stands on them, whose warps single precision could not hold.
#[test]
fn what_is_as_small_as_rounding_is_in_the_map() {
    for seed in [1_475_259, 1_596_995, 1_905_294, 2_106_498, 2_376_628, 2_641_074, 7_303_911_768_504_537_369] {
        check_case(seed, [1e-3, 1e6], &mut Tried::default());
    }
}

/// Scenes in which a lamp touches the corner of a caster, of which a narrow view once saw the rounding: a depth too short for single precision.
#[test]
fn a_light_that_touches_a_caster_has_a_map() {
    for seed in [802_258, 18_222_438_094_714_653_524, 1_278_047_922_325_096_081, 2_009_943_942_272_206_842] {
        check_case(seed, [1e-3, 1e6], &mut Tried::default());
    }
}

/// The test above tries what it says: so many receivers, casters and blends, for each way to choose cascades.
#[test]
fn enough_is_tried() {
    let mut tried = Tried::default();
    for seed in 0..2000 {
        check_case(seed, [1e-3, 1e6], &mut tried);
    }
    assert!(tried.receivers > 5000 && tried.casters > 10_000 && tried.blended > 200 && tried.pancaked > 1000, "{tried:?}");
    let by_containment = (0..2000).filter(|seed| {
        let case = case(*seed, &FITS, [1.0, 10.0], 1);
        matches!(case.settings.split, Split::Cascades(cascades) if cascades.selection == Selection::Containment)
    });
    assert!(by_containment.count() > 200);
}
