//! The outermost layer: JSON text, or a binary container (GLB) that holds JSON and one buffer.

use super::error::{ImportError, Result};

/// The two parts of a file.
#[derive(Debug)]
pub(super) struct Container<'a> {
    /// The JSON text.
    pub(super) json: &'a [u8],
    /// The buffer that a binary container holds.
    pub(super) bin: Option<&'a [u8]>,
}

/// What a binary container starts with.
const MAGIC: &[u8] = b"glTF";
/// Bytes of the container's header: magic, version, length.
const HEADER_LEN: usize = 12;
/// Bytes of a chunk's header: length, type.
const CHUNK_HEADER_LEN: usize = 8;
/// UTF-8 text may start with this mark; glTF forbids it, editors add it.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Takes a file apart. `file` is its name for messages.
pub(super) fn split<'a>(file: &str, bytes: &'a [u8]) -> Result<Container<'a>> {
    if bytes.starts_with(MAGIC) {
        return split_binary(bytes).map_err(|problem| ImportError::Container { file: file.into(), problem });
    }
    let json = without_mark(bytes);
    if json.trim_ascii_start().starts_with(b"{") {
        return Ok(Container { json, bin: None });
    }
    let problem = if bytes.is_empty() {
        "the file is empty; a glTF file is JSON text (.gltf) or starts with the letters glTF (.glb)".into()
    } else {
        let start = String::from_utf8_lossy(&bytes[..bytes.len().min(4)]).into_owned();
        format!("the file starts with {start:?}; a glTF file is JSON text (.gltf) or starts with the letters glTF (.glb)")
    };
    Err(ImportError::Container { file: file.into(), problem })
}

/// The text behind its byte order mark, if it has one.
fn without_mark(json: &[u8]) -> &[u8] {
    json.strip_prefix(BYTE_ORDER_MARK).unwrap_or(json)
}

/// Takes a binary container apart; see section 4.4 of the glTF 2.0 specification.
fn split_binary(bytes: &[u8]) -> core::result::Result<Container<'_>, String> {
    let word = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(format!("the binary header has {} bytes of {HEADER_LEN}; the file was cut short", bytes.len()));
    };
    if version != 2 {
        return Err(format!(
            "the binary container has version {version}, but only version 2 is understood; export the file as glTF 2.0"
        ));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(format!("the binary header announces {length} bytes, but the file has {}; it was cut short", bytes.len()));
    }
    let mut rest = bytes.get(HEADER_LEN..length).ok_or_else(|| {
        format!("the binary header announces {length} bytes, fewer than the header itself; export the file again")
    })?;
    let json = next_chunk(&mut rest, b"JSON")?
        .ok_or("the first chunk of the binary container is not of type JSON; export the file again")?;
    // Some exporters pad the text with zeros although glTF demands spaces.
    let padding = json.iter().rev().take_while(|&&byte| byte == 0 || byte == b' ').count();
    let json = without_mark(&json[..json.len() - padding]);
    let bin = if rest.is_empty() { None } else { next_chunk(&mut rest, b"BIN\0")? };
    Ok(Container { json, bin })
}

/// Takes the next chunk off `rest`; `None` if it is of another type.
fn next_chunk<'a>(rest: &mut &'a [u8], kind: &[u8; 4]) -> core::result::Result<Option<&'a [u8]>, String> {
    let name = String::from_utf8_lossy(kind);
    let name = name.trim_end_matches('\0');
    let Some((header, body)) = rest.split_at_checked(CHUNK_HEADER_LEN) else {
        return Err(format!(
            "the header of the {name} chunk has {} bytes of {CHUNK_HEADER_LEN}; the file was cut short",
            rest.len()
        ));
    };
    let (length, found) = header.split_at(4);
    // Both halves are 4 bytes long.
    let length = length.iter().rev().fold(0_usize, |value, &byte| value << 8 | usize::from(byte));
    if found != kind {
        return Ok(None);
    }
    if !length.is_multiple_of(4) {
        return Err(format!("the {name} chunk is {length} bytes long, which is not a multiple of 4; export the file again"));
    }
    let Some((chunk, after)) = body.split_at_checked(length) else {
        return Err(format!("the {name} chunk announces {length} bytes, but only {} follow; the file was cut short", body.len()));
    };
    *rest = after;
    Ok(Some(chunk))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
        [&(body.len() as u32).to_le_bytes()[..], kind, body].concat()
    }

    fn glb(chunks: &[Vec<u8>]) -> Vec<u8> {
        let body = chunks.concat();
        [MAGIC, &2_u32.to_le_bytes(), &((HEADER_LEN + body.len()) as u32).to_le_bytes(), &body].concat()
    }

    fn message(bytes: &[u8]) -> String {
        split("a.glb", bytes).unwrap_err().to_string()
    }

    #[test]
    fn both_containers_are_taken_apart() {
        let text = split("a.gltf", b"\xef\xbb\xbf {}").unwrap();
        assert_eq!((text.json, text.bin), (&b" {}"[..], None));
        let bytes = glb(&[chunk(b"JSON", b"{}  "), chunk(b"BIN\0", &[1, 2, 3, 4])]);
        let binary = split("a.glb", &bytes).unwrap();
        assert_eq!((binary.json, binary.bin), (&b"{}"[..], Some(&[1, 2, 3, 4][..])));
    }

    #[test]
    fn zero_padding_and_unknown_later_chunks_are_tolerated() {
        let bytes = glb(&[chunk(b"JSON", b"{}\0\0"), chunk(b"MORE", &[0; 4])]);
        let binary = split("a.glb", &bytes).unwrap();
        assert_eq!((binary.json, binary.bin), (&b"{}"[..], None));
    }

    #[test]
    fn every_truncation_is_refused_and_named() {
        let bytes = glb(&[chunk(b"JSON", b"{}  "), chunk(b"BIN\0", &[1, 2, 3, 4])]);
        for length in 0..bytes.len() {
            assert!(split("a.glb", &bytes[..length]).is_err(), "{length} bytes");
        }
        assert!(message(&bytes[..30]).contains("announces 36 bytes, but the file has 30"));
    }

    #[test]
    fn lies_about_lengths_are_refused() {
        let good = glb(&[chunk(b"JSON", b"{}  "), chunk(b"BIN\0", &[1, 2, 3, 4])]);
        for (at, value) in [(8, 0), (8, 11), (8, u32::MAX), (12, 3), (12, u32::MAX), (24, 8), (24, u32::MAX - 3), (4, 1)] {
            let mut bad = good.clone();
            bad[at..at + 4].copy_from_slice(&value.to_le_bytes());
            assert!(split("a.glb", &bad).is_err(), "{value} at {at}");
        }
        assert!(message(&glb(&[chunk(b"BIN\0", &[0; 4])])).contains("first chunk"));
        assert!(message(b"GLTF....").contains("GLTF"));
    }
}
