//! The decoders against the reference: `vectors.json` was made with the encoder and decoder of meshoptimizer 1.3.0 (npm), one
//! stream of triangles by hand for codes that the encoder seldom uses.

use base64::{Engine as _, engine::general_purpose::STANDARD};
use serde_json::{Value, json};

use super::{Decoded, Mode, View, attributes, filters::Filter, indices};

/// The FNV-1a hash of 32 bits: the vectors have that of the whole output, and its beginning to look at.
fn fnv1a(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811c_9dc5, |hash, &byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

fn decode(view: &View, bytes: &[u8]) -> Decoded<Vec<u8>> {
    let count = view.count as usize;
    let mut decoded = match view.mode {
        Mode::Attributes => attributes::decode(bytes, count, view.stride)?,
        Mode::Triangles => indices::pack(&indices::decode_triangles(bytes, count)?, view.stride),
        Mode::Indices => indices::pack(&indices::decode_sequence(bytes, count)?, view.stride),
    };
    view.filter.apply(&mut decoded, view.stride);
    Ok(decoded)
}

/// A stream of the reference encoder.
struct Vector {
    name: String,
    view: View,
    data: Vec<u8>,
    /// The beginning of what the stream stands for; all of it under a filter that rounds.
    first: Vec<u8>,
    /// The hash of what the stream stands for.
    hash: u64,
}

fn vectors() -> Vec<Vector> {
    let vectors: Value = serde_json::from_str(include_str!("vectors.json")).unwrap();
    let bytes = |value: &Value| STANDARD.decode(value.as_str().unwrap()).unwrap();
    let vector = |vector: &Value| {
        let data = bytes(&vector["data"]);
        let (count, stride) = (vector["count"].as_u64().unwrap(), vector["stride"].as_u64().unwrap());
        let extension = json!({
            "buffer": 0, "byteLength": data.len(), "byteStride": stride, "count": count,
            "mode": vector["mode"], "filter": vector["filter"],
        });
        let view = View::read(&extension, count * stride, None).unwrap();
        let hash = vector["fnv1a"].as_u64().unwrap();
        Vector { name: vector["name"].to_string(), view, data, first: bytes(&vector["first"]), hash }
    };
    vectors.as_array().unwrap().iter().map(vector).collect()
}

#[test]
fn streams_decode_to_what_the_reference_decoder_gives() {
    for Vector { name, view, data, first, hash } in vectors() {
        let decoded = decode(&view, &data).unwrap_or_else(|error| panic!("{name}: {error}"));
        if matches!(view.filter, Filter::None | Filter::Exponential) {
            assert_eq!(decoded[..first.len()], first, "{name}");
            assert_eq!(u64::from(fnv1a(&decoded)), hash, "{name}");
            continue;
        }
        // The other filters are specified to one unit in the last place; their vectors have the whole output.
        assert_eq!(decoded.len(), first.len(), "{name}");
        let is_close = |a: &[u8], b: &[u8]| match (a, b) {
            (&[a], &[b]) => a.wrapping_sub(b).wrapping_add(1) <= 2,
            _ => u16::from_le_bytes([a[0], a[1]]).wrapping_sub(u16::from_le_bytes([b[0], b[1]])).wrapping_add(1) <= 2,
        };
        let size = view.stride / 4;
        for (i, (a, b)) in decoded.chunks(size).zip(first.chunks(size)).enumerate() {
            assert!(is_close(a, b), "{name}: component {i} is {a:?}, not {b:?}");
        }
    }
}

/// Every stream that is cut short is refused, and no flipped byte does more than give other values or an error.
#[test]
fn damaged_streams_do_no_harm() {
    for Vector { name, view, data, .. } in vectors() {
        for length in 0..data.len() {
            assert!(decode(&view, &data[..length]).is_err(), "{name} cut to {length} bytes");
        }
        for i in 0..data.len() {
            let mut damaged = data.clone();
            for flip in [0x01, 0xff] {
                damaged[i] = data[i] ^ flip;
                let size = decode(&view, &damaged).map_or(0, |decoded| decoded.len());
                assert!(size == 0 || size as u64 == view.count * view.stride as u64, "{name}, byte {i}");
            }
        }
    }
}

#[test]
fn views_that_break_the_rules_are_refused() {
    let view = |changes: &[(&str, Value)]| {
        let mut extension = json!({"buffer": 0, "byteLength": 9, "byteStride": 4, "count": 6, "mode": "ATTRIBUTES"});
        for (name, value) in changes {
            extension[*name] = value.clone();
        }
        View::read(&extension, 24, None).err().unwrap_or_default()
    };
    assert_eq!(view(&[]), "");
    assert!(view(&[("count", json!(7))]).contains("7 elements of 4 bytes are not the 24 bytes"));
    assert!(view(&[("count", json!(u64::MAX))]).contains("are not the 24 bytes"));
    assert!(view(&[("count", json!(-1))]).contains("`count` must be a whole number"));
    assert!(view(&[("buffer", Value::Null)]).contains("`buffer` must be a whole number"));
    assert!(view(&[("byteStride", json!(6)), ("count", json!(4))]).contains("`byteStride` of 6"));
    assert!(view(&[("byteStride", json!(12)), ("count", json!(2)), ("filter", json!("QUATERNION"))]).contains("of 12"));
    assert!(view(&[("mode", json!("TRIANGLES")), ("filter", json!("EXPONENTIAL"))]).contains("does not go with"));
    assert!(view(&[("mode", json!("TRIANGLES")), ("byteStride", json!(3)), ("count", json!(8))]).contains("of 3"));
    assert!(view(&[("mode", json!("POINTS"))]).contains("\"POINTS\""));
    assert!(view(&[("filter", json!("BLUR"))]).contains("\"BLUR\""));
}
