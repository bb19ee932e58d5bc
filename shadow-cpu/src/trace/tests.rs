//! The tree against every triangle in turn, and rays aimed at what a crack would let through.

use glam::{DVec3, Quat, Vec3};
use proptest::prelude::*;
use shadow_scene::{Material, Mesh, Pass, Scene, SceneBuilder, Vertices, builtin::shapes};

use super::{Hit, Ray, Tracer, triangle::ShearedRay};

fn scene(mesh: Mesh) -> Scene {
    let mut builder = SceneBuilder::new(DVec3::ZERO);
    let material = builder.add_material(Material { double_sided: true, ..Material::white() });
    builder.add_instance("mesh", material, mesh).expect("the mesh is whole");
    builder.build().expect("the scene is whole")
}

/// Triangles without shared corners.
fn soup(corners: &[Vec3]) -> Mesh {
    let count = corners.len();
    let vertices = Vertices {
        positions: corners.to_vec(),
        normals: vec![Vec3::Y; count],
        uvs: vec![glam::Vec2::ZERO; count],
        colors: vec![glam::Vec4::ONE; count],
    };
    let triangles = (0..count as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { vertices, triangles }
}

/// The nearest hit, by asking every triangle.
fn closest_of_all(tracer: &Tracer<'_>, ray: Ray) -> Option<Hit> {
    let sheared = ShearedRay::new(ray);
    let drawn = Pass::ALL.into_iter().flat_map(|pass| tracer.scene().pass_triangles(pass));
    let hits = drawn.filter_map(|i| sheared.meet(i, tracer.corners(i)));
    hits.min_by(|a, b| a.distance.total_cmp(&b.distance).then(a.triangle.cmp(&b.triangle)))
}

/// A coordinate that meets others often, one of any size, or one near another.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![(-4..5_i32).prop_map(|x| x as f32), -4.0..4.0_f32, -1000.0..1000.0_f32, (-4..5_i32).prop_map(|x| x as f32 + 1e-6)]
}

fn point() -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(coordinate()).prop_map(Vec3::from)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, ..ProptestConfig::default() })]

    /// Whatever the tree leaves out, no triangle would have been met: the two agree to the bit.
    #[test]
    fn the_tree_finds_what_every_triangle_would_say(
        corners in prop::collection::vec(point(), 3..150),
        ends in prop::collection::vec((point(), point()), 20),
        aims in prop::collection::vec((point(), 0_usize..1000, 0_usize..1000), 20),
    ) {
        let scene = scene(soup(&corners[..corners.len() / 3 * 3]));
        let tracer = Tracer::new(&scene, 1).expect("a thread starts");
        let mut rays = tracer.rays();
        let between = ends.into_iter().map(|(from, to)| Ray::between(from.as_dvec3(), to.as_dvec3()));
        // Rays through corners and through the middle of edges, of which some begin on a corner.
        let aimed = aims.into_iter().flat_map(|(from, a, b)| {
            let (a, b) = (corners[a % corners.len()].as_dvec3(), corners[b % corners.len()].as_dvec3());
            [Ray::along(from.as_dvec3(), a - from.as_dvec3()), Ray::along(a, 0.5 * (a + b) - from.as_dvec3()), Ray::between(a, b)]
        });
        for ray in between.chain(aimed) {
            let expected = closest_of_all(&tracer, ray);
            prop_assert_eq!(rays.closest(ray), expected, "{:?}", ray);
            prop_assert_eq!(rays.is_blocked(ray), expected.is_some(), "{:?}", ray);
        }
    }

    /// A ray that leaves a surface does not meet the triangle that it leaves, nor one that continues its plane, at any angle.
    #[test]
    fn no_surface_hides_the_light_from_itself(
        corners in prop::array::uniform3(point()),
        shift in 0.0..1000.0_f32,
        at in prop::array::uniform2(0.0..1.0_f64),
        toward in prop::array::uniform3(-1.0..1.0_f64),
        grazing in prop_oneof![Just(1.0), Just(1e-3), Just(1e-6), Just(1e-9), Just(1e-12)],
    ) {
        let corners = corners.map(|corner| corner + shift);
        // The parallelogram of the triangle and its mirror image: where its fourth corner is exact, both halves lie on one plane.
        let fourth = corners[1] + corners[2] - corners[0];
        let is_exact = fourth.as_dvec3() == corners[1].as_dvec3() + corners[2].as_dvec3() - corners[0].as_dvec3();
        let mut all = corners.to_vec();
        if is_exact {
            all.extend([corners[1], fourth, corners[2]]);
        }
        let normal = (corners[1] - corners[0]).as_dvec3().cross((corners[2] - corners[0]).as_dvec3());
        let scene = scene(soup(&all));
        // A needle is not there to hide anything.
        prop_assume!(!scene.pass_triangles(Pass::OpaqueDoubleSided).is_empty() && scene.triangles()[0] == [0, 1, 2]);
        let tracer = Tracer::new(&scene, 1).expect("a thread starts");
        let hit = Hit { triangle: 0, distance: 1.0, u: at[0], v: at[1] * (1.0 - at[0]), is_back: false };
        let point = tracer.surface_point(&hit, Ray::along(DVec3::ZERO, -normal));
        let along = DVec3::from(toward).reject_from(normal);
        let direction = along + point.normal * (grazing * along.length());
        let ray = point.along(direction);
        prop_assume!(ray.is_some());
        let mut rays = tracer.rays();
        prop_assert!(ray.is_some_and(|ray| !rays.is_blocked(ray)), "{:?} along {}", point, direction);
    }
}

proptest! {
    /// A light may lie on a surface, as on a ceiling: rounding decides on which side, and must not make it dark.
    #[test]
    fn a_surface_does_not_hide_a_light_that_lies_on_it(
        corners in prop::array::uniform3(point()),
        from in point(),
        at in prop::array::uniform2(0.0..1.0_f64),
    ) {
        let scene = scene(soup(&corners));
        let tracer = Tracer::new(&scene, 1).expect("a thread starts");
        let [v0, v1, v2] = corners.map(Vec3::as_dvec3);
        let light = v0 + (v1 - v0) * at[0] + (v2 - v0) * (at[1] * (1.0 - at[0]));
        prop_assert!(!tracer.rays().is_blocked(Ray::between(from.as_dvec3(), light)));
    }
}

/// Rays from inside closed bodies through every corner, and through points of every edge, end on the body.
#[test]
fn no_ray_slips_through_a_closed_mesh() {
    let bodies = [
        ("sphere", shapes::sphere(Vec3::ZERO, 1.0, 48), Vec3::ZERO),
        ("sphere far from the origin", shapes::sphere(Vec3::new(900.0, -700.0, 300.0), 1.0, 48), Vec3::new(900.0, -700.0, 300.0)),
        ("box", shapes::cuboid(Vec3::ONE, Vec3::new(1.0, 0.5, 3.0), Quat::from_rotation_y(0.3)), Vec3::ONE),
        ("box along the axes", shapes::cuboid(Vec3::ZERO, Vec3::ONE, Quat::IDENTITY), Vec3::ZERO),
    ];
    for (name, mesh, middle) in bodies {
        let scene = scene(mesh);
        let tracer = Tracer::new(&scene, 1).expect("a thread starts");
        let mut rays = tracer.rays();
        let positions = &scene.vertices().positions;
        let mut count = 0;
        for offset in [DVec3::ZERO, DVec3::new(0.1, 0.03, -0.2)] {
            let eye = middle.as_dvec3() + offset;
            for triangle in scene.triangles() {
                for corner in 0..3 {
                    let a = positions[triangle[corner] as usize].as_dvec3();
                    let b = positions[triangle[(corner + 1) % 3] as usize].as_dvec3();
                    for share in [0.0, 0.5, 1.0 / 3.0, 0.999_999, 1e-12] {
                        count += 1;
                        let ray = Ray::along(eye, a + (b - a) * share - eye);
                        assert!(rays.closest(ray).is_some() && rays.is_blocked(ray), "{name}: {ray:?} slips through at {share}");
                    }
                }
            }
        }
        assert!(count >= 360, "{name}: {count} rays");
    }
}

#[test]
fn what_cannot_be_met_is_not() {
    let flat = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::Y, Vec3::Y, Vec3::Y];
    let scene = scene(soup(&flat));
    let tracer = Tracer::new(&scene, 1).expect("a thread starts");
    assert_eq!((tracer.triangle_count(), scene.triangles().len()), (0, 2), "triangles without an area are not there");
    assert_eq!(tracer.rays().closest(Ray::along(DVec3::NEG_X, DVec3::X)), None);

    let wall = self::scene(soup(&[Vec3::new(1.0, -9.0, -9.0), Vec3::new(1.0, 9.0, -9.0), Vec3::new(1.0, 0.0, 9.0)]));
    let tracer = Tracer::new(&wall, 1).expect("a thread starts");
    let mut rays = tracer.rays();
    assert!(rays.is_blocked(Ray::along(DVec3::ZERO, DVec3::X)), "a ray that has a direction meets it");
    for direction in
        [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::new(f64::INFINITY, 0.0, 0.0), DVec3::new(1.0, f64::NAN, 0.0)]
    {
        assert_eq!(rays.closest(Ray::along(DVec3::ZERO, direction)), None, "{direction}");
        assert_eq!(rays.closest(Ray::between(DVec3::ZERO, direction)), None, "{direction}");
    }
    assert!(!rays.is_blocked(Ray::between(DVec3::ONE, DVec3::ONE)), "a ray without a length meets nothing");
}

/// All distances are multiples of the scene: one made a million times as large or as small is met alike.
#[test]
fn size_does_not_matter() {
    for scale in [1e-6_f32, 1.0, 1e6, 1e15] {
        let mesh = shapes::sphere(Vec3::ZERO, scale, 24);
        let scene = scene(mesh);
        let tracer = Tracer::new(&scene, 1).expect("a thread starts");
        let mut rays = tracer.rays();
        let eye = DVec3::new(0.2, -3.0, 0.1) * f64::from(scale);
        for i in 0..500 {
            let (x, z) = (f64::from(i % 25) / 12.5 - 1.0, f64::from(i / 25) / 10.0 - 1.0);
            let ray = Ray::along(eye, DVec3::new(x, 2.0, z));
            assert_eq!(rays.closest(ray), closest_of_all(&tracer, ray), "scale {scale}, {ray:?}");
        }
    }
}
