//! The binary container of glTF, taken apart and put together, and words of the format.

use serde_json::{Value, json};

/// Names of members that mean something in many places.
pub(crate) const KEYS: &[&str] = &[
    "animations",
    "attributes",
    "baseColorFactor",
    "baseColorTexture",
    "buffer",
    "bufferView",
    "byteLength",
    "byteOffset",
    "byteStride",
    "camera",
    "channels",
    "children",
    "componentType",
    "count",
    "extensions",
    "extensionsRequired",
    "extensionsUsed",
    "indices",
    "input",
    "interpolation",
    "inverseBindMatrices",
    "joints",
    "material",
    "matrix",
    "max",
    "mesh",
    "meshes",
    "min",
    "mode",
    "node",
    "nodes",
    "normalized",
    "output",
    "POSITION",
    "primitives",
    "range",
    "rotation",
    "sampler",
    "samplers",
    "scale",
    "scene",
    "scenes",
    "skeleton",
    "skin",
    "skins",
    "source",
    "sparse",
    "target",
    "targets",
    "texCoord",
    "translation",
    "type",
    "uri",
    "values",
    "weights",
    "WEIGHTS_0",
    "JOINTS_0",
    "NORMAL",
    "TEXCOORD_0",
    "COLOR_0",
    "filter",
];

/// Strings that mean something.
pub(crate) const WORDS: &[&str] = &[
    "",
    "2.0",
    "SCALAR",
    "VEC2",
    "VEC3",
    "VEC4",
    "MAT2",
    "MAT3",
    "MAT4",
    "LINEAR",
    "STEP",
    "CUBICSPLINE",
    "translation",
    "rotation",
    "scale",
    "weights",
    "MASK",
    "BLEND",
    "OPAQUE",
    "perspective",
    "orthographic",
    "directional",
    "point",
    "spot",
    "image/png",
    "image/jpeg",
    "ATTRIBUTES",
    "TRIANGLES",
    "INDICES",
    "NONE",
    "OCTAHEDRAL",
    "QUATERNION",
    "EXPONENTIAL",
    "COLOR",
    "data:;base64,AAAA",
    "data:image/png;base64,",
    "../a.bin",
    "a%00.bin",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "EXT_mesh_gpu_instancing",
    "KHR_node_visibility",
    "KHR_texture_transform",
    "KHR_materials_pbrSpecularGlossiness",
];

/// What a file consists of.
pub(crate) struct Parts {
    pub(crate) json: Value,
    /// The binary chunk; without one the file is text.
    pub(crate) bin: Vec<u8>,
}

impl Parts {
    /// Takes a file apart; `None` if it is not well-formed.
    pub(crate) fn split(bytes: &[u8]) -> Option<Self> {
        if !bytes.starts_with(b"glTF") {
            return Some(Self { json: serde_json::from_slice(bytes).ok()?, bin: Vec::new() });
        }
        let (json, rest) = chunk(bytes.get(12..)?)?;
        let bin = chunk(rest).map_or(&[][..], |(bin, _)| bin);
        Some(Self { json: serde_json::from_slice(json).ok()?, bin: bin.to_vec() })
    }

    /// The file: a container if there is a binary chunk, and text without one.
    pub(crate) fn join(mut self) -> Vec<u8> {
        let mut json = self.json.to_string().into_bytes();
        if self.bin.is_empty() {
            return json;
        }
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        // The first buffer keeps to the chunk, so that a longer or shorter chunk is not all that is looked at.
        if let Some(length) = self.json.pointer_mut("/buffers/0/byteLength")
            && length.as_u64().is_some_and(|length| length.next_multiple_of(4) <= u64::from(u16::MAX))
        {
            *length = json!(self.bin.len());
            json = self.json.to_string().into_bytes();
        }
        json.resize(json.len().next_multiple_of(4), b' ');
        let chunk = |kind: &[u8; 4], body: &[u8]| [&(body.len() as u32).to_le_bytes()[..], kind, body].concat();
        let chunks = [chunk(b"JSON", &json), chunk(b"BIN\0", &self.bin)].concat();
        [b"glTF", &2_u32.to_le_bytes()[..], &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
    }
}

/// The body of the first chunk, and what follows it.
fn chunk(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (header, rest) = bytes.split_at_checked(8)?;
    let length = u32::from_le_bytes(header[..4].try_into().ok()?);
    rest.split_at_checked(length as usize)
}
