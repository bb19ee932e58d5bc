//! URIs: data inside the file, or a file in its folder; nothing else is ever read.

use core::fmt::Display;
use std::{
    borrow::Cow,
    fs,
    io::{self, Read as _},
    path::{Component, Path, PathBuf},
};

use base64::{
    Engine as _,
    engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig},
};
use percent_encoding::percent_decode_str;

use super::{
    budget::{Budget, Use},
    document::Document,
    error::{ImportError, Result},
};

/// Standard base64; the padding at the end may be missing, as it is in many files.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Where external files are read from, and within how much memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Folder<'a> {
    /// The folder; `None` refuses all external files.
    pub(super) path: Option<&'a Path>,
    /// The memory that the import may take.
    pub(super) budget: &'a Budget,
}

impl Folder<'_> {
    /// The bytes that a URI stands for, of which there must be at least `at_least` if that is given; no more than
    /// those are read then. `place` is the JSON path of the URI.
    pub(super) fn read(
        self,
        document: &Document,
        uri: &str,
        what: Use,
        at_least: Option<u64>,
        place: impl Display,
    ) -> Result<Vec<u8>> {
        let bytes = if let Some(data) = strip_scheme(uri, "data") {
            // Decoding never lengthens the text.
            self.budget.claim(what, data.len() as u64, &place)?;
            decode_data(data).map_err(|problem| document.invalid(&place, problem))?
        } else {
            let path = relative_path(uri).map_err(|problem| document.invalid(&place, problem))?;
            self.read_file(document, &path, what, at_least, &place)?
        };
        match at_least {
            Some(length) if (bytes.len() as u64) < length => Err(document.invalid(
                place,
                format_args!("byteLength is {length}, but there are only {} bytes; the data was cut short", bytes.len()),
            )),
            _ => Ok(bytes),
        }
    }

    /// Reads a file in the folder. It is looked up with every link resolved, so that none leads out of the folder.
    fn read_file(
        self,
        document: &Document,
        path: &Path,
        what: Use,
        at_least: Option<u64>,
        place: &impl Display,
    ) -> Result<Vec<u8>> {
        let Some(folder) = self.path else {
            return Err(document.invalid(
                place,
                format_args!(
                    "`{}` is a file of its own, and there is no folder to read it from; embed it as a data URI or in a .glb",
                    path.display()
                ),
            ));
        };
        let resource = |source: io::Error| ImportError::Resource {
            file: document.file().into(),
            place: place.to_string(),
            path: path.display().to_string(),
            source,
        };
        let folder = folder.canonicalize().map_err(resource)?;
        let target = folder.join(path).canonicalize().map_err(resource)?;
        if !target.starts_with(&folder) {
            return Err(document.invalid(
                place,
                format_args!("`{}` is a link that leads out of the glTF file's folder; copy the file it names", path.display()),
            ));
        }
        // Opening a pipe would wait for a writer: what kind of file it is must be known first.
        let metadata = fs::metadata(&target).map_err(resource)?;
        if !metadata.is_file() {
            return Err(document.invalid(place, format_args!("`{}` is not a regular file", path.display())));
        }
        if let Some(length) = at_least
            && metadata.len() < length
        {
            return Err(document.invalid(
                place,
                format_args!(
                    "byteLength is {length}, but `{}` has only {} bytes; it was cut short",
                    path.display(),
                    metadata.len()
                ),
            ));
        }
        let length = at_least.unwrap_or(metadata.len());
        self.budget.claim(what, length, place)?;
        let mut bytes = Vec::with_capacity(length as usize);
        let file = fs::File::open(&target).map_err(resource)?;
        file.take(length).read_to_end(&mut bytes).map_err(resource)?;
        Ok(bytes)
    }
}

/// What follows `scheme:`, which is compared without regard to case.
fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let (found, rest) = uri.split_once(':')?;
    found.eq_ignore_ascii_case(scheme).then_some(rest)
}

/// The content of a data URI, from behind its scheme: `[type][;parameter]*[;base64],content`.
fn decode_data(data: &str) -> core::result::Result<Vec<u8>, String> {
    let Some((header, content)) = data.split_once(',') else {
        return Err("the data URI has no comma before its content; export the file again".into());
    };
    if header.rsplit(';').next().is_some_and(|last| last.eq_ignore_ascii_case("base64")) {
        let content: Cow<'_, [u8]> = percent_decode_str(content).into();
        return BASE64.decode(&content).map_err(|error| format!("the data URI is not base64: {error}; export the file again"));
    }
    Ok(percent_decode_str(content).collect())
}

/// The path that a relative URI names, below the folder it is relative to.
fn relative_path(uri: &str) -> core::result::Result<PathBuf, String> {
    /// The most characters of a URI that a message repeats.
    const SHOWN: usize = 60;
    let shown: String = uri.chars().take(SHOWN).collect();
    if let Some((scheme, _)) = uri.split_once(':')
        && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c))
    {
        let fetch = if scheme.len() == 1 { "absolute paths are not read" } else { "nothing is fetched" };
        return Err(format!(
            "`{shown}` has the scheme `{scheme}:`; {fetch}: only data URIs and files in the glTF file's folder are; copy the file there"
        ));
    }
    let decoded = percent_decode_str(uri)
        .decode_utf8()
        .map_err(|_| format!("`{shown}` is not UTF-8 when its percent signs are decoded; rename the file"))?;
    if decoded.contains('\0') {
        return Err(format!("`{shown}` contains a zero byte; rename the file"));
    }
    let mut path = PathBuf::new();
    for component in Path::new(decoded.as_ref()).components() {
        let inside = match component {
            Component::Normal(name) => {
                path.push(name);
                true
            }
            Component::CurDir => true,
            Component::ParentDir => path.pop(),
            Component::RootDir | Component::Prefix(_) => false,
        };
        if !inside {
            return Err(format!(
                "`{shown}` leads out of the glTF file's folder, and only files in it are read; copy the file there"
            ));
        }
    }
    if path.as_os_str().is_empty() {
        return Err(format!("`{shown}` names no file"));
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_is_decoded_from_base64_and_from_percent_signs() {
        let decode = |uri| decode_data(strip_scheme(uri, "data").unwrap());
        assert_eq!(decode("data:application/octet-stream;base64,AAEC/w==").unwrap(), [0, 1, 2, 255]);
        assert_eq!(decode("DATA:;base64,AAEC/w").unwrap(), [0, 1, 2, 255], "padding may be missing");
        assert_eq!(decode("data:;base64,AAEC%2Fw%3D%3D").unwrap(), [0, 1, 2, 255]);
        assert_eq!(decode("data:text/plain;charset=utf-8,a%00b").unwrap(), b"a\0b");
        assert_eq!(decode("data:,").unwrap(), b"");
        assert!(decode("data:;base64").unwrap_err().contains("no comma"));
        assert!(decode("data:;base64,@@@@").unwrap_err().contains("not base64"));
    }

    #[test]
    fn relative_paths_are_normalised_and_decoded() {
        let path = |uri| relative_path(uri).unwrap();
        assert_eq!(path("a/./b/../c%20d.bin"), Path::new("a/c d.bin"));
        assert_eq!(path("Unicode%E2%9D%A4.png"), Path::new("Unicode❤.png"));
        assert_eq!(path("Unicode❤.png"), Path::new("Unicode❤.png"));
        assert_eq!(path("50%.png"), Path::new("50%.png"), "a percent sign that encodes nothing stands for itself");
    }

    #[test]
    fn nothing_leads_out_of_the_folder() {
        for uri in ["../a", "a/../../b", "/etc/passwd", "%2e%2e/a", "..%2Fa", "%2Fetc/passwd", "//host/a", ".", "", "a/.."] {
            assert!(relative_path(uri).is_err(), "{uri}");
        }
        for uri in ["http://example.com/a.bin", "file:///a.bin", "HTTPS:a", "C:/a.bin", "a%00.bin", "%ff.bin"] {
            assert!(relative_path(uri).is_err(), "{uri}");
        }
        assert!(relative_path("http://example.com/a.bin").unwrap_err().contains("nothing is fetched"));
    }
}
