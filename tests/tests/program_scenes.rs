//! The program on scenes from files: what is in them, what of them is drawn, and how much memory that may take.

use crate::program::Folder;

/// A scene of one triangle in one of two scenes, with a moving node, a light and a masked material. Its buffer holds three corners
/// (0, 0, 0), (1, 0, 0) and (0, 1, 0), two times (0 s and 2 s) and two translations (none, and 4 m along x).
fn two_scenes() -> String {
    let numbers: [f32; 17] = [0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 2., 0., 0., 0., 4., 0., 0.];
    let bytes: String = numbers.iter().flat_map(|number| number.to_le_bytes()).map(|byte| format!("%{byte:02x}")).collect();
    serde_json::json!({
        "asset": { "version": "2.0", "generator": "by hand" },
        "extensionsUsed": ["KHR_lights_punctual", "EXT_unheard_of"],
        "extensions": { "KHR_lights_punctual": { "lights": [{ "type": "point", "name": "bulb", "intensity": 70.0 }] } },
        "scenes": [{ "name": "full", "nodes": [0, 1] }, { "name": "bare" }],
        "scene": 0,
        "nodes": [
            { "mesh": 0 },
            { "translation": [0, 0, 3], "extensions": { "KHR_lights_punctual": { "light": 0 } } }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "material": 0 }] }],
        "materials": [{ "alphaMode": "MASK", "doubleSided": true }],
        "animations": [{
            "name": "slide",
            "channels": [{ "sampler": 0, "target": { "node": 0, "path": "translation" } }],
            "samplers": [{ "input": 1, "output": 2 }]
        }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2] },
            { "bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 8 },
            { "buffer": 0, "byteOffset": 44, "byteLength": 24 }
        ],
        "buffers": [{ "byteLength": 68, "uri": format!("data:application/octet-stream,{bytes}") }]
    })
    .to_string()
}

fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    std::fs::write(folder.path().join("two.gltf"), two_scenes()).expect("the folder can be written");
    folder
}

#[test]
fn info_says_what_is_in_a_scene() {
    let folder = folder("info");
    let report = folder.json(&["info", "two.gltf", "--json"]);
    for (field, value) in
        [("triangles", 1), ("vertices", 3), ("meshes", 1), ("textures", 0), ("drawn_scene", 0), ("drawn_animation", 0)]
    {
        assert_eq!(report[field].as_u64(), Some(value), "{field} in {report}");
    }
    assert_eq!(report["materials"], serde_json::json!({ "opaque": 0, "mask": 1, "blend": 0 }));
    assert_eq!(report["generator"], "by hand");
    assert_eq!(report["scenes"], serde_json::json!(["full", "bare"]));
    let light = &report["lights"][0];
    assert_eq!((&light["name"], &light["kind"], &light["unit"]), (&"bulb".into(), &"point".into(), &"candela".into()));
    assert_eq!(light["intensity"].as_f64(), Some(70.0));
    assert_eq!(report["cameras"], serde_json::json!([]), "one that frames the bounds is not the scene's");
    assert_eq!(report["animations"], serde_json::json!([{ "name": "slide", "seconds": 2.0, "channels": 1 }]));
    assert_eq!(report["bounds"]["size"], serde_json::json!([1.0, 1.0, 0.0]));
    assert_eq!(report["units_guess"], "metres");
    assert_eq!(report["extensions_ignored"], serde_json::json!(["EXT_unheard_of"]));

    let text = folder.run(&["info", "two.gltf"]);
    let text = String::from_utf8_lossy(&text.stdout);
    for part in ["1 triangle, 3 vertices", "1 masked", "`bulb`, point, 70 candela", "`slide`, 2.000 s", "metres are plausible"] {
        assert!(text.contains(part), "`{part}` in {text}");
    }
}

#[test]
fn scenes_animations_and_times_are_chosen() {
    let folder = folder("choices");
    let left =
        |arguments: &[&str]| folder.json(&[&["info", "two.gltf", "--json"], arguments].concat())["bounds"]["min"][0].as_f64();
    assert_eq!(left(&[]), Some(0.0));
    assert_eq!(left(&["--animation", "slide", "--time", "1"]), Some(2.0));
    assert_eq!(left(&["--animation", "0", "--time", "2"]), Some(4.0));
    assert_eq!(folder.json(&["info", "two.gltf", "--scene", "bare", "--json"])["triangles"], 0);
    assert_eq!(folder.json(&["plan", "two.gltf", "--scene", "1", "--json"])["triangles"], 0);
    let refused = |arguments: &[&str], words: &[&str]| {
        let sentence = folder.refusal(arguments);
        for word in words {
            assert!(sentence.contains(word), "{arguments:?}: `{word}` is not in: {sentence}");
        }
    };
    refused(&["plan", "two.gltf", "--scene", "dusk"], &["dusk", "full", "bare"]);
    refused(&["plan", "two.gltf", "--animation", "7"], &["animation 7", "slide"]);
    refused(&["plan", "two.gltf", "--time", "1s"], &["without a unit", "seconds", "here 1"]);
    refused(&["plan", "two.gltf", "--time", "-1"], &["-1"]);
    for option in ["--scene", "--animation", "--time"] {
        refused(&["info", "builtin:demo", option, "0"], &[option, "builtin:demo", ".glb"]);
    }
}

/// Scenes without triangles are drawn, compared and timed as any other.
#[test]
fn nothing_can_be_drawn() {
    let folder = folder("nothing");
    let bare = ["two.gltf", "--scene", "bare", "--size", "32x18", "--map-size", "32", "--json"];
    let report = folder.json(&[&["compare"], &bare[..]].concat());
    assert_eq!((&report["agree"], &report["triangles"]), (&true.into(), &0.into()));
    for backend in ["cpu", "gpu"] {
        folder.json(&[&["render", "--backend", backend], &bare[..]].concat());
    }
    folder.json(&[&["bench", "--frames", "1"], &bare[..]].concat());
    let info = folder.json(&["info", "two.gltf", "--scene", "bare", "--json"]);
    assert!(info["bounds"].is_null() && info["units_guess"].is_null(), "{info}");
}

/// The refusal of what takes too much memory says what takes how much, the limit and what to do, before any work is done.
#[test]
fn the_memory_limit_bounds_all_parts_together() {
    let folder = folder("memory");
    let sizes = ["--size", "1024x1024", "--map-size", "1024"];
    // A map of 4 MiB; a picture of 28 MiB with its layers and 3 MiB to be written.
    let light = ["--light", "directional:dir=0,-1,0;lux=1"];
    let limited = |command: &[&'static str], limit: &'static str| [command, &sizes, &light, &["--memory-limit", limit]].concat();
    let cases: &[(Vec<&str>, &[&str])] = &[
        (limited(&["render"], "30MiB"), &["30.0 MiB", "frame 31.0 MiB", "1024 x 1024 pixels", "--size", "--memory-limit"]),
        (
            vec!["render", "--size", "16x9", "--map-size", "4096", "--memory-limit", "64MiB"],
            &["64.0 MiB", "shadow maps 128.0 MiB (2 of 4096 x 4096 texels)", "choose a smaller --map-size"],
        ),
        (limited(&["compare"], "60MiB"), &["60.0 MiB", "frame", "shadow maps"]),
        (limited(&["bench"], "50MiB"), &["50.0 MiB", "frame 56.0 MiB"]),
        (vec!["info", "two.gltf", "--memory-limit", "100B"], &["two.gltf", "--memory-limit"]),
        (vec!["render", "--memory-limit", "6G"], &["6G", "6GiB"]),
    ];
    for (arguments, words) in cases {
        let sentence = folder.refusal(arguments);
        for word in *words {
            assert!(sentence.contains(word), "{arguments:?}: `{word}` is not in: {sentence}");
        }
    }
    folder.json(&[limited(&["render"], "48MiB"), vec!["--json"]].concat());
    assert_eq!(folder.files(), ["shadow.png", "two.gltf"]);
}

/// The camera that a plan writes is the camera that it plans with.
#[test]
fn the_plan_writes_its_camera() {
    let folder = folder("camera");
    let matrix = |camera: &[&str]| {
        let report = folder.json(&[&["plan", "two.gltf", "--json"], camera].concat());
        let rows = report["camera"]["clip_from_world"].as_array().expect("the matrix is a list of rows").clone();
        let numbers: Vec<f64> =
            rows.iter().flat_map(|row| row.as_array().cloned().unwrap_or_default()).filter_map(|n| n.as_f64()).collect();
        (numbers, report["camera"]["spec"].as_str().expect("a perspective camera has a description").to_string())
    };
    for begin in [&[][..], &["--camera", "eye=3,2,4;target=0.5,0.2,0;fov=33.25"]] {
        let (scene, spec) = matrix(begin);
        let (written, again) = matrix(&["--camera", &spec]);
        assert_eq!((scene.len(), written.len()), (16, 16));
        assert_eq!(spec, again);
        // The row of depth depends on the near plane, which a description leaves to the program.
        for row in [0, 1, 3] {
            for column in 0..4 {
                let (a, b) = (scene[4 * row + column], written[4 * row + column]);
                assert!((a - b).abs() < 1e-4, "row {row}, column {column}: {a} and {b}");
            }
        }
    }
    let (_, spec) = matrix(&[]);
    let text = folder.run(&["plan", "two.gltf"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains(&format!("--camera '{spec}'")));
}
