//! Buffers and the views into them, every length checked against the bytes there really are.

use core::{cell::OnceCell, fmt::Display};
use std::borrow::Cow;

use super::{
    budget::{Budget, Use},
    document::Document,
    error::Result,
    meshopt,
    uri::Folder,
};

/// The contents of a file's buffers.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    /// `None` for a buffer that the file leaves to others to fill.
    contents: Vec<Option<Cow<'a, [u8]>>>,
    /// The contents of compressed buffer views, once they have been asked for; `None` for views that are not compressed.
    decompressed: Vec<OnceCell<Option<Vec<u8>>>>,
    budget: &'a Budget,
}

impl<'a> Buffers<'a> {
    /// Loads every buffer; each is then exactly as long as its `byteLength`.
    ///
    /// `bin` is what the binary container holds.
    pub(super) fn load(document: &Document, folder: Folder<'a>, bin: Option<&'a [u8]>) -> Result<Self> {
        let mut contents = Vec::new();
        for (i, buffer) in document.root.buffers.iter().enumerate() {
            let length = buffer.byte_length.0;
            let fail = |problem: &dyn Display| document.invalid(format_args!("buffers[{i}].byteLength"), problem);
            if length == 0 {
                return Err(fail(&"a buffer must have at least 1 byte; export the file again"));
            }
            contents.push(match (&buffer.uri, bin) {
                (Some(uri), _) => {
                    let mut bytes = folder.read(document, uri, Use::Buffers, Some(length), format_args!("buffers[{i}]"))?;
                    bytes.truncate(length as usize);
                    Some(Cow::Owned(bytes))
                }
                (None, Some(bin)) if i == 0 => Some(Cow::Borrowed(slice(bin, 0, length).ok_or_else(|| {
                    fail(&format_args!("is {length}, but the BIN chunk has only {} bytes; the file was cut short", bin.len()))
                })?)),
                (None, _) => None,
            });
        }
        let decompressed = vec![OnceCell::new(); document.root.buffer_views.len()];
        Ok(Self { contents, decompressed, budget: folder.budget })
    }

    /// The memory that the import may take.
    pub(super) fn budget(&self) -> &'a Budget {
        self.budget
    }

    /// The bytes of a buffer; `None` if there are none, or no such buffer.
    pub(super) fn content(&self, buffer: usize) -> Option<&[u8]> {
        self.contents.get(buffer)?.as_deref()
    }

    /// The content of a compressed buffer view, which is decompressed when it is asked for first; `None` for others.
    fn decompressed(&self, document: &Document, view: usize) -> Result<Option<&[u8]>> {
        // `Document` guarantees the index of a view.
        let cell = &self.decompressed[view];
        if cell.get().is_none() {
            // Nothing else fills the cell meanwhile.
            let _ = cell.set(meshopt::decode(document, self, view)?);
        }
        Ok(cell.get().and_then(Option::as_deref))
    }

    /// The bytes of a buffer view. `place` is what uses it.
    pub(super) fn view(&self, document: &Document, view: usize, place: impl Display) -> Result<&[u8]> {
        if let Some(bytes) = self.decompressed(document, view)? {
            return Ok(bytes);
        }
        // `Document` guarantees both indices, and `load` that there is a content for each buffer.
        let json = &document.root.buffer_views[view];
        let Some(buffer) = &self.contents[json.buffer.value()] else {
            let problem = "has neither a `uri` nor a BIN chunk to take its bytes from; export the file again";
            return Err(document.invalid(place, format_args!("buffers[{}] {problem}", json.buffer)));
        };
        let offset = json.byte_offset.map_or(0, |offset| offset.0);
        let length = json.byte_length.0;
        slice(buffer, offset, length).ok_or_else(|| {
            document.invalid(
                place,
                format_args!(
                    "bufferViews[{view}] is {length} bytes from byte {offset} on, but buffers[{}] has {} bytes; export the file again",
                    json.buffer,
                    buffer.len()
                ),
            )
        })
    }
}

/// `length` bytes from `offset` on; `None` if there are not as many.
pub(super) fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    bytes.get(usize::try_from(offset).ok()?..end)
}
