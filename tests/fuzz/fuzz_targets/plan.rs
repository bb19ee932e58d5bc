//! Any cameras, lights, settings and bounds: a plan that is made has finite numbers in their documented ranges.

#![no_main]
#![forbid(unsafe_code)]

#[path = "shared/finite.rs"]
mod finite;
#[path = "shared/number.rs"]
mod number;

use arbitrary::Arbitrary;
use glam::{DQuat, DVec3, Vec2, Vec3, Vec4};
use libfuzzer_sys::fuzz_target;
use shadow_math::{
    fit::Subject,
    Bias, Camera, Filter, Light, LightKind, Projection, ShadowSettings, Split,
    bounds::Aabb,
    exposure::Exposure,
    plan::{MAX_VIEWS_PER_LIGHT, ViewPlan, plan_camera, plan_light, view_count},
};
use shadow_scene::{
    FramePlan,
    builder::{Mesh, SceneBuilder},
    scene::{Material, Vertices},
};

use crate::{
    finite::{assert_finite_camera, assert_finite_light, assert_finite_plan, assert_finite_view},
    number::{Number, Vector},
};

/// The largest coordinate, in metres, of the bounds: that of an imported vertex. Any coordinate of the input is cut to it.
const MAX_COORDINATE: f32 = 1e12;

#[derive(Arbitrary, Debug)]
struct Input {
    camera: AnyCamera,
    lights: Vec<AnyLight>,
    /// Corners of the casters' bounds.
    casters: Vec<[Vector; 2]>,
    split_cube: bool,
    filter_hard: bool,
    bias: AnyBias,
    map_size: u16,
    width: u16,
    height: u16,
    ev: Option<Number>,
}

#[derive(Arbitrary, Debug)]
enum AnyCamera {
    LookAt { eye: Vector, target: Vector, projection: AnyProjection },
    Posed { eye: Vector, orientation: [Number; 4], is_normalized: bool, projection: AnyProjection },
}

#[derive(Arbitrary, Debug)]
enum AnyProjection {
    Perspective { vertical_fov: Number, near: Number, far: Option<Number> },
    Orthographic { half_height: Number, near: Number, far: Number },
}

#[derive(Arbitrary, Debug)]
struct AnyLight {
    kind: AnyLightKind,
    color: Vector,
    intensity: Number,
}

#[derive(Arbitrary, Debug)]
enum AnyLightKind {
    Directional { direction: Vector },
    Spot { position: Vector, direction: Vector, inner: Number, outer: Number, range: Option<Number> },
    Point { position: Vector, range: Option<Number> },
}

#[derive(Arbitrary, Debug)]
enum AnyBias {
    None,
    Constant { metres: Number },
    Slope { scale: Number, metres: Number },
    Automatic,
}

fn point(vector: &Vector) -> DVec3 {
    DVec3::from_array(vector.0.map(|number| number.0))
}

fn projection(projection: &AnyProjection) -> Projection {
    match *projection {
        AnyProjection::Perspective { vertical_fov, near, far } => {
            Projection::Perspective { vertical_fov: vertical_fov.0, near: near.0, far: far.map(|far| far.0) }
        }
        AnyProjection::Orthographic { half_height, near, far } => {
            Projection::Orthographic { half_height: half_height.0, near: near.0, far: far.0 }
        }
    }
}

fn camera(camera: &AnyCamera) -> Option<Camera> {
    match camera {
        AnyCamera::LookAt { eye, target, projection: p } => Camera::look_at(point(eye), point(target), projection(p)).ok(),
        AnyCamera::Posed { eye, orientation, is_normalized, projection: p } => {
            let orientation = DQuat::from_array(orientation.map(|number| number.0));
            let orientation = if *is_normalized { orientation.normalize() } else { orientation };
            Some(Camera { eye: point(eye), orientation, projection: projection(p) })
        }
    }
}

fn light(light: &AnyLight) -> Light {
    let range = |range: &Option<Number>| range.map(Number::f32);
    let kind = match &light.kind {
        AnyLightKind::Directional { direction } => LightKind::Directional { direction: direction.vec3() },
        AnyLightKind::Spot { position, direction, inner, outer, range: limit } => LightKind::Spot {
            position: position.vec3(),
            direction: direction.vec3(),
            inner: inner.f32(),
            outer: outer.f32(),
            range: range(limit),
        },
        AnyLightKind::Point { position, range: limit } => LightKind::Point { position: position.vec3(), range: range(limit) },
    };
    Light { kind, color: light.color.vec3(), intensity: light.intensity.f32() }
}

fn settings(input: &Input) -> ShadowSettings {
    ShadowSettings {
        split: if input.split_cube { Split::Cube } else { Split::Single },
        filter: if input.filter_hard { Filter::Hard } else { Filter::Bilinear },
        bias: match input.bias {
            AnyBias::None => Bias::NONE,
            AnyBias::Automatic => Bias::Automatic,
            AnyBias::Constant { metres } => Bias::constant(metres.f32()),
            AnyBias::Slope { scale, metres } => Bias::slope(scale.f32(), metres.f32()),
        },
        map_size: input.map_size.into(),
        ..ShadowSettings::default()
    }
}

/// The box between two corners as a scene could have it.
fn bounds([a, b]: &[Vector; 2]) -> Option<Aabb> {
    let limit = Vec3::splat(MAX_COORDINATE);
    let [a, b] = [a.vec3(), b.vec3()].map(|corner| corner.clamp(-limit, limit));
    (a.is_finite() && b.is_finite()).then(|| Aabb::from_points([a, b]))
}

fuzz_target!(|input: Input| {
    let settings = settings(&input);
    let casters: Vec<Aabb> = input.casters.iter().filter_map(bounds).collect();
    let all = casters.iter().copied().fold(Aabb::EMPTY, Aabb::union);
    let lights: Vec<Light> = input.lights.iter().map(light).collect();
    let camera = camera(&input.camera);

    for light in &lights {
        let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
        if let Ok(plan) = plan_light(light, &Subject::unseen(&casters, all), &settings, [7, 7], &mut views) {
            assert_finite_light(&plan);
            let count = plan.view_count as usize;
            assert_eq!(Ok(count), view_count(light, &settings));
            for (index, view) in views[..count].iter().enumerate() {
                assert_finite_view(view);
                assert_eq!(view.layer, 7 + index as u32);
            }
            assert!(views[count..].iter().all(|view| *view == ViewPlan::default()));
        }
    }
    let (width, height) = (input.width.into(), input.height.into());
    if let Some(camera) = &camera
        && let Ok(plan) = plan_camera(camera, width, height, Exposure::default(), 0)
    {
        assert_finite_camera(&plan);
    }

    // The same through a scene, which checks its parts itself.
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let white = builder.add_material(Material::white());
    for caster in &casters {
        let mesh = Mesh {
            vertices: Vertices {
                positions: vec![caster.min, caster.max, caster.center()],
                normals: vec![Vec3::Y; 3],
                uvs: vec![Vec2::ZERO; 3],
                colors: vec![Vec4::ONE; 3],
            },
            triangles: vec![[0, 1, 2]],
        };
        builder.add_instance("caster", white, mesh).expect("the caster is finite");
    }
    for light in lights {
        builder.add_light("light", light);
    }
    if let Some(camera) = camera {
        builder.add_camera("camera", camera);
    }
    let Ok(scene) = builder.build() else { return };
    let camera = scene.cameras()[0].camera;
    if let Ok(plan) = FramePlan::new(&scene, &camera, &settings, width, height, input.ev.map(Number::f32)) {
        assert_finite_plan(&plan);
    }
});
