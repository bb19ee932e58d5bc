//! What the fits are made of, so that a slower part can be told from the others: `cargo bench -p shadow-math`.
//!
//! Each is done at most a few times a light and frame. The targets beside some are for a desktop's core of 2020 or later; nothing fails where one is missed.

use divan::{Bencher, Divan, black_box};
use shadow_math::{
    Camera, Cascades, Fit, Light, LightKind, Projection, ShadowSettings, Split,
    bounds::Aabb,
    fit::{
        Content, Eye, LightFrame, Subject, directional_view, focused_view, lispsm_view, optimal_warp, plane_depth_factor,
        plane_optimal,
    },
    frustum::Frustum,
    glam::{DMat3, DVec2, DVec3, DVec4, Vec3},
    plan::{MAX_VIEWS_PER_LIGHT, ViewPlan, plan_light},
    polytope::{MAX_VERTICES, Polytope, shadow_planes},
    rectangle::{convex_hull, smallest_rectangle},
};

fn main() {
    Divan::default().config_with_args().main();
}

/// A view from the ground along a street of houses.
fn frustum() -> Frustum {
    let projection = Projection::Perspective { vertical_fov: 1.0, near: 0.1, far: Some(200.0) };
    let camera =
        Camera::look_at(DVec3::new(-20.0, 1.7, 5.0), DVec3::new(30.0, 4.0, -8.0), projection).expect("it looks somewhere");
    Frustum::slice(&camera, 16.0 / 9.0, 0.1, 200.0).expect("the slice has two ends")
}

/// The street, and the houses in it.
const BOUNDS: Aabb = Aabb::new(Vec3::new(-60.0, 0.0, -40.0), Vec3::new(90.0, 25.0, 40.0));
const CASTERS: Aabb = Aabb::new(Vec3::new(-55.0, 0.0, -12.0), Vec3::new(70.0, 22.0, 30.0));
/// Toward the sun.
const SUN: DVec3 = DVec3::new(0.3, 0.8, -0.2);

fn body() -> Polytope {
    let mut body = Polytope::from_frustum(&frustum());
    body.clip_to_bounds(BOUNDS);
    let (planes, count) = shadow_planes(CASTERS, SUN.extend(0.0));
    planes[..count].iter().for_each(|plane| body.clip(*plane));
    body
}

/// A camera's frustum as a body.
#[divan::bench]
fn frustum_body(bencher: Bencher<'_, '_>) {
    let frustum = frustum();
    bencher.bench_local(|| Polytope::from_frustum(black_box(&frustum)));
}

/// A camera's frustum cut by a box and by the nine planes of another one's shadow volume.
#[divan::bench]
fn clip(bencher: Bencher<'_, '_>) {
    assert!(body().vertices().len() > 8, "the planes cut it");
    let frustum = frustum();
    bencher.bench_local(|| {
        let mut body = Polytope::from_frustum(black_box(&frustum));
        body.clip_to_bounds(black_box(BOUNDS));
        let (planes, count) = shadow_planes(black_box(CASTERS), black_box(SUN.extend(0.0)));
        planes[..count].iter().for_each(|plane| body.clip(*plane));
        body
    });
}

/// The hull, and the smallest rectangle around it, of that body as the light sees it.
#[divan::bench]
fn rectangle(bencher: Bencher<'_, '_>) {
    let body = body();
    let (x, y) = SUN.normalize().any_orthonormal_pair();
    let seen = DMat3::from_cols(x, y, SUN).transpose();
    bencher.bench_local(|| {
        let (mut points, mut hull) = ([DVec2::ZERO; MAX_VERTICES], [DVec2::ZERO; MAX_VERTICES]);
        let vertices = black_box(&body).vertices();
        for (point, vertex) in points.iter_mut().zip(vertices) {
            *point = (seen * *vertex).truncate();
        }
        let len = convex_hull(&mut points[..vertices.len()], &mut hull);
        smallest_rectangle(&hull[..len])
    });
}

/// The street's light, camera and casters, as a light's plan is made from them.
struct Street {
    casters: Vec<Aabb>,
    eye: Eye<'static>,
    frame: LightFrame,
}

/// The houses, of which there are so many.
fn street(count: usize) -> Street {
    let projection = Projection::Perspective { vertical_fov: 1.0, near: 0.1, far: Some(200.0) };
    let camera =
        Camera::look_at(DVec3::new(-20.0, 1.7, 5.0), DVec3::new(30.0, 4.0, -8.0), projection).expect("it looks somewhere");
    let house = |i: usize| {
        let place = Vec3::new(-55.0 + 12.0 * (i % 10) as f32, 0.0, -12.0 + 4.0 * (i / 10) as f32);
        Aabb::new(place, place + Vec3::new(9.0, 4.0 + (i % 7) as f32, 3.0))
    };
    let casters = if count == 1 { vec![CASTERS] } else { (0..count).map(house).collect() };
    let eye = Eye { camera, aspect: 16.0 / 9.0, samples: &[], plane: Some(DVec4::Y) };
    Street { casters, eye, frame: LightFrame::parallel(-SUN.as_vec3()) }
}

/// How many casters scenes have.
const COUNTS: [usize; 2] = [1, 100];

/// A matrix around all that the light reaches. Target: 1 microsecond.
#[divan::bench]
fn uniform_matrix(bencher: Bencher<'_, '_>) {
    bencher.bench_local(|| directional_view(black_box(-SUN.as_vec3()), black_box(BOUNDS), 2048, 4));
}

/// The smallest window of a body that is given. Target: 10 microseconds.
#[divan::bench(args = COUNTS)]
fn focused_matrix(bencher: Bencher<'_, '_>, count: usize) {
    let (street, body) = (street(count), body());
    let content = Content::new(body.vertices(), &street.casters);
    bencher.bench_local(|| focused_view(black_box(&street.frame), black_box(&content), 2048, 4));
}

/// A warp of a body that is given: its parameter and its matrix. Target: 1 microsecond with one caster.
#[divan::bench(args = COUNTS)]
fn lispsm_matrix(bencher: Bencher<'_, '_>, count: usize) {
    let (street, body) = (street(count), body());
    let content = Content::new(body.vertices(), &street.casters);
    bencher.bench_local(|| {
        let warp = optimal_warp(black_box(&street.frame), black_box(&street.eye), content.points).expect("the sun stands aside");
        lispsm_view(&street.frame, street.eye.camera.eye, warp, black_box(&content), 2048, 4)
    });
}

/// The rows of a plane and its view, but for the depth that casters take. Target: 1 microsecond.
#[divan::bench]
fn plane_optimal_matrix(bencher: Bencher<'_, '_>) {
    let street = street(1);
    bencher.bench_local(|| {
        let rows = plane_optimal(black_box(&street.eye), DVec4::Y, street.frame.light()).expect("the floor is seen");
        rows.view(&street.eye, -0.01, 2048)
    });
}

/// The depth that casters over a plane take.
#[divan::bench(args = COUNTS)]
fn plane_optimal_depth(bencher: Bencher<'_, '_>, count: usize) {
    let street = street(count);
    let rows = plane_optimal(&street.eye, DVec4::Y, street.frame.light()).expect("the floor is seen");
    bencher.bench_local(|| plane_depth_factor(black_box(&rows), black_box(&street.casters)));
}

/// A whole plan of four cascades.
fn plan_cascades(bencher: Bencher<'_, '_>, count: usize, fit: Fit, stabilised: bool) {
    let street = street(count);
    let sun = Light { kind: LightKind::Directional { direction: -SUN.as_vec3() }, color: Vec3::ONE, intensity: 1.0 };
    let settings = ShadowSettings {
        fit,
        split: Split::Cascades(Cascades { stabilised, ..Cascades::default() }),
        ..ShadowSettings::default()
    };
    let subject = Subject { eye: Some(street.eye), ..Subject::unseen(&street.casters, BOUNDS) };
    let mut views = [ViewPlan::default(); MAX_VIEWS_PER_LIGHT];
    bencher.bench_local(|| {
        plan_light(black_box(&sun), black_box(&subject), black_box(&settings), [0, 0], &mut views).expect("it can be planned")
    });
}

/// Four cascades around spheres, with all else that a plan has. Target: 5 microseconds.
#[divan::bench(args = COUNTS)]
fn plan_of_stabilised_cascades(bencher: Bencher<'_, '_>, count: usize) {
    plan_cascades(bencher, count, Fit::Uniform, true);
}

/// Four cascades around what is seen, bodies and all. Target: 40 microseconds.
#[divan::bench(args = COUNTS)]
fn plan_of_focused_cascades(bencher: Bencher<'_, '_>, count: usize) {
    plan_cascades(bencher, count, Fit::Focused, false);
}
