//! What of a file is imported: which scene, in which pose, and within how much memory.

use core::{convert::Infallible, fmt, str::FromStr};

/// Which one of several things in a file: by its number from 0, or by its name.
///
/// Text is a number if it is one, so that a thing whose name is a number is chosen by [`Choice::Name`] alone.
///
/// ```
/// use shadow_scene::Choice;
///
/// assert_eq!("2".parse(), Ok(Choice::Index(2)));
/// assert_eq!("Walk".parse(), Ok(Choice::Name("Walk".into())));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Choice {
    /// The number, from 0, in the order of the file.
    Index(usize),
    /// The name; of several things that share it, the first one.
    Name(String),
}

impl FromStr for Choice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(text.parse().map_or_else(|_| Self::Name(text.into()), Self::Index))
    }
}

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => index.fmt(f),
            Self::Name(name) => write!(f, "`{name}`"),
        }
    }
}

/// What of a file is imported.
///
/// ```no_run
/// use std::path::Path;
/// use shadow_scene::{Choice, ImportOptions, import_with};
///
/// let options = ImportOptions { animation: Some(Choice::Name("Run".into())), time: 0.5, ..ImportOptions::default() };
/// let scene = import_with(Path::new("Fox.glb"), &options)?;
/// assert_eq!(scene.source().animations[2].name, "Run");
/// # Ok::<(), shadow_scene::ImportError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ImportOptions {
    /// The scene that is drawn. `None` takes the file's default scene, the first one if it has none, and all nodes of a
    /// file without scenes.
    pub scene: Option<Choice>,
    /// The animation whose pose is drawn. `None` takes the first one, and the rest pose of a file without animations.
    pub animation: Option<Choice>,
    /// The time of the pose in seconds since the start of the animation, 0 or more. Before its first key an animation
    /// stands as at the first one, after its last key as at the last one.
    pub time: f64,
    /// The most memory that the import may reserve for a file's buffers, its meshes with all their instances, and its
    /// decoded textures, together, in bytes. What would need more is refused before it is reserved.
    pub memory_limit: u64,
}

impl ImportOptions {
    /// The memory limit unless another one is given: 4 GiB.
    ///
    /// That is a hundred times what scenes of a million triangles take, and leaves half of an 8 GiB computer to a renderer.
    pub const DEFAULT_MEMORY_LIMIT: u64 = 4 << 30;
}

impl Default for ImportOptions {
    /// The default scene, at the start of its first animation, within [`ImportOptions::DEFAULT_MEMORY_LIMIT`].
    fn default() -> Self {
        Self { scene: None, animation: None, time: 0.0, memory_limit: Self::DEFAULT_MEMORY_LIMIT }
    }
}
