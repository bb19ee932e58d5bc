//! Memory: what small files may not make the import reserve, and what the limit says.

use super::*;
use crate::import::{ImportOptions, import_slice_with};

fn with_limit(file: &File, memory_limit: u64) -> Result<Scene, ImportError> {
    import_slice_with("test.glb", &file.bytes(), &ImportOptions { memory_limit, ..ImportOptions::default() })
}

/// A PNG of 1 bit a texel and of one colour.
fn flat_png(side: u32) -> Vec<u8> {
    let mut png = Vec::new();
    let image = image::GrayImage::new(side, side);
    image.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).unwrap();
    png
}

fn with_image(png: &[u8]) -> File {
    let mut file = File::triangle();
    file.texture();
    let view = file.view(png);
    file.json["images"][0]["bufferView"] = view.into();
    file.material(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    file
}

#[test]
fn counts_without_bytes_are_refused() {
    let instanced = |count: u64| {
        let mut file = File::triangle();
        let accessor = json!({"componentType": FLOAT, "type": "VEC3", "count": count});
        file.json["accessors"].as_array_mut().unwrap().push(accessor);
        file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}}});
        file
    };
    assert_eq!(instanced(3).scene().instances().len(), 3, "a few are zeros, as the specification says");
    let sparse = |count: u64| {
        let mut file = File::triangle();
        let (indices, values) = (file.view(&[1]), file.view(bytemuck::cast_slice(&[5.0_f32, 0.0, 0.0])));
        file.json["accessors"][0] = json!({
            "componentType": FLOAT, "type": "VEC3", "count": count,
            "sparse": {
                "count": 1, "indices": {"bufferView": indices, "componentType": UNSIGNED_BYTE},
                "values": {"bufferView": values},
            },
        });
        file
    };
    assert_eq!(corners(&sparse(3).scene(), 0), [Vec3::ZERO, 5.0 * Vec3::X, Vec3::ZERO]);
    let plain = |count: u64| {
        let mut file = File::triangle();
        file.json["accessors"][0] = json!({"componentType": FLOAT, "type": "VEC3", "count": count});
        file
    };
    assert_eq!(corners(&plain(3).scene(), 0), [Vec3::ZERO; 3]);
    let indexed = |count: u64| {
        let mut file = File::triangle();
        let accessor = json!({"componentType": UNSIGNED_SHORT, "type": "SCALAR", "count": count});
        file.json["accessors"].as_array_mut().unwrap().push(accessor);
        file.primitive()["indices"] = 1.into();
        file
    };
    for count in [100_000, 4_000_000_000, 1 << 62] {
        for file in [instanced(count), sparse(count), plain(count), indexed(count)] {
            assert!(file.error().contains("without one at most 65536 are read"), "{}", file.error());
        }
    }
}

/// A sparse morph target may leave out the bytes of however many vertices the mesh has.
#[test]
fn sparse_morph_targets_without_bytes_of_their_own_are_read_in_place() {
    let count = 300_000;
    let mut file = File::new();
    let positions: Vec<f32> = (0..count).flat_map(|i| [(i % 3) as f32, (i % 2) as f32, 0.0]).collect();
    file.floats("POSITION", "VEC3", &positions);
    let (indices, values) = (file.view(&(count - 3_u32).to_le_bytes()), file.view(bytemuck::cast_slice(&[0.0_f32, 0.0, 7.0])));
    file.json["accessors"].as_array_mut().unwrap().push(json!({
        "componentType": FLOAT, "type": "VEC3", "count": count,
        "sparse": {
            "count": 1, "indices": {"bufferView": indices, "componentType": UNSIGNED_INT}, "values": {"bufferView": values},
        },
    }));
    file.primitive()["targets"] = json!([{"POSITION": 1}]);
    file.json["meshes"][0]["weights"] = json!([1]);
    let scene = file.scene();
    assert_eq!(corners(&scene, 99_999)[0].z, 7.0);
    assert_eq!(scene.vertices().positions.iter().filter(|position| position.z != 0.0).count(), 1);
}

#[test]
fn images_that_claim_more_than_they_hold_are_refused() {
    let mut png = flat_png(64);
    // Width and height are the first things in the header, and a sum over the header follows it.
    png[16..24].copy_from_slice(&[0, 0, 0x40, 0, 0, 0, 0x40, 0]);
    let sum = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&sum.to_be_bytes());
    let message = with_image(&png).error();
    assert!(message.contains("images[0]: claims 16384 x 16384 texels"), "{message}");
}

/// The checksum of PNG chunks.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| if sum & 1 == 1 { sum >> 1 ^ 0xedb8_8320 } else { sum >> 1 })
    })
}

#[test]
fn the_limit_names_what_is_too_large() {
    let mut file = with_image(&flat_png(512));
    let translations = vec![0.0; 3 * 1000];
    let translations = file.float_accessor("VEC3", &translations);
    file.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translations}}});
    file.scene();
    // One after the other: the JSON first, then 3001 vertices and more, then 512 by 512 texels.
    let refusal = |limit: u64| with_limit(&file, limit).unwrap_err().to_string();
    let bytes = 2 * file.json.to_string().len() as u64;
    let meshes = refusal(bytes + 200_000);
    assert!(meshes.contains("meshes[0].primitives[0]: with these meshes the import takes 1 MiB"), "{meshes}");
    let textures = refusal(bytes + 1_000_000);
    assert!(textures.contains("images[0]: with these textures the import takes"), "{textures}");
    assert!(textures.contains("its memory limit is 0 MiB; raise the limit, or scale the images down"), "{textures}");
    with_limit(&file, 1 << 24).unwrap();

    let mut text = File::triangle();
    let content = format!("data:;base64,{}", "A".repeat(4000));
    text.json["buffers"] = json!([{"byteLength": 36, "uri": content}]);
    let text = text.json.to_string();
    // Room for the JSON, but not for the 4000 characters of the buffer once more.
    let options = ImportOptions { memory_limit: 2 * text.len() as u64 + 1000, ..ImportOptions::default() };
    let buffers = import_slice_with("test.gltf", text.as_bytes(), &options).unwrap_err().to_string();
    assert!(buffers.contains("buffers[0]: with these buffers"), "{buffers}");
}

#[test]
fn the_file_itself_counts() {
    let folder = std::env::temp_dir().join(format!("shadow-scene-{}-limit", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("file.glb");
    std::fs::write(&path, File::triangle().bytes()).unwrap();
    let options = ImportOptions { memory_limit: 100, ..ImportOptions::default() };
    let message = crate::import_with(&path, &options).unwrap_err().to_string();
    let _ = std::fs::remove_dir_all(&folder);
    assert!(message.contains("file.glb: with these buffers the import takes"), "{message}");
}
