//! glTF 2.0 import.
//!
//! [`import`] reads a `.gltf` or `.glb` file and what it refers to in the same folder, and nothing else: no absolute path, no
//! path out of the folder, no network.
//! Every length is checked before memory is taken, so that a damaged or malicious file ends with an [`ImportError`].
//!
//! # What becomes of a file
//!
//! - One scene is drawn: the chosen one, or the default one, or the first, or all root nodes if there is no scene.
//! - Triangles, strips and fans in world space, wound counter-clockwise whatever the transforms; missing normals become flat
//!   ones. Points and lines are left out with a note; a file without triangles is an empty scene.
//! - Nodes, skins and morph targets stand in the pose that one animation has at one time: the chosen animation, or the first,
//!   at 0 s unless another time is chosen. A file without animations stands in its rest pose. All animations are checked.
//! - Base colour (factor, texture, vertex colour), alpha mask, sidedness and roughness of materials. Blended materials become
//!   opaque, with a note. Textures are PNG or JPEG.
//! - Extensions: KHR_lights_punctual, KHR_texture_transform, KHR_mesh_quantization, EXT_mesh_gpu_instancing,
//!   KHR_node_visibility (which hides meshes and lights, not cameras), KHR_draco_mesh_compression, EXT_meshopt_compression and
//!   KHR_meshopt_compression, and the diffuse colour of KHR_materials_pbrSpecularGlossiness. Others are named in a note; a
//!   file that requires one which changes more than shading is refused.
//! - Positions are transformed in double precision and rounded once, relative to an origin near the scene where it lies far
//!   from zero ([`choose_origin`]).
//!
//! # Memory
//!
//! What a file makes the import reserve is claimed from [`ImportOptions::memory_limit`] before it is reserved: the file and its
//! buffers, what is decompressed from them, every vertex and triangle of every instance, and decoded textures. Counts without
//! bytes behind them, and images that claim more texels than their bytes can hold, are refused whatever the limit is.

use std::{fs, path::Path};

use glam::{DAffine3, DVec3};

mod error;
mod options;
mod budget;
mod container;
mod document;
mod uri;
mod buffers;
mod meshopt;
mod accessor;
mod animation;
mod nodes;
mod draco;
mod attributes;
mod geometry;
mod instancing;
mod skin;
mod images;
mod materials;
mod lights;
mod cameras;
mod notes;
mod facts;
#[cfg(test)]
mod tests;

pub use error::ImportError;
pub use options::{Choice, ImportOptions};

use self::{
    animation::Pose,
    budget::{Budget, Use},
    buffers::Buffers,
    document::Document,
    error::Result,
    geometry::Part,
    materials::Materials,
    nodes::Hierarchy,
    notes::Notes,
    uri::Folder,
};
use crate::{
    builder::{Mesh, SceneBuilder, SceneError, choose_origin},
    scene::{Scene, Vertices},
    source::SourceFacts,
};

/// The largest coordinate of a vertex relative to the origin, in metres: the product of three of them still fits f32.
///
/// It is seven times the distance to the sun; a vertex beyond it is damage, and one is enough to lose the rest of the scene in
/// its bounds.
const MAX_COORDINATE: f64 = 1e12;

/// Imports a glTF 2.0 file, text (`.gltf`) or binary (`.glb`); its content decides which, not its name.
///
/// This is [`import_with`] with the default options.
///
/// # Errors
///
/// As [`import_with`].
pub fn import(path: &Path) -> core::result::Result<Scene, ImportError> {
    import_with(path, &ImportOptions::default())
}

/// Imports a chosen scene of a glTF 2.0 file, text (`.gltf`) or binary (`.glb`), in a chosen pose.
///
/// # Errors
///
/// An [`ImportError`] if the file or one that it refers to cannot be read, is not as glTF demands, needs an extension that is
/// not supported or more memory than the options allow, or does not have what they choose. It names the file and the place
/// in it.
pub fn import_with(path: &Path, options: &ImportOptions) -> core::result::Result<Scene, ImportError> {
    let file = path.display().to_string();
    let budget = Budget::new(&file, options.memory_limit);
    let bytes = read_file(&file, path, &budget)?;
    import_bytes(&file, &bytes, Folder { path: Some(folder_of(path)), budget: &budget }, options)
}

/// The folder that a file lies in.
fn folder_of(path: &Path) -> &Path {
    // The parent of a bare name is the empty path, which stands for the current folder only in joins.
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The content of the file itself, if the budget has room for it.
fn read_file(file: &str, path: &Path, budget: &Budget) -> Result<Vec<u8>> {
    let failed = |source| ImportError::Read { file: file.into(), source };
    let length = fs::metadata(path).map_err(failed)?.len();
    budget.claim(Use::Buffers, length, "")?;
    fs::read(path).map_err(failed)
}

/// Imports the content of a glTF 2.0 file that refers to no other file. `name` is what messages call it.
///
/// This is [`import_slice_with`] with the default options.
///
/// # Errors
///
/// As [`import_slice_with`].
///
/// ```
/// let gltf = br#"{
///     "asset": {"version": "2.0"},
///     "nodes": [{"mesh": 0}],
///     "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
///     "accessors": [{"bufferView": 0, "componentType": 5121, "type": "VEC3", "count": 3, "min": [0, 0, 0], "max": [1, 1, 0]}],
///     "bufferViews": [{"buffer": 0, "byteLength": 12, "byteStride": 4}],
///     "buffers": [{"byteLength": 12, "uri": "data:;base64,AAAAAAEAAAAAAQAA"}]
/// }"#;
/// let scene = shadow_scene::import::import_slice("triangle.gltf", gltf)?;
/// assert_eq!(scene.triangles().len(), 1);
/// assert_eq!(scene.vertices().normals[0], glam::Vec3::Z);
/// # Ok::<(), shadow_scene::ImportError>(())
/// ```
pub fn import_slice(name: &str, bytes: &[u8]) -> core::result::Result<Scene, ImportError> {
    import_slice_with(name, bytes, &ImportOptions::default())
}

/// Imports a chosen scene, in a chosen pose, from the content of a glTF 2.0 file that refers to no other file. `name` is
/// what messages call it.
///
/// # Errors
///
/// As [`import_with`], and if there is a reference to another file.
///
/// ```
/// use shadow_scene::{Choice, ImportOptions, import::import_slice_with};
///
/// let gltf = br#"{"asset": {"version": "2.0"}, "scenes": [{"name": "day"}, {"name": "night"}]}"#;
/// let options = ImportOptions { scene: Some(Choice::Name("dusk".into())), ..ImportOptions::default() };
/// let error = import_slice_with("house.gltf", gltf, &options).unwrap_err();
/// assert_eq!(error.to_string(), "house.gltf: there is no scene `dusk`; choose one of 0 (`day`), 1 (`night`)");
/// ```
pub fn import_slice_with(name: &str, bytes: &[u8], options: &ImportOptions) -> core::result::Result<Scene, ImportError> {
    let budget = Budget::new(name, options.memory_limit);
    import_bytes(name, bytes, Folder { path: None, budget: &budget }, options)
}

/// A node of a file in a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PosedNode {
    /// The name; may be empty.
    pub name: String,
    /// The matrix from the node's space to the file's world space, in metres; `None` for a node on a loop of nodes, which
    /// has no place.
    pub world_from_node: Option<DAffine3>,
}

/// Where the nodes of a glTF 2.0 file stand in the pose that the options choose, in the order of the file.
///
/// A scene has no nodes any more; this is for tools that follow a joint, and for comparing poses joint by joint.
///
/// # Errors
///
/// As [`import_with`], but for what is wrong with meshes, materials, lights and cameras, which are not read.
///
/// ```no_run
/// use std::path::Path;
/// use shadow_scene::{ImportOptions, import::node_poses};
///
/// let options = ImportOptions { time: 0.5, ..ImportOptions::default() };
/// for node in node_poses(Path::new("Fox.glb"), &options)? {
///     println!("{}: {:?}", node.name, node.world_from_node.map(|world_from_node| world_from_node.translation));
/// }
/// # Ok::<(), shadow_scene::ImportError>(())
/// ```
pub fn node_poses(path: &Path, options: &ImportOptions) -> core::result::Result<Vec<PosedNode>, ImportError> {
    let file = path.display().to_string();
    let budget = Budget::new(&file, options.memory_limit);
    let bytes = read_file(&file, path, &budget)?;
    let posed = Posed::read(&file, &bytes, Folder { path: Some(folder_of(path)), budget: &budget }, options)?;
    let nodes = posed.document.root.nodes.iter().enumerate();
    let node = |(i, node): (usize, &gltf::json::Node)| PosedNode {
        name: node.name.clone().unwrap_or_default(),
        world_from_node: posed.hierarchy.world_from_node(i),
    };
    Ok(nodes.map(node).collect())
}

/// A file whose nodes stand in the pose that the options choose.
struct Posed<'a> {
    document: Document,
    buffers: Buffers<'a>,
    pose: Pose,
    hierarchy: Hierarchy,
    facts: SourceFacts,
    notes: Notes,
}

impl<'a> Posed<'a> {
    fn read(file: &str, bytes: &'a [u8], folder: Folder<'a>, options: &ImportOptions) -> Result<Self> {
        let container = container::split(file, bytes)?;
        // Texts, such as data URIs, are copied into the document as it was written and into the typed one.
        folder.budget.claim(Use::Buffers, 2 * container.json.len() as u64, "")?;
        let document = Document::parse(file, container.json)?;
        let buffers = Buffers::load(&document, folder, container.bin)?;
        let scene = document.scene(options.scene.as_ref())?;
        let mut facts = facts::of(&document, scene);
        let mut notes = Notes { extensions: facts.extensions_ignored.clone(), ..Notes::default() };
        let pose = Pose::read(&document, &buffers, options, &mut facts, &mut notes)?;
        let hierarchy = Hierarchy::place(&document, scene, &pose)?;
        Ok(Self { document, buffers, pose, hierarchy, facts, notes })
    }
}

fn import_bytes(file: &str, bytes: &[u8], folder: Folder<'_>, options: &ImportOptions) -> Result<Scene> {
    let Posed { document, buffers, pose, hierarchy, mut facts, mut notes } = Posed::read(file, bytes, folder, options)?;
    let parts = geometry::collect(&document, &buffers, &hierarchy, &pose, &mut notes)?;

    let positions = || parts.iter().flat_map(|part| &part.positions);
    let min = positions().copied().fold(DVec3::INFINITY, DVec3::min);
    let max = positions().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let mut builder = SceneBuilder::new(choose_origin(min, max));
    let mut materials = Materials::new(&document, &buffers, folder);
    for part in parts {
        let material = materials.scene_material(part.material, &mut builder, &mut notes)?;
        let name = part.name.clone();
        let mesh = mesh(&document, part, builder.origin())?;
        builder.add_instance(name, material, mesh).map_err(|source| scene_error(file, source))?;
    }
    lights::add(&document, &hierarchy, &mut builder)?;
    cameras::add(&document, &hierarchy, &mut builder)?;
    for sentence in notes.sentences() {
        builder.add_note(sentence);
    }
    materials.describe_images(&builder, &mut facts);
    facts.points_and_lines = notes.points_or_lines;
    facts.blended_materials = notes.blended;
    builder.set_source(facts);
    builder.build().map_err(|source| scene_error(file, source))
}

fn scene_error(file: &str, source: SceneError) -> ImportError {
    ImportError::Scene { file: file.into(), source: Box::new(source) }
}

/// A part relative to the scene's origin, rounded to single precision.
fn mesh(document: &Document, part: Part, origin: DVec3) -> Result<Mesh> {
    let relative = |(i, position): (usize, &DVec3)| {
        let relative = *position - origin;
        // Written so that NaN, from an overflow of the transform, is refused too.
        if relative.abs().max_element() <= MAX_COORDINATE && relative.is_finite() {
            Ok(relative.as_vec3())
        } else {
            Err(document.invalid(
                &part.place,
                format_args!(
                    "`{}` has a vertex (number {i} of those that are used) at {:?} m in the world; it may be at most {MAX_COORDINATE:e} m from the scene's origin {:?}: move or remove it",
                    part.name,
                    position.to_array(),
                    origin.to_array()
                ),
            ))
        }
    };
    let positions = part.positions.iter().enumerate().map(relative).collect::<Result<_>>()?;
    let vertices = Vertices { positions, normals: part.normals, uvs: part.uvs, colors: part.colors };
    Ok(Mesh { vertices, triangles: part.triangles })
}
