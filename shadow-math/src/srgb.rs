//! The sRGB transfer function (IEC 61966-2-1).
//!
//! [`linear_to_srgb`] is mirrored by `srgb.wgsl`.

use glam::Vec4;

use crate::approx::pow;

/// Below this linear value the function is a straight line.
pub const LINEAR_LIMIT: f32 = 0.003_130_8;

/// Encodes one linear channel, clamped to 0 to 1. NaN gives 0.
#[inline]
#[must_use]
pub fn linear_to_srgb(linear: f32) -> f32 {
    let x = linear.max(0.0).min(1.0);
    if x <= LINEAR_LIMIT {
        return x * 12.92;
    }
    1.055 * pow(x, 0.416_666_66) - 0.055
}

/// A linear colour as the 8-bit sRGB pixel of a picture; alpha is 255.
#[must_use]
pub fn encode_pixel(color: Vec4) -> [u8; 4] {
    let channel = |linear: f32| (linear_to_srgb(linear) * 255.0 + 0.5) as u8;
    [channel(color.x), channel(color.y), channel(color.z), 255]
}

/// The linear value of each 8-bit sRGB value, and after these 256 that of each 8-bit alpha, which is its share of 255.
///
/// Both renderers read this table, which begins their texel buffer, so that no power is computed per texel, and no quotient by a constant, of which some
/// shader compilers make a product.
#[must_use]
pub fn decode_table() -> [f32; 512] {
    core::array::from_fn(|index| {
        let share = (index % 256) as f64 / 255.0;
        (if index < 256 { srgb_to_linear(share) } else { share }) as f32
    })
}

/// Decodes one sRGB channel from 0 to 1.
#[must_use]
pub fn srgb_to_linear(encoded: f64) -> f64 {
    #[cfg(not(feature = "std"))]
    use crate::float::FloatFuncs;
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_decoding_and_encoding() {
        for (byte, linear) in decode_table().into_iter().take(256).enumerate() {
            assert_eq!(usize::from(encode_pixel(Vec4::splat(linear))[0]), byte);
        }
    }

    #[test]
    fn out_of_range_channels_are_clamped() {
        assert_eq!(encode_pixel(Vec4::new(-1.0, 7.0, f32::NAN, 1.0)), [0, 255, 0, 255]);
    }

    #[test]
    fn known_values() {
        // Middle grey: 18 % reflectance is 118 of 255 in sRGB.
        assert_eq!(encode_pixel(Vec4::splat(0.18))[1], 118);
    }
}
