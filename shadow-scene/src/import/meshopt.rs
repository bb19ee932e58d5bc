//! EXT_meshopt_compression and its successor KHR_meshopt_compression: buffer views that are compressed one by one.
//!
//! The decoders follow the bitstreams in appendix A of the extensions' specifications, and the filters of appendix B.
//! They read bytes through a checked [`Reader`], so that a damaged stream ends with an error whatever it says.

use serde_json::Value;

use super::{
    budget::Use,
    buffers::{Buffers, slice},
    document::Document,
    error::Result,
};

mod attributes;
mod filters;
mod indices;

/// The names of the extension; both mean the same wherever the older one can be used.
const EXTENSIONS: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// What a stream is found not to be.
type Decoded<T> = core::result::Result<T, String>;

/// The bytes of a stream, in order.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, length: usize) -> Decoded<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(length).ok_or("the compressed data ends too early")?;
        self.0 = rest;
        Ok(taken)
    }

    fn byte(&mut self) -> Decoded<u8> {
        Ok(self.take(1)?[0])
    }

    /// A number in 7-bit groups, lowest first; all but the last have the highest bit set.
    fn varint(&mut self) -> Decoded<u32> {
        const MAX_BYTES: u32 = 5;
        let mut value = 0;
        for group in 0..MAX_BYTES {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << (7 * group);
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err("a number in the compressed data is longer than 5 bytes".into())
    }

    /// Whether all bytes have been read.
    fn finish(self) -> Decoded<()> {
        if self.0.is_empty() { Ok(()) } else { Err(format!("{} bytes of the compressed data are left over", self.0.len())) }
    }
}

/// How a view is compressed.
#[derive(Clone, Copy)]
enum Mode {
    Attributes,
    Triangles,
    Indices,
}

/// What the extension of a buffer view says.
struct View {
    buffer: usize,
    offset: u64,
    length: u64,
    stride: usize,
    count: u64,
    mode: Mode,
    filter: filters::Filter,
}

impl View {
    /// Reads the extension and checks the rules that it has to keep, of which the size of the view is one.
    fn read(extension: &Value, view_length: u64, view_stride: Option<usize>) -> Decoded<Self> {
        let number = |name: &str| match extension.get(name) {
            Some(value) => value.as_u64().ok_or_else(|| format!("`{name}` must be a whole number of 0 or more")),
            None if name == "byteOffset" => Ok(0),
            None => Err(format!("`{name}` is missing")),
        };
        let mode = match extension["mode"].as_str() {
            Some("ATTRIBUTES") => Mode::Attributes,
            Some("TRIANGLES") => Mode::Triangles,
            Some("INDICES") => Mode::Indices,
            _ => return Err(format!("`mode` is {}, but must be ATTRIBUTES, TRIANGLES or INDICES", extension["mode"])),
        };
        let filter = filters::Filter::read(extension.get("filter"))?;
        let (stride, count) = (number("byteStride")?, number("count")?);
        let stride_fits = match mode {
            Mode::Attributes => stride.is_multiple_of(4) && (4..=256).contains(&stride),
            Mode::Triangles | Mode::Indices => (stride == 2 || stride == 4) && filter == filters::Filter::None,
        };
        if !stride_fits || !filter.takes(stride) {
            return Err(format!("a `byteStride` of {stride} does not go with the mode and filter"));
        }
        if matches!(mode, Mode::Triangles) && !count.is_multiple_of(3) {
            return Err(format!("`count` is {count}, but must be a multiple of 3 for triangles"));
        }
        if count.checked_mul(stride) != Some(view_length) || view_stride.is_some_and(|given| given as u64 != stride) {
            return Err(format!("{count} elements of {stride} bytes are not the {view_length} bytes of the buffer view"));
        }
        let buffer = usize::try_from(number("buffer")?).map_err(|error| error.to_string())?;
        let (offset, length) = (number("byteOffset")?, number("byteLength")?);
        // The stride is at most 256.
        Ok(Self { buffer, offset, length, stride: stride as usize, count, mode, filter })
    }
}

/// The content of a compressed buffer view; `None` if it is not compressed.
pub(super) fn decode(document: &Document, buffers: &Buffers<'_>, view: usize) -> Result<Option<Vec<u8>>> {
    let named = EXTENSIONS.iter().find_map(|name| Some((name, document.view_extension(view, name)?)));
    let Some((name, extension)) = named else { return Ok(None) };
    let place = format!("bufferViews[{view}].extensions.{name}");
    let fail = |problem: String| document.invalid(&place, format_args!("{problem}; export the file again"));
    // `Document` guarantees the index.
    let json = &document.root.buffer_views[view];
    let read = View::read(extension, json.byte_length.0, json.byte_stride.map(|stride| stride.0)).map_err(fail)?;
    let bytes = buffers.content(read.buffer).and_then(|buffer| slice(buffer, read.offset, read.length));
    let bytes = bytes
        .ok_or_else(|| fail(format!("{} bytes from byte {} on are not in buffers[{}]", read.length, read.offset, read.buffer)))?;
    // No mode packs more than this into a byte: a whole block of 256 elements can share the byte that says that none of
    // its 4 bytes an element changes.
    const MAX_RATIO: u64 = 256 * 4;
    let size = json.byte_length.0;
    if size > read.length.saturating_mul(MAX_RATIO) {
        return Err(fail(format!("{} bytes cannot hold {size}", read.length)));
    }
    buffers.budget().claim(Use::Buffers, size, &place)?;
    let count = read.count as usize;
    let decoded = match read.mode {
        Mode::Attributes => attributes::decode(bytes, count, read.stride),
        Mode::Triangles => indices::decode_triangles(bytes, count).map(|indices| indices::pack(&indices, read.stride)),
        Mode::Indices => indices::decode_sequence(bytes, count).map(|indices| indices::pack(&indices, read.stride)),
    };
    let mut decoded = decoded.map_err(fail)?;
    read.filter.apply(&mut decoded, read.stride);
    Ok(Some(decoded))
}

#[cfg(test)]
mod tests;
