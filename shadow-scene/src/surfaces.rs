//! Materials and textures as plain data that both renderers read.

use shadow_math::{
    glam::{Vec2, Vec4},
    material::{
        DECODE_TABLE_LEN, FLAG_DOUBLE_SIDED, FLAG_MASK, MaterialData, TextureData, WRAP_CLAMP, WRAP_MIRROR, WRAP_REPEAT,
        base_color,
    },
    shade::shininess_of_roughness,
    srgb::decode_table,
};

use crate::scene::{Alpha, Scene, Wrap};

/// The scene's materials, and all its texels in one buffer of words.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfaces {
    /// One entry a material of the scene.
    pub materials: Vec<MaterialData>,
    /// The decode table, then the images' texels, four bytes each, red in the lowest.
    pub words: Vec<u32>,
}

/// Where the texels of an image begin among the words of [`Surfaces`].
///
/// # Panics
///
/// If the scene has no such image.
#[must_use]
pub fn first_word_of(scene: &Scene, image: u32) -> u32 {
    let before: usize = scene.images()[..image as usize].iter().map(|image| image.texels.len()).sum();
    DECODE_TABLE_LEN + before as u32
}

impl Surfaces {
    /// The surfaces of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let texel_count: usize = scene.images().iter().map(|image| image.texels.len()).sum();
        let mut words = Vec::with_capacity(DECODE_TABLE_LEN as usize + texel_count);
        words.extend(decode_table().map(f32::to_bits));
        let first_words: Vec<u32> = scene
            .images()
            .iter()
            .map(|image| {
                let first = words.len() as u32;
                words.extend(image.texels.iter().map(|texel| u32::from_le_bytes(*texel)));
                first
            })
            .collect();

        let materials = scene
            .materials()
            .iter()
            .map(|material| {
                let texture = material.texture.map_or(TextureData::NONE, |texture| {
                    let image = &scene.images()[texture.image as usize];
                    TextureData {
                        first_word: first_words[texture.image as usize],
                        width: image.width,
                        height: image.height,
                        wrap_u: wrap_mode(texture.wrap_u),
                        wrap_v: wrap_mode(texture.wrap_v),
                    }
                });
                let (mask, alpha_cutoff) = match material.alpha {
                    Alpha::Opaque => (0, 0.0),
                    Alpha::Mask { cutoff } => (FLAG_MASK, cutoff),
                };
                MaterialData {
                    base_color: material.base_color.to_array(),
                    alpha_cutoff,
                    flags: mask | if material.double_sided { FLAG_DOUBLE_SIDED } else { 0 },
                    shininess: shininess_of_roughness(material.roughness),
                    texture,
                }
            })
            .collect();
        Self { materials, words }
    }
}

impl Surfaces {
    /// The colour and alpha of a triangle's surface where its second corner weighs `u` and its third `v`, before light.
    ///
    /// # Panics
    ///
    /// If the surfaces are not the scene's, or if there is no such triangle.
    #[inline]
    #[must_use]
    pub fn color(&self, scene: &Scene, triangle: u32, u: f32, v: f32) -> Vec4 {
        let [i0, i1, i2] = scene.triangles()[triangle as usize].map(|corner| corner as usize);
        let vertices = scene.vertices();
        let (uv0, uv1, uv2) = (vertices.uvs[i0], vertices.uvs[i1], vertices.uvs[i2]);
        let (c0, c1, c2) = (vertices.colors[i0], vertices.colors[i1], vertices.colors[i2]);
        let uv: Vec2 = uv0 + (uv1 - uv0) * u + (uv2 - uv0) * v;
        let color = c0 + (c1 - c0) * u + (c2 - c0) * v;
        base_color(self.material(scene, triangle), &self.words, uv, color)
    }

    /// The material of a triangle.
    ///
    /// # Panics
    ///
    /// As [`Surfaces::color`].
    #[inline]
    #[must_use]
    pub fn material(&self, scene: &Scene, triangle: u32) -> &MaterialData {
        &self.materials[scene.triangle_materials()[triangle as usize] as usize]
    }
}

fn wrap_mode(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => WRAP_REPEAT,
        Wrap::ClampToEdge => WRAP_CLAMP,
        Wrap::MirroredRepeat => WRAP_MIRROR,
    }
}
