//! Layers as OpenEXR files: the numbers exactly as they were computed, for programs and for people who measure.

use std::io::{self, Seek, Write};

use image::{ExtendedColorType, ImageEncoder, codecs::openexr::OpenExrEncoder};
use shadow_scene::{Layer, Pixels};

/// Writes a layer of numbers as OpenEXR, with 32 bits a channel and compressed without loss.
///
/// Colour is linear red, green, blue and alpha. A layer of single numbers has each in red, green and blue alike: readers commonly refuse
/// files without them.
pub(crate) fn write_exr(layer: &Layer, file: impl Write + Seek) -> io::Result<()> {
    // The encoder takes bytes in the machine's order.
    let (bytes, color): (Vec<[u8; 4]>, _) = match &layer.pixels {
        Pixels::Rgba(values) => {
            (values.as_flattened().iter().map(|value| value.to_ne_bytes()).collect(), ExtendedColorType::Rgba32F)
        }
        Pixels::Float(values) => (values.iter().flat_map(|value| [value.to_ne_bytes(); 3]).collect(), ExtendedColorType::Rgb32F),
        Pixels::Id(_) => return Err(io::Error::other("the indices of triangles are no floating-point numbers")),
    };
    OpenExrEncoder::new(file).write_image(bytes.as_flattened(), layer.width, layer.height, color).map_err(io::Error::other)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use image::{ImageFormat, load_from_memory_with_format};
    use shadow_scene::LayerName;

    use super::*;

    fn written(name: LayerName, pixels: Pixels) -> image::DynamicImage {
        let mut file = Cursor::new(Vec::new());
        let layer = Layer { name, width: 2, height: pixels.len() as u32 / 2, pixels };
        write_exr(&layer, &mut file).unwrap();
        load_from_memory_with_format(file.get_ref(), ImageFormat::OpenExr).unwrap()
    }

    fn bits(values: &[f32]) -> Vec<u32> {
        values.iter().map(|value| value.to_bits()).collect()
    }

    #[test]
    fn colour_keeps_every_bit() {
        let colors = vec![[0.1, -0.0, 1e30, 1.0], [f32::MIN_POSITIVE, 0.333, f32::INFINITY, 0.5]];
        let read = written(LayerName::Color, Pixels::Rgba(colors.clone()));
        assert_eq!((read.width(), read.height()), (2, 1));
        assert_eq!(bits(read.into_rgba32f().as_raw()), bits(colors.as_flattened()));
    }

    #[test]
    fn single_numbers_are_in_every_channel_row_by_row_from_the_top() {
        let depths = [0.1_f32, 0.2, 1.0, 1e-20];
        let read = written(LayerName::Depth, Pixels::Float(depths.to_vec()));
        let expected: Vec<f32> = depths.iter().flat_map(|&depth| [depth; 3]).collect();
        assert_eq!(bits(read.into_rgb32f().as_raw()), bits(&expected));
    }

    #[test]
    fn indices_are_refused() {
        let layer = Layer { name: LayerName::Triangle, width: 1, height: 1, pixels: Pixels::Id(vec![7]) };
        assert!(write_exr(&layer, Cursor::new(Vec::new())).is_err());
    }
}
