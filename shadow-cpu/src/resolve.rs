//! From the visibility buffer to visibility and colour: once a pixel, from the triangle's vertices.
//!
//! Mirrored by `resolve_visibility.wgsl`, `resolve_color.wgsl` and `surfaces.wgsl`.

use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;
use shadow_math::{
    material::{FLAG_MASK, base_color},
    plan::{CameraPlan, PixelRays},
    shade::{BACKGROUND, Surface, shade_ambient, shade_light},
    triangle::{TrianglePoint, pixel_ray, turned_to_viewer},
    vector::normalized,
    visibility::{MapAccess, visibility},
};
use shadow_scene::{FramePlan, NO_TRIANGLE, Scene, Surfaces};

use crate::{
    kernel::{Kernel, MultiplyAdd, dispatch, lanes::Lanes},
    raster::AlphaTest,
};

/// The depths of all shadow maps: one layer a view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShadowMaps {
    /// Width and height of a layer in texels.
    pub size: u32,
    /// The layers, row by row from the top.
    pub layers: Vec<Vec<f32>>,
}

impl MapAccess for ShadowMaps {
    #[inline]
    fn fetch_texel(&self, layer: u32, x: u32, y: u32) -> f32 {
        self.layers[layer as usize][y as usize * self.size as usize + x as usize]
    }
}

/// A scene's triangles and surfaces, as pixels ask for them.
#[derive(Clone, Copy, Debug)]
pub struct SceneView<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its materials and textures.
    pub surfaces: &'a Surfaces,
}

impl SceneView<'_> {
    #[inline]
    fn corners(&self, triangle: u32) -> [usize; 3] {
        self.scene.triangles()[triangle as usize].map(|corner| corner as usize)
    }

    /// The colour and alpha of a triangle's surface at a point of it.
    #[inline]
    fn color(&self, triangle: u32, hit: &TrianglePoint) -> Vec4 {
        let [i0, i1, i2] = self.corners(triangle);
        let vertices = self.scene.vertices();
        let (uv0, uv1, uv2) = (vertices.uvs[i0], vertices.uvs[i1], vertices.uvs[i2]);
        let (c0, c1, c2) = (vertices.colors[i0], vertices.colors[i1], vertices.colors[i2]);
        let uv: Vec2 = uv0 + (uv1 - uv0) * hit.u + (uv2 - uv0) * hit.v;
        let color = c0 + (c1 - c0) * hit.u + (c2 - c0) * hit.v;
        let material = &self.surfaces.materials[self.scene.triangle_materials()[triangle as usize] as usize];
        base_color(material, &self.surfaces.words, uv, color)
    }
}

/// The alpha test of a scene's masked triangles, for the rays of one camera or light.
#[derive(Clone, Copy, Debug)]
pub struct SceneAlphaTest<'a> {
    /// The scene.
    pub view: SceneView<'a>,
    /// The rays through the target's pixels.
    pub rays: &'a PixelRays,
}

impl AlphaTest for SceneAlphaTest<'_> {
    fn passes(&self, triangle: u32, x: u32, y: u32) -> bool {
        let material = &self.view.surfaces.materials[self.view.scene.triangle_materials()[triangle as usize] as usize];
        if material.flags & FLAG_MASK == 0 {
            return true;
        }
        let ray = pixel_ray(self.rays, x as f32 + 0.5, y as f32 + 0.5);
        let hit = self.view.scene.point(triangle, ray);
        self.view.color(triangle, &hit).w >= material.alpha_cutoff
    }
}

/// The visibility of every light at every pixel, the lights of a pixel side by side: 1 where there is nothing.
///
/// `triangles` is the camera's triangle layer.
#[must_use]
pub fn resolve_visibility(view: SceneView<'_>, plan: &FramePlan, triangles: &[u32], maps: &ShadowMaps) -> Vec<f32> {
    let light_count = plan.lights.len();
    let mut out = vec![1.0; triangles.len() * light_count];
    if light_count == 0 {
        return out;
    }
    let width = plan.camera.width as usize;
    let rows = out.par_chunks_mut(width * light_count).zip(triangles.par_chunks(width));
    rows.enumerate().for_each(|(y, (out, triangles))| {
        dispatch(false, VisibilityKernel { view, plan, maps, y, triangles, out });
    });
    out
}

struct VisibilityKernel<'a> {
    view: SceneView<'a>,
    plan: &'a FramePlan,
    maps: &'a ShadowMaps,
    y: usize,
    triangles: &'a [u32],
    out: &'a mut [f32],
}

impl Kernel for VisibilityKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes, M: MultiplyAdd>(self) {
        let Self { view, plan, maps, y, triangles, out } = self;
        for ((x, &triangle), out) in triangles.iter().enumerate().zip(out.chunks_exact_mut(plan.lights.len())) {
            if triangle == NO_TRIANGLE {
                continue;
            }
            let ray = pixel_ray(&plan.camera.rays, x as f32 + 0.5, y as f32 + 0.5);
            let receiver = view.scene.receiver(triangle, ray);
            for (light, out) in plan.lights.iter().zip(out) {
                *out = visibility(light, &plan.views, maps, &receiver);
            }
        }
    }
}

/// The colour of every pixel, linear, after exposure.
///
/// `triangles` is the camera's triangle layer, `visibility` what [`resolve_visibility`] gave.
#[must_use]
pub fn resolve_color(view: SceneView<'_>, plan: &FramePlan, triangles: &[u32], visibility: &[f32]) -> Vec<[f32; 4]> {
    let mut out = vec![[0.0; 4]; triangles.len()];
    let width = plan.camera.width as usize;
    let light_count = plan.lights.len();
    out.par_chunks_mut(width).zip(triangles.par_chunks(width)).enumerate().for_each(|(y, (out, triangles))| {
        let visibility = &visibility[y * width * light_count..][..triangles.len() * light_count];
        dispatch(false, ColorKernel { view, plan, y, triangles, visibility, out });
    });
    out
}

struct ColorKernel<'a> {
    view: SceneView<'a>,
    plan: &'a FramePlan,
    y: usize,
    triangles: &'a [u32],
    visibility: &'a [f32],
    out: &'a mut [[f32; 4]],
}

impl Kernel for ColorKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes, M: MultiplyAdd>(self) {
        let Self { view, plan, y, triangles, visibility, out } = self;
        let light_count = plan.lights.len();
        for (x, (out, &triangle)) in out.iter_mut().zip(triangles).enumerate() {
            let visibility = &visibility[x * light_count..][..light_count];
            *out = pixel_color(view, plan, triangle, x as f32 + 0.5, y as f32 + 0.5, visibility);
        }
    }
}

/// The colour of one pixel.
#[inline]
fn pixel_color(view: SceneView<'_>, plan: &FramePlan, triangle: u32, x: f32, y: f32, visibility: &[f32]) -> [f32; 4] {
    if triangle == NO_TRIANGLE {
        return [BACKGROUND[0], BACKGROUND[1], BACKGROUND[2], 1.0];
    }
    let camera: &CameraPlan = &plan.camera;
    let ray = pixel_ray(&camera.rays, x, y);
    let hit = view.scene.point(triangle, ray);
    let base = view.color(triangle, &hit);
    let [i0, i1, i2] = view.corners(triangle);
    let normals = &view.scene.vertices().normals;
    let (n0, n1, n2) = (normals[i0], normals[i1], normals[i2]);
    let normal = normalized(n0 + (n1 - n0) * hit.u + (n2 - n0) * hit.v);
    let material = &view.surfaces.materials[view.scene.triangle_materials()[triangle as usize] as usize];
    let surface = Surface {
        point: hit.point,
        normal: turned_to_viewer(normal, hit.normal, ray),
        toward_viewer: normalized(-ray.direction),
        base_color: Vec3::new(base.x, base.y, base.z),
        shininess: material.shininess,
    };
    let ambient = Vec3::new(camera.ambient[0], camera.ambient[1], camera.ambient[2]);
    let mut radiance = shade_ambient(ambient, &surface);
    for (light, &visibility) in plan.lights.iter().zip(visibility) {
        radiance += shade_light(light, &surface, visibility);
    }
    let color = radiance * camera.exposure;
    [color.x, color.y, color.z, 1.0]
}
