//! Why a glTF file cannot be imported.

use std::io;

use crate::builder::SceneError;

/// Why a glTF file cannot be imported.
///
/// Every message names the file, and where there is one the place in it as a JSON path such as
/// `meshes[3].primitives[0].attributes.POSITION`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImportError {
    /// The file itself cannot be read.
    #[error("{file}: cannot be read: {source}{}", read_hint(source))]
    Read {
        /// The file.
        file: String,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file is neither JSON nor a binary glTF container, or the container is damaged.
    #[error("{file}: {problem}")]
    Container {
        /// The file.
        file: String,
        /// What is wrong, and the way out.
        problem: String,
    },
    /// The JSON is not well-formed.
    #[error("{file}: the JSON is not well-formed: {source}; export the file again")]
    Json {
        /// The file.
        file: String,
        /// What is wrong; line and column count from the start of the JSON.
        source: serde_json::Error,
    },
    /// The file demands another version of glTF.
    #[error("{file}: {place} is {version}, but only glTF 2.0 is understood; export the file as glTF 2.0")]
    Version {
        /// The file.
        file: String,
        /// `asset.version` or `asset.minVersion`.
        place: &'static str,
        /// The version it demands, as JSON.
        version: String,
    },
    /// The file cannot be drawn without an extension that is not supported.
    #[error("{file}: {place}: the extension {name} is required, but it is not supported; {advice}")]
    Extension {
        /// The file.
        file: String,
        /// The JSON path of the entry.
        place: String,
        /// The extension.
        name: String,
        /// What to do.
        advice: &'static str,
    },
    /// Something in the file is not as glTF demands, or beyond a limit.
    #[error("{file}: {place}: {problem}")]
    Invalid {
        /// The file.
        file: String,
        /// The JSON path.
        place: String,
        /// What is wrong: the value, the limit and the way out.
        problem: String,
    },
    /// A file that this one refers to cannot be read.
    #[error("{file}: {place}: `{path}` cannot be read: {source}; put it beside the glTF file")]
    Resource {
        /// The file.
        file: String,
        /// The JSON path.
        place: String,
        /// The file that is missing, relative to the glTF file's folder.
        path: String,
        /// What the operating system says.
        source: io::Error,
    },
    /// A scene or an animation is chosen that the file does not have.
    #[error("{file}: there is no {what} {choice}; {}", choice_hint(what, known))]
    Choice {
        /// The file.
        file: String,
        /// "scene" or "animation".
        what: &'static str,
        /// What was chosen.
        choice: String,
        /// What there is, in words; empty if there is nothing.
        known: String,
    },
    /// The time of the pose is not a time.
    #[error("{file}: the pose at {time} s cannot be drawn; a time is a number of seconds, 0 or more")]
    Time {
        /// The file.
        file: String,
        /// The time in seconds.
        time: f64,
    },
    /// The pose at a time is asked for, but nothing in the file moves.
    #[error("{file}: the pose at {time} s cannot be drawn, because the file has no animations; leave out the time")]
    NoAnimation {
        /// The file.
        file: String,
        /// The time in seconds.
        time: f64,
    },
    /// The import would take more memory than it may.
    #[error("{file}: {place}with these {what} the import takes {} MiB, but its memory limit is {} MiB; raise the limit, or {advice}", needed.div_ceil(MIB), limit / MIB)]
    Memory {
        /// The file.
        file: String,
        /// The JSON path of what needs it, with a colon and a space behind it; empty for the file itself.
        place: String,
        /// "buffers", "meshes" or "textures".
        what: &'static str,
        /// How many bytes the import would have taken with it.
        needed: u64,
        /// The limit in bytes.
        limit: u64,
        /// What to do other than to raise the limit.
        advice: &'static str,
    },
    /// What the file contains makes no scene.
    #[error("{file}: {source}")]
    Scene {
        /// The file.
        file: String,
        /// What is wrong.
        source: Box<SceneError>,
    },
}

/// Bytes of a mebibyte.
const MIB: u64 = 1 << 20;

/// The result of a step of the import.
pub(super) type Result<T> = core::result::Result<T, ImportError>;

/// What to do about a file that cannot be read.
fn read_hint(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::NotFound => "; a scene is a .gltf or .glb file that exists",
        io::ErrorKind::IsADirectory => "; name the .gltf or .glb file in the folder",
        io::ErrorKind::PermissionDenied => "; ask for the right to read it, or copy it",
        _ => "",
    }
}

/// What to choose instead of what there is not.
fn choice_hint(what: &str, known: &str) -> String {
    if known.is_empty() { format!("the file has no {what}s: choose none") } else { format!("choose one of {known}") }
}
