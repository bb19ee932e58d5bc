//! Whether shadows stand still while the camera moves and turns.

use glam::{DQuat, DVec3, Vec3};
use shadow_cpu::{
    CpuRenderer, RasterRules,
    measure::{Judge, Moment, Stability},
    renderer::PreparedScene,
    trace::{CameraView, Sampling, SurfacePoint, Tracer},
};
use shadow_math::{Camera, Cascades, Fit, Light, LightKind, ShadowSettings, Split, Store};
use shadow_scene::{FramePlan, Material, Mesh, NO_TRIANGLE, Scene, SceneBuilder, SceneLight, builtin};
use shadow_tests::report::say;

/// The picture, small enough to be traced at every place.
const SIZE: (u32, u32) = (240, 135);
/// How far the scene lies from the world's origin, in metres: nowhere, a town's width, a country's, and the Earth's radius.
const PLACES: [f64; 4] = [0.0, 1e4, 1e5, 6.4e6];
/// How many other poses of the camera there are at each place.
const POSES: u32 = 4;
/// The largest share of points whose shadows may change: of some ten thousand here, none. Single precision moves a map's texels by some hundred-thousandths of their width, which decides one depth test in as many.
const MOST: f64 = 1e-5;

/// The demo under a sun, with the scene's origin so far from the world's.
fn demo_at(distance: f64) -> Scene {
    let demo = builtin::by_name("demo").expect("it is listed");
    let mut builder = SceneBuilder::new(DVec3::new(distance, 0.25 * distance, -0.5 * distance));
    let material = builder.add_material(Material::white());
    let mesh = Mesh { vertices: demo.vertices().clone(), triangles: demo.triangles().to_vec() };
    builder.add_instance("demo", material, mesh).expect("the demo's mesh is sound");
    let kind = LightKind::Directional { direction: Vec3::new(0.45, -1.0, 0.3) };
    builder.add_light("sun", Light { kind, color: Vec3::ONE, intensity: 50_000.0 });
    builder.add_camera("main", demo.cameras()[0].camera);
    builder.build().expect("the demo is a scene")
}

/// A number from -1 to 1 that a place, a pose and an axis have.
fn noise(seed: u32) -> f64 {
    let mut bits = seed.wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
    bits = (bits ^ (bits >> 15)).wrapping_mul(0x2c1b_3c6d);
    bits = (bits ^ (bits >> 12)).wrapping_mul(0x297a_2d39);
    f64::from(bits ^ (bits >> 15)) / f64::from(u32::MAX) * 2.0 - 1.0
}

/// How far a camera moves, in metres, and turns, in radians, on each axis at most.
#[derive(Clone, Copy)]
struct Motion {
    step: f64,
    turn: f64,
}

/// Less than a texel of the nearest cascade's map, and a quarter of a degree.
const NUDGE: Motion = Motion { step: 0.003, turn: 0.25 * core::f64::consts::PI / 180.0 };
/// Hundreds of texels, and eight degrees: most of the picture stays in view.
const WALK: Motion = Motion { step: 1.5, turn: 8.0 * core::f64::consts::PI / 180.0 };

fn moved(camera: &Camera, motion: Motion, seed: u32) -> Camera {
    let of = |axis: u32| noise(16 * seed + axis);
    let step = DVec3::new(of(0), of(1), of(2)) * motion.step;
    let turn = DQuat::from_scaled_axis(DVec3::new(of(3), of(4), of(5)) * motion.turn);
    Camera { eye: camera.eye + step, orientation: (turn * camera.orientation).normalize(), ..*camera }
}

struct Watch<'a> {
    scene: &'a Scene,
    renderer: &'a CpuRenderer,
    prepared: &'a PreparedScene<'a>,
    tracer: &'a Tracer<'a>,
    points: Vec<SurfacePoint>,
}

impl Watch<'_> {
    /// What changes between the scene's camera and some that have moved.
    fn stability(&self, settings: &ShadowSettings, motion: Motion, first_seed: u32) -> Stability {
        let plan = |camera: &Camera| {
            FramePlan::new(self.scene, camera, settings, SIZE.0, SIZE.1, None).expect("the scene can be planned")
        };
        let camera = self.scene.cameras()[0].camera;
        let before_plan = plan(&camera);
        let before_maps = self.renderer.shadow_maps(self.prepared, &before_plan);
        let lights: &[SceneLight] = self.scene.lights();
        let before = Moment { plan: &before_plan, maps: &before_maps, lights };
        (0..POSES).fold(Stability::default(), |sum, pose| {
            let plan = plan(&moved(&camera, motion, first_seed + pose));
            let maps = self.renderer.shadow_maps(self.prepared, &plan);
            let found = Stability::between(self.tracer, &self.points, &before, &Moment { plan: &plan, maps: &maps, lights });
            Stability {
                compared: sum.compared + found.compared,
                changed: sum.changed + found.changed,
                other_maps: sum.other_maps + found.other_maps,
                out_of_view: sum.out_of_view + found.out_of_view,
            }
        })
    }
}

#[test]
fn stabilised_cascades_stand_still_wherever_the_scene_is() {
    let renderer = CpuRenderer::new(2, RasterRules::default()).expect("the threads start");
    let settings = |fit, stabilised| {
        let cascades = Cascades { stabilised, ..Cascades::default() };
        ShadowSettings {
            fit,
            split: Split::Cascades(cascades),
            map_size: 1024,
            shadow_distance: Some(25.0),
            ..ShadowSettings::default()
        }
    };
    let mut lines = String::new();
    for (index, distance) in (0..).zip(PLACES) {
        let scene = demo_at(distance);
        let camera = scene.cameras()[0].camera;
        let tracer = Tracer::new(&scene, 2).expect("the threads start");
        let view = CameraView::new(&camera, SIZE.0, SIZE.1);
        let judge = Judge::new(&tracer, view, Sampling::default(), &|| {});
        let hits = judge.seen().hits.iter().enumerate().filter(|(_, hit)| hit.triangle != NO_TRIANGLE);
        let points = hits
            .map(|(pixel, hit)| tracer.surface_point(hit, judge.seen().view.ray(pixel as u32 % SIZE.0, pixel as u32 / SIZE.0)));
        let points: Vec<SurfacePoint> = points.collect();
        assert!(points.len() > 10_000, "{} points are watched", points.len());
        let prepared = renderer.prepare(&scene);
        let watch = Watch { scene: &scene, renderer: &renderer, prepared: &prepared, tracer: &tracer, points };
        // Steps of 16 bits of what is seen are counted from the world's origin, too.
        let pancaked = ShadowSettings { pancake: true, store: Store::Depth16, ..settings(Fit::Uniform, true) };
        let pancaked = watch.stability(&pancaked, WALK, 100 * index);
        let here = watch.stability(&settings(Fit::Uniform, true), NUDGE, 100 * index);
        let walked = watch.stability(&settings(Fit::Uniform, true), WALK, 100 * index);
        let beside = watch.stability(&settings(Fit::Focused, false), NUDGE, 100 * index);
        lines += &format!(
            "{distance:e} m: {} of {} change ({:.1e}), {} ask another cascade; {} of {} after a walk, {} pancaked to 16 bits; tight cascades: {:.1e}\n",
            here.changed,
            here.compared,
            here.score(),
            here.other_maps,
            walked.changed,
            walked.compared,
            pancaked.changed,
            beside.score()
        );
        assert!(here.compared > 10_000, "{lines}");
        assert!(here.score() <= MOST && walked.score() <= MOST && pancaked.score() <= MOST, "{lines}");
        assert!(walked.compared > 5_000, "{lines}");
        // The tight fit is what this is better than: were it to stand still, nothing would have been tested.
        assert!(beside.score() > 100.0 * MOST, "{lines}");
    }
    say(&format!("stabilised_cascades_stand_still_wherever_the_scene_is:\n{lines}"));
}
