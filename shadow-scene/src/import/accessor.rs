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

/// The most elements that an accessor without bytes of its own may bring into the scene: no file length limits them, so
/// that a short file could ask for all memory.
const MAX_UNBACKED_COUNT: usize = 1 << 16;

/// The bytes of an element that has none in the file; the largest element is a matrix of 16 floats.
const ZEROS: [u8; 64] = [0; 64];

/// A checked accessor: every element below its count can be read.
#[derive(Clone, Debug)]
pub(super) struct Accessor<'a> {
    /// `None` where all elements are zero.
    bytes: Option<Cow<'a, [u8]>>,
    /// The elements that replace others.
    sparse: Option<Sparse<'a>>,
    stride: usize,
    count: usize,
    component: ComponentType,
    normalized: bool,
    kind: Type,
}

/// The elements of a sparse accessor, which are looked up where they lie: a copy of all elements could take far more
/// memory than the file.
#[derive(Clone, Copy, Debug)]
struct Sparse<'a> {
    /// The numbers of the replaced elements, strictly increasing.
    indices: &'a [u8],
    /// Bytes of a number.
    index_size: usize,
    /// The elements in their place, packed.
    values: &'a [u8],
}

impl<'a> Sparse<'a> {
    fn len(&self) -> usize {
        self.indices.len() / self.index_size
    }

    fn index(&self, i: usize) -> usize {
        little_endian(&self.indices[i * self.index_size..][..self.index_size]) as usize
    }

    /// The bytes, `size` of them, that replace an element.
    fn find(&self, element: usize, size: usize) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.len());
        while low < high {
            let middle = low.midpoint(high);
            if self.index(middle) < element { low = middle + 1 } else { high = middle }
        }
        (low < self.len() && self.index(low) == element).then(|| &self.values[low * size..][..size])
    }
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
    /// Times of keys.
    pub(super) const TIMES: Self = Self { types: &[Type::Scalar], components: &[ComponentType::F32], normalized: false };
    /// Animated translations and scales.
    pub(super) const KEY_VECTOR: Self = Self { types: &[Type::Vec3], components: &[ComponentType::F32], normalized: false };
    /// Animated rotations.
    pub(super) const KEY_ROTATION: Self = Self { types: &[Type::Vec4], components: FLOAT_OR_SMALL, normalized: true };
    /// Animated weights of morph targets.
    pub(super) const KEY_WEIGHTS: Self = Self { types: &[Type::Scalar], components: FLOAT_OR_SMALL, normalized: true };
    /// Quaternions of instances.
    pub(super) const ROTATION: Self = Self { types: &[Type::Vec4], components: FLOAT_OR_SIGNED, normalized: true };
}

impl Format {
    /// What is wrong with data of this type.
    fn check(self, kind: Type, component: ComponentType, normalized: bool) -> core::result::Result<(), String> {
        if !self.types.contains(&kind) || !self.components.contains(&component) {
            return Err(format!("is of type {kind:?} of {component:?}, but must be {:?} of {:?}", self.types, self.components));
        }
        if self.normalized && component != ComponentType::F32 && !normalized {
            return Err(format!("holds {component:?} that are not normalized"));
        }
        Ok(())
    }
}

/// Makes errors about an accessor. `place` is the JSON path of what names it.
fn failure<'d>(document: &'d Document, index: usize, place: &'d impl Display) -> impl Fn(&dyn Display) -> ImportError + 'd {
    move |problem| document.invalid(place, format_args!("accessors[{index}] {problem}; export the file again"))
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
        let fail = failure(document, index, &place);
        let json = document.root.accessors.get(index).ok_or_else(|| fail(&"does not exist"))?;
        // `Document` guarantees that both are valid.
        let (Checked::Valid(kind), Checked::Valid(component)) = (json.type_, json.component_type) else {
            return Err(fail(&"has no valid type"));
        };
        let component = component.0;
        format.check(kind, component, json.normalized).map_err(|problem| fail(&problem))?;
        let count = json.count.0;
        if count == 0 {
            return Err(fail(&"has a count of 0, but must have at least 1 element"));
        }
        let size = component.size() * kind.multiplicity();
        let (bytes, stride) = match json.buffer_view {
            None => (None, size),
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
                (Some(Cow::Borrowed(range)), stride)
            }
        };
        let count =
            usize::try_from(count).map_err(|_| fail(&format_args!("has {count} elements, more than can be addressed")))?;
        let sparse = match &json.sparse {
            None => None,
            Some(sparse) => Some(open_sparse(document, buffers, sparse, count, size, &fail, &place)?),
        };
        Ok(Self { bytes, sparse, stride, count, component, normalized: json.normalized, kind })
    }

    /// An accessor over bytes that were decompressed, of which there must be at least one element: whatever type the
    /// compressed data has stands in place of that in the file.
    pub(super) fn unpacked(
        document: &Document,
        index: usize,
        bytes: Vec<u8>,
        (kind, component): (Type, ComponentType),
        format: Format,
        place: impl Display,
    ) -> Result<Self> {
        let fail = failure(document, index, &place);
        let json = document.root.accessors.get(index).ok_or_else(|| fail(&"does not exist"))?;
        format.check(kind, component, json.normalized).map_err(|problem| fail(&problem))?;
        let stride = component.size() * kind.multiplicity();
        let count = bytes.len() / stride;
        if count == 0 {
            return Err(fail(&"has no elements after decompression"));
        }
        Ok(Self { bytes: Some(Cow::Owned(bytes)), sparse: None, stride, count, component, normalized: json.normalized, kind })
    }

    /// Opens an accessor whose count decides how much memory the scene takes: one without bytes must not have many
    /// elements.
    pub(super) fn open_counted(
        document: &Document,
        buffers: &'a Buffers<'_>,
        index: usize,
        format: Format,
        place: impl Display,
    ) -> Result<Self> {
        let accessor = Self::open(document, buffers, index, format, &place)?;
        if accessor.bytes.is_none() && accessor.count > MAX_UNBACKED_COUNT {
            let problem = format!(
                "accessors[{index}] has {} elements but no bufferView; without one at most {MAX_UNBACKED_COUNT} are read: export the file again",
                accessor.count
            );
            return Err(document.invalid(place, problem));
        }
        Ok(accessor)
    }

    /// How many elements there are, at least 1.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Whether all elements are zero because the file has no bytes for them.
    pub(super) fn is_left_out(&self) -> bool {
        self.bytes.is_none() && self.sparse.is_none()
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

    /// The bytes of element `i`, which must be below the count.
    fn element(&self, i: usize) -> &[u8] {
        let size = self.size();
        if let Some(replaced) = self.sparse.and_then(|sparse| sparse.find(i, size)) {
            return replaced;
        }
        self.bytes.as_ref().map_or(&ZEROS[..size], |bytes| &bytes[i * self.stride..][..size])
    }

    /// The bytes of component `c` of an element; `c` must be below the width.
    fn component<'e>(&self, element: &'e [u8], c: usize) -> &'e [u8] {
        let size = self.component.size();
        &element[c * size..][..size]
    }

    /// Component `c` of element `i` in double precision; `i` must be below the count and `c` below the width.
    pub(super) fn number(&self, i: usize, c: usize) -> f64 {
        let bits = little_endian(self.component(self.element(i), c));
        // Fractions of integers as in section 3.11 of the specification.
        match (self.component, self.normalized) {
            (ComponentType::F32, _) => f32::from_bits(bits).into(),
            (ComponentType::I8, true) => (f64::from(bits as u8 as i8) / 127.0).max(-1.0),
            (ComponentType::U8, true) => f64::from(bits) / 255.0,
            (ComponentType::I16, true) => (f64::from(bits as u16 as i16) / 32_767.0).max(-1.0),
            (ComponentType::U16, true) => f64::from(bits) / 65_535.0,
            (ComponentType::I8, false) => f64::from(bits as u8 as i8),
            (ComponentType::I16, false) => f64::from(bits as u16 as i16),
            (ComponentType::U8 | ComponentType::U16 | ComponentType::U32, _) => f64::from(bits),
        }
    }

    /// An element as numbers; `i` must be below the count and `N` at most the width.
    pub(super) fn vector<const N: usize>(&self, i: usize) -> [f32; N] {
        let element = self.element(i);
        core::array::from_fn(|c| {
            let bits = little_endian(self.component(element, c));
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
        little_endian(self.component(self.element(i), c))
    }
}

/// Checks the part of a sparse accessor that replaces elements, of `size` bytes each.
fn open_sparse<'a>(
    document: &Document,
    buffers: &'a Buffers<'_>,
    sparse: &gltf::json::accessor::sparse::Sparse,
    count: usize,
    size: usize,
    fail: &dyn Fn(&dyn Display) -> ImportError,
    place: &dyn Display,
) -> Result<Sparse<'a>> {
    // `Document` guarantees that it is valid.
    let Checked::Valid(index_type) = sparse.indices.component_type else {
        return Err(fail(&"has sparse indices of no valid type"));
    };
    let replaced = sparse.count.0;
    if replaced == 0 || replaced > count as u64 {
        return Err(fail(&format_args!(
            "replaces {replaced} of its {count} elements; it must be at least 1 and no more than there are"
        )));
    }
    let part = |view: gltf::json::Index<gltf::json::buffer::View>, offset: u64, element: usize, what: &str| {
        let bytes = buffers.view(document, view.value(), place)?;
        replaced
            .checked_mul(element as u64)
            .and_then(|length| slice(bytes, offset, length))
            .ok_or_else(|| fail(&format_args!("has {replaced} sparse {what}, which do not fit bufferViews[{view}]")))
    };
    let index_size = index_type.0.size();
    let indices = part(sparse.indices.buffer_view, sparse.indices.byte_offset.0, index_size, "indices")?;
    let values = part(sparse.values.buffer_view, sparse.values.byte_offset.0, size, "values")?;
    let sparse = Sparse { indices, index_size, values };
    let mut previous = None;
    for index in (0..sparse.len()).map(|i| sparse.index(i)) {
        if previous.is_some_and(|previous| index <= previous) || index >= count {
            return Err(fail(&format_args!(
                "has the sparse index {index} in a place where it must be above the one before it and below {count}"
            )));
        }
        previous = Some(index);
    }
    Ok(sparse)
}

/// Up to four bytes as a number.
fn little_endian(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}
