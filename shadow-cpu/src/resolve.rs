//! From the visibility buffer to visibility and colour: once a pixel, from the triangle's vertices.
//!
//! Mirrored by `resolve_visibility.wgsl`, `resolve_color.wgsl` and `surfaces.wgsl`.

use rayon::prelude::*;
use shadow_math::{
    caster::texel_ray,
    material::FLAG_MASK,
    plan::{COMPOSE_ADDITIVE, COMPOSE_FACTOR, COMPOSE_MODULATIVE, PixelRays, TERMINATOR_SOFT, ViewPlan},
    shade::BACKGROUND,
    triangle::pixel_ray,
    vector::row_times_point,
    visibility::MapAccess,
};
use shadow_scene::{FramePlan, NO_TRIANGLE, Scene, Surfaces};

use self::{
    color::SurfaceSpan,
    span::{Corners, Hits, SPAN, Vectors},
    visibility::span_visibility,
};
use crate::{
    buffer::Buffer,
    kernel::{Kernel, MultiplyAdd, dispatch, lanes::Lanes},
    raster::AlphaTest,
};

mod color;
mod span;
mod visibility;

pub(crate) use self::span::ShadingVertices;

/// The depths of all shadow maps: one layer a view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShadowMaps {
    /// Width and height of a layer in texels.
    pub size: u32,
    /// The layers, row by row from the top.
    pub layers: Vec<Buffer<f32>>,
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
    /// Its vertices as shading reads them.
    pub(crate) vertices: &'a ShadingVertices,
}

/// The alpha test of a scene's masked triangles, for the rays of a camera.
#[derive(Clone, Copy, Debug)]
pub struct SceneAlphaTest<'a> {
    /// The scene.
    pub view: SceneView<'a>,
    /// The rays through the target's pixels.
    pub rays: &'a PixelRays,
}

impl AlphaTest for SceneAlphaTest<'_> {
    fn passes(&self, triangle: u32, x: u32, y: u32) -> bool {
        let SceneView { scene, surfaces, .. } = self.view;
        let material = surfaces.material(scene, triangle);
        if material.flags & FLAG_MASK == 0 {
            return true;
        }
        let ray = pixel_ray(self.rays, x as f32 + 0.5, y as f32 + 0.5);
        let hit = scene.point(triangle, ray);
        surfaces.color(scene, triangle, hit.u, hit.v).w >= material.alpha_cutoff
    }
}

/// What casters are tested by at the texels of a view: the alpha of masked ones, and on which side of the view's half-space they lie.
#[derive(Clone, Copy, Debug)]
pub struct ViewTest<'a> {
    /// The scene.
    pub view: SceneView<'a>,
    /// The view.
    pub plan: &'a ViewPlan,
}

impl AlphaTest for ViewTest<'_> {
    fn passes(&self, triangle: u32, x: u32, y: u32) -> bool {
        let SceneView { scene, surfaces, .. } = self.view;
        let hit = scene.point(triangle, texel_ray(self.plan, x as f32 + 0.5, y as f32 + 0.5));
        if row_times_point(self.plan.half_space, hit.point) < 0.0 {
            return false;
        }
        let material = surfaces.material(scene, triangle);
        material.flags & FLAG_MASK == 0 || surfaces.color(scene, triangle, hit.u, hit.v).w >= material.alpha_cutoff
    }
}

/// What a frame's pixels are made of; `None` for what is not wanted.
#[derive(Debug, Default)]
pub struct Resolved<'a> {
    /// The visibility of every light at every pixel, the lights of a pixel side by side: 1 where there is nothing.
    pub visibility: Option<&'a mut [f32]>,
    /// The colour of every pixel, linear, after exposure.
    pub color: Option<&'a mut [[f32; 4]]>,
}

/// Visibility from shadow maps, and colour from it, row by row. `triangles` is the camera's triangle layer.
///
/// # Panics
///
/// If an output does not have the size of the picture.
pub fn resolve(view: SceneView<'_>, plan: &FramePlan, triangles: &[u32], maps: &ShadowMaps, out: Resolved<'_>) {
    resolve_from(view, plan, triangles, Source::Maps(maps), out);
}

/// The colour of every pixel, linear, after exposure.
///
/// `triangles` is the camera's triangle layer, `visibility` that of every light at every pixel, the lights of a pixel side by side.
///
/// # Panics
///
/// If a layer does not have the size of the picture.
pub fn resolve_color(view: SceneView<'_>, plan: &FramePlan, triangles: &[u32], visibility: &[f32], out: &mut [[f32; 4]]) {
    let out = Resolved { visibility: None, color: Some(out) };
    resolve_from(view, plan, triangles, Source::Visibility(visibility), out);
}

/// Where visibilities come from.
#[derive(Clone, Copy)]
enum Source<'a> {
    Maps(&'a ShadowMaps),
    Visibility(&'a [f32]),
}

fn resolve_from(view: SceneView<'_>, plan: &FramePlan, triangles: &[u32], source: Source<'_>, out: Resolved<'_>) {
    let (width, light_count) = (plan.camera.width as usize, plan.lights.len());
    let Resolved { visibility, color } = out;
    let visibility = visibility.unwrap_or_default();
    let color = color.unwrap_or_default();
    assert!(
        visibility.is_empty() || visibility.len() == triangles.len() * light_count,
        "visibility must have the picture's size"
    );
    assert!(color.is_empty() || color.len() == triangles.len(), "color must have the picture's size");
    // A chunk of an empty layer is empty: the rows of what is not wanted are made of nothing.
    let rows = triangles.len() / width.max(1);
    let visibility_rows = RowsOf { layer: visibility, len: width * light_count }.split(rows);
    let color_rows = RowsOf { layer: color, len: width }.split(rows);
    let rows = triangles.par_chunks(width.max(1)).zip(visibility_rows).zip(color_rows);
    rows.enumerate().for_each(|(y, ((triangles, visibility), color))| {
        dispatch(false, RowKernel { view, plan, source, y, triangles, visibility, color });
    });
}

/// A layer that is wanted, or an empty one.
struct RowsOf<'a, T> {
    layer: &'a mut [T],
    len: usize,
}

impl<'a, T: Send> RowsOf<'a, T> {
    /// Its rows, or as many empty ones.
    fn split(self, rows: usize) -> Vec<&'a mut [T]> {
        if self.layer.is_empty() {
            (0..rows).map(|_| Default::default()).collect()
        } else {
            self.layer.chunks_mut(self.len).collect()
        }
    }
}

struct RowKernel<'a> {
    view: SceneView<'a>,
    plan: &'a FramePlan,
    source: Source<'a>,
    y: usize,
    triangles: &'a [u32],
    visibility: &'a mut [f32],
    color: &'a mut [[f32; 4]],
}

impl Kernel for RowKernel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes, M: MultiplyAdd>(self) {
        let Self { view, plan, source, y, triangles, visibility, color } = self;
        let light_count = plan.lights.len();
        let wants_color = !color.is_empty();
        let mut corners = Corners::EMPTY;
        let mut hits = Hits::EMPTY;
        let mut surfaces = SurfaceSpan::EMPTY;
        let mut radiance = Vectors::ZERO;
        let mut factor = Vectors([[1.0; SPAN]; 3]);
        let is_any_soft = plan.lights.iter().any(|light| light.terminator == TERMINATOR_SOFT);
        let composition = plan.camera.composition;
        let first = plan.camera.first_light as usize;
        let drawn = first..first + plan.camera.light_count as usize;
        let background = [BACKGROUND[0], BACKGROUND[1], BACKGROUND[2], 1.0];
        for (span, seen) in triangles.chunks(SPAN).enumerate() {
            let x = span * SPAN;
            let pixels = x..x + seen.len();
            let of_lights = x * light_count..pixels.end * light_count;
            if seen.iter().all(|&triangle| triangle == NO_TRIANGLE) {
                if !visibility.is_empty() {
                    visibility[of_lights].fill(1.0);
                }
                if wants_color {
                    color[pixels].fill(background);
                }
                continue;
            }
            corners.fetch::<L>(view, seen, wants_color);
            hits.intersect(&corners, &plan.camera.rays, x, y);
            if wants_color {
                surfaces.sample(view, &plan.camera, (x, y), &corners, &hits, seen.len());
                if is_any_soft {
                    surfaces.deviate(view.scene.deviations(), &corners, &hits);
                }
                surfaces.ambient(&plan.camera, &hits, &mut radiance);
                factor = Vectors([[1.0; SPAN]; 3]);
            }
            for (l, light) in plan.lights.iter().enumerate() {
                let mut numbers = [1.0; SPAN];
                match source {
                    Source::Maps(maps) => {
                        span_visibility(light, &plan.views, maps, &hits, &plan.camera.rays, seen.len(), &mut numbers);
                    }
                    Source::Visibility(visibility) => {
                        let row = &visibility[y * plan.camera.width as usize * light_count..];
                        for (i, number) in numbers[..seen.len()].iter_mut().enumerate() {
                            *number = row[of_lights.start + i * light_count + l];
                        }
                    }
                }
                if !visibility.is_empty() {
                    let out = &mut visibility[of_lights.clone()];
                    for (i, &triangle) in seen.iter().enumerate() {
                        out[i * light_count + l] = if triangle == NO_TRIANGLE { 1.0 } else { numbers[i] };
                    }
                }
                if wants_color && drawn.contains(&l) {
                    if composition == COMPOSE_ADDITIVE {
                        surfaces.add_light(&view.surfaces.words, light, &hits, &numbers, &mut radiance);
                    } else {
                        let sums = (&mut radiance, &mut factor);
                        surfaces.add_unshadowed(&view.surfaces.words, &plan.camera, light, &hits, &numbers, sums);
                    }
                }
            }
            if wants_color {
                let exposure = plan.camera.exposure;
                for (i, (out, &triangle)) in color[pixels].iter_mut().zip(seen).enumerate() {
                    let lit = match composition {
                        COMPOSE_MODULATIVE => radiance.get(i) * factor.get(i) * exposure,
                        COMPOSE_FACTOR => factor.get(i),
                        _ => radiance.get(i) * exposure,
                    };
                    let [r, g, b] = lit.to_array();
                    *out = if triangle == NO_TRIANGLE { background } else { [r, g, b, 1.0] };
                }
            }
        }
    }
}
