//! Files: written under a temporary name in the same folder and renamed, so that a file is there whole or not at all.

use std::{
    fs::{self, File, OpenOptions},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
    sync::atomic::{AtomicU32, Ordering},
};

use shadow_scene::{Layer, LayerName};

use crate::{
    error::CliError,
    exr::write_exr,
    interrupt::{begin_file, end_file},
    picture::Picture,
};

/// What a layer is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// A picture to look at.
    Png,
    /// The numbers.
    Exr,
}

impl Format {
    /// The format that the ending of a name says.
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        let is = |ending: &str| extension.eq_ignore_ascii_case(ending);
        if is("png") { Some(Self::Png) } else { is("exr").then_some(Self::Exr) }
    }
}

/// Checks, before any work is done, that a layer can be written there: its name ends in a format's and its folder exists. Gives the format.
pub(crate) fn check_output_path(path: &Path) -> Result<Format, CliError> {
    let Some(format) = Format::of(path) else { return Err(CliError::Format { path: path.into() }) };
    check_folder_of(path)?;
    Ok(format)
}

/// Checks, before any work is done, that a drawing can be written there: its name ends in .svg and its folder exists.
pub(crate) fn check_drawing_path(path: &Path) -> Result<(), CliError> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg")) {
        return Err(CliError::DrawingName { path: path.into() });
    }
    check_folder_of(path)
}

/// Checks, before any work is done, that a file can be written there: its folder exists, and it is no folder itself.
pub(crate) fn check_folder_of(path: &Path) -> Result<(), CliError> {
    if path.is_dir() {
        return Err(CliError::Write { path: path.into(), source: io::ErrorKind::IsADirectory.into() });
    }
    let folder = folder_of(path);
    let refused = |problem: String| Err(CliError::Write { path: path.into(), source: io::Error::other(problem) });
    match fs::metadata(folder) {
        Ok(metadata) if metadata.is_dir() => Ok(()),
        Ok(_) => refused(format!("`{}` is not a folder; choose another one", folder.display())),
        Err(error) => {
            refused(format!("the folder `{}` cannot be used: {error}; make it or choose another one", folder.display()))
        }
    }
}

/// Makes a folder, and those above it, where there is none.
pub(crate) fn make_folder(path: &Path) -> Result<(), CliError> {
    if path.is_file() {
        let source = io::Error::other("it is a file and not a folder; choose another name");
        return Err(CliError::Write { path: path.into(), source });
    }
    fs::create_dir_all(path).map_err(|source| CliError::Write { path: path.into(), source })
}

/// Writes a picture as PNG.
pub(crate) fn write_picture(path: &Path, picture: &Picture) -> Result<(), CliError> {
    write_atomically(path, |file| picture.write_png(file))
}

/// Writes the numbers of a layer as OpenEXR.
pub(crate) fn write_layer(path: &Path, layer: &Layer) -> Result<(), CliError> {
    write_atomically(path, |file| write_exr(layer, file))
}

/// Writes a text.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), CliError> {
    write_atomically(path, |file| file.write_all(text.as_bytes()))
}

/// The name of a file for a layer: only letters, digits and hyphens, whatever the layer's name is.
pub(crate) fn file_name(layer: LayerName, what: &str) -> String {
    let stem: String = layer.to_string().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    format!("{stem}-{what}.png")
}

/// Lets `write` fill a new file beside `path` and gives it that name when it is complete. On failure nothing is left behind, and
/// what was at `path` before is still there; so it is if the program is interrupted.
fn write_atomically(path: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), CliError> {
    let failed = |source| CliError::Write { path: path.into(), source };
    let temporary = TemporaryFile::beside(path);
    // Not a private file, as temporary ones commonly are: it will be the final one, and has the permissions of any new file.
    let file = OpenOptions::new().write(true).create_new(true).open(&temporary.path).map_err(failed)?;
    let mut file = BufWriter::new(file);
    write(&mut file).map_err(failed)?;
    let file = file.into_inner().map_err(|error| failed(error.into_error()))?;
    // What a system puts off, such as noticing that a disk is full, it does now.
    file.sync_all().map_err(failed)?;
    fs::rename(&temporary.path, path).map_err(failed)
}

/// A file that is removed when it goes out of scope, unless it was renamed by then.
struct TemporaryFile {
    path: PathBuf,
}

impl TemporaryFile {
    /// A name in the folder of `path` that no other file, thread or process has.
    fn beside(path: &Path) -> Self {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        let name = format!(".shadow-{}-{number}.tmp", std::process::id());
        let path = folder_of(path).join(name);
        begin_file(&path);
        Self { path }
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        // After the renaming there is nothing to remove, and a failure to remove cannot be mended here.
        let _ = fs::remove_file(&self.path);
        end_file(&self.path);
    }
}

/// The folder of a file; that of a bare name is the current one.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fresh folder for a test.
    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("shadow-cli-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        path
    }

    fn names(folder: &Path) -> Vec<String> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_is_replaced_whole() {
        let folder = folder("replaced");
        let path = folder.join("a.json");
        write_text(&path, "a long first text").unwrap();
        write_text(&path, "short").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "short");
        assert_eq!(names(&folder), ["a.json"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = folder("failure");
        let path = folder.join("a.json");
        write_text(&path, "old").unwrap();
        let error = write_atomically(&path, |file| {
            file.write_all(b"half of the new")?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert!(matches!(error, Err(CliError::Write { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(&folder), ["a.json"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn paths_that_cannot_work_are_refused_before_the_work() {
        let folder = folder("paths");
        write_text(&folder.join("file"), "").unwrap();
        assert!(matches!(make_folder(&folder.join("file")), Err(CliError::Write { .. })));
        make_folder(&folder.join("one/two")).unwrap();
        make_folder(&folder.join("one/two")).unwrap();
        assert_eq!(check_output_path(&folder.join("a.png")).unwrap(), Format::Png);
        assert_eq!(check_output_path(&folder.join("a.PNG")).unwrap(), Format::Png);
        assert_eq!(check_output_path(Path::new("a.exr")).unwrap(), Format::Exr);
        assert!(matches!(check_output_path(&folder.join("a.jpg")), Err(CliError::Format { .. })));
        assert!(matches!(check_output_path(&folder.join("a")), Err(CliError::Format { .. })));
        assert!(matches!(check_output_path(&folder.join("missing/a.png")), Err(CliError::Write { .. })));
        fs::create_dir(folder.join("b.png")).unwrap();
        assert!(matches!(check_output_path(&folder.join("b.png")), Err(CliError::Write { .. })));
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn file_names_are_safe() {
        assert_eq!(file_name(LayerName::ShadowMap { light: 0, view: 1 }, "cpu"), "shadow-map-0-1-cpu.png");
        assert_eq!(file_name(LayerName::Visibility { light: 12 }, "difference"), "visibility-12-difference.png");
        assert_eq!(file_name(LayerName::Color, "gpu"), "color-gpu.png");
    }
}
