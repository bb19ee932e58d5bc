//! Where cascades end, and what is refused.

use shadow_math::{
    Bias, Camera, Cascades, Filter, Fit, FitFrom, Light, LightKind, PlanError, Projection, Receiver, Selection, ShadowSettings,
    Split, SplitScheme, Store,
    bounds::Aabb,
    fit::{Eye, FitOutcome, Subject},
    glam::{DVec3, Vec3},
    plan::{LightPlan, MAX_VIEWS_PER_LIGHT, ViewPlan, plan_light},
    settings::{BiasParts, MAX_CASCADES, Ogre2006},
    splits::practical_splits,
    visibility::choose_views,
};

const NEAR: f64 = 0.5;
const FAR: f64 = 60.0;

fn sun() -> Light {
    let kind = LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.2) };
    Light { kind, color: Vec3::ONE, intensity: 1.0 }
}

fn lamp(outer: f32) -> Light {
    let kind = LightKind::Spot { position: Vec3::Y * 20.0, direction: Vec3::NEG_Y, inner: 0.1, outer, range: None };
    Light { kind, ..sun() }
}

/// The plan for a camera in a large box, between whose planes all of it can be seen.
fn plan_with(
    light: &Light,
    settings: &ShadowSettings,
    samples: &[Vec3],
    has_camera: bool,
) -> Result<(LightPlan, Vec<ViewPlan>), PlanError> {
    let bounds = Aabb::new(Vec3::splat(-100.0), Vec3::splat(100.0));
    let projection = Projection::Perspective { vertical_fov: 1.0, near: NEAR, far: Some(FAR) };
    let camera = Camera::look_at(DVec3::new(0.0, 2.0, 0.0), DVec3::new(1.0, 1.9, -5.0), projection).expect("it looks ahead");
    let eye = Eye { camera, aspect: 1.5, samples, plane: None };
    let casters = [bounds];
    let subject = Subject { eye: has_camera.then_some(eye), ..Subject::unseen(&casters, bounds) };
    let mut views = vec![ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
    let plan = plan_light(light, &subject, settings, [0, 0], &mut views)?;
    views.truncate(plan.view_count as usize);
    Ok((plan, views))
}

fn of(cascades: Cascades) -> ShadowSettings {
    ShadowSettings { split: Split::Cascades(cascades), ..ShadowSettings::default() }
}

fn plan(cascades: Cascades) -> (LightPlan, Vec<ViewPlan>) {
    plan_with(&sun(), &of(cascades), &[], true).expect("the cascades can be planned")
}

fn ends(plan: &LightPlan) -> Vec<f64> {
    plan.split_far.as_flattened()[..plan.view_count as usize].iter().map(|end| f64::from(*end)).collect()
}

#[test]
fn cascades_end_where_the_practical_scheme_says() {
    for count in 1..=MAX_CASCADES {
        for (scheme, lambda) in
            [(SplitScheme::Uniform, 0.0), (SplitScheme::Logarithmic, 1.0), (SplitScheme::Practical(0.625), 0.625)]
        {
            let (plan, views) = plan(Cascades { count: count as u32, scheme, ..Cascades::default() });
            assert_eq!(views.len(), count);
            let mut expected = [0.0; MAX_CASCADES + 1];
            practical_splits(NEAR, FAR, lambda, &mut expected[..=count]);
            let ends = ends(&plan);
            assert!(ends.windows(2).all(|pair| pair[0] < pair[1]), "{ends:?} increase");
            for (end, expected) in ends.iter().zip(&expected[1..count]) {
                // Distances are widened by a millionth, and by what single precision can do to points 100 m away.
                assert!((end - expected).abs() < 1e-4 * expected + 1e-3, "{end} is not {expected}");
            }
            assert_eq!(ends[count - 1], f64::from(f32::MAX), "the last cascade has the rest");
        }
    }
}

#[test]
fn the_table_of_ogre_is_met() {
    // `splits(3, 1, 3000)` with lambda 0.95, from OGRE's own code in single precision.
    let mut splits = [0.0; 4];
    practical_splits(1.0, 3000.0, 0.95, &mut splits);
    for (split, expected) in splits.iter().zip([1.0, 63.73472, 297.6247, 3000.0]) {
        assert!((split - expected).abs() < 1e-6 * expected, "{split} is not {expected}");
    }
}

/// A hundredth of the samples lie far away: three of four cascades end before them.
#[test]
fn histograms_follow_the_samples() {
    let near = (0..99).map(|i| Vec3::new(0.0, 1.9, -5.0 - 0.02 * i as f32));
    let samples: Vec<_> = near.chain([Vec3::new(0.0, 1.9, -50.0)]).collect();
    let cascades = Cascades { scheme: SplitScheme::Histogram, ..Cascades::default() };
    let (plan, _) = plan_with(&sun(), &of(cascades), &samples, true).expect("there are samples");
    let ends = ends(&plan);
    assert!(ends[0] > 4.0 && ends[2] < 8.0, "{ends:?}");
    assert_eq!(plan_with(&sun(), &of(cascades), &[], true).expect_err("there is none"), PlanError::NoSamples);
    let settings = ShadowSettings { fit: Fit::Focused, fit_from: FitFrom::Samples, ..ShadowSettings::default() };
    assert_eq!(plan_with(&sun(), &settings, &[], true).expect_err("there is none"), PlanError::NoSamples);
}

#[test]
fn explicit_ends_are_kept_within_what_is_seen() {
    let explicit = |ends| Cascades { scheme: SplitScheme::Explicit(ends), ..Cascades::default() };
    let (within, _) = plan(explicit([5.0, 10.0, 20.0, 0.0, 0.0, 0.0, 0.0]));
    assert_eq!(ends(&within)[..3], [5.0, 10.0, 20.0]);
    let (beyond, _) = plan(explicit([0.1, 10.0, 50.0, 0.0, 0.0, 0.0, 0.0]));
    let ends = ends(&beyond);
    assert!((ends[0] - NEAR).abs() < 1e-3 && ends[2] == 50.0, "{ends:?}");
}

/// What begins where everything ends does not exist, and what ends before everything begins has no map; the others are as they would be alone.
#[test]
fn cascades_without_anything_have_no_maps() {
    for stabilised in [false, true] {
        let with = |count, ends: [f32; 3]| {
            let [a, b, c] = ends;
            let scheme = SplitScheme::Explicit([a, b, c, 0.0, 0.0, 0.0, 0.0]);
            plan(Cascades { count, scheme, stabilised, ..Cascades::default() })
        };
        let (light, views) = with(4, [10.0, 70.0, 80.0]);
        let (alone, expected) = with(2, [10.0, 0.0, 0.0]);
        assert_eq!((light.split_far, light.view_count, &views), (alone.split_far, 2, &expected));
        let (light, views) = with(4, [0.1, 0.2, 10.0]);
        assert_eq!(light.view_count, 4);
        let outcomes: Vec<_> = views.iter().map(|view| (view.outcome(), view.layer)).collect();
        let [nothing, fitted] = [FitOutcome::NothingVisible, FitOutcome::Fitted];
        assert_eq!(outcomes, [(nothing, 0), (nothing, 0), (fitted, 0), (fitted, 1)]);
        let (_, expected) = with(2, [10.0, 0.0, 0.0]);
        assert_eq!(views[2..], expected);
    }
}

/// Samples beyond the shadow distance ask no map: the cascades are those of a picture without them.
#[test]
fn histograms_end_with_the_shadows() {
    let near: Vec<_> = (0..99).map(|i| Vec3::new(0.0, 1.9, -5.0 - 0.04 * i as f32)).collect();
    let cascades = Cascades { scheme: SplitScheme::Histogram, ..Cascades::default() };
    let settings = ShadowSettings { shadow_distance: Some(10.0), ..of(cascades) };
    let ends = |far: usize| {
        let samples: Vec<_> = near.iter().copied().chain(vec![Vec3::new(0.0, 1.9, -50.0); far]).collect();
        ends(&plan_with(&sun(), &settings, &samples, true).expect("there are samples").0)
    };
    let (none, many) = (ends(0), ends(1000));
    assert_eq!(none, many);
    assert!(none[0] < 6.5 && none[2] < 8.5, "{none:?} are quarters of the samples between 5 and 9 m");
}

/// Receivers that ask because they are in the map before, which reaches to the camera, do not take the warp from the cascades that they are blended with.
#[test]
fn blends_do_not_undo_warps() {
    let farthest_w = |blend| {
        let cascades = Cascades { selection: Selection::Containment, blend, ..Cascades::default() };
        let settings = ShadowSettings { fit: Fit::Lispsm, ..of(cascades) };
        let (_, views) = plan_with(&sun(), &settings, &[], true).expect("the cascades can be planned");
        views.iter().map(|view| view.farthest_w).collect::<Vec<_>>()
    };
    for (alone, blended) in farthest_w(0.0).into_iter().zip(farthest_w(0.1)) {
        // The map can have twice as much in it, and not more.
        assert!(blended < 2.0 * alone, "w grows to {blended} in place of {alone}");
    }
}

/// A map whose last texel reaches to infinity has no more than what it was fitted to, and a quarter.
#[test]
fn strong_warps_do_not_contain_what_lies_beyond() {
    let floor = Aabb::new(Vec3::new(-1e6, -1.0, -1e6), Vec3::new(1e6, 0.0, 1e6));
    let projection = Projection::Perspective { vertical_fov: 1.0, near: 0.1, far: None };
    let camera = Camera::look_at(DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.0, 1.9, -5.0), projection).expect("it looks ahead");
    let eye = Eye { camera, aspect: 1.5, samples: &[], plane: None };
    let casters = [floor];
    let subject = Subject { eye: Some(eye), ..Subject::unseen(&casters, floor) };
    let cascades = Cascades { selection: Selection::Containment, ..Cascades::default() };
    let settings = ShadowSettings { fit: Fit::Lispsm, map_size: 64, ..of(cascades) };
    let mut views = vec![ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
    let kind = LightKind::Directional { direction: Vec3::new(-0.9, -0.3, 0.0) };
    let light = plan_light(&Light { kind, ..sun() }, &subject, &settings, [0, 0], &mut views).expect("it can be planned");
    assert!(views[0].is_warped != 0);
    let end = ends(&light)[0];
    let chosen = |distance: f64| {
        let point = Vec3::new(0.0, 0.0, -distance as f32);
        choose_views(&light, &views, &Receiver::new(point, Vec3::Y)).first
    };
    assert_eq!(chosen(0.9 * end), 0);
    for factor in [1.5, 10.0, 100.0] {
        assert!(chosen(factor * end) > 0, "a receiver at {factor} times the cascade's end asks it");
    }
}

/// Padding makes maps larger, and no larger than all that is seen.
#[test]
fn padding_ends_where_there_is_nothing_more() {
    let widths =
        |padding| plan(Cascades { padding, ..Cascades::default() }).1.iter().map(|view| view.texel_metres[0]).collect::<Vec<_>>();
    let (plain, padded, most, beyond) = (widths(0.0), widths(0.5), widths(1e4), widths(1e30));
    assert!(plain.iter().zip(&padded).all(|(a, b)| a <= b) && plain[0] < padded[0], "{plain:?} and {padded:?}");
    assert_eq!(most, beyond);
    assert!(most.iter().all(|width| (width - most[0]).abs() < 1e-4 * most[0]), "{most:?} are all of the whole view");
}

#[test]
fn blends_take_their_share_and_the_last_cascade_none() {
    for (selection, expected) in [(Selection::Depth, None), (Selection::Containment, Some(0.25))] {
        let (plan, _) = plan(Cascades { blend: 0.25, selection, ..Cascades::default() });
        let (ends, bands) = (ends(&plan), plan.split_band.as_flattened());
        let second = expected.unwrap_or(0.25 * (ends[1] - ends[0]));
        // Single precision.
        assert!((f64::from(bands[1]) - second).abs() < 1e-5 * second, "{bands:?}");
        assert_eq!(bands[3..], [0.0; 5]);
    }
}

#[test]
fn maps_have_the_sizes_that_are_given() {
    let mut map_sizes = [None; MAX_CASCADES];
    (map_sizes[1], map_sizes[2]) = (Some(512), Some(256));
    let (_, views) = plan(Cascades { map_sizes, ..Cascades::default() });
    assert_eq!(views.iter().map(|view| view.rect[2]).collect::<Vec<_>>(), [2048, 512, 256, 2048]);
    assert!(views.iter().all(|view| view.outcome() == FitOutcome::Fitted));
}

#[test]
fn what_has_no_meaning_is_refused() {
    let refused = |settings: &ShadowSettings| plan_with(&sun(), settings, &[], true).expect_err("it has no meaning");
    let default = Cascades::default();
    let cases = [
        (Cascades { count: 0, ..default }, PlanError::CascadeCount(0)),
        (Cascades { count: 9, ..default }, PlanError::CascadeCount(9)),
        (Cascades { scheme: SplitScheme::Practical(1.5), ..default }, PlanError::Lambda(1.5)),
        (Cascades { padding: -1.0, ..default }, PlanError::Padding(-1.0)),
        (Cascades { padding: f32::INFINITY, ..default }, PlanError::Padding(f32::INFINITY)),
        (Cascades { blend: 1.5, ..default }, PlanError::Blend(1.5)),
        (Cascades { lispsm_factors: [-2.0; MAX_CASCADES], ..default }, PlanError::LispsmFactor(-2.0)),
        (Cascades { map_sizes: [Some(4096); MAX_CASCADES], ..default }, PlanError::CascadeMapSize { size: 4096, most: 2048 }),
        (Cascades { map_sizes: [Some(15); MAX_CASCADES], ..default }, PlanError::CascadeMapSize { size: 15, most: 2048 }),
        (Cascades { map_sizes: [Some(0); MAX_CASCADES], ..default }, PlanError::CascadeMapSize { size: 0, most: 2048 }),
        (Cascades { fits: [Some(Fit::PlaneOptimal); MAX_CASCADES], ..default }, PlanError::FitOfCascades(Fit::PlaneOptimal)),
        (
            Cascades { fits: [Some(Fit::Focused); MAX_CASCADES], stabilised: true, ..default },
            PlanError::StabilisedFit(Fit::Focused),
        ),
        (Cascades { map_sizes: [Some(1000); MAX_CASCADES], stabilised: true, ..default }, PlanError::StabilisedMapSize(1000)),
        (Cascades { scheme: SplitScheme::Histogram, stabilised: true, ..default }, PlanError::StabilisedHistogram),
    ];
    for (cascades, expected) in cases {
        assert_eq!(refused(&of(cascades)), expected);
        assert!(expected.to_string().len() > 40, "the message says what to do");
    }
    for ends in [[5.0, 5.0, 6.0], [5.0, 4.0, 6.0], [0.0, 1.0, 2.0], [1.0, f32::INFINITY, 2.0]] {
        let [a, b, c] = ends;
        let scheme = SplitScheme::Explicit([a, b, c, 0.0, 0.0, 0.0, 0.0]);
        assert!(matches!(refused(&of(Cascades { scheme, ..default })), PlanError::SplitDistance(_)), "{ends:?}");
    }
    assert!(matches!(refused(&of(Cascades { scheme: SplitScheme::Practical(f32::NAN), ..default })), PlanError::Lambda(_)));
    let ogre = ShadowSettings { fit: Fit::OgreUniform, ..of(default) };
    assert_eq!(refused(&ogre), PlanError::FitOfCascades(Fit::OgreUniform));
    for metres in [0.0, -1.0, f32::INFINITY] {
        let settings = ShadowSettings { shadow_distance: Some(metres), ..ShadowSettings::default() };
        assert_eq!(refused(&settings), PlanError::ShadowDistance(metres));
    }
}

/// A cascade's own map is too small for a filter that the others have room for.
#[test]
fn a_map_without_room_for_its_filter_is_refused() {
    let with = |smallest: u32, selection| {
        let mut map_sizes = [None; MAX_CASCADES];
        map_sizes[3] = Some(smallest);
        let settings = of(Cascades { map_sizes, selection, ..Cascades::default() });
        plan_with(&sun(), &ShadowSettings { filter: Filter::Box9, ..settings }, &[], true)
    };
    let (plan, _) = with(2048, Selection::Depth).expect("2048 texels are enough");
    let guard = plan.guard_texels as u32;
    let refused = |guard| PlanError::MapTooSmallForFilter { size: 2 * guard + 1, filter: Filter::Box9, guard };
    assert_eq!(with(2 * guard + 1, Selection::Depth).expect_err("a texel is left, by which maps are moved"), refused(guard));
    assert!(with(2 * guard + 2, Selection::Depth).is_ok());
    // A texel more on each side, where it is asked which map has a receiver.
    assert_eq!(with(2 * guard + 3, Selection::Containment).expect_err("a texel is left"), refused(guard + 1));
}

#[test]
fn what_the_light_does_not_allow_is_refused() {
    let refused = |light: &Light, cascades| plan_with(light, &of(cascades), &[], true).expect_err("the light has no cascades");
    assert_eq!(refused(&lamp(1.4), Cascades::default()), PlanError::CascadesOfCube);
    let point = Light { kind: LightKind::Point { position: Vec3::Y, range: None }, ..sun() };
    assert_eq!(refused(&point, Cascades::default()), PlanError::CascadesOfCube);
    assert_eq!(refused(&lamp(0.7), Cascades { stabilised: true, ..Cascades::default() }), PlanError::StabilisedLight);
    assert!(plan_with(&lamp(0.7), &of(Cascades::default()), &[], true).is_ok(), "a narrow cone has cascades");
}

#[test]
fn what_follows_a_camera_needs_one() {
    let without = |settings: &ShadowSettings| plan_with(&sun(), settings, &[], false);
    let default = ShadowSettings::default();
    assert!(without(&default).is_ok());
    let distance = ShadowSettings { shadow_distance: Some(9.0), ..default };
    let focused = ShadowSettings { fit: Fit::Focused, ..default };
    for settings in [distance, focused, of(Cascades::default())] {
        assert_eq!(without(&settings).expect_err("nobody looks"), PlanError::NoCamera);
    }
}

#[test]
fn warps_are_refused_what_needs_distances() {
    let refused = |settings: &ShadowSettings| plan_with(&sun(), settings, &[], true).expect_err("warps have none");
    for fit in [Fit::Lispsm, Fit::OgreLispsm, Fit::PlaneOptimal] {
        let settings = ShadowSettings { fit, ..ShadowSettings::default() };
        let store = Store::Linear;
        assert_eq!(refused(&ShadowSettings { store, ..settings }), PlanError::StoreOfFit { fit, store });
        let bias = Bias::Parts(BiasParts { ogre_2006: Some(Ogre2006::default()), ..BiasParts::NONE });
        assert_eq!(refused(&ShadowSettings { bias, ..settings }), PlanError::BiasOfFit { fit, bias: "ogre-2006" });
        let steps = ShadowSettings { store: Store::Depth16, ..settings };
        let is_refused = plan_with(&sun(), &steps, &[], true).is_err();
        assert_eq!(is_refused, fit == Fit::PlaneOptimal, "steps are too coarse for the plane's depth alone");
    }
    let plane = [0.0, 0.0, 0.0, 1.0];
    let settings = ShadowSettings { fit: Fit::PlaneOptimal, plane: Some(plane), ..ShadowSettings::default() };
    assert_eq!(refused(&settings), PlanError::Plane(plane));
}
