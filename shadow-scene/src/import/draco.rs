//! KHR_draco_mesh_compression: primitives whose indices and attributes are compressed together.
//!
//! The decoder is the crate `draco-core`: Rust without `unsafe`, with limits on what a stream may expand to.

use core::fmt::Display;

use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use gltf::json::accessor::{ComponentType, Type};
use serde_json::Value;

use super::{
    accessor::{Accessor, Format},
    budget::Use,
    buffers::Buffers,
    document::Document,
    error::Result,
};

const EXTENSION: &str = "KHR_draco_mesh_compression";

/// Bytes that a triangle takes while it is decoded and after that: its corners, and what links it to its neighbours.
const FACE_BYTES: u64 = 64;

/// A primitive that was decompressed.
pub(super) struct Compressed {
    mesh: Mesh,
    /// The number in the stream of each attribute, by its name in glTF.
    attributes: Value,
    place: String,
}

impl Compressed {
    /// Decompresses a primitive of a mesh; `None` if it is not compressed. `place` is its JSON path.
    pub(super) fn open(
        document: &Document,
        buffers: &Buffers<'_>,
        mesh: usize,
        primitive: usize,
        place: &str,
    ) -> Result<Option<Self>> {
        let Some(extension) = document.primitive_extension(mesh, primitive, EXTENSION) else { return Ok(None) };
        let place = format!("{place}.extensions.{EXTENSION}");
        let view = extension["bufferView"].as_u64().and_then(|view| usize::try_from(view).ok());
        let view = view.filter(|&view| view < document.root.buffer_views.len());
        let view = view.ok_or_else(|| {
            document.invalid(format_args!("{place}.bufferView"), "must be the number of a buffer view; export the file again")
        })?;
        let bytes = buffers.view(document, view, &place)?;
        let left = buffers.budget().left();
        let limits = DecodeLimits::default()
            .with_max_points(left / size_of::<[f32; 3]>() as u64)
            .with_max_faces(left / FACE_BYTES)
            .with_max_decoded_bytes(left);
        let mut decoded = Mesh::new();
        MeshDecoder::new().decode(&mut DecoderBuffer::new(bytes).with_limits(limits), &mut decoded).map_err(|error| {
            let error = error.to_string();
            document.invalid(&place, format_args!("cannot be decompressed: {}; export the file again", error.trim_end()))
        })?;
        let attributes = (0..decoded.num_attributes()).map(|a| decoded.attribute(a).buffer().data_size() as u64).sum();
        buffers.budget().claim(Use::Meshes, (decoded.num_faces() as u64 * FACE_BYTES).saturating_add(attributes), &place)?;
        Ok(Some(Self { mesh: decoded, attributes: extension["attributes"].clone(), place }))
    }

    /// The triangles. Their corners may name vertices that do not exist: the caller checks that.
    pub(super) fn triangles(&self) -> Vec<[u32; 3]> {
        self.mesh.faces().iter().map(|face| face.map(|point| point.0)).collect()
    }

    /// An attribute by its name in glTF; `None` if it is not among the compressed ones. `index` is that of its accessor.
    pub(super) fn attribute(
        &self,
        document: &Document,
        buffers: &Buffers<'_>,
        index: usize,
        name: &str,
        format: Format,
        place: &dyn Display,
    ) -> Result<Option<Accessor<'static>>> {
        let Some(number) = self.attributes.get(name) else { return Ok(None) };
        let number = number.as_u64().and_then(|number| u32::try_from(number).ok());
        let Some(attribute) = number.and_then(|number| self.mesh.attribute_by_unique_id(number)) else {
            let problem = "names an attribute that the compressed data does not have; export the file again";
            return Err(document.invalid(format_args!("{}.attributes.{name}", self.place), problem));
        };
        let component = match attribute.data_type() {
            DataType::Int8 => ComponentType::I8,
            DataType::Uint8 => ComponentType::U8,
            DataType::Int16 => ComponentType::I16,
            DataType::Uint16 => ComponentType::U16,
            DataType::Uint32 => ComponentType::U32,
            DataType::Float32 => ComponentType::F32,
            other => {
                let problem = format!("the compressed data is of type {other:?}, which glTF has not; export the file again");
                return Err(document.invalid(place, problem));
            }
        };
        let kind = match attribute.num_components() {
            1 => Type::Scalar,
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            other => {
                let problem = format!("the compressed data has {other} components; there can be 1 to 4: export the file again");
                return Err(document.invalid(place, problem));
            }
        };
        let size = component.size() * kind.multiplicity();
        let stride = usize::try_from(attribute.byte_stride()).unwrap_or_default();
        let data = attribute.buffer().data();
        buffers.budget().claim(Use::Meshes, (self.mesh.num_points() as u64).saturating_mul(size as u64), place)?;
        let mut bytes = Vec::with_capacity(self.mesh.num_points() * size);
        for point in 0..self.mesh.num_points() {
            let value = attribute.mapped_index(draco_core::PointIndex(point as u32)).0 as usize;
            let start = value.checked_mul(stride);
            match start.and_then(|start| data.get(start..start.checked_add(size)?)) {
                Some(element) => bytes.extend_from_slice(element),
                None => {
                    let problem = format!("the compressed data has no value for vertex {point}; export the file again");
                    return Err(document.invalid(place, problem));
                }
            }
        }
        Accessor::unpacked(document, index, bytes, (kind, component), format, place).map(Some)
    }
}
