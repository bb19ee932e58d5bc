//! Built-in scenes: one to look at, and some whose shadows are known in closed form.

use core::f32::consts::PI;

use glam::{DVec3, Quat, Vec2, Vec3, Vec4};
use shadow_math::{Camera, Light, LightKind, Projection};

use crate::{
    builder::{Mesh, SceneBuilder},
    scene::{Alpha, Image, Material, Scene, Texture, Wrap},
};

pub mod shapes;

/// The names of the built-in scenes, for [`by_name`].
pub const NAMES: &[&str] = &["demo", "box-on-plane", "fence", "tilted-plane", "grazing"];

/// The built-in scene of that name; `None` if there is none.
#[must_use]
pub fn by_name(name: &str) -> Option<Scene> {
    Some(match name {
        "demo" => demo(),
        "box-on-plane" => box_on_plane(),
        "fence" => fence(),
        "tilted-plane" => tilted_plane(Vec3::new(0.3, 1.0, 0.2), 5.0),
        "grazing" => grazing(),
        _ => return None,
    })
}

/// The illuminance in lux of the sun in the scenes with a known answer.
const TEST_SUN_LUX: f32 = 10_000.0;

/// A still life on a square of 12 m: a torus knot on a plinth, a sphere, blocks, a picket fence cut out of a texture by
/// its alpha, and a pergola whose slats throw stripes.
///
/// It has a sun and a warm spot light, and one camera that is composed for pictures of 16 to 9.
#[must_use]
pub fn demo() -> Scene {
    let mut scene = Composer::new();
    let ground = scene.material("sandstone", Vec3::new(0.56, 0.50, 0.42), 0.95);
    let coral = scene.material("coral glaze", Vec3::new(0.78, 0.20, 0.11), 0.35);
    let ivory = scene.material("ivory", Vec3::new(0.86, 0.82, 0.73), 0.5);
    let teal = scene.material("teal", Vec3::new(0.06, 0.27, 0.30), 0.7);
    let ochre = scene.material("ochre", Vec3::new(0.76, 0.47, 0.10), 0.8);
    let slate = scene.material("slate", Vec3::new(0.20, 0.22, 0.26), 0.85);
    let timber = scene.material("timber", Vec3::new(0.45, 0.27, 0.14), 0.9);
    let pickets = scene.pickets();

    let turned = |degrees: f32| Quat::from_rotation_y(degrees.to_radians());
    scene.add("ground", ground, shapes::plane(Vec3::ZERO, Vec3::Y, 6.0));
    scene.add("plinth", slate, shapes::cuboid(Vec3::new(-0.35, 0.3, 0.2), Vec3::new(0.6, 0.3, 0.6), turned(12.0)));
    scene.add("knot", coral, shapes::torus_knot(Vec3::new(-0.35, 1.62, 0.2), 0.64, 0.29, 0.14, 320));
    scene.add("sphere", ivory, shapes::sphere(Vec3::new(2.5, 0.8, -1.7), 0.8, 96));
    scene.add("small sphere", coral, shapes::sphere(Vec3::new(1.5, 0.3, 2.2), 0.3, 64));
    scene.add("block", teal, shapes::cuboid(Vec3::new(-3.0, 0.65, -0.1), Vec3::splat(0.65), turned(28.0)));
    scene.add("block on top", ochre, shapes::cuboid(Vec3::new(-2.95, 1.6, -0.15), Vec3::splat(0.3), turned(-15.0)));
    scene.add("step", ochre, shapes::cuboid(Vec3::new(2.6, 0.15, 1.5), Vec3::new(0.55, 0.15, 0.32), turned(35.0)));
    scene.add("fence", pickets, fence_panel(Vec3::new(-4.6, 0.0, 2.9), Vec3::new(-5.0, 0.0, -2.7), 1.3));
    scene.add("pergola", timber, pergola());

    let sun = Vec3::new(0.66, -1.0, -0.36);
    let color = Vec3::new(1.0, 0.95, 0.86);
    scene.builder.add_light("sun", Light { kind: LightKind::Directional { direction: sun }, color, intensity: 20_000.0 });
    let position = Vec3::new(3.6, 4.0, 4.6);
    scene.builder.add_light(
        "lamp",
        Light {
            kind: LightKind::Spot {
                position,
                direction: Vec3::new(-0.9, 0.7, -0.1) - position,
                inner: 14_f32.to_radians(),
                outer: 21_f32.to_radians(),
                range: None,
            },
            color: Vec3::new(1.0, 0.62, 0.30),
            intensity: 400_000.0,
        },
    );
    scene.camera("main", DVec3::new(4.6, 4.6, 9.9), DVec3::new(-0.4, 0.5, -0.3), 32.0);
    scene.finish()
}

/// A picket fence from one point on the ground to another: one quadrilateral, a picket for every 20 cm of it.
fn fence_panel(from: Vec3, to: Vec3, height: f32) -> Mesh {
    const PICKET_PITCH: f32 = 0.2;
    let up = height * Vec3::Y;
    let mut panel = shapes::quad([from, to, to + up, from + up]);
    let pickets = (from.distance(to) / PICKET_PITCH).round();
    for uv in &mut panel.vertices.uvs {
        *uv *= Vec2::new(pickets, 1.0);
    }
    panel
}

/// Four posts, two beams and nine slats, at the back on the right.
fn pergola() -> Mesh {
    const CENTER: Vec3 = Vec3::new(1.8, 0.0, -1.6);
    const HALF_LENGTH: f32 = 1.7;
    const HALF_DEPTH: f32 = 1.1;
    const HEIGHT: f32 = 2.3;
    const SLATS: u32 = 9;
    let mut all = Mesh::default();
    let mut add = |offset: Vec3, half_extents: Vec3, rotation: Quat| {
        shapes::append(&mut all, shapes::cuboid(CENTER + offset, half_extents, rotation));
    };
    for z in [-HALF_DEPTH, HALF_DEPTH] {
        for x in [-HALF_LENGTH, HALF_LENGTH] {
            add(Vec3::new(0.85 * x, 0.5 * HEIGHT, z), Vec3::new(0.07, 0.5 * HEIGHT, 0.07), Quat::IDENTITY);
        }
        add(Vec3::new(0.0, HEIGHT + 0.07, z), Vec3::new(HALF_LENGTH, 0.07, 0.06), Quat::IDENTITY);
    }
    for slat in 0..SLATS {
        let x = (slat as f32 / (SLATS - 1) as f32 * 2.0 - 1.0) * (HALF_LENGTH - 0.1);
        // The slats stand on edge and lean, as they do to keep the noon sun out.
        let lean = Quat::from_rotation_z(-0.35);
        add(Vec3::new(x, HEIGHT + 0.24, 0.0), Vec3::new(0.02, 0.11, HALF_DEPTH + 0.3), lean);
    }
    all
}

/// A box of 2 m that rests on a plane of 20 m, lit by one directional light that travels along (1, -2, 0).
///
/// The box spans -1 to 1 m in x and z and 0 to 2 m in y; the plane is y = 0. A point of the box at height h casts its
/// shadow at `x + h / 2`, so that on the plane, outside of the box, exactly the rectangle `1 < x < 2`, `-1 < z < 1` is in
/// shadow ([`box_on_plane_is_shadowed`]). On the box the sides x = 1 (which faces away) and z = -1, z = 1 (which the light
/// passes along) are dark, the top and the side x = -1 are lit.
#[must_use]
pub fn box_on_plane() -> Scene {
    let mut scene = Composer::new();
    let gray = scene.material("gray", Vec3::splat(0.5), 1.0);
    let red = scene.material("red", Vec3::new(0.6, 0.1, 0.1), 1.0);
    scene.add("plane", gray, shapes::plane(Vec3::ZERO, Vec3::Y, 10.0));
    scene.add("box", red, shapes::cuboid(Vec3::Y, Vec3::ONE, Quat::IDENTITY));
    scene.test_sun(Vec3::new(1.0, -2.0, 0.0));
    scene.camera("main", DVec3::new(5.0, 6.0, 9.0), DVec3::new(0.5, 0.5, 0.0), 35.0);
    scene.finish()
}

/// Whether the point (x, 0, z) of the plane in [`box_on_plane`] is in shadow or under the box; metres.
///
/// The outline itself counts as shadowed.
#[must_use]
pub fn box_on_plane_is_shadowed(x: f32, z: f32) -> bool {
    (-1.0..=2.0).contains(&x) && (-1.0..=1.0).contains(&z)
}

/// Distance between the left edges of neighbouring bars in [`fence`], in metres.
pub const FENCE_PITCH: f32 = 0.25;
/// Width of a bar in [`fence`], in metres: a quarter of the pitch, so that the duty cycle of its shadow is 1/4.
pub const FENCE_WIDTH: f32 = 0.0625;
/// Height of the bars in [`fence`], in metres.
pub const FENCE_HEIGHT: f32 = 2.0;
/// How many bars [`fence`] has.
pub const FENCE_BARS: u32 = 32;

/// Upright bars without thickness in the plane z = 0 over a plane of 20 m, lit by a light that travels along (0, -1, -1).
///
/// Bar `i` of [`FENCE_BARS`] spans [`FENCE_WIDTH`] in x from `-4 + i * FENCE_PITCH` on, and `0 < y < FENCE_HEIGHT`. A point at
/// height h casts its shadow at `z = -h`, so that each bar's shadow is as wide as the bar and reaches from z = 0 to
/// `z = -FENCE_HEIGHT` ([`fence_is_shadowed`]): of the rectangle `-4 < x < 4`, `-2 < z < 0` exactly a quarter is dark.
#[must_use]
pub fn fence() -> Scene {
    let mut scene = Composer::new();
    let gray = scene.material("gray", Vec3::splat(0.5), 1.0);
    let bars = scene.builder.add_material(Material {
        name: "bars".into(),
        base_color: Vec4::new(0.1, 0.3, 0.2, 1.0),
        double_sided: true,
        ..Material::white()
    });
    let mut fence = Mesh::default();
    for bar in 0..FENCE_BARS {
        let left = Vec3::new(-4.0 + bar as f32 * FENCE_PITCH, 0.0, 0.0);
        let right = left + FENCE_WIDTH * Vec3::X;
        let up = FENCE_HEIGHT * Vec3::Y;
        shapes::append(&mut fence, shapes::quad([left, right, right + up, left + up]));
    }
    scene.add("plane", gray, shapes::plane(Vec3::ZERO, Vec3::Y, 10.0));
    scene.add("bars", bars, fence);
    scene.test_sun(Vec3::new(0.0, -1.0, -1.0));
    scene.camera("main", DVec3::new(2.0, 6.0, -10.0), DVec3::new(0.0, 0.5, -0.5), 40.0);
    scene.finish()
}

/// Whether the point (x, 0, z) of the plane in [`fence`] is in shadow; metres. The outline itself counts as shadowed.
#[must_use]
pub fn fence_is_shadowed(x: f32, z: f32) -> bool {
    let along = (x + 4.0) / FENCE_PITCH;
    (0.0..FENCE_BARS as f32).contains(&along) && along.fract() <= FENCE_WIDTH / FENCE_PITCH && (-FENCE_HEIGHT..=0.0).contains(&z)
}

/// One square plane through the origin with the given normal and half side (metres), lit straight from above, seen along
/// its normal. It is lit all over if the normal points up at all, and dark otherwise: whatever else a shadow map says is acne.
///
/// A normal without direction is taken for y, a half side that is not a positive number for 1 m.
#[must_use]
pub fn tilted_plane(normal: Vec3, half_size: f32) -> Scene {
    let normal = normal.try_normalize().unwrap_or(Vec3::Y);
    let half_size = if half_size.is_finite() && half_size > 0.0 { half_size } else { 1.0 };
    lit_plane(normal, half_size, Vec3::NEG_Y)
}

/// A plane of 20 m in y = 0, lit all over by a light 1 degree above the horizon that travels along
/// (cos 1°, -sin 1°, 0): slopes of depth are 57 times what they are at 45 degrees.
#[must_use]
pub fn grazing() -> Scene {
    let (sine, cosine) = (PI / 180.0).sin_cos();
    lit_plane(Vec3::Y, 10.0, Vec3::new(cosine, -sine, 0.0))
}

fn lit_plane(normal: Vec3, half_size: f32, light: Vec3) -> Scene {
    let mut scene = Composer::new();
    let gray = scene.material("gray", Vec3::splat(0.5), 1.0);
    scene.add("plane", gray, shapes::plane(Vec3::ZERO, normal, half_size));
    scene.test_sun(light);
    // A little off the normal, so that no edge of the plane is parallel to the picture's.
    let eye = (normal + 0.3 * normal.any_orthonormal_vector()).as_dvec3() * (3.0 * f64::from(half_size));
    scene.camera("main", eye, DVec3::ZERO, 45.0);
    scene.finish()
}

/// Waves on a rectangle of 16 by 9 m that nearly fills a picture of 16 to 9, for measuring: the more `triangles` there are, the smaller is
/// each of them, and what is covered stays the same.
///
/// There is one such sheet at each of `heights`, in metres, and they are drawn in that order. Those below the highest are hidden by it from
/// the camera and from the sun, but for a strip at the edges as wide as they lie deep. The number of triangles of a sheet is `triangles`
/// if its half has two factors that make cells about as wide as long, as that of every power of ten has, else a little less.
#[must_use]
pub fn waves(triangles: u32, heights: &[f32]) -> Scene {
    const HALF_SIZE: Vec2 = Vec2::new(8.0, 4.5);
    /// High enough to shadow each other under this sun.
    const HEIGHT: f32 = 0.5;
    let mut scene = Composer::new();
    let material = scene.material("clay", Vec3::new(0.62, 0.45, 0.36), 0.9);
    let cells = cells_of(triangles / 2);
    for height in heights {
        scene.add("waves", material, shapes::waves(*height * Vec3::Y, HALF_SIZE, HEIGHT, cells));
    }
    scene.test_sun(Vec3::new(-1.0, -1.0, 0.4));
    scene.camera("above", DVec3::new(0.0, 12.5, 1.0), DVec3::ZERO, 44.0);
    scene.finish()
}

/// As many columns and rows as make `count` cells, of all such pairs the one nearest to a square with at least as many columns; where there is
/// only a strip, a little fewer cells.
fn cells_of(count: u32) -> [u32; 2] {
    /// How many times as many columns as rows there may be: on 16 by 9 m, cells are then less than twice as long as wide, either way.
    const MAX_RATIO: u32 = 3;
    let root = count.max(1).isqrt();
    let rows = (1..=root).rev().find(|rows| count.is_multiple_of(*rows)).unwrap_or(1);
    let columns = count.max(1) / rows;
    if columns <= MAX_RATIO * rows { [columns, rows] } else { [count.max(1) / root, root] }
}

/// A builder of scenes that are known to be good.
struct Composer {
    builder: SceneBuilder,
}

impl Composer {
    fn new() -> Self {
        Self { builder: SceneBuilder::new(DVec3::ZERO) }
    }

    fn material(&mut self, name: &str, color: Vec3, roughness: f32) -> u32 {
        self.builder.add_material(Material { name: name.into(), base_color: color.extend(1.0), roughness, ..Material::white() })
    }

    /// A double-sided material of painted pickets: one picket and two rails, cut out by alpha, that repeat to the side.
    fn pickets(&mut self) -> u32 {
        let image = self.builder.add_image(picket_image());
        self.builder.add_material(Material {
            name: "pickets".into(),
            base_color: Vec4::new(0.80, 0.83, 0.80, 1.0),
            texture: Some(Texture { image, wrap_u: Wrap::Repeat, wrap_v: Wrap::ClampToEdge }),
            alpha: Alpha::Mask { cutoff: 0.5 },
            double_sided: true,
            roughness: 0.8,
        })
    }

    fn add(&mut self, name: &str, material: u32, mesh: Mesh) {
        // The shapes keep what the builder demands, and a test builds every scene.
        self.builder.add_instance(name, material, mesh).expect("a built-in shape is complete and finite");
    }

    fn test_sun(&mut self, direction: Vec3) {
        let kind = LightKind::Directional { direction };
        self.builder.add_light("sun", Light { kind, color: Vec3::ONE, intensity: TEST_SUN_LUX });
    }

    /// A camera that sees everything up to a kilometre; `fov` is the vertical angle of view in degrees.
    fn camera(&mut self, name: &str, eye: DVec3, target: DVec3, fov: f64) {
        let projection = Projection::Perspective { vertical_fov: fov.to_radians(), near: 0.1, far: Some(1000.0 + eye.length()) };
        // Every caller's eye is apart from its target.
        let camera = Camera::look_at(eye, target, projection).expect("a built-in camera looks somewhere");
        self.builder.add_camera(name, camera);
    }

    fn finish(self) -> Scene {
        // Materials and images come from the methods above, and a test builds every scene.
        self.builder.build().expect("a built-in scene is complete")
    }
}

/// One picket of a fence with a pointed top, and the two rails behind it.
fn picket_image() -> Image {
    const WIDTH: u32 = 64;
    const HEIGHT: u32 = 256;
    /// Half the picket's width as a share of the image's.
    const HALF_PICKET: f32 = 0.31;
    /// Where the slope of the pointed top ends, as a share of the height.
    const SHOULDER: f32 = 0.12;
    /// Middles of the rails, as shares of the height.
    const RAILS: [f32; 2] = [0.27, 0.78];
    /// Half the height of a rail.
    const HALF_RAIL: f32 = 0.035;
    let texel = |x: u32, y: u32| {
        let (u, v) = ((x as f32 + 0.5) / WIDTH as f32, (y as f32 + 0.5) / HEIGHT as f32);
        let from_axis = (u - 0.5).abs();
        let picket = from_axis < HALF_PICKET * (v / SHOULDER).min(1.0);
        let rail = RAILS.iter().any(|middle| (v - middle).abs() < HALF_RAIL);
        // The rails lie behind the pickets and so look a little darker; the paint is streaky along the wood.
        let streak = if picket { (37 * x % 13) as u8 } else { (37 * y % 13) as u8 };
        let shade = if picket { 240 } else { 205 } - streak;
        [shade, shade, shade, if picket || rail { 255 } else { 0 }]
    };
    let texels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| texel(x, y))).collect();
    Image { width: WIDTH, height: HEIGHT, texels }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Pass;

    /// Whether the light that travels along `direction` is kept from `point` by any triangle of the scene.
    fn is_blocked(scene: &Scene, point: Vec3, direction: Vec3) -> bool {
        let toward_light = -direction.normalize();
        let positions = &scene.vertices().positions;
        scene.triangles().iter().any(|triangle| {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let (ab, ac) = (b - a, c - a);
            let p = toward_light.cross(ac);
            let determinant = ab.dot(p);
            if determinant.abs() < 1e-9 {
                return false;
            }
            let from_a = point - a;
            let u = from_a.dot(p) / determinant;
            let q = from_a.cross(ab);
            let v = toward_light.dot(q) / determinant;
            u >= 0.0 && v >= 0.0 && u + v <= 1.0 && ac.dot(q) / determinant > 1e-4
        })
    }

    fn sun_of(scene: &Scene) -> Vec3 {
        match scene.lights()[0].light.kind {
            LightKind::Directional { direction } => direction,
            _ => panic!("the first light is the sun"),
        }
    }

    /// Compares a closed form with rays, at points that a fine odd step keeps off the outlines.
    fn check_closed_form(scene: &Scene, is_shadowed: fn(f32, f32) -> bool) {
        let sun = sun_of(scene);
        let mut shadowed = 0;
        for i in 0..150 {
            for j in 0..150 {
                let (x, z) = (-5.003 + 0.067 * i as f32, -5.011 + 0.067 * j as f32);
                let expected = is_shadowed(x, z);
                shadowed += u32::from(expected);
                assert_eq!(is_blocked(scene, Vec3::new(x, 0.0, z), sun), expected, "({x}, {z})");
            }
        }
        assert!(shadowed > 100, "the points must try both cases");
    }

    #[test]
    fn every_name_is_a_scene_with_a_valid_camera_and_no_note() {
        for name in NAMES {
            let scene = by_name(name).unwrap();
            assert!(scene.notes().is_empty(), "{name}: {:?}", scene.notes());
            assert!(!scene.triangles().is_empty() && !scene.lights().is_empty() && scene.cameras().len() == 1, "{name}");
        }
        assert!(by_name("no such scene").is_none());
    }

    #[test]
    fn the_shadow_of_the_box_is_the_documented_rectangle() {
        // Under the box a ray starts inside of it and meets its top: shadowed as documented.
        check_closed_form(&box_on_plane(), box_on_plane_is_shadowed);
    }

    #[test]
    fn the_shadow_of_the_fence_is_the_documented_stripes() {
        check_closed_form(&fence(), fence_is_shadowed);
    }

    #[test]
    fn a_quarter_of_the_fence_is_dark() {
        let steps = 8 * 64;
        let dark = (0..steps).filter(|i| fence_is_shadowed(-4.0 + (*i as f32 + 0.5) / 64.0, -1.0)).count();
        assert_eq!(4 * dark, steps);
    }

    #[test]
    fn lit_planes_face_the_light_and_nothing_blocks_it() {
        for scene in [grazing(), tilted_plane(Vec3::new(2.0, 1.0, 0.0), 3.0), tilted_plane(Vec3::ZERO, f32::NAN)] {
            let sun = sun_of(&scene);
            assert!(scene.vertices().normals[0].dot(sun) < 0.0);
            assert!(!is_blocked(&scene, Vec3::ZERO, sun));
        }
        let elevation = (-sun_of(&grazing()).normalize().y).asin().to_degrees();
        assert!((elevation - 1.0).abs() < 1e-5, "{elevation}");
    }

    #[test]
    fn the_demo_uses_every_pass_it_promises_and_fits_its_square() {
        let scene = demo();
        assert!(!scene.pass_triangles(Pass::MaskDoubleSided).is_empty(), "the fence is cut out by alpha");
        assert!(!scene.pass_triangles(Pass::OpaqueSingleSided).is_empty());
        assert_eq!(scene.bounds().min, Vec3::new(-6.0, 0.0, -6.0));
        assert_eq!((scene.bounds().max.x, scene.bounds().max.z), (6.0, 6.0));
        assert!(scene.lights().iter().any(|light| matches!(light.light.kind, LightKind::Spot { .. })));
    }

    #[test]
    fn the_demo_camera_sees_every_object() {
        let scene = demo();
        let camera = scene.cameras()[0].camera;
        let clip_from_world =
            camera.clip_from_view(16.0 / 9.0, shadow_math::spaces::ClipDepth::ZeroToOne) * camera.view_from_world();
        for instance in scene.instances().iter().filter(|instance| instance.name != "ground") {
            for corner in instance.bounds.corners() {
                let ndc = clip_from_world.project_point3(corner.as_dvec3());
                assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0, "{}: {ndc}", instance.name);
            }
        }
    }

    #[test]
    fn waves_are_as_many_triangles_as_asked_for_and_all_in_view() {
        for triangles in [1_000, 10_000, 100_000, 200_000] {
            assert_eq!(waves(triangles, &[0.0]).triangles().len(), triangles as usize);
        }
        // Half of it is a prime.
        assert_eq!(waves(2 * 997, &[0.0]).triangles().len(), 2 * 31 * 32);
        assert_eq!(waves(0, &[0.0]).triangles().len(), 2);
        let scene = waves(1_000, &[0.0, -0.2]);
        assert_eq!(scene.triangles().len(), 2_000);
        let camera = scene.cameras()[0].camera;
        let clip_from_world =
            camera.clip_from_view(16.0 / 9.0, shadow_math::spaces::ClipDepth::ZeroToOne) * camera.view_from_world();
        for position in &scene.vertices().positions {
            let ndc = clip_from_world.project_point3(position.as_dvec3());
            assert!(ndc.x.abs() < 1.0 && ndc.y.abs() < 1.0, "{position}: {ndc}");
        }
    }

    #[test]
    fn pickets_have_wood_and_gaps() {
        let image = picket_image();
        assert_eq!(image.texels.len(), (image.width * image.height) as usize);
        let at = |x: u32, y: u32| image.texels[(y * image.width + x) as usize][3];
        assert_eq!((at(32, 128), at(0, 128), at(0, 200), at(0, 4)), (255, 0, 255, 0));
    }
}
