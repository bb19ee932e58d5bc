//! Images: PNG and JPEG, told apart by their content.

use core::fmt::Display;
use std::io::Cursor;

use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader, Limits};

use super::{
    budget::{Budget, Use},
    buffers::Buffers,
    document::Document,
    error::Result,
    uri::Folder,
};
use crate::scene::Image;

/// The most texels along a side: what graphics processors can hold.
pub(super) const MAX_SIDE: u32 = 16_384;

/// The most bytes that decoding one image may take: the largest image with four 16-bit channels.
const MAX_DECODED_BYTES: u64 = MAX_SIDE as u64 * MAX_SIDE as u64 * 8;

/// The most bytes of texels that a byte of an image file may stand for, in an image of more than [`SMALL_IMAGE_BYTES`].
///
/// Deflate, which PNG uses, packs at most 1032 bytes into one, and a grey texel of one byte becomes four. JPEG stays below
/// half of that: it spends at least a bit on each block of 8 by 8 texels. Only PNG of less than 8 bits a texel can hold
/// more, and a large one that does is a way to make a few kilobytes fill all memory.
const MAX_EXPANSION: u64 = 4 * 1032;

/// Texels up to this many bytes may come from any number of bytes: those of 4096 by 4096.
const SMALL_IMAGE_BYTES: u64 = 4096 * 4096 * TEXEL_BYTES;

/// Bytes of a texel of the scene.
const TEXEL_BYTES: u64 = 4;

/// Reads the image `index` of the file.
pub(super) fn read(document: &Document, buffers: &Buffers<'_>, folder: Folder<'_>, index: usize) -> Result<Image> {
    // `Document` guarantees the index.
    let json = &document.root.images[index];
    let place = format!("images[{index}]");
    match (json.buffer_view, &json.uri) {
        (Some(view), _) => decode(document, buffers.budget(), buffers.view(document, view.value(), &place)?, &place),
        (None, Some(uri)) => {
            let bytes = folder.read(document, uri, Use::Textures, None, &place)?;
            let image = decode(document, buffers.budget(), &bytes, &place)?;
            buffers.budget().release(bytes.len() as u64);
            Ok(image)
        }
        (None, None) => Err(document.invalid(place, "has neither a `bufferView` nor a `uri`; export the file again")),
    }
}

fn decode(document: &Document, budget: &Budget, bytes: &[u8], place: &str) -> Result<Image> {
    let fail = |problem: &dyn Display| document.invalid(place, problem);
    let format = match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => format,
        Ok(other) => return Err(fail(&format_args!("is of format {other:?}; convert it to PNG or JPEG"))),
        Err(_) => return Err(fail(&"is neither PNG nor JPEG; convert it to one of them")),
    };
    let damaged = |error: image::ImageError| {
        // Some of the decoder's messages end with a line break.
        let error = error.to_string();
        fail(&format_args!("cannot be decoded as {format:?}: {}; save the image again", error.trim_end()))
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_DECODED_BYTES);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
        return Err(fail(&format_args!(
            "is {width} x {height} texels; each side must be between 1 and {MAX_SIDE}: scale the image"
        )));
    }
    let texel_bytes = TEXEL_BYTES * u64::from(width) * u64::from(height);
    let most = MAX_EXPANSION.saturating_mul(bytes.len() as u64).max(SMALL_IMAGE_BYTES);
    if texel_bytes > most {
        return Err(fail(&format_args!(
            "claims {width} x {height} texels, {texel_bytes} bytes, but has {} bytes, from which at most {most} are made: scale the image down",
            bytes.len()
        )));
    }
    // What the decoder gives, and then what it is converted to, beside the texels that stay.
    let transient = decoder.total_bytes().saturating_add(texel_bytes);
    budget.claim(Use::Textures, transient.saturating_add(texel_bytes), place)?;
    let texels = match DynamicImage::from_decoder(decoder).map_err(damaged)? {
        // The usual layouts go straight into texels, since the largest images leave little memory for a step between.
        DynamicImage::ImageLuma8(image) => image.as_raw().iter().map(|&l| [l, l, l, u8::MAX]).collect(),
        DynamicImage::ImageRgb8(image) => image.as_raw().as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, u8::MAX]).collect(),
        other => other.into_rgba8().as_raw().as_chunks::<4>().0.to_vec(),
    };
    budget.release(transient);
    Ok(Image { width, height, texels })
}
