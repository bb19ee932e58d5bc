//! Aliasing: stretches and wasted texels that geometry knows, and the program's views of them.

use core::f64::consts::FRAC_PI_2;

use glam::{DQuat, DVec3, Vec3};
use shadow_cpu::measure::{AliasingStatistics, FrameAliasing, LightAliasing, MIN_COSINE, NO_STRETCH};
use shadow_math::{Camera, Cascades, Light, LightKind, Projection, ShadowSettings, Split};
use shadow_scene::{FramePlan, Material, Mesh, NO_TRIANGLE, Request, Scene, SceneBuilder, SceneLight, builtin, builtin::shapes};
use shadow_tests::{lights, renderers::cpu};

use crate::program::Folder;

/// Width and height of the floor, in metres.
const FLOOR: f64 = 8.0;
/// Width and height of the map, in texels.
const MAP: u32 = 512;
/// Width and height of the picture, in pixels.
const WIDTH: u32 = 160;
const HEIGHT: u32 = 120;
/// How far numbers may be off that hold for exact rows, as a share: rows are rounded to f32, by `2^-24` of terms that are some times larger than what they add up to.
const ROUNDING: f64 = 1e-5;

/// A floor under a sun.
fn floor_under(direction: Vec3) -> Scene {
    scene_under(direction, &[("floor", shapes::plane(Vec3::ZERO, Vec3::Y, 0.5 * FLOOR as f32))])
}

/// Things under a sun.
fn scene_under(direction: Vec3, meshes: &[(&str, Mesh)]) -> Scene {
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let white = builder.add_material(Material::white());
    for (name, mesh) in meshes {
        builder.add_instance(*name, white, mesh.clone()).expect("it is whole");
    }
    builder.add_light("sun", Light { kind: LightKind::Directional { direction }, color: Vec3::ONE, intensity: 1e5 });
    builder.build().expect("the scene is whole")
}

/// A camera straight above a place of the floor that sees `half_height` metres to either side of it.
fn above(x: f64, z: f64, half_height: f64) -> Camera {
    Camera {
        eye: DVec3::new(x, 5.0, z),
        orientation: DQuat::from_rotation_x(-FRAC_PI_2),
        projection: Projection::Orthographic { half_height, near: 1.0, far: 10.0 },
    }
}

fn plan(scene: &Scene, camera: &Camera) -> FramePlan {
    let settings = ShadowSettings { map_size: MAP, ..ShadowSettings::default() };
    FramePlan::new(scene, camera, &settings, WIDTH, HEIGHT, None).expect("the scene can be planned")
}

/// The triangles that a plan's camera sees.
fn triangles(scene: &Scene, plan: &FramePlan) -> Vec<u32> {
    let request = Request { camera: true, ..Request::default() };
    let frame = cpu().render(&cpu().prepare(scene), plan, request).expect("the picture fits").frame;
    frame.triangles().expect("the layer was asked for").to_vec()
}

/// The aliasing of a scene's first light, and of all.
fn measured(scene: &Scene, plan: &FramePlan) -> (LightAliasing, AliasingStatistics) {
    let FrameAliasing { lights, total } = FrameAliasing::of(scene, plan, &triangles(scene, plan), 0).expect("threads start");
    (lights.into_iter().next().expect("there is a light"), total)
}

/// How many texels an interval of a length meets, at least and at most: it can begin anywhere within one, and end within another.
fn whole_texels(length: f64) -> [f64; 2] {
    [length * (1.0 - ROUNDING), length + 2.0]
}

/// Straight from above, under a sun overhead, every texel is as wide in the picture as on the floor; a floor that the camera sees a part of has its texels seen in that part.
#[test]
fn a_floor_from_above_has_the_stretch_of_its_texels() {
    let scene = floor_under(Vec3::NEG_Y);
    for (x, z, half_height) in [(0.0, 0.0, 1.0), (-1.2, 0.7, 0.31), (0.4, -0.3, 2.0)] {
        let plan = plan(&scene, &above(x, z, half_height));
        let (LightAliasing { statistics, stretches }, total) = measured(&scene, &plan);
        let texel = plan.views[0].texel_metres.map(f64::from);
        // The floor fills the map but for some texels on every side that lookups at its rim need.
        assert!((texel[0] / (FLOOR / f64::from(MAP)) - 1.0).abs() < 0.05 && (texel[0] / texel[1] - 1.0).abs() < ROUNDING);
        let pixel = 2.0 * half_height / f64::from(HEIGHT);
        let m = texel[0].max(texel[1]) / pixel;
        assert!(stretches.iter().all(|&stretch| (f64::from(stretch) / m - 1.0).abs() < ROUNDING), "{m}");
        let AliasingStatistics { pixels, grazing, median, percentile_95, max, above_one, texels, .. } = statistics;
        assert_eq!((pixels, grazing, texels), (u64::from(WIDTH * HEIGHT), 0, u64::from(MAP * MAP)));
        assert_eq!(above_one, if m > 1.0 { pixels } else { 0 });
        for number in [median, percentile_95, max] {
            assert!((f64::from(number) / m - 1.0).abs() < ROUNDING, "{number} instead of {m}");
        }
        assert_eq!(statistics, total);

        let seen = [f64::from(WIDTH) * pixel / texel[0], f64::from(HEIGHT) * pixel / texel[1]].map(whole_texels);
        let share = |at_most: usize| seen[0][at_most] * seen[1][at_most] / f64::from(MAP * MAP);
        let waste = statistics.waste();
        assert!(
            (1.0 - share(1)..=1.0 - share(0)).contains(&waste),
            "{waste} instead of {} to {}",
            1.0 - share(1),
            1.0 - share(0)
        );
    }
}

/// A camera that sees more than the floor wastes the rim of the map alone, and has no number where there is nothing.
#[test]
fn what_shows_nothing_has_no_stretch() {
    let scene = floor_under(Vec3::NEG_Y);
    let plan = plan(&scene, &above(0.0, 0.0, 6.0));
    let (LightAliasing { statistics, stretches }, _) = measured(&scene, &plan);
    let triangles = triangles(&scene, &plan);
    let is_empty = |(stretch, triangle): (&f32, &u32)| (*stretch == NO_STRETCH) == (*triangle == NO_TRIANGLE);
    assert!(stretches.iter().zip(&triangles).all(is_empty), "exactly what shows nothing has no stretch");
    assert!(triangles.contains(&NO_TRIANGLE));
    let texel = f64::from(plan.views[0].texel_metres[0]);
    // Pixels whose middle is on the floor show it: with half a pixel on either side, up to a pixel more or less.
    let pixel = 12.0 / f64::from(HEIGHT);
    let [least, most] = [whole_texels((FLOOR - pixel) / texel)[0], whole_texels((FLOOR + pixel) / texel)[1]];
    let waste = statistics.waste();
    let range = 1.0 - (most / f64::from(MAP)).powi(2).min(1.0)..=1.0 - (least / f64::from(MAP)).powi(2);
    assert!(range.contains(&waste), "{waste} instead of {range:?}");
}

/// Under a sun that leans, texels are longer along the floor by 1 over the cosine, until it grazes: then they are counted apart. A card high above the floor's corner, which the camera does not see,
/// makes the box that the map is fitted to higher, and its texels no squares.
#[test]
fn a_leaning_sun_makes_texels_longer() {
    for cosine in [0.9, 0.5, 0.2, 0.11, 0.09, 0.02_f64] {
        let across = (1.0 - cosine * cosine).sqrt();
        let floor = shapes::plane(Vec3::ZERO, Vec3::Y, 0.5 * FLOOR as f32);
        let card = shapes::plane(Vec3::new(3.8, 3.0, 3.8), Vec3::Y, 0.1);
        let scene = scene_under(DVec3::new(0.0, -cosine, across).as_vec3(), &[("floor", floor), ("card", card)]);
        let plan = plan(&scene, &above(0.3, -0.2, 1.0));
        let (LightAliasing { statistics, stretches }, _) = measured(&scene, &plan);
        let [width, height] = plan.views[0].texel_metres.map(f64::from);
        let pixel = 2.0 / f64::from(HEIGHT);
        let m = (height / cosine) / pixel;
        assert!(height / cosine > 1.01 * width, "{height} {width}: along the sun's way they are longer");
        // The sun's direction is rounded to f32, which a small cosine has a larger share of.
        let tolerance = ROUNDING / cosine;
        assert!(
            stretches.iter().all(|&stretch| (f64::from(stretch) / m - 1.0).abs() < tolerance),
            "{cosine}: {m} {}",
            stretches[0]
        );
        let all = u64::from(WIDTH * HEIGHT);
        let counted = if cosine > MIN_COSINE { (all, 0) } else { (0, all) };
        assert_eq!((statistics.pixels, statistics.grazing), counted, "{cosine}");
        assert!(statistics.seen_texels > 0, "grazing pixels see texels as well");
        if counted.0 == 0 {
            assert_eq!((statistics.median, statistics.max, statistics.share_above_one()), (0.0, 0.0, 0.0));
        }
    }
}

/// From the lamp's own place a picture is a magnified map, whatever it shows: every texel is as large in it as any other, on surfaces of every slope.
#[test]
fn a_lamp_at_the_eye_has_one_stretch_for_all_surfaces() {
    let position = Vec3::new(0.4, 3.0, 0.6);
    let lamp = Light { kind: LightKind::Point { position, range: None }, color: Vec3::ONE, intensity: 1000.0 };
    let scene = lights::lit_by(&builtin::demo(), "lamp", lamp);
    let camera = Camera {
        eye: position.as_dvec3(),
        orientation: DQuat::from_rotation_x(-FRAC_PI_2),
        projection: Projection::Perspective { vertical_fov: 1.0, near: 0.05, far: None },
    };
    let plan = plan(&scene, &camera);
    let (LightAliasing { statistics, stretches }, _) = measured(&scene, &plan);
    let pixel = 2.0 * 0.5_f64.tan() / f64::from(HEIGHT);
    let m = f64::from(plan.views[3].texel_metres[0]) / pixel;
    let found = stretches.iter().filter(|&&stretch| stretch != NO_STRETCH);
    // Rows are rounded by `2^-24` of 3 m, and what camera and lamp see edge-on has that share of the difference to nothing.
    let is_right = |stretch: &f32| (f64::from(*stretch) / m - 1.0).abs() < 1e-3;
    let (all, right) = (found.clone().count(), found.filter(|stretch| is_right(stretch)).count());
    assert!(all > 10_000 && right * 1000 > all * 999, "{right} of {all} have {m}");
    assert!((f64::from(statistics.median) / m - 1.0).abs() < ROUNDING && is_right(&statistics.percentile_95), "{statistics:?}");
}

/// Where no light arrives, outside a spot light's cone and beyond its range, its map is of no use to anybody.
#[test]
fn what_a_light_does_not_reach_has_no_stretch() {
    let (height, outer) = (3.0_f64, 0.4_f64);
    let spot = |range| LightKind::Spot {
        position: Vec3::Y * height as f32,
        direction: Vec3::NEG_Y,
        inner: 0.0,
        outer: outer as f32,
        range,
    };
    // Without a range the cone's circle is reached, and with one of a little more than the height a smaller circle.
    let range = 3.1_f64;
    for (kind, radius) in
        [(spot(None), height * outer.tan()), (spot(Some(range as f32)), (range * range - height * height).sqrt())]
    {
        let scene = lights::lit_by(&floor_under(Vec3::NEG_Y), "spot", Light { kind, color: Vec3::ONE, intensity: 100.0 });
        let plan = plan(&scene, &above(0.0, 0.0, 1.5));
        let (LightAliasing { statistics, stretches }, _) = measured(&scene, &plan);
        let pixel = 3.0 / f64::from(HEIGHT);
        for (index, &stretch) in stretches.iter().enumerate() {
            let x = (index as u32 % WIDTH) as f64 + 0.5 - 0.5 * f64::from(WIDTH);
            let z = (index as u32 / WIDTH) as f64 + 0.5 - 0.5 * f64::from(HEIGHT);
            let distance = x.hypot(z) * pixel;
            // Angles and ranges are f32.
            if (distance / radius - 1.0).abs() > 1e-4 {
                assert_eq!(stretch != NO_STRETCH, distance < radius, "{distance} of {radius}: {stretch}");
            }
        }
        // The map is the square around the cone, with some texels on every side; of it a circle is seen, with texels that its pixels meet beside it.
        let [width, _] = plan.views[0].texel_metres.map(|metres| f64::from(metres) * height);
        let area = |radius: f64| core::f64::consts::PI * (radius / width).powi(2);
        let seen = statistics.seen_texels as f64;
        assert!(
            (area(radius - pixel)..=area(radius + pixel + 2.0 * width)).contains(&seen),
            "{seen} instead of {}",
            area(radius)
        );
    }
}

/// Of a view that has a part of its layer the rest counts neither as seen nor as wasted.
#[test]
fn a_view_is_as_large_as_its_rectangle() {
    let scene = floor_under(Vec3::NEG_Y);
    let mut plan = plan(&scene, &above(0.0, 0.0, 0.5 * FLOOR * f64::from(HEIGHT) / f64::from(WIDTH)));
    let (whole, _) = measured(&scene, &plan);
    let half = MAP / 2;
    plan.views[0].rect = [half, 0, half, MAP];
    let (LightAliasing { statistics, stretches }, _) = measured(&scene, &plan);
    assert_eq!((statistics.texels, whole.statistics.texels), (u64::from(half * MAP), u64::from(MAP * MAP)));
    // The camera sees the floor in its whole width, and so the halves of the map are alike.
    let difference = 2 * statistics.seen_texels as i64 - whole.statistics.seen_texels as i64;
    assert!(difference.abs() <= 2 * i64::from(MAP), "{difference}: more than a column on either side");
    assert_eq!(
        stretches.iter().filter(|&&stretch| stretch == NO_STRETCH).count() * 2,
        stretches.len(),
        "left of it no map is asked"
    );
}

/// Where two cascades are blended, m lies between theirs, and the texels of both are seen.
#[test]
fn blended_cascades_share_their_stretch() {
    let scene = builtin::demo();
    let cascades = Cascades { count: 2, blend: 1.0, ..Cascades::default() };
    let settings = ShadowSettings { split: Split::Cascades(cascades), map_size: MAP, ..ShadowSettings::default() };
    let blended = FramePlan::new(&scene, &scene.cameras()[0].camera, &settings, WIDTH, HEIGHT, None).expect("it can be planned");
    let with_first = |end: f32| {
        let mut plan = blended.clone();
        plan.lights[0].split_far[0][0] = end;
        plan.lights[0].split_band = [[0.0; 4]; 2];
        measured(&scene, &plan).0
    };
    let (shared, unshared) = (measured(&scene, &blended).0, with_first(blended.lights[0].split_far[0][0]));
    let (first, second) = (with_first(f32::MAX), with_first(0.0));
    let mut between = 0;
    for pixel in 0..shared.stretches.len() {
        let [m, alone, a, b] = [&shared, &unshared, &first, &second].map(|of| of.stretches[pixel]);
        if [m, a, b].contains(&NO_STRETCH) || !m.is_finite() || a == b {
            continue;
        }
        let share = (m - a) / (b - a);
        // m is rounded to f32.
        let rounding = 1e-5 * m / (b - a).abs();
        if alone == a {
            assert!(share > -rounding && share < 1.0 + rounding, "m of {m} between {a} and {b}");
            between += usize::from(share > 0.1 && share < 0.9);
        } else {
            assert!((share - 1.0).abs() < rounding, "the last cascade is blended with none: {m}, {a} and {b}");
        }
    }
    assert!(between > 1000, "{between} pixels lie well between two cascades");
    let [shared, unshared] = [shared, unshared].map(|of| of.statistics.seen_texels);
    assert!(shared > unshared + 1000, "{shared} texels are seen blended, and {unshared} without");
}

/// Without maps there is nothing to measure, and the sums have no part of it.
#[test]
fn a_light_without_maps_has_no_aliasing() {
    let scene = builtin::demo();
    let mut suns = scene.lights().to_vec();
    suns.push(SceneLight { casts_shadows: false, ..suns[0].clone() });
    let scene = scene.with_lights(suns);
    let plan = plan(&scene, &scene.cameras()[0].camera);
    let FrameAliasing { lights, total } = FrameAliasing::of(&scene, &plan, &triangles(&scene, &plan), 0).expect("threads start");
    let last = lights.last().expect("there are lights");
    assert_eq!(last.statistics, AliasingStatistics::default());
    assert!(last.stretches.iter().all(|&stretch| stretch == NO_STRETCH));
    assert_eq!((last.statistics.waste(), last.statistics.share_above_one()), (0.0, 0.0));
    let sum = |number: fn(&AliasingStatistics) -> u64| lights.iter().map(|light| number(&light.statistics)).sum::<u64>();
    assert_eq!(total.pixels, sum(|of| of.pixels));
    assert_eq!((total.above_one, total.grazing), (sum(|of| of.above_one), sum(|of| of.grazing)));
    assert_eq!((total.texels, total.seen_texels), (sum(|of| of.texels), sum(|of| of.seen_texels)));
}

/// Numbers and pixels are the same whatever number of threads finds them, and none of them is NaN.
#[test]
fn aliasing_does_not_depend_on_threads() {
    for (name, light) in lights::one_of_each(&builtin::demo()) {
        let scene = lights::lit_by(&builtin::demo(), name, light);
        let plan = plan(&scene, &scene.cameras()[0].camera);
        let triangles = triangles(&scene, &plan);
        let [one, three] = [1, 3].map(|threads| FrameAliasing::of(&scene, &plan, &triangles, threads).expect("threads start"));
        assert_eq!(one, three, "{name}");
        assert!(one.worst().iter().all(|&stretch| stretch == NO_STRETCH || stretch >= 0.0), "{name}");
        let AliasingStatistics { median, percentile_95, max, .. } = one.total;
        assert!(0.0 < median && median < percentile_95 && percentile_95 < max && max.is_finite(), "{name}: {:?}", one.total);
        let waste = one.total.waste();
        assert!(waste > 0.0 && waste < 1.0, "{name}: {waste}");
    }
}

/// The program draws the heat map of a light, says what it comes to, and knows no other names for it.
#[test]
fn the_program_shows_aliasing() {
    let folder = Folder::new("aliasing");
    let sizes = ["--size", "160x90", "--map-size", "128"];
    let mut pictures = Vec::new();
    for (show, file) in [("aliasing", "first.png"), ("aliasing:1", "second.png")] {
        let output = folder.run(&[&["render", "--show", show, "--output", file], &sizes[..]].concat());
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains("median") && text.contains("seen by none"), "{text}");
        pictures.push(folder.picture(file));
    }
    assert_ne!(pictures[0], pictures[1], "each light has its own");
    let count = |is_so: fn(&image::Rgb<u8>) -> bool| pictures[0].pixels().filter(|pixel| is_so(pixel)).count();
    let dark = count(|pixel| pixel.0 == [24; 3]);
    let long = count(|pixel| pixel[0] > 200 && pixel[2] < 100);
    // With texels of some 10 cm and pixels of a few centimetres there are surfaces of which a texel covers many pixels; above the horizon there is nothing.
    assert!(dark > 1000 && long > 1000, "{dark} dark and {long} red or yellow of {} pixels", 160 * 90);
    let refusal = folder.refusal(&["render", "--show", "aliasing:7"]);
    assert!(refusal.contains('7') && refusal.contains("2 lights"), "{refusal}");
    let refusal = folder.refusal(&["render", "--show", "aliased"]);
    assert!(refusal.contains("aliasing[:LIGHT]"), "{refusal}");
}

/// Larger maps have a smaller m: the report says so in all its forms.
#[test]
fn measure_reports_aliasing() {
    let folder = Folder::new("measure-aliasing");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("the folder can be written to");
    write("small.toml", "map-size = 256\n");
    write("large.toml", "map-size = 1024\n");
    let choices = ["measure", "--settings", "small.toml", "--settings", "large.toml", "--size", "160x90", "--frames", "1"];
    let report = folder.json(&[&choices[..], &["--report", "page", "--json"]].concat());
    let of = |technique: usize, field: &str| {
        report["techniques"][technique]["aliasing"][field].as_f64().expect("every field is a number")
    };
    for technique in [0, 1] {
        assert!(
            of(technique, "median") < of(technique, "percentile_95") && of(technique, "percentile_95") < of(technique, "max")
        );
        assert!(of(technique, "share_above_one") <= 1.0 && of(technique, "pixels") > 1000.0 && of(technique, "grazing") >= 0.0);
        let lights = report["techniques"][technique]["lights"].as_array().expect("there are lights");
        let pixels = lights.iter().filter_map(|light| light["aliasing"]["pixels"].as_f64());
        assert_eq!(pixels.sum::<f64>(), of(technique, "pixels"));
    }
    // A quarter of the width, but for texels that stay free on every side.
    assert!((of(0, "median") / of(1, "median") / 4.0 - 1.0).abs() < 0.1, "{} {}", of(0, "median"), of(1, "median"));
    assert!([0, 1].into_iter().all(|technique| of(technique, "waste") > 0.0 && of(technique, "waste") < 1.0));
    let page = std::fs::read_to_string(folder.path().join("page/index.html")).expect("the page is there");
    assert!(page.contains("<th>m 95 %</th><th>m &gt; 1</th><th>waste</th>") && page.contains("pixels that a texel smears over"));
    let text = String::from_utf8_lossy(&folder.run(&choices).stdout).into_owned();
    assert!(text.contains("m 95 %") && text.contains("m > 1") && text.contains("waste"), "{text}");
}
