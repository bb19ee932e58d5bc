//! Materials, and the one function that samples their textures.
//!
//! Mirrored by `material.wgsl`.

use glam::{Vec2, Vec4};

/// [`TextureData::first_word`] of a material without a texture.
pub const NO_TEXTURE: u32 = u32::MAX;

/// Bit of [`MaterialData::flags`]: texels whose alpha is below the cutoff do not exist (glTF's `alphaMode` MASK).
pub const FLAG_MASK: u32 = 1;
/// Bit of [`MaterialData::flags`]: both sides are drawn; without it the camera culls back faces.
pub const FLAG_DOUBLE_SIDED: u32 = 2;

/// [`TextureData::wrap_u`] and `wrap_v`: coordinates beyond the edge repeat the texture.
pub const WRAP_REPEAT: u32 = 0;
/// Coordinates beyond the edge take the edge's texel.
pub const WRAP_CLAMP: u32 = 1;
/// Coordinates beyond the edge repeat the texture, every other time mirrored.
pub const WRAP_MIRROR: u32 = 2;

/// The number of entries of the table that begins the texel buffer: see [`crate::srgb::decode_table`].
pub const DECODE_TABLE_LEN: u32 = 512;
/// Where in it the values of alpha begin.
pub const ALPHA_TABLE: u32 = 256;

/// A texture as both renderers read it: where its texels lie in the texel buffer, and how it wraps.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TextureData {
    /// The index of the first texel's word, or [`NO_TEXTURE`]. The buffer begins with [`DECODE_TABLE_LEN`] words of decode table.
    pub first_word: u32,
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// How u wraps: [`WRAP_REPEAT`], [`WRAP_CLAMP`] or [`WRAP_MIRROR`].
    pub wrap_u: u32,
    /// How v wraps.
    pub wrap_v: u32,
}

impl TextureData {
    /// No texture.
    pub const NONE: Self = Self { first_word: NO_TEXTURE, width: 1, height: 1, wrap_u: WRAP_REPEAT, wrap_v: WRAP_REPEAT };
}

/// A material as both renderers read it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct MaterialData {
    /// The base colour, linear, and alpha.
    pub base_color: [f32; 4],
    /// Alpha below this is a hole, where [`FLAG_MASK`] is set.
    pub alpha_cutoff: f32,
    /// [`FLAG_MASK`] and [`FLAG_DOUBLE_SIDED`].
    pub flags: u32,
    /// The exponent of the Blinn-Phong highlight, at least 1.
    pub shininess: f32,
    /// The texture that multiplies the base colour.
    pub texture: TextureData,
}

/// The texel index that `index`, at most `2^23` either way, wraps to on an axis of `size` texels, at most `2^22`.
#[inline(always)]
#[must_use]
pub fn wrap_texel(index: i32, size: i32, wrap: u32) -> i32 {
    if index >= 0 && index < size {
        return index;
    }
    if wrap == WRAP_CLAMP {
        return index.max(0).min(size - 1);
    }
    let mut period = size;
    if wrap == WRAP_MIRROR {
        period = 2 * size;
    }
    // Indices are at most 2^23, so that both numbers are exact in f32 and the quotient's floor is at most one off: faster than an integer division.
    let mut wrapped = index - floor(index as f32 / period as f32) as i32 * period;
    if wrapped < 0 {
        wrapped += period;
    }
    if wrapped >= period {
        wrapped -= period;
    }
    if wrapped >= size {
        wrapped = period - 1 - wrapped;
    }
    wrapped
}

/// One texel, decoded: linear colour and alpha. `words` begins with the decode table.
#[inline(always)]
#[must_use]
pub fn decode_texel(words: &[u32], texel: u32) -> Vec4 {
    let r = f32::from_bits(words[(texel & 0xff) as usize]);
    let g = f32::from_bits(words[(texel >> 8 & 0xff) as usize]);
    let b = f32::from_bits(words[(texel >> 16 & 0xff) as usize]);
    let a = f32::from_bits(words[(ALPHA_TABLE + (texel >> 24)) as usize]);
    Vec4::new(r, g, b, a)
}

/// The largest texture coordinate, in texels, that is taken as it is: beyond it f32 has no fraction of a texel left.
pub const MAX_TEXEL_COORDINATE: f32 = 8_388_608.0;

/// The texture at `uv`, bilinear, level 0: linear colour and alpha.
///
/// `uv` has its origin at the top left corner, as in glTF. Colours are decoded from sRGB before they are averaged.
/// A coordinate that is not finite gives some texel of the texture.
#[inline(always)]
#[must_use]
pub fn sample_texture(words: &[u32], texture: &TextureData, uv: Vec2) -> Vec4 {
    let taps = texture_taps(texture, uv);
    let t00 = decode_texel(words, words[taps.words[0] as usize]);
    let t10 = decode_texel(words, words[taps.words[1] as usize]);
    let t01 = decode_texel(words, words[taps.words[2] as usize]);
    let t11 = decode_texel(words, words[taps.words[3] as usize]);
    let top = t00 + (t10 - t00) * taps.fraction.x;
    let bottom = t01 + (t11 - t01) * taps.fraction.x;
    top + (bottom - top) * taps.fraction.y
}

/// The four texels that a bilinear sample reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureTaps {
    /// Their words: upper left, upper right, lower left, lower right.
    pub words: [u32; 4],
    /// The weights of the right and of the lower ones.
    pub fraction: Vec2,
}

/// Which texels of a texture a sample at `uv` reads; the first half of [`sample_texture`].
#[inline(always)]
#[must_use]
pub fn texture_taps(texture: &TextureData, uv: Vec2) -> TextureTaps {
    let width = texture.width as i32;
    let height = texture.height as i32;
    let x = (uv.x * texture.width as f32 - 0.5).max(-MAX_TEXEL_COORDINATE).min(MAX_TEXEL_COORDINATE);
    let y = (uv.y * texture.height as f32 - 0.5).max(-MAX_TEXEL_COORDINATE).min(MAX_TEXEL_COORDINATE);
    let floor_x = floor(x);
    let floor_y = floor(y);
    let x0 = wrap_texel(floor_x as i32, width, texture.wrap_u);
    let x1 = wrap_texel(floor_x as i32 + 1, width, texture.wrap_u);
    let y0 = wrap_texel(floor_y as i32, height, texture.wrap_v);
    let y1 = wrap_texel(floor_y as i32 + 1, height, texture.wrap_v);
    let row0 = texture.first_word + (y0 * width) as u32;
    let row1 = texture.first_word + (y1 * width) as u32;
    TextureTaps {
        words: [row0 + x0 as u32, row0 + x1 as u32, row1 + x0 as u32, row1 + x1 as u32],
        fraction: Vec2::new(x - floor_x, y - floor_y),
    }
}

/// Rounds toward minus infinity: `floor` of `core`-only builds and of the shader alike.
#[inline(always)]
fn floor(x: f32) -> f32 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    x.floor()
}

/// The material's colour and alpha at a point, before light: factor times texture times vertex colour.
#[inline(always)]
#[must_use]
pub fn base_color(material: &MaterialData, words: &[u32], uv: Vec2, vertex_color: Vec4) -> Vec4 {
    let mut color = Vec4::from_array(material.base_color) * vertex_color;
    if material.texture.first_word != NO_TEXTURE {
        color *= sample_texture(words, &material.texture, uv);
    }
    color
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checker(wrap: u32) -> ([u32; 516], TextureData) {
        // The identity as a decode table: a byte of 255 is 1.0, one of 0 is 0.0.
        let mut words = [0; 516];
        for (index, word) in words.iter_mut().take(512).enumerate() {
            *word = ((index % 256) as f32 / 255.0).to_bits();
        }
        words[512] = 0xffff_ffff;
        words[515] = 0xffff_ffff;
        (words, TextureData { first_word: DECODE_TABLE_LEN, width: 2, height: 2, wrap_u: wrap, wrap_v: wrap })
    }

    #[test]
    fn texel_centres_give_the_texel_and_corners_the_mean() {
        let (words, texture) = checker(WRAP_REPEAT);
        assert_eq!(sample_texture(&words, &texture, Vec2::new(0.25, 0.25)), Vec4::ONE);
        assert_eq!(sample_texture(&words, &texture, Vec2::new(0.75, 0.25)), Vec4::ZERO);
        assert_eq!(sample_texture(&words, &texture, Vec2::new(0.5, 0.5)), Vec4::splat(0.5));
    }

    #[test]
    fn each_wrap_mode_continues_the_texture_as_gltf_says() {
        let expected = [
            (WRAP_REPEAT, [2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1]),
            (WRAP_CLAMP, [0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 3, 3]),
            (WRAP_MIRROR, [1, 0, 0, 1, 2, 3, 3, 2, 1, 0, 0, 1]),
        ];
        let first = [-6, -6, -5];
        for ((wrap, texels), first) in expected.into_iter().zip(first) {
            for (step, texel) in texels.into_iter().enumerate() {
                let index = first + step as i32;
                let start = if wrap == WRAP_MIRROR { index + 3 } else { index };
                assert_eq!(wrap_texel(start, 4, wrap), texel, "wrap {wrap}, index {start}");
            }
        }
    }

    #[test]
    fn coordinates_that_are_not_finite_stay_inside() {
        let (words, texture) = checker(WRAP_MIRROR);
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30] {
            assert!(sample_texture(&words, &texture, Vec2::splat(bad)).is_finite() || bad.is_nan());
        }
    }
}
