//! Pictures that spot lights project.

use glam::{DVec3, Vec3};
use shadow_math::{Camera, Light, LightKind, PlanError, Projection, ShadowSettings};
use shadow_scene::{
    Frame, FramePlan, FramePlanError, Image, Material, Request, Scene, SceneBuilder, SceneLight, builtin::shapes,
    compare::Contract,
};
use shadow_tests::renderers::{self, contract, counterpart};

/// How wide half of the picture is on the floor, in metres: the tangent of the cone's angle at one metre of height.
const HALF: f32 = 1.0;
/// The light's height over the floor, in metres.
const HEIGHT: f32 = 4.0;

/// A floor under a lamp, whose picture is red, green, blue and white in its quarters, row by row.
fn floor(picture: bool) -> Scene {
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let white = builder.add_material(Material::white());
    builder.add_instance("floor", white, shapes::plane(Vec3::ZERO, Vec3::Y, 3.0)).expect("the floor is whole");
    let scene = builder.build().expect("there is a floor");
    let quarters = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    let texels = (0..64).map(|index| quarters[index / 32 * 2 + index % 8 / 4]).collect();
    let (scene, image) = scene.with_image(Image { width: 8, height: 8, texels });
    let kind = LightKind::Spot {
        position: Vec3::new(0.0, HEIGHT, 0.0),
        direction: Vec3::NEG_Y,
        inner: 0.2,
        outer: (HALF / HEIGHT).atan(),
        range: None,
    };
    let kind = if picture { kind } else { LightKind::Point { position: Vec3::Y, range: None } };
    let light = Light { kind, color: Vec3::ONE, intensity: 100.0 };
    scene.with_lights(vec![SceneLight { picture: Some(image), ..SceneLight::new("lamp", light) }])
}

fn frames(scene: &Scene) -> [Frame; 2] {
    // From above, so that a pixel is a place on the floor: x to the right and z downward, two metres to each side.
    let camera = Camera {
        eye: DVec3::new(0.0, 10.0, 0.0),
        orientation: glam::DQuat::from_rotation_x(-core::f64::consts::FRAC_PI_2),
        projection: Projection::Orthographic { half_height: 2.0, near: 1.0, far: 20.0 },
    };
    let plan = FramePlan::new(scene, &camera, &ShadowSettings::default(), 200, 200, Some(5.0)).expect("it can be planned");
    let on_cpu = counterpart().render(&counterpart().prepare(scene), &plan, Request::ALL).expect("it can be rendered").frame;
    let uploaded = pollster::block_on(renderers::gpu().upload(scene)).expect("it fits");
    [on_cpu, pollster::block_on(renderers::gpu().render(&uploaded, &plan, Request::ALL)).expect("it fits").frame]
}

#[test]
fn a_picture_lies_where_its_cone_is() {
    let scene = floor(true);
    let frames = frames(&scene);
    if contract() == Contract::Exact {
        assert!(frames[0].color() == frames[1].color(), "both renderers project it alike");
    }
    let color = frames[0].color().expect("it was asked for");
    // The picture's up is the view's: for a light that looks straight down, the way that its rotation says.
    let rotation = shadow_math::camera::world_from_view_rotation(DVec3::NEG_Y);
    let (right, up) = (rotation * DVec3::X, rotation * DVec3::Y);
    for (u, v, lit) in [(-0.5, 0.5, [0]), (0.5, 0.5, [1]), (-0.5, -0.5, [2])] {
        let place = (right * u + up * v) * f64::from(HALF) * 0.9;
        let pixel = |metres: f64| ((metres + 2.0) * 50.0) as usize;
        let [r, g, b, _] = color[pixel(place.z) * 200 + pixel(place.x)];
        let channels = [r, g, b];
        let brightest = (0..3).max_by(|&a, &b| channels[a].total_cmp(&channels[b])).expect("there are three");
        assert_eq!([brightest], lit, "{u} {v}: {channels:?}");
    }
}

#[test]
fn a_light_without_a_square_projects_no_picture() {
    let scene = floor(false);
    let camera = scene.cameras()[0].camera;
    let error =
        FramePlan::new(&scene, &camera, &ShadowSettings::default(), 16, 16, None).expect_err("a point light has no square");
    assert!(matches!(error, FramePlanError::Light { source: PlanError::PictureOfOtherLight, .. }), "{error}");
    assert!(error.to_string().contains("spot light"), "{error}");
}
