//! The JSON: parsed, its version and extensions checked, every index in it checked against what it names.

use core::fmt::Display;

use gltf::json::{Root, mesh::Semantic, validation};
use serde_json::Value;

use super::{
    error::{ImportError, Result},
    options::Choice,
};

/// Extensions whose every effect that matters here is imported.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions that change only how a surface is shaded: without them the shadows are the same, so that a file which
/// requires them is drawn all the same, with a note.
const SHADING_ONLY: &[&str] = &[
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
];

/// What to do about an extension that is required but not supported.
fn advice(extension: &str) -> &'static str {
    match extension {
        "KHR_texture_basisu" => "decode its textures with `gltf-transform ktxdecompress input.glb output.glb`",
        "EXT_texture_webp" | "EXT_texture_avif" | "MSFT_texture_dds" => {
            "convert its textures with `gltf-transform png input.glb output.glb`"
        }
        _ => "export the file without it",
    }
}

/// A parsed file.
///
/// # Guarantees
///
/// Every index from one top-level array into another is in range, so that it can be used without a further check, but
/// for the source of a texture, which may be missing. Enumerations have a valid value.
/// Accessors, buffers, transforms and numbers in general are **not** checked.
#[derive(Debug)]
pub(super) struct Document {
    /// The typed document.
    pub(super) root: Root,
    /// The same document as it was written: doubles for transforms, and extensions that [`Root`] has no type for.
    raw: Value,
    /// For each animation, the number in the file of each channel that was kept.
    channel_numbers: Vec<Vec<usize>>,
    file: String,
}

impl Document {
    /// Parses and checks a file's JSON. `file` is its name for messages.
    pub(super) fn parse(file: &str, json: &[u8]) -> Result<Self> {
        let mut raw: Value = serde_json::from_slice(json).map_err(|source| ImportError::Json { file: file.into(), source })?;
        check_version(file, &raw)?;
        check_required_extensions(file, &raw)?;
        let channel_numbers = supply_what_root_demands(&mut raw);
        let root: Root = serde_path_to_error::deserialize(&raw).map_err(|error| ImportError::Invalid {
            file: file.into(),
            place: error.path().to_string(),
            problem: error.inner().to_string(),
        })?;
        let document = Self { root, raw, channel_numbers, file: file.into() };
        document.validate()?;
        Ok(document)
    }

    /// The file's name for messages.
    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// An error about a place in the file.
    pub(super) fn invalid(&self, place: impl Display, problem: impl Display) -> ImportError {
        ImportError::Invalid { file: self.file.clone(), place: place.to_string(), problem: problem.to_string() }
    }

    /// The number in the file of a channel of an animation, for messages.
    pub(super) fn channel_number(&self, animation: usize, channel: usize) -> usize {
        self.channel_numbers.get(animation).and_then(|numbers| numbers.get(channel)).copied().unwrap_or(channel)
    }

    /// An extension of a buffer view as it was written.
    pub(super) fn view_extension(&self, view: usize, extension: &str) -> Option<&Value> {
        self.raw.get("bufferViews")?.get(view)?.get("extensions")?.get(extension)
    }

    /// An extension of a primitive as it was written.
    pub(super) fn primitive_extension(&self, mesh: usize, primitive: usize, extension: &str) -> Option<&Value> {
        self.raw.get("meshes")?.get(mesh)?.get("primitives")?.get(primitive)?.get("extensions")?.get(extension)
    }

    /// An extension of a material as it was written.
    pub(super) fn material_extension(&self, material: usize, extension: &str) -> Option<&Value> {
        self.raw.get("materials")?.get(material)?.get("extensions")?.get(extension)
    }

    /// A property of a node as it was written.
    pub(super) fn node_value(&self, node: usize, property: &str) -> Option<&Value> {
        self.raw.get("nodes")?.get(node)?.get(property)
    }

    /// An array of `N` numbers in a node, at the precision it was written in; `None` where there is none.
    pub(super) fn node_numbers<const N: usize>(&self, node: usize, property: &str) -> Option<[f64; N]> {
        let array = self.node_value(node, property)?.as_array()?;
        let mut numbers = [0.0; N];
        for (number, value) in numbers.iter_mut().zip(array) {
            *number = value.as_f64()?;
        }
        // The typed document has the same property and has already refused another length.
        (array.len() == N).then_some(numbers)
    }

    /// The extensions that the file uses and that are left out.
    pub(super) fn ignored_extensions(&self) -> impl Iterator<Item = &str> {
        self.root.extensions_used.iter().map(String::as_str).filter(|name| !SUPPORTED.contains(name))
    }

    /// The scene that is drawn: the one that is chosen, or the default one, or the first; `None` if there is none.
    pub(super) fn scene(&self, choice: Option<&Choice>) -> Result<Option<usize>> {
        let scenes = &self.root.scenes;
        match choice {
            Some(choice) => self.choose("scene", choice, scenes.iter().map(|scene| scene.name.as_deref())).map(Some),
            // `validate` has seen that the default scene exists.
            None => Ok(self.root.scene.map(|scene| scene.value()).or((!scenes.is_empty()).then_some(0))),
        }
    }

    /// The number of a chosen thing. `what` it is in a word, and `names` the names of all there are.
    pub(super) fn choose<'a>(
        &self,
        what: &'static str,
        choice: &Choice,
        names: impl Iterator<Item = Option<&'a str>> + Clone,
    ) -> Result<usize> {
        let found = match choice {
            Choice::Index(index) => Some(*index).filter(|&index| index < names.clone().count()),
            Choice::Name(wanted) => names.clone().position(|name| name == Some(wanted)),
        };
        found.ok_or_else(|| {
            let known: Vec<String> = names
                .enumerate()
                .map(|(index, name)| name.map_or_else(|| index.to_string(), |name| format!("{index} (`{name}`)")))
                .collect();
            let choice = choice.to_string();
            ImportError::Choice { file: self.file.clone(), what, choice, known: known.join(", ") }
        })
    }

    /// The checks of the `gltf` crate, and before them those it forgets.
    fn validate(&self) -> Result<()> {
        use validation::Validate as _;
        let node_count = self.root.nodes.len();
        for (a, animation) in self.root.animations.iter().enumerate() {
            for (c, channel) in animation.channels.iter().enumerate() {
                let node = channel.target.node;
                if node.value() >= node_count {
                    return Err(self.invalid(
                        format_args!("animations[{a}].channels[{c}].target.node"),
                        format_args!("names node {node}, but there are {node_count}; export the file again"),
                    ));
                }
            }
        }
        let accessor_count = self.root.accessors.len();
        for (m, mesh) in self.root.meshes.iter().enumerate() {
            for (p, primitive) in mesh.primitives.iter().enumerate() {
                for (semantic, accessor) in &primitive.attributes {
                    if accessor.value() >= accessor_count {
                        let name = match semantic {
                            validation::Checked::Valid(semantic) => semantic.to_string(),
                            validation::Checked::Invalid => "(unknown)".into(),
                        };
                        return Err(self.invalid(
                            format_args!("meshes[{m}].primitives[{p}].attributes.{name}"),
                            format_args!("names accessor {accessor}, but there are {accessor_count}; export the file again"),
                        ));
                    }
                }
            }
        }
        let mut first = None;
        self.root.validate(&self.root, gltf::json::Path::new, &mut |path, error| {
            let path = path();
            if first.is_none() && !is_tolerated(path.as_str(), error) {
                first = Some((path, error));
            }
        });
        match first {
            None => Ok(()),
            // Its paths have Rust's name for the one extension that they can lead through.
            Some((path, error)) => {
                Err(self.invalid(path.as_str().replace("khrLightsPunctual", "KHR_lights_punctual"), describe(error)))
            }
        }
    }
}

/// Whether a complaint of the `gltf` crate is about something that is not used, or that is checked elsewhere.
fn is_tolerated(path: &str, error: validation::Error) -> bool {
    // Bounds are computed from the positions and not believed; primitives without positions are left out with a note.
    let position_bounds = path.contains(".attributes[\"POSITION\"]") && error != validation::Error::IndexOutOfBounds;
    // An attribute of a name that glTF does not know.
    let unknown_attribute = path.contains("<invalid semantic name>");
    // A texture whose image is in an extension is left out with a note.
    let no_image = path.starts_with("textures[") && error == validation::Error::Missing;
    // The accessor reader says what the absence of a buffer view means for each use.
    let no_view = path.starts_with("accessors[") && path.ends_with(".bufferView") && error == validation::Error::Missing;
    // `check_required_extensions` has seen to them.
    let extension = error == validation::Error::Unsupported;
    position_bounds || unknown_attribute || no_image || no_view || extension
}

/// A complaint of the `gltf` crate in a sentence.
fn describe(error: validation::Error) -> &'static str {
    match error {
        validation::Error::IndexOutOfBounds => "this index names something that does not exist; export the file again",
        validation::Error::Invalid => "this value is not one that glTF allows; export the file again",
        validation::Error::Missing => "something that glTF requires here is missing; export the file again",
        validation::Error::Oversize => "this number does not fit the address space",
        validation::Error::Unsupported => "this is not supported",
    }
}

/// Refuses what is not glTF 2.
fn check_version(file: &str, raw: &Value) -> Result<()> {
    let asset = &raw["asset"];
    for (place, version) in [("asset.version", asset.get("version")), ("asset.minVersion", asset.get("minVersion"))] {
        let Some(version) = version else {
            if place == "asset.version" {
                let problem = "glTF requires a version; if this is a glTF file, export it again".into();
                return Err(ImportError::Invalid { file: file.into(), place: place.into(), problem });
            }
            continue;
        };
        let number = version.as_str().and_then(|text| {
            let (major, minor) = text.split_once('.')?;
            Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
        });
        // A later minor version is compatible, unless the file says that it needs it.
        let understood = number.is_some_and(|(major, minor)| major == 2 && (place == "asset.version" || minor == 0));
        if !understood {
            return Err(ImportError::Version { file: file.into(), place, version: version.to_string() });
        }
    }
    Ok(())
}

/// Refuses a file that cannot be drawn without an extension that is not supported.
fn check_required_extensions(file: &str, raw: &Value) -> Result<()> {
    let required = raw["extensionsRequired"].as_array().map_or(&[][..], Vec::as_slice);
    for (i, name) in required.iter().enumerate() {
        let name = name.as_str().unwrap_or_default();
        if !SUPPORTED.contains(&name) && !SHADING_ONLY.contains(&name) {
            return Err(ImportError::Extension {
                file: file.into(),
                place: format!("extensionsRequired[{i}]"),
                name: name.into(),
                advice: advice(name),
            });
        }
    }
    Ok(())
}

/// Makes valid files acceptable to [`Root`], which demands more than glTF does. The result has, for each animation, the
/// number that each of its channels had before.
fn supply_what_root_demands(raw: &mut Value) -> Vec<Vec<usize>> {
    // A channel must name a node; glTF has those without one ignored.
    let mut channel_numbers = Vec::new();
    for animation in raw.get_mut("animations").and_then(Value::as_array_mut).into_iter().flatten() {
        let mut kept = Vec::new();
        if let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) {
            let mut number = 0;
            channels.retain(|channel| {
                let keep = channel["target"].get("node").is_some() || !channel["target"].is_object();
                if keep {
                    kept.push(number);
                }
                number += 1;
                keep
            });
        }
        channel_numbers.push(kept);
    }
    // A scene must list its nodes, even if it has none.
    for scene in raw.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        if let Some(scene) = scene.as_object_mut() {
            scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
        }
    }
    channel_numbers
}

/// The accessor of an attribute of a primitive.
pub(super) fn attribute(primitive: &gltf::json::mesh::Primitive, semantic: Semantic) -> Option<usize> {
    primitive.attributes.get(&validation::Checked::Valid(semantic)).map(gltf::json::Index::value)
}
