//! Images: PNG and JPEG, told apart by their content.

use core::fmt::Display;
use std::io::Cursor;

use image::{DynamicImage, ImageDecoder as _, ImageFormat, ImageReader, Limits};

use super::{buffers::Buffers, document::Document, error::Result, uri::Folder};
use crate::scene::Image;

/// The most texels along a side: what graphics processors can hold.
pub(super) const MAX_SIDE: u32 = 16_384;

/// The most texels of all images of a scene: 2 GiB of them. A few kilobytes of PNG can stand for one image of the
/// largest size.
const MAX_TEXELS: u64 = 1 << 29;

/// The most bytes that decoding one image may take: the largest image with four 16-bit channels.
const MAX_DECODED_BYTES: u64 = MAX_SIDE as u64 * MAX_SIDE as u64 * 8;

/// Reads the image `index` of the file; `texels` counts those of all images so far.
pub(super) fn read(
    document: &Document,
    buffers: &Buffers<'_>,
    folder: Folder<'_>,
    index: usize,
    texels: &mut u64,
) -> Result<Image> {
    // `Document` guarantees the index.
    let json = &document.root.images[index];
    let place = format!("images[{index}]");
    match (json.buffer_view, &json.uri) {
        (Some(view), _) => decode(document, buffers.view(document, view.value(), &place)?, &place, texels),
        (None, Some(uri)) => decode(document, &folder.read(document, uri, None, &place)?, &place, texels),
        (None, None) => Err(document.invalid(place, "has neither a `bufferView` nor a `uri`; export the file again")),
    }
}

fn decode(document: &Document, bytes: &[u8], place: &str, texels: &mut u64) -> Result<Image> {
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
    *texels += u64::from(width) * u64::from(height);
    if *texels > MAX_TEXELS {
        return Err(fail(&format_args!(
            "with it the scene's images have {texels} texels; at most {MAX_TEXELS} are read: scale them down"
        )));
    }
    let texels = match DynamicImage::from_decoder(decoder).map_err(damaged)? {
        // The usual layouts go straight into texels, since the largest images leave little memory for a step between.
        DynamicImage::ImageLuma8(image) => image.as_raw().iter().map(|&l| [l, l, l, u8::MAX]).collect(),
        DynamicImage::ImageRgb8(image) => image.as_raw().as_chunks::<3>().0.iter().map(|&[r, g, b]| [r, g, b, u8::MAX]).collect(),
        other => other.into_rgba8().as_raw().as_chunks::<4>().0.to_vec(),
    };
    Ok(Image { width, height, texels })
}
