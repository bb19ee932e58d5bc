//! Camera and light agree on every point of the plane.

use shadow_math::{
    Camera, Projection, ShadowSettings,
    aliasing::Aliasing,
    bounds::Aabb,
    exposure::Exposure,
    fit::{Eye, FitOutcome, PlaneOptimal, Subject, plane_depth_factor, plane_optimal},
    glam::{DVec2, DVec3, DVec4, Vec3},
    plan::{MAX_VIEWS_PER_LIGHT, ViewPlan, plan_camera, plan_light},
    rounding::UNIT_ROUNDOFF,
    spaces::ClipDepth,
};

use super::scenes::Random;

/// A plane, a camera that sees it, and a light that lies on either side of it.
struct Setup {
    eye: Eye<'static>,
    plane: DVec4,
    light: DVec4,
}

fn setup(random: &mut Random) -> Setup {
    let normal = random.direction();
    let origin = if random.once_in(2) { DVec3::ZERO } else { random.point() * 20.0 };
    let side = if random.once_in(2) { 1.0 } else { -1.0 };
    let beside = random.direction();
    let eye = origin + normal * side * random.between(0.5, 5.0) + beside.reject_from(normal) * 4.0;
    let projection = if random.once_in(4) {
        Projection::Orthographic { half_height: 3.0, near: 0.0, far: 50.0 }
    } else {
        Projection::Perspective { vertical_fov: random.between(0.3, 1.6), near: 0.1, far: (!random.once_in(2)).then_some(60.0) }
    };
    // Aslant, so that the horizon is often in view.
    let target = origin + random.direction().reject_from(normal) * 3.0;
    let camera = Camera::look_at(eye, target, projection).expect("the eye is off the plane");
    // Any other way, or right against the view: the duelling frusta.
    let way = if random.once_in(4) { -camera.direction() } else { random.direction() };
    let light = match random.below(3) {
        0 => (way * random.between(0.1, 9.0)).extend(0.0),
        1 => (origin + way * random.between(2.0, 20.0)).extend(1.0),
        // Homogeneous, and not of weight 1.
        _ => (origin + way * random.between(2.0, 20.0)).extend(1.0) * 3.0,
    };
    let plane = normal.extend(-normal.dot(origin)) * random.between(0.1, 4.0);
    Setup { eye: Eye { camera, aspect: 1.3, samples: &[], plane: None }, plane, light }
}

/// A point of the plane that the camera sees, by its place in the picture.
fn seen_point(setup: &Setup, ndc: DVec2) -> Option<DVec3> {
    let Setup { eye: Eye { camera, aspect, .. }, plane, .. } = *setup;
    let xy = camera.half_extent(aspect) * ndc;
    let (from, way) = match camera.projection {
        Projection::Perspective { .. } => (camera.eye, camera.orientation * xy.extend(-1.0)),
        Projection::Orthographic { .. } => (camera.eye + camera.orientation * xy.extend(0.0), camera.direction()),
    };
    let along = -plane.dot(from.extend(1.0)) / plane.dot(way.extend(0.0));
    (along > 0.1 && along < 1e4).then(|| from + way * along)
}

fn for_setups(mut check: impl FnMut(&mut Random, &Setup, &PlaneOptimal)) {
    let random = &mut Random(3);
    let mut tried = 0;
    for _ in 0..2000 {
        let setup = setup(random);
        if let Ok(rows) = plane_optimal(&setup.eye, setup.plane, setup.light) {
            tried += 1;
            check(random, &setup, &rows);
        }
    }
    assert!(tried > 1800, "{tried} of 2000 planes have an image");
}

#[test]
fn points_of_the_plane_are_where_the_camera_sees_them() {
    for_setups(|random, setup, rows| {
        let camera = setup.eye.camera;
        let view = rows.view(&setup.eye, -0.1, 256);
        let clip_from_world = view.clip_from_world();
        for _ in 0..20 {
            let ndc = DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
            let Some(point) = seen_point(setup, ndc) else { continue };
            let homogeneous = point.extend(1.0);
            let seen = camera.clip_from_view(setup.eye.aspect, ClipDepth::Reversed) * camera.view_from_world() * homogeneous;
            let lit = DVec4::new(rows.clip_x.dot(homogeneous), rows.clip_y.dot(homogeneous), 0.0, rows.clip_w.dot(homogeneous));
            assert!(lit.w > 0.0, "what is before the camera is before the light");
            // Four products of coordinates over w, each with some roundings; points of the plane are themselves off it by as much.
            let size = (rows.clip_x.abs() + rows.clip_y.abs() + rows.clip_w.abs()).dot(homogeneous.abs());
            let slant = 1.0 / (rows.light_height / rows.light.truncate().distance(point * rows.light.w)).min(1.0);
            let bound = 1e-12_f64.max(64.0 * f64::EPSILON * size / lit.w * slant);
            assert!((lit.truncate() / lit.w - seen.truncate() / seen.w).truncate().length() < bound, "{lit} and {seen}");
            let depth = clip_from_world.project_point3(point).z;
            // The light's pose comes between, and goes out again.
            assert!((depth - 0.99).abs() < 1e3 * bound, "{depth} at {point}");
        }
    });
}

/// The f32 rows of a plan: off by what `4 u |M| |X| / w` says, with two roundings of the matrix's own.
#[test]
fn the_plan_is_as_near_as_single_precision_allows() {
    let floor = Aabb::new(Vec3::new(-9.0, 0.0, -9.0), Vec3::new(9.0, 0.0, 9.0));
    for (x, height) in [(0.0, 2.0), (3.0, 0.5), (-5.0, 6.0)] {
        let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far: None };
        let camera = Camera::look_at(DVec3::new(x, height, 8.0), DVec3::ZERO, projection).expect("it looks at the floor");
        let eye = Eye { camera, aspect: 1.0, samples: &[], plane: Some(DVec4::Y) };
        let casters = [floor];
        let subject = Subject { eye: Some(eye), ..Subject::unseen(&casters, floor) };
        let kind = shadow_math::LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.5) };
        let sun = shadow_math::Light { kind, color: Vec3::ONE, intensity: 1.0 };
        let settings = ShadowSettings { fit: shadow_math::Fit::PlaneOptimal, map_size: 256, ..ShadowSettings::default() };
        let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
        plan_light(&sun, &subject, &settings, [0, 0], &mut views).expect("the scene can be planned");
        let picture = plan_camera(&camera, 256, 256, Exposure::automatic([&sun], floor), 1).expect("so can the picture");
        let random = &mut Random(5);
        for _ in 0..500 {
            let point = random.point_of(floor).as_dvec3();
            let at = |row: [f32; 4]| DVec4::from_array(row.map(f64::from)).dot(point.extend(1.0));
            let size = |row: [f32; 4]| DVec4::from_array(row.map(f64::from)).abs().dot(point.abs().extend(1.0));
            let w = at(picture.clip_w);
            if w < 0.2 || [picture.clip_x, picture.clip_y].into_iter().any(|row| at(row).abs() > w) {
                continue;
            }
            let light_w = at(views[0].clip_w);
            for (seen, lit) in [(picture.clip_x, views[0].clip_x), (picture.clip_y, views[0].clip_y)] {
                // Here only the rows are rounded, once each: a unit of each row's and w's terms, on either side.
                let bound =
                    UNIT_ROUNDOFF * ((size(seen) + size(picture.clip_w)) / w + (size(lit) + size(views[0].clip_w)) / light_w);
                let off = (at(seen) / w - at(lit) / light_w).abs();
                assert!(off <= 1.01 * bound, "{off} is more than {bound} at {point}");
                assert!(bound <= 4.0 * UNIT_ROUNDOFF * (size(lit).max(size(views[0].clip_w))) / light_w * 1.5);
            }
            // A texel is a pixel. It is measured by f32 rows, whose terms are some times their sum.
            let aliasing = Aliasing::at(&picture, &views[0], point, DVec3::Y).expect("both see the floor");
            assert!((aliasing.largest - 1.0).abs() < 1e-4 && (aliasing.smallest - 1.0).abs() < 1e-4, "{aliasing:?} at {point}");
        }
    }
}

/// Casters over the plane whose shadows are in the picture are between the near plane and the plane's own depth, and some touch the former.
/// A plane that is given counts from the world's origin, one that is found from the scene's.
#[test]
fn a_plane_is_given_in_the_world() {
    let floor = Aabb::new(Vec3::new(-9.0, 0.0, -9.0), Vec3::new(9.0, 0.0, 9.0));
    let projection = Projection::Perspective { vertical_fov: 0.9, near: 0.1, far: None };
    let camera = Camera::look_at(DVec3::new(1.0, 3.0, 8.0), DVec3::ZERO, projection).expect("it looks at the floor");
    let eye = Eye { camera, aspect: 1.0, samples: &[], plane: Some(DVec4::Y) };
    let casters = [floor];
    let kind = shadow_math::LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.5) };
    let sun = shadow_math::Light { kind, color: Vec3::ONE, intensity: 1.0 };
    let views = |origin: DVec3, plane| {
        let subject = Subject { eye: Some(eye), origin, ..Subject::unseen(&casters, floor) };
        let settings = ShadowSettings { fit: shadow_math::Fit::PlaneOptimal, plane, map_size: 256, ..ShadowSettings::default() };
        let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
        plan_light(&sun, &subject, &settings, [0, 0], &mut views).expect("the scene can be planned");
        views[0]
    };
    let found = views(DVec3::ZERO, None);
    assert_eq!(found.outcome(), FitOutcome::Fitted);
    for height in [0.0, 100.0, -2048.0] {
        let origin = DVec3::new(12.0, height, 7.0);
        assert_eq!(views(origin, None), found);
        assert_eq!(views(origin, Some([0.0, 2.0, 0.0, -2.0 * height as f32])), found, "the floor is {height} m high");
    }
}

#[test]
fn casters_in_view_fill_the_depth_before_the_plane() {
    let mut nearest = f64::INFINITY;
    for_setups(|random, setup, rows| {
        let center = setup.eye.camera.eye + setup.eye.camera.direction() * random.between(1.0, 8.0);
        let casters: Vec<_> = (0..4)
            .map(|_| {
                let (middle, half) = (center + random.point() * 2.0, 0.1 + 0.5 * (random.point() + 1.0));
                Aabb::new((middle - half).as_vec3(), (middle + half).as_vec3())
            })
            .collect();
        let factor = plane_depth_factor(rows, &casters);
        let clip_from_world = rows.view(&setup.eye, factor, 256).clip_from_world();
        let half_space = rows.view(&setup.eye, factor, 256).half_space;
        for caster in &casters {
            for _ in 0..50 {
                let point = random.point_of(*caster).as_dvec3().extend(1.0);
                let clip = clip_from_world * point;
                let height = rows.plane.dot(point);
                if clip.w <= 0.0 || clip.x.abs() > clip.w || clip.y.abs() > clip.w || height < 0.0 || half_space.dot(point) < 0.0
                {
                    continue;
                }
                let depth = clip.z / clip.w;
                nearest = nearest.min(depth);
                // Rounding of f64 with w far smaller than its terms, for shadows near the camera.
                assert!((-1e-6..=0.99 + 1e-6).contains(&depth), "{depth} at {point}, {height} m over the plane");
            }
        }
    });
    assert!(nearest < 0.1, "some caster comes near to the near plane, and none nearer than {nearest}");
}
