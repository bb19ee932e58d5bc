//! Facts about the file that a scene came from, for people who want to know what is in it.

/// What there is in the file that a scene came from. That of a scene which came from no file has nothing in it.
///
/// Counts are those of the whole file, whatever of it is drawn, unless a field says otherwise.
///
/// ```
/// let scene = shadow_scene::builtin::demo();
/// assert_eq!(scene.source(), &shadow_scene::SourceFacts::default());
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceFacts {
    /// The program that wrote the file, as it calls itself.
    pub generator: Option<String>,
    /// The names of the scenes; empty where one has none.
    pub scenes: Vec<String>,
    /// The scene that is drawn; `None` if the file has none, so that all its nodes are.
    pub scene: Option<usize>,
    /// How many nodes there are.
    pub nodes: usize,
    /// How many meshes there are.
    pub meshes: usize,
    /// How many primitives the meshes have, each counted once.
    pub primitives: usize,
    /// How many drawn primitives are made of points or lines, and are left out.
    pub points_and_lines: usize,
    /// How many materials there are.
    pub materials: usize,
    /// How many of the drawn materials are blended (alphaMode BLEND); they are drawn as opaque.
    pub blended_materials: usize,
    /// How many textures there are.
    pub textures: usize,
    /// The images.
    pub images: Vec<ImageFacts>,
    /// The animations.
    pub animations: Vec<AnimationFacts>,
    /// The animation whose pose is drawn; `None` for the rest pose.
    pub animation: Option<usize>,
    /// The time of the pose that is drawn, in seconds: the one that was asked for, but at most the animation's last key.
    pub time: f64,
    /// How many skins there are.
    pub skins: usize,
    /// The extensions that the file uses.
    pub extensions_used: Vec<String>,
    /// The extensions that it uses and that are left out.
    pub extensions_ignored: Vec<String>,
}

/// An image of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageFacts {
    /// The name, or where there is none the file it lies in; may be empty.
    pub name: String,
    /// Width and height in texels; `None` if no drawn material uses the image, which is then not read.
    pub size: Option<[u32; 2]>,
}

/// An animation of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnimationFacts {
    /// The name; may be empty.
    pub name: String,
    /// The time of the last key of all channels, in seconds.
    pub seconds: f64,
    /// How many channels there are; one moves one property of one node.
    pub channels: usize,
}
