//! The ray tracer against shadows that geometry knows.

use std::f64::consts::PI;

use glam::{DMat4, DVec2, DVec3, Quat, Vec3};
use shadow_cpu::{
    renderer::CameraBuffer,
    trace::{
        CameraView, Sampling, SurfacePoint, Tracer,
        confidence::{CONFIDENCE, Intervals},
    },
};
use shadow_math::{Camera, Light, LightKind, LightShape, Projection, ShadowSettings, spaces::ClipDepth};
use shadow_scene::{
    Alpha, FramePlan, Image, Material, NO_TRIANGLE, Scene, SceneBuilder, SceneLight, Texture, Wrap, builtin, builtin::shapes,
    import,
};
use shadow_tests::renderers::{cpu, scenes};

/// What a pixel sees, and whether it sees the middle of the first light.
struct Pixel {
    triangle: u32,
    point: SurfacePoint,
    is_lit: bool,
}

/// Every pixel of the scene's first camera that shows something.
fn pixels(scene: &Scene, width: u32, height: u32) -> Vec<Pixel> {
    let tracer = Tracer::new(scene, 0).expect("threads start");
    let view = CameraView::new(&scene.cameras()[0].camera, width, height);
    let mut rays = tracer.rays();
    let mut pixels = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let ray = view.ray(x, y);
            if let Some(hit) = rays.closest_seen(ray) {
                let point = tracer.surface_point(&hit, ray);
                let is_lit = rays.sees_center(&point, &scene.lights()[0]);
                pixels.push(Pixel { triangle: hit.triangle, point, is_lit });
            }
        }
    }
    pixels
}

/// The triangles that belong to the instance of that name.
fn triangles_of(scene: &Scene, name: &str) -> std::ops::Range<u32> {
    let mut first = 0;
    for instance in scene.instances() {
        let end = first + instance.triangle_count;
        if instance.name == name {
            return first..end;
        }
        first = end;
    }
    panic!("there is no `{name}`")
}

#[test]
fn the_outline_of_a_box_is_exact_at_every_pixel_centre() {
    let scene = builtin::box_on_plane();
    let plane = triangles_of(&scene, "plane");
    let (mut lit, mut shadowed) = (0, 0);
    for pixel in pixels(&scene, 1280, 720) {
        let position = pixel.point.position;
        let expected = if plane.contains(&pixel.triangle) {
            !builtin::box_on_plane_is_shadowed(position.x as f32, position.z as f32)
        } else {
            // The top faces the light, and so does the side that x = -1 is on; the others do not or see it edge-on.
            position.y > 2.0 - 1e-9 || position.x < -1.0 + 1e-9
        };
        // The function above takes f32: within its rounding of an edge it cannot tell. No pixel centre of this view lies there.
        assert_eq!(pixel.is_lit, expected, "at {position}");
        if plane.contains(&pixel.triangle) {
            if expected { lit += 1 } else { shadowed += 1 }
        }
    }
    assert!(lit > 100_000 && shadowed > 5_000, "{lit} lit and {shadowed} shadowed pixels of the plane");
}

/// A floor of 40 m under a camera that looks down, with what `add` adds to it.
fn over_a_floor(add: impl FnOnce(&mut SceneBuilder, u32)) -> Scene {
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let white = builder.add_material(Material::white());
    builder.add_instance("floor", white, shapes::plane(Vec3::ZERO, Vec3::Y, 20.0)).expect("the floor is whole");
    let projection = Projection::Perspective { vertical_fov: 1.0, near: 0.1, far: None };
    let camera = Camera::look_at(DVec3::new(3.0, 9.0, 6.0), DVec3::new(0.7, 0.0, 0.2), projection);
    builder.add_camera("above", camera.expect("the eye is not the target"));
    add(&mut builder, white);
    builder.build().expect("the scene is whole")
}

fn light(kind: LightKind, shape: LightShape) -> SceneLight {
    SceneLight { shape, ..SceneLight::new("light", Light { kind, color: Vec3::ONE, intensity: 1000.0 }) }
}

/// The shadow of a sphere is an ellipse: the points whose ray to the light comes nearer to the middle than the radius.
#[test]
fn the_shadow_of_a_sphere_is_an_ellipse() {
    let (center, radius, segments) = (Vec3::new(0.5, 2.0, 0.0), 1.0_f32, 256_u32);
    let scene = over_a_floor(|builder, white| {
        builder.add_instance("ball", white, shapes::sphere(center, radius, segments)).expect("the ball is whole");
    });
    let sun = LightKind::Directional { direction: Vec3::new(0.4, -1.0, -0.3) };
    let lamp = LightKind::Point { position: Vec3::new(-1.0, 6.0, 1.0), range: None };
    for kind in [sun, lamp] {
        let scene = scene.clone().with_lights(vec![light(kind, LightShape::Point)]);
        let floor = triangles_of(&scene, "floor");
        // The mesh has its corners on the sphere and its faces inside: an inscribed polygon of as many corners reaches to the cosine of half its angle.
        let inside = f64::from(radius) * (PI / f64::from(segments / 2)).cos();
        let (mut shadowed, mut undecided) = (0, 0);
        for pixel in pixels(&scene, 960, 540).iter().filter(|pixel| floor.contains(&pixel.triangle)) {
            let position = pixel.point.position;
            let toward = match kind {
                LightKind::Directional { direction } => -direction.as_dvec3(),
                LightKind::Spot { position: light, .. } | LightKind::Point { position: light, .. } => light.as_dvec3() - position,
            };
            let distance = (center.as_dvec3() - position).reject_from(toward).length();
            if distance < inside {
                assert!(!pixel.is_lit, "{position} lies {distance} m from the middle of the ball");
                shadowed += 1;
            } else if distance > f64::from(radius) * (1.0 + 1e-6) {
                assert!(pixel.is_lit, "{position} lies {distance} m from the middle of the ball");
            } else {
                undecided += 1;
            }
        }
        assert!(shadowed > 4_000 && undecided * 50 < shadowed, "{shadowed} shadowed, {undecided} undecided");
    }
}

/// The share of a disc of radius 1 beyond a chord at this signed distance from its middle.
fn disc_beyond(distance: f64) -> f64 {
    let distance = distance.clamp(-1.0, 1.0);
    (distance.acos() - distance * (1.0 - distance * distance).sqrt()) / PI
}

/// Below the edge of a half-plane a light sinks behind a straight line: how much of it is left is a matter of a circle's or a rectangle's segment. The
/// interval that comes with the samples holds it in 95 of 100 pixels of the penumbra, for each kind of light.
#[test]
fn the_penumbra_of_a_half_plane_lies_in_its_interval() {
    /// The half-plane reaches from x = -20 m to this edge, at this height.
    const EDGE: f64 = 0.25;
    const HEIGHT: f64 = 2.0;
    let scene = over_a_floor(|builder, white| {
        let corner = |x: f32, z: f32| Vec3::new(x, HEIGHT as f32, z);
        let roof =
            shapes::quad([corner(-20.0, 20.0), corner(EDGE as f32, 20.0), corner(EDGE as f32, -20.0), corner(-20.0, -20.0)]);
        builder.add_instance("roof", white, roof).expect("the roof is whole");
    });
    let lamp = DVec3::new(EDGE, 7.0, 0.0);
    let (radius, angle, half) = (0.5_f64, 0.2_f64, 0.4_f64);
    let sun = LightKind::Directional { direction: Vec3::new(0.3, -1.0, 0.1) };
    let point = LightKind::Point { position: lamp.as_vec3(), range: None };
    let spot = LightKind::Spot { position: lamp.as_vec3(), direction: Vec3::NEG_Y, inner: 1.0, outer: 1.5, range: None };
    let disc = LightShape::Disc { angular_diameter: angle as f32 };
    let sphere = LightShape::Sphere { radius: radius as f32 };
    let rectangle = LightShape::Rectangle { half_width: Vec3::X * half as f32, half_height: Vec3::Z };
    let sampling = Sampling { side: 12 };
    let intervals = Intervals::new(sampling.count(), CONFIDENCE);
    for (kind, shape) in [(sun, disc), (point, sphere), (spot, rectangle)] {
        let scene = scene.clone().with_lights(vec![light(kind, shape)]);
        let floor = triangles_of(&scene, "floor");
        let tracer = Tracer::new(&scene, 0).expect("threads start");
        let view = CameraView::new(&scene.cameras()[0].camera, 480, 270);
        let seen = tracer.camera(view, &|| {});
        let lights = tracer.lights(&seen, sampling, &|| {});
        let (mut in_penumbra, mut held) = (0_u32, 0_u32);
        for (pixel, (hit, &lit)) in seen.hits.iter().zip(&lights.samples_seen).enumerate() {
            if hit.triangle == NO_TRIANGLE || !floor.contains(&hit.triangle) {
                continue;
            }
            let ray = view.ray(pixel as u32 % 480, pixel as u32 / 480);
            let position = tracer.surface_point(hit, ray).position;
            // The line behind which the light sinks is where the plane through the point and the roof's edge cuts the figure.
            let share = match kind {
                LightKind::Directional { direction } => {
                    let center = -direction.as_dvec3().normalize();
                    let normal = DVec3::new(HEIGHT, position.x - EDGE, 0.0);
                    // The figure's directions are center + r a with a across it; the plane's normal is split likewise.
                    let across = normal.reject_from(center).length() * (0.5 * angle).tan();
                    disc_beyond(-normal.dot(center) / across)
                }
                LightKind::Point { .. } => {
                    let normal = DVec3::new(HEIGHT, position.x - EDGE, 0.0).normalize();
                    let toward = lamp - position;
                    // A sphere's outline seen from the point is the cone of this half angle around the way to its middle.
                    let tangent = {
                        let sine = radius / toward.length();
                        sine / (1.0 - sine * sine).sqrt()
                    };
                    let center = toward.normalize();
                    disc_beyond(-normal.dot(center) / (normal.reject_from(center).length() * tangent))
                }
                LightKind::Spot { .. } => {
                    // Similar triangles: the ray over the edge arrives at the lamp's height here.
                    let over = position.x + (EDGE - position.x) * lamp.y / HEIGHT;
                    ((lamp.x + half - over) / (2.0 * half)).clamp(0.0, 1.0)
                }
            };
            let [least, most] = intervals.of(lit);
            if share > 0.0 && share < 1.0 {
                in_penumbra += 1;
                held += u32::from((least..=most).contains(&share));
            } else {
                // Outside of the penumbra all samples agree; f32 rounds the light's place, which the margin of a sample's weight covers.
                assert!(
                    (f64::from(lit) / f64::from(sampling.count()) - share).abs() < 0.05,
                    "{shape:?}: {lit} seen at {position}"
                );
            }
        }
        assert!(in_penumbra > 2_000, "{shape:?}: {in_penumbra} pixels of penumbra");
        assert!(held * 100 >= in_penumbra * 95, "{shape:?}: {held} of {in_penumbra} intervals hold the true share");
    }
}

/// A point inside a light sees all of it, and a light without a size is seen or not.
#[test]
fn lights_that_touch_what_they_light_have_defined_results() {
    let scene = over_a_floor(|_, _| {});
    let lit = |kind, shape| {
        let scene = scene.clone().with_lights(vec![light(kind, shape)]);
        let tracer = Tracer::new(&scene, 1).expect("a thread starts");
        let view = CameraView::new(&scene.cameras()[0].camera, 16, 9);
        let seen = tracer.camera(view, &|| {});
        let lights = tracer.lights(&seen, Sampling::default(), &|| {});
        (
            lights.samples_seen.iter().filter(|&&seen| seen == 64).count(),
            lights.samples_seen.iter().filter(|&&seen| seen == 0).count(),
        )
    };
    let at = |y: f32| LightKind::Point { position: Vec3::new(0.0, y, 0.0), range: None };
    assert_eq!(lit(at(1.0), LightShape::Point), (144, 0));
    assert_eq!(lit(at(-1.0), LightShape::Point), (0, 144), "from below");
    assert_eq!(lit(at(0.0), LightShape::Point), (0, 144), "on the plane of the floor, edge-on");
    // Of a sphere that the floor cuts in half, the half below is hidden; far away from it no point is inside.
    assert_eq!(lit(at(0.0), LightShape::Sphere { radius: 0.01 }).0, 0);
    assert_eq!(lit(at(30.0), LightShape::Sphere { radius: 100.0 }), (144, 0), "inside the light");
}

/// From inside a closed body a camera sees nothing of single-sided walls; a light inside lights nothing outside.
#[test]
fn solids_are_solid_to_light_and_open_to_a_camera_inside() {
    let scene = over_a_floor(|builder, white| {
        let body = shapes::cuboid(Vec3::new(0.0, 2.0, 0.0), Vec3::ONE, Quat::IDENTITY);
        builder.add_instance("body", white, body).expect("the body is whole");
    });
    let inside = LightKind::Point { position: Vec3::new(0.0, 2.0, 0.0), range: None };
    let scene = scene.with_lights(vec![light(inside, LightShape::Point)]);
    assert!(pixels(&scene, 160, 90).iter().all(|pixel| !pixel.is_lit));
    let tracer = Tracer::new(&scene, 1).expect("a thread starts");
    let projection = Projection::Perspective { vertical_fov: 1.0, near: 0.01, far: None };
    let camera = Camera::look_at(DVec3::new(0.0, 2.0, 0.0), DVec3::new(0.1, 0.0, 0.1), projection).expect("a direction");
    let seen = tracer.camera(CameraView::new(&camera, 32, 18), &|| {});
    let floor = triangles_of(&scene, "floor");
    assert!(seen.hits.iter().all(|hit| floor.contains(&hit.triangle)), "the walls are seen from behind, and so not at all");
}

/// A fence of known pitch throws the stripes that geometry says.
#[test]
fn the_stripes_of_a_fence_are_exact_at_every_pixel_centre() {
    let (mut lit, mut shadowed) = (0_u32, 0_u32);
    for pixel in pixels(&builtin::fence(), 960, 540) {
        let position = pixel.point.position;
        if pixel.point.normal.y > 0.9 {
            assert_eq!(pixel.is_lit, !builtin::fence_is_shadowed(position.x as f32, position.z as f32), "at {position}");
            if pixel.is_lit { lit += 1 } else { shadowed += 1 }
        }
    }
    assert!(lit > 50_000 && shadowed > 1000, "{lit} lit and {shadowed} shadowed");
}

/// Holes that are cut out by alpha let rays of both kinds through. Alpha is bilinear, so that between a texel of 1 and one of 0 it is a half, the
/// cutoff, on the border of the texels.
#[test]
fn holes_let_light_through() {
    const COLUMNS: u32 = 8;
    let scene = over_a_floor(|builder, _| {
        let column = |column: u32| [255, 255, 255, if column.is_multiple_of(2) { 255 } else { 0 }];
        let image = builder.add_image(Image { width: COLUMNS, height: 1, texels: (0..COLUMNS).map(column).collect() });
        let texture = Some(Texture { image, wrap_u: Wrap::ClampToEdge, wrap_v: Wrap::ClampToEdge });
        let grating = builder.add_material(Material { texture, alpha: Alpha::Mask { cutoff: 0.5 }, ..Material::white() });
        // A metre of it for each column, from x = -4 m to 4 m.
        let corner = |x: f32, z: f32| Vec3::new(x, 1.0, z);
        let roof = shapes::quad([corner(-4.0, 4.0), corner(4.0, 4.0), corner(4.0, -4.0), corner(-4.0, -4.0)]);
        builder.add_instance("grating", grating, roof).expect("the grating is whole");
    });
    let scene = scene.with_lights(vec![light(LightKind::Directional { direction: Vec3::NEG_Y }, LightShape::Point)]);
    let (mut through, mut shadowed) = (0, 0);
    for pixel in pixels(&scene, 640, 360) {
        let position = pixel.point.position;
        let is_below = position.x.abs() < 4.0 && position.z.abs() < 4.0 && position.y < 0.5;
        let is_hole = (position.x + 4.0).floor() as i32 % 2 == 1;
        assert_eq!(pixel.is_lit, !is_below || is_hole, "at {position}");
        // What lies below a hole and is seen from above is seen through one.
        through += u32::from(is_below && is_hole);
        shadowed += u32::from(!pixel.is_lit);
    }
    assert!(through > 2_000 && shadowed > 2_000, "{through} below holes and {shadowed} shadowed");
}

/// The rasteriser and the rays see the same triangles, but for pixels whose centre an edge passes within a step of the sub-pixel grid.
#[test]
fn rays_and_rasteriser_see_the_same_triangles() {
    let mut all = vec![builtin::demo(), builtin::box_on_plane(), builtin::fence(), builtin::grazing()];
    if let Some(folder) = scenes("rays_and_rasteriser_see_the_same_triangles: real scenes") {
        for file in ["sponza/sponza.glb", "stanford_bunny/stanford_bunny.glb", "carbon_sphere/carbon_sphere.glb"] {
            all.push(import(&folder.join(file)).expect(file));
        }
    }
    for scene in &all {
        let camera = scene.cameras()[0].camera;
        let (width, height) = (640, 360);
        let plan = FramePlan::new(scene, &camera, &ShadowSettings::default(), width, height, None).expect("the plan is made");
        let CameraBuffer { triangles, .. } = cpu().camera(&cpu().prepare(scene), &plan).expect("the camera sees it");
        let tracer = Tracer::new(scene, 0).expect("threads start");
        let view = CameraView::new(&camera, width, height);
        let seen = tracer.camera(view, &|| {});
        let aspect = f64::from(width) / f64::from(height);
        let clip_from_world = camera.clip_from_view(aspect, ClipDepth::Reversed) * camera.view_from_world();
        let mut differing = 0;
        for (pixel, (&raster, hit)) in triangles.iter().zip(&seen.hits).enumerate() {
            if raster == hit.triangle {
                continue;
            }
            differing += 1;
            // An edge moves by no more than its ends, which are snapped to the nearest of 256 steps on each axis.
            let center = DVec2::new(f64::from(pixel as u32 % width) + 0.5, f64::from(pixel as u32 / width) + 0.5);
            let nearest = [raster, hit.triangle].into_iter().filter(|&triangle| triangle != NO_TRIANGLE);
            let nearest =
                nearest.map(|triangle| distance_to_edges(scene, triangle, clip_from_world, center)).fold(f64::MAX, f64::min);
            assert!(nearest <= SNAP, "{center}: {raster} instead of {hit:?}, {nearest} pixels from an edge");
        }
        // One in a thousand: a mesh of as many triangles as pixels has edges everywhere.
        assert!(differing * 1000 < seen.hits.len(), "{differing} pixels of {} differ", seen.hits.len());
    }
}

/// How far a snapped corner can be from where it was: half a step of 1/256 pixel on each axis.
const SNAP: f64 = core::f64::consts::SQRT_2 / 512.0;

/// How far a point of a picture of 640 x 360 pixels is from the nearest line through two corners of a triangle, in pixels.
fn distance_to_edges(scene: &Scene, triangle: u32, clip_from_world: DMat4, point: DVec2) -> f64 {
    let corners = scene.triangles()[triangle as usize].map(|corner| {
        let ndc = clip_from_world.project_point3(scene.vertices().positions[corner as usize].as_dvec3());
        DVec2::new((ndc.x + 1.0) * 320.0, (1.0 - ndc.y) * 180.0)
    });
    let distance = |i: usize| {
        let along = (corners[(i + 1) % 3] - corners[i]).normalize_or_zero();
        (point - corners[i]).perp_dot(along).abs()
    };
    (0..3).map(distance).fold(f64::MAX, f64::min)
}

/// The same picture from any number of threads.
#[test]
fn threads_do_not_change_the_truth() {
    let scene = builtin::demo();
    let view = CameraView::new(&scene.cameras()[0].camera, 160, 90);
    let [one, three] = [1, 3].map(|threads| {
        let tracer = Tracer::new(&scene, threads).expect("threads start");
        let seen = tracer.camera(view, &|| {});
        let lights = tracer.lights(&seen, Sampling::default(), &|| {});
        (seen, lights)
    });
    assert_eq!(one, three);
}
