//! Puts a scene together and resolves what is left open: the order of triangles, the bounds, a camera and a light.

use glam::{DVec3, Vec3};
use shadow_math::{Camera, CameraError, Light, LightError, LightKind, Projection, bounds::Aabb};

use crate::{
    scene::{Image, Instance, Material, Pass, Scene, SceneCamera, SceneLight, Vertices, vertex_deviations},
    source::SourceFacts,
};

/// Why a scene cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A position is not finite.
    #[error("`{instance}`: position {vertex} is {position}, which is not a finite point")]
    Position {
        /// The instance's name.
        instance: String,
        /// The vertex's index in the mesh.
        vertex: usize,
        /// The position.
        position: Vec3,
    },
    /// A triangle names a vertex that does not exist.
    #[error("`{instance}`: triangle {triangle} names vertex {index}, but there are only {count} vertices")]
    Index {
        /// The instance's name.
        instance: String,
        /// The triangle's index in the mesh.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices the mesh has.
        count: usize,
    },
    /// The streams of a mesh are not equally long.
    #[error("`{instance}`: {positions} positions but {other} {stream}")]
    Stream {
        /// The instance's name.
        instance: String,
        /// The stream that differs.
        stream: &'static str,
        /// How many positions there are.
        positions: usize,
        /// How many entries that stream has.
        other: usize,
    },
    /// A material or an image that is named does not exist.
    #[error("{kind} {index} is used, but there are only {count}")]
    Missing {
        /// "material" or "image".
        kind: &'static str,
        /// The index that is used.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// An image's texels do not fill its size.
    #[error("image {index} is {width} x {height} but has {texels} texels")]
    ImageSize {
        /// The image's index.
        index: usize,
        /// Its width in texels.
        width: u32,
        /// Its height in texels.
        height: u32,
        /// How many texels it has.
        texels: usize,
    },
    /// There are more triangles or vertices than 32-bit indices can name.
    #[error("the scene has more than {limit} {what}, the most that 32-bit indices can name; draw a part of it")]
    TooLarge {
        /// "triangles" or "vertices".
        what: &'static str,
        /// The limit.
        limit: u32,
    },
    /// A light cannot be used.
    #[error("light `{name}`: {source}")]
    Light {
        /// The light's name.
        name: String,
        /// What is wrong with it.
        source: LightError,
    },
    /// A camera cannot be used.
    #[error("camera `{name}`: {source}")]
    Camera {
        /// The camera's name.
        name: String,
        /// What is wrong with it.
        source: CameraError,
    },
}

/// The most triangles, and the most vertices, of a scene: three indices a triangle must still be countable in 32 bits.
pub const MAX_ELEMENTS: u32 = u32::MAX / 3;

/// Half the side of the cube, in metres, that stands for the bounds of a scene without triangles.
const EMPTY_HALF_SIZE: f32 = 0.5;

/// Triangles in world space, on their way into a scene.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// The vertices, relative to the builder's origin.
    pub vertices: Vertices,
    /// Three vertex indices a triangle, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

/// Collects the parts of a scene.
///
/// ```
/// use shadow_scene::{Material, Mesh, SceneBuilder, Vertices};
/// use glam::{DVec3, Vec2, Vec3, Vec4};
///
/// let mut builder = SceneBuilder::new(DVec3::ZERO);
/// let white = builder.add_material(Material::white());
/// let mesh = Mesh {
///     vertices: Vertices {
///         positions: vec![Vec3::ZERO, Vec3::Z, Vec3::X],
///         normals: vec![Vec3::Y; 3],
///         uvs: vec![Vec2::ZERO; 3],
///         colors: vec![Vec4::ONE; 3],
///     },
///     triangles: vec![[0, 1, 2]],
/// };
/// builder.add_instance("floor", white, mesh)?;
/// let scene = builder.build()?;
/// assert_eq!(scene.triangles().len(), 1);
/// assert!(scene.has_default_camera() && scene.has_default_light());
/// # Ok::<(), shadow_scene::SceneError>(())
/// ```
#[derive(Debug)]
pub struct SceneBuilder {
    origin: DVec3,
    vertices: Vertices,
    triangles: Vec<[u32; 3]>,
    triangle_materials: Vec<u32>,
    instances: Vec<Instance>,
    materials: Vec<Material>,
    images: Vec<Image>,
    lights: Vec<SceneLight>,
    cameras: Vec<SceneCamera>,
    notes: Vec<String>,
    source: SourceFacts,
}

impl SceneBuilder {
    /// An empty scene whose coordinates will be relative to `origin`, in metres of the file's world space.
    #[must_use]
    pub fn new(origin: DVec3) -> Self {
        Self {
            origin,
            vertices: Vertices::default(),
            triangles: Vec::new(),
            triangle_materials: Vec::new(),
            instances: Vec::new(),
            materials: Vec::new(),
            images: Vec::new(),
            lights: Vec::new(),
            cameras: Vec::new(),
            notes: Vec::new(),
            source: SourceFacts::default(),
        }
    }

    /// The point that all coordinates are relative to.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Adds a material and gives its index.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        (self.materials.len() - 1) as u32
    }

    /// Adds an image and gives its index.
    pub fn add_image(&mut self, image: Image) -> u32 {
        self.images.push(image);
        (self.images.len() - 1) as u32
    }

    /// The images so far.
    #[must_use]
    pub fn images(&self) -> &[Image] {
        &self.images
    }

    /// Adds a light.
    pub fn add_light(&mut self, name: impl Into<String>, light: Light) {
        self.lights.push(SceneLight::new(name, light));
    }

    /// Adds a camera.
    pub fn add_camera(&mut self, name: impl Into<String>, camera: Camera) {
        self.cameras.push(SceneCamera { name: name.into(), camera });
    }

    /// Adds a sentence that the program shows to the person who loaded the scene.
    pub fn add_note(&mut self, note: impl Into<String>) {
        self.notes.push(note.into());
    }

    /// Says what there is in the file that the scene comes from.
    pub fn set_source(&mut self, source: SourceFacts) {
        self.source = source;
    }

    /// Adds triangles of one material.
    ///
    /// # Errors
    ///
    /// What [`Scene`] guarantees and the mesh does not keep; the builder is then as before.
    pub fn add_instance(&mut self, name: impl Into<String>, material: u32, mesh: Mesh) -> Result<(), SceneError> {
        let name = name.into();
        let Mesh { vertices, triangles } = mesh;
        let count = vertices.positions.len();
        for (stream, other) in
            [("normals", vertices.normals.len()), ("texture coordinates", vertices.uvs.len()), ("colours", vertices.colors.len())]
        {
            if other != count {
                return Err(SceneError::Stream { instance: name, stream, positions: count, other });
            }
        }
        if let Some(vertex) = vertices.positions.iter().position(|p| !p.is_finite()) {
            return Err(SceneError::Position { instance: name, vertex, position: vertices.positions[vertex] });
        }
        for (triangle, indices) in triangles.iter().enumerate() {
            if let Some(&index) = indices.iter().find(|&&index| index as usize >= count) {
                return Err(SceneError::Index { instance: name, triangle, index, count });
            }
        }
        if self.vertices.positions.len() + count > MAX_ELEMENTS as usize {
            return Err(SceneError::TooLarge { what: "vertices", limit: MAX_ELEMENTS });
        }
        if self.triangles.len() + triangles.len() > MAX_ELEMENTS as usize {
            return Err(SceneError::TooLarge { what: "triangles", limit: MAX_ELEMENTS });
        }
        if material as usize >= self.materials.len() {
            return Err(SceneError::Missing { kind: "material", index: material, count: self.materials.len() });
        }
        let base = self.vertices.positions.len() as u32;
        let bounds = Aabb::from_points(triangles.iter().flatten().map(|&i| vertices.positions[i as usize]));
        self.instances.push(Instance { name, bounds, triangle_count: triangles.len() as u32, casts_shadows: true });
        self.triangle_materials.extend(core::iter::repeat_n(material, triangles.len()));
        self.triangles.extend(triangles.into_iter().map(|t| t.map(|i| i + base)));
        self.vertices.positions.extend(vertices.positions);
        self.vertices.normals.extend(vertices.normals);
        self.vertices.uvs.extend(vertices.uvs);
        self.vertices.colors.extend(vertices.colors);
        Ok(())
    }

    /// Sorts the triangles, checks materials, lights and cameras, and adds a framing camera and a sun where there is none.
    ///
    /// A scene may be without triangles, as files of points or lines are. Its picture is the background; its bounds are those
    /// of a cube of 1 m around the origin, so that cameras and lights have something to be fitted to, and a note says so.
    ///
    /// # Errors
    ///
    /// What [`Scene`] guarantees and the parts do not keep.
    pub fn build(mut self) -> Result<Scene, SceneError> {
        for (index, image) in self.images.iter().enumerate() {
            let texels = image.texels.len();
            if image.width == 0 || image.height == 0 || image.width as usize * image.height as usize != texels {
                return Err(SceneError::ImageSize { index, width: image.width, height: image.height, texels });
            }
        }
        for texture in self.materials.iter().filter_map(|material| material.texture) {
            if texture.image as usize >= self.images.len() {
                return Err(SceneError::Missing { kind: "image", index: texture.image, count: self.images.len() });
            }
        }
        let mut bounds = self.instances.iter().fold(Aabb::EMPTY, |bounds, instance| bounds.union(instance.bounds));
        if self.triangles.is_empty() {
            bounds = Aabb::new(Vec3::splat(-EMPTY_HALF_SIZE), Vec3::splat(EMPTY_HALF_SIZE));
            self.notes.insert(0, "nothing to draw: the scene has no triangles, and only they are drawn and cast shadows".into());
        }
        let has_default_camera = self.cameras.is_empty();
        if has_default_camera {
            self.add_camera("framing", framing_camera(bounds));
        }
        let has_default_light = self.lights.is_empty();
        if has_default_light {
            self.add_light("sun", sun());
        }
        for SceneLight { name, light, shape, .. } in &self.lights {
            light
                .validate()
                .and_then(|()| shape.validate(&light.kind))
                .map_err(|source| SceneError::Light { name: name.clone(), source })?;
        }
        for SceneCamera { name, camera } in &self.cameras {
            camera.validate().map_err(|source| SceneError::Camera { name: name.clone(), source })?;
        }
        let corners = |triangle: &[u32; 3]| triangle.map(|corner| self.vertices.positions[corner as usize].as_dvec3());
        let areas: Vec<Area> = self.triangles.iter().map(|triangle| Area::of(corners(triangle))).collect();
        let needles = areas.iter().filter(|&&area| area == Area::Needle).count();
        if needles > 0 {
            let what = if needles == 1 { "1 needle is" } else { &format!("{needles} needles are") };
            self.notes.push(format!("{what} not drawn: triangles whose height is no more than the rounding of their corners"));
        }
        let Sorted { triangles, triangle_materials, triangle_instances, pass_triangles } =
            sort_by_pass(&self.materials, &self.instances, &areas, &self.triangles, &self.triangle_materials);
        Ok(Scene {
            origin: self.origin,
            // Needles, which are not drawn, have a normal of chance.
            deviations: vertex_deviations(&self.vertices, &triangles[..pass_triangles[Pass::COUNT - 1].end as usize]),
            vertices: self.vertices,
            triangles,
            triangle_materials,
            triangle_instances,
            pass_triangles,
            instances: self.instances,
            materials: self.materials,
            images: self.images,
            lights: self.lights,
            cameras: self.cameras,
            bounds,
            has_default_camera,
            has_default_light,
            notes: self.notes,
            source: self.source,
        })
    }
}

/// The triangles with what belongs to each, stably sorted by pass, and where each pass lies. Those without an area come last.
struct Sorted {
    triangles: Vec<[u32; 3]>,
    triangle_materials: Vec<u32>,
    triangle_instances: Vec<u32>,
    pass_triangles: [core::ops::Range<u32>; Pass::COUNT],
}

fn sort_by_pass(
    materials: &[Material],
    instances: &[Instance],
    areas: &[Area],
    triangles: &[[u32; 3]],
    triangle_materials: &[u32],
) -> Sorted {
    let passes: Vec<Pass> = materials.iter().map(Material::pass).collect();
    // Instances were added one after the other, each with its triangles.
    let of_instances = instances.iter().zip(0..).flat_map(|(instance, index)| (0..instance.triangle_count).map(move |_| index));
    let triangle_instances: Vec<u32> = of_instances.collect();
    let mut order: Vec<u32> = Vec::with_capacity(triangles.len());
    let pass_triangles = Pass::ALL.map(|pass| {
        let start = order.len() as u32;
        let of_pass =
            |index: &u32| areas[*index as usize] == Area::Some && passes[triangle_materials[*index as usize] as usize] == pass;
        order.extend((0..triangles.len() as u32).filter(of_pass));
        start..order.len() as u32
    });
    order.extend((0..triangles.len() as u32).filter(|&index| areas[index as usize] != Area::Some));
    let in_order = |values: &[u32]| order.iter().map(|&index| values[index as usize]).collect();
    Sorted {
        triangles: order.iter().map(|&index| triangles[index as usize]).collect(),
        triangle_materials: in_order(triangle_materials),
        triangle_instances: in_order(&triangle_instances),
        pass_triangles,
    }
}

/// What a triangle has of an area.
///
/// Each coordinate is rounded by up to `2^-24` of its size. A needle whose height over its longest side is at most four times that may as well lie
/// on either side of it: its plane is what rounding made of it, and its depth in a map can be anything. The largest coordinate counts, since what rotates a mesh mixes
/// them. Exporters leave such needles where a vertex lies on its neighbours' edge. A triangle that is small altogether is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Area {
    /// Its corners lie on a line.
    None,
    /// One that its corners' single precision cannot tell from none.
    Needle,
    Some,
}

impl Area {
    fn of([v0, v1, v2]: [DVec3; 3]) -> Self {
        /// The height of a needle, as a share of its largest coordinate: four roundings.
        const NEEDLE_HEIGHT: f64 = 1.0 / (1_u32 << 22) as f64;
        /// Its height as a share of its longest side.
        const NEEDLE_SHAPE: f64 = 1.0 / (1_u32 << 10) as f64;
        let (e0, e1, e2) = (v2 - v1, v0 - v2, v1 - v0);
        let twice_area = e2.cross(e1).length();
        let longest = e0.length().max(e1.length()).max(e2.length());
        let height = twice_area / longest;
        let largest = v0.abs().max(v1.abs()).max(v2.abs()).max_element();
        if !(twice_area > 0.0) {
            Self::None
        } else if height <= NEEDLE_HEIGHT * largest && height <= NEEDLE_SHAPE * longest {
            Self::Needle
        } else {
            Self::Some
        }
    }
}

/// Illuminance of the sun that lights a scene without lights, in lux: a clear day, some hours from noon.
pub const SUN_LUX: f32 = 80_000.0;

/// The sun for a scene without lights: from the right, above and behind the framing camera.
#[must_use]
pub fn sun() -> Light {
    Light {
        kind: LightKind::Directional { direction: Vec3::new(-0.45, -1.0, -0.6) },
        color: Vec3::new(1.0, 0.96, 0.9),
        intensity: SUN_LUX,
    }
}

/// A perspective camera that sees the whole of `bounds` from the front, the right and above, as near as a square picture allows.
///
/// `bounds` must not be empty; a single point is framed as if it were a millimetre wide.
#[must_use]
pub fn framing_camera(bounds: Aabb) -> Camera {
    /// The vertical angle of view: 40 degrees, that of a 50 mm lens on a full frame held upright.
    const VERTICAL_FOV: f64 = 40.0 * core::f64::consts::PI / 180.0;
    /// The near plane, as a share of the distance from the eye to the middle.
    const NEAR_SHARE: f64 = 1e-3;
    /// A radius below this, in metres, is taken for it.
    const MIN_RADIUS: f64 = 5e-4;
    /// How much farther away than the corners demand: a margin around the picture.
    const MARGIN: f64 = 1.05;
    let radius = f64::from(bounds.radius()).max(MIN_RADIUS);
    let center = bounds.center().as_dvec3();
    let toward_eye = DVec3::new(0.6, 0.55, 1.0).normalize();
    let orientation = shadow_math::camera::world_from_view_rotation(-toward_eye);
    let slope = (0.5 * VERTICAL_FOV).tan();
    // A corner at (x, y, z) in view axes around the middle is seen from a distance of at least its x or y over the slope, plus z.
    let distance = bounds
        .corners()
        .into_iter()
        .map(|corner| orientation.inverse() * (corner.as_dvec3() - center))
        .map(|corner| corner.x.abs().max(corner.y.abs()) / slope + corner.z)
        .fold(radius, f64::max)
        * MARGIN;
    let projection =
        Projection::Perspective { vertical_fov: VERTICAL_FOV, near: distance * NEAR_SHARE, far: Some(distance + 2.0 * radius) };
    Camera { eye: center + distance * toward_eye, orientation, projection }
}

/// The origin for a scene with these bounds, in metres of world space: zero, unless the scene lies so far from it
/// that f32 coordinates would lose more than three bits to the distance; then the middle, rounded to whole metres.
#[must_use]
pub fn choose_origin(min: DVec3, max: DVec3) -> DVec3 {
    /// How many of its own half-diagonals a scene may lie from zero: 8 is three bits.
    const MAX_DISTANCE_IN_RADII: f64 = 8.0;
    let center = 0.5 * min + 0.5 * max;
    let radius = 0.5 * (max - min).length();
    if center.is_finite() && center.length() > MAX_DISTANCE_IN_RADII * radius { center.round() } else { DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec4};

    use super::*;
    use crate::scene::Alpha;

    fn one_triangle() -> Mesh {
        Mesh {
            vertices: Vertices {
                positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
                normals: vec![Vec3::Z; 3],
                uvs: vec![Vec2::ZERO; 3],
                colors: vec![Vec4::ONE; 3],
            },
            triangles: vec![[0, 1, 2]],
        }
    }

    #[test]
    fn triangles_without_an_area_are_in_no_pass() {
        let points = |points: [[f32; 3]; 3]| Area::of(points.map(|point| Vec3::from(point).as_dvec3())) == Area::Some;
        assert!(points([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        assert!(
            points([[100.0, 0.0, 0.0], [100.00001, 0.0, 0.0], [100.0, 1e-5, 0.0]]),
            "small altogether, and rounded, but a triangle"
        );
        assert!(points([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-6, 0.0]]), "thin, and yet more than rounding");
        assert!(!points([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-7, 0.0]]), "a needle");
        assert!(!points([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]]));
        assert!(!points([[3.0, 0.0, 0.0]; 3]));

        let mut builder = SceneBuilder::new(DVec3::ZERO);
        let white = builder.add_material(Material::white());
        let mut mesh = one_triangle();
        mesh.triangles.insert(0, [0, 1, 1]);
        builder.add_instance("mesh", white, mesh).expect("the mesh is whole");
        let scene = builder.build().expect("the scene is whole");
        assert_eq!(scene.triangles(), [[0, 1, 2], [0, 1, 1]]);
        assert_eq!(scene.pass_triangles(Pass::OpaqueSingleSided), 0..1);
    }

    #[test]
    fn triangles_are_sorted_by_pass_and_keep_their_order_within_one() {
        let mut builder = SceneBuilder::new(DVec3::ZERO);
        let mask = builder.add_material(Material { alpha: Alpha::Mask { cutoff: 0.5 }, ..Material::white() });
        let opaque = builder.add_material(Material::white());
        for material in [mask, opaque, mask, opaque] {
            builder.add_instance("t", material, one_triangle()).unwrap();
        }
        let scene = builder.build().unwrap();
        assert_eq!(scene.triangle_materials(), [opaque, opaque, mask, mask]);
        assert_eq!(scene.triangles(), [[3, 4, 5], [9, 10, 11], [0, 1, 2], [6, 7, 8]]);
        assert_eq!(scene.pass_triangles(Pass::OpaqueSingleSided), 0..2);
        assert_eq!(scene.pass_triangles(Pass::MaskSingleSided), 2..4);
    }

    #[test]
    fn what_the_scene_guarantees_is_refused_otherwise() {
        let mut builder = SceneBuilder::new(DVec3::ZERO);
        let white = builder.add_material(Material::white());
        let mut bad = one_triangle();
        bad.triangles[0][1] = 3;
        assert!(matches!(builder.add_instance("t", white, bad), Err(SceneError::Index { index: 3, count: 3, .. })));
        let mut bad = one_triangle();
        bad.vertices.positions[1].y = f32::NAN;
        assert!(matches!(builder.add_instance("t", white, bad), Err(SceneError::Position { vertex: 1, .. })));
        let mut bad = one_triangle();
        bad.vertices.uvs.pop();
        assert!(matches!(builder.add_instance("t", white, bad), Err(SceneError::Stream { other: 2, .. })));
        assert!(matches!(builder.add_instance("t", 7, one_triangle()), Err(SceneError::Missing { index: 7, .. })));
        let scene = builder.build().unwrap();
        assert!(scene.triangles().is_empty() && !scene.bounds().is_empty(), "what was refused is not in the scene");
        assert!(scene.notes()[0].starts_with("nothing to draw"), "{:?}", scene.notes());
    }

    #[test]
    fn the_framing_camera_sees_every_corner() {
        for bounds in [
            Aabb::new(Vec3::new(-20.0, 0.0, -3.0), Vec3::new(5.0, 2.0, 4.0)),
            Aabb::new(Vec3::splat(1000.0), Vec3::splat(1000.2)),
            Aabb::new(Vec3::ZERO, Vec3::ZERO),
        ] {
            let camera = framing_camera(bounds);
            camera.validate().unwrap();
            let clip_from_world =
                camera.clip_from_view(1.0, shadow_math::spaces::ClipDepth::ZeroToOne) * camera.view_from_world();
            for corner in bounds.corners() {
                let ndc = clip_from_world.project_point3(corner.as_dvec3());
                assert!(ndc.x.abs() <= 1.0 && ndc.y.abs() <= 1.0 && (0.0..=1.0).contains(&ndc.z), "{bounds:?}: {ndc}");
            }
        }
    }

    #[test]
    fn the_origin_moves_only_for_scenes_far_away() {
        assert_eq!(choose_origin(DVec3::splat(-5.0), DVec3::splat(9.0)), DVec3::ZERO);
        let far = DVec3::new(1e6, 0.0, 3.0);
        assert_eq!(choose_origin(far - DVec3::ONE, far + DVec3::ONE), far);
    }
}
