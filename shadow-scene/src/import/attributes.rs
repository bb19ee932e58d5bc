//! The attributes of a primitive, from its accessors or from Draco's compression.

use core::fmt::Display;

use gltf::json::mesh::{Primitive, Semantic};

use super::{
    accessor::{Accessor, Format},
    budget::Use,
    buffers::Buffers,
    document::{Document, attribute},
    draco::Compressed,
    error::Result,
};

/// Where the data of a primitive come from.
pub(super) struct Source<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    pub(super) primitive: &'a Primitive,
    /// The JSON path of the primitive.
    pub(super) place: String,
    compressed: Option<Compressed>,
}

impl<'a> Source<'a> {
    /// Opens a primitive of a mesh; both must exist.
    pub(super) fn open(document: &'a Document, buffers: &'a Buffers<'a>, mesh: usize, number: usize) -> Result<Self> {
        let primitive = &document.root.meshes[mesh].primitives[number];
        let place = format!("meshes[{mesh}].primitives[{number}]");
        let compressed = Compressed::open(document, buffers, mesh, number, &place)?;
        Ok(Self { document, buffers, primitive, place, compressed })
    }

    /// The triangles of a compressed primitive; `None` for one that is made of its indices.
    pub(super) fn triangles(&self) -> Option<Vec<[u32; 3]>> {
        self.compressed.as_ref().map(Compressed::triangles)
    }

    /// Claims memory for what is made of the primitive.
    pub(super) fn claim(&self, bytes: u64) -> Result<()> {
        self.buffers.budget().claim(Use::Meshes, bytes, &self.place)
    }

    /// An attribute, which must have an element for each of `count` positions unless that is `None`. The attribute itself
    /// may be missing.
    pub(super) fn attribute(&self, semantic: Semantic, format: Format, count: Option<usize>) -> Result<Option<Accessor<'_>>> {
        let name = semantic.to_string();
        let Some(index) = attribute(self.primitive, semantic) else { return Ok(None) };
        let place = format!("{}.attributes.{name}", self.place);
        if let Some(compressed) = &self.compressed
            && let Some(accessor) = compressed.attribute(self.document, self.buffers, index, &name, format, &place)?
        {
            return Ok(Some(accessor));
        }
        match count {
            None => Accessor::open_counted(self.document, self.buffers, index, format, place),
            Some(count) => open_parallel(self.document, self.buffers, index, format, count, place),
        }
        .map(Some)
    }
}

/// Opens an accessor that must have an element for each of `count` positions.
pub(super) fn open_parallel<'a>(
    document: &Document,
    buffers: &'a Buffers<'_>,
    index: usize,
    format: Format,
    count: usize,
    place: impl Display,
) -> Result<Accessor<'a>> {
    let accessor = Accessor::open(document, buffers, index, format, &place)?;
    if accessor.count() == count {
        return Ok(accessor);
    }
    Err(document.invalid(
        place,
        format_args!(
            "accessors[{index}] has a count of {}, but there are {count} positions; export the file again",
            accessor.count()
        ),
    ))
}
