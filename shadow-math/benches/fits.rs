//! What the fits are made of, so that a slower part can be told from the others: `cargo bench -p shadow-math`.
//!
//! Each is done at most a few times a light and frame. Nothing here says how long one may take: that is a matter of the machine.

use divan::{Bencher, Divan, black_box};
use shadow_math::{
    Camera, Projection,
    bounds::Aabb,
    frustum::Frustum,
    glam::{DMat3, DVec2, DVec3, Vec3},
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
