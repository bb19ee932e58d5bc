//! Accessors: typed arrays in buffers, read element by element after one check of their range.

use core::fmt::Display;
use std::borrow::Cow;

use gltf::json::{
    accessor::{ComponentType, Type},
    buffer::MIN_BYTE_STRIDE,
    validation::Checked,
};

use super::{
    buffers::{Buffers, slice},
    document::Document,
    error::{ImportError, Result},
};

/// The most elements of an accessor that has no bytes of its own, and of one whose bytes must be copied because some
/// are replaced: no file length limits the former, so that a short file could ask for all memory.
const MAX_UNBACKED_COUNT: u64 = 1 << 24;

/// A checked accessor: every element below its count can be read.
#[derive(Debug)]
pub(super) struct Accessor<'a> {
    bytes: Cow<'a, [u8]>,
    stride: usize,
    count: usize,
    component: ComponentType,
    normalized: bool,
    kind: Type,
}

/// What an attribute may be made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Format {
    /// The types it may have.
    pub(super) types: &'static [Type],
    /// The component types it may have.
    pub(super) components: &'static [ComponentType],
    /// Whether integers must be normalised, that is stand for fractions of 1.
    pub(super) normalized: bool,
}

const SMALL_INTEGERS: [ComponentType; 4] = [ComponentType::I8, ComponentType::U8, ComponentType::I16, ComponentType::U16];
const FLOAT_OR_SMALL: &[ComponentType] =
    &[ComponentType::F32, SMALL_INTEGERS[0], SMALL_INTEGERS[1], SMALL_INTEGERS[2], SMALL_INTEGERS[3]];
const FLOAT_OR_UNSIGNED: &[ComponentType] = &[ComponentType::F32, ComponentType::U8, ComponentType::U16];
const FLOAT_OR_SIGNED: &[ComponentType] = &[ComponentType::F32, ComponentType::I8, ComponentType::I16];

impl Format {
    /// Positions and normals; integers as KHR_mesh_quantization allows them.
    pub(super) const VECTOR: Self = Self { types: &[Type::Vec3], components: FLOAT_OR_SMALL, normalized: false };
    /// Texture coordinates; integers as KHR_mesh_quantization allows them.
    pub(super) const UV: Self = Self { types: &[Type::Vec2], components: FLOAT_OR_SMALL, normalized: false };
    /// Vertex colours.
    pub(super) const COLOR: Self = Self { types: &[Type::Vec3, Type::Vec4], components: FLOAT_OR_UNSIGNED, normalized: true };
    /// Weights of joints.
    pub(super) const WEIGHTS: Self = Self { types: &[Type::Vec4], components: FLOAT_OR_UNSIGNED, normalized: true };
    /// Numbers of joints.
    pub(super) const JOINTS: Self =
        Self { types: &[Type::Vec4], components: &[ComponentType::U8, ComponentType::U16], normalized: false };
    /// Vertex indices.
    pub(super) const INDICES: Self = Self {
        types: &[Type::Scalar],
        components: &[ComponentType::U8, ComponentType::U16, ComponentType::U32],
        normalized: false,
    };
    /// Inverse bind matrices.
    pub(super) const MATRIX: Self = Self { types: &[Type::Mat4], components: &[ComponentType::F32], normalized: false };
    /// Quaternions of instances.
    pub(super) const ROTATION: Self = Self { types: &[Type::Vec4], components: FLOAT_OR_SIGNED, normalized: true };
}

impl<'a> Accessor<'a> {
    /// Opens an accessor of a known format. `place` is the JSON path of what names it.
    pub(super) fn open(
        document: &Document,
        buffers: &'a Buffers<'_>,
        index: usize,
        format: Format,
        place: impl Display,
    ) -> Result<Self> {
        let fail = |problem: &dyn Display| -> ImportError {
            document.invalid(&place, format_args!("accessors[{index}] {problem}; export the file again"))
        };
        let json = document.root.accessors.get(index).ok_or_else(|| fail(&"does not exist"))?;
        // `Document` guarantees that both are valid.
        let (Checked::Valid(kind), Checked::Valid(component)) = (json.type_, json.component_type) else {
            return Err(fail(&"has no valid type"));
        };
        let component = component.0;
        if !format.types.contains(&kind) || !format.components.contains(&component) {
            return Err(fail(&format_args!(
                "is of type {kind:?} of {component:?}, but must be {:?} of {:?}",
                format.types, format.components
            )));
        }
        if format.normalized && component != ComponentType::F32 && !json.normalized {
            return Err(fail(&format_args!("holds {component:?} that are not normalized")));
        }
        let count = json.count.0;
        if count == 0 {
            return Err(fail(&"has a count of 0, but must have at least 1 element"));
        }
        let size = component.size() * kind.multiplicity();
        let (bytes, stride) = match json.buffer_view {
            Some(view) => {
                let bytes = buffers.view(document, view.value(), &place)?;
                // `Document` guarantees the index.
                let stride = document.root.buffer_views[view.value()].byte_stride.map_or(size, |stride| stride.0);
                if stride < size {
                    return Err(fail(&format_args!(
                        "has elements of {size} bytes, but bufferViews[{view}].byteStride is {stride} (at least {MIN_BYTE_STRIDE} and no less than an element)"
                    )));
                }
                let offset = json.byte_offset.map_or(0, |offset| offset.0);
                let needed = (count - 1).checked_mul(stride as u64).and_then(|n| n.checked_add(size as u64));
                let range = needed.and_then(|needed| slice(bytes, offset, needed));
                let range = range.ok_or_else(|| {
                    fail(&format_args!(
                        "has {count} elements, {stride} bytes apart, from byte {offset} on, but bufferViews[{view}] has {} bytes",
                        bytes.len()
                    ))
                })?;
                (Cow::Borrowed(range), stride)
            }
            None if count > MAX_UNBACKED_COUNT => {
                return Err(fail(&format_args!(
                    "has {count} elements but no bufferView; without one at most {MAX_UNBACKED_COUNT} are read"
                )));
            }
            None => (Cow::Owned(vec![0; count as usize * size]), size),
        };
        // `count` elements lie in memory or are below a small limit, so it fits.
        let mut accessor = Self { bytes, stride, count: count as usize, component, normalized: json.normalized, kind };
        if let Some(sparse) = &json.sparse {
            accessor.replace(document, buffers, sparse, &fail, &place)?;
        }
        Ok(accessor)
    }

    /// Replaces the elements that a sparse accessor names.
    fn replace(
        &mut self,
        document: &Document,
        buffers: &Buffers<'_>,
        sparse: &gltf::json::accessor::sparse::Sparse,
        fail: &dyn Fn(&dyn Display) -> ImportError,
        place: &dyn Display,
    ) -> Result<()> {
        // `Document` guarantees that it is valid.
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            return Err(fail(&"has sparse indices of no valid type"));
        };
        let count = sparse.count.0;
        if count == 0 || count > self.count as u64 || self.count as u64 > MAX_UNBACKED_COUNT {
            return Err(fail(&format_args!(
                "replaces {count} of its {} elements; it must be at least 1 and no more than there are, of at most {MAX_UNBACKED_COUNT}",
                self.count
            )));
        }
        let size = self.size();
        let part = |view: gltf::json::Index<gltf::json::buffer::View>, offset: u64, element: usize, what: &str| {
            let bytes = buffers.view(document, view.value(), place)?;
            // The count is at most `MAX_UNBACKED_COUNT` and an element at most 64 bytes, so this cannot overflow.
            slice(bytes, offset, count * element as u64)
                .ok_or_else(|| fail(&format_args!("has {count} sparse {what}, which do not fit bufferViews[{view}]")))
        };
        let index_size = index_type.0.size();
        let indices = part(sparse.indices.buffer_view, sparse.indices.byte_offset.0, index_size, "indices")?;
        let values = part(sparse.values.buffer_view, sparse.values.byte_offset.0, size, "values")?;
        let mut packed = Vec::with_capacity(self.count * size);
        for i in 0..self.count {
            packed.extend_from_slice(&self.bytes[i * self.stride..][..size]);
        }
        let mut previous = None;
        for (index, value) in indices.chunks_exact(index_size).zip(values.chunks_exact(size)) {
            let index = little_endian(index) as usize;
            if previous.is_some_and(|previous| index <= previous) || index >= self.count {
                return Err(fail(&format_args!(
                    "has the sparse index {index} in a place where it must be above the one before it and below {}",
                    self.count
                )));
            }
            previous = Some(index);
            packed[index * size..][..size].copy_from_slice(value);
        }
        self.bytes = Cow::Owned(packed);
        self.stride = size;
        Ok(())
    }

    /// How many elements there are, at least 1.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// How many numbers an element has.
    pub(super) fn width(&self) -> usize {
        self.kind.multiplicity()
    }

    /// The largest value of an index, which glTF reserves.
    pub(super) fn largest_integer(&self) -> u32 {
        u32::MAX >> (32 - 8 * self.component.size() as u32)
    }

    /// Bytes of an element.
    fn size(&self) -> usize {
        self.component.size() * self.width()
    }

    /// The bytes of component `c` of element `i`; `i` must be below the count and `c` below the width.
    fn component(&self, i: usize, c: usize) -> &[u8] {
        let size = self.component.size();
        &self.bytes[i * self.stride + c * size..][..size]
    }

    /// An element as numbers; `i` must be below the count and `N` at most the width.
    pub(super) fn vector<const N: usize>(&self, i: usize) -> [f32; N] {
        core::array::from_fn(|c| {
            let bits = little_endian(self.component(i, c));
            // Fractions of integers as in section 3.11 of the specification.
            match (self.component, self.normalized) {
                (ComponentType::F32, _) => f32::from_bits(bits),
                (ComponentType::I8, true) => (f32::from(bits as u8 as i8) / 127.0).max(-1.0),
                (ComponentType::U8, true) => bits as f32 / 255.0,
                (ComponentType::I16, true) => (f32::from(bits as u16 as i16) / 32_767.0).max(-1.0),
                (ComponentType::U16, true) => bits as f32 / 65_535.0,
                (ComponentType::I8, false) => f32::from(bits as u8 as i8),
                (ComponentType::I16, false) => f32::from(bits as u16 as i16),
                (ComponentType::U8 | ComponentType::U16 | ComponentType::U32, _) => bits as f32,
            }
        })
    }

    /// Component `c` of element `i`, which must be unsigned integers; `i` must be below the count and `c` below the width.
    pub(super) fn integer(&self, i: usize, c: usize) -> u32 {
        little_endian(self.component(i, c))
    }
}

/// Up to four bytes as a number.
fn little_endian(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
