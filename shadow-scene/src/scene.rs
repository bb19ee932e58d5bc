//! The scene: fully resolved geometry, materials, lights and cameras.

use std::ops::Range;

use glam::{DVec3, Vec2, Vec3, Vec4};
use shadow_math::{
    Camera, Light, LightShape, Receiver,
    bounds::Aabb,
    plan::PixelRays,
    shade::facet_deviation,
    triangle::{Ray, TrianglePoint, pixel_ray, pixel_steps, triangle_point, turned_to_viewer},
};

use crate::source::SourceFacts;

/// Everything that is drawn, resolved: there is no hierarchy, no unit to convert and no default left to fill in.
///
/// # Guarantees
///
/// [`SceneBuilder::build`](crate::SceneBuilder::build) is the only way to make one, and it has seen to it that
/// - every position is finite, and the streams of [`Vertices`] are equally long;
/// - every index of a triangle names a vertex, every material and image that is named exists;
/// - front faces wind counter-clockwise as seen from outside, whatever the transforms of the file were;
/// - triangles are sorted by [`Pass`], so that each pass draws one run of [`Scene::pass_triangles`], and within a pass
///   in the order they were added;
/// - a triangle without an area is in none of them: it is not drawn and hides nothing.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) origin: DVec3,
    pub(crate) vertices: Vertices,
    /// How far the facets around each vertex lean away from its normal.
    pub(crate) deviations: Vec<f32>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) triangle_materials: Vec<u32>,
    /// The instance of each triangle.
    pub(crate) triangle_instances: Vec<u32>,
    pub(crate) pass_triangles: [Range<u32>; Pass::COUNT],
    pub(crate) instances: Vec<Instance>,
    pub(crate) materials: Vec<Material>,
    pub(crate) images: Vec<Image>,
    pub(crate) lights: Vec<SceneLight>,
    pub(crate) cameras: Vec<SceneCamera>,
    pub(crate) bounds: Aabb,
    pub(crate) has_default_camera: bool,
    pub(crate) has_default_light: bool,
    pub(crate) notes: Vec<String>,
    pub(crate) source: SourceFacts,
}

/// The vertex streams: separate arrays, one entry per vertex in each.
#[derive(Clone, Debug, Default)]
pub struct Vertices {
    /// Positions in metres relative to the scene's origin.
    pub positions: Vec<Vec3>,
    /// Shading normals in world space, of unit length (zero where the file's normal has no direction).
    pub normals: Vec<Vec3>,
    /// Texture coordinates; origin at the top left corner.
    pub uvs: Vec<Vec2>,
    /// Vertex colours, linear, and alpha.
    pub colors: Vec<Vec4>,
}

/// The runs that triangles are sorted into, in the order in which they are drawn. Those that cast no shadow are seen by the camera and not by lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Pass {
    /// Opaque, back faces culled by the camera.
    OpaqueSingleSided = 0,
    /// Opaque, both faces drawn.
    OpaqueDoubleSided = 1,
    /// As the first, casting no shadow.
    OpaqueSingleSidedUncast = 2,
    /// As the second, casting no shadow.
    OpaqueDoubleSidedUncast = 3,
    /// Alpha-tested, back faces culled by the camera.
    MaskSingleSided = 4,
    /// Alpha-tested, both faces drawn.
    MaskDoubleSided = 5,
    /// As the fifth, casting no shadow.
    MaskSingleSidedUncast = 6,
    /// As the sixth, casting no shadow.
    MaskDoubleSidedUncast = 7,
}

impl Pass {
    /// How many passes there are.
    pub const COUNT: usize = 8;
    /// All passes in the order in which they are drawn.
    pub const ALL: [Self; Self::COUNT] = [
        Self::OpaqueSingleSided,
        Self::OpaqueDoubleSided,
        Self::OpaqueSingleSidedUncast,
        Self::OpaqueDoubleSidedUncast,
        Self::MaskSingleSided,
        Self::MaskDoubleSided,
        Self::MaskSingleSidedUncast,
        Self::MaskDoubleSidedUncast,
    ];

    /// Whether triangles of this pass are alpha-tested.
    #[must_use]
    pub fn is_masked(self) -> bool {
        self as usize >= Self::MaskSingleSided as usize
    }

    /// Whether the camera culls back faces in this pass. Casters are never culled.
    #[must_use]
    pub fn culls_back_faces(self) -> bool {
        (self as usize).is_multiple_of(2)
    }

    /// Whether triangles of this pass cast shadows.
    #[must_use]
    pub fn casts_shadows(self) -> bool {
        !matches!(
            self,
            Self::OpaqueSingleSidedUncast
                | Self::OpaqueDoubleSidedUncast
                | Self::MaskSingleSidedUncast
                | Self::MaskDoubleSidedUncast
        )
    }

    /// The pass of triangles that differ in that they cast no shadow.
    #[must_use]
    pub fn without_shadows(self) -> Self {
        match self {
            Self::OpaqueSingleSided => Self::OpaqueSingleSidedUncast,
            Self::OpaqueDoubleSided => Self::OpaqueDoubleSidedUncast,
            Self::MaskSingleSided => Self::MaskSingleSidedUncast,
            Self::MaskDoubleSided => Self::MaskDoubleSidedUncast,
            uncast => uncast,
        }
    }
}

/// One drawn instance of a mesh: its name and the bounds of what it adds to the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// The node's or mesh's name, for messages; may be empty.
    pub name: String,
    /// The bounds of its triangles, in metres relative to the scene's origin.
    pub bounds: Aabb,
    /// How many triangles it has.
    pub triangle_count: u32,
    /// Whether it casts shadows.
    pub casts_shadows: bool,
}

/// How a material treats its alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alpha {
    /// Alpha is ignored. Blended materials are opaque too, for shadows and for the camera.
    Opaque,
    /// Where alpha is below the cutoff there is no surface.
    Mask {
        /// The smallest alpha that is still there; 0.5 unless the file says otherwise.
        cutoff: f32,
    },
}

/// A surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The name, for messages; may be empty.
    pub name: String,
    /// The base colour, linear, and alpha.
    pub base_color: Vec4,
    /// The texture that multiplies it.
    pub texture: Option<Texture>,
    /// How alpha is treated.
    pub alpha: Alpha,
    /// Whether both sides are drawn.
    pub double_sided: bool,
    /// Perceptual roughness, 0 to 1, as glTF's `roughnessFactor`.
    pub roughness: f32,
}

impl Material {
    /// White, matt, opaque, single-sided: glTF's default but for its roughness-1 metal.
    #[must_use]
    pub fn white() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            texture: None,
            alpha: Alpha::Opaque,
            double_sided: false,
            roughness: 1.0,
        }
    }

    /// The pass that draws it if it casts shadows.
    #[must_use]
    pub fn pass(&self) -> Pass {
        match (self.alpha, self.double_sided) {
            (Alpha::Opaque, false) => Pass::OpaqueSingleSided,
            (Alpha::Opaque, true) => Pass::OpaqueDoubleSided,
            (Alpha::Mask { .. }, false) => Pass::MaskSingleSided,
            (Alpha::Mask { .. }, true) => Pass::MaskDoubleSided,
        }
    }
}

/// How a texture continues beyond its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// It repeats.
    Repeat,
    /// The edge's texels continue.
    ClampToEdge,
    /// It repeats, every other time mirrored.
    MirroredRepeat,
}

/// A use of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Texture {
    /// The index of the image in the scene.
    pub image: u32,
    /// How it continues to the sides.
    pub wrap_u: Wrap,
    /// How it continues up and down.
    pub wrap_v: Wrap,
}

/// A picture: sRGB colour and linear alpha, 8 bits each, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// `width * height` texels, red first.
    pub texels: Vec<[u8; 4]>,
}

/// A light with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneLight {
    /// The name, for messages; may be empty.
    pub name: String,
    /// The light, relative to the scene's origin.
    pub light: Light,
    /// How large it is; glTF's lights have no size.
    pub shape: LightShape,
    /// Whether anything is shadowed from it. Where nothing is, all surfaces that face it are lit, and it needs no maps.
    pub casts_shadows: bool,
    /// The index of the image that a spot light projects.
    pub picture: Option<u32>,
}

impl SceneLight {
    /// A light without a size, which casts shadows.
    #[must_use]
    pub fn new(name: impl Into<String>, light: Light) -> Self {
        Self { name: name.into(), light, shape: LightShape::Point, casts_shadows: true, picture: None }
    }
}

/// A camera with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneCamera {
    /// The name, for messages and to choose it by; may be empty.
    pub name: String,
    /// The camera, relative to the scene's origin.
    pub camera: Camera,
}

/// What [`Scene::deviations`] gives.
pub(crate) fn vertex_deviations(vertices: &Vertices, triangles: &[[u32; 3]]) -> Vec<f32> {
    let mut deviations = vec![0.0_f32; vertices.positions.len()];
    for triangle in triangles {
        let corners = triangle.map(|corner| corner as usize);
        let [p0, p1, p2] = corners.map(|corner| vertices.positions[corner]);
        let [n0, n1, n2] = corners.map(|corner| vertices.normals[corner]);
        let facet = (p1 - p0).cross(p2 - p0);
        let deviation = facet_deviation(facet, n0, n1, n2);
        for corner in corners {
            deviations[corner] = deviations[corner].max(deviation);
        }
    }
    deviations
}

impl Scene {
    /// The point, in metres of the file's world space, that all coordinates of the scene are relative to.
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The vertex streams.
    #[must_use]
    pub fn vertices(&self) -> &Vertices {
        &self.vertices
    }

    /// For each vertex, how far a triangle that has it leans away from the normals at any of its corners, at most: [`facet_deviation`].
    ///
    /// Interpolated over a triangle it is at least the triangle's own deviation, and it goes on without a step in the next one.
    #[must_use]
    pub fn deviations(&self) -> &[f32] {
        &self.deviations
    }

    /// Three vertex indices for each triangle; counter-clockwise seen from the front.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The material's index for each triangle.
    #[must_use]
    pub fn triangle_materials(&self) -> &[u32] {
        &self.triangle_materials
    }

    /// The run of triangles that a pass draws.
    #[must_use]
    pub fn pass_triangles(&self, pass: Pass) -> Range<u32> {
        self.pass_triangles[pass as usize].clone()
    }

    /// The drawn instances.
    #[must_use]
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// The materials.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The images that textures use.
    #[must_use]
    pub fn images(&self) -> &[Image] {
        &self.images
    }

    /// The lights.
    #[must_use]
    pub fn lights(&self) -> &[SceneLight] {
        &self.lights
    }

    /// The cameras.
    #[must_use]
    pub fn cameras(&self) -> &[SceneCamera] {
        &self.cameras
    }

    /// The bounds of every triangle; of a scene without triangles, a cube of 1 m around the origin.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The point of a triangle that a ray meets.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[inline]
    #[must_use]
    pub fn point(&self, triangle: u32, ray: Ray) -> TrianglePoint {
        let [i0, i1, i2] = self.triangles[triangle as usize].map(|corner| corner as usize);
        let positions = &self.vertices.positions;
        triangle_point(ray, positions[i0], positions[i1], positions[i2])
    }

    /// The receiver that a pixel's ray sees on a triangle; `rays` are those through all pixels.
    ///
    /// # Panics
    ///
    /// If there is no such triangle.
    #[inline]
    #[must_use]
    pub fn receiver(&self, triangle: u32, rays: &PixelRays, pixel: [u32; 2]) -> Receiver {
        let ray = pixel_ray(rays, pixel[0] as f32 + 0.5, pixel[1] as f32 + 0.5);
        let hit = self.point(triangle, ray);
        let normal = turned_to_viewer(hit.normal, hit.normal, ray);
        Receiver { point: hit.point, normal, pixel, steps: pixel_steps(rays, ray, hit.point, normal) }
    }

    /// Whether the only camera is one that frames the bounds, since the scene brought none.
    #[must_use]
    pub fn has_default_camera(&self) -> bool {
        self.has_default_camera
    }

    /// Whether the only light is a sun, since the scene brought none.
    #[must_use]
    pub fn has_default_light(&self) -> bool {
        self.has_default_light
    }

    /// What a person should know about how the scene was made: parts that were left out or changed.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// What there is in the file that the scene came from; nothing for a scene that came from no file.
    #[must_use]
    pub fn source(&self) -> &SourceFacts {
        &self.source
    }

    /// Whether a triangle casts shadows.
    #[inline]
    #[must_use]
    pub fn casts_shadow(&self, triangle: u32) -> bool {
        !Pass::ALL.into_iter().any(|pass| !pass.casts_shadows() && self.pass_triangles[pass as usize].contains(&triangle))
    }

    /// The same scene in which instances cast shadows as `casts` says of their index and of them.
    #[must_use]
    pub fn with_casters(mut self, casts: impl Fn(usize, &Instance) -> bool) -> Self {
        let drawn: usize = self.pass_triangles.iter().map(ExactSizeIterator::len).sum();
        for index in 0..self.instances.len() {
            self.instances[index].casts_shadows = casts(index, &self.instances[index]);
        }
        let pass_of = |triangle: &u32| {
            let pass = self.materials[self.triangle_materials[*triangle as usize] as usize].pass();
            let casts = self.instances[self.triangle_instances[*triangle as usize] as usize].casts_shadows;
            if casts { pass } else { pass.without_shadows() }
        };
        // A stable sort: within a pass triangles stay in the order in which they were added. Those without an area come last, in no pass.
        let mut order: Vec<u32> = (0..drawn as u32).collect();
        order.sort_by_key(|triangle| pass_of(triangle) as usize);
        let mut first = 0;
        self.pass_triangles = Pass::ALL.map(|pass| {
            let start = first;
            first += order.iter().skip(start as usize).take_while(|triangle| pass_of(triangle) == pass).count() as u32;
            start..first
        });
        order.extend(drawn as u32..self.triangles.len() as u32);
        self.triangles = order.iter().map(|&triangle| self.triangles[triangle as usize]).collect();
        self.triangle_materials = order.iter().map(|&triangle| self.triangle_materials[triangle as usize]).collect();
        self.triangle_instances = order.iter().map(|&triangle| self.triangle_instances[triangle as usize]).collect();
        self
    }

    /// The same scene with one more image, and the image's index.
    ///
    /// # Panics
    ///
    /// If the image does not have as many texels as its size says, or none.
    #[must_use]
    pub fn with_image(mut self, image: Image) -> (Self, u32) {
        let texels = image.width as usize * image.height as usize;
        assert!(texels > 0 && texels == image.texels.len(), "an image has as many texels as its size says");
        self.images.push(image);
        let index = self.images.len() as u32 - 1;
        (self, index)
    }

    /// The same scene under other lights.
    #[must_use]
    pub fn with_lights(mut self, lights: Vec<SceneLight>) -> Self {
        self.lights = lights;
        self.has_default_light = false;
        self
    }
}
