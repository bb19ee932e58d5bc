//! What the importer refuses, and a sweep over real and malformed files.

use shadow_math::ShadowSettings;

use super::*;
use crate::frame_plan::FramePlan;

#[test]
fn versions_other_than_2_are_refused() {
    let mut file = File::triangle();
    for (asset, accepted) in [
        (json!({"version": "2.9"}), true),
        (json!({"version": "2.1", "minVersion": "2.0"}), true),
        (json!({"version": "2.1", "minVersion": "2.1"}), false),
        (json!({"version": "1.0"}), false),
        (json!({"version": 2.0}), false),
        (json!({}), false),
        (Value::Null, false),
    ] {
        file.json["asset"] = asset.clone();
        assert_eq!(file.import().is_ok(), accepted, "{asset}");
    }
}

#[test]
fn node_graphs_that_are_no_trees_are_refused() {
    let mut file = File::triangle();
    for nodes in [
        json!([{"mesh": 0, "children": [0]}]),
        json!([{"mesh": 0, "children": [1]}, {"children": [0]}]),
        json!([{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}]),
        json!([{"children": [1, 1]}, {"mesh": 0}]),
    ] {
        file.json["nodes"] = nodes;
        assert!(file.error().contains("is reached a second time"), "{}", file.error());
    }
}

#[test]
fn a_deep_hierarchy_does_not_overflow_the_stack() {
    let depth = 100_000;
    let mut nodes: Vec<Value> = (1..depth).map(|child| json!({"children": [child], "translation": [0, 0, 0.25]})).collect();
    nodes.push(json!({"mesh": 0}));
    let mut file = File::triangle();
    file.json["nodes"] = nodes.into();
    let scene = file.scene();
    assert_eq!(scene.origin().z + f64::from(scene.bounds().min.z), 0.25 * f64::from(depth - 1));
}

#[test]
fn ranges_that_lie_are_refused_before_anything_is_read() {
    type Change = fn(&mut File);
    let cases: [(Change, &str); 12] = [
        (|f| f.json["accessors"][0]["count"] = 4.into(), "has 4 elements, 12 bytes apart, from byte 0 on"),
        (|f| f.json["accessors"][0]["count"] = 0.into(), "count of 0"),
        (|f| f.json["accessors"][0]["count"] = u64::MAX.into(), "elements, 12 bytes apart"),
        (|f| f.json["accessors"][0]["byteOffset"] = u64::MAX.into(), "from byte 18446744073709551615 on"),
        (|f| f.json["accessors"][0]["type"] = "VEC2".into(), "must be [Vec3]"),
        (|f| f.json["accessors"][0]["componentType"] = UNSIGNED_INT.into(), "of U32"),
        (|f| f.json["bufferViews"][0]["byteOffset"] = u64::MAX.into(), "bufferViews[0] is 36 bytes from byte"),
        (|f| f.json["bufferViews"][0]["byteLength"] = 37.into(), "bufferViews[0] is 37 bytes"),
        (|f| f.json["bufferViews"][0]["byteStride"] = 8.into(), "byteStride is 8"),
        (|f| f.json["bufferViews"][0]["buffer"] = 1.into(), "bufferViews[0].buffer"),
        (
            |f| f.primitive()["attributes"]["POSITION"] = 9.into(),
            "primitives[0].attributes.POSITION: names accessor 9, but there are 1",
        ),
        (|f| f.indices(&[0, 1, 3]), "has 3 as its element 2, but there are only 3 vertices"),
    ];
    for (change, message) in cases {
        let mut file = File::triangle();
        change(&mut file);
        assert!(file.error().contains(message), "{} has no `{message}`", file.error());
    }
}

#[test]
fn vertices_beyond_all_reason_are_refused() {
    let mut file = File::new();
    file.floats("POSITION", "VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 3e30, 0.0]);
    assert!(file.error().contains("at most 1e12 m"), "{}", file.error());
    let mut file = File::new();
    file.floats("POSITION", "VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, f32::INFINITY, 0.0]);
    assert!(file.error().contains("vertex 2 is at [0, inf, 0]"), "{}", file.error());
}

#[test]
fn a_file_without_triangles_is_an_empty_scene_with_a_note() {
    let mut file = File::triangle();
    file.primitive()["mode"] = 0.into();
    let scene = file.scene();
    assert!(scene.triangles().is_empty() && scene.vertices().positions.is_empty() && scene.instances().is_empty());
    assert_eq!((scene.bounds().min, scene.bounds().max), (Vec3::splat(-0.5), Vec3::splat(0.5)));
    assert!(scene.notes()[0].starts_with("nothing to draw"), "{:?}", scene.notes());
    assert!(scene.has_default_camera() && scene.source().points_and_lines == 1);
    FramePlan::new(&scene, &scene.cameras()[0].camera, &ShadowSettings::default(), 64, 64, None).unwrap();
}

#[test]
fn a_slice_reads_no_other_file() {
    let text = r#"{"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": "Cargo.toml"}]}"#;
    let message = import_slice("test.gltf", text.as_bytes()).unwrap_err().to_string();
    assert!(message.contains("no folder to read it from"), "{message}");
}

/// Every `.gltf` and `.glb` file below a folder, in order.
fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_below(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "gltf" || extension == "glb") {
            files.push(path);
        }
    }
}

/// Imports real and malformed scenes: the folder in the environment variable `SHADOW_SCENES`.
#[test]
#[allow(clippy::print_stderr, reason = "a test that does not run must say so")]
fn every_shared_scene_loads_or_is_refused_by_name() {
    let Some(folder) = std::env::var_os("SHADOW_SCENES").map(PathBuf::from) else {
        eprintln!("skipped: set SHADOW_SCENES to a folder of glTF files");
        return;
    };
    let mut files = Vec::new();
    files_below(&folder, &mut files);
    assert!(!files.is_empty(), "no glTF file below {}", folder.display());
    let mut loaded = 0;
    for file in &files {
        match import(file) {
            Ok(scene) => {
                loaded += 1;
                let vertices = scene.vertices();
                let is_finite = vertices.normals.iter().all(|n| n.is_finite())
                    && vertices.uvs.iter().all(|uv| uv.is_finite())
                    && vertices.colors.iter().all(|color| color.is_finite());
                assert!(is_finite, "{}", file.display());
            }
            Err(error) => {
                let message = error.to_string();
                assert!(message.starts_with(&file.display().to_string()) && !message.contains('\n'), "{message}");
            }
        }
    }
    assert!(loaded > 0, "none of {} files below {} loads", files.len(), folder.display());
}
