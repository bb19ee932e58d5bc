//! The colour of a span of pixels.

use shadow_math::{
    glam::{Vec2, Vec3},
    material::{NO_TEXTURE, texture_taps},
    picture::picture_color,
    plan::{CameraPlan, LightPlan, toward_light},
    shade::{Surface, light_reach, shade_ambient, shade_light, shadow_factor},
    triangle::pixel_ray,
    vector::normalized,
};

use super::{
    SceneView,
    span::{Corners, Hits, Numbers, SPAN, Vectors},
};

/// What the surfaces of a span are made of.
pub(crate) struct SurfaceSpan {
    uv: [Numbers; 2],
    base_color: Vectors,
    shininess: Numbers,
    normal: Vectors,
    toward_viewer: Vectors,
    /// What lights with a soft terminator ask for; 0 where there are none.
    deviation: Numbers,
}

/// The texels around the samples of a span, decoded, and their weights.
struct Texels {
    color: [Vectors; 4],
    fraction: [Numbers; 2],
}

impl SurfaceSpan {
    pub(crate) const EMPTY: Self = Self {
        uv: [[0.0; SPAN]; 2],
        base_color: Vectors::ZERO,
        shininess: [1.0; SPAN],
        normal: Vectors::ZERO,
        toward_viewer: Vectors::ZERO,
        deviation: [0.0; SPAN],
    };

    /// The surfaces of the span that begins at pixel (`x`, `y`).
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        view: SceneView<'_>,
        camera: &CameraPlan,
        (x, y): (usize, usize),
        corners: &Corners,
        hits: &Hits,
        count: usize,
    ) {
        let rays = camera.rays;
        let row = y as f32 + 0.5;
        for i in 0..SPAN {
            let (u, v) = corners.texture_coordinates(i, hits.u[i], hits.v[i]);
            self.uv[0][i] = u;
            self.uv[1][i] = v;
            self.normal.set(i, normalized(corners.normal(i, hits.u[i], hits.v[i])) * hits.side[i]);
            let ray = pixel_ray(&rays, (x + i) as i32 as f32 + 0.5, row);
            self.toward_viewer.set(i, normalized(-ray.direction));
        }
        self.sample_materials(view, corners, hits, count);
    }

    #[inline(always)]
    fn surface(&self, hits: &Hits, i: usize) -> Surface {
        Surface {
            point: hits.point.get(i),
            normal: self.normal.get(i),
            deviation: self.deviation[i],
            toward_viewer: self.toward_viewer.get(i),
            base_color: self.base_color.get(i),
            shininess: self.shininess[i],
        }
    }

    /// How far the triangles lean away from their smooth normals.
    #[inline(always)]
    pub(crate) fn deviate(&mut self, deviations: &[f32], corners: &Corners, hits: &Hits) {
        for i in 0..SPAN {
            let [d0, d1, d2] = corners.indices(i).map(|corner| deviations[corner]);
            self.deviation[i] = d0 + (d1 - d0) * hits.u[i] + (d2 - d0) * hits.v[i];
        }
    }

    /// Light from everywhere.
    #[inline(always)]
    pub(crate) fn ambient(&self, camera: &CameraPlan, hits: &Hits, radiance: &mut Vectors) {
        let ambient = Vec3::new(camera.ambient[0], camera.ambient[1], camera.ambient[2]);
        for i in 0..SPAN {
            radiance.set(i, shade_ambient(ambient, &self.surface(hits, i)));
        }
    }

    /// Adds one light.
    #[inline(always)]
    pub(crate) fn add_light(&self, words: &[u32], light: &LightPlan, hits: &Hits, visibility: &Numbers, radiance: &mut Vectors) {
        let light = *light;
        if light.picture_width > 0 {
            for i in 0..SPAN {
                let picture = picture_color(words, &light, hits.point.get(i));
                radiance.set(i, radiance.get(i) + shade_light(&light, &self.surface(hits, i), visibility[i]) * picture);
            }
            return;
        }
        // A light without a picture is multiplied by 1, which changes nothing.
        for i in 0..SPAN {
            radiance.set(i, radiance.get(i) + shade_light(&light, &self.surface(hits, i), visibility[i]));
        }
    }

    /// Adds one light wherever it would fall, and multiplies the factor of all shadows by its own.
    #[inline(always)]
    pub(crate) fn add_unshadowed(
        &self,
        words: &[u32],
        camera: &CameraPlan,
        light: &LightPlan,
        hits: &Hits,
        visibility: &Numbers,
        (radiance, factor): (&mut Vectors, &mut Vectors),
    ) {
        let color = Vec3::new(camera.shadow_color[0], camera.shadow_color[1], camera.shadow_color[2]);
        for i in 0..SPAN {
            let reach = light_reach(light, toward_light(light, hits.point.get(i)));
            let own = shadow_factor(color, visibility[i], reach);
            // Where a slide is dark its light has no shadow.
            let picture = picture_color(words, light, hits.point.get(i));
            factor.set(i, factor.get(i) * (Vec3::ONE - (Vec3::ONE - own) * picture));
        }
        self.add_light(words, light, hits, &[1.0; SPAN], radiance);
    }

    /// The materials' part: base colour and shininess.
    #[inline(always)]
    fn sample_materials(&mut self, view: SceneView<'_>, corners: &Corners, hits: &Hits, count: usize) {
        let mut texels = Texels { color: [Vectors([[1.0; SPAN]; 3]); 4], fraction: [[0.0; SPAN]; 2] };
        let words = &view.surfaces.words;
        let mut is_textured = false;
        for i in 0..count {
            let triangle = corners.triangle[i] as usize;
            let material = &view.surfaces.materials[view.scene.triangle_materials()[triangle] as usize];
            self.shininess[i] = material.shininess;
            for channel in 0..3 {
                self.base_color.0[channel][i] = material.base_color[channel];
            }
            if material.texture.first_word != NO_TEXTURE {
                is_textured = true;
                let taps = texture_taps(&material.texture, Vec2::new(self.uv[0][i], self.uv[1][i]));
                for tap in 0..4 {
                    let texel = words[taps.words[tap] as usize];
                    // Alpha plays no part in the colour of what is there.
                    for channel in 0..3 {
                        let byte = texel >> (8 * channel) & 0xff;
                        texels.color[tap].0[channel][i] = f32::from_bits(words[byte as usize]);
                    }
                }
                texels.fraction[0][i] = taps.fraction.x;
                texels.fraction[1][i] = taps.fraction.y;
            }
        }
        if view.vertices.has_colors {
            let colors = &view.scene.vertices().colors;
            for i in 0..count {
                let [v0, v1, v2] = corners.indices(i);
                let (c0, c1, c2) = (colors[v0], colors[v1], colors[v2]);
                let color = c0 + (c1 - c0) * hits.u[i] + (c2 - c0) * hits.v[i];
                self.base_color.set(i, self.base_color.get(i) * Vec3::new(color.x, color.y, color.z));
            }
        }
        if is_textured {
            for channel in 0..3 {
                for i in 0..SPAN {
                    let [t00, t10, t01, t11] = &texels.color;
                    let (t00, t10) = (t00.0[channel][i], t10.0[channel][i]);
                    let (t01, t11) = (t01.0[channel][i], t11.0[channel][i]);
                    let top = t00 + (t10 - t00) * texels.fraction[0][i];
                    let bottom = t01 + (t11 - t01) * texels.fraction[0][i];
                    // A pixel without a texture has texels of 1, which give exactly 1.
                    self.base_color.0[channel][i] *= top + (bottom - top) * texels.fraction[1][i];
                }
            }
        }
    }
}
